//! Particles at one time.

use foxglove::messages::PointCloud;
use foxglove::messages::packed_element_field::NumericType;

/// One quantity of the particles of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct FrameField {
    /// Name, as in the log.
    pub name: String,
    /// SI unit; empty for numbers that name something.
    pub unit: String,
    /// Whether it names something, as a phase or a particle, and so is a whole number.
    pub is_whole: bool,
    /// Value of each particle.
    pub values: Vec<f64>,
}

/// The particles of a topic at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Simulated time (s).
    pub time: f64,
    /// Quantities, in the order of the log.
    pub fields: Vec<FrameField>,
    /// Number of particles.
    pub count: usize,
}

impl Frame {
    /// The frame of a cloud of points; `unit` says that of a field.
    ///
    /// # Errors
    /// Fields of kinds that no log of ours has, or that reach beyond their row.
    pub(super) fn new(time: f64, cloud: &PointCloud, unit: impl Fn(&str) -> String) -> Result<Self, String> {
        let stride = cloud.point_stride as usize;
        if stride == 0 {
            return Err("a frame whose points have no bytes".to_owned());
        }
        let rows = || cloud.data.chunks_exact(stride);
        let mut fields = Vec::with_capacity(cloud.fields.len());
        for field in &cloud.fields {
            let (start, name) = (field.offset as usize, &field.name);
            let (read, size): (fn(&[u8]) -> f64, usize) = match field.r#type() {
                NumericType::Uint8 => (|bytes| f64::from(bytes[0]), 1),
                NumericType::Uint32 => (|bytes| f64::from(u32::from_le_bytes(four(bytes))), 4),
                NumericType::Float32 => (|bytes| f64::from(f32::from_le_bytes(four(bytes))), 4),
                NumericType::Float64 => (|bytes| f64::from_le_bytes(eight(bytes)), 8),
                other => return Err(format!("the field `{name}` of a frame is of the kind {other:?}")),
            };
            if start + size > stride {
                return Err(format!("the field `{name}` of a frame reaches beyond its row"));
            }
            let values = rows().map(|row| read(&row[start..start + size])).collect();
            let is_whole = matches!(field.r#type(), NumericType::Uint8 | NumericType::Uint32);
            fields.push(FrameField { name: name.clone(), unit: unit(name), is_whole, values });
        }
        Ok(Self { time, fields, count: rows().count() })
    }

    /// The field called `name`.
    #[must_use]
    pub fn field(&self, name: &str) -> Option<&FrameField> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Values of the field called `name`; empty if there is none.
    #[must_use]
    pub fn values(&self, name: &str) -> &[f64] {
        self.field(name).map_or(&[], |field| &field.values)
    }

    /// Position (m) of each particle.
    pub fn positions(&self) -> impl Iterator<Item = [f64; 3]> {
        self.vectors(["x", "y", "z"])
    }

    /// Velocity (m/s) of each particle.
    pub fn velocities(&self) -> impl Iterator<Item = [f64; 3]> {
        self.vectors(["vx", "vy", "vz"])
    }

    fn vectors(&self, names: [&str; 3]) -> impl Iterator<Item = [f64; 3]> {
        let axes = names.map(|name| self.values(name));
        (0..self.count).map(move |k| axes.map(|axis| axis.get(k).copied().unwrap_or(0.0)))
    }

    /// Speed (m/s) of each particle.
    #[must_use]
    pub fn speeds(&self) -> Vec<f64> {
        self.velocities().map(|v| v.iter().map(|component| component * component).sum::<f64>().sqrt()).collect()
    }
}

fn four(bytes: &[u8]) -> [u8; 4] {
    std::array::from_fn(|k| bytes[k])
}

fn eight(bytes: &[u8]) -> [u8; 8] {
    std::array::from_fn(|k| bytes[k])
}
