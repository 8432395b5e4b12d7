//! What the program says about each kind of mistake in a scene: messages as snapshots, reviewed by reading
//! (`INSTA_UPDATE=always cargo test -p storegga-standard --test mistakes`, then look at `git diff tests/snapshots`).

use std::fs;
use std::path::PathBuf;
use std::process::Command;

const SCENE: &str = r#"Scene(
    title: "A small tank",
    dimension: 2,
    spacing: 0.01,
    gravity: (0.0, -9.81),
    end_time: 0.05,
    phases: {
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
        "mud": (
            reference_density: 1500.0,
            rheology: HerschelBulkley(consistency: 2.0, exponent: 0.5, yield_stress: 10.0, max_viscosity: 50.0),
        ),
    },
    walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.4, 0.4)))},
    structures: {"pipe": (shape: Circle(center: (0.3, 0.05), radius: 0.03))},
    fluids: [
        (phase: "water", shape: Box(min: (0.0, 0.1), max: (0.4, 0.2))),
        (phase: "mud", shape: Box(min: (0.0, 0.0), max: (0.4, 0.1))),
    ],
    probes: {
        "p": PressurePoint(at: (0.2, 0.0)),
        "h": SurfaceHeight(at: (0.2, 0.0)),
    },
    expect: [(name: "head", of: "p.pressure", is: Number(2450.0), within: Relative(0.2))],
)
"#;

/// A folder of one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("storegga-mistakes-{}-{name}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What `storegga check` says to a scene, its exit code first. Of a scene that can be run, the warnings.
fn said(name: &str, scene: &str, arguments: &[&str], files: &[(&str, &str)]) -> String {
    let folder = Folder::new(name);
    for (file, text) in files.iter().chain(&[("scene.ron", scene)]) {
        fs::write(folder.0.join(file), text).unwrap();
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_storegga"));
    let ran = command.args(["check", "scene.ron"]).args(arguments).current_dir(&folder.0).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&ran.stdout), String::from_utf8_lossy(&ran.stderr));
    let warnings = out.find("Warning:").map(|start| &out[start..]).unwrap_or_default();
    let said: Vec<String> = err.lines().chain(warnings.lines()).map(without_all_names).collect();
    format!("exit code {}\n{}", ran.status.code().unwrap_or(-1), said.join("\n"))
}

/// A line of a message without all but the first name of a list, which grows with every plugin.
fn without_all_names(line: &str) -> String {
    for list in ["expected one of ", "(known: "] {
        if let Some((before, names)) = line.split_once(list)
            && let Some((first, _)) = names.split_once(',')
        {
            return format!("{before}{list}{first}, …");
        }
    }
    line.to_owned()
}

fn check(name: &str, said: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/snapshots"));
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!(name, said));
}

/// A scene in which `from` was written as `to`.
fn with(from: &str, to: &str) -> String {
    assert_eq!(SCENE.matches(from).count(), 1, "{from}");
    SCENE.replace(from, to)
}

/// Mistakes that end in exit code 2.
fn refused(name: &str, from: &str, to: &str) {
    let said = said(name, &with(from, to), &[], &[]);
    assert!(said.starts_with("exit code 2\nError: "), "{said}");
    assert!(said.contains("scene.ron:"), "no file, line and column: {said}");
    check(name, &said);
}

/// What is probably not meant, and can be run.
fn warned(name: &str, from: &str, to: &str) {
    let said = said(name, &with(from, to), &[], &[]);
    assert!(said.starts_with("exit code 0\nWarning: "), "{said}");
    check(name, &said);
}

#[test]
fn the_scene_itself_is_sound() {
    assert_eq!(said("sound", SCENE, &[], &[]), "exit code 0\n");
}

