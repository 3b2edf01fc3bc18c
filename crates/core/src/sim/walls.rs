//! Velocities of moving walls: boundaries and fixed discs with a motion (`world::motion`), and pistons.
//!
//! In a step each moving body has one rigid velocity: the mean velocity of its prescribed motion over the time step Δt
//! or, in the last step of this motion, the remaining travel divided by Δt. A body driven by a force begins with its
//! present speed, and the step computes its new speed (`solver::problem::walls`). Contacts use the rigid velocity at
//! the touched point, and the body moves with it when the grains move.
//!
//! **Walls that turn.** A wall turns about the pivot p with the angular velocity ω, by the angle α = ωΔt in a step. Let
//! R be this rotation. A point of the wall at the place c has the mean velocity V(c) = (R − 1)(c − p)/Δt, of which the
//! part −½ω²Δt(c − p) points inward. A step takes the normal n and the tangent t from its beginning, but the normal
//! turns with the wall. Let a disc of radius r slide along a flat wall with the speed u relative to the wall. The disc
//! has the normal velocity v_n and, at its touching point, the tangential velocity v_t. Take for c the centre of the
//! disc, as if the wall extended to it. In a step the gap grows by Δt cos α (v_n − V_n) with
//!
//! > V_n = n·V(c) − u tan α,  V_t = t·V(c) − rω.
//!
//! So a disc that sticks (v_t = V_t, angular velocity ω) moves with the wall, and its gap stays constant at any Δt. The
//! touched point of the wall would not be suitable as c: the gap of a disc that sticks would then grow by ½ω²Δt·r per
//! second. The code uses sin α instead of tan α; the two differ by about α³/2.
//!
//! Around a fixed disc with the centre q the normal turns with the grain:
//!
//! > V_n = n·V(c) − u tan ½α.
//!
//! This V_n is the velocity of q along n if the grain does not move. If the grain moves, the error is as large as at a
//! fixed disc that does not turn, because normals stay as they were at the beginning of the step. A surface speed (as
//! of a conveyor belt) also moves the grain around the disc. With the disc's radius ρ, the distance L = |c − q|, the
//! angle β = (ω + surface speed/ρ)Δt, and the sliding speed relative to q, w = u + L sin α/Δt,
//!
//! > V_n = n·V(q) − w tan ½β = n·V(c) − u tan ½β − (tan ½β − tan ½α) L sin α/Δt.
//!
//! The speed u is taken at the beginning of the step. A grain at rest relative to the wall has had the mean velocity V⁻
//! of the wall in the previous step, with (1 − R⁻¹)/Δt instead of (R − 1)/Δt, so u is relative to V⁻. Its normal
//! velocity just before the step is given by the formula for V_n with two changes: V⁻ replaces V, and the terms that
//! contain tan have the opposite sign (on a flat wall it is n·V⁻(c) + u tan α). Restitution and collisions use
//! velocities relative to this velocity.

use std::f64::consts::FRAC_PI_4;

use glam::DVec2;

use crate::contact::{Candidates, Contact, Numbering, Other};
use crate::solver::{DrivenBy, DrivenWall, Surface};
use crate::world::{Boundary, Carry, RigidVelocity, World};

/// Value in `of_boundary`, `of_disc` and `of_feature` for a body that does not belong to a moving wall.
const NONE: u32 = u32::MAX;

/// Moving walls of the present step: boundaries and fixed discs with a motion, and pistons (half-spaces that move by
/// themselves at a given speed). The vectors keep their memory between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Walls {
    moving: Vec<Wall>,
    /// Time step for which the walls' velocities are means, s. For a stepper that detects contacts in each substep, the
    /// length of a substep (part of a step).
    secs: f64,
    /// For each boundary, the index of its wall in `moving`, or [`NONE`] if the boundary does not move.
    of_boundary: Vec<u32>,
    /// For each fixed disc, the index of its wall in `moving`, or [`NONE`] if the disc does not move.
    of_disc: Vec<u32>,
    /// For each feature (part of a boundary), the index of its wall in `moving`, or [`NONE`] if the feature does not
    /// move.
    of_feature: Vec<u32>,
    /// Two flags for each feature (part of a boundary): true if it is a half-space, and true if it moves only along its
    /// normal.
    shapes: Vec<(bool, bool)>,
}

#[derive(Clone, Copy, Debug)]
struct Wall {
    mover: Mover,
    velocity: RigidVelocity,
    /// Velocity that the wall has just before the step. Restitution and collisions use the velocity of a grain relative
    /// to it.
    before: RigidVelocity,
    /// Additional speed of the surface along its tangent, m/s, as of a conveyor belt.
    surface_speed: f64,
    driver: Option<Driver>,
}

