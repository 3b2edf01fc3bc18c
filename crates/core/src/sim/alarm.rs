//! Alarms (warnings) of a run: the kind of failure, the first step that showed it, and the change most likely to help.
//! [`Watch`] raises alarms, and `advice` chooses the changes.

use serde::{Deserialize, Serialize};

use crate::contact::{Numbering, Other};
use crate::error::legible;
use crate::number::{millis_text, rounded_down};
use crate::setting::words;
use crate::sim::advice::{self, Advice};
use crate::sim::losses::{Losses, NewLosses};
use crate::sim::state::State;
use crate::sim::{Observables, Settings};

/// Number of consecutive unsolved steps (steps that miss the solver's tolerance) that raises an alarm. With a smaller
/// number, a few steps that are hard to solve, and do no harm, would raise the alarm.
const STEPS_AT_LIMIT: u32 = 100;
/// Overlap that raises an alarm, in diameters of the smaller disc. The distance that the two grains travel in one step
/// is subtracted from the overlap first. With a smaller value, errors within a solver's tolerance would raise the
/// alarm. With a larger value, the alarm comes later if discs sink into each other because steps are not solved.
const LARGEST_OVERLAP: f64 = 0.05;
/// Upper limit for the distance that is subtracted from an overlap before the overlap can raise an alarm, in diameters
/// of the smaller disc. The subtracted distance is the distance that the two grains travel in one step: a contact is
/// detected up to one step late, so in a falling pile contacts overlap by up to this distance (measured: 0.43 to 0.56
/// mean diameters in simulations of 138 grains without cohesion, Δt = 5 ms, six initial states). With a larger value,
/// grains pass through each other without an alarm.
const LARGEST_TRAVEL: f64 = 0.75;
/// Growth of the overlap that raises an alarm if grains were placed in overlap, in diameters of the smaller disc. With
/// a smaller value, errors that a solver's tolerance allows would raise the alarm.
const GROWTH_OF_OVERLAP: f64 = 0.01;
/// Energy that contacts may create without an alarm, divided by the largest kinetic energy of the run. With a smaller
/// value, errors within a solver's tolerance would raise the alarm.
const ENERGY_OF_MOTION: f64 = 0.01;
/// Additional energy that contacts may create without an alarm, as the height to which it would lift all grains, in
/// mean diameters. With a smaller value, a stepper that pushes overlap out, and so lifts grains, would raise the alarm.
const ENERGY_OF_HEIGHT: f64 = 0.1;

words! {
    /// Kind of failure that an alarm reports.
    pub enum AlarmKind {
        NotFinite = "not-finite", "the state is no longer finite";
        GrainLost = "grain-lost", "a grain has gone through a wall";
        GrainLeft = "grain-left", "a grain has left the world";
        SweepLimit = "sweep-limit", "100 steps in a row were not solved to their tolerance";
        Overlap = "overlap", "a contact overlaps by more than one step's travel and 5 % of a diameter, or by more than 80 %";
        PlacedInOverlap = "placed-in-overlap",
            "a grain was placed on a grain or a wall, with an overlap of more than 5 % of a diameter";
        EnergyCreated = "energy-created", "contacts have created energy";
        NoCohesion = "no-cohesion", "Bond is above 0, but no contact pulls";
        BreakUnseen = "break-unseen", "bonds break faster than the substeps of a step can follow";
        TurnedBonds = "turned-bonds", "bonds that could bear the pull on them ended because their pairs turned";
    }
}

/// Warning of a failure in a run: the kind of failure, its first step, and advice.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Alarm {
    /// Kind of failure.
    pub kind: AlarmKind,
    /// First step that showed the failure.
    pub step: u64,
    /// Simulated time at the end of the first step that showed the failure, s.
    pub time_secs: f64,
    /// Advice: the change of the settings or the scene that is most likely to help.
    pub advice: Advice,
    /// Longest time step that would avoid the failure, s; `None` if it is unknown or a shorter step would not help.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub longest_time_step_secs: Option<f64>,
    /// Present stiffness of the springs, N/m, if a larger stiffness would help; otherwise `None`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stiffness: Option<f64>,
    /// Number of occurrences of the failure so far; `None` for kinds of failure that are not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u64>,
}

