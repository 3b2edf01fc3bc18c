//! Motion in the plane with rotation, between borders that shear (`world::periodic`).
//!
//! The image of j that is nearest to i goes with v_j + (w, 0), and what the laws ask for is the velocity relative to
//! that image:
//!
//! > v_n = n·(v_i − v_j) − n_x w,  v_t = t·(v_i − v_j) + n_y w − s_i − s_j.
//!
//! w is known when the step begins, and goes with the normal, so that whoever asks for a relative velocity has it in
//! that, and no method has to know. Impulses act as on any other pair, on j where it is.

use super::Kinematics;
use super::plane::{PlaneBody, SpinningPlane};
use crate::contact::Lanes;
use crate::world::World;

/// Two axes and rotation, and images that slide.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShearedPlane;

/// A normal, and how fast the image of j slides that it is of.
#[derive(Clone, Copy, Debug)]
pub struct SlidingNormal<T> {
    /// n, from j to i.
    pub normal: [T; 2],
    /// w, m/s along x; 0 where the pair meets inside the cell.
    pub slide: T,
}

/// What a plane without such borders does as well.
type Upright = SpinningPlane;

impl Kinematics for ShearedPlane {
    type Body<T: Lanes> = PlaneBody<T>;
    type Normal<T: Lanes> = SlidingNormal<T>;
    const AXES: usize = Upright::AXES;
    const ROTATION: bool = Upright::ROTATION;
    const SLIDES: bool = true;
    const TANGENTIAL_COMPLIANCE: f64 = Upright::TANGENTIAL_COMPLIANCE;
    const DEGREES: usize = Upright::DEGREES;
    const INERTIA_OVER_MASS: [f64; 3] = Upright::INERTIA_OVER_MASS;

    fn body(world: &World, index: usize) -> PlaneBody {
        Upright::body(world, index)
    }

    fn store(body: &PlaneBody, world: &mut World, index: usize) {
        Upright::store(body, world, index);
    }

    fn accelerated(
        body: &PlaneBody,
        world: &World,
        index: usize,
        time_step_secs: f64,
    ) -> PlaneBody {
        Upright::accelerated(body, world, index, time_step_secs)
    }

    #[inline(always)]
    fn normal<T: Lanes>(normal: [T; 2]) -> SlidingNormal<T> {
        SlidingNormal { normal, slide: normal[0].same(0.0) }
    }

    #[inline(always)]
    fn sliding(normal: SlidingNormal<f64>, slide: f64) -> SlidingNormal<f64> {
        SlidingNormal { slide, ..normal }
    }

    #[inline(always)]
    fn slide(normal: SlidingNormal<f64>) -> f64 {
        normal.slide
    }

    fn components(normal: SlidingNormal<f64>) -> [f64; 2] {
        normal.normal
    }

    #[inline(always)]
    fn relative_velocity<T: Lanes>(
        SlidingNormal { normal, slide }: SlidingNormal<T>,
        i: &PlaneBody<T>,
        j: &PlaneBody<T>,
    ) -> [T; 2] {
        let [along_normal, along_tangent] = Upright::relative_velocity(normal, i, j);
        [along_normal - normal[0] * slide, along_tangent + normal[1] * slide]
    }

    #[inline(always)]
    fn velocity<T: Lanes>(normal: SlidingNormal<T>, i: &PlaneBody<T>) -> [T; 2] {
        Upright::velocity(normal.normal, i)
    }

    #[inline(always)]
    fn push_pair<T: Lanes>(
        i: &mut PlaneBody<T>,
        j: &mut PlaneBody<T>,
        normal: SlidingNormal<T>,
        reduced_impulse: [T; 2],
        share: T,
    ) {
        Upright::push_pair(i, j, normal.normal, reduced_impulse, share);
    }

    #[inline(always)]
    fn push_single<T: Lanes>(
        i: &mut PlaneBody<T>,
        normal: SlidingNormal<T>,
        reduced_impulse: [T; 2],
    ) {
        Upright::push_single(i, normal.normal, reduced_impulse);
    }

    fn kinetic_energy(body: &PlaneBody, mass: f64) -> f64 {
        Upright::kinetic_energy(body, mass)
    }

    #[inline(always)]
    fn coordinates<T: Lanes>(body: &PlaneBody<T>) -> [T; 3] {
        Upright::coordinates(body)
    }

    #[inline(always)]
    fn from_coordinates<T: Lanes>(coordinates: [T; 3]) -> PlaneBody<T> {
        Upright::from_coordinates(coordinates)
    }

    #[inline(always)]
    fn set(body: &mut PlaneBody, coordinates: [f64; 3]) {
        Upright::set(body, coordinates);
    }

    #[inline(always)]
    fn gradients(normal: SlidingNormal<f64>) -> [[[f64; 3]; 2]; 2] {
        Upright::gradients(normal.normal)
    }

    fn work_of_gravity(before: &PlaneBody, after: &PlaneBody, free: &PlaneBody, mass: f64) -> f64 {
        Upright::work_of_gravity(before, after, free, mass)
    }
}
