//! The arguments of the commands that show what is in logs.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::results::Frame;

/// Which frames of a log.
#[derive(Debug, Clone, Args)]
pub(super) struct Frames {
    /// Only frames from this simulated time (s) on.
    #[arg(long, value_name = "SECONDS")]
    pub from: Option<f64>,
    /// Only frames up to this simulated time (s).
    #[arg(long, value_name = "SECONDS")]
    pub to: Option<f64>,
    /// Only every so many-th frame.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
}

impl Frames {
    /// Whether frame `number` of those at `times` (s) is meant.
    pub fn take(&self, times: &[f64], number: usize) -> bool {
        // Times in a log are rounded to nanoseconds.
        const ROUNDING: f64 = 1e-9;
        let Some(time) = times.get(number) else { return false };
        let first = times.iter().position(|time| self.from.is_none_or(|from| *time >= from - ROUNDING));
        let is_beat =
            first.is_some_and(|first| number >= first && (number - first).is_multiple_of(self.every as usize));
        is_beat && self.to.is_none_or(|to| *time <= to + ROUNDING)
    }
}

/// Arguments of `storegga export`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga export runs/submarine_slide.mcap --vtk runs/paraview
  storegga export runs/submarine_slide.mcap --vtk runs/paraview --from 0.4 --to 0.8 --every 2

ParaView opens runs/paraview/particles.pvd, walls.pvd and structures.pvd; the representation `Point Gaussian` shows particles as
discs. Python reads them with pyvista. Units are those of the log, SI; each file names them in its field data.")]
pub(super) struct ExportArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Folder for the files of VTK: a .vtp for each frame, and a .pvd for particles, walls and structures. It is made if it
    /// does not exist.
    #[arg(long, value_name = "DIR")]
    pub vtk: PathBuf,
    #[command(flatten)]
    pub frames: Frames,
}

/// Arguments of `storegga plot`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga plot runs/submarine_slide.mcap
  storegga plot runs/submarine_slide.mcap --field pressure --at 0.4,0.6,0.8 --format both
  storegga plot runs/submarine_slide.mcap --field phase --arrows --at 0.8
  storegga plot runs/submarine_slide.mcap --series front.velocity --series books
  storegga plot runs/submarine_slide.mcap --profile surface:slide --at 0.4,0.8
  storegga plot runs/two_phase_tank.mcap --profile pressure:x=0.2
  storegga plot runs/zhou_teng.mcap --series g1.height --reference measured.csv:t_s,g1_m

With none of --field, --series and --profile: pressure, speed and phase of the last frame, and every series.
Fields are those of the log (`storegga doctor` lists them), and speed. Viscosity has a logarithmic scale.
A scale of colours leaves out the 0.2 % of particles at each end, unless --range is given.
A reference is compared with by R² = 1 - Σ(y-ŷ)²/Σ(y-ȳ)² (Eq. 22) and L2 = √(Σ(y-ŷ)²/Σy²) (Eq. 20) at its own points, or at so many as
--points asks for, at equal distances.")]
pub(super) struct PlotArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Particles coloured by this quantity, such as pressure, speed, density, viscosity, shear_rate, phase, vx; can be given again and
    /// again.
    #[arg(long = "field", value_name = "NAME")]
    pub fields: Vec<String>,
    /// Simulated times (s) of fields and profiles: the nearest frames are drawn, below one another. The last frame if left out.
    #[arg(long, value_name = "SECONDS", value_delimiter = ',')]
    pub at: Vec<f64>,
    #[command(flatten)]
    pub look: Look,
    /// A series over time: its name, or its name and one of its quantities, such as front.velocity; can be given again and again.
    #[arg(long, value_name = "NAME[.QUANTITY]")]
    pub series: Vec<String>,
    /// A profile: the upper surface of a phase, surface:slide, or a field along a line, pressure:x=0.2 (m); can be given again and again.
    #[arg(long = "profile", value_name = "WHAT:WHERE")]
    pub profiles: Vec<String>,
    /// A CSV file to compare the one series or profile with: its first two columns, or those named behind a colon.
    #[arg(long, value_name = "FILE[:X,Y]")]
    pub reference: Option<String>,
    /// Compare with the reference at so many points at equal distances, such as the paper's 35.
    #[arg(long, value_name = "N", requires = "reference", value_parser = points)]
    pub points: Option<usize>,
    /// Folder for the figures; by default plots/<log>. It is made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// File format.
    #[arg(long, value_enum, default_value_t)]
    pub format: PictureFormat,
}

