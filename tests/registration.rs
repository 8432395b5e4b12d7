//! The registration points of the framework, used from outside: what a plugin can bring, it brings here.

use bevy_app::{App, Plugin, PluginGroup, PluginGroupBuilder};
use bevy_ecs::prelude::*;
use foxglove::Decode;
use foxglove::messages::PointCloud;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use storegga::app::{End, PaperPlugins, StopFlag, StoreggaApp, open, run};
use storegga::checkpoint::{check_state, restore_state, save_state};
use storegga::clock::Clock;
use storegga::error::UserError;
use storegga::kernels::Kernel;
use storegga::log::{close_log, open_log};
use storegga::outputs::{OutputKind, OutputTimes};
use storegga::particles::{DensityRate, Fluid, ParticleId, PhaseIndex, ShearRate, Viscosity};
use storegga::phases::Phase;
use storegga::probes::{Probe, Series, SeriesField, State};
use storegga::rheology::Rheology;
use storegga::scene::{Document, Invalid, SceneSection, SectionError};
use storegga::schedule::{Output, OutputStage, Stage};

/// A rheology with a memory: its viscosity falls with the strain that a particle has been through.
#[derive(Component, Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Softening {
    /// Viscosity (Pa s) of undisturbed material.
    #[schemars(range(min = 0.0), extend("unit" = "Pa s"))]
    intact: f64,
}

impl Rheology for Softening {
    fn check(&self) -> Result<(), Invalid> {
        Ok(())
    }

    fn greatest_viscosity(&self) -> f64 {
        self.intact
    }
}

/// Accumulated strain: a column of the plugin's own.
#[derive(Component, Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Strain(f64);

/// The particle that the column should belong to.
#[derive(Component, Debug, Clone, Copy, Default, Serialize, Deserialize)]
struct Owner(u32);

fn soften(
    clock: Res<Clock>,
    phases: Query<(&Phase, &Softening)>,
    mut fluid: Query<(&PhaseIndex, &ShearRate, &mut Strain, &mut Viscosity), With<Fluid>>,
) {
    for (phase, shear_rate, mut strain, mut viscosity) in &mut fluid {
        if let Some((_, softening)) = phases.iter().find(|(one, _)| one.index == phase.0) {
            strain.0 += clock.time_step * shear_rate.0;
            viscosity.0 = softening.intact / (1.0 + strain.0);
        }
    }
}

/// A cubic kernel of the plugin's own: (1 − q)³ up to q = 1, in units of 3h.
#[derive(Clone, JsonSchema)]
struct Cubic;

impl Kernel for Cubic {
    fn support(&self) -> f64 {
        3.0
    }

    fn normalisation(&self, dimension: usize) -> f64 {
        // ∫ (1 − r/3)³ d^d r = 2π 9/20 and 4π 27/60.
        if dimension == 2 { 10.0 / (9.0 * std::f64::consts::PI) } else { 5.0 / (9.0 * std::f64::consts::PI) }
    }

    fn w(&self, q: f64) -> f64 {
        (1.0 - q / 3.0).max(0.0).powi(3)
    }

    fn dw_dq(&self, q: f64) -> f64 {
        -(1.0 - q / 3.0).max(0.0).powi(2)
    }
}

/// A section of the plugin's own.
#[derive(Resource, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Earthquake {
    /// Greatest acceleration of the ground.
    #[schemars(extend("unit" = "m/s²"))]
    peak: f64,
}

impl SceneSection for Earthquake {
    const NAME: &'static str = "earthquake";

    fn check(&self, _: &World) -> Result<(), Invalid> {
        if self.peak < 0.0 { Err(Invalid::new("peak", "must not be negative")) } else { Ok(()) }
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        world.insert_resource(self);
        Ok(())
    }
}

/// A probe of the plugin's own: the number of fluid particles.
#[derive(Component, Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Count();

impl Probe for Count {
    fn description(&self) -> String {
        "number of particles".to_owned()
    }

    fn fields(&self) -> Vec<SeriesField> {
        vec![SeriesField::new("particles", "", "fluid particles")]
    }

    fn measure(&mut self, state: &State<'_>, row: &mut [f64]) {
        row[0] = state.fluid.position.len() as f64;
    }
}

/// A channel of the plugin's own.
fn write_channel(clock: Res<Clock>, outputs: Res<OutputTimes>, mut series: Query<&mut Series>) {
    if !outputs.due(OutputKind::Series) {
        return;
    }
    for mut series in series.iter_mut().filter(|series| series.name == "beat") {
        series.push(clock.time, &[clock.step as f64]);
    }
}