impl Alarm {
    fn new(kind: AlarmKind, observables: &Observables, advice: Advice) -> Self {
        let &Observables { step, time_secs, .. } = observables;
        let (longest_time_step_secs, stiffness, count) = (None, None, None);
        Self { kind, step, time_secs, advice, longest_time_step_secs, stiffness, count }
    }

    /// Returns one sentence that names the failure, its first step, and the change most likely to help. Times are in
    /// seconds.
    pub fn message(&self, settings: &Settings) -> String {
        self.sentence(&format!("{:.4} s", self.time_secs), &self.advice_in_words(settings))
    }

    /// Returns the sentence of [`Self::message`] with times in milliseconds, for the window.
    pub fn message_in_millis(&self, settings: &Settings) -> String {
        let time_step_secs = settings.parameters.time_step_secs;
        let advice = match (self.advice, self.longest_time_step_secs) {
            (Advice::TimeStep, None) => {
                format!("try a time step below {}", millis_text(time_step_secs))
            }
            (Advice::TimeStep, Some(secs)) => {
                format!("try a time step of at most {}", millis_text(rounded_down(secs)))
            }
            _ => self.advice_in_words(settings),
        };
        self.sentence(&millis_text(self.time_secs), &advice)
    }

    fn sentence(&self, time: &str, advice: &str) -> String {
        let Self { kind, step, count, .. } = self;
        let so_far = count.map_or_else(String::new, |count| format!("{count} so far, first in "));
        let hint = kind.hint();
        legible(&format!("{hint} ({so_far}step {step}, t = {time}): {advice}"))
    }

    fn advice_in_words(&self, settings: &Settings) -> String {
        let Settings { parameters, solver, .. } = settings;
        match (self.advice, self.longest_time_step_secs, self.stiffness) {
            (Advice::TimeStep, None, _) => {
                format!("try a time step below {} s", parameters.time_step_secs)
            }
            (Advice::TimeStep, Some(secs), _) => {
                format!("try a time step of at most {:e} s", rounded_down(secs))
            }
            (Advice::Stiffness, _, Some(stiffness)) => {
                format!("try a stiffness above {stiffness:.2e} N/m")
            }
            (Advice::Sweeps, ..) => format!("try more than {} sweeps", solver.max_sweeps),
            (Advice::Tolerance, ..) => format!("try a tolerance above {:e}", solver.tolerance),
            (advice, ..) => advice.hint().to_owned(),
        }
    }
}

/// Data with which a running simulation is checked for failures. A file of the simulation contains them, so that a run
/// that continues from the file raises the same alarms.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Watch {
    unfinished_in_a_row: u32,
    /// Alarms raised so far, at most one of each kind.
    pub alarms: Vec<Alarm>,
    pub losses: Losses,
    /// True if grains were placed (at the start, or moved by the user) and no step has been taken since.
    are_placed: bool,
    /// Smallest value that the overlap of the deepest contact ([`DeepestContact`]) has had since grains were last
    /// placed, in diameters of the smaller disc. If it is above [`LARGEST_OVERLAP`], grains were placed in overlap and
    /// have been deep in each other ever since. Then only a growth of the overlap above this value raises an alarm.
    placed_overlap: f64,
    /// Longest distance that each grain has moved in a single step so far, m.
    travels: Vec<f64>,
    /// Number of bonds that have ended since the start because their two grains circled each other, which opened the
    /// gap.
    turned_bonds: u64,
    energy: ContactEnergy,
}