/// Arguments of `storegga forces`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga forces runs/cylinder_drag.mcap --velocity 0.2 --width 0.1 --phase water --steady 2,3
  storegga forces runs/pipe_impact.mcap --velocity 2 --width 0.05 --phase mud --window 0.1,0.4
  storegga forces runs/rotating_flume.mcap --arm 0.8 --velocity 0.38 --width 0.02 --phase sand --cutoff 5 --window 5.4,8.7 --steady 7.2,8.6

Forces are those of the log: of the fluid on the structure, in 2D per metre where the scene gives it no length.
C = F/(½ρU²A), with A = D times the structure's length (1 m where it has none). Re = ρU²/τ with τ of the phase at γ̇ = U/D.
Each component is drawn, raw and filtered.")]
pub(super) struct ForcesArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Name of the structure; can be left out where there is one only.
    #[arg(long, value_name = "NAME")]
    pub structure: Option<String>,
    /// Direction of drag; lift is to its left, in 2D. Along x if left out.
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = vector)]
    pub direction: Option<[f64; 3]>,
    /// Of a structure that turns about the point to which its moment refers: its distance (m) from there. The force along its path
    /// is the moment over it.
    #[arg(long, value_name = "METRES", conflicts_with = "direction", value_parser = positive)]
    pub arm: Option<f64>,
    /// Velocity U (m/s) of the flow, for coefficients.
    #[arg(long, value_name = "M/S", requires = "width", value_parser = positive)]
    pub velocity: Option<f64>,
    /// Width D (m) of the structure across the flow.
    #[arg(long, value_name = "METRES", requires = "velocity", value_parser = positive)]
    pub width: Option<f64>,
    /// Frontal area A (m²), where it is not D times the length.
    #[arg(long, value_name = "M2", requires = "velocity", value_parser = positive)]
    pub area: Option<f64>,
    /// Phase whose density and rheology count.
    #[arg(long, value_name = "NAME", requires = "velocity")]
    pub phase: Option<String>,
    /// Density ρ (kg/m³), where it is not that of the phase; 1000 if there is no phase.
    #[arg(long, value_name = "KG/M3", requires = "velocity", value_parser = positive)]
    pub density: Option<f64>,
    /// Cutoff (Hz) of the filter; a twentieth of the rate of sampling if left out.
    #[arg(long, value_name = "HZ", value_parser = positive)]
    pub cutoff: Option<f64>,
    /// Times (s) between which peaks and the impulse are taken; the whole record if left out. Past a start from rest that jolts, say.
    #[arg(long, value_name = "FROM,TO", value_parser = range)]
    pub window: Option<(f64, f64)>,
    /// Times (s) between which the mean is taken; the second half of the window if left out.
    #[arg(long, value_name = "FROM,TO", value_parser = range)]
    pub steady: Option<(f64, f64)>,
    /// Folder for the figures; by default plots/<log>. It is made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// File format.
    #[arg(long, value_enum, default_value_t)]
    pub format: PictureFormat,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| "expected a number greater than 0".to_owned())
}

fn vector(text: &str) -> Result<[f64; 3], String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(str::parse).collect();
    let vector = match numbers.as_deref() {
        Ok([x, y]) => [*x, *y, 0.0],
        Ok([x, y, z]) => [*x, *y, *z],
        _ => [0.0; 3],
    };
    let is_some = vector.iter().any(|component| *component != 0.0) && vector.iter().all(|x| x.is_finite());
    if is_some { Ok(vector) } else { Err("expected two or three numbers, not all 0, such as 1,0".to_owned()) }
}

/// How particles are shown.
#[derive(Debug, Clone, Copy, Args)]
pub(super) struct Look {
    /// Draw arrows of the mean velocity over fields.
    #[arg(long)]
    pub arrows: bool,
    /// Least and greatest value of the scale of colours, in the unit of the field.
    #[arg(long, value_name = "LEAST,GREATEST", value_parser = range, allow_hyphen_values = true)]
    pub range: Option<(f64, f64)>,
    /// Plane of the picture; in space the nearest particles hide those behind. By default xy in the plane; in space xz, or xy where gravity acts along y.
    #[arg(long, value_enum)]
    pub view: Option<View>,
}

/// Arguments of `storegga movie`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga movie runs/submarine_slide.mcap
  storegga movie runs/submarine_slide.mcap --field speed --arrows --fps 10 --out slide.png
  ffmpeg -i plots/submarine_slide/phase_movie.png slide.mp4