/// Stands in for the continuity equation: nothing is compressed.
fn incompressible(mut fluid: Query<&mut DensityRate, With<Fluid>>) {
    fluid.iter_mut().for_each(|mut rate| rate.0 = 0.0);
}

struct Outside;

impl Plugin for Outside {
    fn build(&self, app: &mut App) {
        app.register_particle_column::<Strain>()
            .log_particle_column::<Strain, Softening>("strain", "1", |strain| strain.0)
            .log_particle_column::<Owner, Careless>("owner", "", |owner| f64::from(owner.0))
            .register_particle_column::<Owner>()
            .register_rheology_system::<Softening, _>("Softening", soften)
            .register_kernel("Cubic", Cubic)
            .register_scene_section::<Earthquake>()
            .register_probe::<Count>("Count")
            .set_stage(Stage::Continuity, incompressible, incompressible)
            .set_stage(Stage::Diffusion, || {}, || {});
        let field = SeriesField::new("step", "", "number of the step");
        app.world_mut().spawn(Series::new("beat", "/beat", "steps", vec![field]));
        app.add_systems(Output, write_channel.in_set(OutputStage::Measure).after(storegga::probes::ProbeSystems));
    }
}

const SCENE: &str = r#"Scene(
    dimension: 2, spacing: 0.05, gravity: (0.0, -9.81), end_time: 0.05, kernel: Cubic,
    neighbours: (skin: 0.01, sort_every: 1),
    phases: { "mud": (reference_density: 1500.0, rheology: Softening(intact: 10.0)) },
    fluids: [(phase: "mud", shape: Box(min: (0.0, 0.0), max: (0.4, 0.6)))],
    walls: { "tank": (shape: Box(min: (0.0, 0.0), max: (1.0, 1.0))) },
    probes: { "count": Count() },
    earthquake: (peak: 2.5),
    log: (particles: 1.0, series: 0.01),
)"#;

fn opened(text: &str) -> Result<App, UserError> {
    open(PaperPlugins.build().add(Outside), Document::parse("test.ron", text)?)
}

#[test]
fn a_plugin_brings_everything() {
    let mut app = opened(SCENE).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let world = app.world_mut();
    assert_eq!(world.resource::<Earthquake>().peak, 2.5);
    for (id, mut owner) in world.query_filtered::<(&ParticleId, &mut Owner), With<Fluid>>().iter_mut(world) {
        owner.0 = id.0;
    }
    run(world, 0.05, &StopFlag::default(), |_| {});

    // The column follows its particle through re-sorting, and the memory of the rheology with it.
    let mut columns = world.query_filtered::<(&ParticleId, &Owner, &Strain, &Viscosity), With<Fluid>>();
    let found: Vec<_> = columns.iter(world).collect();
    assert!(found.windows(2).any(|pair| pair[0].0 > pair[1].0), "nothing was re-sorted");
    assert!(found.iter().all(|(id, owner, ..)| id.0 == owner.0));
    assert!(found.iter().any(|(.., strain, _)| strain.0 > 0.0));
    assert!(found.iter().all(|(.., strain, viscosity)| viscosity.0 == 10.0 / (1.0 + strain.0)));

    // The replaced stages did nothing.
    let mut rates = world.query_filtered::<&DensityRate, With<Fluid>>();
    assert!(rates.iter(world).all(|rate| rate.0 == 0.0));

    let series: Vec<&Series> = world.query::<&Series>().iter(world).collect();
    let named = |name: &str| *series.iter().find(|series| series.name == name).expect("it was spawned");
    assert_eq!(named("count").times().len(), 6);
    assert_eq!(named("count").row(5), [96.0]);
    assert_eq!(named("beat").times().len(), 6);
}

#[test]
fn what_a_plugin_brings_is_saved_and_restored() {
    let open = || opened(SCENE).unwrap_or_else(|error| panic!("{}", error.render(false)));
    let (mut straight, mut resumed) = (open(), open());
    run(straight.world_mut(), 0.02, &StopFlag::default(), |_| {});
    assert_eq!(check_state(straight.world()), Ok(()));
    let saved = save_state(straight.world_mut()).expect("the state is saved");
    restore_state(resumed.world_mut(), &saved).expect("the state fits");
    for app in [&mut straight, &mut resumed] {
        run(app.world_mut(), 0.05, &StopFlag::default(), |_| {});
        let world = app.world_mut();
        assert!(world.query::<&Strain>().iter(world).any(|strain| strain.0 > 0.0));
        assert!(world.query::<&Series>().iter(world).all(|series| series.times().len() == 6));
    }
    let [straight, resumed] = [straight, resumed].map(|mut app| save_state(app.world_mut()));
    assert!(straight == resumed, "the resumed run went another way");
    let without_plugin = open_plain().map(|mut app| restore_state(app.world_mut(), &saved));
    let refusal = without_plugin.unwrap_or_else(|error| panic!("{error}")).expect_err("it does not fit");
    assert!(refusal.contains("Strain") && refusal.contains("does not have"), "{refusal}");
}