/// Data on a wall that a force drives.
#[derive(Clone, Copy, Debug)]
struct Driver {
    /// Index of this wall among all walls that a force drives.
    number: u32,
    axis: DVec2,
    /// Velocity of the wall's prescribed motion, m/s. The velocity of the wall is the sum of this velocity and its
    /// speed along the driving force.
    course: DVec2,
}

/// Source of a wall's motion.
#[derive(Clone, Copy, Debug)]
enum Mover {
    /// The boundary with this index moves without an entry in the list of motions, as a piston does.
    Boundary(usize),
    /// The motion with this index in the world's list of motions moves the wall.
    Motion(usize),
}

impl Walls {
    /// Begins a step of length `time_step_secs` (s): computes the velocities of all moving walls.
    pub(crate) fn begin(&mut self, world: &World, candidates: &Candidates, time_step_secs: f64) {
        self.moving.clear();
        self.secs = time_step_secs;
        let by_themselves = world.boundaries.iter().enumerate().filter_map(|(index, boundary)| {
            let velocity = boundary.velocity_in(time_step_secs)?;
            let mover = Mover::Boundary(index);
            Some(Wall { mover, velocity, before: velocity, surface_speed: 0.0, driver: None })
        });
        let mut number = 0;
        let by_motions = world.motions.iter().enumerate().map(|(index, motion)| {
            let mut velocity = motion.velocity_in(time_step_secs);
            let mut before = motion.velocity_before(time_step_secs);
            let driver = motion.drive.as_ref().map(|drive| {
                let driver = Driver { number, axis: drive.axis(), course: velocity.velocity };
                number += 1;
                velocity.velocity += drive.speed * driver.axis;
                before.velocity += drive.speed * driver.axis;
                driver
            });
            let surface_speed = motion.surface_speed;
            Wall { mover: Mover::Motion(index), velocity, before, surface_speed, driver }
        });
        let moves = |wall: &Wall| {
            let moves = wall.velocity.moves() || wall.before.moves();
            moves || wall.surface_speed != 0.0 || wall.driver.is_some()
        };
        self.moving.extend(by_themselves.chain(by_motions).filter(moves));
        if !self.moving.is_empty() {
            self.find_bodies(world, candidates);
        }
    }

    fn find_bodies(&mut self, world: &World, candidates: &Candidates) {
        let Self { moving, of_boundary, of_disc, of_feature, shapes, .. } = self;
        of_boundary.clear();
        of_boundary.resize(world.boundaries.len(), NONE);
        of_disc.clear();
        of_disc.resize(world.fixed_discs.len(), NONE);
        for (number, wall) in (0..).zip(&*moving) {
            match wall.mover {
                Mover::Boundary(boundary) => of_boundary[boundary] = number,
                Mover::Motion(motion) => {
                    let motion = &world.motions[motion];
                    motion.boundaries.iter().for_each(|&boundary| of_boundary[boundary] = number);
                    motion.fixed_discs.iter().for_each(|&disc| of_disc[disc] = number);
                }
            }
        }
        of_feature.clear();
        shapes.clear();
        for feature in 0..candidates.features().len() {
            let index = candidates.boundary_of(feature);
            let (number, boundary) = (of_boundary[index], &world.boundaries[index]);
            of_feature.push(number);
            let wall = moving.get(number as usize);
            let is_pushed = wall.is_some_and(|wall| wall.pushes(world, boundary));
            shapes.push((boundary.is_half_space(), is_pushed));
        }
    }

    pub(crate) fn any_move(&self) -> bool {
        !self.moving.is_empty()
    }

    /// Divides the stored time step of the walls (`secs`) by the number of substeps, for a stepper that detects
    /// contacts in each substep.
    pub(crate) fn divide(&mut self, substeps: u32) {
        self.secs /= f64::from(substeps);
    }

    /// Returns the speed of the fastest point of all moving walls, m/s. A half-space is endless; if it turns, its speed
    /// at the farthest grain counts.
    pub(crate) fn fastest(&self, world: &World, candidates: &Candidates) -> f64 {
        let turns = |number: u32| {
            self.moving.get(number as usize).map(|wall| wall.velocity).filter(|it| it.spin != 0.0)
        };
        let straight = self.moving.iter().map(|wall| wall.velocity.velocity.length());
        let fastest = straight.fold(0.0, f64::max);
        if self.moving.iter().all(|wall| wall.velocity.spin == 0.0) {
            return fastest;
        }
        let discs = self.of_disc.iter().zip(&world.fixed_discs);
        let of_discs = discs.filter_map(|(&number, disc)| {
            let velocity = turns(number)?;
            Some(velocity.at(disc.position).length() + velocity.spin.abs() * disc.radius)
        });
        let features = self.of_feature.iter().zip(candidates.features());
        let of_features = features.filter_map(|(&number, feature)| {
            let velocity = turns(number)?;
            let speed = |place: DVec2| velocity.at(place).length();
            let grains = world.grains.positions.iter().copied();
            Some(match feature.is_half_space() {
                true => grains.map(speed).fold(0.0, f64::max),
                false => feature.corners().map(speed).fold(0.0, f64::max),
            })
        });
        of_discs.chain(of_features).fold(fastest, f64::max)
    }

