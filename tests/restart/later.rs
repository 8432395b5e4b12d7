//! Runs that have ended go on to a later end.

use crate::program::Folder;
use crate::{Left, RESUME, RUN, kill};

/// A run that has ended goes on to a later end as one run to that end does, wherever the first end lay between its steps.
#[test]
fn a_run_that_ended_goes_on_to_a_later_end_with_the_same_bits() {
    let folder = Folder::stream("later", 2);
    let until = |seconds: &'static str| folder.run(&[&RUN[..], &["--until", seconds]].concat());
    let resume = |seconds: &'static str| folder.run(&[&RESUME[..], &["--until", seconds]].concat());
    let reference = Left::of(&folder, &until("0.06"));
    let beyond = Left::of(&folder, &until("0.12"));
    // An output, a moment before one, and in the midst of steps.
    for first in ["0.02", "0.0199999999", "0.0213", "0.04371"] {
        until(first).ended_with(0);
        let mut extended = Left::of(&folder, &resume("0.06"));
        // The log says that it was asked to run to the first end, and then that it was asked to run to the second.
        let asked = |record: &String| record.contains("until [s]");
        let ends = extended.others.iter().filter(|record| asked(record)).cloned().collect::<Vec<_>>();
        assert!(ends.len() == 2 && ends[0].contains(first) && ends[1].contains("0.06"), "{ends:?}");
        extended.others = reference.others.clone();
        extended.is(&reference, first);
        assert_eq!(folder.run(&["doctor", "runs/stream.mcap"]).code(), Some(0));
    }
    // On from there, beyond the end of the scene, killed on its way.
    let child = folder.start(&[&RESUME[..], &["--until", "0.12"]].concat());
    folder.wait_for_another_checkpoint();
    folder.wait_for_another_checkpoint();
    kill(child);
    let mut extended = Left::of(&folder, &folder.run(&RESUME));
    extended.others = beyond.others.clone();
    extended.is(&beyond, "extended twice and killed");

    for (seconds, part) in [("0.01", "too late for a run to 0.01 s"), ("-1", "greater than 0"), ("soon", "--until")] {
        resume(seconds).is_refused_with(&[part]);
    }
}