fn open_plain() -> Result<App, UserError> {
    storegga::app::open(PaperPlugins, plain_scene())
}

/// Remembers something, and nobody is told.
#[derive(Resource, Default)]
struct Forgotten(#[expect(dead_code, reason = "a resource needs a value to be forgotten")] f64);

#[test]
fn state_that_would_not_be_saved_is_found() {
    let mut app = open_plain().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(check_state(app.world()), Ok(()));
    app.init_resource::<Forgotten>();
    assert_eq!(check_state(app.world()), Err(vec!["registration::Forgotten".to_owned()]));
    app.register_rebuilt::<Forgotten>();
    assert_eq!(check_state(app.world()), Ok(()));
}

fn refusal(opened: Result<App, UserError>) -> String {
    match opened {
        Ok(_) => panic!("the scene was accepted"),
        Err(error) => error.render(false),
    }
}

#[test]
fn a_wrong_section_is_refused_in_its_place() {
    let misspelt = refusal(opened(&SCENE.replace("peak: 2.5", "peek: 2.5")));
    assert!(misspelt.contains("test.ron:8:18") && misspelt.contains("did you mean `peak`?"), "{misspelt}");
    let negative = refusal(opened(&SCENE.replace("peak: 2.5", "peak: -1.0")));
    assert!(negative.contains("test.ron:8:24") && negative.contains("must not be negative"), "{negative}");
    let unknown = refusal(opened(&SCENE.replace("kernel: Cubic", "kernel: Cubik")));
    assert!(unknown.contains("did you mean `Cubic`?"), "{unknown}");
}

/// The last frame of `/particles` in the log of the scene, and its state at the end.
fn logged(plugins: PluginGroupBuilder, document: Document) -> (PointCloud, App) {
    let mut app = open(plugins, document).unwrap_or_else(|error| panic!("{error}"));
    let path = std::env::temp_dir().join(format!("storegga-registration-{}.mcap", std::process::id()));
    open_log(app.world_mut(), &path, 0.05).expect("a log is opened");
    let end = run(app.world_mut(), 0.05, &StopFlag::default(), |_| {});
    close_log(app.world_mut(), &end).expect("the log is written");
    let bytes = std::fs::read(&path).expect("the log is there");
    let _ = std::fs::remove_file(&path);
    let messages = mcap::MessageStream::new(&bytes).expect("a log").map(|message| message.expect("a message"));
    let last = messages.filter(|message| message.channel.topic == "/particles").last().expect("a frame");
    (PointCloud::decode(&*last.data).expect("a point cloud"), app)
}

#[test]
fn a_column_can_be_logged_by_scenes_that_use_it() {
    let document = Document::parse("test.ron", SCENE).unwrap_or_else(|error| panic!("{error}"));
    let (cloud, mut app) = logged(PaperPlugins.build().add(Outside), document);
    // The column of something that this scene does not have is left out.
    let field = cloud.fields.last().expect("there are fields");
    assert_eq!((field.name.as_str(), cloud.fields.len()), ("strain", 13));
    let world = app.world_mut();
    let strains: Vec<f64> = world.query_filtered::<&Strain, With<Fluid>>().iter(world).map(|strain| strain.0).collect();
    assert!(strains.iter().any(|strain| *strain > 0.0) && strains.len() == 96);
    for (row, strain) in cloud.data.chunks(cloud.point_stride as usize).zip(strains) {
        let at = field.offset as usize;
        let bytes: [u8; 4] = row[at..at + 4].try_into().expect("four bytes");
        assert_eq!(f32::from_le_bytes(bytes), strain as f32);
    }
    let (cloud, _) = logged(PaperPlugins.build(), plain_scene());
    assert_eq!(cloud.fields.len(), 12);
}

/// Puts a component on fluid particles without registering it.
#[derive(Component)]
struct Careless;

impl Plugin for Careless {
    fn build(&self, app: &mut App) {
        app.register_required_components::<Fluid, Owner>();
    }
}

#[test]
fn a_column_that_nobody_registered_is_refused() {
    let error = refusal(open(PaperPlugins.build().add(Careless), plain_scene()));
    assert!(error.contains("Owner"), "{error}");
}

/// Marks the scene.
#[derive(Component)]
struct Wanted;

/// A section that is spawned after the fluids, and then finds that their column is wanted.
#[derive(serde::Deserialize, serde::Serialize, schemars::JsonSchema)]
struct Late;

impl SceneSection for Late {
    const NAME: &'static str = "late";

    fn when_absent() -> Option<Self> {
        Some(Self)
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        world.spawn(Wanted);
        Ok(())
    }
}

impl Plugin for Late {
    fn build(&self, app: &mut App) {
        app.register_particle_column_for::<Strain, Wanted>().register_scene_section::<Self>();
    }
}

#[test]
fn a_column_that_is_wanted_after_the_fluids_are_filled_is_refused() {
    let error = refusal(open(PaperPlugins.build().add(Late), plain_scene()));
    assert!(error.contains("Strain") && error.contains("after its fluid was filled"), "{error}");
}

/// The scene without what only the plugin [`Outside`] knows.
fn plain_scene() -> Document {
    let text = SCENE
        .replace("kernel: Cubic,", "")
        .replace("Softening(intact: 10.0)", "Newtonian(viscosity: 1.0)")
        .replace(r#"probes: { "count": Count() },"#, "")
        .replace("earthquake: (peak: 2.5),", "");
    Document::parse("test.ron", &text).unwrap_or_else(|error| panic!("{}", error.render(false)))
}

fn halve(mut fluid: Query<&mut Viscosity, With<Fluid>>) {
    fluid.iter_mut().for_each(|mut viscosity| viscosity.0 *= 0.5);
}

fn double(mut fluid: Query<&mut Viscosity, With<Fluid>>) {
    fluid.iter_mut().for_each(|mut viscosity| viscosity.0 *= 2.0);
}

/// Two systems that write one column, and no order between them.
struct Unordered;

impl Plugin for Unordered {
    fn build(&self, app: &mut App) {
        app.set_stage(Stage::Rheology, (halve, double), (halve, double));
    }
}

#[test]
fn two_writers_without_an_order_are_refused() {
    let error = refusal(open(PaperPlugins.build().add(Unordered), plain_scene()));
    assert!(error.contains("halve") && error.contains("double") && error.contains("Viscosity"), "{error}");
}

/// Stands in for every rheology.
struct Constant;

impl Plugin for Constant {
    fn build(&self, app: &mut App) {
        let seven = |mut fluid: Query<&mut Viscosity, With<Fluid>>| fluid.iter_mut().for_each(|mut mu| mu.0 = 7.0);
        app.set_stage(Stage::Rheology, seven, seven);
    }
}

#[test]
fn the_stage_of_rheologies_can_be_replaced() {
    let mut app = open(PaperPlugins.build().add(Constant), plain_scene()).unwrap_or_else(|error| panic!("{error}"));
    let world = app.world_mut();
    assert!(world.query_filtered::<&Viscosity, With<Fluid>>().iter(world).all(|mu| mu.0 == 7.0));
}

/// A system that fails after a while.
struct Failing;

fn fail(clock: Res<Clock>) -> Result {
    if clock.step > 5 { Err("out of luck".into()) } else { Ok(()) }
}

impl Plugin for Failing {
    fn build(&self, app: &mut App) {
        app.add_to_stage(Stage::BodyForce, fail);
    }
}

#[test]
fn a_system_that_fails_ends_the_run_in_order() {
    let mut app = open(PaperPlugins.build().add(Failing), plain_scene()).unwrap_or_else(|error| panic!("{error}"));
    let end = run(app.world_mut(), 0.05, &StopFlag::default(), |_| {});
    let End::Failed(what) = end else { panic!("{end:?}") };
    assert!(what.contains("fail") && what.contains("out of luck"), "{what}");
}

/// A marker on one particle splits the table of the fluid.
#[derive(Component)]
struct Marked;

struct Splitting;

impl Plugin for Splitting {
    fn build(&self, app: &mut App) {
        app.register_scene_section::<Splitter>();
    }
}

#[derive(Serialize, Deserialize, JsonSchema)]
struct Splitter();

impl SceneSection for Splitter {
    const NAME: &'static str = "splitter";

    fn when_absent() -> Option<Self> {
        Some(Self())
    }

    fn spawn(self, world: &mut World) -> Result<(), SectionError> {
        let last = world.query_filtered::<Entity, With<Fluid>>().iter(world).last().expect("there is fluid");
        world.entity_mut(last).insert(Marked);
        Ok(())
    }
}

#[test]
fn a_marker_on_one_particle_is_refused() {
    let error = refusal(open(PaperPlugins.build().add(Splitting), plain_scene()));
    assert!(error.contains("Marked"), "{error}");
}
