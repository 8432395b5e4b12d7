//! What is run, and what stands in the table.

use std::fs;

use serde_json::Value;

use crate::program::{Folder, assert_parts, messages};
use crate::{GRID, NAMES};

/// Times and values of a field of the energies, read from the messages of a log.
fn energy(log: &[u8], field: &str) -> Vec<(f64, f64)> {
    let told = messages(log).into_iter().filter(|(topic, ..)| topic == "/energy");
    let values = told.map(|(.., data)| serde_json::from_slice::<Value>(&data).unwrap());
    values.map(|value| (value["time"].as_f64().unwrap(), value[field].as_f64().unwrap())).collect()
}

#[test]
fn a_grid_is_every_combination_and_the_table_has_what_the_logs_have() {
    let folder = Folder::with_study("grid", GRID);
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_eq!(folder.logs().into_keys().collect::<Vec<_>>(), NAMES);
    let table = folder.table();
    assert_eq!(table.keys().collect::<Vec<_>>(), NAMES.iter().collect::<Vec<_>>());
    for (name, row) in &table {
        let kinetic = energy(&folder.log(name), "kinetic");
        let number = |cell: &str| row[cell].parse::<f64>().unwrap_or_else(|_| panic!("{cell} of {row:?}"));
        assert!(name.contains(&format!("spacing={}", row["spacing [m]"])), "{row:?}");
        assert!(name.contains(&format!("viscosity={},", row["phases.water.rheology.viscosity [Pa s]"])), "{row:?}");
        let greatest = kinetic.iter().map(|(_, value)| *value).fold(0.0, f64::max);
        assert!(greatest > 0.0 && number("greatest kinetic energy [J]") == greatest, "{row:?}");
        let at = kinetic.iter().find(|(time, _)| (time - 0.03).abs() < 1e-12).unwrap().1;
        assert!((number("kinetic energy at 0.03 s [J]") - at).abs() <= 1e-12 * at, "{row:?}");
        assert_eq!(number("mass [kg]"), energy(&folder.log(name), "mass").last().unwrap().1);
        let size = 0.2 * 0.1 / number("spacing [m]").powi(2);
        assert_eq!((row["end"].as_str(), number("time [s]")), ("done", 0.05));
        assert_eq!(number("fluid particles"), size.round());
        let steps = messages(&folder.log(name)).into_iter().rfind(|(topic, ..)| topic == "/steps").unwrap();
        assert_eq!(number("steps"), serde_json::from_slice::<Value>(&steps.3).unwrap()["step"].as_f64().unwrap());
        assert!(number("wall time [s]") > 0.0);
    }
    assert!(table[NAMES[0]]["greatest kinetic energy [J]"] != table[NAMES[2]]["greatest kinetic energy [J]"]);
}

