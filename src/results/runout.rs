//! How far a mass has come, and how high the water stood.

use super::Frame;

/// Where a phase is at one time, along a direction n.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Time (s).
    pub time: f64,
    /// x·n (m) of its foremost particle.
    pub front: f64,
    /// x·n (m) behind which 99 % of its particles are: the front of what holds together.
    pub bulk_front: f64,
    /// x·n (m) of its centre of mass; particles of a phase weigh the same but for the compression at the start.
    pub center: f64,
    /// x·n (m) of its last particle.
    pub rear: f64,
}

/// Share of a phase behind [`Extent::bulk_front`].
pub const BULK: f64 = 0.99;

impl Extent {
    /// The extent of a phase in a frame along the unit vector `direction`; `None` if the phase has no particle.
    #[must_use]
    pub fn of(frame: &Frame, phase: usize, direction: [f64; 3]) -> Option<Self> {
        let along = |x: [f64; 3]| x.iter().zip(direction).map(|(x, n)| x * n).sum::<f64>();
        let of_phase = frame.positions().zip(frame.values("phase")).filter(|(_, of)| **of == phase as f64);
        let mut places: Vec<f64> = of_phase.map(|(x, _)| along(x)).collect();
        places.sort_by(f64::total_cmp);
        let (rear, front) = (*places.first()?, *places.last()?);
        let bulk_front = places[((BULK * places.len() as f64).ceil() as usize).clamp(1, places.len()) - 1];
        let center = places.iter().sum::<f64>() / places.len() as f64;
        Some(Self { time: frame.time, front, bulk_front, center, rear })
    }
}

/// Width (spacings) of the columns of [`Envelope`].
pub const COLUMN: f64 = 4.0;

/// Part of a column by which places in a log are rounded.
const ROUNDING: f64 = 1e-4;

/// Highest and lowest elevation of the free surface, column by column, over the frames of a run.
///
/// The elevation of a column is the volume that it holds more than in the first frame, over its cross-section: `η_k = Σ_j (V_j w_k(x_j) −
/// V_j⁰ w_k(x_j⁰))/A`, with w_k the hat functions of columns [`COLUMN`] spacings apart along x (and, in space, along the other level axis). So it is exact to a fraction
/// of a spacing, spray counts with its volume only, and a slide under the water is water that it displaced. Columns that a wall cuts at the ends
/// of the fluid are left out. Where a wall or structure moves through a column, it is taken for water that is missing, and where it
/// leaves one, for water that has come.
///
/// `V_j = dp^d ρ_j⁰/ρ_j`: a particle fills its cell in the first frame.
#[derive(Debug, Clone)]
pub struct Envelope {
    /// Width (m) of columns.
    width: f64,
    dimension: usize,
    /// The axes that are level, those of the columns: x, and in space y or z.
    level: [usize; 2],
    spacing: f64,
    /// ρ (kg/m³) of each particle in the first frame, by its identity.
    densities: Vec<f64>,
    /// Number of the first column and how many there are along each level axis.
    first: [i64; 2],
    count: [usize; 2],
    /// Volume (m³; m² in 2D) of each column in the first frame.
    start: Vec<f64>,
    /// Of each column.
    extremes: Vec<Extremes>,
}

/// Extremes of the elevation of a column.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Extremes {
    /// Highest elevation (m), and its time (s).
    pub highest: (f64, f64),
    /// Lowest elevation (m), and its time (s).
    pub lowest: (f64, f64),
}

impl Envelope {
    /// The envelope from a first frame on, of a run with `spacing` (m) and the axis `up`.
    #[must_use]
    pub fn from(frame: &Frame, dimension: usize, up: usize, spacing: f64) -> Self {
        let level = [0, 3 - up];
        let width = COLUMN * spacing;
        let mut densities = Vec::new();
        for (id, rho) in frame.values("id").iter().zip(frame.values("density")) {
            let id = *id as usize;
            densities.resize(densities.len().max(id + 1), 0.0);
            densities[id] = *rho;
        }
        let (mut first, mut count) = ([0; 2], [1; 2]);
        for axis in 0..dimension - 1 {
            let places = frame.positions().map(|x| x[level[axis]]);
            let (least, greatest) =
                places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
            // A column reaches to the middles of those beside it. Where that is beyond the fluid, it is cut by a wall.
            let ends = [(least - 0.5 * spacing) / width, (greatest + 0.5 * spacing) / width];
            first[axis] = (ends[0] - ROUNDING).ceil() as i64 + 1;
            count[axis] = ((ends[1] + ROUNDING).floor() as i64 - first[axis]).max(0) as usize;
        }
        let extremes = vec![Extremes { highest: (0.0, frame.time), lowest: (0.0, frame.time) }; count[0] * count[1]];
        let mut envelope =
            Self { width, dimension, level, spacing, densities, first, count, start: Vec::new(), extremes };
        envelope.start = envelope.volumes(frame);
        envelope
    }

