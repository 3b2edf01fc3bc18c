//! The scenes of Abramian & Staron (2020): the pile (§3), the collision (§2.2) and the cradle (§4).

use std::ops::RangeInclusive;

use glam::DVec2;

use crate::error::{self, Error, Result};
use crate::scene::tones::tone_in_layers;
use crate::scene::{NewPile, Scene, View};
use crate::solver::{Method, Ordering, SolverSettings, StopTest};
use crate::world::{Disc, Grain, Gravity, Parameters, Physics};

/// Mean diameter d of the pile, m.
pub(super) const DIAMETER: f64 = 5e-3;
/// Gravity g of the pile, m/s².
pub(super) const GRAVITY: f64 = 9.8;
const NAME: &str = "pile";
/// Allowed widths of a rough base (a row of fixed discs on which a pile lies), in diameters.
const BASE_WIDTHS_IN_DIAMETERS: RangeInclusive<f64> = 1.0..=1e5;
/// Width of the rough base on either side of the box, divided by the height of the pile. In the runs of one second of
/// Abramian & Staron (2020), no grain of a collapsing pile leaves this base.
const BASE_MARGIN_IN_HEIGHTS: f64 = 5.0;
/// Constant part of the largest allowed height of a grain above the base, in diameters. Two diameters per grain of the
/// pile are added to this value. The loosest initial lattice of a pile is a column with 1.3 diameters per grain, which
/// is below this limit.
const LEAST_ROOM_IN_DIAMETERS: f64 = 1000.0;

const INITIAL_STATE: &str = include_str!("../../assets/pile_138.csv");

/// Returns the scene of the pile of 138 grains of Abramian & Staron (2020), with the initial state that is shipped with
/// Slump.
///
/// # Errors
/// If the file of the initial state has been modified and is not valid. The error names the wrong line.
pub fn paper_pile() -> Result<Scene> {
    let lines = INITIAL_STATE.lines().filter(|line| !line.starts_with('#')).skip(1);
    let disc = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map_while(|number| number.parse().ok()).collect();
        let [x, y, radius] = numbers[..] else {
            return Err(Error::value("assets/pile_138.csv", line, "x,y,radius"));
        };
        Ok(Grain::at_rest(DVec2::new(x, y), radius))
    };
    let grains = lines.map(disc).collect::<Result<_>>()?;
    pile_of(grains, NewPile::default().box_width_in_diameters)
}

/// Returns the scene of a pile of the given grains, which have come to rest in a box `box_width_in_diameters` wide.
/// The box itself is not part of the scene.
///
/// # Errors
/// If a grain is higher than any grain of a pile can be. The base is widened in proportion to the height of the pile,
/// so with such a grain it would have far more discs than the pile.
pub fn pile_of(mut grains: Vec<Grain>, box_width_in_diameters: f64) -> Result<Scene> {
    let highest = DIAMETER * (LEAST_ROOM_IN_DIAMETERS + 2.0 * grains.len() as f64);
    if let Some(index) = grains.iter().position(|grain| grain.position.y > highest) {
        let found = format!("at y = {} m", grains[index].position.y);
        let allowed =
            format!("within {highest:.3} m of the base where there are {} grains", grains.len());
        return Err(Error::value(format!("grains[{index}]"), found, allowed));
    }
    let height = grains.iter().map(|grain| grain.position.y).fold(0.0, f64::max) / DIAMETER;
    let base_width = box_width_in_diameters + 2.0 * BASE_MARGIN_IN_HEIGHTS * height;
    tone_in_layers(&mut grains, DIAMETER);
    let gravity = Gravity::Uniform { acceleration: DVec2::new(0.0, -GRAVITY) };
    let parameters =
        Parameters { bond: 20.0, restitution: 0.1, friction: 0.5, ..Parameters::default() };
    let fixed_discs = rough_base(base_width, DIAMETER);
    Ok(Scene { fixed_discs, ..Scene::of(NAME, DIAMETER, gravity, parameters, grains) })
}

/// Returns a rough base: a row of fixed discs that touch each other. Their diameter is `diameter` (m), their centres
/// are on y = 0 and symmetric about x = 0, and the row is at least `width_in_diameters` diameters wide.
pub fn rough_base(width_in_diameters: f64, diameter: f64) -> Vec<Disc> {
    let half = (0.5 * width_in_diameters).ceil() as i64;
    (-half..=half)
        .map(|k| Disc { position: DVec2::new(k as f64 * diameter, 0.0), radius: 0.5 * diameter })
        .collect()
}

