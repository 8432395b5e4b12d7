//! Spoils scenes token by token and reads them: `cargo run --example fuzz_scenes -- --seconds 60`.
//!
//! Whatever a scene says, the program must end, not panic and not ask for much memory; it is either put into effect or refused
//! with a message that can be shown and whose place lies in the text.

#[path = "../../../examples/fuzz/mod.rs"]
mod fuzz;

use std::path::Path;
use std::process::ExitCode;

use storegga::app::open;
use storegga::error::UserError;
use storegga::scene::{Document, open_document};
use storegga_standard::StandardPlugins;

use fuzz::{Random, fuzz};

/// Memory (bytes) that one scene may take: it has some thousands of particles at most.
const MOST_MEMORY: usize = 1 << 30;

fn main() -> ExitCode {
    let seeds = seeds();
    let words: Vec<String> = seeds.iter().flat_map(|seed| tokens(seed)).map(str::to_owned).collect();
    fuzz("scenes", MOST_MEMORY, |random| {
        let seed = &seeds[random.below(seeds.len())];
        let mut scene: Vec<String> = tokens(seed).into_iter().map(str::to_owned).collect();
        for _ in 0..=random.below(3) {
            spoil(&mut scene, &words, random);
        }
        let text: String = scene.concat();
        if let Err(error) = read(&text, &words, random) {
            check_message(&error);
        }
    })
}

/// Reads a scene, now and then with an override, and puts it into effect.
fn read(text: &str, words: &[String], random: &mut Random) -> Result<(), UserError> {
    let mut document = Document::parse("scene.ron", text)?;
    if random.below(4) == 0 {
        let word = |random: &mut Random| words[random.below(words.len())].clone();
        let path: Vec<String> = (0..=random.below(4)).map(|_| word(random).trim_matches('"').to_owned()).collect();
        document = document.set(&path.join("."), &word(random))?;
    }
    open(StandardPlugins, document).map(|_| ())
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

/// The scenes that are shipped, each at the coarsest spacing at which it can be put into effect.
fn seeds() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let entries = std::fs::read_dir(&folder).expect("there are scenes").filter_map(Result::ok);
    let mut files: Vec<_> = entries.map(|entry| entry.path()).filter(|path| path.extension().is_some()).collect();
    files.sort();
    let coarsened = files.iter().filter_map(|file| {
        let scene = open_document(file, &[]).ok()?;
        let spacing: f64 = scene.read("spacing").ok()?;
        [16.0, 8.0, 4.0, 2.0, 1.0].into_iter().find_map(|factor| {
            let coarse = scene.clone().set("spacing", &format!("{:?}", factor * spacing)).ok()?;
            open(StandardPlugins, coarse.clone()).ok().map(|_| coarse.text().to_string())
        })
    });
    let seeds: Vec<String> = coarsened.collect();
    println!("{} scenes of {} are spoiled", seeds.len(), files.len());
    seeds
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
