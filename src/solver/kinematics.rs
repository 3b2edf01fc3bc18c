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

use glam::DVec2;

use super::{Problems, StepProblem};
use crate::world::World;

/// The ways in which the bodies of a scene can move.
pub trait Kinematics: Copy + Send + Sync + 'static {
    /// A body as the sweep sees it.
    type Body: Copy + Default + Send + Sync + std::fmt::Debug + 'static;
    /// A contact's normal as the sweep sees it.
    type Normal: Copy + Send + Sync + std::fmt::Debug + 'static;
    /// Number of axes.
    const AXES: usize;
    /// Whether grains turn.
    const ROTATION: bool;
    /// m_n / m_t, the same for every contact of solid discs.
    const TANGENTIAL_COMPLIANCE: f64;

    /// Degrees of freedom of a body.
    const DEGREES: usize;
    /// Inertia of each degree of freedom over the body's mass: with s = rω, ½Iω² = ½(m/2)s².
    const INERTIA_OVER_MASS: [f64; 3];

    /// Packs grain `index` of a world.
    fn body(world: &World, index: usize) -> Self::Body;
    /// Writes a body's velocity back to grain `index`.
    fn store(body: &Self::Body, world: &mut World, index: usize);
    /// The body after an acceleration during `time_step_secs` at its present place.
    fn accelerated(
        body: &Self::Body,
        world: &World,
        index: usize,
        time_step_secs: f64,
    ) -> Self::Body;
    /// Packs a normal.
    fn normal(normal: DVec2) -> Self::Normal;
    /// (v_n, v_t) of body i relative to body j, m/s.
    fn relative_velocity(normal: Self::Normal, i: &Self::Body, j: &Self::Body) -> [f64; 2];
    /// (v_n, v_t) of body i relative to a body at rest, m/s.
    fn velocity(normal: Self::Normal, i: &Self::Body) -> [f64; 2];
    /// Applies λ_n and λ_t (m/s) to bodies i and j, `share` being g_i.
    fn push_pair(
        i: &mut Self::Body,
        j: &mut Self::Body,
        normal: Self::Normal,
        reduced_impulse: [f64; 2],
        share: f64,
    );
    /// Applies λ_n and λ_t (m/s) to body i, which touches a fixed body.
    fn push_single(i: &mut Self::Body, normal: Self::Normal, reduced_impulse: [f64; 2]);
    /// Kinetic energy, J, of a body of `mass` (kg).
    fn kinetic_energy(body: &Self::Body, mass: f64) -> f64;
    /// A body's velocity, an entry a degree of freedom; the rest is 0.
    fn coordinates(body: &Self::Body) -> [f64; 3];
    /// How the coordinates of i, then of j, enter (v_n, v_t): v_n = Σ \[body\]\[0\]·coordinates,
    /// v_t = Σ \[body\]\[1\]·coordinates.
    fn gradients(normal: Self::Normal) -> [[[f64; 3]; 2]; 2];
    /// The stored problem of this kind of motion.
    fn problem(problems: &mut Problems) -> &mut StepProblem<Self>;
    /// Work of the gravity impulse M(`free` − `before`) in a step that ends as `after`, J: the
    /// impulse times the mean velocity (see `solver::measure`).
    fn work_of_gravity(
        before: &Self::Body,
        after: &Self::Body,
        free: &Self::Body,
        mass: f64,
    ) -> f64;
}

/// A body on the x axis.
#[derive(Clone, Copy, Debug, Default)]
pub struct LineBody {
    /// m/s.
    pub velocity: f64,
}

/// A body in the plane, aligned so that it never straddles two cache lines.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct PlaneBody {
    /// m/s.
    pub velocity: [f64; 2],
    /// s = r·ω, m/s.
    pub spin: f64,
}

/// One axis: no tangent, no rotation.
#[derive(Clone, Copy, Debug)]
pub struct Line;

/// Two axes, no rotation.
#[derive(Clone, Copy, Debug)]
pub struct Plane;

/// Two axes and rotation.
#[derive(Clone, Copy, Debug)]
pub struct SpinningPlane;

impl Kinematics for Line {
    type Body = LineBody;
    type Normal = f64;
    const AXES: usize = 1;
    const ROTATION: bool = false;
    const TANGENTIAL_COMPLIANCE: f64 = 1.0;
    const DEGREES: usize = 1;
    const INERTIA_OVER_MASS: [f64; 3] = [1.0, 0.0, 0.0];

