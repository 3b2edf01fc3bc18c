//! Relative velocity of the two bodies of a contact, and the response of the bodies to the contact's two impulses.
//!
//! A contact of bodies i and j has the unit normal n (from j to i), the unit tangent t, and the effective mass m_ij
//! with 1/m_ij = 1/m_i + 1/m_j. Sweeps (visits of every contact by a solver) work with **reduced impulses** λ = P/m_ij
//! (m/s), impulse divided by effective mass: λ_n is the change of the contact's normal velocity due to the normal
//! impulse. Spin is stored as s = r·ω, radius times angular velocity (m/s). With these variables and I = ½mr² of a
//! solid disc, the update of a contact needs no radius, and only one ratio of masses, g_i = m_ij/m_i = m_j/(m_i + m_j)
//! (for body j it is 1 − g_i):
//!
//! > v_n = n·(v_i − v_j),  v_t = t·(v_i − v_j) − s_i − s_j,
//! > Δv_i = g_i (λ_n n + λ_t t),  Δv_j = −(1 − g_i)(λ_n n + λ_t t),
//! > Δs_i = −(r_i²/I_i) m_ij λ_t = −2 g_i λ_t,  Δs_j = −2 (1 − g_i) λ_t,
//!
//! so that λ_n changes v_n by λ_n, and λ_t changes v_t by λ_t (1 + 2) = 3 λ_t. The ratio m_n/m_t of the effective
//! masses along n and t is 3, or 1 without rotation. At a contact with a fixed body (disc or wall that is not a grain)
//! g_i = 1.
//!
//! **Periodic borders that shear** (`world::periodic`) move the copies (images) of grains beyond a border relative to
//! the grains. The image of j that is nearest to i has the velocity v_j + (w, 0). The contact laws use the velocity of
//! i relative to that image:
//!
//! > v_n = n·(v_i − v_j) − n_x w,  v_t = t·(v_i − v_j) + n_y w − s_i − s_j.
//!
//! The slide velocity w is known at the beginning of the step and is stored with the normal. Every function that
//! computes a relative velocity receives w with the normal, so solvers need no change. Impulses act on j itself, as in
//! any other pair.

use std::fmt::Debug;

use glam::DVec2;

use crate::contact::{Contact, Lanes};
use crate::world::World;

