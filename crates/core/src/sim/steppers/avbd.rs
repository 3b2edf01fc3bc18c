//! Stepper `avbd`: augmented vertex block descent (C. Giles, E. Diaz and C. Yuksel, *Augmented Vertex Block Descent*,
//! ACM Transactions on Graphics 44, 2025). It minimises, body by body, the kinetic energy plus penalties for velocities
//! that break the contact law. A penalty becomes stiffer while the velocities break the law. Multipliers (impulses that
//! do not depend on the velocities) gradually replace the penalty impulses.
//!
//! The unknowns are the velocities V of the bodies at the end of a substep of length h. A body at x at the beginning of
//! the substep is at x + hV at its end; contact normals are those of the beginning. A contact requires the velocity c =
//! v − w + b (m/s; c_n along the normal, c_t along the tangent without b) to be 0 along normal and tangent, unless the
//! contact law limits its impulse. Here v is the relative velocity of its two bodies, w the velocity of its wall, and
//! the term b = gap/h keeps a gap from closing by more than its size. Let λ_n⁰ and λ_t⁰ be the multipliers, k the
//! stiffness of the penalty along normal or tangent, μ the friction coefficient, Bond the Bond number, a the
//! acceleration in the cohesion force C₀ = Bond·m_ij·a, and σ = λ_n + Bond·a·h. A contact exerts the impulses (divided
//! by the effective mass m_ij, m/s)
//!
//! > λ_n = max(λ_n⁰ − κ_n c_n, −Bond·a·h),  λ_t = λ_t⁰ − κ_t c_t projected onto |λ_t| ≤ μσ,  κ = k h²/m_ij.
//!
//! One iteration has two parts. **For each body** in turn it takes a Newton step ΔV that minimises the body's kinetic
//! energy and the penalties of its contacts, with all other bodies fixed,
//!
//! > (D + Σ s κ ∇c ∇cᵀ) ΔV = D (V_free − V) + Σ s λ ∇c,  s = m_ij/m_i,
//!
//! with the inertia D of body i divided by its mass m_i, the gradient ∇c of c with respect to V, the velocity V_free
//! that the body would have without contacts, and sums Σ over the normals and tangents of the body's contacts. Then,
//! **for each contact**, it replaces the multipliers λ⁰ by the impulses λ, and increases κ in proportion to |c| unless
//! the contact law has limited λ. The matrix on the left side contains the penalties of all contacts, also of those
//! with limited impulses, because also these contacts hold a body back; without them, the grains of collapsing piles
//! fly apart. Bodies in contact start from their velocities before the substep. A contact that slides keeps the
//! smallest κ, which is 1. If a body slides on a fixed body without turning, each iteration then halves the remaining
//! change of its velocity, so after the ten iterations 2⁻¹⁰ of the change is missing. Stiffnesses are kept from step to
//! step, and reduced slightly in each substep. A last pass over the bodies, with b computed from the overlap beyond a
//! margin, changes positions but not velocities.
//!
//! **Momentum** is not conserved: each body uses λ before its partners have responded, so action and reaction differ by
//! the error of the iteration. For the same reason the works of the contacts do not equal the change of energy exactly.
//! There is no restitution.

use glam::{DMat3, DVec3};

use crate::contact::{ContactLaw, law};
use crate::number::Parts;
use crate::sim::pull::acceleration_of_springs;
use crate::sim::settings::Settings;
use crate::sim::steppers::substeps::{self, Substepping, Touching};
use crate::sim::stepping::{Stage, StepResult};
use crate::solver::{Model, Row, StepProblem};
use crate::world::Parameters;

/// Number of iterations per substep (part of a step), as in the examples of the authors of augmented vertex block
/// descent (Giles, Diaz and Yuksel, 2025).
const ITERATIONS: u32 = 10;

pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> StepResult {
    let substepping = &mut Substepping::begin_step(stage, settings);
    let substeps = substepping.count;
    let substep_secs = substepping.substep_secs;
    let gap_tolerance = stage.state.candidates.gap_tolerance();
    let capture_speed = stage.problem.law.capture_speed() / f64::from(substeps);
    let warm_secs = if settings.solver.warm_start { substep_secs } else { 0.0 };
    let mut contacts = substeps::touching(stage, warm_secs);
    let mut descent = BlockDescent::new(stage, substep_secs, &settings.parameters);
    if settings.solver.warm_start {
        descent.stiffen(stage);
    }
    stage.in_pieces(substeps, settings, StepResult::nothing_yet(), |stage, _, _| {
        substepping.begin(stage);
        let problem = &mut *stage.problem;
        for contact in &mut contacts {
            let cohesive = contact.gap < gap_tolerance;
            contact.capture_speed = if cohesive { capture_speed } else { 0.0 };
        }
        descent.begin(problem, &substepping.start);
        let keep_gaps = |gap: f64| gap.positive_part() / substep_secs;
        for _ in 0..ITERATIONS {
            descent.minimise::<M>(problem, &substepping.free, &contacts, keep_gaps);
            descent.multiply::<M>(problem, &mut contacts, keep_gaps);
        }
        let reached = problem.bodies.now.clone();
        let margin = descent.margin;
        let push_out = |gap: f64| {
            if gap > 0.0 {
                gap / substep_secs
            } else {
                (gap + margin).negative_part() / substep_secs
            }
        };
        descent.minimise::<M>(problem, &substepping.free, &contacts, push_out);
        substepping.place(stage);
        let problem = &mut *stage.problem;
        substeps::follow_gaps(problem, &mut contacts, substep_secs);
        problem.bodies.now = reached;
        substepping.add_gravity_work(&problem.bodies.now, &stage.state.world.grains.masses);
        substeps::end_substep(problem, &mut contacts, substepping);
        // The user's spring reads the velocity of the grain from the world.
        substepping.store(stage);
    });
    substeps::remember(stage, &contacts, substep_secs);
    descent.remember(stage);
    substeps::hand_over(stage.problem, &contacts);
    stage.problem.store_impulses(&mut stage.state.contacts);
    substepping.end_step_of(stage, &contacts, substeps * (ITERATIONS + 1))
}

/// Dimensionless stiffness κ = k h²/m_ij of a new contact (stiffness k, length h of a substep, which is a part of a
/// step, effective mass m_ij), and smallest stiffness of any contact. With a smaller value grains with new contacts
/// overlap more; with a larger value iterations that change one body at a time cannot transmit a force from body to
/// body.
const SOFTEST: f64 = 1.0;
/// Largest dimensionless stiffness κ = k h²/m_ij of a contact (stiffness k, length h of a substep, which is a part of a
/// step, effective mass m_ij). A stiffer contact would dominate all other forces on its two bodies.
const STIFFEST: f64 = 1e6;
/// Increase of a contact's dimensionless stiffness κ (stiffness times squared substep length, divided by effective
/// mass) per iteration, if the relative velocity that the contact law requires to be 0 equals the speed that gravity
/// adds in a substep. With a larger value columns are more stable, but impacts make contacts so stiff that iterations
/// that change one body at a time cannot transmit forces, and the grains of collapsing piles fly apart.
const GROWTH: f64 = 0.1;
/// Factor that multiplies the stiffnesses of all contacts at the beginning of each substep (part of a step). With a
/// smaller value, contacts of resting grains soften.
const KEPT: f64 = 0.99;
/// Overlap that remains after the correction of positions at the end of a substep (part of a step), in mean diameters.
/// Cohesive contacts need some overlap to pull.
const MARGIN: f64 = 5e-4;

/// One side of a contact: the effect of the contact on one of its two bodies.
#[derive(Clone, Copy)]
struct Side {
    row: u32,
    /// Body to which this side belongs: 0 for body i of the contact, 1 for body j.
    end: u8,
}

/// Data of the iterations of augmented vertex block descent in a step: stiffnesses of the contacts, and the contacts of
/// each body. The contact problem and the contacts themselves are stored elsewhere.
struct BlockDescent {
    substep_secs: f64,
    law: ContactLaw,
    /// Speed that gravity adds in a substep (part of a step), g·h (gravity g, length h of the substep), m/s: the unit
    /// in which the stepper measures the relative velocities that contacts require to be 0.
    speed_scale: f64,
    /// Overlap that remains after the correction of positions at the end of a substep (part of a step), m.
    margin: f64,
    /// Dimensionless stiffnesses of each contact along normal and tangent: stiffness times squared substep length,
    /// divided by effective mass.
    stiffness: Vec<[f64; 2]>,
    /// The sides of all contacts, sorted by the body on which they act.
    sides: Vec<Side>,
    /// For each body: the end of the body's range in `sides`.
    side_ends: Vec<usize>,
}

