//! Augmented vertex block descent (C. Giles, E. Diaz and C. Yuksel, *Augmented Vertex Block Descent*, ACM
//! Transactions on Graphics 44, 2025): penalties that stiffen as long as a contact is violated, minimised body by
//! body, and multipliers that take over what they carry.
//!
//! With the bodies' velocities V at the end of a substep h as unknowns (their places are x + hV, normals stay) and
//! c = v − w + b, the relative velocity less that of the wall, where b = gap/h keeps a gap from closing by more than
//! it is, a contact pushes with the reduced impulse
//!
//! > λ_n = max(λ_n⁰ − κ_n c_n, −Bond·g·h),  |λ_t| ≤ μσ likewise around λ_t⁰ − κ_t c_t,  κ = k h²/m_ij.
//!
//! One iteration is, **for each body** in turn, a step of Newton's method on its own energy with all others held,
//!
//! > (D + Σ s κ ∇c ∇cᵀ) ΔV = D (V_free − V) + Σ s λ ∇c,  s = m_ij/m_i,
//!
//! where D is the inertia over the mass; and then **for each contact** λ⁰ ← λ, and κ grows by |c| where its bound
//! did not cut λ. On the left are all contacts, those too that their bounds cut: without these, which hold a body
//! back, piles that collapse explode. Bodies that touch something start from where they were, so that what slides
//! is late by 2⁻¹⁰ of what a step would change. Stiffnesses are kept from step to step, a little less each time. A
//! last pass over the bodies with b of the overlap beyond a margin moves the grains, but leaves their velocities.
//!
//! What it does not hold: **momentum**. Bodies see λ before their partners have answered, so that action and
//! reaction differ by what the iterations leave, and so do work and energy. It has no restitution.

mod descent;

use self::descent::Descent;
use super::StepperInfo;
use super::course::Course;
use super::touching;
use crate::sim::settings::Settings;
use crate::sim::stepping::{Outcome, Stage};
use crate::solver::Model;
use crate::world::Parameters;

/// The row of the registry.
pub(super) const INFO: StepperInfo = StepperInfo {
    solves: "the step's problem by penalties and multipliers, as far as its iterations get",
    source: "C. Giles, E. Diaz and C. Yuksel (2025)",
    settings: &["bond", "dt", "tilt", "mu", "cone", "warm-start", "substeps"],
    substeps: |_, _, parameters| substeps(parameters),
    ..StepperInfo::WHOLE
};

/// Iterations of a substep: what its authors' examples take.
const ITERATIONS: u32 = 10;

fn substeps(parameters: &Parameters) -> u32 {
    parameters.substeps.max(1)
}

/// Takes one step.
pub(super) fn advance<M: Model>(stage: &mut Stage<'_, M>, settings: &Settings) -> Outcome {
    let substeps = substeps(&settings.parameters);
    let course = &mut Course::begin_step(stage, settings, substeps);
    let substep_secs = course.substep_secs;
    let gap_tolerance = stage.state.candidates.gap_tolerance();
    let capture_speed = stage.problem.capture_speed / f64::from(substeps);
    let warm_secs = if settings.solver.warm_start { substep_secs } else { 0.0 };
    let mut contacts = touching::all(stage, warm_secs);
    let mut descent = Descent::new(stage, substep_secs);
    if settings.solver.warm_start {
        descent.stiffen(stage);
    }
    stage.in_pieces(substeps, settings, Outcome::nothing_yet(), |stage, _, _| {
        course.begin(stage);
        let problem = &mut *stage.problem;
        for contact in &mut contacts {
            let cohesive = contact.gap < gap_tolerance;
            contact.capture_speed = if cohesive { capture_speed } else { 0.0 };
        }
        descent.begin(problem, &course.start);
        let keep_gaps = |gap: f64| gap.max(0.0) / substep_secs;
        for _ in 0..ITERATIONS {
            descent.minimise::<M>(problem, &course.free, &contacts, keep_gaps);
            descent.multiply::<M>(problem, &mut contacts, keep_gaps);
        }
        let reached = problem.bodies.clone();
        let margin = descent.margin;
        let push_out = |gap: f64| {
            if gap > 0.0 { gap / substep_secs } else { (gap + margin).min(0.0) / substep_secs }
        };
        descent.minimise::<M>(problem, &course.free, &contacts, push_out);
        course.place(stage);
        let problem = &mut *stage.problem;
        touching::follow(problem, &mut contacts, substep_secs);
        problem.bodies = reached;
        course.add_gravity_work(&problem.bodies, &stage.state.world.grains.masses);
        touching::end_substep(problem, &mut contacts, course);
        // The spring that pulls a grain looks at its velocity.
        course.store(stage);
    });
    touching::remember(stage, &contacts, substep_secs);
    descent.remember(stage);
    touching::hand_over(stage.problem, &contacts);
    stage.problem.store_impulses(&mut stage.state.contacts);
    course.end_step(stage, substeps * (ITERATIONS + 1))
}
