//! Non-linear elimination: before the next Newton step, the few contacts that contribute most to the residual are
//! solved separately, while the impulses of all other contacts stay unchanged (P. Lanzkron, D. Rose, J. Wilkes 1996;
//! X.-C. Cai, X. Li 2011).
//!
//! The result is kept only if it reduces the residual of the whole pile. In an overfull box, contacts that are solved
//! separately push each other harder and harder; without this condition discs kept moving at 7 √(g d) (gravity g, mean
//! diameter d).
//!
//! A few contacts that change between sticking, sliding and opening shorten the Newton step for all other contacts. Of
//! 300 steps of 2,000 collapsing grains, solved to 1e-3 under Coulomb's law, 0, 11 and 22 are unsolved at Bond numbers
//! 0, 20 and 50 without elimination. With elimination 0, 6 and 15 steps are unsolved, in 1.4 times the time.

use super::sweep::ImpulseChange;
use crate::solver::kinematics::Model;
use crate::solver::problem::{
    ContactRows, CoulombFriction, FrictionProjection, StepProblem, errors, law_of_row, residual,
};

/// Minimum fraction of the squared residual that the selected contacts must contribute. Contacts are selected in the
/// order of falling contributions. The contacts of their bodies and of neighbouring bodies are then solved separately.
const HELD: f64 = 0.9;
/// Number of sweeps over the contacts that are solved separately. Of 21,600 steps of 138 grains, solved to 1e-6 with
/// elimination from the first factorisation on, 1,339 are unsolved with 0 sweeps, 1,152 with 30, 878 with 100 and 759
/// with 300 sweeps. The computing times have the ratio 1 : 1.5 : 2.1 : 3.9.
const SWEEPS: u32 = 100;

/// Work memory of the non-linear elimination, and the contacts that are solved separately. Its contents are not kept
/// from one call to the next.
#[derive(Clone, Debug, Default)]
pub(super) struct NonlinearElimination {
    /// Contribution of each contact to the squared residual, (N·s)².
    squares: Vec<f64>,
    /// Numbers of the contacts, sorted by falling contribution to the squared residual.
    by_square: Vec<usize>,
    /// True for each body of a selected contact. The selected contacts contribute most to the residual.
    at: Vec<bool>,
    /// True for each body of a contact that contributes much to the residual (marked in `at`), and for each body that
    /// touches a marked body.
    around: Vec<bool>,
    fixed: Vec<usize>,
    pairs: Vec<usize>,
    /// Impulses of all contacts before the elimination: normal impulse plus cohesion impulse, and tangential impulse,
    /// divided by the effective mass, m/s. They are restored if the elimination does not reduce the residual.
    saved: Vec<[f64; 2]>,
}

impl NonlinearElimination {
    /// Selects the bodies of the contacts that contribute most to the residual, and solves all contacts of these bodies
    /// and of their neighbours by sweeps under Coulomb's law. Keeps the result if it reduces the residual of the whole
    /// problem. The reported number of sweeps does not include these sweeps, because they visit only a few contacts of
    /// the pile.
    pub(super) fn apply<M: Model>(&mut self, problem: &mut StepProblem<M>) {
        let before = residual(problem);
        problem.rows.read_impulses(&mut self.saved);
        self.choose(problem);
        let StepProblem { bodies, rows, law, .. } = problem;
        let ContactRows { fixed, pairs, frictions, captures, rolling, .. } = rows;
        let first_pair = fixed.len();
        let law_of = |number| law_of_row([frictions, captures], number, law);
        let project = |number: usize| {
            let law = law_of(number);
            move |trial| CoulombFriction::<false>::project::<M>(&law, 0.0, trial)
        };
        let mut change = ImpulseChange::default();
        for _ in 0..SWEEPS {
            for &number in &self.fixed {
                let row = &mut fixed[number];
                row.solve::<false>(&mut bodies.now, &mut change, project(number));
                if M::ROLLING
                    && let Some(rolling) = rolling.get_mut(number)
                {
                    let law = law_of(number);
                    row.solve_rolling::<false>(rolling, None, &law, &mut bodies.now, &mut change);
                }
            }
            for &number in &self.pairs {
                let (row, number) = (&mut pairs[number], first_pair + number);
                row.solve::<false>(&mut bodies.now, &mut change, project(number));
                if M::ROLLING
                    && let Some(rolling) = rolling.get_mut(number)
                {
                    let (share, law) = (Some(row.share), law_of(number));
                    row.solve_rolling::<false>(rolling, share, &law, &mut bodies.now, &mut change);
                }
            }
        }
        // NaN compares false, so a residual of NaN counts as no progress.
        let is_better = residual(problem) < before;
        if !is_better {
            problem.write_impulses(self.saved.iter().copied());
        }
    }

