//! A pile at rest is stepped without a single allocation. This binary counts them; one test alone
//! runs in it, so that no other thread allocates meanwhile.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

use common::{start, take_steps};
use glam::DVec2;
use slump::scene::paper_pile;
use slump::sim::Stepper;
use slump::world::Boundary;

/// The system's allocator, counting.
struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as for this function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: as for this function.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: as for this function.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_step_at_rest_allocates_nothing() {
    let before = ALLOCATIONS.load(Ordering::Relaxed);
    let mut scene = paper_pile().expect("the shipped state");
    assert!(ALLOCATIONS.load(Ordering::Relaxed) > before, "allocations are counted");
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 8.0 * scene.mean_diameter, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    scene.boundaries = vec![wall(-1.0), wall(1.0)];
    scene.parameters.bond = 5.0;
    scene.solver.tolerance = 1e-4;
    for law in [Stepper::Moreau, Stepper::Range] {
        scene.stepper = law;
        let mut simulation = start(&scene);
        take_steps(&mut simulation, 50);
        let before = ALLOCATIONS.load(Ordering::Relaxed);
        take_steps(&mut simulation, 500);
        assert_eq!(ALLOCATIONS.load(Ordering::Relaxed) - before, 0, "{law:?}");
        assert!(simulation.observables().contacts > 138, "the pile stands");
    }
}
