//! Bodies that move by themselves (`world::motion`, and pistons).
//!
//! In a step each has one rigid velocity: the mean of its course over Δt, or in its last step what is left of its
//! way over Δt. One that a force drives begins with the speed that it has, and its step says with which it goes on
//! (`solver::problem::walls`). The contacts see it where they touch, and with the grains the body is
//! carried by it.

use glam::DVec2;

use crate::contact::{Candidates, Contact, Numbering, Other};
use crate::solver::{DrivenBy, DrivenWall, Surface};
use crate::world::{Boundary, Carry, RigidVelocity, World};

/// No wall.
const NONE: u32 = u32::MAX;

/// What moves in the present step. Memory is kept between steps.
#[derive(Clone, Debug, Default)]
pub(crate) struct Walls {
    moving: Vec<Wall>,
    /// The wall of each boundary, of each fixed disc, and of each feature, or [`NONE`].
    of_boundary: Vec<u32>,
    of_disc: Vec<u32>,
    of_feature: Vec<u32>,
    /// Whether each feature is a half-space, and whether it goes along its normal and no other way.
    shapes: Vec<(bool, bool)>,
}

#[derive(Clone, Copy, Debug)]
struct Wall {
    mover: Mover,
    velocity: RigidVelocity,
    /// Along the tangent besides, m/s.
    surface_speed: f64,
    driver: Option<Driver>,
}

/// What a force drives of a wall.
#[derive(Clone, Copy, Debug)]
struct Driver {
    /// Its number among all of them.
    number: u32,
    axis: DVec2,
    /// The velocity that the wall has besides, m/s.
    course: DVec2,
}

/// What says how a wall goes.
#[derive(Clone, Copy, Debug)]
enum Mover {
    /// The boundary of that number itself.
    Boundary(usize),
    /// The motion of that number.
    Motion(usize),
}

impl Walls {
    /// Begins a step of that length.
    pub(crate) fn begin(&mut self, world: &World, candidates: &Candidates, time_step_secs: f64) {
        self.moving.clear();
        let by_themselves = world.boundaries.iter().enumerate().filter_map(|(index, boundary)| {
            let velocity = boundary.velocity_in(time_step_secs)?;
            let mover = Mover::Boundary(index);
            Some(Wall { mover, velocity, surface_speed: 0.0, driver: None })
        });
        let mut number = 0;
        let by_motions = world.motions.iter().enumerate().map(|(index, motion)| {
            let mut velocity = motion.velocity_in(time_step_secs);
            let driver = motion.drive.as_ref().map(|drive| {
                let driver = Driver { number, axis: drive.axis(), course: velocity.velocity };
                number += 1;
                velocity.velocity += drive.speed * driver.axis;
                driver
            });
            let surface_speed = motion.surface_speed;
            Wall { mover: Mover::Motion(index), velocity, surface_speed, driver }
        });
        let moves = |wall: &Wall| {
            wall.velocity.moves() || wall.surface_speed != 0.0 || wall.driver.is_some()
        };
        self.moving.extend(by_themselves.chain(by_motions).filter(moves));
        if !self.moving.is_empty() {
            self.find_bodies(world, candidates);
        }
    }

    fn find_bodies(&mut self, world: &World, candidates: &Candidates) {
        let Self { moving, of_boundary, of_disc, of_feature, shapes } = self;
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

    /// Speed of the fastest shape, m/s. Of a half-space that turns, that which it has at the farthest grain.
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

    /// How the surface of the other body of a contact goes, if that moves.
    #[inline]
    pub(crate) fn surface(&self, world: &World, contact: &Contact) -> Option<Surface> {
        self.surface_at(world, contact, world.grains.positions[contact.grain as usize])
    }

    /// The same of a contact whose grain was elsewhere, m.
    pub(crate) fn surface_at(
        &self,
        world: &World,
        contact: &Contact,
        centre: DVec2,
    ) -> Option<Surface> {
        if self.moving.is_empty() {
            return None;
        }
        let (number, (is_half_space, is_pushed)) = match Numbering::of(world).other(contact.other) {
            Other::Grain(_) => return None,
            Other::FixedDisc(disc) => (self.of_disc[disc], (false, false)),
            Other::Feature(feature) => (self.of_feature[feature], self.shapes[feature]),
        };
        let wall = self.moving.get(number as usize)?;
        let radius = world.grains.radii[contact.grain as usize];
        let place = centre - (radius + contact.gap) * contact.normal;
        let velocity = wall.velocity.at(place);
        let driven = wall.driver.map(|Driver { number, axis, .. }| {
            let along_tangent = if is_pushed { 0.0 } else { axis.dot(contact.normal.perp()) };
            DrivenBy { wall: number, along: [axis.dot(contact.normal), along_tangent] }
        });
        Some(Surface { velocity, round: wall.surface_speed, is_half_space, is_pushed, driven })
    }

    /// The walls that a force drives, as they begin a step of that length.
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

    /// Has the walls that a force drives go on as a step has found. Gives the work of the forces and of the damping, J:
    /// Δt (F − cV) ½(V + V⁻), in which ΔtF = V_free/r − MV⁻ and cΔt = 1/r − M (`solver::problem::walls`).
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

    /// How fast the surface of the other body of a contact goes along n and t, m/s.
    #[inline]
    pub(crate) fn velocity(&self, world: &World, contact: &Contact) -> [f64; 2] {
        let surface = self.surface(world, contact);
        surface.map_or([0.0; 2], |surface| surface.along(contact.normal))
    }

    /// Moves the walls for `secs`, and all clocks on.
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

    /// Speed of the fastest wall in a next step of that length, m/s.
    pub(crate) fn fastest_in(world: &World, candidates: &Candidates, secs: f64) -> f64 {
        let mut walls = Self::default();
        walls.begin(world, candidates, secs);
        walls.fastest(world, candidates)
    }
}

impl Wall {
    /// True where it moves a boundary along its normal and no other way.
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
