//! How long a study will go on.

/// Estimated time (s) that is left: `done` has the estimated and the measured duration (s) of runs that have ended, `running` the
/// estimated one and that so far, `waiting` the estimated ones, of which `jobs` go on at once.
///
/// Estimates are scaled by what those that have ended took.
#[must_use]
pub fn time_left(done: &[(f64, f64)], running: &[(f64, f64)], waiting: &[f64], jobs: usize) -> f64 {
    let (estimated, measured) = done.iter().fold((0.0, 0.0), |sum, run| (sum.0 + run.0, sum.1 + run.1));
    let scale = if estimated > 0.0 && measured > 0.0 { measured / estimated } else { 1.0 };
    let rest = |(estimate, so_far): &(f64, f64)| (scale * estimate - so_far).max(0.0);
    let work = running.iter().map(rest).sum::<f64>() + scale * waiting.iter().sum::<f64>();
    let longest = running.iter().map(rest).chain(waiting.iter().map(|estimate| scale * estimate));
    longest.fold(work / jobs.max(1) as f64, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_are_scaled_by_what_was_measured() {
        // Runs take twice as long as estimated.
        assert_eq!(time_left(&[(1.0, 2.0), (3.0, 6.0)], &[], &[5.0], 1), 10.0);
        assert_eq!(time_left(&[], &[(4.0, 1.0)], &[2.0, 2.0], 1), 7.0);
        assert_eq!(time_left(&[], &[(4.0, 9.0)], &[2.0, 2.0], 2), 2.0);
        assert_eq!(time_left(&[], &[], &[], 1), 0.0);
        // The longest one cannot be parted.
        assert_eq!(time_left(&[], &[], &[10.0, 1.0, 1.0], 8), 10.0);
    }
}
