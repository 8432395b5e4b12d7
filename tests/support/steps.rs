//! A run of so many steps.

use bevy_ecs::prelude::*;
use storegga::app::{End, StopFlag, run};
use storegga::clock::Clock;

/// Runs `steps` steps.
pub fn advance(world: &mut World, steps: u64) {
    let last = world.resource::<Clock>().step + steps;
    let stop = StopFlag::default();
    let watched = stop.clone();
    let end = run(world, f64::INFINITY, &stop, |clock| {
        if clock.step >= last {
            watched.stop();
        }
    });
    assert_eq!(end, End::Interrupted);
}
