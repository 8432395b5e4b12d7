//! How well a result fits a reference.

/// A result beside a reference y_i at n points, the result ŷ_i linear between its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// `R² = 1 − Σ (y_i − ŷ_i)²/Σ (y_i − ȳ)²` (Eq. 22): 1 where they are the same, 0 where the mean of the reference would do as well.
    pub r_squared: f64,
    /// `L₂ = √(Σ (y_i − ŷ_i)²/Σ y_i²)` (Eq. 20).
    pub l2: f64,
    /// n.
    pub points: usize,
}

impl Fit {
    /// Compares at the points of the reference that lie within the result, or at `count` points at equal distances over what both have,
    /// the reference linear between its own.
    ///
    /// # Errors
    /// Why they cannot be compared.
    pub fn of(reference: &[[f64; 2]], result: &[[f64; 2]], count: Option<usize>) -> Result<Self, String> {
        let ends = |points: &[[f64; 2]]| Some((points.first()?[0], points.last()?[0]));
        let (Some((a, b)), Some((c, d))) = (ends(reference), ends(result)) else {
            return Err("there is nothing to compare".to_owned());
        };
        let (from, to) = (a.max(c), b.min(d));
        let places: Vec<f64> = match count {
            Some(count) => (0..count).map(|k| from + (to - from) * k as f64 / (count.max(2) - 1) as f64).collect(),
            None => reference.iter().map(|point| point[0]).filter(|place| (from..=to).contains(place)).collect(),
        };
        if places.len() < 2 || from >= to {
            return Err("the reference and the result have fewer than two points in common".to_owned());
        }
        let pairs: Vec<(f64, f64)> =
            places.iter().map(|place| (linear(reference, *place), linear(result, *place))).collect();
        let mean = pairs.iter().map(|(y, _)| y).sum::<f64>() / pairs.len() as f64;
        let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
        let error = sum(&|(y, found)| (y - found).powi(2));
        Ok(Self {
            r_squared: 1.0 - error / sum(&|(y, _)| (y - mean).powi(2)),
            l2: (error / sum(&|(y, _)| y * y)).sqrt(),
            points: pairs.len(),
        })
    }
}

/// The value at `place` on the broken line through `points`, which are in order; beyond its ends that of the end.
fn linear(points: &[[f64; 2]], place: f64) -> f64 {
    let after = points.partition_point(|point| point[0] < place).clamp(1, points.len() - 1);
    let ([x0, y0], [x1, y1]) = (points[after - 1], points[after]);
    let share = if x1 > x0 { ((place - x0) / (x1 - x0)).clamp(0.0, 1.0) } else { 1.0 };
    y0 + share * (y1 - y0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_curve_fits_whatever_its_points() {
        let line = |n: usize| (0..=n).map(|k| [k as f64 / n as f64, 3.0 - k as f64 / n as f64]).collect::<Vec<_>>();
        for count in [None, Some(35)] {
            let fit = Fit::of(&line(7), &line(10), count).expect("they overlap");
            assert!((fit.r_squared - 1.0).abs() < 1e-14 && fit.l2 < 1e-14, "{fit:?}");
            assert_eq!(fit.points, count.unwrap_or(8));
        }
    }

    #[test]
    fn the_mean_of_the_reference_has_no_r_squared() {
        let reference = [[0.0, 1.0], [1.0, 2.0], [2.0, 3.0]];
        let fit = Fit::of(&reference, &[[0.0, 2.0], [2.0, 2.0]], None).expect("they overlap");
        assert!(fit.r_squared.abs() < 1e-15);
        // √((1 + 0 + 1)/(1 + 4 + 9))
        assert!((fit.l2 - (2.0_f64 / 14.0).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn what_does_not_overlap_is_not_compared() {
        assert!(Fit::of(&[[0.0, 1.0], [1.0, 2.0]], &[[2.0, 1.0], [3.0, 2.0]], None).is_err());
        assert!(Fit::of(&[], &[[2.0, 1.0], [3.0, 2.0]], Some(35)).is_err());
    }
}
