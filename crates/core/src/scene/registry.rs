//! The built-in scenes by name.

use super::{Scene, collision, cradle, experiments, paper_pile, stability};
use crate::error::{Error, Result};

/// What a scene is there for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SceneGroup {
    /// The paper's scenes.
    Paper,
    /// Experiments of granular physics.
    Experiments,
    /// Scenes made to break methods.
    Stability,
}

impl SceneGroup {
    /// All groups, in the order that lists show them.
    pub const ALL: [Self; 3] = [Self::Paper, Self::Experiments, Self::Stability];

    /// Heading of the group in lists.
    pub fn title(self) -> &'static str {
        match self {
            Self::Paper => "Scenes",
            Self::Experiments => "Experiments",
            Self::Stability => "Scenes made to break methods",
        }
    }
}

/// A built-in scene.
#[derive(Clone, Copy, Debug)]
pub struct SceneInfo {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is there for.
    pub group: SceneGroup,
    /// One line.
    pub summary: &'static str,
    /// Makes it.
    pub make: fn() -> Result<Scene>,
}

/// All built-in scenes.
pub const SCENES: [SceneInfo; 31] = [
    SceneInfo {
        name: "pile",
        group: SceneGroup::Paper,
        summary: "cohesive grains on a rough base, 138 unless asked otherwise; at t = 0 the walls go (paper section 3)",
        make: paper_pile,
    },
    SceneInfo {
        name: "cradle",
        group: SceneGroup::Paper,
        summary: "three grains on a line, one falls on a bonded pair (paper section 4)",
        make: || Ok(cradle()),
    },
    SceneInfo {
        name: "collision",
        group: SceneGroup::Paper,
        summary: "one grain dropped on a fixed one (paper section 2.2)",
        make: || Ok(collision()),
    },
    SceneInfo {
        name: "drum",
        group: SceneGroup::Experiments,
        summary: "150 grains in a rough drum that turns: they rise with it and roll down a slope",
        make: || Ok(experiments::drum()),
    },
    SceneInfo {
        name: "shear",
        group: SceneGroup::Experiments,
        summary: "228 grains between rough plates in a periodic cell: one is drawn along under a pressure",
        make: || Ok(experiments::shear()),
    },
    SceneInfo {
        name: "shear-periodic",
        group: SceneGroup::Experiments,
        summary: "224 grains without walls: the cell above slides over this one, and that over the one below",
        make: || Ok(experiments::shear_periodic()),
    },
    SceneInfo {
        name: "biaxial",
        group: SceneGroup::Experiments,
        summary: "300 grains in a box: the sides press with a constant force each, the lid comes down",
        make: || Ok(experiments::biaxial()),
    },
    SceneInfo {
        name: "vibrated",
        group: SceneGroup::Experiments,
        summary: "120 grains and a large one in a box that is shaken with 3 g",
        make: || Ok(experiments::vibrated()),
    },
    SceneInfo {
        name: "collapse",
        group: SceneGroup::Experiments,
        summary: "400 grains between two gates over a rough floor: the gates go and the column spreads",
        make: || Ok(experiments::collapse()),
    },
    SceneInfo {
        name: "silo",
        group: SceneGroup::Experiments,
        summary: "450 grains flow out of a silo with a flat bottom and an orifice of seven diameters",
        make: || Ok(experiments::silo()),
    },
    SceneInfo {
        name: "incline",
        group: SceneGroup::Experiments,
        summary: "300 grains in a box that is tilted until they flow",
        make: || Ok(experiments::incline()),
    },
    SceneInfo {
        name: "column",
        group: SceneGroup::Stability,
        summary: "a column of 20 discs: does the floor carry them all?",
        make: || Ok(stability::column(20)),
    },
    SceneInfo {
        name: "mass-ratio",
        group: SceneGroup::Stability,
        summary: "a disc 1,000 times as heavy on a light one",
        make: || Ok(stability::mass_ratio(1e3)),
    },
    SceneInfo {
        name: "chain",
        group: SceneGroup::Stability,
        summary: "a hanging chain at 1.2 times the Bond number that breaks it",
        make: || Ok(stability::hanging_chain(8, 1.2 * stability::breaking_bond(8))),
    },
    SceneInfo {
        name: "cantilever",
        group: SceneGroup::Stability,
        summary: "two rows of cohesive grains reach out from a wall, held at Bond 100",
        make: || Ok(stability::cantilever(4)),
    },
    SceneInfo {
        name: "bridge",
        group: SceneGroup::Stability,
        summary: "two rows of cohesive grains between two walls, held at Bond 100",
        make: || Ok(stability::bridge(10)),
    },
    SceneInfo {
        name: "overlap",
        group: SceneGroup::Stability,
        summary: "two discs that overlap by a tenth at the start",
        make: || Ok(stability::overlapped(0.1)),
    },
    SceneInfo {
        name: "squeeze",
        group: SceneGroup::Stability,
        summary: "25 discs in a box that is a hundredth too small",
        make: || Ok(stability::squeeze(1e-2)),
    },
    SceneInfo {
        name: "moving-walls",
        group: SceneGroup::Stability,
        summary: "18 discs between two walls that move in: each has one place to be",
        make: || Ok(stability::press()),
    },
    SceneInfo {
        name: "logs",
        group: SceneGroup::Stability,
        summary: "a disc 20 times as large on two small ones",
        make: || Ok(stability::logs(20.0)),
    },
    SceneInfo {
        name: "arch",
        group: SceneGroup::Stability,
        summary: "an arch of three discs at 1.05 times the least friction that holds it",
        make: || {
            let mut scene = stability::arch();
            scene.parameters.friction = 1.05 * stability::FRICTION_OF_ARCH;
            Ok(scene)
        },
    },
    SceneInfo {
        name: "repose",
        group: SceneGroup::Stability,
        summary: "a heap of 21 discs at 60 degrees, which stands still",
        make: || Ok(stability::heap(6)),
    },
    SceneInfo {
        name: "repose-angle",
        group: SceneGroup::Stability,
        summary: "the same heap on a slope of 29 degrees: from 30 on it must slide",
        make: || Ok(stability::heap_on_slope(6, 29.0)),
    },
    SceneInfo {
        name: "far",
        group: SceneGroup::Stability,
        summary: "the heap of 21 discs, a thousand million diameters away",
        make: || Ok(stability::heap_far_away(6, 1e9)),
    },
    SceneInfo {
        name: "bounce",
        group: SceneGroup::Stability,
        summary: "a disc that bounces infinitely often in finite time",
        make: || Ok(stability::bounce(0.9)),
    },
    SceneInfo {
        name: "newtons-cradle",
        group: SceneGroup::Stability,
        summary: "five balls in a row: the last should fly off alone",
        make: || Ok(stability::balls(5)),
    },
    SceneInfo {
        name: "thin-wall",
        group: SceneGroup::Stability,
        summary: "a disc so fast that a step can carry it through the wall",
        make: || Ok(stability::thin_wall(1.0, 0.0)),
    },
    SceneInfo {
        name: "lift-off",
        group: SceneGroup::Stability,
        summary: "a column under a disc 100 times as heavy",
        make: || Ok(stability::lift_off(100.0)),
    },
    SceneInfo {
        name: "dilatancy",
        group: SceneGroup::Stability,
        summary: "a disc that slides on the floor: friction must not lift it",
        make: || Ok(stability::dilatancy()),
    },
    SceneInfo {
        name: "blow",
        group: SceneGroup::Stability,
        summary: "a heavy disc falls on one that slides: friction has to know at once",
        make: || Ok(stability::blow()),
    },
    SceneInfo {
        name: "hyperstatic",
        group: SceneGroup::Stability,
        summary: "150 discs in a lattice with twice the contacts that it needs, normals a little off",
        make: || Ok(stability::lattice(13, 12, 1e-4)),
    },
];

pub(crate) fn scene_names() -> String {
    SCENES.map(|scene| scene.name).join(", ")
}

/// A built-in scene by name.
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
/// Where there is none of that name.
pub fn built_in(name: &str) -> Result<Scene> {
    let info = SCENES.iter().find(|scene| scene.name == name).ok_or_else(|| {
        Error::value("scene", name, format!("one of {} or a file.toml", scene_names()))
    })?;
    (info.make)()
}
