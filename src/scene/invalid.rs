//! A value of the scene that makes no physical sense, and where it stands.

/// What is wrong with one value of a scene.
///
/// The path leads to the value (`phases.slide.rheology.yield_stress`, `fluids.0.shape`); the scene reader turns it
/// into file, line and column.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invalid {
    /// Path of the value inside the scene or inside the part that was checked; fields and list indices joined by dots.
    pub path: String,
    /// What was found and what was expected, with units.
    pub message: String,
}

impl Invalid {
    /// The value at `path` is wrong because of `message`.
    pub fn new(path: impl Into<String>, message: impl Into<String>) -> Self {
        Self { path: path.into(), message: message.into() }
    }

    /// The same complaint seen from one level further out: `yield_stress` under `rheology` is
    /// `rheology.yield_stress`.
    #[must_use]
    pub fn under(mut self, parent: &str) -> Self {
        self.path = match (parent.is_empty(), self.path.is_empty()) {
            (true, _) => self.path,
            (false, true) => parent.to_owned(),
            (false, false) => format!("{parent}.{}", self.path),
        };
        self
    }
}
