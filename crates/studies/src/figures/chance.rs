//! How often a test says that a claim holds where nothing is behind it: the same test, on the same runs, with Δt
//! shuffled among those that are alike but for Δt. What scatters and how much is then as it was, and no effect is left.

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// Shuffles. The share of a test at 5 % is then known to ± 1.4 %.
const SHUFFLES: usize = 1000;

/// Runs that are alike but for one number: that number, and what came out, of each.
pub(super) type Alike = Vec<(f64, f64)>;

/// Deals what came out to the numbers at random.
fn deal(runs: &mut Alike, random: &mut Pcg64) {
    let mut outcomes: Vec<f64> = runs.iter().map(|(_, outcome)| *outcome).collect();
    outcomes.shuffle(random);
    for (run, outcome) in runs.iter_mut().zip(outcomes) {
        run.1 = outcome;
    }
}

/// The share of shuffles of all groups after which the claim `holds`. `border` is put back in after the shuffle: an
/// effect that a claim allows for, at the border of what it allows.
pub(super) fn share(
    groups: &[Alike],
    border: impl Fn(f64) -> f64,
    holds: impl Fn(&[Alike]) -> bool,
) -> f64 {
    let mut random = Pcg64::seed_from_u64(1);
    let held = (0..SHUFFLES).filter(|_| {
        let mut shuffled = groups.to_vec();
        for group in &mut shuffled {
            deal(group, &mut random);
            for (number, outcome) in group.iter_mut() {
                *outcome += border(*number);
            }
        }
        holds(&shuffled)
    });
    held.count() as f64 / SHUFFLES as f64
}

/// [`share`] in words.
pub(super) fn told(share: f64) -> String {
    format!("holds in {:.1} % of {SHUFFLES} shuffles of Δt within each state", 100.0 * share)
}

#[cfg(test)]
mod tests {
    use super::super::verdict::SIGNIFICANT;
    use super::*;
    use crate::statistics::{mean, slope};

    /// Sixteen states with six Δt each, whose outcomes fall by `fall` a decade.
    fn states(fall: f64) -> Vec<Alike> {
        let of_state = |state: usize| {
            let run = |step: usize| {
                let scatter = (1.3 * state as f64 + 7.1 * (state * step) as f64).sin();
                (step as f64, 0.1 * scatter - fall * step as f64)
            };
            (0..6).map(run).collect()
        };
        (1..=16).map(of_state).collect()
    }

    fn falls(states: &[Alike]) -> bool {
        let slopes: Vec<f64> = states.iter().map(|state| slope(state)).collect();
        mean(&slopes).p_below(0.0) < SIGNIFICANT
    }

    #[test]
    fn a_sound_test_says_so_by_chance_in_five_of_a_hundred_whatever_the_effect() {
        for fall in [0.0, 0.02, 0.5] {
            let share = share(&states(fall), |_| 0.0, falls);
            assert!((share - 0.05).abs() < 0.02, "{share} where it falls by {fall}");
        }
        assert!(falls(&states(0.02)) && !falls(&states(-0.02)));
    }

    #[test]
    fn one_that_always_says_so_is_found_out_and_the_border_counts() {
        assert_eq!(share(&states(0.0), |_| 0.0, |_| true), 1.0);
        assert!(share(&states(0.0), |step| -0.5 * step, falls) > 0.99);
    }
}
