//! The channel `/turbidity` of the log.

use bevy_ecs::prelude::*;
use storegga::clock::Clock;
use storegga::outputs::{OutputKind, OutputTimes};
use storegga::particles::{Fluid, Mass, Position};
use storegga::probes::{Series, SeriesField};

use crate::FineSediment;

/// Name of the series: what `expect` calls it, as in `of: "turbidity.mass"`.
const NAME: &str = "turbidity";

/// An empty series; every entity with one becomes a channel.
pub fn series() -> Series {
    let fields = vec![
        SeriesField::new("mass", "kg", "fine sediment in suspension (per metre of length in 2D)"),
        SeriesField::new("greatest", "kg/kg", "greatest mass fraction of a particle"),
        SeriesField::new("height", "m", "height y of the centre of mass of the fine sediment"),
    ];
    Series::new(NAME, "/turbidity", "fine sediment in suspension", fields)
}

/// Appends a row whenever series are due.
pub fn measure(
    clock: Res<Clock>,
    outputs: Res<OutputTimes>,
    fluid: Query<(&Position, &Mass, &FineSediment), With<Fluid>>,
    mut series: Query<&mut Series>,
) {
    let Some(mut series) = series.iter_mut().find(|series| series.name == NAME) else { return };
    if !outputs.due(OutputKind::Series) {
        return;
    }
    let (mut mass, mut greatest, mut moment) = (0.0, 0.0_f64, 0.0);
    for (x, m, c) in &fluid {
        mass += m.0 * c.0;
        greatest = greatest.max(c.0);
        moment += m.0 * c.0 * x.0.y;
    }
    series.push(clock.time, &[mass, greatest, moment / mass]);
}