/// Energy created and dissipated by contacts, to detect contacts that create energy.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ContactEnergy {
    /// Work of all contacts since the start, J, except the work of moving walls and of bonds.
    work: f64,
    /// Smallest value of `work` so far, J. Contacts that only dissipate energy make `work` decrease, so its increase
    /// above this value is energy that contacts have created.
    least_work: f64,
    /// Largest kinetic energy so far, J.
    largest_kinetic_energy: f64,
}

impl Watch {
    /// Creates the data with which a simulation is checked for failures, from its state at time 0. Call this after
    /// contact detection.
    pub(super) fn new(state: &State) -> Self {
        let losses = Losses::new(&state.world, state.candidates.features(), state.physics);
        let mut watch = Self { losses, ..Self::default() };
        watch.place(state);
        watch
    }

    /// Records that grains were placed at their present positions (at the start or by the user). Call this after
    /// contact detection.
    pub(super) fn place(&mut self, state: &State) {
        self.losses.place(&state.world.grains.positions);
        (self.are_placed, self.placed_overlap) = (true, DeepestContact::new(state, &[]).overlap);
    }

    /// Deletes the data of the grain with the index `grain`, which is being removed from the world.
    pub(super) fn remove(&mut self, grain: usize) {
        self.losses.remove(grain);
        if grain < self.travels.len() {
            self.travels.remove(grain);
        }
    }

    /// Returns the alarm that reports grains placed in overlap; `None` if there is no such overlap or if the remedy
    /// `push-out` (an optional correction that moves such grains apart) is on. `observables` are the measurements
    /// before the next step.
    pub(super) fn of_placed(
        &self,
        observables: &Observables,
        settings: &Settings,
    ) -> Option<Alarm> {
        let overlaps = self.are_placed && self.placed_overlap > LARGEST_OVERLAP;
        let kind = AlarmKind::PlacedInOverlap;
        (overlaps && !settings.remedies.push_out)
            .then(|| Alarm::new(kind, observables, advice::on_placed(settings)))
    }

    /// Raises an alarm before the first step after grains were placed, if they were placed in overlap. After this step
    /// the overlap may be a result of the step, and [`Self::look`] checks it.
    pub(super) fn look_ahead(&mut self, observables: &Observables, settings: &Settings) {
        if let Some(alarm) = self.of_placed(observables, settings) {
            self.add(alarm);
        }
        self.are_placed = false;
    }

    /// Checks the state after a step, and raises alarms. Writes two measurements to `observables`: the number of grains
    /// that went through a wall or left the world, and the slump without these grains. `finite` is false if a position,
    /// a velocity or the kinetic energy is not finite; then `observables` report the step as not solved.
    pub(super) fn look(
        &mut self,
        state: &State,
        settings: &Settings,
        observables: &mut Observables,
        finite: bool,
    ) {
        let State { world, candidates, physics, .. } = state;
        self.unfinished_in_a_row =
            if observables.converged { 0 } else { self.unfinished_in_a_row + 1 };
        if finite {
            let new = self.losses.look(world, candidates.features(), world.has_motion());
            self.raise_losses(new, state, settings, observables);
        }
        observables.lost_grains = self.losses.count;
        if observables.lost_grains > 0 {
            observables.slump = self.losses.slump(world);
        }
        if let Some(advice) = advice::on_no_cohesion(settings, world, *physics) {
            self.raise_with(AlarmKind::NoCohesion, observables, advice);
        }
        if !finite {
            observables.converged = false;
            let advice = advice::on_overflow(state, settings);
            return self.raise_with(AlarmKind::NotFinite, observables, advice);
        }
        if self.unfinished_in_a_row >= STEPS_AT_LIMIT {
            let advice = advice::on_unsolved(state, settings, observables.stalled);
            self.raise_with(AlarmKind::SweepLimit, observables, advice);
        }
        // Grains may have been added since the last step.
        self.travels.resize(world.grains.len(), 0.0);
        for (travel, velocity) in self.travels.iter_mut().zip(&world.grains.velocities) {
            *travel = travel.max(observables.time_step_secs * velocity.length());
        }
        let DeepestContact { overlap, found_in } = DeepestContact::new(state, &self.travels);
        let most = match self.placed_overlap {
            placed if placed > LARGEST_OVERLAP => placed + GROWTH_OF_OVERLAP,
            _ => LARGEST_OVERLAP,
        };
        // Grains that were placed in overlap raise no further alarm, because they fly apart and may collide hard.
        if overlap > most && !self.has(AlarmKind::PlacedInOverlap) {
            // True if the contact was already known before this step: it deepens because the step is not solved.
            let sinks = !observables.converged && found_in < observables.step;
            self.raise_on_depth(AlarmKind::Overlap, sinks, state, settings, observables);
        }
        self.placed_overlap = self.placed_overlap.min(overlap);
    }

