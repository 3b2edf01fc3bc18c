//! Links. A link is a line of text from which a run can be computed again. It contains the origin of the scene and, for
//! each simulation, the settings, their changes and the number of steps.
//!
//! > slump://run?scene=pile&bond=20&from=120&bond=5&to=300
//!
//! The names are those of the command line. `from` is the number of a step; the settings that follow it in the line
//! apply after that step. `to` is the number of steps of a simulation and ends the description of this simulation; the
//! next simulation follows. A setting that is left out keeps the value of the scene or its previous value.

use std::sync::OnceLock;

use super::watched_run::TakenRun;
use crate::config::{Config, SceneSource, words_of};
use crate::error::{Error, Result, check};
use crate::live::WorldPlan;
use crate::scene::SceneInfo;
use crate::sim::Settings;

/// First part of links (texts that reproduce runs) that open in Slump's window.
const HEAD: &str = "slump://run?";
/// First part of links (texts that reproduce runs) that open in a browser: the address of the page.
static PAGE: OnceLock<String> = OnceLock::new();

/// Sets the address of the page in the browser. Links that the browser version makes begin with this address.
#[cfg(target_arch = "wasm32")]
pub(super) fn set_link_start(start: String) {
    let _ = PAGE.set(start);
}

/// True if the text looks like the link of a run, for the window or for the browser version.
pub(super) fn is_link(text: &str) -> bool {
    let text = text.trim_start();
    text.starts_with("slump://") || (text.starts_with("http") && text.contains("?scene="))
}

/// Expected form of a link (text that reproduces runs), for error messages.
const FORM: &str = "a line that Copy link gave: slump://run?…&to=STEP";
/// Largest number of characters of a link that an error message shows.
const MOST_SHOWN: usize = 60;

/// The contents of a link (text that reproduces runs): the origin of a scene, and the simulations with the settings
/// that the user chose.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunLink {
    pub source: SceneSource,
    worlds: Vec<LinkedWorld>,
}

/// One of the worlds (simulations) that a link describes.
#[derive(Clone, Debug, PartialEq)]
struct LinkedWorld {
    /// Settings, each with the number of the step after which they apply, in order of steps. The first number is 0.
    changes: Vec<(u64, Config)>,
    steps: u64,
}

/// Appends options of a command line, each a name and a value, to a link.
fn append(query: &mut form_urlencoded::Serializer<'_, String>, words: &[String]) {
    for pair in words.chunks_exact(2) {
        query.append_pair(pair[0].trim_start_matches('-'), &pair[1]);
    }
}

/// Returns the link that reproduces these simulations. The flag is true if the user edited grains or walls of a
/// simulation with the mouse, because a link cannot express such edits.
///
/// # Errors
/// If the run continued from a saved run, or if its scene is in a file or no longer exists.
pub(super) fn link_of(runs: &[TakenRun]) -> Result<(String, bool)> {
    let source = runs.first().map(|run| run.start.config.source.clone()).unwrap_or_default();
    check_names_no_file(&source)?;
    let unchanged = Config { source, ..Config::default() };
    let base = unchanged.without_settling()?.settings();
    let mut query =
        form_urlencoded::Serializer::new(PAGE.get().map_or(HEAD, |page| page).to_owned());
    append(&mut query, &unchanged.words(&base)?);
    let mut is_by_hand = false;
    for TakenRun { world, .. } in runs {
        let allowed = "one that began with a scene: save a session instead";
        let is_from_scene = world.record.start().observables().step == 0;
        check(is_from_scene, "run", "continued from a saved run", allowed)?;
        let now = &world.simulation;
        let steps = now.observables().step;
        let mut before = base;
        let made: Vec<_> = world.record.changes(0, now.time_secs()).collect();
        is_by_hand |= made.iter().any(|change| change.controls.pull.is_some());
        is_by_hand |= !world.record.edits().is_empty();
        let made = made.iter().map(|change| (change.after_step, change.controls.settings));
        for (after, settings) in made.chain([(steps, *now.settings())]) {
            let words = words_of(&settings, Some(&before));
            if after > 0 && !words.is_empty() {
                query.append_pair("from", &after.to_string());
            }
            append(&mut query, &words);
            before = settings;
        }
        query.append_pair("to", &steps.to_string());
    }
    Ok((query.finish(), is_by_hand))
}

impl RunLink {
    /// Reads a link, a text that reproduces runs.
    pub(crate) fn read(text: &str) -> Result<Self> {
        let text = text.trim();
        let refuse = || Error::value("link", shortened(text), FORM);
        let page = || text.starts_with("http").then(|| text.split_once('?')).flatten();
        let query = text.strip_prefix(HEAD).or_else(|| Some(page()?.1)).ok_or_else(refuse)?;
        let mut link = Self { source: SceneSource::default(), worlds: Vec::new() };
        let (mut after, mut options) = (0, Vec::new());
        let mut changes = Vec::new();
        for (name, value) in form_urlencoded::parse(query.as_bytes()).into_owned() {
            let is_step = matches!(&*name, "from" | "to");
            if !is_step {
                options.push((name, value));
                continue;
            }
            let step: u64 = value.parse().map_err(|_| {
                Error::value(format!("link: {name}"), &value, "the number of a step")
            })?;
            let allowed = format!("at least {after}, the step before it in the link");
            check(step >= after, format!("link: {name}"), step, allowed)?;
            let config =
                Config::of_options(options.iter().map(|(name, value)| (&**name, &**value)))?;
            options.clear();
            let is_first = link.worlds.is_empty() && changes.is_empty();
            let Config { source, .. } = &config;
            if is_first {
                link.source = source.clone();
            } else if *source != SceneSource::default() {
                let allowed = "given once, before the first step";
                return Err(Error::value("link: the origin of the scene", "given twice", allowed));
            }
            changes.push((after, Config { source: SceneSource::default(), ..config }));
            after = step;
            if name == "to" {
                link.worlds
                    .push(LinkedWorld { changes: std::mem::take(&mut changes), steps: step });
                after = 0;
            }
        }
        if link.worlds.is_empty() || !options.is_empty() || !changes.is_empty() {
            return Err(refuse());
        }
        check_names_no_file(&link.source).map(|()| link)
    }