    /// Volume of each column.
    fn volumes(&self, frame: &Frame) -> Vec<f64> {
        let cell = self.spacing.powi(self.dimension as i32);
        let mut volumes = vec![0.0; self.count[0] * self.count[1]];
        for ((x, id), rho) in frame.positions().zip(frame.values("id")).zip(frame.values("density")) {
            let volume = self.densities.get(*id as usize).map_or(0.0, |start| cell * start / rho);
            for (i, along_x) in self.hats(x, 0) {
                for (j, along_y) in self.hats(x, 1) {
                    volumes[j * self.count[0] + i] += volume * along_x * along_y;
                }
            }
        }
        volumes
    }

    /// The columns along the level axis number `axis` in which `x` counts, and how much.
    fn hats(&self, x: [f64; 3], axis: usize) -> impl Iterator<Item = (usize, f64)> {
        let place = x[self.level[axis]] / self.width;
        let (left, share) = (place.floor() as i64, place - place.floor());
        let both =
            if axis + 1 < self.dimension { [(left, 1.0 - share), (left + 1, share)] } else { [(0, 1.0), (-1, 0.0)] };
        let (first, count) = (self.first[axis], self.count[axis]);
        both.into_iter().filter_map(move |(column, share)| {
            let column = usize::try_from(column - first).ok()?;
            (column < count).then_some((column, share))
        })
    }

    /// Enters a frame.
    pub fn enter(&mut self, frame: &Frame) {
        let area = self.width.powi(self.dimension as i32 - 1);
        for ((now, start), extremes) in self.volumes(frame).iter().zip(&self.start).zip(&mut self.extremes) {
            let elevation = (now - start) / area;
            if elevation > extremes.highest.0 {
                extremes.highest = (elevation, frame.time);
            }
            if elevation < extremes.lowest.0 {
                extremes.lowest = (elevation, frame.time);
            }
        }
    }

    /// Place (x and the other level coordinate in m; 0 in 2D) and extremes of each column.
    pub fn columns(&self) -> impl Iterator<Item = ([f64; 2], Extremes)> {
        let [first_x, first_y] = self.first;
        self.extremes.iter().enumerate().map(move |(k, extremes)| {
            let (i, j) = ((k % self.count[0]) as i64, (k / self.count[0]) as i64);
            ([(first_x + i) as f64 * self.width, (first_y + j) as f64 * self.width], *extremes)
        })
    }

    /// Highest and lowest elevation (m) over x (m); in space the extremes over the other level axis.
    #[must_use]
    pub fn along_x(&self) -> [Vec<[f64; 2]>; 2] {
        let mut curves = [Vec::new(), Vec::new()];
        for i in (0..self.count[0]).take_while(|_| !self.extremes.is_empty()) {
            let of_column = || self.extremes.iter().skip(i).step_by(self.count[0]);
            let x = (self.first[0] + i as i64) as f64 * self.width;
            curves[0].push([x, of_column().map(|e| e.highest.0).fold(f64::NEG_INFINITY, f64::max)]);
            curves[1].push([x, of_column().map(|e| e.lowest.0).fold(f64::INFINITY, f64::min)]);
        }
        curves
    }
}

