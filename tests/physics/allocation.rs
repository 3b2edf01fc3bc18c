//! Checks that steps of a pile at rest allocate no memory. Each thread counts its own allocations; steps of a pile this
//! small use a single thread.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use crate::common::*;

struct Counting;

thread_local! {
    static ALLOCATIONS: Cell<u64> = const { Cell::new(0) };
}

fn allocations() -> u64 {
    ALLOCATIONS.get()
}

// SAFETY: each call is passed on unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(allocations() + 1);
        // SAFETY: the caller meets the conditions of this function, which are those of the system's function.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller meets the conditions of this function, which are those of the system's function.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        ALLOCATIONS.set(allocations() + 1);
        // SAFETY: the caller meets the conditions of this function, which are those of the system's function.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn a_step_at_rest_allocates_nothing() {
    let before = allocations();
    let mut scene = paper_pile().expect("the shipped state");
    assert!(allocations() > before, "allocations are counted");
    let wall = |side: f64| Boundary::HalfSpace {
        point: DVec2::new(side * 8.0 * scene.mean_diameter, 0.0),
        normal: DVec2::new(-side, 0.0),
    };
    scene.boundaries = vec![wall(-1.0), wall(1.0)];
    scene.parameters.bond = 5.0;
    scene.solver.tolerance = 1e-4;
    for law in [Stepper::Moreau, Stepper::Range] {
        scene.stepper = law;
        let mut run = after(&scene, 50);
        let before = allocations();
        take_steps(&mut run, 500);
        assert_eq!(allocations() - before, 0, "{law:?}");
        assert!(run.observables().contacts > 138, "the pile stands");
    }
}
