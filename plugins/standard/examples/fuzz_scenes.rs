//! Spoils scenes, variants and tables token by token and reads them: `cargo run --example fuzz_scenes -- --seconds 60`.
//!
//! Whatever a scene says, the program must end, not panic and not ask for much memory; it is either put into effect or refused
//! with a message that can be shown and whose place lies in the text.

#[path = "../../../examples/fuzz/mod.rs"]
mod fuzz;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{self, ExitCode};

use storegga::app::open;
use storegga::error::UserError;
use storegga::scene::{Document, open_document};
use storegga_standard::StandardPlugins;

use fuzz::{Random, fuzz};

/// Memory (bytes) that one scene may take: it has some thousands of particles at most.
const MOST_MEMORY: usize = 1 << 30;

/// A scene that reads files.
const SHAKEN: &str = r#"Scene(
    dimension: 2, spacing: 0.05, gravity: (0.0, -9.81), end_time: 0.5,
    phases: {"water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001))},
    walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.4, 0.4)))},
    fluids: [(phase: "water", shape: Box(min: (0.0, 0.0), max: (0.4, 0.2)))],
    probes: {"water": CenterOfMass(phase: "water")},
    shaking: Accelerogram(file: "table.csv", time: "t", columns: [
        (name: "east", direction: (1.0, 0.0)), (name: "up", direction: (0.0, 1.0)),
    ]),
    expect: [(name: "measured", of: "water.vx", is: Csv(file: "table.csv", time: "t", value: "east"), within: Absolute(1.0))],
)"#;

/// The file that it reads.
const TABLE: &str =
    "# shaken by hand\nt, east, up\n0.0, 0.0, 0.0\n0.1, 2.5, -0.5\n0.2, -1e-3, 0.25\n0.35, 1.0, 0.0\n0.5, 0.0, 0.0\n";

fn main() -> ExitCode {
    let folder = std::env::temp_dir().join(format!("storegga-fuzz-scenes-{}", process::id()));
    let seeds = Seeds::new(&folder);
    let code = fuzz("scenes", MOST_MEMORY, |random| {
        let read = match random.below(4) {
            0 => seeds.read_variant(random),
            1 => seeds.read_tables(random),
            _ => seeds.read_scene(random),
        };
        if let Err(error) = read {
            check_message(&error);
        }
    });
    if code == ExitCode::SUCCESS {
        let _ = fs::remove_dir_all(&folder);
    } else {
        eprintln!("the last case is in {}: scene.ron, ci/variant.ron, or shaken.ron with table.csv", folder.display());
    }
    code
}

/// What is spoiled.
struct Seeds {
    /// Where files are written; the scenes of `variants` lie there.
    folder: PathBuf,
    scenes: Vec<String>,
    variants: Vec<String>,
    words: Vec<String>,
}

impl Seeds {
    /// The scenes that are shipped, each at the coarsest spacing at which it can be put into effect, and the variants of them that
    /// are so coarse that they are tested.
    fn new(folder: &Path) -> Self {
        let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
        let scenes: Vec<String> = files(&shipped).iter().filter_map(|file| coarsest(file)).collect();
        let variants: Vec<String> =
            files(&shipped.join("ci")).iter().filter_map(|file| fs::read_to_string(file).ok()).collect();
        fs::create_dir_all(folder.join("ci")).expect("the folder for temporary files can be written");
        for file in files(&shipped) {
            fs::copy(&file, folder.join(file.file_name().unwrap_or_default())).expect("it can be written");
        }
        println!("{} scenes and {} variants are spoiled", scenes.len(), variants.len());
        let texts = scenes.iter().chain(&variants).map(String::as_str).chain([SHAKEN]);
        let words = texts.flat_map(tokens).map(str::to_owned).collect();
        Self { folder: folder.to_owned(), scenes, variants, words }
    }

    fn read_scene(&self, random: &mut Random) -> Result<(), UserError> {
        let scene = &self.scenes[random.below(self.scenes.len())];
        let file = self.write("scene.ron", self.spoilt(scene, random).as_bytes());
        self.put_into_effect(open_document(&file, &[])?, random)
    }

    fn read_variant(&self, random: &mut Random) -> Result<(), UserError> {
        let variant = &self.variants[random.below(self.variants.len())];
        let file = self.write("ci/variant.ron", self.spoilt(variant, random).as_bytes());
        self.put_into_effect(open_document(&file, &[])?, random)
    }

    /// A scene with a file that is spoiled, and now and then the scene itself as well.
    fn read_tables(&self, random: &mut Random) -> Result<(), UserError> {
        let mut table = self.spoilt(TABLE, random).into_bytes();
        if random.below(4) == 0 {
            let at = random.below(table.len());
            table.get_mut(at).into_iter().for_each(|byte| *byte = random.next() as u8);
        }
        self.write("table.csv", &table);
        let scene = if random.below(4) == 0 { self.spoilt(SHAKEN, random) } else { SHAKEN.to_owned() };
        let file = self.write("shaken.ron", scene.as_bytes());
        self.put_into_effect(open_document(&file, &[])?, random)
    }

