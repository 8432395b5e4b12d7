//! The program as its users meet it: exit codes, messages, the JSON object, logs of runs that end in every way.

#[path = "support/program.rs"]
mod program;

use std::fs;
use std::path::{Path, PathBuf};

use mcap::MessageStream;
use mcap::read::Options;
use program::{Folder, Ran, TANK, assert_parts};
use serde_json::Value;

impl Folder {
    /// A folder with this scene as `tank.ron`.
    fn with(name: &str, scene: &str) -> Self {
        let folder = Self::new(name);
        folder.write("tank.ron", scene);
        folder
    }

    fn tank(name: &str) -> Self {
        Self::with(name, TANK)
    }

    fn log(&self) -> PathBuf {
        self.path("runs/tank.mcap")
    }
}

/// The tank with an expectation that is met.
fn expecting_mass() -> String {
    let expect = "    expect: [(name: \"mass\", of: \"energy.mass\", is: Between(1.0, 25.0))],\n)\n";
    TANK.replace("\n)\n", &format!("\n{expect}"))
}

/// Number of messages of a topic in a log, whole or torn.
fn messages(log: &Path, topic: &str) -> usize {
    let bytes = fs::read(log).unwrap();
    let stream = MessageStream::new_with_options(&bytes, Options::IgnoreEndMagic.into()).unwrap();
    stream.map_while(Result::ok).filter(|message| message.channel.topic == topic).count()
}

/// What the run had to say, as it stands in the log.
fn log_lines(log: &Path) -> Vec<String> {
    let bytes = fs::read(log).unwrap();
    let messages = MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    let said = messages.filter(|message| message.channel.topic == "/log");
    said.map(|message| String::from_utf8_lossy(&message.data).into_owned()).collect()
}

fn is_finished(log: &Path) -> bool {
    matches!(mcap::Summary::read(&fs::read(log).unwrap()), Ok(Some(_)))
}

#[test]
fn a_run_ends_with_0_and_a_finished_log() {
    let folder = Folder::tank("done");
    let ran = folder.run(&["run", "tank.ron"]);
    ran.ended_with(0);
    assert_parts(&ran.out(), &["done at t = 0.05 s", "200 fluid", "runs/tank.mcap"]);
    assert!(is_finished(&folder.log()));
    assert_eq!(messages(&folder.log(), "/particles"), 6);
    assert_eq!(messages(&folder.log(), "/walls"), 1);
    assert_eq!(messages(&folder.log(), "/structures"), 0);
    assert_eq!(messages(&folder.log(), "/steps"), 11);
    assert_eq!(messages(&folder.log(), "/log"), 2);
}

#[test]
fn the_log_holds_the_scene_and_every_number() {
    let folder = Folder::tank("numbers");
    folder.run(&["run", "tank.ron", "--until", "0.001", "--set", "spacing=0.02", "--out", "a/b.mcap"]);
    let bytes = fs::read(folder.path("a/b.mcap")).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let attachment = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!(attachment.name, "tank.ron");
    assert_eq!(String::from_utf8_lossy(&attachment.data), TANK.replace("spacing: 0.01", "spacing: 0.02"));
    let record = |name: &str| {
        let index = summary.metadata_indexes.iter().find(|index| index.name == name).unwrap();
        mcap::read::metadata(&bytes, index).unwrap().metadata
    };
    assert_eq!(record("overrides")["spacing"], "0.02");
    assert_eq!(record("parameters")["phases.water.rheology.viscosity"], "0.001");
    assert_eq!(record("defaults")["time_step.sound"], "0.25");
    assert_eq!(record("derived")["particles.fluid"], "50");
    assert_eq!(record("derived")["smoothing_length [m]"], "0.024");
    assert!(record("program").contains_key("threads"));
}