/// The variant of the mechanics that a step computes: the number of space dimensions, and whether contacts have
/// friction and rolling resistance and grains rotate. All of this is fixed at compile time, so a simpler variant has no
/// branches for the mechanics that it leaves out.
///
/// Cohesion and the friction cone are not part of the model, because they change only coefficients of the contact law
/// (`contact::law`).
pub trait Model: Copy + Debug + Default + Send + Sync + 'static {
    /// The velocity of a body in the form that the solver stores; with several SIMD lanes, the velocities of one body
    /// per lane.
    type Body<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// The unit normal of a contact in the form that the solver stores; with several SIMD lanes, one normal per lane.
    type Normal<T: Lanes>: Copy + Send + Sync + Debug + 'static;
    /// Number of space dimensions.
    const AXES: usize;
    /// True if contacts have tangential (friction) impulses.
    const FRICTION: bool;
    /// True if grains can rotate.
    const ROTATION: bool;
    /// True if contacts can have rolling resistance (`problem::rolling`).
    const ROLLING: bool = false;
    /// True if periodic borders can shear: the copies (images) of grains beyond a border then move relative to the
    /// grains.
    const SLIDES: bool = false;
    /// The ratio m_n / m_t of a contact's effective masses along normal and tangent, the same for every contact of
    /// solid discs.
    const TANGENTIAL_COMPLIANCE: f64;

    /// Number of degrees of freedom of a body.
    const DEGREES: usize;
    /// Inertia of each degree of freedom divided by the body's mass. The coordinate of rotation is radius times angular
    /// velocity, so its entry is ½ for a solid disc.
    const INERTIA_OVER_MASS: [f64; 3];

    /// Returns the velocity of grain `index` of a world (the grains and boundaries of a scene).
    fn body(world: &World, index: usize) -> Self::Body<f64>;
    /// Writes a body's velocity back to grain `index` of a world.
    fn store(body: &Self::Body<f64>, world: &mut World, index: usize);
    /// Returns the velocity that grain `index` reaches from its velocity `body` if gravity at the grain's position acts
    /// on it for `time_step_secs` (s).
    fn accelerated(
        body: &Self::Body<f64>,
        world: &World,
        index: usize,
        time_step_secs: f64,
    ) -> Self::Body<f64>;
    /// Returns a unit normal in the form that the solver stores, from its x and y components.
    fn normal<T: Lanes>(normal: [T; 2]) -> Self::Normal<T>;
    /// Returns the unit normal of a contact, together with the slide velocity of the periodic image of body j: its
    /// velocity relative to j, which is not 0 if the pair meets across a border that shears.
    #[inline(always)]
    fn normal_of(world: &World, contact: &Contact) -> Self::Normal<f64> {
        let normal = Self::normal(contact.normal.to_array());
        let (i, j) = (contact.grain as usize, contact.other as usize);
        match Self::SLIDES && j < world.grains.len() {
            true => Self::sliding(normal, world.speed_of_image(i, j)),
            false => normal,
        }
    }
    /// Adds the slide velocity of the periodic image of body j (its velocity relative to j, m/s along x) to a stored
    /// normal, if the model has borders that shear.
    #[inline(always)]
    fn sliding(normal: Self::Normal<f64>, _slide: f64) -> Self::Normal<f64> {
        normal
    }
    /// Returns the slide velocity that is stored with the normal, m/s along x: the velocity of the periodic image of
    /// body j relative to j.
    #[inline(always)]
    fn slide(_normal: Self::Normal<f64>) -> f64 {
        0.0
    }
    /// Returns the components along normal and tangent, m/s, of the slide velocity (velocity w along x of the periodic
    /// image of body j relative to j): (n_x w, −n_y w), with the components n_x and n_y of the unit normal.
    #[inline(always)]
    fn slide_along(normal: Self::Normal<f64>) -> [f64; 2] {
        let [x, y] = Self::components(normal);
        let slide = Self::slide(normal);
        [x * slide, -y * slide]
    }
    /// Returns the x and y components of a stored unit normal; 0 along axes that the model does not have.
    fn components<T: Lanes>(normal: Self::Normal<T>) -> [T; 2];
    /// Converts the normal and tangential velocity relative to body j to the velocity relative to the periodic image of
    /// j (a copy of j beyond a border), which moves relative to j with the slide velocity that is stored in `_normal`.
    #[inline(always)]
    fn relative_to_image<T: Lanes>(_normal: Self::Normal<T>, velocity: [T; 2]) -> [T; 2] {
        velocity
    }
    /// Returns the normal and tangential velocity, m/s, of body i relative to body j, or to j's periodic image.
    fn relative_velocity<T: Lanes>(
        normal: Self::Normal<T>,
        i: &Self::Body<T>,
        j: &Self::Body<T>,
    ) -> [T; 2];
    /// Returns the normal and tangential velocity of body i relative to a body at rest at their contact, m/s.
    fn velocity<T: Lanes>(normal: Self::Normal<T>, i: &Self::Body<T>) -> [T; 2];
    /// Applies the normal and tangential impulses of a contact, divided by its effective mass (m/s), to bodies i and j.
    /// `share` is the mass of body j divided by the sum of both masses.
    fn push_pair<T: Lanes>(
        i: &mut Self::Body<T>,
        j: &mut Self::Body<T>,
        normal: Self::Normal<T>,
        reduced_impulse: [T; 2],
        share: T,
    );
    /// Applies the normal and tangential impulses of a contact, divided by its effective mass (m/s), to body i. The
    /// other body of the contact is fixed.
    fn push_single<T: Lanes>(
        i: &mut Self::Body<T>,
        normal: Self::Normal<T>,
        reduced_impulse: [T; 2],
    );
    /// Returns the kinetic energy, J, of a body of `mass` (kg).
    fn kinetic_energy(body: &Self::Body<f64>, mass: f64) -> f64;
    /// Returns the velocity of a body as numbers, m/s, one per degree of freedom (a rotation as radius times angular
    /// velocity); further entries are not used.
    fn coordinates<T: Lanes>(body: &Self::Body<T>) -> [T; 3];
    /// Returns a velocity in the form that the solver stores, from one number (m/s) per degree of freedom.
    fn from_coordinates<T: Lanes>(coordinates: [T; 3]) -> Self::Body<T>;
    /// Sets the velocity of a body from its coordinates, m/s, one per degree of freedom of the model. Further entries
    /// of `coordinates` are ignored.
    fn set(body: &mut Self::Body<f64>, coordinates: [f64; 3]);
    /// Returns the derivatives `[body][direction]` of a contact's velocity (direction 0: normal, 1: tangential) by the
    /// velocity coordinates of its bodies (0: i, 1: j). The sum of all derivatives times coordinates is the velocity.
    fn gradients(normal: Self::Normal<f64>) -> [[[f64; 3]; 2]; 2];
    /// Returns the work of gravity on a body in a step, J: the impulse of gravity, `mass` × (`free` − `before`), times
    /// ½ (`before` + `after`) (see `solver::measure`). `before` and `after` are the velocities before and after the
    /// step, `free` is the velocity after it without contacts.
    fn work_of_gravity(
        before: &Self::Body<f64>,
        after: &Self::Body<f64>,
        free: &Self::Body<f64>,
        mass: f64,
    ) -> f64;
}

/// The velocity of a body on the x axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineBody<T = f64> {
    /// Velocity along x, m/s.
    pub velocity: T,
}

/// Model with one axis, without friction and rotation.
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

/// The velocity of a body in the plane, aligned so that it never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct PlaneBody<T = f64> {
    /// Velocity of the body's centre along x and y, m/s.
    pub velocity: [T; 2],
    /// Spin s = r·ω, radius times angular velocity, m/s.
    pub spin: T,
}

/// Model with two axes, without friction and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SmoothPlane;

/// Model with two axes and friction, without rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct Plane;

/// Model with two axes, friction and rotation.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpinningPlane;

/// Model with two axes, friction, rotation, and contacts that resist rolling. The friction coefficient may be 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct RollingPlane;

/// Model with two axes, friction, rotation, and periodic borders that shear, so that the copies (images) of grains
/// beyond a border move relative to the grains. Friction and rolling resistance may be 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShearedPlane;

/// The unit normal of a contact, with the velocity of the periodic image of body j relative to j.
#[derive(Clone, Copy, Debug)]
pub struct SlidingNormal<T> {
    /// Unit normal n, from body j to body i.
    pub normal: [T; 2],
    /// Slide velocity w, m/s along x: the velocity of the periodic image of body j relative to j; 0 if the pair meets
    /// inside the periodic cell.
    pub slide: T,
}

/// Implements [`Model`] for a variant of the mechanics in the plane. `own` contains the items that only this model has.
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
                // Energy of rotation with the spin s = rω: ½Iω² = ¼mr²ω² = ½m·(s²/2).
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
