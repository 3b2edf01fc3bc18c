//! Motion of a body in a scene, and its response to the two impulses of a contact.
//!
//! The sweep works with **reduced impulses** λ = P/m_ij (m/s): the change of the contact's relative normal velocity
//! that the impulse makes. Spin is stored as s = r·ω (m/s). With these and I = ½mr² of a solid disc, an update needs no
//! radius, and of the masses only the ratio g_i = m_ij/m_i = m_j/(m_i + m_j) of i; that of j is 1 − g_i:
//!
//! > v_n = n·(v_i − v_j),  v_t = t·(v_i − v_j) − s_i − s_j,
//! > Δv_i = g_i (λ_n n + λ_t t),  Δv_j = −(1 − g_i)(λ_n n + λ_t t),
//! > Δs_i = −(r_i²/I_i) m_ij λ_t = −2 g_i λ_t,  Δs_j = −2 (1 − g_i) λ_t,
//!
//! so that λ_n changes v_n by λ_n, and λ_t changes v_t by λ_t (1 + 2) = 3 λ_t: m_n/m_t = 3, or 1 without rotation.
//! Against a fixed body g_i = 1.
//!
//! **Between borders that shear** (`world::periodic`) the image of j that is nearest to i moves with v_j + (w, 0), and
//! the laws ask for the velocity relative to that image:
//!
//! > v_n = n·(v_i − v_j) − n_x w,  v_t = t·(v_i − v_j) + n_y w − s_i − s_j.
//!
//! w is known at the beginning of the step and is stored with the normal. Every function that computes a relative
//! velocity gets it with the normal, and methods need no change. Impulses act on j itself, as in any other pair.

use std::fmt::Debug;

use glam::DVec2;

use crate::contact::{Contact, Lanes};
use crate::world::World;

/// The mechanics that a step computes: motion of bodies, friction and rotation. All of this is fixed at compile time,
/// so a leaner model has no branches for the parts that it leaves out.
///
/// Cohesion and the friction cone are not part of the model: in shifted impulses they are numbers (`contact::law`).
pub trait Model: Copy + Debug + Default + Send + Sync + 'static {
    /// A body as the sweep stores it; with several lanes, one body per lane.
    type Body<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// A contact's normal as the sweep stores it.
    type Normal<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// Number of axes.
    const AXES: usize;
    /// True if contacts carry tangential impulses.
    const FRICTION: bool;
    /// True if grains turn.
    const ROTATION: bool;
    /// True if contacts may resist rolling (`problem::rolling`).
    const ROLLING: bool = false;
    /// True if images of grains slide relative to the grains themselves.
    const SLIDES: bool = false;
    /// m_n / m_t, the same for every contact of solid discs.
    const TANGENTIAL_COMPLIANCE: f64;

    /// Degrees of freedom of a body.
    const DEGREES: usize;
    /// Inertia of each degree of freedom divided by the body's mass: with s = rω, ½Iω² = ½(m/2)s².
    const INERTIA_OVER_MASS: [f64; 3];

    /// Packs grain `index` of a world.
    fn body(world: &World, index: usize) -> Self::Body<f64>;
    /// Writes a body's velocity back to grain `index`.
    fn store(body: &Self::Body<f64>, world: &mut World, index: usize);
    /// The body after gravity has acted for `time_step_secs` at its present position.
    fn accelerated(
        body: &Self::Body<f64>,
        world: &World,
        index: usize,
        time_step_secs: f64,
    ) -> Self::Body<f64>;
    /// Packs a normal from its x and y components.
    fn normal<T: Lanes>(normal: [T; 2]) -> Self::Normal<T>;
    /// Packs the normal of a contact in a world, with the slide velocity of its image.
    #[inline(always)]
    fn normal_of(world: &World, contact: &Contact) -> Self::Normal<f64> {
        let normal = Self::normal(contact.normal.to_array());
        let (i, j) = (contact.grain as usize, contact.other as usize);
        match Self::SLIDES && j < world.grains.len() {
            true => Self::sliding(normal, world.speed_of_image(i, j)),
            false => normal,
        }
    }
    /// Adds a slide velocity, m/s along x, to the packed normal of a pair, if images slide in this model.
    #[inline(always)]
    fn sliding(normal: Self::Normal<f64>, _slide: f64) -> Self::Normal<f64> {
        normal
    }
    /// Slide velocity of the image of a packed normal, m/s along x.
    #[inline(always)]
    fn slide(_normal: Self::Normal<f64>) -> f64 {
        0.0
    }
    /// The slide velocity's contribution to the relative velocity of i and j along n and t, m/s; it is subtracted.
    #[inline(always)]
    fn slide_along(normal: Self::Normal<f64>) -> [f64; 2] {
        let [x, y] = Self::components(normal);
        let slide = Self::slide(normal);
        [x * slide, -y * slide]
    }
    /// The x and y components of a packed normal; 0 along axes that the model does not have.
    fn components<T: Lanes>(normal: Self::Normal<T>) -> [T; 2];
    /// Converts (v_n, v_t) relative to body j to (v_n, v_t) relative to the image of j that a packed normal belongs to.
    #[inline(always)]
    fn relative_to_image<T: Lanes>(_normal: Self::Normal<T>, velocity: [T; 2]) -> [T; 2] {
        velocity
    }
    /// (v_n, v_t) of body i relative to body j, m/s.
    fn relative_velocity<T: Lanes>(
        normal: Self::Normal<T>,
        i: &Self::Body<T>,
        j: &Self::Body<T>,
    ) -> [T; 2];
    /// (v_n, v_t) of body i relative to a body at rest, m/s.
    fn velocity<T: Lanes>(normal: Self::Normal<T>, i: &Self::Body<T>) -> [T; 2];
    /// Applies λ_n and λ_t (m/s) to bodies i and j; `share` is g_i.
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
    /// Velocity of a body, one entry per degree of freedom; further entries are not used.
    fn coordinates<T: Lanes>(body: &Self::Body<T>) -> [T; 3];
    /// The body with these coordinates.
    fn from_coordinates<T: Lanes>(coordinates: [T; 3]) -> Self::Body<T>;
    /// Sets the coordinates of a body; entries that are not degrees of freedom of the model stay unchanged.
    fn set(body: &mut Self::Body<f64>, coordinates: [f64; 3]);
    /// Derivatives of (v_n, v_t) by the coordinates of i, then of j: v_n = Σ \[body\]\[0\]·coordinates,
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

