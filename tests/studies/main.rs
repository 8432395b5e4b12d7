//! Studies, as their users meet them: what is run, what is run again, what stands in the table, what is said of mistakes.

mod mistakes;
mod stopped;
mod table;
mod validate;

#[path = "../support/program.rs"]
mod program;
#[path = "../support/shipped.rs"]
mod shipped;

use std::collections::BTreeMap;
use std::fs;
use std::time::SystemTime;

use program::{Folder, Ran, TANK};

/// Two values of two fields of the tank, every combination.
const GRID: &str = r#"Study(
    title: "A family of tanks",
    scene: "tank.ron",
    vary: Grid({"phases.water.rheology.viscosity": [0.001, 1.0], "spacing": [0.02, 0.025]}),
    measures: [
        (name: "greatest kinetic energy", of: "energy.kinetic", take: Max),
        (name: "mass", of: "energy.mass"),
        (name: "kinetic energy at 0.03 s", of: "energy.kinetic", take: At(0.03)),
    ],
    figures: [
        Measure(of: "greatest kinetic energy", over: "phases.water.rheology.viscosity"),
        Series(of: "energy.kinetic"),
        Surface(of: "water", at: 0.03),
    ],
)
"#;

/// Names of the runs of [`GRID`], in their order.
const NAMES: [&str; 4] = [
    "viscosity=0.001,spacing=0.02",
    "viscosity=0.001,spacing=0.025",
    "viscosity=1,spacing=0.02",
    "viscosity=1,spacing=0.025",
];

impl Folder {
    /// A folder with the tank and a study of it, `study.ron`.
    fn with_study(name: &str, study: &str) -> Self {
        let folder = Self::new(name);
        folder.write("tank.ron", TANK);
        folder.write("study.ron", study);
        folder
    }

    /// Starts the study; its runs have one thread each, so that their logs are equal whenever they are.
    fn study(&self, arguments: &[&str]) -> Ran {
        self.run(&[&["study", "study.ron", "--threads", "1"], arguments].concat())
    }

    /// When each log was last written.
    fn logs(&self) -> BTreeMap<String, SystemTime> {
        let entries = fs::read_dir(self.path("runs/study")).unwrap().map(Result::unwrap);
        let logs = entries.filter(|entry| entry.path().extension().is_some_and(|end| end == "mcap"));
        let changed = |entry: &fs::DirEntry| entry.metadata().unwrap().modified().unwrap();
        logs.map(|entry| (entry.path().file_stem().unwrap().to_string_lossy().into_owned(), changed(&entry))).collect()
    }

    fn log(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(&format!("runs/study/{name}.mcap"))).unwrap()
    }

    /// The rows of the table by their names, each with its cells by theirs.
    fn table(&self) -> BTreeMap<String, BTreeMap<String, String>> {
        let text = fs::read_to_string(self.path("runs/study/table.csv")).unwrap();
        let mut lines = text.lines().map(cells);
        let names = lines.next().unwrap();
        let row = |cells: Vec<String>| names.iter().cloned().zip(cells).collect::<BTreeMap<_, _>>();
        lines.map(row).map(|row| (row["run"].clone(), row)).collect()
    }
}

/// The cells of a line of CSV.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut is_quoted) = (vec![String::new()], false);
    for letter in line.chars() {
        match letter {
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => cells.push(String::new()),
            letter => cells.last_mut().unwrap().push(letter),
        }
    }
    cells
}

#[test]
fn the_studies_that_are_shipped_can_be_run() {
    for study in shipped::scenes("studies") {
        let folder = Folder::new(&format!("shipped-{}", study.file_stem().unwrap().display()));
        let ran = folder.run(&["study", study.to_str().unwrap(), "--dry-run"]);
        ran.ended_with(0);
        assert!(ran.out().lines().count() > 3, "{}", ran.out());
    }
}

/// The paper's section 3.2: the front of the slide is faster as η or τ_y falls, and τ_y matters more: n of v ∝ η^n, v ∝ τ_y^n.
#[test]
fn the_slide_is_as_sensitive_as_the_paper_finds() {
    let folder = Folder::new("sensitivity");
    let study = shipped::root().join("studies/slide_sensitivity.ron").canonicalize().unwrap();
    let ran =
        folder.run(&["study", study.to_str().unwrap(), "--coarse", "--threads", "1", "--out", "runs/study", "--quiet"]);
    ran.ended_with(0);
    let table = folder.table();
    let front = |consistency: &str, yield_stress: &str| -> f64 {
        let name = format!("spacing=0.1,consistency={consistency},yield_stress={yield_stress}");
        table[&name]["greatest front velocity [m/s]"].parse().unwrap()
    };
    let exponent = |slow: f64, fast: f64, ratio: f64| (slow / fast).ln() / ratio.ln();
    let of_yield_stress = ["0.15", "150"].map(|eta| exponent(front(eta, "1000"), front(eta, "250"), 4.0));
    let of_viscosity = ["250", "1000"].map(|tau| exponent(front("150", tau), front("0.15", tau), 1000.0));
    assert!(of_yield_stress.iter().chain(&of_viscosity).all(|n| *n < 0.0), "{of_yield_stress:?} {of_viscosity:?}");
    let steepest = of_viscosity.into_iter().fold(0.0, f64::min);
    assert!(of_yield_stress.iter().all(|n| *n < steepest), "{of_yield_stress:?} {of_viscosity:?}");
}

#[test]
fn the_page_has_every_field_and_its_study_can_be_run() {
    let page = fs::read_to_string(shipped::root().join("docs/studies.md")).unwrap();
    let fields = [
        "title",
        "text",
        "scene",
        "until",
        "set",
        "vary",
        "coarse",
        "names",
        "measures",
        "figures",
        "name",
        "of",
        "take",
        "cutoff",
        "scale",
        "against",
        "shift",
        "asked",
        "asked_coarse",
        "over",
        "by",
        "logarithmic",
        "runs",
        "beside",
    ];
    let words =
        ["Grid", "List", "Measure", "Series", "Surface", "--dry-run", "--again", "--jobs", "--threads", "--out"];
    for word in fields.into_iter().chain(words) {
        assert!(page.contains(&format!("`{word}")), "{word}");
    }
    let (_, after) = page.split_once("```ron\n").unwrap();
    let study = after.split_once("```").unwrap().0;
    let folder = Folder::new("page");
    let scene = shipped::root().join("scenes/submarine_slide.ron").canonicalize().unwrap();
    folder.write("study.ron", study.replace("../scenes/submarine_slide.ron", scene.to_str().unwrap()));
    folder.study(&["--dry-run"]).ended_with(0);
    assert!(folder.run(&["study", "--help"]).out().contains("docs/studies.md"));
}
