//! What `storegga runout` makes of a log.

use storegga::results::Results;

use crate::program::{Folder, TANK};

/// The rows of a table of numbers.
fn rows(folder: &Folder, name: &str) -> Vec<Vec<f64>> {
    let text = std::fs::read_to_string(folder.path(name)).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(|number| number.parse().unwrap()).collect()).collect()
}

/// Front, centre and rear are those of the particles of each frame.
#[test]
fn the_extents_are_those_of_the_frames() {
    let folder = Folder::new("runout");
    folder.write("tank.ron", TANK);
    folder.log();
    let ran = folder.run(&["runout", "runs/tank.mcap", "--phase", "water", "--direction", "0,-2", "--out", "out"]);
    ran.ended_with(0);
    assert!(ran.out().contains("along (0, -2)"), "{}", ran.out());
    let results = Results::open(&folder.path("runs/tank.mcap")).unwrap();
    let water = results.facts.phases.iter().position(|name| name == "water").unwrap();
    let table = rows(&folder, "out/water_runout.csv");
    assert_eq!(table.len(), results.frame_times("/particles").len());
    for (number, row) in table.iter().enumerate() {
        let frame = results.frame("/particles", number).unwrap().unwrap();
        let depths: Vec<f64> = frame
            .positions()
            .zip(frame.values("phase"))
            .filter(|(_, phase)| **phase == water as f64)
            .map(|(x, _)| -x[1])
            .collect();
        let near = |value: f64, exact: f64| assert!((value - exact).abs() < 1e-9, "{value} {exact}");
        near(row[0], frame.time);
        near(row[1], depths.iter().copied().fold(f64::NEG_INFINITY, f64::max));
        near(row[3], depths.iter().sum::<f64>() / depths.len() as f64);
        near(row[4], depths.iter().copied().fold(f64::INFINITY, f64::min));
    }
    for name in ["water_runout", "water_outline", "wave_envelope"] {
        for ending in ["png", "csv"] {
            assert!(folder.path(&format!("out/{name}.{ending}")).is_file(), "{name}.{ending}");
        }
    }
    // A tank at rest has no waves.
    let elevations = rows(&folder, "out/wave_envelope.csv");
    assert!(!elevations.is_empty() && elevations.iter().all(|row| row[2].max(-row[4]) < 0.002), "{elevations:?}");
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::new("runout-mistakes");
    folder.write("tank.ron", TANK);
    folder.log();
    for (arguments, word) in [
        (&["--phase", "watr"][..], "did you mean `water`?"),
        (&["--phase", "water", "--direction", "0,0"], "not all 0"),
        (&["--phase", "water", "--direction", "0,0,1"], "in the plane of the log"),
    ] {
        let ran = folder.run(&[&["runout", "runs/tank.mcap"], arguments].concat());
        ran.ended_with(2);
        assert!(ran.err().contains(word), "{}", ran.err());
    }
}
