//! How a body moves in a scene, and how a contact's two impulses move it.
//!
//! The sweep works in **reduced impulses** λ = P/m_ij (m/s): the change of the contact's relative
//! normal velocity that the impulse makes. Spin is kept as s = r·ω (m/s). With these and I = ½mr² of
//! a solid disc, an update needs no radius and of the masses only i's share
//! g_i = m_ij/m_i = m_j/(m_i + m_j), with j's share 1 − g_i:
//!
//! > v_n = n·(v_i − v_j),  v_t = t·(v_i − v_j) − s_i − s_j,
//! > Δv_i = g_i (λ_n n + λ_t t),  Δv_j = −(1 − g_i)(λ_n n + λ_t t),
//! > Δs_i = −(r_i²/I_i) m_ij λ_t = −2 g_i λ_t,  Δs_j = −2 (1 − g_i) λ_t,
//!
//! so that λ_n changes v_n by λ_n, and λ_t changes v_t by λ_t (1 + 2) = 3 λ_t: m_n/m_t = 3, with
//! rotation held still 1. Against a fixed body g_i = 1.

pub(crate) mod line;
pub(crate) mod plane;
pub(crate) mod sheared;

use std::fmt::Debug;

use crate::contact::{Contact, Lanes};
use crate::world::World;

/// The ways in which the bodies of a scene can move.
pub trait Kinematics: Copy + Debug + Default + Send + Sync + 'static {
    /// A body as the sweep sees it; with several lanes, a body a lane.
    type Body<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// A contact's normal as the sweep sees it.
    type Normal<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// Number of axes.
    const AXES: usize;
    /// Whether grains turn.
    const ROTATION: bool;
    /// Whether images of grains slide beside the grains themselves.
    const SLIDES: bool = false;
    /// m_n / m_t, the same for every contact of solid discs.
    const TANGENTIAL_COMPLIANCE: f64;

    /// Degrees of freedom of a body.
    const DEGREES: usize;
    /// Inertia of each degree of freedom over the body's mass: with s = rω, ½Iω² = ½(m/2)s².
    const INERTIA_OVER_MASS: [f64; 3];

    /// Packs grain `index` of a world.
    fn body(world: &World, index: usize) -> Self::Body<f64>;
    /// Writes a body's velocity back to grain `index`.
    fn store(body: &Self::Body<f64>, world: &mut World, index: usize);
    /// The body after an acceleration during `time_step_secs` at its present place.
    fn accelerated(
        body: &Self::Body<f64>,
        world: &World,
        index: usize,
        time_step_secs: f64,
    ) -> Self::Body<f64>;
    /// Packs a normal, given along x and y.
    fn normal<T: Lanes>(normal: [T; 2]) -> Self::Normal<T>;
    /// Packs the normal of a contact as it is in a world: it tells of an image that slides.
    #[inline(always)]
    fn normal_of(world: &World, contact: &Contact) -> Self::Normal<f64> {
        let normal = Self::normal(contact.normal.to_array());
        let (i, j) = (contact.grain as usize, contact.other as usize);
        match Self::SLIDES && j < world.grains.len() {
            true => Self::sliding(normal, world.speed_of_image(i, j)),
            false => normal,
        }
    }
    /// A packed normal of a pair whose image of j goes so fast (m/s along x) beside j, where images slide.
    #[inline(always)]
    fn sliding(normal: Self::Normal<f64>, _slide: f64) -> Self::Normal<f64> {
        normal
    }
    /// How fast the image goes that a packed normal is of, m/s along x.
    #[inline(always)]
    fn slide(_normal: Self::Normal<f64>) -> f64 {
        0.0
    }
    /// The same along n and t, m/s: by so much the relative velocity is less than that of i and j themselves.
    #[inline(always)]
    fn slide_along(normal: Self::Normal<f64>) -> [f64; 2] {
        let [x, y] = Self::components(normal);
        let slide = Self::slide(normal);
        [x * slide, -y * slide]
    }
    /// A packed normal along x and y; along axes that there are not, 0.
    fn components(normal: Self::Normal<f64>) -> [f64; 2];
    /// (v_n, v_t) of body i relative to body j, m/s.
    fn relative_velocity<T: Lanes>(
        normal: Self::Normal<T>,
        i: &Self::Body<T>,
        j: &Self::Body<T>,
    ) -> [T; 2];
    /// (v_n, v_t) of body i relative to a body at rest, m/s.
    fn velocity<T: Lanes>(normal: Self::Normal<T>, i: &Self::Body<T>) -> [T; 2];
    /// Applies λ_n and λ_t (m/s) to bodies i and j, `share` being g_i.
    fn push_pair<T: Lanes>(
        i: &mut Self::Body<T>,
        j: &mut Self::Body<T>,
        normal: Self::Normal<T>,
        reduced_impulse: [T; 2],
        share: T,
    );
    /// Applies λ_n and λ_t (m/s) to body i, which touches a fixed body.
    fn push_single<T: Lanes>(
        i: &mut Self::Body<T>,
        normal: Self::Normal<T>,
        reduced_impulse: [T; 2],
    );
    /// Kinetic energy, J, of a body of `mass` (kg).
    fn kinetic_energy(body: &Self::Body<f64>, mass: f64) -> f64;
    /// A body's velocity, an entry a degree of freedom; the rest is 0.
    fn coordinates<T: Lanes>(body: &Self::Body<T>) -> [T; 3];
    /// The body of which these are the coordinates.
    fn from_coordinates<T: Lanes>(coordinates: [T; 3]) -> Self::Body<T>;
    /// Gives a body these coordinates; what is none of its degrees of freedom stays.
    fn set(body: &mut Self::Body<f64>, coordinates: [f64; 3]);
    /// How the coordinates of i, then of j, enter (v_n, v_t): v_n = Σ \[body\]\[0\]·coordinates,
    /// v_t = Σ \[body\]\[1\]·coordinates.
    fn gradients(normal: Self::Normal<f64>) -> [[[f64; 3]; 2]; 2];
    /// Work of the gravity impulse M(`free` − `before`) in a step that ends as `after`, J: the
    /// impulse times the mean velocity (see `solver::measure`).
    fn work_of_gravity(
        before: &Self::Body<f64>,
        after: &Self::Body<f64>,
        free: &Self::Body<f64>,
        mass: f64,
    ) -> f64;
}