    /// Adds the work of the contacts in the last step to the total of the run, and raises an alarm if contacts have
    /// created energy. Must not be called for two steppers: `avbd`, in which the works of the contacts do not equal the
    /// change of energy that they cause, and `dem`, whose contact springs store energy and return it as positive work.
    pub(super) fn count_work(
        &mut self,
        state: &State,
        settings: &Settings,
        observables: &Observables,
    ) {
        let Observables { normal_work, tangential_work, wall_work, bond_work, .. } = *observables;
        let energy = &mut self.energy;
        energy.work += normal_work + tangential_work - wall_work - bond_work.unwrap_or(0.0);
        energy.least_work = energy.least_work.min(energy.work);
        energy.largest_kinetic_energy =
            energy.largest_kinetic_energy.max(observables.kinetic_energy);
        let created = energy.work - energy.least_work;
        let of_motion = ENERGY_OF_MOTION * energy.largest_kinetic_energy;
        if created <= of_motion || self.has(AlarmKind::EnergyCreated) {
            return;
        }
        let world = &state.world;
        let weight = world.gravity.magnitude() * world.grains.masses.iter().sum::<f64>();
        if created > of_motion + ENERGY_OF_HEIGHT * weight * world.mean_diameter {
            let advice = match observables.converged {
                true => advice::on_created_energy(settings),
                false => advice::on_unsolved(state, settings, observables.stalled),
            };
            self.raise_with(AlarmKind::EnergyCreated, observables, advice);
        }
    }

    /// Returns the advice of the alarm that reports a state that is no longer finite, as text. The text is empty if
    /// there is no such alarm.
    pub(super) fn advice_on_overflow(&self, settings: &Settings) -> String {
        let mut alarms = self.alarms.iter().filter(|alarm| alarm.kind == AlarmKind::NotFinite);
        alarms.next().map(|alarm| alarm.advice_in_words(settings)).unwrap_or_default()
    }

    fn raise_losses(
        &mut self,
        new: NewLosses,
        state: &State,
        settings: &Settings,
        observables: &Observables,
    ) {
        if new.placed {
            let advice = Advice::OutOfWalls;
            self.raise_with(AlarmKind::PlacedInOverlap, observables, advice);
        }
        if new.through_wall {
            let sinks = self.unfinished_in_a_row >= STEPS_AT_LIMIT;
            self.raise_on_depth(AlarmKind::GrainLost, sinks, state, settings, observables);
        }
        if new.left {
            // With a longer time step, a grain this fast can be above a fixed disc before a step and below the disc
            // afterwards.
            let longest = 1.0 / new.diameters_per_second;
            match observables.time_step_secs > longest {
                true => self.raise(AlarmKind::GrainLeft, observables, Some(longest)),
                false => self.raise_with(AlarmKind::GrainLeft, observables, Advice::Enclose),
            }
        }
    }

    /// Raises an alarm of the kind `kind`, whose cause is an overlap of bodies that is too deep. `sinks` is true if the
    /// overlap is deep because steps are unsolved, and false if it has another cause, such as a time step that is too
    /// long.
    fn raise_on_depth(
        &mut self,
        kind: AlarmKind,
        sinks: bool,
        state: &State,
        settings: &Settings,
        observables: &Observables,
    ) {
        let (advice, stiffness) = match sinks {
            true => (advice::on_unsolved(state, settings, observables.stalled), None),
            false => advice::on_depth(state, settings),
        };
        self.add(Alarm { stiffness, ..Alarm::new(kind, observables, advice) });
    }