#[test]
fn json_is_one_object_and_nothing_else() {
    let folder = Folder::tank("json");
    let ran = folder.run(&["run", "tank.ron", "--json", "--threads", "1", "--set", "spacing=0.02"]);
    let json = ran.json();
    assert_eq!((json["scene"].as_str(), json["dimension"].as_u64()), (Some("tank.ron"), Some(2)));
    assert_eq!((json["spacing"].as_f64(), json["particles"]["fluid"].as_u64()), (Some(0.02), Some(50)));
    assert!(json["particles"]["wall"].as_u64() > Some(0) && json["particles"]["structure"] == 0);
    assert!(json["steps"].as_u64() > Some(10) && json["time"] == 0.05 && json["threads"] == 1);
    assert!(json["wall_s"].as_f64() > Some(0.0) && json["updates_per_s"].as_f64() > Some(0.0));
    assert_eq!((json["log"].as_str(), json["end"].as_str()), (Some("runs/tank.mcap"), Some("done")));
    assert_eq!(json["checks"].as_array().map(Vec::len), Some(0));
}

#[test]
fn expectations_decide_between_0_and_1() {
    for (name, most, code) in [("met", 25.0, 0), ("failed", 15.0, 1)] {
        let expect = format!("    expect: [(name: \"mass\", of: \"energy.mass\", is: Between(1.0, {most:?}))],\n)\n");
        let folder = Folder::with(name, &TANK.replace("\n)\n", &format!("\n{expect}")));
        let ran = folder.run(&["run", "tank.ron", "--json"]);
        ran.ended_with(code);
        let check = &ran.json()["checks"][0];
        assert_eq!((&check["name"], &check["pass"]), (&Value::from("mass"), &Value::from(code == 0)));
        assert!((check["value"].as_f64().unwrap() - 20.0).abs() < 0.1, "{check}");
        let (expected, tolerance) = (check["expected"].as_f64().unwrap(), check["tolerance"].as_f64().unwrap());
        assert_eq!((expected - tolerance, expected + tolerance, &check["unit"]), (1.0, most, &Value::from("kg")));
        let ran = folder.run(&["test", "tank.ron"]);
        ran.ended_with(code);
        assert!(ran.out().contains(if code == 0 { "pass" } else { "FAIL" }), "{}", ran.out());
        let ran = folder.run(&["test", "--scenes", "."]);
        ran.ended_with(code);
        // A part of a run says nothing about its end.
        assert_eq!(folder.run(&["run", "tank.ron", "--until", "0.01"]).code(), Some(0));
    }
}

#[test]
fn misspelt_fields_are_shown_with_the_nearest_name() {
    let folder = Folder::with("misspelt", &TANK.replace("reference_density", "refrence_density"));
    let parts = ["tank.ron:7:24", "\"water\": (refrence_density", "did you mean `reference_density`?"];
    folder.run(&["run", "tank.ron"]).is_refused_with(&parts);
    folder.run(&["check", "tank.ron"]).is_refused_with(&parts);
    assert!(!folder.path("runs").exists());
}

#[test]
fn a_missing_field_is_told_with_what_it_is() {
    let folder = Folder::with("missing-field", &TANK.replace("    spacing: 0.01,\n", ""));
    folder
        .run(&["check", "tank.ron"])
        .is_refused_with(&["`spacing` is missing: the initial distance of particles (m)"]);
}

#[test]
fn numbers_that_are_none_are_refused() {
    for (name, wrong) in [("nan", "NaN"), ("inf", "inf")] {
        let folder = Folder::with(name, &TANK.replace("spacing: 0.01", &format!("spacing: {wrong}")));
        folder.run(&["run", "tank.ron"]).is_refused_with(&["tank.ron:4:14", "finite"]);
    }
}

#[test]
fn overrides_are_as_strict_as_the_scene() {
    let folder = Folder::tank("overrides");
    let refused = |set: &str, parts: &[&str]| folder.run(&["run", "tank.ron", "--set", set]).is_refused_with(parts);
    refused("spacing=-1", &["must be greater than 0, got -1 m", "set by --set spacing=-1"]);
    refused("spacng=1", &["did you mean `spacing`?"]);
    refused("phases.wtaer.reference_density=1", &["no `wtaer`", "did you mean `water`?"]);
    refused("phases.water.rheology.viscosty=1", &["did you mean `viscosity`?"]);
    refused("spacing", &["expected `path=value`"]);
    let parts = ["unknown field `max_sped`", "did you mean `max_speed`?", "set by --set equation_of_state.max_sped=2"];
    refused("equation_of_state.max_sped=2", &parts);
    refused("eqation_of_state.max_speed=2", &["did you mean `equation_of_state`?", "set by --set eqation"]);
}