    fn choose<M: Model>(&mut self, problem: &StepProblem<M>) {
        let Self { squares, by_square, at, around, fixed, pairs, .. } = self;
        squares.clear();
        problem.for_each_velocity(&problem.bodies.now, |row, velocity| {
            let restitution = row.restitution_velocity;
            let [normal, tangential] = errors::<M, f64>(
                &problem.law_of(squares.len()),
                row.impulse(),
                restitution,
                velocity,
            );
            let mass = row.effective_mass;
            squares.push(mass * mass * (normal * normal + tangential * tangential));
        });
        for (number, row) in problem.rows() {
            if let Some((rolling, velocity)) = problem.rolling(number, row, &problem.bodies.now) {
                let error = rolling.error(&problem.law_of(number), row.shifted_impulse, velocity);
                squares[number] += (row.effective_mass * error).powi(2);
            }
        }
        by_square.clear();
        by_square.extend(0..squares.len());
        by_square.sort_unstable_by(|&one, &other| squares[other].total_cmp(&squares[one]));
        let rows = &problem.rows;
        let most = HELD * squares.iter().sum::<f64>();
        at.clear();
        at.resize(problem.bodies.now.len(), false);
        let mut held = 0.0;
        for &number in &*by_square {
            if held >= most {
                break;
            }
            held += squares[number];
            if let Some(row) = rows.fixed.get(number) {
                at[row.i as usize] = true;
            } else {
                let row = &rows.pairs[number - rows.fixed.len()];
                at[row.i as usize] = true;
                at[row.j as usize] = true;
            }
        }
        around.clone_from(at);
        for row in &rows.pairs {
            let [i, j] = [row.i as usize, row.j as usize];
            if at[i] || at[j] {
                around[i] = true;
                around[j] = true;
            }
        }
        fixed.clear();
        fixed.extend((0..rows.fixed.len()).filter(|&number| around[rows.fixed[number].i as usize]));
        pairs.clear();
        pairs.extend((0..rows.pairs.len()).filter(|&number| {
            let row = &rows.pairs[number];
            around[row.i as usize] || around[row.j as usize]
        }));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::ContactLaw;
    use crate::solver::SpinningPlane;
    use crate::solver::methods::pass::sweep;
    use crate::solver::methods::random_problem::random_problem;
    use crate::world::FrictionCone;

    #[test]
    fn what_one_contact_holds_is_solved_there_and_nowhere_else() {
        for seed in 0..20 {
            let law = ContactLaw::new(0.4, 0.1, FrictionCone::Shifted);
            // The problem is random, but contacts exist only between bodies whose numbers differ by at most two. So
            // bodies with distant numbers are many contacts away from each other.
            let mut problem = random_problem::<SpinningPlane>(seed, law, 60, 120, 3, 0.0..0.3);
            for _ in 0..2_000 {
                sweep::<SpinningPlane, false>(&mut problem);
            }
            let solved = residual(&problem);
            let pairs = problem.rows.pairs.iter_mut();
            let struck = pairs.min_by_key(|row| row.i.abs_diff(30)).expect("some of 120");
            struck.shifted_impulse += 3.0;
            problem.form_velocities();
            let before = residual(&problem);
            assert!(before > 100.0 * solved, "seed {seed}: {solved:e}, {before:e}");
            let impulses = problem.rows.iter().map(|row| row.impulse()).collect::<Vec<_>>();
            NonlinearElimination::default().apply(&mut problem);
            let after = residual(&problem);
            assert!(after < 0.2 * before, "seed {seed}: {before:e}, {after:e}");
            for (row, before) in problem.rows.iter().zip(impulses) {
                let is_far = [row.i, row.j].iter().all(|body| !(20..40).contains(body));
                assert!(!is_far || row.impulse() == before, "seed {seed}: {} {}", row.i, row.j);
            }
        }
    }
}
