//! State that is saved and restored within a process.

use storegga::app::open;
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::scene::open_document;
use storegga_standard::StandardPlugins;

use crate::shipped;
use crate::steps::advance;

/// Whatever a plugin that is shipped brings, some scene has it.
#[test]
fn every_shipped_scene_can_be_resumed() {
    let scenes = shipped::scenes("scenes/ci");
    assert!(scenes.len() > 5);
    for path in scenes {
        let opened = || open_document(&path, &[]).and_then(|document| open(StandardPlugins, document));
        let [mut straight, mut resumed] = [opened(), opened()].map(|app| app.unwrap_or_else(|error| panic!("{error}")));
        advance(straight.world_mut(), 8);
        let forgotten = check_state(straight.world());
        assert_eq!(forgotten, Ok(()), "{}: neither saved nor rebuilt", path.display());
        let saved = save_state(straight.world_mut()).unwrap();
        restore_state(resumed.world_mut(), &saved).unwrap();
        advance(straight.world_mut(), 8);
        advance(resumed.world_mut(), 8);
        let [straight, resumed] = [straight, resumed].map(|mut app| save_state(app.world_mut()).unwrap());
        assert!(straight == resumed, "{}: the resumed run went another way", path.display());
    }
}
