//! What `storegga forces` makes of a log.

use storegga::results::Results;

use crate::program::{Folder, TANK};

/// The number behind `label` in what was told.
fn number(told: &str, label: &str) -> f64 {
    let after = told.split_once(label).unwrap_or_else(|| panic!("no `{label}` in:\n{told}")).1;
    let word = after.split_whitespace().next().unwrap_or_default();
    word.parse().unwrap_or_else(|_| panic!("`{word}` behind `{label}` in:\n{told}"))
}

/// A folder with the log of a tank with a post in it, 0.5 m long.
fn with_post(name: &str) -> Folder {
    let folder = Folder::new(name);
    let post = r#"structures: {"post": (shape: Box(min: (0.08, 0.02), max: (0.12, 0.06)), length: 0.5)},"#;
    folder.write(
        "tank.ron",
        TANK.replace("    log:", &format!("    {post}\n    log:")).replace("spacing: 0.01", "spacing: 0.02"),
    );
    folder.log();
    folder
}

/// Mean, impulse, coefficient and Reynolds number are what they are by hand.
#[test]
fn the_numbers_are_those_of_the_log() {
    let folder = with_post("forces");
    let results = Results::open(&folder.path("runs/tank.mcap")).unwrap();
    let load = results.series.iter().find(|series| series.topic == "/structures/post/load").unwrap();
    let (times, values) = (&load.times, &load.field("force_y").unwrap().values);
    let n = values.len();
    let impulse: f64 = (1..n).map(|k| 0.5 * (values[k] + values[k - 1]) * (times[k] - times[k - 1])).sum();
    let mean = impulse / (times[n - 1] - times[0]);
    assert!(mean > 1.0, "the water carries the post");

    let steady = format!("{},{}", times[0], times[n - 1]);
    let flow = ["--velocity", "2", "--width", "0.1", "--phase", "water", "--steady", &steady];
    let ran = folder.run(&[&["forces", "runs/tank.mcap", "--direction", "0,-1"], &flow[..]].concat());
    ran.ended_with(0);
    let told = ran.out();
    let near = |label: &str, exact: f64| {
        let value = number(&told, label);
        assert!((value - exact).abs() < 2e-3 * exact.abs(), "{label}: {value} {exact}\n{told}");
    };
    near("\n    mean", -mean);
    near("\n    impulse", -impulse);
    // ½ρU²A with A = 0.1 m × 0.5 m; ρU²/τ with τ = μU/D.
    near("½ρU²A =", 100.0);
    near("Reynolds", 1000.0 * 2.0 * 0.1 / 0.001);
    let (_, behind) = told.split_once("\n    mean").unwrap();
    assert!((number(behind, "C =") + mean / 100.0).abs() < 2e-3 * mean / 100.0, "{told}");
    assert!(told.contains("of 0.5 m of its length"), "{told}");

    // Peak and impulse of a part: that from one sample to a later one.
    let (from, to) = (n / 3, n / 2);
    let window = format!("{},{}", times[from], times[to]);
    let ran = folder.run(&["forces", "runs/tank.mcap", "--direction", "0,-1", "--window", &window]);
    ran.ended_with(0);
    let told = ran.out();
    let part: f64 = (from + 1..=to).map(|k| 0.5 * (values[k] + values[k - 1]) * (times[k] - times[k - 1])).sum();
    let peak = values[from..=to].iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap();
    for (label, exact) in [("\n    impulse", -part), ("\n    peak, raw", -peak)] {
        let value = number(&told, label);
        assert!((value - exact).abs() < 2e-3 * exact.abs(), "{label}: {value} {exact}\n{told}");
    }
    for component in ["drag", "lift"] {
        assert!(folder.path(&format!("plots/tank/post_{component}_record.png")).is_file());
    }
}

#[test]
fn mistakes_are_named() {
    let folder = with_post("forces_mistakes");
    for (arguments, parts) in [
        (&["--structure", "pots"] as &[&str], &["pots", "post"] as &[&str]),
        (&["--cutoff", "1e9"], &["--cutoff 1000000000", "half the rate of sampling"]),
        (&["--velocity", "1"], &["--width"]),
        (&["--velocity", "1", "--width", "1", "--phase", "watr"], &["watr", "did you mean `water`?"]),
        (&["--direction", "0,0"], &["not all 0"]),
        (&["--window", "1000,2000"], &["--window 1000,2000", "the record reaches from 0 to 0.05 s"]),
        (&["--window", "0.05,0.06"], &["--window 0.05,0.06", "the record reaches from 0 to 0.05 s"]),
        (&["--steady", "5,6"], &["--steady 5,6", "the record reaches from 0 to 0.05 s"]),
    ] {
        let ran = folder.run(&[&["forces", "runs/tank.mcap"], arguments].concat());
        ran.ended_with(2);
        for part in parts {
            assert!(ran.err().contains(part), "{arguments:?}: {}", ran.err());
        }
    }
}
