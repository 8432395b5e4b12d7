//! Files that ParaView opens: one `.vtp` (VTK's XML for points) a frame, and a `.pvd` that strings them together in time.
//!
//! The numbers follow the XML as they are, little endian, in blocks compressed by zlib (VTK file formats, "XML File Formats", appended
//! raw data).

use std::fmt::Write as _;
use std::io::{self, Write};

use flate2::Compression;
use flate2::write::ZlibEncoder;

use super::Frame;

/// Bytes of a block before compression.
const BLOCK: usize = 1 << 17;

/// Writes the particles of a frame to `out`: their fields by name, `velocity` as a vector, the time, and the units.
///
/// # Errors
/// What `out` says.
pub fn write_points(frame: &Frame, out: &mut impl Write) -> io::Result<()> {
    let mut arrays = Arrays::default();
    let mut point_data = String::new();
    for field in &frame.fields {
        match field.name.as_str() {
            "x" | "y" | "z" | "vx" | "vy" | "vz" => {}
            name if field.is_whole => {
                let values = field.values.iter().flat_map(|value| (*value as i32).to_le_bytes());
                point_data += &arrays.add("Int32", name, 1, values.collect())?;
            }
            name => point_data += &arrays.add("Float32", name, 1, floats(field.values.iter().copied()))?,
        }
    }
    point_data += &arrays.add("Float32", "velocity", 3, floats(frame.velocities().flatten()))?;
    let points = arrays.add("Float32", "Points", 3, floats(frame.positions().flatten()))?;
    // Each point is a vertex of its own: what has no cells is not shown.
    let whole = |numbers: std::ops::Range<i32>| numbers.flat_map(i32::to_le_bytes).collect();
    let count = i32::try_from(frame.count).map_err(|_| io::Error::other("too many particles for a file of VTK"))?;
    let vertices = arrays.add("Int32", "connectivity", 1, whole(0..count))?
        + &arrays.add("Int32", "offsets", 1, whole(1..count + 1))?;
    write!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>\n<FieldData>\n\
         <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n\
         <DataArray type=\"String\" Name=\"units\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n</FieldData>\n\
         <Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"{count}\">\n<PointData>\n{point_data}</PointData>\n\
         <Points>\n{points}</Points>\n<Verts>\n{vertices}</Verts>\n</Piece>\n</PolyData>\n\
         <AppendedData encoding=\"raw\">\n_",
        frame.time,
        codes(&units(frame)),
    )?;
    out.write_all(&arrays.bytes)?;
    out.write_all(b"\n</AppendedData>\n</VTKFile>\n")
}

/// Writes the `.pvd` of files at times (s) to `out`.
///
/// # Errors
/// What `out` says.
pub fn write_collection<'a>(files: impl IntoIterator<Item = (f64, &'a str)>, out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">"
    )?;
    writeln!(out, "<Collection>")?;
    for (time, file) in files {
        writeln!(out, "<DataSet timestep=\"{time}\" part=\"0\" file=\"{}\"/>", escaped(file))?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}

/// Arrays that follow the XML.
#[derive(Default)]
struct Arrays {
    bytes: Vec<u8>,
}

impl Arrays {
    /// Appends an array and returns the element that tells of it.
    fn add(&mut self, kind: &str, name: &str, components: usize, values: Vec<u8>) -> io::Result<String> {
        let offset = self.bytes.len();
        let blocks = values.chunks(BLOCK).map(|block| {
            let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
            encoder.write_all(block)?;
            encoder.finish()
        });
        let blocks = blocks.collect::<io::Result<Vec<_>>>()?;
        // How many blocks, how long they are, how long the last is if it is shorter, and how long each is when compressed.
        let head = [blocks.len(), BLOCK, values.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
        self.bytes.extend(head.flat_map(|number| (number as u64).to_le_bytes()));
        blocks.iter().for_each(|block| self.bytes.extend_from_slice(block));
        Ok(format!(
            "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>\n",
            escaped(name)
        ))
    }
}

fn floats(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(|value| (value as f32).to_le_bytes()).collect()
}

/// `pressure: Pa, velocity: m/s, …`.
fn units(frame: &Frame) -> String {
    let own = frame
        .fields
        .iter()
        .filter(|field| !field.unit.is_empty() && !["x", "y", "z", "vx", "vy", "vz"].contains(&field.name.as_str()));
    own.fold("Points: m, velocity: m/s".to_owned(), |mut text, field| {
        let _ = write!(text, ", {}: {}", field.name, field.unit);
        text
    })
}

/// A text as VTK writes it in XML: the numbers of its bytes, and a 0.
fn codes(text: &str) -> String {
    text.bytes().chain([0]).map(|byte| format!("{byte} ")).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