    fn coordinates(body: &LineBody) -> [f64; 3] {
        [body.velocity, 0.0, 0.0]
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

    fn normal(normal: DVec2) -> f64 {
        normal.x
    }

    #[inline(always)]
    fn relative_velocity(normal: f64, i: &LineBody, j: &LineBody) -> [f64; 2] {
        [normal * (i.velocity - j.velocity), 0.0]
    }

    #[inline(always)]
    fn velocity(normal: f64, i: &LineBody) -> [f64; 2] {
        [normal * i.velocity, 0.0]
    }

    #[inline(always)]
    fn push_pair(
        i: &mut LineBody,
        j: &mut LineBody,
        normal: f64,
        [along_normal, _]: [f64; 2],
        share: f64,
    ) {
        let whole = normal * along_normal;
        let part = share * whole;
        i.velocity += part;
        j.velocity -= whole - part;
    }

    #[inline(always)]
    fn push_single(i: &mut LineBody, normal: f64, [along_normal, _]: [f64; 2]) {
        i.velocity += normal * along_normal;
    }

    fn problem(problems: &mut Problems) -> &mut StepProblem<Self> {
        &mut problems.line
    }

    fn kinetic_energy(body: &LineBody, mass: f64) -> f64 {
        0.5 * mass * body.velocity * body.velocity
    }

    fn work_of_gravity(before: &LineBody, after: &LineBody, free: &LineBody, mass: f64) -> f64 {
        0.5 * mass * (before.velocity + after.velocity) * (free.velocity - before.velocity)
    }
}

/// What both kinds of plane motion share.
macro_rules! plane_kinematics {
    ($name:ident, $problem:ident, rotation: $rotation:literal) => {
        impl Kinematics for $name {
            type Body = PlaneBody;
            type Normal = [f64; 2];
            const AXES: usize = 2;
            const ROTATION: bool = $rotation;
            const TANGENTIAL_COMPLIANCE: f64 = if $rotation { 3.0 } else { 1.0 };
            const DEGREES: usize = if $rotation { 3 } else { 2 };
            const INERTIA_OVER_MASS: [f64; 3] = [1.0, 1.0, 0.5];

            fn coordinates(body: &PlaneBody) -> [f64; 3] {
                [body.velocity[0], body.velocity[1], body.spin]
            }

            #[inline(always)]
            fn gradients([nx, ny]: [f64; 2]) -> [[[f64; 3]; 2]; 2] {
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

            fn normal(normal: DVec2) -> [f64; 2] {
                normal.to_array()
            }

            #[inline(always)]
            fn relative_velocity([nx, ny]: [f64; 2], i: &PlaneBody, j: &PlaneBody) -> [f64; 2] {
                let x = i.velocity[0] - j.velocity[0];
                let y = i.velocity[1] - j.velocity[1];
                let spin = if Self::ROTATION { i.spin + j.spin } else { 0.0 };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn velocity([nx, ny]: [f64; 2], i: &PlaneBody) -> [f64; 2] {
                let [x, y] = i.velocity;
                let spin = if Self::ROTATION { i.spin } else { 0.0 };
                [nx * x + ny * y, nx * y - ny * x - spin]
            }

            #[inline(always)]
            fn push_pair(
                i: &mut PlaneBody,
                j: &mut PlaneBody,
                [nx, ny]: [f64; 2],
                [along_normal, along_tangent]: [f64; 2],
                share: f64,
            ) {
                let x = nx * along_normal - ny * along_tangent;
                let y = ny * along_normal + nx * along_tangent;
                let other_share = 1.0 - share;
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
            fn push_single(
                i: &mut PlaneBody,
                [nx, ny]: [f64; 2],
                [along_normal, along_tangent]: [f64; 2],
            ) {
                i.velocity[0] += nx * along_normal - ny * along_tangent;
                i.velocity[1] += ny * along_normal + nx * along_tangent;
                if Self::ROTATION {
                    i.spin -= along_tangent + along_tangent;
                }
            }

            fn problem(problems: &mut Problems) -> &mut StepProblem<Self> {
                &mut problems.$problem
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

plane_kinematics!(Plane, plane, rotation: false);
plane_kinematics!(SpinningPlane, spinning_plane, rotation: true);