    /// Returns the configuration from which the scene of the link can be built.
    pub(crate) fn config(&self) -> Config {
        Config { source: self.source.clone(), ..Config::default() }
    }

    /// Checks that the scene of the link exists and that all settings are valid. Does not deposit a new pile, because a
    /// deposition takes long.
    pub(crate) fn check(&self) -> Result<()> {
        let base = self.config().without_settling()?.settings();
        let mut settings = self.plans(&base).into_iter().flat_map(|plan| {
            let changed = plan.changes.into_iter().map(|(_, settings)| settings);
            std::iter::once(plan.settings).chain(changed)
        });
        settings.try_for_each(|settings| settings.validate())
    }

    /// Returns, for each simulation of the link, its first settings, their later changes, and the number of steps.
    /// `base` are the settings of the scene.
    pub(crate) fn plans(&self, base: &Settings) -> Vec<WorldPlan> {
        let plan = |world: &LinkedWorld| {
            let mut settings = *base;
            let mut changes = world.changes.iter().map(|(after, config)| {
                config.change_settings(&mut settings);
                (*after, settings)
            });
            let (_, first) = changes.next().unwrap_or((0, *base));
            WorldPlan { settings: first, changes: changes.collect(), steps: world.steps }
        };
        self.worlds.iter().map(plan).collect()
    }
}

/// Refuses a scene or an initial state from a file. The sender of a link (text that reproduces runs) must not choose
/// which file is opened on the receiver's machine.
fn check_names_no_file(source: &SceneSource) -> Result<()> {
    let SceneSource { scene, initial, .. } = source;
    match (scene, initial) {
        (Some(name), _) if SceneInfo::named(name).is_none() => {
            Err(Error::value("link: scene", name, "a built-in scene: links name no files"))
        }
        (_, Some(path)) => {
            Err(Error::value("link: initial", path.display(), "left out: links name no files"))
        }
        _ => Ok(()),
    }
}

fn shortened(text: &str) -> String {
    let mut shown: String = text.chars().take(MOST_SHOWN).collect();
    if shown.len() < text.len() {
        shown.push('…');
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_says_worlds_changes_and_steps() {
        let text = "slump://run?scene=pile&bond=20&from=120&bond=5&to=300&dt=0.005&to=60";
        let link = RunLink::read(&format!("  {text}\n")).expect("a link");
        assert_eq!(link.config(), Config::of_scene("pile"));
        let base = Settings::default();
        let [first, second] = &link.plans(&base)[..] else { panic!("two worlds") };
        assert_eq!(first.settings, base.with_bond(20.0));
        assert_eq!((&first.changes[..], first.steps), (&[(120, base.with_bond(5.0))][..], 300));
        assert_eq!(
            *second,
            WorldPlan { settings: base.over(5e-3), changes: Vec::new(), steps: 60 }
        );
    }

    #[test]
    fn the_address_of_a_page_is_a_link() {
        let query = "scene=pile&bond=20&dt=5e-3&to=300";
        let address = format!("https://example.org/slump/?{query}");
        assert!(is_link(&address) && !is_link("https://example.org/"));
        let read = |text: &str| RunLink::read(text).expect("a link");
        assert_eq!(read(&address), read(&format!("slump://run?{query}")));
    }

    #[test]
    fn what_is_no_link_is_refused_in_a_sentence() {
        for (text, said) in [
            (
                "http://example.org",
                "link is http://example.org, but must be a line that Copy link gave",
            ),
            ("slump://run?scene=pile", "but must be a line"),
            ("http://example.org/?scene=pile", "but must be a line"),
            ("slump://run?scene=pile&to=3&bond=5", "but must be a line"),
            ("slump://run?scene=pile&to=-3", "link: to is -3, but must be the number of a step"),
            (
                "slump://run?from=9&to=3",
                "link: to is 3, but must be at least 9, the step before it in the link",
            ),
            ("slump://run?scene=pile&to=3&scene=drum&to=4", "given once"),
            ("slump://run?glue=3&to=3", "--glue"),
            ("slump://run?bond=much&to=3", "--bond is much"),
            ("slump://run?save=a&to=3", "--save is given, but must be a setting"),
            (
                "slump://run?initial=/dev/zero&to=3",
                "link: initial is /dev/zero, but must be left out",
            ),
            (
                "slump://run?scene=/tmp/a.toml&to=3",
                "link: scene is /tmp/a.toml, but must be a built-in",
            ),
        ] {
            let refusal = RunLink::read(text).expect_err("no link").to_string();
            assert!(refusal.contains(said), "{text}: {refusal}");
        }
    }
}
