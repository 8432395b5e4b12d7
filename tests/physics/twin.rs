//! A channel extruded into the third direction, periodic there, flows like its plane twin.

use bevy_ecs::prelude::*;
use storegga::app::{StopFlag, run};
use storegga::particles::{Fluid, Position, Velocity};

use crate::support::app;

const LAYERS: usize = 10;

/// Mean velocity (m/s) along the channel in each layer of particles, after `end` (s).
fn profile(scene: &str, overrides: &[&str], end: f64) -> [f64; LAYERS] {
    let mut app = app(scene, overrides);
    let world = app.world_mut();
    run(world, end, &StopFlag::default(), |_| {});
    let (mut sum, mut count) = ([0.0; LAYERS], [0.0; LAYERS]);
    for (x, v) in world.query_filtered::<(&Position, &Velocity), With<Fluid>>().iter(world) {
        let layer = ((x.0.y / 0.1 * LAYERS as f64) as usize).min(LAYERS - 1);
        sum[layer] += v.0.x;
        count[layer] += 1.0;
    }
    std::array::from_fn(|layer| sum[layer] / count[layer])
}

#[test]
fn an_extruded_channel_equals_its_plane_twin() {
    let plane = profile(
        include_str!("../../scenes/channel.ron"),
        &["spacing=0.01", "smoothing_ratio=1.0", "periodic.x.1=0.06", "fluids.0.shape.max.0=0.06"],
        2.0,
    );
    let extruded = profile(
        include_str!("../../scenes/channel_3d.ron"),
        &[
            "spacing=0.01",
            "periodic.x.1=0.06",
            "periodic.z.1=0.06",
            "fluids.0.shape.max.0=0.06",
            "fluids.0.shape.max.2=0.06",
        ],
        2.0,
    );
    let norm = |v: &[f64; LAYERS]| v.iter().map(|u| u * u).sum::<f64>().sqrt();
    let difference: [f64; LAYERS] = std::array::from_fn(|layer| extruded[layer] - plane[layer]);
    assert!(norm(&plane) > 0.01, "nothing flows: {plane:?}");
    assert!(norm(&difference) < 0.01 * norm(&plane), "plane {plane:?}\nextruded {extruded:?}");
}
