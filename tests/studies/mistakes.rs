//! What is said of mistakes: a message with the line, exit code 2, and nothing has been run.

use crate::GRID;
use crate::program::Folder;

#[track_caller]
fn refused(name: &str, wrong: (&str, &str), parts: &[&str]) {
    assert!(GRID.contains(wrong.0), "{}", wrong.0);
    let folder = Folder::with_study(name, &GRID.replace(wrong.0, wrong.1));
    folder.study(&[]).is_refused_with(parts);
    assert!(!folder.path("runs").exists());
}

#[test]
fn of_varied_values() {
    let unknown = ("\"spacing\": [", "\"phases.water.rheology.viscosty\": [");
    refused(
        "field",
        unknown,
        &["study.ron:4:", "unknown field `viscosty`", "did you mean `viscosity`?", "vary: Grid("],
    );
    let nowhere = ("\"spacing\": [", "\"phases.wtaer.reference_density\": [");
    refused("path", nowhere, &["study.ron:4:", "no `wtaer`", "did you mean `water`?"]);
    refused(
        "top",
        ("\"spacing\": [", "\"spacng\": ["),
        &["study.ron:4:", "unknown field `spacng`", "did you mean `spacing`?"],
    );
    refused("type", ("[0.02, 0.025]", "[0.02, fine]"), &["study.ron:4:84", "expected a number, found `fine`"]);
    refused("range", ("[0.02, 0.025]", "[0.02, -0.025]"), &["study.ron:4:84", "must be greater than 0, got -0.025 m"]);
    refused("twice", ("[0.02, 0.025]", "[0.02, 2e-2]"), &["study.ron:4:84", "`0.02` is given twice"]);
    refused("empty", ("[0.02, 0.025]", "[]"), &["study.ron:4:77", "the list of values of `spacing` is empty"]);
    refused(
        "number",
        ("[0.02, 0.025]", "0.02"),
        &["study.ron:4:77", "expected a list of values `[…]`, found the number"],
    );
    refused("line", ("[0.02, 0.025]", "[0.02"), &["study.ron:4:"]);
    let fixed = ("    vary", "    set: {\"spacing\": 0.01},\n    vary");
    refused("both", fixed, &["study.ron:5:78", "`spacing` is varied, and stands in `set`, too"]);
    let wrong = ("    vary", "    set: {\"phases.water.reference_density\": -1},\n    vary");
    refused("fixed", wrong, &["study.ron:4:45", "must lie between"]);
    refused("way", ("Grid(", "Gird("), &["study.ron:4:11", "unknown way to vary `Gird`", "did you mean `Grid`?"]);
    refused("plain", ("Grid({", "({"), &["study.ron:4:11", "expected a name"]);
}

#[test]
fn of_lists() {
    let (_, rest) = GRID.split_once("vary: ").unwrap();
    let grid = rest.split_once(",\n").unwrap().0;
    for (name, text, parts) in [
        ("list-empty", "List([])", &["study.ron:4:16", "the list of runs is empty"] as &[&str]),
        ("list-map", "List({})", &["study.ron:4:16", "expected a list of tables"]),
        ("list-items", "List([1])", &["study.ron:4:17", "expected a table `{\"path\": value}`, found the number 1"]),
        ("list-twice", "List([{\"spacing\": 0.02}, {\"spacing\": 0.020}])", &["study.ron:4:36", "given twice"]),
        (
            "list-value",
            "List([{\"spacing\": 0.02}, {\"spacing\": -1, \"phases.water.rheology.viscosity\": 1}])",
            &["study.ron:4:48", "must be greater than 0"],
        ),
        ("grid-empty", "Grid({})", &["study.ron:4:16", "nothing is varied"]),
        ("grid-list", "Grid([])", &["study.ron:4:16", "expected a table of lists"]),
    ] {
        refused(name, (grid, text), parts);
    }
}

#[test]
fn of_fields_measures_and_figures() {
    refused("study", ("title", "titel"), &["study.ron:2:5", "unknown field `titel`", "did you mean `title`?"]);
    refused("root", ("Study(", "Scene("), &["study.ron:1:1", "expected a study `Study(…)`, found `Scene(…)`"]);
    refused("scene", ("tank.ron", "tnak.ron"), &["study.ron:3:12", "tnak.ron", "did you mean `tank.ron`?"]);
    refused("no-scene", ("scene: \"tank.ron\",", ""), &["study.ron:1:1", "`scene` is missing"]);
    refused("until", ("    vary", "    until: -1,\n    vary"), &["study.ron:4:12", "must be greater than 0"]);
    refused("series", ("energy.mass", "enrgy.mass"), &["study.ron:7:", "`measures.1.of`", "did you mean `energy`?"]);
    refused("quantity", ("energy.mass", "energy.mas"), &["study.ron:7:", "did you mean `mass`?"]);
    refused("take", ("take: Max", "take: Maximum"), &["study.ron:6:", "unknown name `Maximum`"]);
    refused("time", ("At(0.03)", "At(0.3)"), &["study.ron:8:", "0.3 s lies outside the run"]);
    refused(
        "name",
        ("(name: \"mass\"", "(nam: \"mass\""),
        &["study.ron:7:", "unknown field `nam`", "did you mean `name`?"],
    );
    refused(
        "same",
        ("name: \"mass\"", "name: \"greatest kinetic energy\""),
        &["study.ron:7:", "another measure has this name"],
    );
    let over = ("over: \"phases.water.rheology.viscosity\"", "over: \"phases.water.rheology.viscosty\"");
    refused("over", over, &["study.ron:11:", "did you mean `phases.water.rheology.viscosity`?"]);
    refused(
        "measure",
        ("Measure(of: \"greatest", "Measure(of: \"graetest"),
        &["study.ron:11:", "no measure is called"],
    );
    refused("curve", ("Series(of: \"energy", "Series(of: \"enrgy"), &["study.ron:12:", "did you mean `energy`?"]);
    refused("surface", ("Surface(of: \"water\"", "Surface(of: \"watr\""), &["study.ron:13:", "did you mean `water`?"]);
    refused("late", ("at: 0.03", "at: 0.06"), &["study.ron:13:", "0.06 s lies outside the run"]);
    let word = ("[0.02, 0.025]})", "[0.02], \"walls.tank.slip\": [NoSlip, FreeSlip]})");
    let folder =
        GRID.replace(word.0, word.1).replace("over: \"phases.water.rheology.viscosity\"", "over: \"walls.tank.slip\"");
    Folder::with_study("word", &folder).study(&[]).is_refused_with(&["study.ron:11:", "`NoSlip` is no number"]);
}

#[test]
fn of_files_and_folders() {
    let folder = Folder::with_study("files", GRID);
    folder.run(&["study", "studdy.ron"]).is_refused_with(&["studdy.ron", "did you mean `study.ron`?"]);
    folder.study(&["--out", "."]).is_refused_with(&["not the folder of a study", "--out"]);
    folder.write("taken", "x");
    folder.study(&["--out", "taken"]).is_refused_with(&["taken", "--out"]);
    folder.study(&["--jobs", "0"]).is_refused_with(&["--jobs"]);
    folder.run(&["run", "study.ron"]).is_refused_with(&["study.ron:1:1", "expected a scene `Scene(…)`"]);
    folder.write("tank.ron", "Scene(");
    folder.study(&[]).is_refused_with(&["tank.ron:1:"]);
}