/// A body on the x axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineBody<T = f64> {
    /// Velocity along x, m/s.
    pub velocity: T,
}

/// One axis, without friction and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Line;

impl Model for Line {
    type Body<T: Lanes> = LineBody<T>;
    type Normal<T: Lanes> = T;
    const AXES: usize = 1;
    const FRICTION: bool = false;
    const ROTATION: bool = false;
    const TANGENTIAL_COMPLIANCE: f64 = 1.0;
    const DEGREES: usize = 1;
    const INERTIA_OVER_MASS: [f64; 3] = [1.0, 0.0, 0.0];

    #[inline(always)]
    fn coordinates<T: Lanes>(body: &LineBody<T>) -> [T; 3] {
        let none = body.velocity.same(0.0);
        [body.velocity, none, none]
    }

    #[inline(always)]
    fn from_coordinates<T: Lanes>([velocity, ..]: [T; 3]) -> LineBody<T> {
        LineBody { velocity }
    }

    #[inline(always)]
    fn set(body: &mut LineBody, [velocity, ..]: [f64; 3]) {
        body.velocity = velocity;
    }

    fn gradients(normal: f64) -> [[[f64; 3]; 2]; 2] {
        [[[normal, 0.0, 0.0], [0.0; 3]], [[-normal, 0.0, 0.0], [0.0; 3]]]
    }

    fn body(world: &World, index: usize) -> LineBody {
        LineBody { velocity: world.grains.velocities[index].x }
    }

    fn store(body: &LineBody, world: &mut World, index: usize) {
        world.grains.velocities[index].x = body.velocity;
    }

    fn accelerated(body: &LineBody, world: &World, index: usize, time_step_secs: f64) -> LineBody {
        let x = world.grains.positions[index].x;
        let change = time_step_secs * world.gravity.acceleration_on_line(x);
        LineBody { velocity: body.velocity + change }
    }

    #[inline(always)]
    fn normal<T: Lanes>([normal, _]: [T; 2]) -> T {
        normal
    }

    #[inline(always)]
    fn components<T: Lanes>(normal: T) -> [T; 2] {
        [normal, normal.same(0.0)]
    }

    #[inline(always)]
    fn relative_velocity<T: Lanes>(normal: T, i: &LineBody<T>, j: &LineBody<T>) -> [T; 2] {
        [normal * (i.velocity - j.velocity), normal.same(0.0)]
    }

    #[inline(always)]
    fn velocity<T: Lanes>(normal: T, i: &LineBody<T>) -> [T; 2] {
        [normal * i.velocity, normal.same(0.0)]
    }