    /// The text with up to four tokens changed.
    fn spoilt(&self, text: &str, random: &mut Random) -> String {
        let mut tokens: Vec<String> = tokens(text).into_iter().map(str::to_owned).collect();
        for _ in 0..=random.below(3) {
            spoil(&mut tokens, &self.words, random);
        }
        tokens.concat()
    }

    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.folder.join(name);
        fs::write(&path, bytes).expect("it can be written");
        path
    }

    /// Puts a scene into effect, now and then with an override.
    fn put_into_effect(&self, mut document: Document, random: &mut Random) -> Result<(), UserError> {
        if random.below(4) == 0 {
            let word = |random: &mut Random| self.words[random.below(self.words.len())].clone();
            let path: Vec<String> = (0..=random.below(4)).map(|_| word(random).trim_matches('"').to_owned()).collect();
            document = document.set(&path.join("."), &word(random))?;
        }
        open(StandardPlugins, document).map(|_| ())
    }
}

/// A message can be shown, and the place that it names is one of its text.
fn check_message(error: &UserError) {
    assert!(!error.message().is_empty(), "a message without a word");
    let shown = error.render(false);
    assert!(shown.contains(error.message()), "the message is not shown: {shown}");
    if let Some(place) = error.place() {
        let (line, column) = place.line_column();
        assert!(place.text.get(place.span.clone()).is_some(), "{error}: {:?} is no part of the text", place.span);
        assert!(line <= place.text.lines().count().max(1) + 1 && column >= 1, "{error}: no such line");
    }
}

/// The scenes in a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).expect("there are scenes").filter_map(Result::ok);
    let mut files: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some()).collect();
    files.sort();
    files
}

/// A scene at the coarsest spacing at which it can be put into effect.
fn coarsest(file: &Path) -> Option<String> {
    let scene = open_document(file, &[]).ok()?;
    let spacing: f64 = scene.read("spacing").ok()?;
    [16.0, 8.0, 4.0, 2.0, 1.0].into_iter().find_map(|factor| {
        let coarse = scene.clone().set("spacing", &format!("{:?}", factor * spacing)).ok()?;
        open(StandardPlugins, coarse.clone()).ok().map(|_| coarse.text().to_string())
    })
}

/// Words, numbers, texts in quotes, and every other character by itself; together they are the text.
fn tokens(text: &str) -> Vec<&str> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let is_word = |letter: char| letter.is_alphanumeric() || matches!(letter, '_' | '.' | '-' | '+');
        let length = match first {
            '"' => rest[1..].find('"').map_or(rest.len(), |end| end + 2),
            '/' if rest.starts_with("//") => rest.find('\n').unwrap_or(rest.len()),
            first if is_word(first) => rest.find(|letter| !is_word(letter)).unwrap_or(rest.len()),
            first => first.len_utf8(),
        };
        let (token, after) = rest.split_at(length);
        found.push(token);
        rest = after;
    }
    found
}

/// Numbers that are seldom meant. None makes a scene much larger than it was without making it larger than is allowed.
const NUMBERS: [&str; 14] =
    ["0", "0.0", "-0.0", "-1", "1", "2", "3", "1e-300", "1e300", "NaN", "inf", "-inf", "99999999999999999999", "1e"];

const MARKS: [&str; 14] = ["(", ")", "[", "]", "{", "}", ",", ":", "\"", "r#\"", "/*", "'", "ø", "\u{0}"];

/// Changes one token.
fn spoil(scene: &mut Vec<String>, words: &[String], random: &mut Random) {
    let at = random.below(scene.len());
    let word = words[random.below(words.len())].clone();
    match random.below(10) {
        0 => drop(scene.remove(at)),
        1 => scene.insert(at, scene[at].clone()),
        2 => scene.insert(at, word),
        3 => scene[at] = word,
        4 => {
            let other = random.below(scene.len());
            scene.swap(at, other);
        }
        5 => scene.insert(at, MARKS[random.below(MARKS.len())].to_owned()),
        6 => scene.truncate(at + 1),
        7 => scene[at] = misspelt(&scene[at], random),
        _ => {
            let numbers: Vec<usize> = (0..scene.len()).filter(|k| scene[*k].parse::<f64>().is_ok()).collect();
            if let Some(&at) = numbers.get(random.below(numbers.len())) {
                let value: f64 = scene[at].parse().unwrap_or_default();
                let factor = [-1.0, 0.5, 2.0, 0.99, 1.01][random.below(5)];
                let special = NUMBERS[random.below(NUMBERS.len())].to_owned();
                scene[at] = if random.below(2) == 0 { special } else { format!("{:?}", value * factor) };
            }
        }
    }
    if scene.is_empty() {
        scene.push(String::new());
    }
}

/// A word with two letters exchanged, or one less.
fn misspelt(word: &str, random: &mut Random) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    let at = random.below(letters.len());
    match letters.get(at + 1) {
        Some(_) => letters.swap(at, at + 1),
        None => drop(letters.pop()),
    }
    letters.into_iter().collect()
}