impl BlockDescent {
    fn new<M: Model>(stage: &Stage<'_, M>, substep_secs: f64, parameters: &Parameters) -> Self {
        let (world, problem) = (stage.world(), stage.problem());
        let fixed = problem.rows.fixed.len();
        let mut of_bodies: Vec<(u32, Side)> = Vec::new();
        for (number, row) in problem.rows() {
            let row_number = number as u32;
            of_bodies.push((row.i, Side { row: row_number, end: 0 }));
            if number >= fixed {
                of_bodies.push((row.j, Side { row: row_number, end: 1 }));
            }
        }
        of_bodies.sort_by_key(|&(body, _)| body);
        let ends = 0..problem.bodies.now.len() as u32;
        let side_ends = ends.map(|body| of_bodies.partition_point(|side| side.0 <= body)).collect();
        let g = acceleration_of_springs(world, parameters);
        Self {
            substep_secs,
            law: problem.law,
            speed_scale: g * substep_secs,
            margin: MARGIN * world.mean_diameter,
            stiffness: vec![[SOFTEST; 2]; problem.rows.contacts.len()],
            sides: of_bodies.into_iter().map(|(_, side)| side).collect(),
            side_ends,
        }
    }

    /// Reads the stiffnesses (N/m) that contacts have stored in the previous step, and makes them dimensionless.
    fn stiffen<M: Model>(&mut self, stage: &Stage<'_, M>) {
        let memories = stage.state.contacts.memories();
        let rows = stage.problem.rows().zip(&stage.problem.rows.contacts);
        for (stiffness, ((_, row), &contact)) in self.stiffness.iter_mut().zip(rows) {
            let to_reduced = self.substep_secs * self.substep_secs / row.effective_mass;
            *stiffness =
                memories[contact as usize].stiffness.map(|per_metre| to_reduced * per_metre);
        }
    }

    /// Stores the stiffnesses (N/m) in the contacts, for the next step.
    fn remember<M: Model>(&self, stage: &mut Stage<'_, M>) {
        let memories = stage.state.contacts.parts_mut().memories;
        let rows = stage.problem.rows().zip(&stage.problem.rows.contacts);
        for (stiffness, ((_, row), &contact)) in self.stiffness.iter().zip(rows) {
            let per_reduced = row.effective_mass / (self.substep_secs * self.substep_secs);
            memories[contact as usize].stiffness = stiffness.map(|reduced| per_reduced * reduced);
        }
    }

    /// Begins a substep (part of a step): reduces the stiffnesses of all contacts slightly. Bodies in contact start
    /// from their velocities at the beginning of the substep, without gravity, because the contacts that carried them
    /// before will carry them again.
    fn begin<M: Model>(&mut self, problem: &mut StepProblem<M>, start: &[M::Body<f64>]) {
        for stiffness in self.stiffness.as_flattened_mut() {
            *stiffness = (KEPT * *stiffness).clamp(SOFTEST, STIFFEST);
        }
        let mut first = 0;
        for ((body, start), &end) in problem.bodies.now.iter_mut().zip(start).zip(&self.side_ends) {
            if first < end {
                *body = *start;
            }
            first = end;
        }
    }

    /// Sets the velocity of each body in turn to the velocity that minimises the sum of its kinetic energy and the
    /// penalties of its contacts, while the velocities of all other bodies stay the same. `free` are the velocities
    /// without contacts. The closure `bias` returns, for the gap of a contact (m), the closing speed that the contact
    /// allows (m/s); a negative value requires the contact to open.
    fn minimise<M: Model>(
        &self,
        problem: &mut StepProblem<M>,
        free: &[M::Body<f64>],
        contacts: &[Touching],
        bias: impl Fn(f64) -> f64,
    ) {
        let inertia = DVec3::from_array(M::INERTIA_OVER_MASS);
        // A coordinate that is not a degree of freedom gets the diagonal element 1, so that the matrix is regular and
        // the coordinate does not change.
        let diagonal = DVec3::select(inertia.cmpgt(DVec3::ZERO), inertia, DVec3::ONE);
        let mut first = 0;
        for (body, &end) in self.side_ends.iter().enumerate() {
            if first == end {
                continue;
            }
            let coordinates = |body| DVec3::from_array(M::coordinates(body));
            let now = coordinates(&problem.bodies.now[body]);
            let mut force = inertia * (coordinates(&free[body]) - now);
            let mut matrix = DMat3::from_diagonal(diagonal);
            for &Side { row: number, end } in &self.sides[first..end] {
                let (number, end) = (number as usize, usize::from(end));
                let contact = &contacts[number];
                let push = self.push::<M>(problem, number, contact, bias(contact.gap));
                let row = problem.rows.get(number);
                let share = problem.rows.share(number);
                let share = if end == 0 { share } else { 1.0 - share };
                let directions = if M::FRICTION { 0..2 } else { 0..1 };
                for direction in directions {
                    let gradient = gradient::<M>(row, end, direction);
                    force += share * push.impulse[direction] * gradient;
                    let stiffness = share * self.stiffness[number][direction];
                    let [x, y, spin] = gradient.to_array();
                    let along = stiffness * gradient;
                    matrix += DMat3::from_cols(x * along, y * along, spin * along);
                }
            }
            first = end;
            let reached = now + matrix.inverse() * force;
            M::set(&mut problem.bodies.now[body], reached.to_array());
        }
    }

