//! How wide skins are, and when they are used up.
//!
//! Every particle has a half-skin s of its own: two are listed if they are nearer than `R + s_i + s_j`, R the support radius. So no pair
//! within the support is missing as long as no particle is farther than its s from where it was when the lists were built. Sweeps over the middle
//! of the drift find theirs, too: it lies between two places that were both within s, or half a step before the build. (Where shifting carries a particle
//! out of its s and the drift back, and with skins given narrower than a step, pairs at the very edge of the support may be missing, where ∇W is some
//! 10⁻⁸ of its greatest.)
//!
//! Who is fast gets a wide one, who rests a narrow one: lists would last N steps,
//!
//! `s_i = N (x_i + f x̄)`,
//!
//! x_i how far particle i goes in a step and x̄ its mean over the fluid; `f x̄` is for those that get faster meanwhile. A step costs `C_l/N`
//! for lists and `C_p (1 + a (s_i + s_j)/R)` for sweeps, which is least with
//!
//! `N = √(C_l R/(2 a C_p (1 + f) x̄))`.

use bevy_ecs::prelude::*;
use rayon::prelude::*;

use super::PeriodicSides;
use super::build::{NeighbourSettings, Neighbours};
use super::list::clear_with_room_for_images;
use crate::clock::Clock;
use crate::kernels::SmoothingKernel;
use crate::particles::{Fluid, GRAIN, Position, Solid, Velocity, Wall, WallVelocity, columns};

/// The half-skin of the first lists, and the bounds of the others where the scene gives no skin (in support radii).
pub(crate) const FIRST_HALF_SKIN: f64 = 0.025;
pub(super) const LEAST_HALF_SKIN: f64 = 0.0025;
const GREATEST_HALF_SKIN: f64 = 0.2;

/// `√(C_l/(2 a C_p))`; in the plane `C_l ≈ 0.5 C_p` and a ≈ 1.6 were measured.
const SKIN_FOR_MOTION: f64 = 0.4;

/// f.
const SPARE: f64 = 0.5;

/// The greatest half-skin (in support radii) with which no particle meets its own image.
pub(super) fn greatest_half_skin(sides: &PeriodicSides, radius: f64) -> f64 {
    let periods = sides.0.into_iter().flatten().map(|(from, to)| to - from);
    periods.map(|period| 0.5 * (period / radius - 1.0)).fold(GREATEST_HALF_SKIN, f64::min)
}

/// Sets the half-skin of every row without images, for lists to be built now.
pub(super) fn set_half_skins(
    settings: Res<NeighbourSettings>,
    clock: Res<Clock>,
    sides: Res<PeriodicSides>,
    kernel: Res<SmoothingKernel>,
    mut neighbours: ResMut<Neighbours>,
    fluid: Query<&Velocity, With<Fluid>>,
    walls: Query<&WallVelocity, With<Wall>>,
    structures: Query<&WallVelocity, With<Solid>>,
) {
    let radius = kernel.0.radius();
    let (v, walls, structures): (&[Velocity], &[WallVelocity], &[WallVelocity]) =
        (columns(&fluid), columns(&walls), columns(&structures));
    let greatest = greatest_half_skin(&sides, radius);
    let (is_first, images) = (neighbours.builds == 0, neighbours.rows.images.len());
    let out = &mut neighbours.half_skins;
    let rows = v.len() + walls.len() + structures.len();
    clear_with_room_for_images(out, rows, images);
    let uniform = settings.skin.map(|skin| 0.5 * skin).or(is_first.then_some(FIRST_HALF_SKIN.min(greatest)));
    if let Some(half_skin) = uniform {
        out.resize(rows, (half_skin * radius) as f32);
        return;
    }
    // How far each goes in a step, in support radii.
    let scale = clock.stable_time_step / radius;
    let of_ghosts = walls.iter().chain(structures).map(|v_w| v_w.0.length());
    out.extend(v.iter().map(|v| v.0.length()).chain(of_ghosts).map(|speed| (speed * scale) as f32));
    let mean = out[..v.len()].iter().copied().map(f64::from).sum::<f64>() / v.len() as f64;
    let farthest = f64::from(out.iter().copied().fold(0.0, f32::max));
    let spare = SPARE * mean;
    let steps = (SKIN_FOR_MOTION / (mean + spare).sqrt()).min(greatest / (farthest + spare));
    for s in out {
        // With all at rest the product is no number, of which `max` makes the least.
        let half_skin = (steps * (f64::from(*s) + spare)).max(LEAST_HALF_SKIN).min(greatest);
        *s = (half_skin * radius) as f32;
    }
}

/// Whether a particle has used up its half-skin, or there are no lists yet.
pub(super) fn lists_are_stale(
    neighbours: Res<Neighbours>,
    fluid: Query<&Position, With<Fluid>>,
    walls: Query<&Position, With<Wall>>,
    structures: Query<&Position, With<Solid>>,
) -> bool {
    let n = &*neighbours;
    if n.builds == 0 || n.is_invalid {
        return true;
    }
    let tables: [&[Position]; 3] = [columns(&fluid), columns(&walls), columns(&structures)];
    let starts = [0, n.rows.fluid, n.rows.fluid + n.rows.walls];
    let serves = |(start, table): (usize, &[Position])| {
        let then = n.positions[start..].par_iter().zip(&n.half_skins[start..]);
        // Not so where a position is no number.
        table.par_iter().zip(then).with_min_len(GRAIN).all(|(x, (then, s))| {
            let half_skin = f64::from(*s);
            x.0.distance_squared(*then) <= half_skin * half_skin
        })
    };
    !starts.into_iter().zip(tables).all(serves)
}

#[cfg(test)]
mod tests {
    use bevy_ecs::system::RunSystemOnce;
    use glam::DVec3;

    use super::*;

    /// Whether lists serve whose rows are 0.1 m apart, the row `moved` of a fluid particle, a wall and a structure being `by` times its half-skin from
    /// where it was.
    fn are_stale(moved: usize, by: f64) -> bool {
        let mut n = Neighbours::default();
        [n.rows.fluid, n.rows.walls, n.rows.structures] = [1; 3];
        n.builds = 1;
        n.half_skins = vec![0.01, 0.002, 0.04];
        n.positions = [0.0, 0.1, 0.2].map(|x| DVec3::new(x, 0.0, 0.0)).to_vec();
        let mut now = n.positions.clone();
        now[moved].y += by * f64::from(n.half_skins[moved]);
        let mut world = World::new();
        world.spawn((Fluid, Position(now[0])));
        world.spawn((Wall, Position(now[1])));
        world.spawn((Solid, Position(now[2])));
        world.insert_resource(n);
        world.run_system_once(lists_are_stale).expect("it runs")
    }

    #[test]
    fn lists_serve_until_a_particle_has_used_up_its_half_skin() {
        for row in 0..3 {
            assert!(!are_stale(row, 0.0) && !are_stale(row, 0.999) && !are_stale(row, -0.999), "row {row}");
            assert!(are_stale(row, 1.001) && are_stale(row, -1.001) && are_stale(row, f64::NAN), "row {row}");
        }
    }
}
