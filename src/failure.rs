//! What happens when a system fails: the run ends in order, with its log closed, and says which system it was.

use std::cell::RefCell;

use bevy_ecs::error::{BevyError, ErrorContext, FallbackErrorHandler};
use bevy_ecs::prelude::*;
use bevy_ecs::schedule::{InternedScheduleLabel, ScheduleLabel};

use crate::schedule::{Output, Step};

thread_local! {
    // The handler is a plain function. Schedules run their systems on the thread that runs the schedule.
    static FAILURE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Makes `world` note the first error of a system instead of panicking.
pub(crate) fn install(world: &mut World) {
    world.insert_resource(FallbackErrorHandler(note));
}

fn note(error: BevyError, context: ErrorContext) {
    let what = format!("the {} `{}`: {error}", context.kind(), context.name());
    FAILURE.with_borrow_mut(|failure| failure.get_or_insert(what).len());
}

/// The first failure since this was last asked.
pub(crate) fn take() -> Option<String> {
    FAILURE.take()
}

/// Builds the schedules of `world`, or says which systems write the same data without an order, or what else is wrong.
pub(crate) fn build_schedules(world: &mut World) -> Result<(), String> {
    let labels: [InternedScheduleLabel; 2] = [Step.intern(), Output.intern()];
    labels.into_iter().try_for_each(|label| {
        world.schedule_scope(label, |world, schedule| match schedule.initialize(world) {
            Ok(_) => Ok(()),
            Err(error) => Err(error.to_string(schedule.graph(), world)),
        })
    })
}