/// The height (m) of the centre of a phase in a frame, along the axis `up`.
#[must_use]
pub fn center_height(frame: &Frame, phase: usize, up: usize) -> Option<f64> {
    let mut direction = [0.0; 3];
    direction[up] = 1.0;
    Extent::of(frame, phase, direction).map(|extent| extent.center)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::super::FrameField;
    use super::*;

    const SPACING: f64 = 0.02;

    /// Water 2 m long and 0.4 m deep, moved by `place`, compressed by `beta`.
    fn water(time: f64, beta: f64, place: impl Fn(f64, f64) -> [f64; 2]) -> Frame {
        let cells = (0..100 * 20).map(|k| (SPACING * (f64::from(k % 100) + 0.5), SPACING * (f64::from(k / 100) + 0.5)));
        let places: Vec<[f64; 2]> = cells.map(|(x, y)| place(x, y)).collect();
        let field = |name: &str, values: Vec<f64>| FrameField {
            name: name.into(),
            unit: String::new(),
            is_whole: false,
            values,
        };
        let count = places.len();
        let fields = vec![
            field("x", places.iter().map(|place| place[0]).collect()),
            field("y", places.iter().map(|place| place[1]).collect()),
            field("phase", vec![0.0; count]),
            field("density", vec![1000.0 * beta; count]),
            field("id", (0..count).map(|k| k as f64).collect()),
        ];
        Frame { time, fields, count }
    }

    #[test]
    fn extents_are_those_of_the_particles() {
        let frame = water(1.5, 1.0, |x, y| [x, y]);
        let extent = Extent::of(&frame, 0, [1.0, 0.0, 0.0]).unwrap();
        let near = |value: f64, exact: f64| assert!((value - exact).abs() < 1e-12, "{value} {exact}");
        near(extent.front, 1.99);
        near(extent.rear, 0.01);
        near(extent.center, 1.0);
        // One column of a hundred lies farther.
        near(extent.bulk_front, 1.97);
        near(center_height(&frame, 0, 1).unwrap(), 0.2);
        assert!(Extent::of(&frame, 1, [1.0, 0.0, 0.0]).is_none());
    }

    /// A wave that is made by moving water along, as waves are: x + ξ(x), with η = −h dξ/dx of the long wave.
    #[test]
    fn the_envelope_of_a_standing_wave_is_its_amplitude() {
        let (depth, length, amplitude) = (0.4, 2.0, 0.01);
        let k = TAU / length;
        let mut envelope = Envelope::from(&water(0.0, 1.0, |x, y| [x, y]), 2, 1, SPACING);
        for step in 0..=40 {
            let phase = TAU * f64::from(step) / 40.0;
            let displaced = |x: f64, y: f64| [x - amplitude / (depth * k) * (k * x).sin() * phase.sin(), y];
            envelope.enter(&water(phase, 1.0, displaced));
        }
        for ([x, _], extremes) in envelope.columns() {
            let exact = amplitude * (k * x).cos().abs();
            for found in [extremes.highest.0, -extremes.lowest.0] {
                // The displaced water is not linear: (η/h)² is 2.5 % of it; hats take off (kw)²/12.
                assert!((found - exact).abs() < 0.05 * amplitude, "{x} m: {found} m, exact {exact}");
            }
        }
        let [highest, lowest] = envelope.along_x();
        // 2 m are 25 columns of 0.08 m; the first and the last of those between the walls reach up to them.
        assert!(highest.len() == lowest.len() && highest.len() == 24);
    }

    /// Wherever the walls stand, no column that counts reaches beyond them.
    #[test]
    fn columns_that_a_wall_cuts_are_left_out() {
        for offset in [0.0, 0.01, 0.035, 0.07] {
            let moved = |up: f64| water(up, 1.0 / (1.0 + up), move |x, y| [x + offset, y]);
            let mut envelope = Envelope::from(&moved(0.0), 2, 1, SPACING);
            envelope.enter(&moved(0.1));
            for ([x, _], extremes) in envelope.columns() {
                // A tenth more volume in every column.
                assert!((extremes.highest.0 - 0.04).abs() < 1e-9, "{offset} m, at {x} m: {} m", extremes.highest.0);
            }
        }
    }

    #[test]
    fn water_that_is_compressed_stands_lower() {
        let mut envelope = Envelope::from(&water(0.0, 1.0, |x, y| [x, y]), 2, 1, SPACING);
        envelope.enter(&water(1.0, 1.01, |x, y| [x, y]));
        for (_, extremes) in envelope.columns() {
            assert!((extremes.lowest.0 + 0.4 * (1.0 - 1.0 / 1.01)).abs() < 1e-12);
            assert_eq!(extremes.highest, (0.0, 0.0));
        }
    }

    /// A block 1 m long, 0.2 m deep along y and 0.6 m wide, whose density falls by a tenth: it stands 0.02 m higher, not 0.06.
    #[test]
    fn up_may_be_y_in_space() {
        let block = |rho: f64| {
            let places: Vec<[usize; 3]> = (0..50 * 10 * 30).map(|k| [k % 50, k / 50 % 10, k / 500]).collect();
            let axis = |of: usize| places.iter().map(|place| SPACING * (place[of] as f64 + 0.5)).collect();
            let count = places.len();
            let fields = [
                ("x", axis(0)),
                ("y", axis(1)),
                ("z", axis(2)),
                ("phase", vec![0.0; count]),
                ("density", vec![rho; count]),
                ("id", (0..count).map(|k| k as f64).collect()),
            ];
            let fields = fields.map(|(name, values)| FrameField {
                name: name.into(),
                unit: String::new(),
                is_whole: false,
                values,
            });
            Frame { time: 0.0, fields: fields.into(), count }
        };
        let mut envelope = Envelope::from(&block(1100.0), 3, 1, SPACING);
        envelope.enter(&block(1000.0));
        assert!(envelope.columns().count() > 10);
        for (place, extremes) in envelope.columns() {
            assert!((extremes.highest.0 - 0.02).abs() < 1e-9, "{place:?}: {} m", extremes.highest.0);
        }
        assert!((center_height(&block(1000.0), 0, 1).unwrap() - 0.1).abs() < 1e-12);
    }
}
