//! Point clouds: one packed row of bytes per particle, inside a `foxglove.PointCloud`.

use std::ops::Range;

use foxglove::Encode;
use foxglove::messages::{
    PackedElementField, PointCloud, Pose, Quaternion, Timestamp, Vector3, packed_element_field::NumericType,
};
use glam::DVec3;

use crate::particles::Workspace;

/// Name of the one frame of reference of a log: the coordinates of the scene.
const FRAME: &str = "world";

/// Rows packed together, so that the pass over each column finds them still in the nearest cache (~10 KiB).
const BLOCK: usize = 256;

/// Names a cloud of points of the [`LogWriter`](super::LogWriter) that handed it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct PointsId(pub(super) usize);

/// How one field of a point is stored, always little endian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PointKind {
    /// 32-bit float: seven digits, so 1 mm in 10 km.
    F32,
    /// Unsigned byte.
    U8,
    /// Unsigned 32-bit integer.
    U32,
}

impl PointKind {
    const fn size(self) -> u32 {
        match self {
            Self::F32 | Self::U32 => 4,
            Self::U8 => 1,
        }
    }

    const fn numeric_type(self) -> NumericType {
        match self {
            Self::F32 => NumericType::Float32,
            Self::U8 => NumericType::Uint8,
            Self::U32 => NumericType::Uint32,
        }
    }
}

/// One field of a point. The fields of a point follow each other without gaps, in the order they are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointField<'a> {
    /// Name that a viewer shows; `x`, `y` and `z` are the place in the world in metres.
    pub name: &'a str,
    /// SI unit; empty for numbers that name something.
    pub unit: &'a str,
    /// How it is stored.
    pub kind: PointKind,
}

impl<'a> PointField<'a> {
    /// A field called `name` in `unit` that is stored as `kind`.
    pub const fn new(name: &'a str, unit: &'a str, kind: PointKind) -> Self {
        Self { name, unit, kind }
    }
}

/// Fields of a fluid particle (45 bytes): place \[m\], velocity \[m/s\], density \[kg/m³\], pressure \[Pa\],
/// apparent dynamic viscosity \[Pa·s\], shear rate \[1/s\], number of its phase, number of the particle.
pub const FLUID_FIELDS: [PointField<'static>; 12] = [
    PointField::new("x", "m", PointKind::F32),
    PointField::new("y", "m", PointKind::F32),
    PointField::new("z", "m", PointKind::F32),
    PointField::new("vx", "m/s", PointKind::F32),
    PointField::new("vy", "m/s", PointKind::F32),
    PointField::new("vz", "m/s", PointKind::F32),
    PointField::new("density", "kg/m³", PointKind::F32),
    PointField::new("pressure", "Pa", PointKind::F32),
    PointField::new("viscosity", "Pa s", PointKind::F32),
    PointField::new("shear_rate", "1/s", PointKind::F32),
    PointField::new("phase", "", PointKind::U8),
    PointField::new("id", "", PointKind::U32),
];

/// Fields of a particle of a wall or a structure (33 bytes): place \[m\], velocity \[m/s\], pressure \[Pa\],
/// number of its body, number of the particle.
pub const BODY_FIELDS: [PointField<'static>; 9] = [
    PointField::new("x", "m", PointKind::F32),
    PointField::new("y", "m", PointKind::F32),
    PointField::new("z", "m", PointKind::F32),
    PointField::new("vx", "m/s", PointKind::F32),
    PointField::new("vy", "m/s", PointKind::F32),
    PointField::new("vz", "m/s", PointKind::F32),
    PointField::new("pressure", "Pa", PointKind::F32),
    PointField::new("body", "", PointKind::U8),
    PointField::new("id", "", PointKind::U32),
];