    /// Sets the stored impulses of each contact (the multipliers) to its present impulses including penalties. Makes a
    /// contact stiffer in proportion to the relative velocity that it requires to be 0, unless the contact law limits
    /// its impulse. The closure `bias` returns, for the gap of a contact (m), the closing speed that the contact allows
    /// (m/s).
    fn multiply<M: Model>(
        &mut self,
        problem: &StepProblem<M>,
        contacts: &mut [Touching],
        bias: impl Fn(f64) -> f64,
    ) {
        for (number, contact) in contacts.iter_mut().enumerate() {
            let push = self.push::<M>(problem, number, contact, bias(contact.gap));
            contact.impulse = push.impulse;
            for direction in 0..2 {
                if !push.is_cut[direction] {
                    let violated = push.violation[direction].abs() / self.speed_scale;
                    let stiffness = &mut self.stiffness[number][direction];
                    *stiffness = (*stiffness + GROWTH * violated).min(STIFFEST);
                }
            }
        }
    }

    /// Returns the impulses of a contact, divided by the effective mass (m/s), at the present velocities of its bodies.
    /// `bias` is the closing speed that the contact allows, m/s; a negative value requires the contact to open.
    #[inline(always)]
    fn push<M: Model>(
        &self,
        problem: &StepProblem<M>,
        number: usize,
        contact: &Touching,
        bias: f64,
    ) -> ContactPush {
        let row = problem.rows.get(number);
        let i = &problem.bodies.now[row.i as usize];
        let [normal_velocity, tangential_velocity] = if number < problem.rows.fixed.len() {
            M::velocity(row.normal, i)
        } else {
            M::relative_velocity(row.normal, i, &problem.bodies.now[row.j as usize])
        };
        let stiffness = self.stiffness[number];
        let closing = normal_velocity - contact.wall_speed + bias;
        let wanted = contact.impulse[0] + contact.capture_speed - stiffness[0] * closing;
        let shifted = law::signorini(wanted);
        let mut push = ContactPush {
            impulse: [shifted - contact.capture_speed, 0.0],
            violation: [closing, 0.0],
            is_cut: [wanted < 0.0, true],
        };
        if M::FRICTION {
            let slip = tangential_velocity - contact.surface_speed;
            let wanted = contact.impulse[1] - stiffness[1] * slip;
            let law = self.law.with_capture_speed(contact.capture_speed);
            let bound = law.friction_bound(shifted);
            push.impulse[1] = law::coulomb(wanted, bound);
            push.violation[1] = slip;
            push.is_cut[1] = wanted.abs() > bound;
        }
        push
    }
}

/// Impulses of a contact, and the velocities that cause them. Each array has an entry for the normal and an entry for
/// the tangential direction: `impulse` is the impulse divided by the effective mass, m/s; `violation` is the relative
/// velocity that the contact requires to be 0, m/s; `is_cut` is true if the contact law has limited the impulse.
struct ContactPush {
    impulse: [f64; 2],
    violation: [f64; 2],
    is_cut: [bool; 2],
}

/// Returns the gradient ∇c of a contact's normal (`direction` 0) or tangential (1) velocity with respect to the
/// velocity of its body i (`end` 0) or j (1).
#[inline(always)]
fn gradient<M: Model>(row: &Row<M>, end: usize, direction: usize) -> DVec3 {
    let mut gradient = M::gradients(row.normal)[end][direction];
    gradient[M::DEGREES..].fill(0.0);
    DVec3::from_array(gradient)
}
