//! Studies beside measurements, and the page of all of them.

use std::fs;

use serde_json::Value;

use crate::program::{Folder, assert_parts, messages};
use crate::{GRID, NAMES};

/// [`GRID`] with more lines among its measures and among its figures.
fn with(measures: &str, figures: &str) -> String {
    GRID.replace("    measures: [", &format!("    measures: [{measures}"))
        .replace("    figures: [", &format!("    figures: [{figures}"))
}

/// The longest line of each of the first two colours in a figure.
fn lines(figure: &str) -> Vec<&str> {
    let colours = ["#0072B2", "#D55E00"].into_iter();
    let of = |colour| {
        figure
            .lines()
            .filter(|line| line.starts_with("<polyline") && line.contains(colour))
            .max_by_key(|line| line.len())
    };
    colours.filter_map(of).collect()
}

/// What is compared with one of its own runs is the same as it, and nothing is run again for it.
#[test]
fn r_squared_is_one_beside_itself_and_less_beside_others() {
    let folder = Folder::with_study("against", GRID);
    folder.study(&[]).ended_with(0);
    let told = messages(&folder.log(NAMES[0])).into_iter().filter(|(topic, ..)| topic == "/energy");
    let rows = told.map(|(.., data)| serde_json::from_slice::<Value>(&data).unwrap());
    let rows: String = rows.map(|value| format!("{},{}\n", value["time"], value["kinetic"])).collect();
    folder.write("measured.csv", format!("time,kinetic\n{rows}"));
    let told = messages(&folder.log(NAMES[0])).into_iter().filter(|(topic, ..)| topic == "/energy");
    let rows = told.map(|(.., data)| serde_json::from_slice::<Value>(&data).unwrap());
    let early = rows.map(|value| format!("{},{}\n", value["time"].as_f64().unwrap() - 0.25, value["kinetic"]));
    folder.write("early.csv", format!("time,kinetic\n{}", early.collect::<String>()));
    let against = r#"(name: "fit", of: "energy.kinetic", against: (file: "measured.csv", x: "time", y: "kinetic")),
        (name: "shifted", of: "energy.kinetic", against: (file: "early.csv", x: "time", y: "kinetic", shift: 0.25)),
        (name: "smooth", of: "energy.kinetic", take: Max, cutoff: 10.0),
        (name: "even", of: "energy.mass", take: Min, cutoff: 10.0),
        (name: "weight", of: "energy.mass", scale: (by: -9.81, unit: "N"), take: Max),"#;
    let beside = r#"
        Series(of: "energy.kinetic", name: "energy of motion", cutoff: 50.0, window: (0.01, 0.04), beside: [(file: "measured.csv", x: "time", y: "kinetic", name: "measured")]),
        Measure(of: "fit", over: "greatest kinetic energy", logarithmic: true),
        Field(of: "pressure", at: [0.02, 0.05], arrows: true, runs: 2),
        Profile(of: "pressure:x=0.1", at: [0.05]),"#;
    folder.write("study.ron", with(against, &beside.replace(", cutoff: 50.0, window: (0.01, 0.04)", "")));
    folder.study(&[]).ended_with(0);
    let figure = || fs::read_to_string(folder.path("runs/study/figure_1_energy.kinetic.svg")).unwrap();
    let raw_figure = figure();
    let names = "    names: {\"spacing\": \"\", \"phases.water.rheology.viscosity\": \"thickness\"},\n    measures: [";
    folder.write("study.ron", with(against, beside).replace("    measures: [", names));
    let ran = folder.study(&[]);
    ran.ended_with(0);
    assert_parts(&ran.err(), &["4 runs, 4 done before, 0 to do"]);
    let table = folder.table();
    let fit = |name: &str| table[name]["fit"].parse::<f64>().unwrap();
    assert!((fit(NAMES[0]) - 1.0).abs() < 1e-12, "{}", fit(NAMES[0]));
    assert!(NAMES[1..].iter().all(|name| fit(name) < 0.999));
    let of = |name: &str| table[NAMES[0]][name].parse::<f64>().unwrap();
    assert!((of("weight [N]") / of("mass [kg]") + 9.81).abs() < 1e-9);
    let [raw, smooth] = ["greatest kinetic energy [J]", "smooth [J]"].map(of);
    let [even, mass, shifted] = ["even [kg]", "mass [kg]", "shifted"].map(of);
    assert!((smooth / raw - 1.0).abs() > 0.01 && (even - mass).abs() < 1e-9, "{smooth} {raw} {even} {mass}");
    assert!((shifted - 1.0).abs() < 1e-9, "{shifted}");
    assert!(figure().contains("energy of motion below 50 Hz (J)"));
    assert!(lines(&figure())[0] != lines(&raw_figure)[0]);
    // The axis of time ends with the window, the measured curve too.
    let has = |figure: &str, ticks: [&str; 2]| figure.lines().any(|line| ticks.contains(&line.trim()));
    assert!(has(&raw_figure, ["0.05", "0.050"]));
    assert!(has(&figure(), ["0.04", "0.040"]) && !has(&figure(), ["0.05", "0.050"]), "{}", figure());
    let page = fs::read_to_string(folder.path("runs/study/table.md")).unwrap();
    assert_parts(&page, &["| thickness (Pa s) | fluid particles |"]);
    // The two spacings are not named, and yet have a curve each.
    let over =
        fs::read_to_string(folder.path("runs/study/figure_5_greatest_kinetic_energy_over_viscosity.svg")).unwrap();
    assert!(over.contains("thickness (Pa s)") && lines(&over).len() == 2);
    // The field of the last two runs, at two times each, says of which they are.
    let field = fs::read_to_string(folder.path("runs/study/figure_3_pressure.svg")).unwrap();
    for time in ["0.02", "0.05"] {
        assert_eq!(field.matches(&format!("thickness = 1 Pa s, t = {time} s")).count(), 2, "{time}");
    }
    for name in ["1_energy.kinetic", "2_fit_over_greatest_kinetic_energy", "3_pressure"] {
        assert!(folder.path(&format!("runs/study/figure_{name}.png")).is_file(), "{name}");
    }
}

