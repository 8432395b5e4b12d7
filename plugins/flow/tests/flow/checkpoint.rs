//! A run with zones and shaking goes on from a checkpoint with the same bits.

use storegga::checkpoint::{check_state, restore_state, save_state};

use crate::shaking::{beside, shaken, tank};
use crate::support::{app_in, run_until};

#[test]
fn a_resumed_run_is_the_one_that_was_not_stopped() {
    let zone = "relaxation_zones: { \"sponge\": (shape: Box(min: (0.7, -1.0), max: (2.0, 2.0)), rate: 20.0, ramp: 0.2, \
        target: Uniform(velocity: (0.0, 0.0)), until: 0.05) },";
    let file = beside("resumed", "t,a\n0.0,2.0\n0.03,-4.0\n0.1,1.0\n");
    let open = || app_in(&file, &tank("(0.0, -8.0)", &(shaken() + zone)));
    let (mut straight, mut resumed) = (open(), open());
    run_until(straight.world_mut(), 0.02);
    assert_eq!(check_state(straight.world()), Ok(()));
    let saved = save_state(straight.world_mut()).expect("the state is saved");
    restore_state(resumed.world_mut(), &saved).expect("the state fits");
    let [straight, resumed] = [straight, resumed].map(|mut app| {
        run_until(app.world_mut(), 0.08);
        save_state(app.world_mut()).expect("the state is saved")
    });
    assert!(straight != saved && straight == resumed, "the resumed run went another way");
}
