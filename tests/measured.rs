//! The measured figures that scenes compare with, against the files they were taken from: those in the folder that the
//! environment variable `STOREGGA_DATA` names. Without it nothing is compared, and the test says so (`-- --nocapture` shows it).

use std::fs;
use std::path::Path;

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

/// The shipped scene, as text.
fn scene(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.ron"));
    fs::read_to_string(path).expect("a shipped scene")
}

/// Rows of a file of measured data, without its comments and its head.
fn rows(folder: &Path, file: &str) -> Vec<Vec<String>> {
    let text = fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// The first time at which a series reaches a value, on the straight line between two rows.
fn first_time(series: &[(f64, f64)], value: f64) -> Option<f64> {
    let pair = series.windows(2).find(|pair| pair[0].1 < value && pair[1].1 >= value)?;
    let ((t0, y0), (t1, y1)) = (pair[0], pair[1]);
    Some(t0 + (t1 - t0) * (value - y0) / (y1 - y0))
}

#[test]
fn figures_in_scenes_are_those_that_were_measured() {
    let Some(folder) = std::env::var_os("STOREGGA_DATA") else {
        println!("skipped: STOREGGA_DATA names no folder with measured data");
        return;
    };
    let folder = Path::new(&folder);
    for Time { scene: name, seconds, file, reaches, unit } in TIMES {
        let number = |text: &String| text.parse::<f64>().unwrap_or_else(|_| panic!("{file}: {text}"));
        let series = rows(folder, file).into_iter().map(|row| (number(&row[0]), number(&row[1])));
        // Buchner's sensor drifts before anything has reached it.
        let series: Vec<_> = series.skip_while(|(t, _)| unit == IMPACT && *t < 2.0).collect();
        let measured = unit * first_time(&series, reaches).unwrap_or_else(|| panic!("{file} never reaches {reaches}"));
        let quoted: f64 = seconds.parse().expect("a number");
        assert!((quoted / measured - 1.0).abs() < 0.003, "{name}: {quoted} s, {file}: {measured} s");
        assert!(scene(name).contains(&format!("Number({seconds})")), "{name} compares with {seconds} s");
    }
    let coefficients = rows(folder, "cylinder_schafer_turek_2d1_2d2.csv");
    for name in ["cD", "cL"] {
        let row = coefficients.iter().find(|row| row[0] == "2D-1" && row[2] == name).expect("the coefficient");
        assert!(scene("cylinder_drag").contains(&format!("Number({})", row[3])), "{row:?}");
    }
}
