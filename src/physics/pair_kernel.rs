//! The kernel of every pair of a ghost and fluid, once a step.
//!
//! `W_ij` (Eq. 4) with which walls and structures interpolate, and `∇_iW_ij = (r_ij/r) dW/dr` (Eq. 3) as the factor
//! `F_ij = (dW/dr)/r` for the loads on structures. (Sweeps over the fluid evaluate ∇W as they go: to keep it would take 400 bytes a
//! particle in 2D.)

use bevy_ecs::prelude::*;

use crate::kernels::SmoothingKernel;
use crate::neighbours::{Neighbours, Wanted};
use crate::particles::{Fluid, Gathered, Position, Solid, Vector, Wall, Workspace, columns};

/// Evaluates W and (dW/dr)/r of every pair of a ghost and fluid.
pub fn pair_kernel<const D: usize>(
    mut neighbours: ResMut<Neighbours>,
    kernel: Res<SmoothingKernel>,
    mut workspace: ResMut<Workspace>,
    fluid: Query<&Position, With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) {
    let n = &mut *neighbours;
    let tables: [&[Position]; 3] = [columns(&fluid), columns(&walls), columns(&structures)];
    let [fluid, walls, structures] =
        tables.map(|x| move |k: usize| Gathered { position: Vector::from(x[k].0), state: () });
    let records = workspace.gather::<D, ()>(&n.rows, fluid, walls, structures);

    let mut first_owner = n.rows.fluid;
    for (list, owners, wanted) in [
        (&mut n.walls, n.rows.walls, Wanted { gradients: false, values: true }),
        (&mut n.structures, n.rows.structures, Wanted { gradients: true, values: true }),
    ] {
        list.evaluate(
            wanted,
            |i, rows, squared_distances| {
                let x_i = records.get(first_owner + i).position;
                for (&row, out) in rows.iter().zip(squared_distances) {
                    let r_ij = x_i - records.get(row as usize).position;
                    *out = r_ij.dot(r_ij);
                }
            },
            |x| kernel.0.gradients(x),
            |x| kernel.0.values(x),
        );
        first_owner += owners;
    }
}