/// Replaces the base of a pile by a rough base of this width in diameters.
///
/// # Errors
/// If the width is outside its range, or the scene is not a pile.
pub fn put_on_base(scene: &mut Scene, width_in_diameters: f64) -> Result<()> {
    error::check(scene.name == NAME, "scene", &scene.name, "pile where base-width is given")?;
    if !BASE_WIDTHS_IN_DIAMETERS.contains(&width_in_diameters) {
        let (least, most) = BASE_WIDTHS_IN_DIAMETERS.into_inner();
        let allowed = format!("{least} to {most} diameters");
        return Err(Error::value("base-width", width_in_diameters, allowed));
    }
    scene.fixed_discs = rough_base(width_in_diameters, scene.mean_diameter);
    Ok(())
}

/// Diameter d of the discs of the collision and of the cradle, m.
const LINE_DIAMETER: f64 = 0.3;
const ON_LINE: Physics = Physics { axes: 1, friction: false, rotation: false, cohesion: true };

/// Returns the rectangle that pictures of the scene `collision` or `cradle` show. The arguments are its lower left and
/// its upper right corner, in diameters.
fn view_on_line(min: DVec2, max: DVec2) -> Option<View> {
    Some(View { min: LINE_DIAMETER * min, max: LINE_DIAMETER * max })
}

/// Returns the scene of the collision with one contact (Abramian & Staron 2020, §2.2): a disc falls on a fixed disc.
///
/// Let A be the normal force (N) for which the formal velocity v̄ = (v⁺ + ρ v⁻)/(1 + ρ) of the contact would be 0 (v⁻,
/// v⁺: normal velocity before and after the step, ρ: restitution), and C₀ the cohesion force (N). The contact has three
/// cases. For A > 0 the contact pushes with the force A, and the disc bounces. For −C₀ < A < 0 the contact pulls with
/// the force −A, and a disc that moves away comes back. For A < −C₀ the contact pulls with C₀ only, and opens. The
/// built-in scene starts in the first case and passes through the other cases as the bounces decay.
pub fn collision() -> Scene {
    let radius = 0.5 * LINE_DIAMETER;
    let gravity = Gravity::Uniform { acceleration: DVec2::new(-2.0, 0.0) };
    let parameters = Parameters {
        bond: 3.0,
        restitution: 0.5,
        restitution_threshold: 0.0,
        touch_tolerance: 0.0,
        ..Parameters::default()
    };
    let grain = Grain::at_rest(DVec2::new(2.0 * LINE_DIAMETER, 0.0), radius);
    Scene {
        duration_secs: 1.5,
        physics: ON_LINE,
        view: view_on_line(DVec2::new(-0.7, -0.7), DVec2::new(2.7, 0.7)),
        fixed_discs: vec![Disc { position: DVec2::ZERO, radius }],
        ..Scene::of("collision", LINE_DIAMETER, gravity, parameters, vec![grain])
    }
}

/// Initial distance, in diameters, between the centres of the falling disc and the disc that it hits in the scene
/// `cradle`. With this distance, the impact breaks the bond of the other two discs for the same values of the time step
/// Δt as in Abramian & Staron (2020), who do not state the distance. The value was found by a search.
const START_IN_DIAMETERS: f64 = 7.865;

/// Returns the scene of the cradle (Abramian & Staron 2020, §4): three discs on a line, with an attraction towards a
/// point.
///
/// Disc i is at the centre of attraction, and disc j touches it on the right. Disc k starts at rest on the left and
/// falls onto disc i. Whether this shock (collision) separates i and j depends on the time step. At small time steps
/// the remaining error of the solver also decides whether they separate, because in an exactly solved step the relative
/// velocity of i and j after the shock is 0.
pub fn cradle() -> Scene {
    cradle_from(START_IN_DIAMETERS)
}

/// Returns the scene of the cradle with another initial distance, `start_in_diameters` (in diameters), between the
/// centres of the falling disc and the disc that it hits.
pub fn cradle_from(start_in_diameters: f64) -> Scene {
    let disc = |x: f64, tone: u8| Grain {
        tone,
        ..Grain::at_rest(DVec2::new(x * LINE_DIAMETER, 0.0), 0.5 * LINE_DIAMETER)
    };
    let i = disc(0.0, 255);
    let j = Grain { feels_gravity: false, ..disc(1.0, 200) };
    let k = disc(-start_in_diameters, 80);
    let gravity = Gravity::Attraction { centre: DVec2::ZERO, magnitude: 2.0 };
    let parameters =
        Parameters { time_step_secs: 5e-4, restitution: 0.2, ..collision().parameters };
    Scene {
        gap_tolerance: 1e-9,
        duration_secs: 2.5,
        physics: ON_LINE,
        solver: SolverSettings {
            method: Method::Nsgs,
            ordering: Ordering::Interleaved,
            stop: StopTest::ImpulsePerMass,
            tolerance: 2.2e-3,
            max_sweeps: 20_000,
            warm_start: false,
            ..SolverSettings::SWEEPS
        },
        view: view_on_line(DVec2::new(-9.0, -1.2), DVec2::new(5.0, 1.2)),
        ..Scene::of("cradle", LINE_DIAMETER, gravity, parameters, vec![i, j, k])
    }
}
