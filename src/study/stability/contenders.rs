//! Who is tried: every method of the registry, and settings that mend a known failure.

use crate::scene::{Preset, Scene};
use crate::solver::{METHODS, Method, Ordering};

/// A way to step that is tried.
#[derive(Clone, Copy, Debug)]
pub struct Contender {
    /// Its name in the table.
    pub name: &'static str,
    apply: fn(&mut Scene, Method),
    method: Method,
}

impl Contender {
    /// Changes a scene to be stepped this way; whatever else it says stays.
    pub fn apply(&self, scene: &mut Scene) {
        (self.apply)(scene, self.method);
    }

    /// The contender of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        CONTENDERS.iter().find(|contender| contender.name == name)
    }

    const fn of_method(index: usize) -> Self {
        let info = METHODS[index];
        Self {
            name: info.name,
            apply: |scene, method| scene.solver.method = method,
            method: info.method,
        }
    }
}

/// All contenders.
pub static CONTENDERS: [Contender; METHODS.len() + 2] = {
    let bottom_up = Contender {
        name: "nsgs bottom-up",
        apply: |scene, method| {
            scene.solver.method = method;
            scene.solver.ordering = Ordering::BottomUp;
        },
        method: Method::Nsgs,
    };
    let robust = Contender {
        name: "robust",
        apply: |scene, _| Preset::Robust.apply(scene),
        method: Method::Newton,
    };
    let mut all = [bottom_up; METHODS.len() + 2];
    all[METHODS.len() + 1] = robust;
    let mut index = 0;
    while index < METHODS.len() {
        all[index] = Contender::of_method(index);
        index += 1;
    }
    all
};
