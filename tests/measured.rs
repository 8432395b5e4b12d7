//! The measured figures that scenes compare with, against the files they were taken from: those in the folder that the
//! environment variable `STOREGGA_DATA` names. Without it nothing is compared, and the test says so (`-- --nocapture` shows it).

use std::fs;
use std::path::{Path, PathBuf};

/// A time (s) that stands in a scene: that of the first row of a file whose second column reaches a value.
struct Time {
    scene: &'static str,
    /// As the scene has it.
    seconds: &'static str,
    file: &'static str,
    reaches: f64,
    /// Unit (s) of the file's times.
    unit: f64,
}

/// √(a/2g) of a column 57.15 mm wide, and √(H/g) of one 0.3 m high.
const FRONT: f64 = 0.053_971;
const IMPACT: f64 = 0.174_874;

#[rustfmt::skip]
const TIMES: [Time; 8] = [
    Time { scene: "dam_break_front", seconds: "0.1375", file: "dambreak_martin_moyce_1952_a2.25in.csv", reaches: 2.995, unit: FRONT },
    Time { scene: "dam_break_front", seconds: "0.3682", file: "dambreak_martin_moyce_1952_a2.25in.csv", reaches: 9.986, unit: FRONT },
    Time { scene: "dam_break_front", seconds: "0.4985", file: "dambreak_martin_moyce_1952_a2.25in.csv", reaches: 13.970, unit: FRONT },
    Time { scene: "dam_break_front", seconds: "0.1467", file: "dambreak_koshizuka_oka_1996.csv", reaches: 3.003, unit: FRONT },
    Time { scene: "dam_break_2d", seconds: "0.4258", file: "dambreak_lobovsky_2014_p1.csv", reaches: 0.5, unit: IMPACT },
    Time { scene: "dam_break_2d", seconds: "0.4453", file: "dambreak_lobovsky_2014_p3.csv", reaches: 0.5, unit: IMPACT },
    Time { scene: "dam_break_2d", seconds: "0.5105", file: "dambreak_lobovsky_2014_p4.csv", reaches: 0.3, unit: IMPACT },
    Time { scene: "dam_break_2d", seconds: "0.4360", file: "dambreak_buchner_2002_pressure.csv", reaches: 0.15, unit: IMPACT },
];

/// A table of measured figures that scenes compare with, in `scenes/measured`, and the file that it was taken from.
struct Table {
    table: &'static str,
    file: &'static str,
    /// Time (s) in the scene at which the file's clock shows 0.
    start: f64,
    /// Unit (s) of the file's times.
    time_unit: f64,
    /// Columns of the file, in the order of the table, and the unit (that of the table) in which each is given.
    columns: &'static [(usize, f64)],
}

/// √(H/g) and ρgH of a column 0.55 m high.
const BOX_TIME: f64 = 0.236_780;
const BOX_PRESSURE: f64 = 5395.5;

#[rustfmt::skip]
const TABLES: [Table; 4] = [
    Table { table: "zhou_teng_2010_a", file: "zhou_teng_2010_Case_A_W.csv", start: 0.364, time_unit: 1.0, columns: &[(1, 1e-3), (2, 1e-3)] },
    Table { table: "enet_grilli_d100", file: "enet_grilli_d100.csv", start: 0.2, time_unit: 1.0, columns: &[(1, 1e-3), (2, 1e-3), (3, 1e-3)] },
    Table { table: "kleefsman_2005_p1", file: "dambreak3d_kleefsman_2005_p1.csv", start: 0.0, time_unit: BOX_TIME, columns: &[(1, BOX_PRESSURE)] },
    Table { table: "kleefsman_2005_p3", file: "dambreak3d_kleefsman_2005_p3.csv", start: 0.0, time_unit: BOX_TIME, columns: &[(1, BOX_PRESSURE)] },
];

/// A file of the folder with the shipped scenes.
fn shipped(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes").join(file)
}

/// The shipped scene, as text.
fn scene(name: &str) -> String {
    fs::read_to_string(shipped(&format!("{name}.ron"))).expect("a shipped scene")
}

/// The folder with measured data, or `None` after saying that there is none.
fn data() -> Option<PathBuf> {
    let folder = std::env::var_os("STOREGGA_DATA");
    if folder.is_none() {
        println!("skipped: STOREGGA_DATA names no folder with measured data");
    }
    folder.map(PathBuf::from)
}

