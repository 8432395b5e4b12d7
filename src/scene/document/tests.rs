//! Places, messages and edits, each against what was counted or written by hand.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::*;

fn parse(text: &str) -> Document {
    Document::parse("a.ron", text).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn refused(text: &str) -> String {
    Document::parse("a.ron", text).map(|_| ()).unwrap_err().to_string()
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Fluid {
    density: f64,
    #[serde(default = "two")]
    gamma: u32,
    #[serde(default)]
    label: Option<String>,
    #[serde(default)]
    wall: Wall,
}

fn two() -> u32 {
    2
}

#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
enum Wall {
    #[default]
    NoSlip,
    Navier {
        length: f64,
    },
    Shape(Shape),
    Moving((f64, f64)),
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
enum Shape {
    Box { min: (f64, f64), max: (f64, f64) },
    Polygon(Vec<(f64, f64)>),
}

/// Message, place and help of the error in reading a fluid at path `w`.
fn fluid_error(text: &str) -> String {
    let error = parse(text).read::<Fluid>("w").unwrap_err();
    let place = error.place().unwrap_or_else(|| panic!("{error} has no place"));
    let wrong = place.text.get(place.span.clone()).unwrap_or_default();
    format!("{error} <{wrong}> {}", error.help_line().unwrap_or_default()).trim_end().to_owned()
}

#[test]
fn values_are_found_by_path_through_names_and_wrappers() {
    let text = "Scene(a: [(1, 22)], r: HB(y: Some(5)), s: Shape(Box(min: (7, 8))), p: Polygon([(0, 1), (2, 3)]),\n\
                m: {\"øl\": (x: 9), plain: 3}, o: Some([4, 6]))";
    let document = parse(text);
    for (path, expected) in [
        ("a.0.1", "22"),
        ("r.y", "Some(5)"),
        ("r.y.0", ""),
        ("s.min.1", "8"),
        ("s.0.min.0", "7"),
        ("p.1.0", "2"),
        ("p.0.1.1", "3"),
        ("m.øl.x", "9"),
        ("m.plain", "3"),
        ("o.1", "6"),
        ("r", "HB(y: Some(5))"),
        ("q", ""),
        ("a.1", ""),
        ("a.x", ""),
        ("", text),
    ] {
        let found = document.node(path).map_or("", |node| &text[node.span.clone()]);
        assert_eq!(found, expected, "{path}");
    }
}

#[test]
fn comments_raw_strings_and_other_alphabets_do_not_disturb_places() {
    let text = "// (\u{e6}\n/* { /* nested \" */ [ */ Scene /* ( */ ( // )\n a /* : */ : r#\"x\") \"#, // \"\n ø: 'c', b: x1e /**/ ,)";
    let document = parse(text);
    let node = document.node("b").unwrap();
    assert_eq!(&text[node.span.clone()], "x1e");
    assert_eq!(document.node("a").unwrap().kind, Kind::Scalar(Scalar::Text("x\") ".to_owned())));
    // " ø: 'c', b: x1e": the value b starts in column 13.
    assert!(
        document.read::<f64>("b").unwrap_err().to_string().starts_with("a.ron:4:13: expected a number, found `x1e`")
    );
}

#[test]
fn syntax_errors_have_their_place() {
    for (text, expected) in [
        ("(a: 1, b: \n  ø)\n  c: 3)", "a.ron:3:3: something follows"),
        ("(a: 1\n b: 2)", "a.ron:2:2: expected `,` or a closing bracket"),
        ("(a: [1, 2)", "a.ron:1:10: expected `,` or a closing bracket"),
        ("(a: \"øø\", b: ?)", "a.ron:1:14: unexpected character `?`"),
        ("(a: 1,\n b: \"x)", "a.ron:2:5: this text in quotes is never closed"),
        ("(a: .5)", "a.ron:1:5: a decimal point must stand between digits"),
        ("(a: 5.)", "a.ron:1:6: a decimal point must stand between digits"),
        ("(a: -.5)", "a.ron:1:5: a sign must be followed by a digit, as in -0.5"),
        ("(a: 1 /* x )", "a.ron:1:7: this comment"),
        ("", "a.ron:1:1: "),
        ("[1]", "a.ron:1:1: expected a scene `Scene(…)`, found a list"),
        ("Szene(a: 1)", "a.ron:1:1: expected a scene `Scene(…)`, found `Szene(…)`"),
    ] {
        let found = refused(text);
        assert!(found.starts_with(expected), "{text:?}: {found}");
    }
    parse("()");
    parse("Scene()");
}

#[test]
fn what_is_nested_too_deeply_is_refused_and_anything_less_is_read() {
    let nested = |levels: usize| format!("(a:\n {}{})", "Union([".repeat(levels), "])".repeat(levels));
    parse(&nested(15));
    let expected = "a.ron:2:113: more than 32 brackets stand in one another here";
    assert_eq!(refused(&nested(16)), expected);
    assert_eq!(refused(&nested(70)), expected);
    let error = parse("(a: 1)").set("a", &"[".repeat(40)).unwrap_err();
    assert_eq!(error.to_string(), "--set a:1:33: more than 32 brackets stand in one another here");
}

#[test]
fn numbers_must_be_finite_and_names_unique() {
    for number in ["inf", "-inf", "NaN", "1e999", "-1e999", "inff64", "1e9_99", "+inf", "3e"] {
        assert_eq!(refused(&format!("(é: 1,\n x: [0, {number}])")), "a.ron:2:9: must be a finite number", "{number}");
    }
    parse("(a: 1e308, b: 0x1F, c: 1_000.5, d: -0.5, e: 1E-3, f: 3f64, g: +1e+3)");
    assert_eq!(refused("(a: 1, b: (c: 1, ø: 2, c: 3))"), "a.ron:1:24: `c` is given twice");
    assert_eq!(refused("(m: {\"k\": 1,\n  \"k\": 2})"), "a.ron:2:3: `k` is given twice");
    assert_eq!(refused("(a: [{\"\": 1}])"), "a.ron:1:7: a name may not be empty");
    assert_eq!(refused("(m: {\"k\": {\"a.b\": 1}})"), "a.ron:1:12: a name may not contain a dot");
    let set = parse("(m: {})").set("m", "{\"x.\": 1}").unwrap_err().to_string();
    assert_eq!(set, "--set m:1:2: a name may not contain a dot");
}

#[test]
fn unknown_and_missing_names_are_underlined() {
    for (text, expected) in [
        ("(w: (density: 1,\n denisty: 2))", "a.ron:2:2: unknown field `denisty` <denisty> did you mean `density`?"),
        ("(w: (wall: NoSlipp, density: 1))", "a.ron:1:12: unknown name `NoSlipp` <NoSlipp> did you mean `NoSlip`?"),
        ("(w: (density: 1, wall: Shape(Bocks(min: (0, 0)))))", "a.ron:1:30: unknown name `Bocks` <Bocks>"),
        ("(w: (gamma: 1))", "a.ron:1:5: `density` is missing <(>"),
        ("(w: Fluid ( ))", "a.ron:1:5: `density` is missing <Fluid>"),
        ("(w: (density: 1, wall: Navier()))", "a.ron:1:24: `length` is missing <Navier>"),
        (
            "(w: (density: 1, wall: Navier(lenght: 3)))",
            "a.ron:1:31: unknown field `lenght` <lenght> did you mean `length`?",
        ),
        ("(w: (density: 1, wall: Shape(Box(min: (0, 0)))))", "a.ron:1:30: `max` is missing <Box>"),
        ("(v: 1)", "a.ron:1:1: `w` is missing <(>"),
    ] {
        assert_eq!(fluid_error(text), expected);
    }
    let error = parse("(w: (x: 1))").read::<Fluid>("w").unwrap_err();
    assert_eq!(error.place().unwrap().label, "expected one of `density`, `gamma`, `label`, `wall`");
}

#[test]
fn wrong_types_are_told_in_plain_words() {
    for (text, expected) in [
        ("(w: (density: \"ø\"))", "a.ron:1:15: expected a number, found the text \"ø\" <\"ø\">"),
        ("(w: (density: [1]))", "a.ron:1:15: expected a number, found a list `[…]` <[1]>"),
        ("(w: (density: 1, gamma: 1.5))", "a.ron:1:25: expected a whole number, found the number 1.5 <1.5>"),
        (
            "(w: (density: 1, gamma: -3))",
            "a.ron:1:25: expected a whole number that is not negative, found the number -3 <-3>",
        ),
        (
            "(w: (density: 1, gamma: 5000000000))",
            "a.ron:1:25: expected a smaller whole number, found the number 5000000000 <5000000000>",
        ),
        (
            "(w: (density: 1, label: water))",
            "a.ron:1:25: expected a text in quotes, found `water` <water> put it in quotes: \"water\"",
        ),
        (
            "(w: (density: 1, wall: \"NoSlip\"))",
            "a.ron:1:24: expected a name, found the text \"NoSlip\" <\"NoSlip\"> write it without quotes: NoSlip",
        ),
        (
            "(w: (density: 1, wall: Navier))",
            "a.ron:1:24: expected values in parentheses `(…)`, found `Navier` <Navier> write `Navier(…)`",
        ),
        ("(w: (density: 1, wall: NoSlip(2)))", "a.ron:1:24: `NoSlip` stands alone, without `(…)` <NoSlip(2)>"),
        ("(w: (density: 1, wall: Moving(1, 2, 3)))", "a.ron:1:37: expected 2 values, found 3 <3>"),
        ("(w: (density: 1, wall: Moving(1)))", "a.ron:1:24: expected 2 values, found 1 <Moving(1)>"),
        (
            "(w: (density: 1, wall: Shape(Polygon([(0, 0), [1, 2]]))))",
            "a.ron:1:47: expected values in parentheses `(…)`, found a list `[…]` <[1, 2]> use round brackets instead of square ones",
        ),
        (
            "(w: (density: 1, wall: Shape(Polygon(((0, 0), (1, 2))))))",
            "a.ron:1:38: expected a list `[…]`, found values in parentheses `(…)` <((0, 0), (1, 2))> use square brackets instead of round ones",
        ),
        ("(w: 5)", "a.ron:1:5: expected values in parentheses `(…)`, found the number 5 <5>"),
        (
            "(w: {\"density\": 5})",
            "a.ron:1:5: expected values in parentheses `(…)`, found a table `{…}` <{\"density\": 5}>",
        ),
    ] {
        assert_eq!(fluid_error(text), expected);
    }
    let flag = parse("(a: 1)").read::<bool>("a").unwrap_err();
    assert_eq!(flag.to_string(), "a.ron:1:5: expected true or false, found the number 1");
    let table = parse("(a: (x: 1))").read::<BTreeMap<String, f64>>("a").unwrap_err();
    assert!(table.to_string().starts_with("a.ron:1:5: expected a table"), "{table}");
    let value = parse("(a: {\"x\": 1, \"y\":\n true})").read::<BTreeMap<String, f64>>("a").unwrap_err();
    assert_eq!(value.to_string(), "a.ron:2:2: expected a number, found `true`");
}

#[test]
fn sound_values_are_read() {
    let document = parse("(w: Fluid(density: 1, label: \"sea\", wall: Shape(Box(min: (0, 0), max: (1, 2)))))");
    let fluid: Fluid = document.read("w").unwrap();
    let wall = Wall::Shape(Shape::Box { min: (0.0, 0.0), max: (1.0, 2.0) });
    assert_eq!(fluid, Fluid { density: 1.0, gamma: 2, label: Some("sea".to_owned()), wall });
}

#[test]
fn registered_names_leave_their_body_to_the_caller() {
    let document =
        parse("(r: Herschel // ø (\n (density: 3), s: Bare, t: 5, u: Empty(), v: Wrong(density: \"x\"), o: Some(Opt))");
    let named = |path| document.named(document.node(path).unwrap());
    let herschel = named("r").unwrap();
    assert_eq!((herschel.name, herschel.span.clone()), ("Herschel", 4..12));
    assert_eq!(document.read_body::<Fluid>(&herschel).unwrap().density, 3.0);
    assert_eq!(named("o").unwrap().name, "Opt");
    for (path, place) in [("s", "a.ron:2:19"), ("u", "a.ron:2:34")] {
        let error = document.read_body::<Fluid>(&named(path).unwrap()).unwrap_err();
        assert_eq!(error.to_string(), format!("{place}: `density` is missing"));
    }
    let error = document.read_body::<Fluid>(&named("v").unwrap()).unwrap_err();
    assert_eq!(error.to_string(), "a.ron:2:61: expected a number, found the text \"x\"");
    assert!(named("t").unwrap_err().to_string().starts_with("a.ron:2:28: expected a name such as `Name(…)`"));
    let error = document.unknown_name_error(herschel.span, "rheology", "Herschel", &["Bingham", "HerschelB"]);
    assert_eq!(error.to_string(), "a.ron:1:5: unknown rheology `Herschel`");
    assert_eq!(error.help_line(), Some("did you mean `HerschelB`?"));
}

#[test]
fn top_level_fields_are_checked() {
    let document = parse("Scene(domain: 1, fluid: 2)");
    assert!(document.require_known_fields("", &["domain", "fluid"]).is_ok());
    let error = document.require_known_fields("", &["domain", "fluids"]).unwrap_err();
    assert_eq!(error.to_string(), "a.ron:1:18: unknown field `fluid`");
    assert_eq!(error.help_line(), Some("did you mean `fluids`?"));
}

#[test]
fn physical_complaints_find_their_value_or_its_parent() {
    let document = parse("Scene(\n  phases: {\"slide\": (rheology: HB(yield_stress: -1))})");
    let error = document.invalid(&Invalid::new("phases.slide.rheology.yield_stress", "must not be negative"));
    assert_eq!(error.to_string(), "a.ron:2:49: `phases.slide.rheology.yield_stress`: must not be negative");
    let error = document.invalid(&Invalid::new("phases.slide.rheology.index", "must be positive"));
    assert!(error.to_string().starts_with("a.ron:2:32: "), "{error}");
    assert_eq!(error.help_line(), Some("`index` has its default value; give another one"));
    let whole = document.invalid(&Invalid::new("", "nothing to do"));
    assert_eq!(whole.to_string(), "a.ron:1:1: nothing to do");
    assert!(whole.render(false).contains("Scene("));
}

#[test]
fn overrides_change_only_their_value() {
    let text =
        "Scene(a: 1, // one\n b: [(x: 1), (x: 2, y: \"old\",)], m: {\"k\": (), p: 1}, n: {}, w: Bare, o: Some(3))";
    for (path, value, old, new) in [
        ("a", "2.5e3", "a: 1,", "a: 2.5e3,"),
        ("a", " 2 // not one", "a: 1,", "a: 2,"),
        ("b.1.x", "7", "x: 2", "x: 7"),
        ("b.1.y", "new text", "\"old\"", "\"new text\""),
        ("b.1.y", "\"q\"", "\"old\"", "\"q\""),
        ("b.1.y", "sa\\y \"hi\"", "\"old\"", r#""sa\\y \"hi\"""#),
        ("b.1.z", "3", "\"old\",)", "\"old\", z: 3,)"),
        ("b.0", "(x: 5)", "(x: 1)", "(x: 5)"),
        ("m.k.inner", "1", "()", "(inner: 1)"),
        ("m.q", "2", "p: 1", "p: 1, q: 2"),
        ("n.new", "1", "{}", "{\"new\": 1}"),
        ("w.depth", "1", "Bare", "Bare(depth: 1)"),
        ("o", "4", "Some(3)", "4"),
        ("last", "[1]", "Some(3)", "Some(3), last: [1]"),
        ("part.c.d", "1", "Some(3)", "Some(3), part: (c: (d: 1))"),
        ("b.0.c.d", "1", "x: 1", "x: 1, c: (d: 1)"),
        ("m.k.c.d", "1", "()", "(c: (d: 1))"),
        ("w.c.d", "1", "Bare", "Bare(c: (d: 1))"),
    ] {
        let changed = parse(text).set(path, value).unwrap_or_else(|error| panic!("{}", error.render(false)));
        assert_eq!(&**changed.text(), text.replacen(old, new, 1), "{path}={value}");
    }
    let twice = parse("(a: 1, b: 2)").set_pair("a=(c: 3)").unwrap().set_pair(" a.c =x=y").unwrap_err();
    assert!(twice.to_string().contains("--set a.c"), "{twice}");
}

#[test]
fn overrides_that_cannot_be_made_say_why() {
    let document = parse("Scene(fluids: [(density: 1)], outer: (inner: (x: 1)), m: {}, slide: {\"mud\": 1})");
    for (pair, expected, help) in [
        (
            "flow.0.y=1",
            "--set flow.0.y=1: the scene has no `flow`; it has `fluids`, `outer`, `m`, `slide`",
            Some("give it whole: --set 'flow=…'"),
        ),
        ("slide.mid.x=1", "--set slide.mid.x=1: `slide` has no `mid`; it has `mud`", Some("did you mean `mud`?")),
        ("m.new.x=1", "--set m.new.x=1: `m` has no `new`; it is empty", None),
        ("fluids.3=1", "--set fluids.3=1: `fluids` has no `3`; it has 1 item, 0", None),
        ("fluids.0.density.u=1", "--set fluids.0.density.u=1: `fluids.0.density` has no `u`; it is the number 1", None),
        ("outer", "--set outer: expected `path=value`", Some("for example --set spacing=0.01")),
        ("outer.inner.x=(", "--set outer.inner.x:1:2: expected `,` or the closing `)`", None),
        ("outer.inner.x=", "--set outer.inner.x:1:1: there is no value", None),
        ("outer.inner.x=1, y: 2", "--set outer.inner.x:1:2: something follows the end of the value", None),
        ("outer.inner.x=1e999", "--set outer.inner.x:1:1: must be a finite number", None),
    ] {
        let error = document.set_pair(pair).unwrap_err();
        assert_eq!((error.to_string().as_str(), error.help_line()), (expected, help), "{pair}");
    }
}

#[test]
fn errors_in_overridden_text_name_the_override() {
    let document = parse("(a: 1, w: (density: 1))").set("w.density", "sand").unwrap().set("w.gama", "1").unwrap();
    assert_eq!(document.overrides().len(), 2);
    let error = document.read::<Fluid>("w").unwrap_err();
    assert_eq!(error.help_line(), Some("(set by --set w.density=sand)"));
    let document = document.set("w.density", "2").unwrap();
    let error = document.read::<Fluid>("w").unwrap_err();
    assert_eq!(error.to_string(), "a.ron:1:24: unknown field `gama`");
    assert_eq!(error.help_line(), Some("did you mean `gamma`? (set by --set w.gama=1)"));
    assert_eq!(document.error(1..2, "elsewhere", "").help_line(), None);
    let document = document.set("stats.mean", "1").unwrap().set("stats.max", "2").unwrap();
    let error = document.require_known_fields("", &["a", "w", "state"]).unwrap_err();
    assert_eq!(error.to_string(), "a.ron:1:34: unknown field `stats`");
    assert_eq!(error.help_line(), Some("did you mean `state`? (set by --set stats.mean=1)"));
}

#[derive(Serialize)]
struct Everything {
    fluids: BTreeMap<String, Fluid>,
    gravity: (f64, f64),
    origin: Option<f64>,
    walls: Vec<Wall>,
}

fn everything() -> Everything {
    let wall = Wall::Shape(Shape::Box { min: (0.0, 0.0), max: (1.0, 2e-9) });
    let water = Fluid { density: 1000.0, gamma: 7, label: Some("a, b".to_owned()), wall };
    let walls = vec![Wall::NoSlip, Wall::Navier { length: 0.5 }, Wall::Shape(Shape::Polygon(vec![(0.0, 1.0)]))];
    Everything { fluids: [("Water".to_owned(), water)].into(), gravity: (0.0, -9.81), origin: None, walls }
}

fn lines(leaves: &[(String, String)]) -> Vec<String> {
    leaves.iter().map(|(path, value)| format!("{path} = {value}")).collect()
}

#[test]
fn all_leaves_are_listed_under_the_paths_of_a_scene() {
    let expected = [
        "s.fluids.Water.density = 1000.0",
        "s.fluids.Water.gamma = 7",
        "s.fluids.Water.label = \"a, b\"",
        "s.fluids.Water.wall = Shape(Box)",
        "s.fluids.Water.wall.min = (0.0,0.0)",
        "s.fluids.Water.wall.max = (1.0,2e-9)",
        "s.gravity = (0.0,-9.81)",
        "s.origin = None",
        "s.walls.0 = NoSlip",
        "s.walls.1 = Navier",
        "s.walls.1.length = 0.5",
        "s.walls.2 = Shape(Polygon([(0.0,1.0)]))",
    ];
    assert_eq!(lines(&flatten("s", &everything())), expected);
}

#[test]
fn defaults_are_the_leaves_the_scene_does_not_write() {
    let document = parse(
        "Scene(fluids: {\"Water\": (density: 1e3, wall: Shape(Box(min: (0, 0))))}, gravity: (0, -9.81), walls: [\n\
         NoSlip, Navier, Shape(Polygon([(0, 1)]))])",
    );
    let expected = [
        "fluids.Water.gamma = 7",
        "fluids.Water.label = \"a, b\"",
        "fluids.Water.wall.max = (1.0,2e-9)",
        "origin = None",
        "walls.1.length = 0.5",
    ];
    assert_eq!(lines(&document.defaults("", &everything())), expected);
    let inner = document.defaults("numerics.wall", &Wall::Navier { length: 2.0 });
    assert_eq!(lines(&inner), ["numerics.wall = Navier", "numerics.wall.length = 2.0"]);
}