/// Runs of a list are called as the study says, and values that are long are cut for people, not for programs.
#[test]
fn runs_have_names_and_long_values_are_cut() {
    let (head, rest) = GRID.split_once("vary: ").unwrap();
    let grid = rest.split_once(",\n").unwrap().0;
    let shape = "Box(min: (0.0, 0.0), max: (0.2, 0.05))";
    let list = format!(r#"List([{{"name": "full"}}, {{"name": "half full", "fluids.0.shape": "{shape}"}}])"#);
    let study = format!("{head}vary: {}", rest.replacen(grid, &list, 1));
    let study = study.lines().filter(|line| !line.contains("over: ")).collect::<Vec<_>>().join("\n");
    let folder = Folder::with_study("named", &study);
    folder.study(&[]).ended_with(0);
    let page = fs::read_to_string(folder.path("runs/study/table.md")).unwrap();
    assert_parts(&page, &["| run | shape", "| full | ", "| half full | Box(min: (0.0, 0.0), max…"]);
    assert!(!page.contains(shape));
    assert!(fs::read_to_string(folder.path("runs/study/table.csv")).unwrap().contains(shape));
}

#[test]
fn people_get_a_table_and_figures() {
    let folder = Folder::with_study("people", GRID);
    let ran = folder.study(&["--jobs", "2"]);
    ran.ended_with(0);
    let page = fs::read_to_string(folder.path("runs/study/table.md")).unwrap();
    assert_parts(&page, &["# A family of tanks", "| viscosity (Pa s) | spacing (m) |", "greatest kinetic energy (J)"]);
    assert_eq!(page.lines().filter(|line| line.starts_with("| ") && line.contains("| done |")).count(), 4);
    assert_parts(&ran.out(), &["viscosity (Pa s)", "done", "runs/study/table.csv"]);
    assert_parts(&ran.err(), &["4 runs, 0 done before, 4 to do", "[4/4]"]);
    let figures: Vec<&str> =
        page.lines().filter_map(|line| line.strip_prefix("![")?.split_once("](")?.1.strip_suffix(')')).collect();
    assert_eq!(figures.len(), 3);
    for figure in &figures {
        assert!(fs::read(folder.path(&format!("runs/study/{figure}"))).unwrap().starts_with(b"\x89PNG"));
    }
    let drawn = |figure: &str| {
        fs::read_to_string(folder.path(&format!("runs/study/{}", figure.replace(".png", ".svg")))).unwrap()
    };
    // A curve for each spacing; one for each run.
    assert_parts(
        &drawn(figures[0]),
        &["viscosity (Pa s)", "greatest kinetic energy (J)", "spacing = 0.02 m", "spacing = 0.025 m"],
    );
    assert_parts(&drawn(figures[2]), &["x (m)", "surface of water at 0.03 s (m)"]);
    assert_parts(&drawn(figures[1]), &["time (s)", "energy: kinetic (J)", "viscosity = 1 Pa s, spacing = 0.025 m"]);
}

#[test]
fn a_list_is_those_runs() {
    let list = GRID.replace(
        "Grid({\"phases.water.rheology.viscosity\": [0.001, 1.0], \"spacing\": [0.02, 0.025]})",
        "List([{\"spacing\": 0.02}, {\"spacing\": 0.025, \"walls.tank.slip\": FreeSlip, \"phases.water.rheology.viscosity\": 1e0}])",
    );
    let folder = Folder::with_study("list", &list);
    folder.study(&[]).ended_with(0);
    let table = folder.table();
    assert_eq!(table.keys().collect::<Vec<_>>(), ["spacing=0.02", "spacing=0.025,slip=FreeSlip,viscosity=1"]);
    // What a run leaves to the scene is that of the scene.
    let cell = |run: &str, cell: &str| table[run][cell].clone();
    assert_eq!(cell("spacing=0.02", "phases.water.rheology.viscosity [Pa s]"), "0.001");
    assert_eq!(cell("spacing=0.02", "walls.tank.slip"), "NoSlip");
    assert_eq!(cell("spacing=0.025,slip=FreeSlip,viscosity=1", "walls.tank.slip"), "FreeSlip");
}

#[test]
fn what_is_fixed_counts_for_all_and_an_end_ends_them() {
    let study = GRID.replace("    vary", "    until: 0.035,\n    set: {\"walls.tank.slip\": \"FreeSlip\"},\n    vary");
    let folder = Folder::with_study("fixed", &study);
    folder.study(&[]).ended_with(0);
    for name in NAMES {
        let log = folder.log(name);
        let summary = mcap::Summary::read(&log).unwrap().unwrap();
        let scene = mcap::read::attachment(&log, &summary.attachment_indexes[0]).unwrap();
        assert!(String::from_utf8_lossy(&scene.data).contains("slip: FreeSlip"));
        assert_eq!(folder.table()[name]["time [s]"], "0.035");
    }
}

#[test]
fn a_run_that_diverges_stands_in_the_table_and_is_not_run_again() {
    let study = GRID.replace("Grid({", "Grid({\"fluids.0.velocity\": [(0.0, 0.0), (50.0, 0.0)], ");
    let study = study.replace("    vary", "    set: {\"equation_of_state.max_speed\": 1},\n    vary");
    let folder = Folder::with_study("diverging", &study.replace("[0.001, 1.0]", "[0.001]").replace(", 0.025]", "]"));
    let ran = folder.study(&[]);
    ran.ended_with(3);
    let table = folder.table();
    let (still, fast): (Vec<_>, Vec<_>) =
        table.values().partition(|row| row["fluids.0.velocity [m/s]"] == "(0.0, 0.0)");
    assert_eq!((still[0]["end"].as_str(), fast[0]["end"].as_str()), ("done", "diverged"));
    assert!(!still[0]["mass [kg]"].is_empty() && fast[0]["mass [kg]"].is_empty(), "a part of a run has no measures");
    assert!(fast[0]["time [s]"].parse::<f64>().unwrap() < 0.05 && fast[0]["note"].contains("speed"), "{fast:?}");
    assert_parts(&ran.out(), &["diverged at "]);
    let before = folder.logs();
    let ran = folder.study(&[]);
    ran.ended_with(3);
    assert_eq!(folder.logs(), before);
    assert_eq!(folder.table(), table);
}

#[test]
fn a_measure_without_a_value_says_why() {
    let folder = Folder::with_study("without", &GRID.replace("take: At(0.03)", "take: Reaches(1e9)"));
    folder.study(&[]).ended_with(0);
    let row = &folder.table()[NAMES[0]];
    assert_eq!(row["kinetic energy at 0.03 s [s]"], "");
    assert!(row["note"].contains("did not reach 1000000000"), "{row:?}");
}

#[test]
fn a_dry_run_writes_nothing_and_tells_what_is_left() {
    let folder = Folder::with_study("dry", GRID);
    let ran = folder.study(&["--dry-run"]);
    ran.ended_with(0);
    assert_parts(&ran.out(), &[NAMES[0], NAMES[3], "to run", "MB", "at once"]);
    assert!(!folder.path("runs").exists());
    folder.study(&["--quiet"]).ended_with(0);
    folder.write("study.ron", GRID.replace("1.0]", "2.0]"));
    let ran = folder.study(&["--dry-run"]);
    let lines_with = |word: &str| ran.out().lines().filter(|line| line.trim_end().ends_with(word)).count();
    assert_eq!((lines_with("  done"), lines_with("  to run")), (2, 2), "{}", ran.out());
}

#[test]
fn the_number_of_runs_at_once_changes_nothing() {
    let (one, two) = (Folder::with_study("one", GRID), Folder::with_study("two", GRID));
    one.study(&["--jobs", "1", "--quiet"]).ended_with(0);
    two.study(&["--jobs", "3", "--quiet"]).ended_with(0);
    for name in NAMES {
        assert!(one.log(name) == two.log(name), "{name}");
    }
}