The animation is an APNG, which browsers and most viewers of pictures show; ffmpeg makes other formats of it.")]
pub(super) struct MovieArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Particles are coloured by this quantity; by default by their phase if there are several, else by speed.
    #[arg(long, value_name = "NAME")]
    pub field: Option<String>,
    #[command(flatten)]
    pub frames: Frames,
    #[command(flatten)]
    pub look: Look,
    /// Frames of the log shown in a second.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub fps: u16,
    /// File, whose name ends in .png or .apng; by default plots/<log>/<field>_movie.png. Its folder is made if it does not exist.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

fn range(text: &str) -> Result<(f64, f64), String> {
    let ends = text.split_once(',').and_then(|(least, greatest)| Some((least.parse().ok()?, greatest.parse().ok()?)));
    let ends =
        ends.filter(|(least, greatest): &(f64, f64)| least < greatest && least.is_finite() && greatest.is_finite());
    ends.ok_or_else(|| "expected two numbers, the lower one first, such as 0,15000".to_owned())
}

fn points(text: &str) -> Result<usize, String> {
    text.parse()
        .ok()
        .filter(|n| (2..=1_000_000).contains(n))
        .ok_or_else(|| "expected a number from 2 on, such as 35".to_owned())
}

/// Format of figures.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(super) enum PictureFormat {
    /// Pixels, 200 to an inch of a page.
    #[default]
    Png,
    /// Lines and letters that stay sharp.
    Svg,
    /// Both.
    Both,
}

impl PictureFormat {
    /// Endings of the names of files.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Svg => &["svg"],
            Self::Both => &["png", "svg"],
        }
    }
}

/// Plane of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum View {
    /// x to the right, y up.
    Xy,
    /// x to the right, z up, seen against y.
    Xz,
    /// y to the right, z up, seen against x.
    Yz,
}

impl View {
    /// Axes to the right, up and away from the eye.
    const fn indices(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Xz => [0, 2, 1],
            Self::Yz => [1, 2, 0],
        }
    }

    /// Names of the axes to the right and up.
    pub fn axes(self) -> [&'static str; 2] {
        let [right, up, _] = self.indices();
        [right, up].map(|axis| ["x", "y", "z"][axis])
    }

    /// A vector in the picture.
    pub fn flat(self, vector: [f64; 3]) -> [f64; 2] {
        let [right, up, _] = self.indices();
        [vector[right], vector[up]]
    }

    /// Numbers of the particles, the farthest from the eye first. It looks along y or against x and z: what is nearest is at the
    /// front of a scene.
    pub fn behind_first(self, frame: &Frame) -> Vec<usize> {
        let away = self.indices()[2];
        let sign = if self == Self::Xz { -1.0 } else { 1.0 };
        let depths: Vec<f64> = frame.positions().map(|x| sign * x[away]).collect();
        let mut order: Vec<usize> = (0..frame.count).collect();
        order.sort_by(|a, b| depths[*a].total_cmp(&depths[*b]));
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_from_the_first_that_is_wanted() {
        let times = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5];
        let taken = |frames: Frames| (0..7).filter(|k| frames.take(&times, *k)).collect::<Vec<_>>();
        assert_eq!(taken(Frames { from: None, to: None, every: 1 }), [0, 1, 2, 3, 4, 5]);
        assert_eq!(taken(Frames { from: Some(0.1), to: Some(0.4), every: 2 }), [1, 3]);
        assert!(taken(Frames { from: Some(0.6), to: None, every: 1 }).is_empty());
    }
}

/// Arguments of `storegga runout`.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  storegga runout runs/submarine_slide.mcap --phase slide
  storegga runout runs/submarine_slide.mcap --phase slide --direction 1,-1 --out runs/slide

It draws front, centre of mass and rear over time, the upper surface at the start and at the end, and the highest and lowest elevation of
the free surface over x, and writes the same numbers as CSV. It sees the frames of the log (`log: (particles: ...)` of the scene).")]
pub(super) struct RunoutArgs {
    /// Log, whole or torn.
    pub log: PathBuf,
    /// Phase that slides; can be left out where there is one only.
    #[arg(long, value_name = "NAME")]
    pub phase: Option<String>,
    /// Direction in which it slides. Along x if left out.
    #[arg(long, value_name = "X,Y[,Z]", allow_hyphen_values = true, value_parser = vector)]
    pub direction: Option<[f64; 3]>,
    /// Folder for figures and tables; by default plots/<log>. It is made if it does not exist.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// File format.
    #[arg(long, value_enum, default_value_t)]
    pub format: PictureFormat,
}