#[test]
fn missing_files_and_wrong_options_are_refused() {
    let folder = Folder::tank("missing");
    folder.run(&["run", "tnak.ron"]).is_refused_with(&["tnak.ron", "did you mean `tank.ron`?"]);
    folder.run(&["run", "tank.ron", "--until", "-1"]).is_refused_with(&["--until"]);
    folder.run(&["run", "tank.ron", "--threads", "0"]).is_refused_with(&["--threads"]);
    folder.run(&["run", "tank.ron", "--out", "tank.ron/x.mcap"]).is_refused_with(&["tank.ron", "--out"]);
    folder.run(&["run", "tank.ron", "--out", "."]).is_refused_with(&["cannot create the log", "--out"]);
    folder.run(&["scenes"]).is_refused_with(&["folder of scenes", "--scenes"]);
    folder.run(&["test", "--scenes", "."]).is_refused_with(&["no scene has expectations"]);
}

#[test]
fn a_log_replaces_nothing_but_a_log() {
    let folder = Folder::tank("replaces");
    let run = |out: &str| folder.run(&["run", "tank.ron", "--until", "0.001", "--quiet", "--out", out]);
    folder.write("short", "x");
    for out in ["tank.ron", "short"] {
        run(out).is_refused_with(&[&format!("{out} exists and is not a log"), "--out"]);
    }
    assert_eq!(fs::read_to_string(folder.path("tank.ron")).unwrap(), TANK);
    folder.write("new.mcap", "");
    for _ in 0..2 {
        let ran = run("new.mcap");
        ran.ended_with(0);
    }
}

#[test]
fn a_diverging_run_ends_with_3_and_a_log_that_reads() {
    let folder = Folder::tank("diverging");
    let sets = ["--set", "fluids.0.velocity=(50.0, 0.0)", "--set", "equation_of_state.max_speed=1"];
    let ran = folder.run(&[&["run", "tank.ron", "--json"][..], &sets].concat());
    ran.ended_with(3);
    let parts = [
        "diverged at t = ",
        "particle ",
        "`water`",
        "position (",
        "viscosity 0.001 Pa s",
        "neighbours (about 39 in the midst of a fluid)",
        "--set equation_of_state.max_speed=",
        "closed and readable",
    ];
    assert_parts(&ran.err(), &parts);
    let json = ran.json();
    assert_eq!(json["end"], "diverged");
    let told = &json["divergence"];
    assert!(told["time"].as_f64() > Some(0.0) && told["particle"].is_u64() && told["phase"] == "water");
    // c = 10 v_max.
    assert_eq!((&told["limit"]["name"], &told["limit"]["unit"]), (&Value::from("speed"), &Value::from("m/s")));
    assert!(told["limit"]["value"].as_f64() > Some(9.9) && told["limit"]["limit"].as_f64() > Some(9.9));
    assert!(told["neighbours"][0]["count"].as_u64() > Some(0) && told["advice"][0]["text"].is_string());
    assert!(
        log_lines(&folder.log())
            .iter()
            .any(|line| line.contains("neighbours (about 39") && line.contains("What to try"))
    );
    assert!(is_finished(&folder.log()));
    assert_eq!(messages(&folder.log(), "/particles"), 2, "the start and the state that diverged");
}

#[test]
fn a_variant_is_its_scene_with_other_values() {
    let folder = Folder::tank("variant");
    folder.write("coarse.ron", "Variant(of: \"tank.ron\", set: {\"spacing\": \"0.02\"})");
    assert_eq!(folder.run(&["run", "coarse.ron", "--json"]).json()["particles"]["fluid"], 50);
    folder.write("wrong.ron", "Variant(of: \"tank.ron\", set: {\"spacing\": \"-1\"})");
    folder.run(&["run", "wrong.ron"]).is_refused_with(&["wrong.ron:1:42", "must be greater than 0"]);
}

