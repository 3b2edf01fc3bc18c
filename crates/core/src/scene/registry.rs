//! The list of the built-in scenes, and functions that find a scene by its name.

use super::{Scene, collision, cradle, experiments, paper_pile, stability};
use crate::error::{Error, Result};
use crate::setting::words;

words! {
    /// Purpose of a scene. Lists of scenes show it as a heading.
    pub enum SceneGroup {
        Paper = "paper", "Scenes";
        Experiments = "experiments", "Experiments";
        Stability = "stability", "Scenes made to break methods";
    }
}

/// Entry in the list of built-in scenes: name, purpose, description and constructor.
#[derive(Clone, Copy, Debug)]
pub struct SceneInfo {
    /// Name of the scene on the command line.
    pub name: &'static str,
    /// Further names of the scene: the names of the stability tests that use it.
    pub also: &'static [&'static str],
    /// Purpose of the scene, under which lists show it.
    pub group: SceneGroup,
    /// Description of the scene in one line.
    pub summary: &'static str,
    /// Creates the scene.
    pub make: fn() -> Result<Scene>,
}

impl SceneInfo {
    /// Returns the built-in scene with this name, whether it is written in upper or lower case. `None` if there is no
    /// such scene.
    pub fn named(name: &str) -> Option<&'static Self> {
        let is_it = |known: &&str| known.eq_ignore_ascii_case(name);
        SCENES.iter().find(|scene| is_it(&scene.name) || scene.also.iter().any(is_it))
    }
}

/// Declares the built-in scenes, grouped by purpose, each with its names, description and constructor.
macro_rules! scenes {
    ($($Group:ident { $($name:literal $(| $also:literal)*, $summary:literal => $make:expr;)* })*) => {
        /// All built-in scenes.
        pub const SCENES: &[SceneInfo] = &[$($(
            SceneInfo {
                name: $name,
                also: &[$($also),*],
                group: SceneGroup::$Group,
                summary: $summary,
                make: || $make,
            },
        )*)*];
    };
}

scenes! {
    Paper {
        "pile", "cohesive grains on a rough base, 138 unless asked otherwise; at t = 0 the walls go (paper section 3)"
            => paper_pile();
        "cradle" | "shock", "three grains on a line, one falls on a bonded pair (paper section 4)" => Ok(cradle());
        "collision", "one grain dropped on a fixed one (paper section 2.2)" => Ok(collision());
    }
    Experiments {
        "drum", "150 grains in a rough drum that turns: they rise with it and roll down a slope"
            => Ok(experiments::drum());
        "shear", "228 grains between rough plates in a periodic cell: one is drawn along under a pressure"
            => Ok(experiments::shear());
        "shear-periodic", "224 grains without walls: the cell above slides over this one, and that over the one below"
            => Ok(experiments::shear_periodic());
        "biaxial", "300 grains in a box: the sides press with a constant force each, the lid comes down"
            => Ok(experiments::biaxial());
        "vibrated", "120 grains and a large one in a box that is shaken with 3 g" => Ok(experiments::vibrated());
        "collapse", "400 grains between two gates over a rough floor: the gates go and the column spreads"
            => Ok(experiments::collapse());
        "silo", "450 grains flow out of a silo with a flat bottom and an orifice of seven diameters"
            => Ok(experiments::silo());
        "incline", "300 grains in a box that is tilted until they flow" => Ok(experiments::incline());
    }
    Stability {
        "column" | "sag", "a column of 20 discs: does the floor carry them all?" => Ok(stability::column(20));
        "mass-ratio", "a disc 1,000 times as heavy on a light one" => Ok(stability::mass_ratio(1e3));
        "chain", "a hanging chain at 1.2 times the Bond number that breaks it"
            => Ok(stability::hanging_chain(8, 1.2 * stability::breaking_bond(8)));
        "cantilever", "two rows of cohesive grains reach out from a wall, held at Bond 100"
            => Ok(stability::cantilever(4));
        "bridge", "two rows of cohesive grains between two walls, held at Bond 100" => Ok(stability::bridge(10));
        "overlap", "two discs that overlap by a tenth at the start" => Ok(stability::overlapped(0.1));
        "squeeze", "25 discs in a box that is a hundredth too small" => Ok(stability::squeeze(1e-2));
        "moving-walls", "18 discs between two walls that move in: each has one place to be" => Ok(stability::press());
        "logs" | "size-ratio" | "friction-limit", "a disc 20 times as large on two small ones" => Ok(stability::logs(20.0));
        "leaning-column", "a column that leans, at 1.05 times the least rolling friction that holds it"
            => {
                let mut scene = stability::leaning_column(5);
                scene.parameters.rolling_friction = 1.05 * stability::ROLLING_FRICTION_OF_COLUMN;
                Ok(scene)
            };
        "arch", "an arch of three discs at 1.05 times the least friction that holds it"
            => {
                let mut scene = stability::arch();
                scene.parameters.friction = 1.05 * stability::FRICTION_OF_ARCH;
                Ok(scene)
            };
        "repose" | "rest" | "shuffle" | "size" | "sliders" | "time-step-switch",
            "a heap of 21 discs at 60 degrees, which stands still" => Ok(stability::heap(6));
        "repose-angle", "the same heap on a slope of 29 degrees: from 30 on it must slide"
            => Ok(stability::heap_on_slope(6, 29.0));
        "far", "the heap of 21 discs, a thousand million diameters away" => Ok(stability::heap_far_away(6, 1e9));
        "bounce", "a disc that bounces infinitely often in finite time" => Ok(stability::bounce(0.9));
        "newtons-cradle", "five balls in a row: the last should fly off alone" => Ok(stability::balls(5));
        "thin-wall", "a disc so fast that a step can carry it through the wall" => Ok(stability::thin_wall(1.0, 0.0));
        "lift-off", "a column under a disc 100 times as heavy" => Ok(stability::lift_off(100.0));
        "dilatancy", "a disc that slides on the floor: friction must not lift it" => Ok(stability::dilatancy());
        "blow", "a heavy disc falls on one that slides: friction has to know at once" => Ok(stability::blow());
        "hyperstatic", "150 discs in a lattice with twice the contacts that it needs, normals a little off"
            => Ok(stability::lattice(13, 12, 1e-4));
    }
}

pub(crate) fn scene_names() -> String {
    SCENES.iter().map(|scene| scene.name).collect::<Vec<_>>().join(", ")
}

/// Returns the built-in scene with this name.
///
/// ```
/// let mut scene = slump_core::scene::built_in("pile")?;
/// scene.parameters.bond = 20.0;
/// assert_eq!(scene.simulation()?.world().grains.len(), scene.grains.len());
/// assert!(slump_core::scene::built_in("plie").is_err());
/// # Ok::<(), slump_core::error::Error>(())
/// ```
///
/// # Errors
/// If no built-in scene has this name.
pub fn built_in(name: &str) -> Result<Scene> {
    let info = SceneInfo::named(name).ok_or_else(|| {
        Error::value("scene", name, format!("one of {} or a file.toml", scene_names()))
    })?;
    (info.make)()
}