    /// Returns the velocities of the surface that a contact's grain touches, and the data on the force that drives it,
    /// if any; `None` if the grain does not touch a moving wall.
    #[inline]
    pub(crate) fn surface(&self, world: &World, contact: &Contact) -> Option<Surface> {
        self.surface_at(world, contact, world.grains.positions[contact.grain as usize])
    }

    /// Like [`surface`](Self::surface), for a grain with its centre at `centre`, m, instead of at its present position.
    pub(crate) fn surface_at(
        &self,
        world: &World,
        contact: &Contact,
        centre: DVec2,
    ) -> Option<Surface> {
        if self.moving.is_empty() {
            return None;
        }
        let other = Numbering::of(world).other(contact.other);
        let (number, (is_half_space, is_pushed), round_disc) = match other {
            Other::Grain(_) => return None,
            Other::FixedDisc(disc) => {
                (self.of_disc[disc], (false, false), Some(world.fixed_discs[disc].radius))
            }
            Other::Feature(feature) => (self.of_feature[feature], self.shapes[feature], None),
        };
        let wall = self.moving.get(number as usize)?;
        let spin = wall.spin_of_normal(round_disc);
        let [velocity, before] = match spin {
            0.0 if wall.before.spin == 0.0 => [wall.velocity.velocity, wall.before.velocity],
            _ => {
                let grain = contact.grain as usize;
                let (radius, velocity) =
                    (world.grains.radii[grain], world.grains.velocities[grain]);
                let touching = TouchedPlace { centre, radius, velocity, contact, round_disc };
                wall.velocities_at(&touching, spin, self.secs)
            }
        };
        let driven = wall.driver.map(|Driver { number, axis, .. }| {
            let along_tangent = if is_pushed { 0.0 } else { axis.dot(contact.normal.perp()) };
            DrivenBy { wall: number, along: [axis.dot(contact.normal), along_tangent] }
        });
        let round = wall.surface_speed;
        Some(Surface { velocity, before, round, spin, is_half_space, is_pushed, driven })
    }

    /// Returns the walls driven by a force, each with its speed at the beginning of a step of length `time_step_secs`
    /// (s), and with the speed that it would reach in the step without contacts.
    pub(crate) fn driven<'a>(
        &'a self,
        world: &'a World,
        time_step_secs: f64,
    ) -> impl Iterator<Item = DrivenWall> + 'a {
        self.moving.iter().filter_map(move |wall| {
            let Mover::Motion(motion) = wall.mover else { return None };
            let drive = world.motions[motion].drive.as_ref()?;
            let response = 1.0 / (drive.mass + time_step_secs * drive.damping);
            let push = time_step_secs * drive.force_in(world.periodic);
            let free = response * (drive.mass * drive.speed + push);
            Some(DrivenWall { motion, response, before: drive.speed, free, now: drive.speed })
        })
    }

    /// Stores the speeds V (m/s) of walls driven by a force at the end of a step Δt. Returns the work, J, of the
    /// driving forces F (N) minus the loss in the walls' damping c (kg/s): Δt (F − cV) ½(V + V⁻), with the speed V⁻ at
    /// the beginning of the step. ΔtF and cΔt are computed from the wall's mass M, its response r = 1/(M + cΔt) and its
    /// speed without contacts V_free = r(MV⁻ + ΔtF): ΔtF = V_free/r − MV⁻, and cΔt = 1/r − M
    /// (`solver::problem::walls`).
    pub(crate) fn take_driven(&mut self, world: &mut World, driven: &[DrivenWall]) -> f64 {
        let mut work = 0.0;
        for found in driven {
            let Some(drive) = &mut world.motions[found.motion].drive else { continue };
            let DrivenWall { response, before, free, now, .. } = *found;
            let pushed = free / response - drive.mass * before;
            let damped = (1.0 / response - drive.mass) * now;
            work += 0.5 * (pushed - damped) * (now + before);
            drive.speed = now;
            for wall in &mut self.moving {
                let is_it = matches!(wall.mover, Mover::Motion(motion) if motion == found.motion);
                if let (true, Some(Driver { axis, course, .. })) = (is_it, wall.driver) {
                    wall.velocity.velocity = course + now * axis;
                }
            }
        }
        work
    }

    /// Returns the velocity of the surface that a contact's grain touches, along the normal n and the tangent t, m/s;
    /// zero if the grain does not touch a moving wall.
    #[inline]
    pub(crate) fn velocity(&self, world: &World, contact: &Contact) -> [f64; 2] {
        let surface = self.surface(world, contact);
        surface.map_or([0.0; 2], |surface| surface.along(contact.normal))
    }

    /// Moves the walls with their velocities for the time `secs` (s), and advances the elapsed times of all prescribed
    /// motions.
    pub(crate) fn advance(&self, world: &mut World, candidates: &mut Candidates, secs: f64) {
        let carries: Vec<Carry> =
            self.moving.iter().map(|wall| wall.velocity.carry(secs)).collect();
        let World { boundaries, fixed_discs, motions, .. } = &mut *world;
        let of = |numbers: &[u32], at: usize| {
            let number = *numbers.get(at)?;
            carries.get(number as usize).filter(|carry| carry.goes())
        };
        for (index, boundary) in boundaries.iter_mut().enumerate() {
            if let Some(carry) = of(&self.of_boundary, index) {
                boundary.carry(carry);
            }
        }
        let mut longest = 0f64;
        for (index, disc) in fixed_discs.iter_mut().enumerate() {
            if let Some(carry) = of(&self.of_disc, index) {
                let now = carry.place(disc.position);
                longest = longest.max(now.distance(disc.position));
                disc.position = now;
            }
        }
        for (index, motion) in motions.iter_mut().enumerate() {
            let is_it = |wall: &Wall| matches!(wall.mover, Mover::Motion(moved) if moved == index);
            let wall = self.moving.iter().find(|wall| is_it(wall));
            let velocity = wall.map_or(RigidVelocity::NONE, |wall| wall.velocity);
            motion.advance(secs, &velocity.carry(secs));
        }
        candidates.follow(world, |boundary| of(&self.of_boundary, boundary), longest);
    }

    /// Returns the speed of the fastest wall in the next step, m/s, if that step has the length `secs` (s).
    pub(crate) fn fastest_in(world: &World, candidates: &Candidates, secs: f64) -> f64 {
        let mut walls = Self::default();
        walls.begin(world, candidates, secs);
        walls.fastest(world, candidates)
    }
}

