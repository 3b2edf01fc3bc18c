//! The shocks of a step under the law `range`.
//!
//! Collisions are instantaneous: neither gravity nor a bond, whose forces are finite, does anything in
//! no time. So before the step proper, the grains that run into each other are brought to the
//! velocities after their collisions, with neither gravity nor cohesion. A contact that closes with u
//! bounces,
//!
//! > 0 ≤ P_n ⟂ u⁺ + ρ u⁻ ≥ 0.
//!
//! The step then goes on from v⁺ and bounces no more.
//!
//! **A pair that meets within the step** bounces in it, with the whole speed u that it has when it
//! meets, along the normal that it has then (`contact::meeting`). Slowed down to what closes its gap, and
//! left to the next step to bounce, it would have the restitution φρ, φ being the part of the step that
//! the gap takes: any number from 0 to ρ. An impulse at the moment t moves a grain for what is left of
//! the step,
//!
//! > x^n = x + Δt v^n − Σ t Δv,
//!
//! so that a grain is on straight ways before and after, and meets others where it then is. The sum is the
//! `offset` of a grain. A bond that a meeting makes lives from t on.
//!
//! **One after the other.** A pass takes those meetings that are the first of both their grains: what
//! another collision deflects is not struck where it would have been. The next pass looks anew at the
//! pairs of grains that were struck. What touches at that time is struck along with it, all at once, as
//! under `moreau`: in a row of balls at rest that touch, all fly off together, while balls with gaps hand
//! the shock on, and the last one alone flies off. Meetings of different moments that reach the same
//! touching grains are struck at the first of these moments.
//!
//! **Gravity.** A grain that rests on nothing falls on the parabola x + v s + ½a s², and does so however it
//! is cut into steps: what the step's last velocity tells too much of it, Δt v^n − ½aΔt², is taken off. Where it
//! meets what is fixed, u = v_n + a_n t, and it is handed v⁺ such that with all of
//! the step's gravity it ends with what it has had since: v⁺ + a_n t = −ρu. The works are those of the speeds at the
//! meeting. What rests on something is held by it, for all that is known before the step is solved, and has u = v_n.
//!
//! **Bonds.** A bond that is stretched by s has C₀s to give back until its pair meets: u² = v_n² + 2C₀s/m_ij.
//!
//! **Why not in one problem with the step.** A bounce that is asked for together with v_n ≥ 0 of contacts that open
//! can be asked for in vain: of two grains that rattle between others each is to be left and none can
//! be. Then no solution is to be had. Asked for alone, v⁺ = −ρ v⁻ of all grains obeys every contact, and so does v = 0 in the step.
//! For this, contacts that open have their term too: they may close by ρ v_n⁻, and are struck by the next pass if they do.
//!
//! **Walls that a force drives** are struck in no shock: what hits such a wall would change its speed, and with that
//! the moments of all that it is still to meet. The step proper stops what comes to it, and its unknown speed takes that
//! up, so momentum and energy balance; but nothing bounces off it.
//!
//! **No energy is gained** by a pass without friction, for the reason that `remedies::sequential_impacts` gives.
//!
//! **How tightly.** As the step. Solved less tightly, with what that leaves of approach taken up by the
//! step, shocks cost less, but slump may then depend on Δt. A pair that shares its grains with no other is solved exactly.

mod bodies;
mod foreseen;
mod result;
mod struck;

pub(super) use self::bodies::{Passed, Shocks};
pub(super) use self::result::Closed;

use self::bodies::{NEVER, Surroundings};
use super::numbers::StepNumbers;
use crate::sim::stepping::Stage;
use crate::solver::{Model, SolverSettings};

/// Passes at the most; what then still closes is stopped by the step. Smaller: where many grains meet in a
/// step, restitution is lost; larger: a wedge of grains that bounces ever faster holds the step up.
const MOST_PASSES: u32 = 24;

/// Takes a prepared problem through the shocks of its step: from then on its bodies begin with v⁺.
pub(super) fn pass<M: Model>(
    stage: &mut Stage<'_, M>,
    shocks: &mut Shocks,
    numbers: StepNumbers,
    settings: &SolverSettings,
) -> Option<Passed> {
    let Stage { state, problem, part, memory } = stage;
    let (world, candidates, contacts) = (&state.world, &state.candidates, &state.contacts);
    let around = Surroundings { world, candidates, contacts, numbers };
    shocks.begin(problem, &around, settings.tolerance);
    let mut passed: Option<Passed> = None;
    for _ in 0..MOST_PASSES {
        let first = shocks.foresee(problem, &around);
        if first == NEVER {
            break;
        }
        shocks.choose(problem, first, numbers);
        shocks.refine(problem, &around);
        let all = passed.get_or_insert(Passed::nothing_yet());
        for alone in [true, false] {
            if shocks.set_up(problem, part, &around, alone) {
                shocks.strike::<M>((problem, part), memory, (settings, alone), all);
            }
        }
        shocks.move_on(problem);
    }
    shocks.hand_over(problem, &around);
    passed
}
