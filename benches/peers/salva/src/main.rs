//! A tank of salva3d at rest, as large as Storegga's `scenes/tank_3d.ron`. Prints the positions at the end, a particle a line:
//! `fluid` or `solid` and three coordinates.
//!
//! Usage: salva-tank SPACING SUPPORT STEPS, where SUPPORT is the radius of the kernel in spacings.

use std::{env, process::exit};

use nalgebra::Vector3;
use salva3d::{
    object::{interaction_groups::InteractionGroups, Boundary, Fluid},
    solver::{ArtificialViscosity, DFSPHSolver},
    LiquidWorld,
};

/// Layers of the walls.
const LAYERS: i32 = 2;

fn main() {
    let numbers: Vec<f32> = env::args().skip(1).filter_map(|text| text.parse().ok()).collect();
    let [spacing, support, steps] = numbers[..] else {
        eprintln!("salva-tank: wants three numbers: SPACING SUPPORT STEPS");
        exit(2);
    };
    let (wide, high) = ((0.2 / spacing).round() as i32, (0.4 / spacing).round() as i32);

    let (mut fluid, mut walls) = (Vec::new(), Vec::new());
    for x in -LAYERS..wide + LAYERS {
        for y in -LAYERS..wide + LAYERS {
            for z in -LAYERS..high + 2 * LAYERS {
                let place = Vector3::new(x as f32 + 0.5, y as f32 + 0.5, z as f32 + 0.5) * spacing;
                let inside = |k: i32| (0..wide).contains(&k);
                match inside(x) && inside(y) && z >= 0 {
                    true if z < high => fluid.push(place),
                    true => {}
                    false => walls.push(place),
                }
            }
        }
    }
    let solver: DFSPHSolver = DFSPHSolver::new();
    let radius = spacing / 2.0;
    let mut world = LiquidWorld::new(solver, radius, support, 1.0);
    let mut liquid = Fluid::new(fluid, radius, 1000.0, InteractionGroups::default());
    liquid.nonpressure_forces.push(Box::new(ArtificialViscosity::new(0.5, 0.0)));
    let liquid = world.add_fluid(liquid);
    let walls = world.add_boundary(Boundary::new(walls, InteractionGroups::default()));

    // A fortieth of a spacing at the speed of a fall from the surface.
    let step = spacing / 40.0 / (2.0f32 * 9.81 * 0.4).sqrt();
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    for _ in 0..steps as usize {
        world.step(step, &gravity);
    }

    let (liquid, walls) = (world.fluids().get(liquid), world.boundaries().get(walls));
    let liquid = liquid.iter().flat_map(|fluid| &fluid.positions).map(|place| ("fluid", place));
    let walls = walls.iter().flat_map(|wall| &wall.positions).map(|place| ("solid", place));
    for (kind, place) in liquid.chain(walls) {
        println!("{kind} {} {} {}", place.x, place.y, place.z);
    }
}
