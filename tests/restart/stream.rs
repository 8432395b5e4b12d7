//! The scene of these runs.

/// Whatever is shipped, at once: three liquids, two of them soils, that a force drives over a floor that moves, past a body that
/// goes up and down, round through the sides and through a relaxation zone, while the ground shakes; lists are rebuilt and
/// particles re-sorted often, and probes measure.
pub fn stream(dimension: usize) -> String {
    let (spacing, z) = if dimension == 2 { (0.05, "") } else { (0.1, ", z: (0.0, 0.8)") };
    let at = |x: f64, y: f64, z: f64| {
        if dimension == 2 { format!("({x:?}, {y:?})") } else { format!("({x:?}, {y:?}, {z:?})") }
    };
    let block = |(x0, y0, z0), (x1, y1, z1)| format!("Box(min: {}, max: {})", at(x0, y0, z0), at(x1, y1, z1));
    let (round, axis) = if dimension == 2 { ("Circle", "") } else { ("Sphere", "axis: (0.0, 0.0, 1.0),") };
    let (mud, sand) = (block((0.0, 0.0, 0.0), (0.4, 0.3, 0.8)), block((0.4, 0.0, 0.0), (0.8, 0.3, 0.8)));
    let water = block((0.0, 0.3, 0.0), (0.8, 0.6, 0.8));
    let (floor, open) = (block((-1.0, 0.0, -1.0), (2.0, 2.0, 2.0)), block((-3.0, 0.0, -3.0), (3.0, 3.0, 3.0)));
    let row = |time: f64, up: f64| format!("(time: {time:?}, displacement: {})", at(0.0, up, 0.0));
    format!(
        r#"Scene(
    dimension: {dimension}, spacing: {spacing:?}, gravity: {gravity}, end_time: 0.1,
    periodic: (x: (0.0, 0.8){z}), neighbours: (skin: 0.02, sort_every: 2), equation_of_state: (max_speed: 3.0),
    phases: {{
        "mud": (reference_density: 1500.0, rheology: StrainSoftening(
            consistency: 3.0, exponent: 0.7, peak_yield_stress: 50.0, sensitivity: 4.0, strain_95: 0.2, max_viscosity: 50.0)),
        "sand": (reference_density: 1800.0, rheology: MuI(
            static_friction: 0.4, limiting_friction: 0.7, inertial_number: 0.3, grain_diameter: 0.001,
            grain_density: 2600.0, pore_pressure: Dry, pressure_floor: 1.0, max_viscosity: 50.0)),
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
    }},
    fluids: [
        (phase: "mud", shape: {mud}, pressure: Uniform(0.0)),
        (phase: "sand", shape: {sand}, pressure: Uniform(0.0)),
        (phase: "water", shape: {water}, velocity: {velocity}, pressure: Uniform(0.0)),
    ],
    walls: {{ "floor": (shape: {floor}, cut: {open}, motion: Translation(velocity: {backwards})) }},
    structures: {{ "body": (
        shape: {round}(center: {center}, radius: 0.15),
        motion: Table(center: {center}, {axis} rows: [{up}, {down}]),
    ) }},
    probes: {{
        "front": Front(phase: "mud", direction: {upward}), "mud": CenterOfMass(phase: "mud"),
        "gauge": SurfaceHeight(at: {center}), "pressure": PressurePoint(at: {center}),
        "drag": ForceCoefficients(structure: "body", velocity: {velocity}, density: 1000.0, frontal: 0.3),
        "flow": MeanVelocity(shape: {water}),
    }},
    relaxation_zones: {{ "inlet": (shape: {mud}, target: Uniform(velocity: {velocity}), rate: 5.0, ramp: 0.1) }},
    shaking: Accelerogram(file: "quake.csv", time: "t", columns: [(name: "a", direction: {velocity})]),
    log: (particles: 0.02, series: 0.005),
    expect: [
        (name: "over the whole run", of: "body.force_y", take: Mean(from: 0.0, to: 0.1), is: Between(-1e9, 1e9)),
        (name: "measured", of: "mud.vx", is: Csv(file: "measured.csv", time: "t", value: "v"), within: Absolute(1e9)),
    ],
)
"#,
        gravity = at(4.0, -9.81, 0.0),
        velocity = at(1.0, 0.0, 0.0),
        backwards = at(-0.5, 0.0, 0.0),
        upward = at(0.0, 1.0, 0.0),
        center = at(0.4, 0.3, 0.4),
        up = row(0.0, 0.0),
        down = row(0.3, 0.1),
    )
}

/// What the stream leaves out: a yield stress, a wave at the start, damping that ends on the way, walls that fluid hits, the books.
pub fn slosh() -> String {
    r#"Scene(
    dimension: 2, spacing: 0.04, gravity: (0.0, -9.81), end_time: 0.1,
    neighbours: (skin: 0.02, sort_every: 2), equation_of_state: (max_speed: 3.0),
    settling: Damping(until: 0.05, rate: 5.0),
    phases: {
        "mud": (reference_density: 1500.0, rheology: HerschelBulkley(
            consistency: 3.0, exponent: 0.7, yield_stress: 50.0, max_viscosity: 50.0)),
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
    },
    fluids: [
        (phase: "mud", shape: Box(min: (0.0, 0.0), max: (0.8, 0.2))),
        (phase: "water", shape: Box(min: (0.0, 0.2), max: (0.8, 0.4))),
    ],
    disturbance: Mode(along: X, crest: 0.0, wavelength: 1.6, level: 0.2, below: 0.2, above: 0.2, velocity: 0.8),
    walls: { "tank": (shape: Box(min: (0.0, 0.0), max: (0.8, 0.8))) },
    probes: {
        "books": Books(), "wave": LayerMode(phase: "mud", along: X, crest: 0.0, wavelength: 1.6),
        "mixing": PhaseMixing(), "fluid": DensityError(), "water": CenterOfMass(phase: "water"),
    },
    log: (particles: 0.02, series: 0.005),
    expect: [
        (name: "books", of: "books.residual", take: Max, is: Between(-1e9, 1e9)),
        (name: "measured", of: "water.vx", is: Csv(file: "measured.csv", time: "t", value: "v"), within: Absolute(1e9)),
    ],
)
"#
    .to_owned()
}