    #[inline(always)]
    fn push_pair<T: Lanes>(
        i: &mut LineBody<T>,
        j: &mut LineBody<T>,
        normal: T,
        [along_normal, _]: [T; 2],
        share: T,
    ) {
        let whole = normal * along_normal;
        let part = share * whole;
        i.velocity += part;
        j.velocity -= whole - part;
    }

    #[inline(always)]
    fn push_single<T: Lanes>(i: &mut LineBody<T>, normal: T, [along_normal, _]: [T; 2]) {
        i.velocity += normal * along_normal;
    }

    fn kinetic_energy(body: &LineBody, mass: f64) -> f64 {
        0.5 * mass * body.velocity * body.velocity
    }

    fn work_of_gravity(before: &LineBody, after: &LineBody, free: &LineBody, mass: f64) -> f64 {
        0.5 * mass * (before.velocity + after.velocity) * (free.velocity - before.velocity)
    }
}

/// A body in the plane, aligned so that it never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct PlaneBody<T = f64> {
    /// Velocity, m/s.
    pub velocity: [T; 2],
    /// s = r·ω, m/s.
    pub spin: T,
}

/// Two axes, without friction and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SmoothPlane;

/// Two axes and friction, without rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plane;

/// Two axes, friction and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpinningPlane;

/// Two axes, friction, rotation, and contacts that resist rolling. Friction may be 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct RollingPlane;

/// Two axes, friction, rotation, and images that slide. Friction and rolling resistance may be 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShearedPlane;

/// A normal with the slide velocity of the image of j.
#[derive(Clone, Copy, Debug)]
pub struct SlidingNormal<T> {
    /// n, from j to i.
    pub normal: [T; 2],
    /// w, m/s along x; 0 if the pair meets inside the cell.
    pub slide: T,
}

