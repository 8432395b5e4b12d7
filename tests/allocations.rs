//! A step allocates nothing once it is warm.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use storegga::app::{PaperPlugins, StopFlag, open, run};
use storegga::clock::Clock;
use storegga::neighbours::Neighbours;
use storegga::scene::Document;

/// Counts what the system's allocator is asked for.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is passed on unchanged to the system's allocator.
#[expect(unsafe_code, reason = "a global allocator cannot be written without it")]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// A column of water that collapses on a structure, in a tank.
const SCENE: &str = r#"Scene(
    dimension: 2, spacing: 0.02, gravity: (0.0, -9.81), end_time: 10.0,
    phases: {
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
        "mud": (reference_density: 1500.0, rheology: HerschelBulkley(
            consistency: 1.0, exponent: 0.8, yield_stress: 10.0, max_viscosity: 10.0)),
    },
    fluids: [
        (phase: "mud", shape: Box(min: (0.0, 0.0), max: (0.4, 0.3))),
        (phase: "water", shape: Box(min: (0.0, 0.3), max: (0.4, 0.6))),
    ],
    walls: { "tank": (shape: Box(min: (0.0, 0.0), max: (1.0, 1.0))) },
    structures: { "post": (shape: Circle(center: (0.6, 0.2), radius: 0.06)) },
)"#;

/// Two liquids that flow round through periodic sides, over a floor that moves and past a ball that goes up and down.
const STREAM: &str = r#"Scene(
    dimension: 3, spacing: 0.1, gravity: (4.0, 0.0, -9.81), end_time: 10.0,
    periodic: (x: (0.0, 0.8), y: (0.0, 0.8)), neighbours: (skin: 0.02, sort_every: 2),
    equation_of_state: (max_speed: 3.0),
    phases: {
        "water": (reference_density: 1000.0, rheology: Newtonian(viscosity: 0.001)),
        "mud": (reference_density: 1500.0, rheology: HerschelBulkley(
            consistency: 1.0, exponent: 0.8, yield_stress: 10.0, max_viscosity: 10.0)),
    },
    fluids: [
        (phase: "mud", shape: Box(min: (0.0, 0.0, 0.0), max: (0.8, 0.8, 0.32)), pressure: Uniform(0.0)),
        (phase: "water", shape: Box(min: (0.0, 0.0, 0.32), max: (0.8, 0.8, 0.64)), pressure: Uniform(0.0)),
    ],
    walls: { "floor": (
        shape: Box(min: (-1.0, -1.0, 0.0), max: (2.0, 2.0, 2.0)),
        cut: Box(min: (-3.0, -3.0, 0.0), max: (3.0, 3.0, 3.0)),
        motion: Translation(velocity: (-0.5, 0.0, 0.0)),
    ) },
    structures: { "ball": (
        shape: Sphere(center: (0.4, 0.4, 0.3), radius: 0.15),
        motion: Table(center: (0.4, 0.4, 0.3), axis: (0.0, 0.0, 1.0), rows: [
            (time: 0.0, displacement: (0.0, 0.0, 0.0)), (time: 0.5, displacement: (0.0, 0.0, 0.1)),
            (time: 1.0, displacement: (0.0, 0.0, 0.0)),
        ]),
    ) },
)"#;

#[test]
fn a_warm_step_allocates_nothing() {
    // One after the other: the counter counts for all.
    assert_eq!(allocations_when_warm(SCENE), 0, "in 200 steps");
    // Now and then there are more pairs or images than ever before: memory has room for them.
    assert_eq!(allocations_when_warm(STREAM), 0, "in 200 steps");
    let books = "probes: { \"books\": Books() }, phases:";
    assert_eq!(allocations_when_warm(&STREAM.replace("phases:", books)), 0, "in 200 steps with books");
}

/// Allocations in 200 steps after 400.
fn allocations_when_warm(scene: &str) -> u64 {
    let document = Document::parse("test.ron", scene).expect("a right scene");
    let mut app = open(PaperPlugins, document).expect("a right scene");
    let world = app.world_mut();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("a thread pool");
    let mut advance = |steps: u64| {
        pool.install(|| {
            let last = world.resource::<Clock>().step + steps;
            let stop = StopFlag::default();
            let (watched, mut during) = (stop.clone(), 0);
            run(world, f64::INFINITY, &stop, |clock| {
                if clock.step + steps == last + 1 {
                    during = ALLOCATIONS.load(Ordering::Relaxed);
                }
                if clock.step >= last {
                    during = ALLOCATIONS.load(Ordering::Relaxed) - during;
                    watched.stop();
                }
            });
            (during, world.resource::<Neighbours>().builds)
        })
    };
    let (_, builds_before) = advance(400);
    let (allocations, builds_after) = advance(200);
    assert!(builds_after > builds_before + 2, "lists were hardly rebuilt: the test would miss that");
    allocations
}
