//! The contract of a rheology, and the registry through which scenes name them.

use bevy_ecs::component::Mutable;
use bevy_ecs::prelude::*;
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::error::UserError;
use crate::particles::{Fluid, GRAIN, PIECE, PhaseIndex, Pressure, ShearRate, Viscosity};
use crate::phases::Phase;
use crate::scene::schema::{Describe, OpenEnum, check_ranges, describe};
use crate::scene::{Document, Invalid, Named, flatten};

/// Parameters of a rheology: what a scene writes behind its name, and a component of its phase.
pub trait Rheology: Component<Mutability = Mutable> + Serialize + DeserializeOwned + JsonSchema + Clone {
    /// Refuses parameters that make no physical sense. Those outside the range that their `#[schemars(…)]` states have been
    /// refused already.
    ///
    /// # Errors
    /// The first such parameter.
    fn check(&self) -> Result<(), Invalid> {
        Ok(())
    }

    /// The greatest dynamic viscosity (Pa s) that it can give: it limits the time step.
    fn greatest_viscosity(&self) -> f64;
}

/// A rheology without a memory: a pure function of shear rate and pressure.
pub trait FlowCurve: Rheology {
    /// Dynamic viscosity μ (Pa s) at shear rate γ̇ (1/s) and pressure p (Pa).
    fn viscosity(&self, shear_rate: f64, pressure: f64) -> f64;
}

/// What a phase keeps of its rheology, whatever its type.
#[derive(Debug, Clone)]
pub struct RheologyFacts {
    /// Name by which the scene called it.
    pub name: String,
    /// Greatest viscosity (Pa s).
    pub greatest_viscosity: f64,
    /// Every parameter with its value.
    pub parameters: Vec<(String, String)>,
    /// Parameters that the scene left open, with the values they took.
    pub defaults: Vec<(String, String)>,
    /// Its flow curve; none if it has a memory.
    pub curve: Option<Curve>,
}

/// Viscosity μ (Pa s) of a phase's entity at a shear rate γ̇ (1/s) and a pressure p (Pa), whatever the type of its [`FlowCurve`].
pub type Curve = fn(EntityRef<'_>, f64, f64) -> Option<f64>;

type Read = fn(&Document, &Named<'_>, &str, &mut EntityWorldMut) -> Result<RheologyFacts, UserError>;

/// The rheologies that a scene can name.
#[derive(Resource, Default)]
pub struct RheologyRegistry {
    entries: Vec<(String, Read, Describe, Option<Curve>)>,
    registrations: usize,
}

impl OpenEnum for RheologyRegistry {
    const NAME: &'static str = "rheology";

    fn variants(&self) -> impl Iterator<Item = (&str, Describe)> {
        self.entries.iter().map(|(name, _, describe, _)| (name.as_str(), *describe))
    }
}

impl RheologyRegistry {
    /// Registers `R` in the place of what had its name; how many registrations there have been.
    pub(crate) fn register<R: Rheology>(&mut self, name: &str) -> usize {
        self.entries.retain(|(known, ..)| known != name);
        self.entries.push((name.to_owned(), read::<R>, describe::<R>, None));
        self.registrations += 1;
        self.registrations
    }

    /// Lets others ask for the flow curve of `R`, which was registered as `name`.
    pub(crate) fn set_curve<R: FlowCurve>(&mut self, name: &str) {
        for (_, _, _, curve) in self.entries.iter_mut().filter(|(known, ..)| known == name) {
            *curve = Some(|phase, shear_rate, pressure| Some(phase.get::<R>()?.viscosity(shear_rate, pressure)));
        }
    }

    /// Names that a scene can use.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.iter().map(|(name, ..)| name.as_str())
    }

    /// Reads the rheology at `path` of the scene and gives it to the phase `entity`.
    ///
    /// # Errors
    /// An unknown name, or parameters that are wrong.
    pub(crate) fn read(
        &self,
        document: &Document,
        path: &str,
        entity: &mut EntityWorldMut,
    ) -> Result<RheologyFacts, UserError> {
        let Some(node) = document.node(path) else {
            return Err(document.invalid(&Invalid::new(path, "a rheology is needed here")));
        };
        let named = document.named(node)?;
        let Some((name, read, _, curve)) = self.entries.iter().find(|(known, ..)| known == named.name) else {
            let known: Vec<&str> = self.names().collect();
            return Err(document.unknown_name_error(named.span, "rheology", named.name, &known));
        };
        Ok(RheologyFacts { name: name.clone(), curve: *curve, ..read(document, &named, path, entity)? })
    }
}

fn read<R: Rheology>(
    document: &Document,
    named: &Named<'_>,
    path: &str,
    entity: &mut EntityWorldMut,
) -> Result<RheologyFacts, UserError> {
    let rheology: R = document.read_body(named)?;
    check_ranges(describe::<R>, &rheology).map_err(|invalid| document.invalid(&invalid.under(path)))?;
    rheology.check().map_err(|invalid| document.invalid(&invalid.under(path)))?;
    let facts = RheologyFacts {
        name: String::new(),
        greatest_viscosity: rheology.greatest_viscosity(),
        parameters: flatten(path, &rheology),
        defaults: document.defaults(path, &rheology),
        curve: None,
    };
    entity.insert(rheology);
    Ok(facts)
}

/// The rheology `R` of each phase by its index, `None` for phases of another, in the reused memory of `models`.
pub fn models_by_phase<'a, R: Rheology>(
    models: &'a mut Vec<Option<R>>,
    phases: &Query<(&Phase, Option<&R>)>,
) -> &'a [Option<R>] {
    models.clear();
    models.resize(phases.iter().len(), None);
    for (phase, model) in phases {
        models[phase.index as usize] = model.cloned();
    }
    models
}

/// Applies a [`FlowCurve`] to the particles of every phase that has it.
pub fn apply_flow_curve<R: FlowCurve>(
    mut models: Local<Vec<Option<R>>>,
    phases: Query<(&Phase, Option<&R>)>,
    mut fluid: Query<(&PhaseIndex, &ShearRate, &Pressure, &mut Viscosity), With<Fluid>>,
) -> Result {
    let models = models_by_phase(&mut models, &phases);
    for (phase, shear_rate, pressure, mut viscosity) in fluid.contiguous_iter_mut()? {
        (phase, shear_rate, pressure, viscosity.bypass_change_detection())
            .into_par_iter()
            .with_min_len(GRAIN)
            .with_max_len(PIECE)
            .for_each(|(phase, shear_rate, pressure, viscosity)| {
                if let Some(model) = &models[phase.0 as usize] {
                    viscosity.0 = model.viscosity(shear_rate.0, pressure.0);
                }
            });
    }
    Ok(())
}