    fn raise_with(&mut self, kind: AlarmKind, observables: &Observables, advice: Advice) {
        self.add(Alarm::new(kind, observables, advice));
    }

    /// Raises an alarm of the kind `kind`, whose advice is a shorter time step. `longest_time_step_secs` is the longest
    /// time step that would help, s, or `None` if it is unknown.
    pub(super) fn raise(
        &mut self,
        kind: AlarmKind,
        observables: &Observables,
        longest_time_step_secs: Option<f64>,
    ) {
        let alarm = Alarm::new(kind, observables, Advice::TimeStep);
        self.add(Alarm { longest_time_step_secs, ..alarm });
    }

    /// Adds `more` to the number of bonds that ended because their two grains circled each other, which opened the gap.
    /// Raises an alarm once this number exceeds half the number of contacts. Fewer such bonds are normal: in most
    /// moving cohesive piles a few bonds end this way.
    pub(super) fn count_turned_bonds(
        &mut self,
        settings: &Settings,
        observables: &Observables,
        more: u64,
    ) {
        self.turned_bonds += more;
        if 2 * self.turned_bonds <= u64::from(observables.contacts) {
            return;
        }
        let kind = AlarmKind::TurnedBonds;
        self.add(Alarm::new(kind, observables, advice::on_turned_bonds(settings)));
        for alarm in self.alarms.iter_mut().filter(|alarm| alarm.kind == kind) {
            alarm.count = Some(self.turned_bonds);
        }
    }

    /// Adds `alarm` to the alarms of the run, unless they already contain an alarm of the same kind.
    fn add(&mut self, alarm: Alarm) {
        if !self.has(alarm.kind) {
            self.alarms.push(alarm);
        }
    }

    fn has(&self, kind: AlarmKind) -> bool {
        self.alarms.iter().any(|alarm| alarm.kind == kind)
    }
}

/// The contact with the largest overlap relative to the smaller disc, after the distance that its two grains travel in
/// one step is subtracted.
struct DeepestContact {
    /// Overlap minus the distance that both grains travel in one step, in diameters of the smaller disc. At a wall, the
    /// diameter is that of the grain.
    overlap: f64,
    /// Number of the step in which this contact was first found.
    found_in: u64,
}

impl DeepestContact {
    /// Finds the deepest contact of a state. `travels` contains the longest distance that each grain has moved in one
    /// step, m; if it is empty, no distance is subtracted from overlaps.
    fn new(state: &State, travels: &[f64]) -> Self {
        let State { world, contacts, .. } = state;
        let (radii, numbering) = (&world.grains.radii, Numbering::of(world));
        let travel_of = |grain: usize| travels.get(grain).copied().unwrap_or(0.0);
        let mut deepest = Self { overlap: 0.0, found_in: 0 };
        for (contact, &found_in) in contacts.contacts().iter().zip(contacts.found_in()) {
            if contact.gap >= 0.0 {
                continue;
            }
            let radius = radii[contact.grain as usize];
            let (radius_of_other, travel_of_other) = match numbering.other(contact.other) {
                Other::Grain(grain) => (radii[grain], travel_of(grain)),
                Other::FixedDisc(disc) => (world.fixed_discs[disc].radius, 0.0),
                Other::Feature(_) => (radius, 0.0),
            };
            let travel = travel_of(contact.grain as usize) + travel_of_other;
            let diameter = 2.0 * radius.min(radius_of_other);
            let overlap = -contact.gap / diameter - (travel / diameter).min(LARGEST_TRAVEL);
            if overlap > deepest.overlap {
                deepest = Self { overlap, found_in };
            }
        }
        deepest
    }
}