#[test]
fn syntax() {
    refused("syntax_bracket", "(0.4, 0.4)))}", "(0.4, 0.4))}");
    refused("syntax_comma", "dimension: 2,", "dimension: 2");
    refused("syntax_quotes", r#"title: "A small tank""#, "title: A small tank");
    refused("syntax_twice", "end_time: 0.05,", "end_time: 0.05, spacing: 0.02,");
}

#[test]
fn names() {
    refused("name_section", "probes: {", "probs: {");
    refused("name_field", "yield_stress", "yeild_stress");
    refused("name_field_missing", "reference_density: 1500.0,", "");
    refused("name_header_missing", "gravity: (0.0, -9.81),", "");
    refused("name_rheology", "HerschelBulkley", "HerschelBulkely");
    refused("name_kernel", "dimension: 2,", "dimension: 2, kernel: QuinticSplin,");
    refused("name_probe", "PressurePoint", "PresurePoint");
    refused("name_shape", "Circle(", "Cirle(");
    refused("name_phase", r#"phase: "mud""#, r#"phase: "mudd""#);
    refused("name_series", "p.pressure", "q.pressure");
    refused("name_series_field", "p.pressure", "p.presure");
    refused("name_line_break", r#""p": "#, r#""p\nq": "#);
    refused("name_escape", "A small tank", r"A \u{1b}[31mred tank");
    refused("name_slash", r#""p": "#, r#""p/q": "#);
    refused("name_slash_structure", r#""pipe""#, r#""pi/pe""#);
    refused("name_taken", r#""p": "#, r#""pipe": "#);
}

#[test]
fn types() {
    refused("type_text_for_number", "spacing: 0.01", r#"spacing: "0.01""#);
    refused("type_fraction_for_whole", "dimension: 2,", "dimension: 2.5,");
    refused("type_number_for_name", r#"phase: "mud""#, "phase: 2");
    refused("type_name_for_text", r#"phase: "mud""#, "phase: mud");
    refused("type_list_for_vector", "(0.0, -9.81)", "[0.0, -9.81]");
    refused("type_coordinates", "(0.0, -9.81)", "(0.0, 0.0, -9.81)");
    refused("type_too_few", "(0.0, -9.81)", "(-9.81)");
}

#[test]
fn ranges() {
    refused("range_spacing_zero", "spacing: 0.01", "spacing: 0.0");
    refused("range_density_negative", "reference_density: 1500.0", "reference_density: -1500.0");
    refused("range_exponent_negative", "exponent: 0.5", "exponent: -0.5");
    refused("range_smoothing", "dimension: 2,", "dimension: 2, smoothing_ratio: 4.0,");
    refused("range_dimension", "dimension: 2,", "dimension: 4,");
    refused("range_nan", "yield_stress: 10.0", "yield_stress: NaN");
    refused("range_infinite", "yield_stress: 10.0", "yield_stress: inf");
    refused("range_tolerance", "Relative(0.2)", "Relative(-0.2)");
    refused("range_density_great", "reference_density: 1500.0", "reference_density: 1e300");
    refused("range_density_small", "reference_density: 1500.0", "reference_density: 1e-300");
    refused("range_log", "end_time: 0.05,", "end_time: 0.05, log: (series: 1e-300),");
}

#[test]
fn shapes() {
    refused("shape_radius_zero", "radius: 0.03", "radius: 0.0");
    refused("shape_box_negative", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.2), max: (0.4, 0.1)");
    refused(
        "shape_crossed",
        "Circle(center: (0.3, 0.05), radius: 0.03)",
        "Polygon([(0.1, 0.1), (0.2, 0.2), (0.2, 0.1), (0.1, 0.2)])",
    );
    refused("shape_of_space", "Circle(center: (0.3, 0.05), radius: 0.03)", "Sphere(center: (0.3, 0.05), radius: 0.03)");
    refused("shape_thin_structure", "radius: 0.03", "radius: 0.001");
    refused(
        "shape_nothing_left",
        "Circle(center: (0.3, 0.05), radius: 0.03)",
        "Difference(of: Circle(center: (0.3, 0.05), radius: 0.03), minus: [Box(min: (0.2, 0.0), max: (0.4, 0.1))])",
    );
    refused(
        "shape_nothing_left_of_fluid",
        "shape: Box(min: (0.0, 0.1), max: (0.4, 0.2))",
        "shape: Difference(of: Box(min: (0.0, 0.1), max: (0.4, 0.2)), minus: [Box(min: (0.0, 0.0), max: (0.4, 0.3))])",
    );
    refused("shape_thin_fluid", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.101), max: (0.4, 0.104)");
    warned("shape_thinnish_fluid", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.1), max: (0.4, 0.106)");
}

#[test]
fn places() {
    refused("place_fluids_overlap", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.05), max: (0.4, 0.2)");
    refused("place_fluid_in_wall", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.1), max: (0.45, 0.2)");
    refused("place_structure_in_wall", "center: (0.3, 0.05)", "center: (0.5, 0.05)");
    refused(
        "place_structures_overlap",
        r#"structures: {"#,
        r#"structures: {"rod": (shape: Circle(center: (0.3, 0.07), radius: 0.02)), "#,
    );
    refused("place_probe_outside", "PressurePoint(at: (0.2, 0.0))", "PressurePoint(at: (0.2, 0.6))");
    refused("place_gauge_outside", "SurfaceHeight(at: (0.2, 0.0))", "SurfaceHeight(at: (-0.2, 0.0))");
    let also = |probe: &str| format!("\"more\": {probe}, \"h\": SurfaceHeight");
    let beside = "Box(min: (1.0, 0.0), max: (2.0, 0.4))";
    let stress = also(&format!("ShearStress(phase: \"mud\", within: {beside})"));
    refused("place_stress_outside", r#""h": SurfaceHeight"#, &stress);
    refused("place_mean_outside", r#""h": SurfaceHeight"#, &also(&format!("MeanVelocity(shape: {beside})")));
    let zone = format!(
        r#"end_time: 0.05, relaxation_zones: {{"beach": (shape: {beside}, target: Uniform(velocity: (0.0, 0.0)), rate: 5.0)}},"#
    );
    refused("place_zone_outside", "end_time: 0.05,", &zone);
    refused("place_outside_periodic", "end_time: 0.05,", "end_time: 0.05, periodic: (x: (0.0, 0.3)),");
    warned("place_structure_half_in_wall", "center: (0.3, 0.05)", "center: (0.4, 0.05)");
    warned(
        "place_structure_thin",
        "Circle(center: (0.3, 0.05), radius: 0.03)",
        "Box(min: (0.27, 0.04), max: (0.33, 0.06))",
    );
    warned("place_gap_at_wall", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.1), max: (0.38, 0.2)");
    warned("place_gap_between_fluids", "min: (0.0, 0.1), max: (0.4, 0.2)", "min: (0.0, 0.11), max: (0.4, 0.2)");
    warned("place_period", "end_time: 0.05,", "end_time: 0.05, periodic: (x: (0.0, 0.405)),");
    warned("place_off_lattice", "max: (0.4, 0.2)", "max: (0.4, 0.204)");
    warned(
        "place_polygon_off_lattice",
        "shape: Box(min: (0.0, 0.0), max: (0.4, 0.4))",
        "shape: Polygon([(0.0, 0.0), (0.404, 0.0), (0.404, 0.4), (0.304, 0.45), (0.013, 0.433), (0.0, 0.4)])",
    );
}

/// Walls in that of the tank.
#[test]
fn walls() {
    let tank = r#"walls: {"tank": (shape: Box(min: (0.0, 0.0), max: (0.4, 0.4)))}"#;
    let and = |more: &str| tank.replace("0.4)))}", &format!("0.4))), {more}}}"));
    let floor = "shape: Box(min: (0.1, -0.1), max: (0.3, 0.0)), fluid: Outside";
    warned("walls_twice", tank, &and(r#""again": (shape: Box(min: (0.0, 0.0), max: (0.4, 0.4)))"#));
    refused("walls_parting", tank, &and(&format!(r#""floor": ({floor}, motion: Translation(velocity: (0.1, 0.0)))"#)));
    warned("walls_slip", tank, &and(r#""wide": (shape: Box(min: (-0.02, 0.0), max: (0.4, 0.4)), slip: FreeSlip)"#));
}

#[test]
fn physics() {
    warned("physics_unused_phase", r#"phase: "mud""#, r#"phase: "water""#);
    warned(
        "physics_background_pressure",
        "end_time: 0.05,",
        "end_time: 0.05, equation_of_state: (background_pressure: 100.0),",
    );
    let slow = "end_time: 0.05, equation_of_state: (max_speed: 1.0),";
    let fast = |from: &str, to: &str| with("end_time: 0.05,", slow).replace(from, to);
    let jet = fast("max: (0.4, 0.2))", "max: (0.4, 0.2)), velocity: (2.0, 0.0)");
    check("physics_fast_fluid", &said("physics_fast_fluid", &jet, &[], &[]));
    let ram = fast("radius: 0.03)", "radius: 0.03), motion: Translation(velocity: (2.0, 0.0), until: 0.001)");
    check("physics_fast_body", &said("physics_fast_body", &ram, &[], &[]));
    warned("physics_always_capped", "max_viscosity: 50.0", "max_viscosity: 0.05");
    refused("physics_falls_for_ever", "end_time: 0.05,", "end_time: 0.05, periodic: (y: (0.0, 0.4)),");
    refused("physics_hydrostatic_ramp", "end_time: 0.05,", "end_time: 0.05, settling: GravityRamp(until: 0.1),");
    refused(
        "physics_no_fluid",
        "    fluids: [\n        (phase: \"water\", shape: Box(min: (0.0, 0.1), max: (0.4, 0.2))),\n        (phase: \"mud\", shape: Box(min: (0.0, 0.0), max: (0.4, 0.1))),\n    ],",
        "    fluids: [],",
    );
}

#[test]
fn times() {
    warned("time_settling", "end_time: 0.05,", "end_time: 0.05, settling: Damping(until: 1.0, rate: 20.0),");
}

#[test]
fn waves() {
    let wave = |along: &str, displacement: &str| {
        format!(
            "end_time: 0.05, disturbance: Mode(along: {along}, crest: 0.0, wavelength: 0.8, level: 0.1, below: 0.1, above: 0.1, \
             displacement: {displacement}),"
        )
    };
    refused("wave_axis", "end_time: 0.05,", &wave("Z", "0.001"));
    refused("wave_folds", "end_time: 0.05,", &wave("X", "1e3"));
    let mode = r#""mode": LayerMode(phase: "mud", along: Z, crest: 0.0, wavelength: 0.8), "h": SurfaceHeight"#;
    refused("wave_layer_axis", r#""h": SurfaceHeight"#, mode);
}

#[test]
fn too_many_particles() {
    refused("size_particles", "spacing: 0.01", "spacing: 1e-6");
    refused("size_spacing_small", "spacing: 0.01", "spacing: 1e-300");
    refused("size_spacing_great", "spacing: 0.01", "spacing: 1e300");
}

/// No gap is seen between a disc of fitted particles and the fluid around it.
#[test]
fn a_fitted_disc_fills_its_hole() {
    let water = r#"(phase: "water", shape: Box(min: (0.0, 0.1), max: (0.4, 0.2)))"#;
    // The second is off the lattice, so that its particles share cells with the fluid around it.
    for disc in ["Circle(center: (0.15, 0.15), radius: 0.03)", "Circle(center: (0.155, 0.15), radius: 0.033)"] {
        let with_disc = format!(
            r#"(phase: "water", shape: Difference(of: Box(min: (0.0, 0.1), max: (0.4, 0.2)), minus: [{disc}])),
            (phase: "water", shape: {disc}, pressure: Uniform(500.0), filling: Fitted)"#
        );
        assert_eq!(said("fitted", &with(water, &with_disc), &[], &[]), "exit code 0\n", "{disc}");
    }
}

#[test]
fn motions() {
    let table = |rows: &str| format!("radius: 0.03), motion: Table(center: (0.3, 0.05), rows: [{rows}])");
    let row = |t: f64, x: f64| format!("(time: {t:?}, displacement: ({x:?}, 0.0))");
    refused("motion_one_row", "radius: 0.03)", &table(&row(0.0, 0.0)));
    refused("motion_times", "radius: 0.03)", &table(&[row(0.0, 0.0), row(0.2, 0.0), row(0.1, 0.0)].join(", ")));
    refused("motion_start", "radius: 0.03)", &table(&[row(0.0, 0.1), row(0.2, 0.2)].join(", ")));
    refused(
        "motion_until",
        "radius: 0.03)",
        "radius: 0.03), motion: Translation(velocity: (0.1, 0.0), from: 0.2, until: 0.1)",
    );
}

/// What is said of an expectation that compares with the file `series.csv`, or of shaking from it.
fn file(name: &str, csv: &str) {
    let is = r#"is: Csv(file: "series.csv", time: "t", value: "p"), within: Relative(0.2)"#;
    let scene = with("is: Number(2450.0), within: Relative(0.2)", is);
    let files: &[(&str, &str)] = if csv.is_empty() { &[("serie.csv", "t,p\n0,1\n")] } else { &[("series.csv", csv)] };
    let said = said(name, &scene, &[], files);
    assert!(said.starts_with("exit code 2\nError: "), "{said}");
    check(name, &said);
}

#[test]
fn files() {
    file("file_missing", "");
    file("file_column", "t,pressure\n0,1\n0.01,2\n");
    file("file_word", "t,p\n0,1\n0.01,two\n");
    file("file_row", "t,p\n0,1\n0.01\n");
    file("file_times", "t,p\n0,1\n0.02,2\n0.01,3\n");
    file("file_semicolons", "t;p\n0;1\n");
    file("file_empty", "t,p\n");
    file("file_blank", "\n");
    file("file_late", "t,p\n0,1\n1.0,2\n");
    let shaking = "end_time: 0.05, shaking: Accelerogram(file: \"quake.csv\", time: \"t\", columns: [(name: \"ew\", direction: (1.0, 0.0))]),";
    let scene = with("end_time: 0.05,", shaking);
    check("file_accelerogram", &said("quake", &scene, &[], &[("quake.csv", "t,ew\n0,0.1\n0.01,x\n")]));
    let late = said("late", &scene, &[], &[("quake.csv", "t,ew\n10,0.1\n20,0.2\n")]);
    check("file_accelerogram_late", &late);
}

#[test]
fn overrides() {
    for (name, set) in [
        ("override_unknown", "phases.mud.rheology.yeild_stress=5"),
        ("override_section", "phase.mud.reference_density=5"),
        ("override_index", "fluids.2.velocity=(0.0, 1.0)"),
        ("override_value", "spacing=fine"),
        ("override_syntax", "spacing"),
        ("override_range", "spacing=-0.01"),
        ("override_empty_end", "spacing.=0.05"),
        ("override_empty_parts", "..=1"),
    ] {
        let said = said(name, SCENE, &["--set", set], &[]);
        assert!(said.starts_with("exit code 2\n"), "{said}");
        check(name, &said);
    }
}
