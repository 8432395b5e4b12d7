//! The page on scene files knows every field that a shipped scene has or leaves open, and every name it can use.

#[path = "support/shipped.rs"]
mod shipped;

use std::collections::BTreeSet;

use storegga::app::open;
use storegga::kernels::KernelRegistry;
use storegga::probes::ProbeRegistry;
use storegga::rheology::RheologyRegistry;
use storegga::scene::{SceneFacts, open_document};
use storegga_standard::StandardPlugins;

/// Sections in which the second part of a path is a name that the author of the scene chose.
const NAMED: [&str; 5] = ["phases", "walls", "structures", "probes", "relaxation_zones"];

#[test]
fn every_field_and_name_is_documented() {
    let page = std::fs::read_to_string(shipped::root().join("docs/scene.md")).expect("the page is there");
    let mut words = BTreeSet::new();
    for path in shipped::scenes("scenes") {
        let document = open_document(&path, &[]).unwrap_or_else(|error| panic!("{}", error.render(false)));
        let app = open(StandardPlugins, document).unwrap_or_else(|error| panic!("{}", error.render(false)));
        for (path, _) in &app.world().resource::<SceneFacts>().parameters {
            let parts: Vec<&str> = path.split('.').collect();
            let chosen = NAMED.contains(&parts[0]);
            let fields =
                parts.iter().enumerate().filter(|(k, part)| !(chosen && *k == 1) && part.parse::<u32>().is_err());
            words.extend(fields.map(|(_, part)| (*part).to_owned()));
        }
        words.extend(app.world().resource::<KernelRegistry>().names().map(str::to_owned));
        words.extend(app.world().resource::<ProbeRegistry>().names().map(str::to_owned));
        words.extend(app.world().resource::<RheologyRegistry>().names().map(str::to_owned));
    }
    assert!(words.len() > 60, "only {} words: {words:?}", words.len());
    let missing: Vec<&String> = words
        .iter()
        .filter(|word| {
            ![format!("`{word}`"), format!("`{word}("), format!("({word}:")].iter().any(|form| page.contains(form))
        })
        .collect();
    assert!(missing.is_empty(), "not in docs/scene.md: {missing:?}");
}