#[test]
fn check_tells_the_run_before_it_is_run() {
    let folder = Folder::tank("check");
    let ran = folder.run(&["check", "tank.ron"]);
    ran.ended_with(0);
    let parts = [
        "200 fluid",
        "v_max",
        "Δt by viscosity",
        "memory",
        "time_step.sound = 0.25",
        "1/2 < ρ/ρ0 < 2, Δt ≥ ",
        "QuinticSpline, support 0.036 m",
        // Documented in the stages and probes that use them.
        "strain_rate.least_determinant = 0.1",
        "free_surface.least_filling = 0.5",
        "probes.pressure_point.dry_beyond = 1.5 spacings",
    ];
    assert_parts(&ran.out(), &parts);
    assert!(!folder.path("runs").exists());
    let ran = folder.run(&["check", "tank.ron", "--set", "spacing=0.0098"]);
    assert_parts(&ran.out(), &["Warning: `fluids.0.shape`: x = 0.2 m of `max`"]);
}

#[test]
fn help_names_the_page_of_fields() {
    let folder = Folder::tank("help");
    for command in ["run", "check", "test"] {
        assert!(folder.run(&[command, "--help"]).out().contains("docs/scene.md"), "{command}");
    }
}

#[test]
fn scenes_are_listed_a_line_each() {
    let folder = Folder::tank("scenes");
    let ran = folder.run(&["scenes", "--scenes", "."]);
    assert_parts(&ran.out(), &["tank.ron  A small tank  2D         0.01 m"]);
}

#[test]
fn a_scene_that_is_wrong_does_not_hide_the_others() {
    let folder = Folder::with("others", &expecting_mass());
    folder.write("a.ron", TANK.replace("spacing", "spacng"));
    for arguments in [&["scenes", "--scenes", "."][..], &["test", "--scenes", "."], &["test", "a.ron", "tank.ron"]] {
        let ran = folder.run(arguments);
        ran.ended_with(2);
        assert_parts(&ran.err(), &["did you mean `spacing`?"]);
        assert_parts(&ran.out(), &["tank.ron"]);
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_test_tells_what_was_done() {
    use std::io::{BufRead, BufReader};

    let folder = Folder::with("told", &expecting_mass());
    folder.write("long.ron", expecting_mass().replace("end_time: 0.05", "end_time: 10000.0"));
    let mut child = folder.start(&["test", "tank.ron", "long.ron"]);
    let told = BufReader::new(child.stderr.take().unwrap()).lines().map_while(Result::ok);
    let mut told = told.skip_while(|line| !line.contains("long.ron"));
    assert!(told.next().is_some(), "the second scene was never begun");
    program::interrupt(&child, "INT");
    let ran = Ran::of(child);
    ran.ended_with(130);
    assert!(ran.out().contains("tank.ron  mass") && !ran.out().contains("long.ron"), "{}", ran.out());
}

#[test]
fn a_killed_run_leaves_a_log_that_reads() {
    let folder = Folder::tank("killed");
    let mut child = folder.start_long_run();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!is_finished(&folder.log()));
    assert!(messages(&folder.log(), "/particles") >= 2);
    assert!(messages(&folder.log(), "/steps") >= 2);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_ends_the_run_with_a_message() {
    let ran = Folder::tank("full").run(&["run", "tank.ron", "--quiet", "--out", "/dev/full"]);
    ran.is_refused_with(&["cannot write the log /dev/full", "No space left on device"]);
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_with_130_and_a_finished_log() {
    for signal in ["INT", "TERM"] {
        let folder = Folder::tank(&format!("interrupted-{signal}"));
        let mut child = folder.start_long_run();
        program::interrupt(&child, signal);
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert!(is_finished(&folder.log()), "{signal}");
    }
}