/// Rows of a file of measured data, without its comments and its head.
fn rows(folder: &Path, file: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The same, as numbers.
fn numbers(folder: &Path, file: &str) -> Vec<Vec<f64>> {
    let number = |text: &String| text.parse().unwrap_or_else(|_| panic!("{file}: {text}"));
    rows(folder, file).iter().map(|row| row.iter().map(number).collect()).collect()
}

/// The first time at which a series reaches a value, on the straight line between two rows.
fn first_time(series: &[(f64, f64)], value: f64) -> Option<f64> {
    let pair = series.windows(2).find(|pair| pair[0].1 < value && pair[1].1 >= value)?;
    let ((t0, y0), (t1, y1)) = (pair[0], pair[1]);
    Some(t0 + (t1 - t0) * (value - y0) / (y1 - y0))
}

#[test]
fn figures_in_scenes_are_those_that_were_measured() {
    let Some(folder) = data() else { return };
    for Time { scene: name, seconds, file, reaches, unit } in TIMES {
        let series = numbers(&folder, file).into_iter().map(|row| (row[0], row[1]));
        // Buchner's sensor drifts before anything has reached it.
        let series: Vec<_> = series.skip_while(|(t, _)| unit == IMPACT && *t < 2.0).collect();
        let measured = unit * first_time(&series, reaches).unwrap_or_else(|| panic!("{file} never reaches {reaches}"));
        let quoted: f64 = seconds.parse().expect("a number");
        assert!((quoted / measured - 1.0).abs() < 0.003, "{name}: {quoted} s, {file}: {measured} s");
        assert!(scene(name).contains(&format!("Number({seconds})")), "{name} compares with {seconds} s");
    }
    let coefficients = rows(&folder, "cylinder_schafer_turek_2d1_2d2.csv");
    for name in ["cD", "cL"] {
        let row = coefficients.iter().find(|row| row[0] == "2D-1" && row[2] == name).expect("the coefficient");
        assert!(scene("cylinder_drag").contains(&format!("Number({})", row[3])), "{row:?}");
    }
}

#[test]
fn tables_of_scenes_are_rows_that_were_measured() {
    let Some(folder) = data() else { return };
    for Table { table, file, start, time_unit, columns } in TABLES {
        let measured = numbers(&folder, file);
        let rows = numbers(&shipped("measured"), &format!("{table}.csv"));
        assert!(!rows.is_empty(), "{table} has rows");
        for row in rows {
            // Times are rounded to a tenth of a millisecond, values to four digits.
            let source = measured.iter().find(|source| (start + time_unit * source[0] - row[0]).abs() < 1e-4);
            let source = source.unwrap_or_else(|| panic!("{file} has nothing at {} s", row[0]));
            assert_eq!(row.len(), 1 + columns.len(), "{table}");
            for (value, (column, unit)) in row[1..].iter().zip(columns) {
                let known = source[*column] * unit;
                assert!((value - known).abs() <= 1e-4 * known.abs() + 1e-12, "{table}: {value}, {file}: {known}");
            }
        }
    }
}

/// The least and the greatest value that `study` asks of its measure `name`.
fn asked(study: &str, name: &str) -> (f64, f64) {
    let line = study.lines().find(|line| line.contains(&format!("(name: \"{name}\"")));
    let range = line.and_then(|line| line.split("asked: (").nth(1)?.split(')').next()).expect(name);
    let (least, greatest) = range.split_once(", ").expect(name);
    let number = |text: &str| text.parse().expect("a number");
    (number(least), number(greatest))
}

/// Trough and crest within 30 % of those that Enet & Grilli measured; arrivals, when the surface is first 5 mm down, within 5 % of the time since the
/// release, 0.2 s after the start.
#[test]
fn what_is_asked_of_enet_and_grilli_lies_around_what_was_measured() {
    let Some(folder) = data() else { return };
    let study = fs::read_to_string(shipped("../studies/enet_grilli.ron")).expect("a shipped study");
    let measured = numbers(&folder, "enet_grilli_d100.csv");
    let near = |name: &str, exact: [f64; 2]| {
        let (least, greatest) = asked(&study, name);
        let distance = [least - exact[0], greatest - exact[1]].map(f64::abs);
        let told = format!("{name}: asked {least} to {greatest}, {exact:?}");
        assert!(distance[0].max(distance[1]) < 2e-3 * exact[0].abs(), "{told}");
    };
    for (gauge, column, crest) in [("g1", 1, None), ("g2", 2, Some(1.5..2.1)), ("g4", 3, Some(1.9..2.35))] {
        let down: Vec<_> = measured.iter().map(|row| (row[0], -1e-3 * row[column])).collect();
        let arrival = first_time(&down, 0.005).expect(gauge);
        near(&format!("arrival at {gauge}"), [0.95, 1.05].map(|factor| 0.2 + factor * arrival));
        let trough = down.iter().map(|(_, depth)| *depth).fold(0.0, f64::max);
        near(&format!("trough at {gauge}"), [-1.3 * trough, -0.7 * trough]);
        if let Some(crest) =
            crest.map(|time| down.iter().filter(|(t, _)| time.contains(t)).map(|(_, depth)| -depth).fold(0.0, f64::max))
        {
            near(&format!("crest at {gauge}"), [0.7 * crest, 1.3 * crest]);
        }
    }
}