/// The values of one field, or of three that make a vector, for all particles in order.
#[derive(Debug, Clone, Copy)]
pub enum Column<'a> {
    /// Three consecutive [`PointKind::F32`] fields, in SI units, rounded to 32 bits.
    Vector(&'a [DVec3]),
    /// One [`PointKind::F32`] field, in SI units, rounded to 32 bits.
    Scalar(&'a [f64]),
    /// One [`PointKind::U8`] field.
    U8(&'a [u8]),
    /// One [`PointKind::U32`] field.
    U32(&'a [u32]),
}

impl Column<'_> {
    const fn kinds(&self) -> &'static [PointKind] {
        match self {
            Self::Vector(_) => &[PointKind::F32; 3],
            Self::Scalar(_) => &[PointKind::F32],
            Self::U8(_) => &[PointKind::U8],
            Self::U32(_) => &[PointKind::U32],
        }
    }

    const fn len(&self) -> usize {
        match self {
            Self::Vector(values) => values.len(),
            Self::Scalar(values) => values.len(),
            Self::U8(values) => values.len(),
            Self::U32(values) => values.len(),
        }
    }

    fn size(&self) -> usize {
        self.kinds().iter().map(|kind| kind.size() as usize).sum()
    }

    /// Writes the values of `particles` at `offset` of the rows of `stride` bytes.
    fn put(&self, rows: &mut [u8], stride: usize, offset: usize, particles: Range<usize>) {
        match self {
            Self::Vector(values) => put(rows, stride, offset, values[particles].iter().map(vector_bytes)),
            Self::Scalar(values) => {
                put(rows, stride, offset, values[particles].iter().map(|value| (*value as f32).to_le_bytes()));
            }
            Self::U8(values) => put(rows, stride, offset, values[particles].iter().map(|value| [*value])),
            Self::U32(values) => {
                put(rows, stride, offset, values[particles].iter().map(|value| value.to_le_bytes()));
            }
        }
    }
}

fn vector_bytes(vector: &DVec3) -> [u8; 12] {
    let mut bytes = [0; 12];
    bytes[..4].copy_from_slice(&(vector.x as f32).to_le_bytes());
    bytes[4..8].copy_from_slice(&(vector.y as f32).to_le_bytes());
    bytes[8..].copy_from_slice(&(vector.z as f32).to_le_bytes());
    bytes
}

fn put<const N: usize>(rows: &mut [u8], stride: usize, offset: usize, values: impl Iterator<Item = [u8; N]>) {
    for (row, value) in rows.chunks_exact_mut(stride).zip(values) {
        row[offset..offset + N].copy_from_slice(&value);
    }
}

/// A cloud of points as the writer keeps it: its message without the rows.
#[derive(Debug)]
pub(super) struct Points {
    pub channel: u16,
    pub sequence: u32,
    kinds: Vec<PointKind>,
    cloud: PointCloud,
}

impl Points {
    pub fn new(channel: u16, fields: &[PointField]) -> Self {
        let mut stride = 0;
        let mut packed = Vec::with_capacity(fields.len());
        for field in fields {
            let r#type = field.kind.numeric_type() as i32;
            packed.push(PackedElementField { name: field.name.to_owned(), offset: stride, r#type });
            stride += field.kind.size();
        }
        // Viewers take a pose that is left out for an invalid rotation, so the identity is spelled out.
        let identity = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
        let pose = Pose { position: Some(Vector3::default()), orientation: Some(identity) };
        let cloud = PointCloud {
            frame_id: FRAME.to_owned(),
            pose: Some(pose),
            point_stride: stride,
            fields: packed,
            ..PointCloud::default()
        };
        Self { channel, sequence: 0, kinds: fields.iter().map(|field| field.kind).collect(), cloud }
    }

    /// The message of one frame, written to `workspace`, or why the columns do not fit.
    pub fn encode<'w>(
        &mut self,
        timestamp: Timestamp,
        columns: &[Column],
        workspace: &'w mut Workspace,
    ) -> Result<&'w [u8], String> {
        if !columns.iter().flat_map(Column::kinds).eq(&self.kinds) {
            return Err("the columns of a point cloud are not those its topic was added with".to_owned());
        }
        let count = columns.first().map_or(0, Column::len);
        if columns.iter().any(|column| column.len() != count) {
            return Err("the columns of a point cloud differ in length".to_owned());
        }
        let stride = self.cloud.point_stride as usize;
        self.cloud.timestamp = Some(timestamp);
        let mut head = Vec::new();
        self.cloud.encode(&mut head).map_err(|error| error.to_string())?;
        // The rows, which are most of it, are packed where they are to be: the message has no `data` of its own.
        head.push(DATA_TAG);
        put_varint(&mut head, (count * stride) as u64);
        let message: &mut [u8] = workspace.values(head.len() + count * stride);
        let (start, rows) = message.split_at_mut(head.len());
        start.copy_from_slice(&head);
        for (index, block) in rows.chunks_mut(BLOCK * stride).enumerate() {
            let first = index * BLOCK;
            let particles = first..first + block.len() / stride;
            let mut offset = 0;
            for column in columns {
                column.put(block, stride, offset, particles.clone());
                offset += column.size();
            }
        }
        Ok(message)
    }
}

/// Number 6 of `foxglove.PointCloud`, its last field, `data`: bytes with their length before them.
const DATA_TAG: u8 = 6 << 3 | 2;

/// Seven bits a byte, the lowest first; all bytes but the last have the highest bit set.
fn put_varint(out: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}