/// Implements [`Model`] for a kind of motion in the plane; `own` contains the items that only this kind has.
macro_rules! plane_model {
    ($name:ident, $normal:ty, |$of:ident| $packed:expr, $along_axes:expr, friction: $friction:literal, rotation: $rotation:literal, own: { $($own:item)* }) => {
        impl Model for $name {
            type Body<T: Lanes> = PlaneBody<T>;
            type Normal<T: Lanes> = $normal;
            $($own)*
            const AXES: usize = 2;
            const FRICTION: bool = $friction;
            const ROTATION: bool = $rotation;
            const TANGENTIAL_COMPLIANCE: f64 = if $rotation { 3.0 } else { 1.0 };
            const DEGREES: usize = if $rotation { 3 } else { 2 };
            const INERTIA_OVER_MASS: [f64; 3] = [1.0, 1.0, 0.5];

            #[inline(always)]
            fn coordinates<T: Lanes>(body: &PlaneBody<T>) -> [T; 3] {
                [body.velocity[0], body.velocity[1], body.spin]
            }

            #[inline(always)]
            fn from_coordinates<T: Lanes>([x, y, spin]: [T; 3]) -> PlaneBody<T> {
                PlaneBody { velocity: [x, y], spin }
            }

            #[inline(always)]
            fn set(body: &mut PlaneBody, [x, y, spin]: [f64; 3]) {
                body.velocity = [x, y];
                if Self::ROTATION {
                    body.spin = spin;
                }
            }

            #[inline(always)]
            fn gradients(normal: Self::Normal<f64>) -> [[[f64; 3]; 2]; 2] {
                let [nx, ny] = Self::components(normal);
                let normal = [nx, ny, 0.0];
                let tangent = [-ny, nx, -1.0];
                [[normal, tangent], [[-nx, -ny, 0.0], [ny, -nx, -1.0]]]
            }

            fn body(world: &World, index: usize) -> PlaneBody {
                let grains = &world.grains;
                PlaneBody {
                    velocity: grains.velocities[index].to_array(),
                    spin: grains.radii[index] * grains.angular_velocities[index],
                }
            }

            fn store(body: &PlaneBody, world: &mut World, index: usize) {
                let grains = &mut world.grains;
                grains.velocities[index] = DVec2::from_array(body.velocity);
                if Self::ROTATION {
                    grains.angular_velocities[index] = body.spin / grains.radii[index];
                }
            }

            fn accelerated(
                body: &PlaneBody,
                world: &World,
                index: usize,
                time_step_secs: f64,
            ) -> PlaneBody {
                let position = world.grains.positions[index];
                let change = time_step_secs * world.gravity.acceleration(position);
                let velocity = (DVec2::from_array(body.velocity) + change).to_array();
                PlaneBody { velocity, spin: body.spin }
            }

            #[inline(always)]
            fn normal<T: Lanes>(normal: [T; 2]) -> Self::Normal<T> {
                let $of = normal;
                $packed
            }

            #[inline(always)]
            fn components<T: Lanes>(normal: Self::Normal<T>) -> [T; 2] {
                let $of = normal;
                $along_axes
            }

            #[inline(always)]
            fn relative_velocity<T: Lanes>(
                normal: Self::Normal<T>,
                i: &PlaneBody<T>,
                j: &PlaneBody<T>,
            ) -> [T; 2] {
                let [nx, ny] = Self::components(normal);
                let x = i.velocity[0] - j.velocity[0];
                let y = i.velocity[1] - j.velocity[1];
                let spin = if Self::ROTATION { i.spin + j.spin } else { nx.same(0.0) };
                Self::relative_to_image(normal, [nx * x + ny * y, nx * y - ny * x - spin])
            }

            #[inline(always)]
            fn velocity<T: Lanes>(normal: Self::Normal<T>, i: &PlaneBody<T>) -> [T; 2] {
                let [nx, ny] = Self::components(normal);
                let [x, y] = i.velocity;
                let spin = if Self::ROTATION { i.spin } else { nx.same(0.0) };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn push_pair<T: Lanes>(
                i: &mut PlaneBody<T>,
                j: &mut PlaneBody<T>,
                normal: Self::Normal<T>,
                [along_normal, along_tangent]: [T; 2],
                share: T,
            ) {
                let [nx, ny] = Self::components(normal);
                let x = nx * along_normal - ny * along_tangent;
                let y = ny * along_normal + nx * along_tangent;
                let other_share = share.same(1.0) - share;
                i.velocity[0] += share * x;
                i.velocity[1] += share * y;
                j.velocity[0] -= other_share * x;
                j.velocity[1] -= other_share * y;
                if Self::ROTATION {
                    let turn = along_tangent + along_tangent;
                    i.spin -= share * turn;
                    j.spin -= other_share * turn;
                }
            }

            #[inline(always)]
            fn push_single<T: Lanes>(
                i: &mut PlaneBody<T>,
                normal: Self::Normal<T>,
                [along_normal, along_tangent]: [T; 2],
            ) {
                let [nx, ny] = Self::components(normal);
                i.velocity[0] += nx * along_normal - ny * along_tangent;
                i.velocity[1] += ny * along_normal + nx * along_tangent;
                if Self::ROTATION {
                    i.spin -= along_tangent + along_tangent;
                }
            }

            fn kinetic_energy(body: &PlaneBody, mass: f64) -> f64 {
                let [x, y] = body.velocity;
                // ½Iω² = ¼mr²ω² = ½m·(s²/2)
                0.5 * mass * (x * x + y * y + 0.5 * body.spin * body.spin)
            }

            fn work_of_gravity(
                before: &PlaneBody,
                after: &PlaneBody,
                free: &PlaneBody,
                mass: f64,
            ) -> f64 {
                let along = |axis: usize| {
                    let change = free.velocity[axis] - before.velocity[axis];
                    0.5 * (before.velocity[axis] + after.velocity[axis]) * change
                };
                mass * (along(0) + along(1))
            }
        }
    };
}

plane_model!(SmoothPlane, [T; 2], |normal| normal, normal, friction: false, rotation: false, own: {});
plane_model!(Plane, [T; 2], |normal| normal, normal, friction: true, rotation: false, own: {});
plane_model!(SpinningPlane, [T; 2], |normal| normal, normal, friction: true, rotation: true, own: {});
plane_model!(RollingPlane, [T; 2], |normal| normal, normal, friction: true, rotation: true, own: {
    const ROLLING: bool = true;
});
plane_model!(ShearedPlane, SlidingNormal<T>, |normal| SlidingNormal { normal, slide: normal[0].same(0.0) }, normal.normal, friction: true, rotation: true, own: {
    const SLIDES: bool = true;
    const ROLLING: bool = true;

    #[inline(always)]
    fn relative_to_image<T: Lanes>(
        SlidingNormal { normal, slide }: SlidingNormal<T>,
        [along_normal, along_tangent]: [T; 2],
    ) -> [T; 2] {
        [along_normal - normal[0] * slide, along_tangent + normal[1] * slide]
    }

    #[inline(always)]
    fn sliding(normal: SlidingNormal<f64>, slide: f64) -> SlidingNormal<f64> {
        SlidingNormal { slide, ..normal }
    }

    #[inline(always)]
    fn slide(normal: SlidingNormal<f64>) -> f64 {
        normal.slide
    }
});