#[test]
fn the_page_shows_what_is_met_and_what_is_missed() {
    // 20 kg/m of water.
    let asked = |least: f64, greatest: f64| {
        with(&format!(r#"(name: "weighed", of: "energy.mass", asked: ({least:?}, {greatest:?})),"#), "")
    };
    let folder = Folder::with_study("page", &asked(19.9, 20.1));
    folder.write("other.ron", asked(30.0, 31.0).replace("A family of tanks", "Another family"));
    let validate = |more: &[&str]| {
        folder.run(&[&["validate", "study.ron", "other.ron", "--threads", "1", "--page", "page.md"], more].concat())
    };
    validate(&[]).ended_with(1);
    let page = fs::read_to_string(folder.path("page.md")).unwrap();
    assert_parts(&page, &["# Validation", "## A family of tanks", "## Another family"]);
    let verdict = |title: &str| {
        let line = page.lines().find(|line| line.starts_with(&format!("| {title} | weighed (kg)")));
        line.unwrap_or_else(|| panic!("{title} in {page}")).to_owned()
    };
    assert!(verdict("A family of tanks").ends_with("| met |"));
    assert!(verdict("Another family").ends_with("| **missed** |"));
    let figures: Vec<&str> =
        page.lines().filter_map(|line| line.strip_prefix("![")?.split_once("](")?.1.strip_suffix(')')).collect();
    assert_eq!(figures.len(), 6);
    assert!(figures.iter().all(|figure| folder.path(figure).is_file()), "{figures:?}");

    // What is done is enough for the page; nothing is run for it.
    fs::remove_file(folder.path(&format!("runs/validation/other/{}.mcap", NAMES[3]))).unwrap();
    validate(&["--no-run"]).ended_with(1);
    let page = fs::read_to_string(folder.path("page.md")).unwrap();
    assert_parts(&page, &["| not run |", "## Another family"]);
    assert!(!folder.path(&format!("runs/validation/other/{}.mcap", NAMES[3])).exists());

    let coarse = "    coarse: Grid({\"spacing\": [0.05]}),\n    measures: [";
    folder.write(
        "other.ron",
        asked(30.0, 31.0).replace("    measures: [", coarse).replace(
            "        Measure(of: \"greatest kinetic energy\", over: \"phases.water.rheology.viscosity\"),\n",
            "",
        ),
    );
    let ran = validate(&["--coarse", "--out", "runs/coarse"]);
    ran.ended_with(0);
    let page = fs::read_to_string(folder.path("page.md")).unwrap();
    assert_parts(&page, &["not judged: coarse", "| met |"]);
    assert!(!page.contains("missed"));

    // Unless something is asked of coarse runs themselves.
    let other = fs::read_to_string(folder.path("other.ron")).unwrap();
    folder.write("other.ron", other.replace("asked: (30.0, 31.0)", "asked: (19.9, 20.1), asked_coarse: (30.0, 31.0)"));
    validate(&["--coarse", "--out", "runs/coarse"]).ended_with(1);
    let page = fs::read_to_string(folder.path("page.md")).unwrap();
    assert_parts(&page, &["| 30 | 31 |", "**missed**: coarse", " Coarse runs.\n"]);
}

/// A study that is run alone changes its own part of the page and nothing else, whatever has become of the logs of the others.
#[test]
fn the_page_keeps_the_parts_of_other_studies() {
    let folder = Folder::with_study("kept", GRID);
    folder.write("other tank.ron", GRID.replace("A family of tanks", "Another | family"));
    folder.run(&["validate", "study.ron", "other tank.ron", "--threads", "1", "--page", "page.md"]).ended_with(0);
    let page = || fs::read_to_string(folder.path("page.md")).unwrap();
    let whole = page();
    assert_parts(&whole, &["](page/other%20tank/figure_1"]);
    assert!(!whole.contains("oarse"));
    fs::remove_dir_all(folder.path("runs/validation/other tank")).unwrap();
    fs::remove_file(folder.path("other tank.ron")).unwrap();
    folder.write("study.ron", GRID.replace("A family of tanks", "A family of vessels"));
    let again = || folder.run(&["validate", "study.ron", "--no-run", "--page", "page.md"]);
    let ran = again();
    ran.ended_with(0);
    assert_parts(&ran.err(), &["The page keeps what it had of other tank."]);
    assert_eq!(page(), whole.replace("A family of tanks", "A family of vessels"));
    let figures = fs::read_dir(folder.path("page/other tank")).unwrap().flatten();
    assert_eq!(figures.filter(|entry| entry.path().extension().is_some_and(|e| e == "png")).count(), 3);

    folder.write("page/other tank/section.json", "{}");
    again().is_refused_with(&["page/other tank/section.json", "missing field", "delete what is there"]);
    fs::remove_dir_all(folder.path("page/other tank")).unwrap();
    again().ended_with(0);
    assert!(!page().contains("Another"));
}

#[test]
fn mistakes_are_named_in_their_place() {
    for (name, measures, figures, part) in [
        (
            "take",
            r#"(name: "f", of: "energy.mass", take: Max, against: (file: "a.csv", x: "t", y: "y")),"#,
            "",
            "leave `take` out",
        ),
        (
            "file",
            r#"(name: "f", of: "energy.mass", against: (file: "a.csv", x: "t", y: "y")),"#,
            "",
            "a.csv cannot be read",
        ),
        ("order", r#"(name: "f", of: "energy.mass", asked: (2.0, 1.0)),"#, "", "the least value comes first"),
        ("coarse", r#"(name: "f", of: "energy.mass", asked_coarse: (2.0, 1.0)),"#, "", "the least value comes first"),
        (
            "scale",
            r#"(name: "f", of: "energy.mass", scale: (by: 0.0, unit: "N")),"#,
            "",
            "must be a number other than 0, got 0",
        ),
        ("window", "", r#"Series(of: "energy.mass", window: (0.04, 0.01)),"#, "the first time comes first"),
        ("runs", "", r#"Field(of: "pressure", at: [0.05], runs: 0),"#, "a whole number other than zero"),
        (
            "cutoff",
            r#"(name: "f", of: "energy.mass", cutoff: 0.0),"#,
            "",
            "must lie between 0 and 100 Hz, half the rate of the log, got 0 Hz",
        ),
        ("figure", "", r#"Series(of: "energy.mass", cutoff: 100.0),"#, "half the rate of the log, got 100 Hz"),
        ("quantity", "", r#"Field(of: "presure", at: [0.05]),"#, "did you mean `pressure`?"),
        ("profile", "", r#"Profile(of: "surface:watr", at: [0.05]),"#, "did you mean `water`?"),
        ("late", "", r#"Field(of: "pressure", at: [7.0]),"#, "7 s lies outside the run"),
        (
            "beside",
            "",
            r#"Series(of: "energy.mass", beside: [(file: "b.csv", x: "t", y: "y")]),"#,
            "b.csv cannot be read",
        ),
    ] {
        let folder = Folder::with_study(&format!("wrong-{name}"), &with(measures, figures));
        folder.study(&[]).is_refused_with(&["study.ron:", part]);
    }
    let names = GRID.replace("    measures: [", "    names: {\"spacin\": \"distance\"},\n    measures: [");
    Folder::with_study("wrong-names", &names).study(&[]).is_refused_with(&["study.ron:", "did you mean `spacing`?"]);
    let hidden = names
        .replace("spacin\\\"", "")
        .replace("\"spacin\": \"distance\"", "\"phases.water.rheology.viscosity\": \"\"");
    Folder::with_study("wrong-axis", &hidden).study(&[]).is_refused_with(&["study.ron:", "has an empty name"]);
    let folder = Folder::with_study(
        "wrong-column",
        &with("", r#"Series(of: "energy.mass", beside: [(file: "c.csv", x: "tme", y: "y")]),"#),
    );
    folder.write("c.csv", "time,y\n0,1\n");
    folder.study(&[]).is_refused_with(&["study.ron:", "did you mean `time`?"]);
    let folder = Folder::new("wrong-folder");
    fs::create_dir(folder.path("empty")).unwrap();
    folder.run(&["validate", "empty"]).is_refused_with(&["there is no study"]);
    // A page whose figures would lie among the runs; two studies of one name; a mistake in the second, told before the first runs.
    let folder = Folder::with_study("wrong-page", GRID);
    let wrong_page = folder.run(&["validate", "study.ron", "--out", "runs/page", "--page", "runs/page.md"]);
    wrong_page.is_refused_with(&["cannot be the page"]);
    folder.run(&["validate", "study.ron", "./study.ron"]).is_refused_with(&["have one name"]);
    folder.write("wrong.ron", GRID.replace("take: Max", "take: Mx"));
    folder.run(&["validate", "study.ron", "wrong.ron"]).is_refused_with(&["wrong.ron:"]);
    assert!(!folder.path("runs").exists());
}
