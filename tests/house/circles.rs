//! Files that use each other in a circle.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fmt;

use super::uses::Uses;

/// Sets of files each of which uses all others of its set, directly or through others.
pub struct Circles<'a> {
    uses: &'a Uses,
    sets: Vec<BTreeSet<&'a str>>,
}

impl<'a> Circles<'a> {
    /// The circles among uses.
    pub fn of(uses: &'a Uses) -> Self {
        let mut used_by: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (user, used) in uses.keys() {
            used_by.entry(user).or_default().push(used);
        }
        let reached: BTreeMap<&str, BTreeSet<&str>> =
            used_by.keys().map(|&file| (file, reached_from(file, &used_by))).collect();
        let mut sets: Vec<BTreeSet<&str>> = Vec::new();
        for (&file, others) in &reached {
            let set: BTreeSet<&str> = others
                .iter()
                .copied()
                .filter(|&other| reached.get(other).is_some_and(|back| back.contains(file)))
                .collect();
            if !set.is_empty() && !sets.contains(&set) {
                sets.push(set);
            }
        }
        Self { uses, sets }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.sets.is_empty()
    }

    /// The shortest way within a set from one of its files back to it.
    pub fn smallest(&self, set: &BTreeSet<&'a str>) -> Vec<&'a str> {
        let circles = set.iter().filter_map(|&start| {
            let mut came_from: BTreeMap<&str, &str> = BTreeMap::new();
            let mut next = VecDeque::from([start]);
            while let Some(user) = next.pop_front() {
                for (other, used) in self.uses.keys() {
                    if other != user || !set.contains(used.as_str()) {
                        continue;
                    }
                    if used == start {
                        let way =
                            std::iter::successors(Some(user), |at| came_from.get(at).copied());
                        let mut way: Vec<&str> = way.collect();
                        way.reverse();
                        return Some(way);
                    }
                    if !came_from.contains_key(used.as_str()) {
                        came_from.insert(used, user);
                        next.push_back(used);
                    }
                }
            }
            None
        });
        circles.min_by_key(Vec::len).unwrap_or_default()
    }

    /// The sets.
    pub fn sets(&self) -> &[BTreeSet<&'a str>] {
        &self.sets
    }
}

/// All that a file uses, directly or through others; itself only if it lies on a circle.
fn reached_from<'a>(file: &'a str, used_by: &BTreeMap<&'a str, Vec<&'a str>>) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut next = vec![file];
    while let Some(user) = next.pop() {
        for &used in used_by.get(user).into_iter().flatten() {
            if reached.insert(used) {
                next.push(used);
            }
        }
    }
    reached
}

impl fmt::Display for Circles<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for set in &self.sets {
            let smallest = self.smallest(set);
            writeln!(
                f,
                "a circle of {} files, within {} that use each other",
                smallest.len(),
                set.len()
            )?;
            let ring: BTreeSet<(&str, &str)> = (0..smallest.len())
                .map(|at| (smallest[at], smallest[(at + 1) % smallest.len()]))
                .collect();
            let line =
                |f: &mut fmt::Formatter<'_>, user: &str, used: &str, names: &BTreeSet<String>| {
                    let names = names.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
                    writeln!(f, "    {user} -> {used}: {names}")
                };
            let within = self.uses.iter().filter(|((user, used), _)| {
                set.contains(user.as_str()) && set.contains(used.as_str())
            });
            let (first, others): (Vec<_>, Vec<_>) = within
                .partition(|((user, used), _)| ring.contains(&(user.as_str(), used.as_str())));
            for ((user, used), names) in first {
                line(f, user, used, names)?;
            }
            if !others.is_empty() {
                writeln!(f, "  the other uses within the set")?;
            }
            for ((user, used), names) in others {
                line(f, user, used, names)?;
            }
        }
        Ok(())
    }
}
