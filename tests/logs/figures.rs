//! What `storegga plot`, `movie` and `export` make of a log.

use std::path::Path;

use storegga::results::{PARTICLES, Results};

use crate::program::{Folder, Ran};

/// Width and height of a PNG, by the head that every PNG has.
fn size_of_png(path: &Path) -> (u32, u32) {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

fn plot(folder: &Folder, arguments: &[&str]) -> Ran {
    folder.run(&[&["plot", "runs/tank.mcap"], arguments].concat())
}

#[test]
fn with_nothing_asked_for_fields_and_every_series_are_drawn() {
    let folder = Folder::tank("plot_all");
    folder.log();
    let ran = plot(&folder, &[]);
    ran.ended_with(0);
    let results = Results::open(&folder.path("runs/tank.mcap")).unwrap();
    assert!(!results.series.is_empty());
    for name in ["pressure", "speed"] {
        let (width, height) = size_of_png(&folder.path(&format!("plots/tank/{name}.png")));
        assert!(width > 500 && height > 500, "{width} × {height}");
    }
    for series in &results.series {
        assert!(ran.out().contains(&format!("plots/tank/{}_", series.name())), "{}", series.topic);
    }
}

#[test]
fn a_vector_figure_names_its_axes_and_units() {
    let folder = Folder::tank("plot_svg");
    folder.log();
    plot(&folder, &["--field", "pressure", "--arrows", "--series", "energy.kinetic", "--format", "svg"]).ended_with(0);
    let text = |name: &str| std::fs::read_to_string(folder.path(&format!("plots/tank/{name}.svg"))).unwrap();
    for label in ["x (m)", "y (m)", "pressure (Pa)", "m/s", "t = "] {
        assert!(text("pressure").contains(label), "{label}");
    }
    for label in ["time (s)", "energy: kinetic (J)"] {
        assert!(text("energy_kinetic").contains(label), "{label}");
    }
}

#[test]
fn a_result_fits_itself_and_a_shifted_copy_as_much_as_it_should() {
    let folder = Folder::tank("plot_reference");
    folder.log();
    let results = Results::open(&folder.path("runs/tank.mcap")).unwrap();
    let series = results.series.iter().find(|series| series.name() == "energy").unwrap();
    let values = &series.field("potential").unwrap().values;
    let write = |name: &str, shift: f64| {
        let rows = series.times.iter().zip(values).map(|(t, y)| format!("{t:?},{:?}\n", y + shift));
        folder.write(name, format!("t_s,J\n{}", rows.collect::<String>()));
    };
    write("same.csv", 0.0);
    let fit = |file: &str| plot(&folder, &["--series", "energy.potential", "--reference", file]).out();
    assert!(fit("same.csv").contains("R² = 1.000000, L2 = 0 over"), "{}", fit("same.csv"));
    // Shifted by the standard deviation of the values: R² = 1 − n s²/(n s²) = 0.
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let deviation = (values.iter().map(|y| (y - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
    assert!(deviation > 0.0);
    write("shifted.csv", deviation);
    let told = fit("shifted.csv:t_s,J");
    assert!(told.contains("R² = 0.000000") || told.contains("R² = -0.000000"), "{told}");
}

#[test]
fn mistakes_are_named() {
    let folder = Folder::tank("plot_mistakes");
    folder.log();
    folder.write("words.csv", "t,y\n0,one\n");
    for (arguments, parts) in [
        (&["--field", "presure"] as &[&str], &["presure", "did you mean `pressure`?"] as &[&str]),
        (&["--series", "enrgy"], &["enrgy", "did you mean `energy`?"]),
        (&["--series", "energy.kinetik"], &["kinetik", "did you mean `kinetic`?"]),
        (&["--field", "pressure", "--at", "99"], &["--at 99", "frames from 0 to"]),
        (&["--profile", "pressure"], &["--profile pressure", "surface:<phase>"]),
        (&["--profile", "surface:mud"], &["phase `mud`"]),
        (&["--series", "energy.kinetic", "--reference", "none.csv"], &["none.csv"]),
        (&["--series", "energy.kinetic", "--reference", "words.csv"], &["line 2", "`one`"]),
        (&["--field", "speed", "--reference", "words.csv"], &["--reference needs one"]),
    ] {
        plot(&folder, arguments).is_refused_with(parts);
    }
    folder.run(&["export", "runs/tank.mcap", "--vtk", "vtk", "--from", "99"]).is_refused_with(&["no frames"]);
    folder.write("scene.txt", "Scene()");
    folder.run(&["movie", "scene.txt"]).is_refused_with(&["it is not a log"]);
}

#[test]
fn an_animation_has_the_wanted_frames() {
    let folder = Folder::tank("movie");
    folder.log();
    let times = Results::open(&folder.path("runs/tank.mcap")).unwrap().frame_times(PARTICLES);
    assert!(times.len() > 3, "{times:?}");
    // What is not named as an APNG would be taken for something else.
    for (out, parts) in [
        ("slide.mp4", ["got slide.mp4", "`ffmpeg -i slide.png slide.mp4`"]),
        ("slide", ["got slide", "write slide.png"]),
    ] {
        folder.run(&["movie", "runs/tank.mcap", "--out", out]).is_refused_with(&parts);
        assert!(!folder.path(out).exists());
    }
    folder.run(&["movie", "runs/tank.mcap", "--field", "speed", "--every", "2"]).ended_with(0);
    let path = folder.path("plots/tank/speed_movie.png");
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let frames = reader.info().animation_control().unwrap().num_frames;
    assert_eq!(frames as usize, times.len().div_ceil(2));
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    for _ in 0..frames {
        reader.next_frame(&mut pixels).unwrap();
        assert!(pixels.iter().any(|byte| *byte != pixels[0]), "a frame is empty");
    }
}
