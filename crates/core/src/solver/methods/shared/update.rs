//! The update of one contact in a Gauss–Seidel sweep, or of several that share no grain.
//!
//! In reduced impulses (`contact::law`, `problem::kinematics`):
//!
//! > σ ← max(σ − (v_n + ρ v_n^{n−1}), 0),  λ_t ← clamp(λ_t − v_t · m_t/m_n, ±bound(σ)).
//!
//! The normal impulse does not change v_t, so both velocities are read once.

use crate::contact::{Lanes, law};
use crate::solver::problem::{Kinematics, Model, Row, StepProblem};

/// A body of a model; with several lanes, a body a lane.
pub(crate) type Body<M, T> = <<M as Model>::Kinematics as Kinematics>::Body<T>;

/// What an update needs of a row beside its impulses; with several lanes, of a row a lane. Units as
/// in [`Row`].
#[derive(Clone, Copy)]
pub(crate) struct Local<K: Kinematics, T: Lanes> {
    pub normal: K::Normal<T>,
    pub of_other: T,
    pub restitution_velocity: T,
    pub effective_mass: T,
}

impl<K: Kinematics, T: Lanes> Local<K, T> {
    /// (v_n, v_t) of grains i against fixed bodies, as [`Row::velocity`] has it, m/s.
    #[inline(always)]
    pub(crate) fn velocity(&self, i: &K::Body<T>) -> [T; 2] {
        let [normal, tangential] = K::velocity(self.normal, i);
        [normal, tangential - self.of_other]
    }
}

/// A row's [`Local`], and its (σ, λ_t).
#[inline(always)]
fn parts<K: Kinematics>(row: &mut Row<K>) -> (Local<K, f64>, [&mut f64; 2]) {
    let Row { normal, of_other, restitution_velocity, effective_mass, .. } = *row;
    let local = Local { normal, of_other, restitution_velocity, effective_mass };
    (local, [&mut row.shifted_impulse, &mut row.tangential_impulse])
}

/// The numbers of the contact law that all rows share.
pub(crate) struct Law {
    friction: f64,
    capture_speed: f64,
}

impl Law {
    /// Those of a problem.
    pub(crate) fn of<K: Kinematics>(problem: &StepProblem<K>) -> Self {
        Self { friction: problem.friction, capture_speed: problem.capture_speed }
    }

    /// The largest |λ_t| that a shifted normal impulse allows, m/s.
    pub(crate) fn friction_bound<M: Model>(&self, shifted_impulse: f64) -> f64 {
        M::friction_bound(self.friction, shifted_impulse, self.capture_speed)
    }

    /// Solves the contact of a row: of grain i with a fixed body.
    #[inline(always)]
    pub(crate) fn solve_single_row<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        i: &mut Body<M, f64>,
        change: &mut Change,
    ) {
        let (local, impulse) = parts(row);
        self.solve_single::<M, f64, MEASURE>((&local, impulse), i, change);
    }

    /// Solves the contact of a row: between grains i and j.
    #[inline(always)]
    pub(crate) fn solve_pair_row<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        i: &mut Body<M, f64>,
        j: &mut Body<M, f64>,
        change: &mut Change,
    ) {
        let (local, impulse) = parts(row);
        self.solve_pair::<M, f64, MEASURE>((&local, impulse), i, j, change);
    }

    /// Solves the contact of a row: between two of the bodies.
    #[inline(always)]
    pub(crate) fn solve_pair_among<M: Model, const MEASURE: bool>(
        &self,
        row: &mut Row<M::Kinematics>,
        bodies: &mut [Body<M, f64>],
        change: &mut Change,
    ) {
        let (mut i, mut j) = (bodies[row.i as usize], bodies[row.j as usize]);
        self.solve_pair_row::<M, MEASURE>(row, &mut i, &mut j, change);
        bodies[row.i as usize] = i;
        bodies[row.j as usize] = j;
    }

    /// Solves contacts of grains i with fixed bodies.
    #[inline(always)]
    pub(crate) fn solve_single<M: Model, T: Lanes, const MEASURE: bool>(
        &self,
        (local, impulse): (&Local<M::Kinematics, T>, [&mut T; 2]),
        i: &mut Body<M, T>,
        change: &mut Change<T>,
    ) {
        let velocity = local.velocity(i);
        let impulse = self.update::<M, T>((local, impulse), velocity);
        M::Kinematics::push_single(i, local.normal, impulse);
        change.add::<M, MEASURE>(local.effective_mass, impulse);
    }

    /// Solves contacts between grains i and j.
    #[inline(always)]
    pub(crate) fn solve_pair<M: Model, T: Lanes, const MEASURE: bool>(
        &self,
        (local, impulse): (&Local<M::Kinematics, T>, [&mut T; 2]),
        i: &mut Body<M, T>,
        j: &mut Body<M, T>,
        change: &mut Change<T>,
    ) {
        let velocity = M::Kinematics::relative_velocity(local.normal, i, j);
        let impulse = self.update::<M, T>((local, impulse), velocity);
        M::Kinematics::push_pair(i, j, local.normal, impulse, local.of_other);
        change.add::<M, MEASURE>(local.effective_mass, impulse);
    }

    /// Solves at the given (v_n, v_t) and returns the change of (λ_n, λ_t).
    #[inline(always)]
    fn update<M: Model, T: Lanes>(
        &self,
        (local, [shifted, tangential]): (&Local<M::Kinematics, T>, [&mut T; 2]),
        [normal_velocity, tangential_velocity]: [T; 2],
    ) -> [T; 2] {
        let normal_before = *shifted;
        let closing = normal_velocity + local.restitution_velocity;
        *shifted = law::signorini(normal_before - closing);
        let normal_change = *shifted - normal_before;
        if !M::FRICTION {
            return [normal_change, normal_change.same(0.0)];
        }
        let bound = M::friction_bound(self.friction, *shifted, self.capture_speed);
        let tangential_before = *tangential;
        let compliance = tangential.same(1.0 / M::Kinematics::TANGENTIAL_COMPLIANCE);
        *tangential = law::coulomb(tangential_before - compliance * tangential_velocity, bound);
        [normal_change, *tangential - tangential_before]
    }
}

/// P² of an impulse (λ_n, λ_t) of an effective mass, (N·s)².
#[inline(always)]
pub(crate) fn squared_impulse(mass: f64, [normal, tangential]: [f64; 2]) -> f64 {
    mass * mass * (normal * normal + tangential * tangential)
}

/// How much a sweep changed the impulses; zero where it was not asked to measure. With several
/// lanes, how much those of each lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change<T = f64> {
    /// Σ ΔP², (N·s)².
    pub squared: T,
    /// Σ |ΔP|, N·s.
    pub absolute: T,
}

impl Change {
    /// Adds the change of other contacts.
    pub(crate) fn add_all(&mut self, other: Self) {
        self.squared += other.squared;
        self.absolute += other.absolute;
    }
}

impl<T: Lanes> Change<T> {
    /// Counts a change of (λ_n, λ_t) of an effective mass, where it is asked to measure.
    #[inline(always)]
    pub(crate) fn add<M: Model, const MEASURE: bool>(
        &mut self,
        mass: T,
        [normal, tangential]: [T; 2],
    ) {
        if MEASURE {
            let normal = mass * normal;
            self.squared += normal * normal;
            self.absolute += normal.magnitude();
            if M::FRICTION {
                let tangential = mass * tangential;
                self.squared += tangential * tangential;
                self.absolute += tangential.magnitude();
            }
        }
    }
}
