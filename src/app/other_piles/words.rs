//! What is said of other piles.

use super::tasks::Told;
use crate::app::state::AppState;

/// The rule that a mean goes by, for whoever points at it.
const RULE: &str = "Idle cores run piles that differ from this one in their seed alone, with the present settings from \
                    the start on. The band is their mean slump with its 95 % interval (Student's). Other settings \
                    begin anew; a run whose settings changed on the way, or that was pulled by hand, has no others: \
                    reset it. The seed of the shipped pile, which was chosen, is never among them.";

impl AppState {
    /// Whether what is open has other piles, be they computed or not.
    pub(crate) fn has_other_piles(&self) -> bool {
        self.other_piles.are_possible()
    }

    /// How other piles come about, and which they are.
    pub(crate) fn about_other_piles(&self) -> String {
        let Some(Told { seeds, settling, failed, .. }) = self.other_piles.told(self.selected)
        else {
            return RULE.into();
        };
        let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
        let mut text = format!("{RULE}\nSeeds {}.", seeds.join(", "));
        if let Some((number, part)) = settling {
            text += &format!(" Rain {number} of {}: {:.0} %.", seeds.len(), 100.0 * part);
        }
        if failed > 0 {
            text += &format!(" {failed} of the runs came to no end and are left out.");
        }
        text
    }

    /// A world's slump at the moment that is shown beside that of its other piles; nothing where it has none.
    pub(crate) fn beside_other_piles(&self, world: usize) -> Option<String> {
        let row = self.frame.worlds.get(world)?.snapshot.observables;
        let told = self.other_piles.told(world)?;
        Some(format!("Δy {:.3}; {}", row.slump, said(&told, row.time_secs)))
    }

    /// The same of the others alone, for narrow places.
    pub(crate) fn others_in_short(&self, world: usize) -> Option<String> {
        let row = self.frame.worlds.get(world)?.snapshot.observables;
        let told = self.other_piles.told(world)?;
        Some(said(&told, row.time_secs).replace("other piles", "others"))
    }
}

/// What other piles say at a simulated time.
fn said(told: &Told, time_secs: f64) -> String {
    let (planned, count) = (told.seeds.len() - told.failed, told.band.count);
    let mean = told.band.at(time_secs);
    let of = if count < planned { format!("{count} of {planned}") } else { count.to_string() };
    match (mean, told.settling) {
        (Some((mean, half)), _) if half.is_finite() => {
            let decimals = decimals(half);
            format!("other piles {mean:.decimals$} ± {half:.decimals$} (n = {of})")
        }
        (Some((mean, _)), _) => format!("other piles {mean:.2} (n = {of})"),
        (None, _) if count > 0 => "other piles were not run so far".into(),
        (None, Some((number, _))) => format!("other piles: rain {number} of {}", told.seeds.len()),
        (None, None) => "other piles are under way".into(),
    }
}

/// Decimals that show half an interval to two digits, or to one where that is below 0.001.
fn decimals(half: f64) -> usize {
    if half >= 0.1 { 2 } else { 3 }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::app::other_piles::Band;

    fn told(slumps: &[f64], settling: Option<(usize, f32)>) -> Told {
        let run = |&slump: &f64| Arc::new(vec![[0.0, 0.0], [1.0, slump]]);
        let runs: Vec<_> = slumps.iter().map(run).collect();
        Told { band: Arc::new(Band::of(&runs)), seeds: vec![1, 2, 3], failed: 0, settling }
    }

    #[test]
    fn numbers_come_with_their_interval_and_how_many_piles_they_are_of() {
        // Tables: t(0.975; 2) = 4.302653, and the standard error of 0.2, 0.3, 0.4 is 0.1/√3.
        assert_eq!(said(&told(&[0.2, 0.3, 0.4], None), 1.0), "other piles 0.30 ± 0.25 (n = 3)");
        assert_eq!(said(&told(&[0.3, 0.3], None), 1.0), "other piles 0.300 ± 0.000 (n = 2 of 3)");
        assert_eq!(said(&told(&[0.25], None), 1.0), "other piles 0.25 (n = 1 of 3)");
        assert_eq!(said(&told(&[], Some((2, 0.5))), 0.0), "other piles: rain 2 of 3");
        assert_eq!(said(&told(&[], None), 0.0), "other piles are under way");
        assert_eq!(said(&told(&[0.25], None), 9.0), "other piles were not run so far");
    }
}