/// A contact of a grain with a moving wall: position, size and velocity of the grain, and the wall's shape at the
/// contact.
struct TouchedPlace<'a> {
    centre: DVec2,
    radius: f64,
    velocity: DVec2,
    contact: &'a Contact,
    /// Radius of the fixed disc that the grain touches, m; `None` if it touches a boundary.
    round_disc: Option<f64>,
}

impl Wall {
    /// Returns the rate at which the contact normal turns for a grain at rest relative to the surface, rad/s. It is the
    /// angular velocity of the wall. At a fixed disc of radius `round_disc` (m), the surface speed divided by this
    /// radius is added.
    fn spin_of_normal(&self, round_disc: Option<f64>) -> f64 {
        match round_disc {
            Some(radius) if self.surface_speed != 0.0 => {
                self.velocity.spin + self.surface_speed / radius
            }
            _ => self.velocity.spin,
        }
    }

    /// Returns the velocities of a turning wall's surface at the contact, m/s: the mean over the step of `secs` (s),
    /// and the velocity just before the step. `spin` is the rate at which the contact normal turns, rad/s. The head of
    /// the module `sim::walls` derives the formulas.
    fn velocities_at(&self, touching: &TouchedPlace<'_>, spin: f64, secs: f64) -> [DVec2; 2] {
        let TouchedPlace { centre, radius, velocity, contact, round_disc } = *touching;
        let (normal, tangent) = (contact.normal, contact.normal.perp());
        let [now, before] = [self.velocity, self.before];
        let [there, there_before] = [now.mean_from(centre, secs), before.mean_until(centre, secs)];
        let slide = (velocity - there_before).dot(tangent);
        let sine = libm::sin(secs * now.spin);
        let turning = match round_disc {
            Some(round) => {
                let of = |spin: f64| libm::tan((0.5 * secs * spin).clamp(-FRAC_PI_4, FRAC_PI_4));
                let by_shape = sine * (radius + contact.gap + round) / secs;
                of(spin) * slide + (of(spin) - of(now.spin)) * by_shape
            }
            None => sine * slide,
        };
        let along = |velocity: DVec2, turning: f64, spin: f64| {
            let tangential = velocity.dot(tangent) - radius * spin;
            (velocity.dot(normal) + turning) * normal + tangential * tangent
        };
        [along(there, -turning, now.spin), along(there_before, turning, before.spin)]
    }

    /// True if this wall moves `boundary`, one of its boundaries, only along the boundary's normal.
    fn pushes(&self, world: &World, boundary: &Boundary) -> bool {
        self.surface_speed == 0.0
            && match self.mover {
                Mover::Boundary(_) => true,
                Mover::Motion(motion) => world.motions[motion]
                    .direction(&self.velocity)
                    .is_some_and(|direction| boundary.is_pushed_along(direction)),
            }
    }
}
