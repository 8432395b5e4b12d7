//! The guard of the step's speed: `cargo bench --profile dev --bench guard` ends with exit code 1 if a step got slower.
//!
//! A machine that is twice as slow, or busy, must not raise it: what is compared are ratios of times taken alternately in one
//! run on one thread, the fastest of each. The measure of a step is the kernel's own loop: ∇W of as many pairs as its sweeps meet, which
//! no step can do without. The kernel's own measure is a root and a division for each pair.
//!
//! The limits are those of four numbers side by side (AVX2, AVX-512). Where a processor has fewer, nothing is judged.

mod support;

use std::time::{Duration, Instant};

use bevy_ecs::prelude::World;
use pulp::{Arch, Simd, WithSimd};
use storegga::kernels::SmoothingKernel;
use storegga::neighbours::Neighbours;
use support::{step, tank};

const ROUNDS: u32 = 60;

/// Sweeps over the pairs of the fluid in a step: the middle of the drift, and the forces.
const SWEEPS: usize = 2;

/// The kernel may take this many times what one root and one division a pair take. Seen: 1.3 to 1.4 with AVX2, 1.3 with AVX-512.
const MOST_ROOTS: f64 = 1.7;

/// A step may take this many times what the kernel takes for its pairs. Seen: 2.5 with AVX-512; 2.9 to 3.2 with AVX2, before sweep 1 was
/// shortened.
const MOST_KERNELS: f64 = 3.4;

/// The plain loops take at least this many times as long as the fast ones. Seen: 3.0 with AVX2, 3.1 to 3.2 with AVX-512.
const LEAST_GAIN: f64 = 2.4;

/// New lists may take this many steps. Seen: 0.5 with both.
const MOST_STEPS_A_LIST: f64 = 0.75;

fn main() -> Result<(), rayon::ThreadPoolBuildError> {
    let lanes = Arch::new().dispatch(Lanes);
    if lanes < 4 {
        println!("not judged: {lanes} numbers side by side, and the limits are those of four");
        return Ok(());
    }
    let spacing = ("spacing", "0.004");
    let (mut fast, _) = tank(2, &[spacing]);
    let (mut plain, _) = tank(2, &[spacing, ("neighbours", "(loops: Plain)")]);
    let (fast, plain) = (fast.world_mut(), plain.world_mut());
    // Whole steps run on the one thread of the pool, as those of a run do.
    let is_right = rayon::ThreadPoolBuilder::new().num_threads(1).build()?.install(|| measure(fast, plain));
    std::process::exit(i32::from(!is_right));
}

/// Whether all ratios are as they should be.
fn measure(fast: &mut World, plain: &mut World) -> bool {
    let kernel = fast.resource::<SmoothingKernel>().clone();
    let pairs = SWEEPS * fast.resource::<Neighbours>().fluid.len();

    let [mut of_step, mut of_new_lists, mut of_plain, mut of_kernel, mut of_roots] = [Duration::MAX; 5];
    for _ in 0..ROUNDS {
        take_least(&mut of_step, || step(fast));
        take_least(&mut of_new_lists, || {
            fast.resource_mut::<Neighbours>().invalidate();
            step(fast);
        });
        take_least(&mut of_plain, || step(plain));
        take_least(&mut of_kernel, || evaluate(&kernel, pairs));
        take_least(&mut of_roots, || for_batches(pairs, |batch| Arch::new().dispatch(Roots(batch))));
    }
    let ratio = |a: Duration, b: Duration| a.as_secs_f64() / b.as_secs_f64();
    let lists = of_new_lists.saturating_sub(of_step);
    let checks = [
        ("the kernel, in times of a root and a division", ratio(of_kernel, of_roots), 0.0..=MOST_ROOTS),
        ("a step, in times of the kernel for its pairs", ratio(of_step, of_kernel), 0.0..=MOST_KERNELS),
        ("plain loops, in times of fast ones", ratio(of_plain, of_step), LEAST_GAIN..=f64::INFINITY),
        ("new lists, in steps", ratio(lists, of_step), 0.0..=MOST_STEPS_A_LIST),
    ];
    println!(
        "step {of_step:?}, with new lists {of_new_lists:?}, plain {of_plain:?}, kernel {of_kernel:?}, roots {of_roots:?}"
    );
    let mut all = true;
    for (what, found, range) in checks {
        let is_right = range.contains(&found);
        all &= is_right;
        println!("{} {what}: {found:.2} (in {range:?})", if is_right { "ok  " } else { "FAIL" });
    }
    all
}

fn take_least(least: &mut Duration, what: impl FnOnce()) {
    let start = Instant::now();
    what();
    *least = start.elapsed().min(*least);
}

/// The kernel's gradient for `pairs` pairs, as many at once as a sweep asks for.
fn evaluate(kernel: &SmoothingKernel, pairs: usize) {
    let unit = kernel.0.radius().powi(2);
    for_batches(pairs, |batch| {
        batch.iter_mut().for_each(|square| *square *= unit);
        kernel.0.gradients(batch);
    });
}

/// Numbers of a batch of the kernel.
const AT_ONCE: usize = 256;

/// Calls `work` with squares of distances between 0 and 1, for `pairs` pairs altogether.
fn for_batches(pairs: usize, mut work: impl FnMut(&mut [f64; AT_ONCE])) {
    let squares: [f64; AT_ONCE] = std::array::from_fn(|k| ((k as f64 + 0.5) / AT_ONCE as f64).powi(2));
    for _ in 0..pairs.div_ceil(AT_ONCE) {
        let mut batch = squares;
        work(std::hint::black_box(&mut batch));
        std::hint::black_box(&batch);
    }
}

/// Numbers side by side in a register.
struct Lanes;

impl WithSimd for Lanes {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> usize {
        S::F64_LANES
    }
}

/// One root and one division for each number.
struct Roots<'a>(&'a mut [f64; AT_ONCE]);

impl WithSimd for Roots<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let one = simd.splat_f64s(1.0);
        for square in S::as_mut_simd_f64s(self.0).0 {
            *square = simd.div_f64s(one, simd.sqrt_f64s(*square));
        }
    }
}
