//! Help texts, shell completions and manual pages of the command line.

use clap::{Arg, Command, CommandFactory};

use super::Cli;
use crate::config::Config;
#[cfg(feature = "manual")]
use crate::error::{Error, Result};
use crate::scene::built_in;

/// Names of the options that the short help (`-h`) shows. The long help (`--help`) shows all options.
const FIRST: [&str; 16] = [
    "scene", "grains", "seed", "preset", "duration", "stepper", "bond", "dt", "rho", "mu",
    "solver", "headless", "frames", "gif", "data", "help",
];

/// Names of the options that are allowed only with `--headless`.
const HEADLESS: [&str; 13] = [
    "overwrite",
    "fps",
    "times",
    "gif",
    "video",
    "video_speed",
    "colour_scale",
    "force_scale",
    "save",
    "checkpoint_every",
    "data",
    "data_every",
    "data_format",
];

const EXAMPLES: &str = "Examples:
  slump --bond 20 --dt 5e-3                           # the window, with a cohesive pile
  slump run cradle --frames out/                      # pictures, and a row a step
  slump run pile --bond 50 --data run/                # all grains and contacts, for other programs
  slump budget --bond 20 --out budget/                # physics, time step or solver?
  slump list scenes";

const RUN_EXAMPLES: &str = "Examples:
  slump run pile --bond 20 --frames out/              # pictures, and a row a step
  slump run pile --grains 500 --seed 3 --gif fall.gif # another pile, as an animation
  slump run mine.toml --dt 1e-3 --data run/           # a scene file; all grains and contacts
  slump run cradle --frames out/ --save end.slump     # resume from this file:
  slump run --restart end.slump --duration 3 --frames more/";

/// Returns the definition of the command line: all commands and options, with their help texts. The short help (`-h`)
/// shows only the most important options. The long help (`--help`) shows all options, each with its value in the
/// built-in pile if it is a setting.
pub fn command() -> Command {
    let pile = built_in(Config::DEFAULT_SCENE).map(|scene| scene.settings()).ok();
    let root = Cli::command();
    let of_root: Vec<_> = root.get_arguments().map(|arg| arg.get_id().clone()).collect();
    let told = |arg: Arg| {
        let name = arg.get_id().as_str();
        let default = pile.and_then(|settings| settings.get(name));
        let is_hidden = !FIRST.contains(&name) && of_root.iter().any(|it| it == name);
        let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
        // The long help is always set. Without it, a manual page would have no text for an option that the short help
        // hides.
        let long = match default {
            Some(default) => format!("{help} [pile: {default}]"),
            None => help,
        };
        arg.long_help(long).hide_short_help(is_hidden)
    };
    let of_headless = |arg: Arg| match HEADLESS.contains(&arg.get_id().as_str()) {
        true => arg.requires("headless"),
        false => arg,
    };
    let run = |below: Command| if below.get_name() == "run" { scene_first(below) } else { below };
    let root = root.mut_args(of_headless).mut_subcommands(run).after_help(EXAMPLES);
    tell(root, &told)
}

/// Changes the command `run` so that the scene is its first argument and the option `--headless`, which `run` implies,
/// is hidden.
fn scene_first(run: Command) -> Command {
    let scene = |scene: Arg| {
        let scene = scene.long(None).index(1).value_name("SCENE").help_heading(None);
        scene.required_unless_present_any(["initial", "restart"])
    };
    run.mut_arg("scene", scene).mut_arg("headless", |arg| arg.hide(true)).after_help(RUN_EXAMPLES)
}

/// Applies the function `told`, which completes the help text of an option, to all options of those commands that take
/// a scene. Also makes all options of all commands accept values that look like negative numbers, so that the check of
/// each option can refuse a negative value with a clear message.
fn tell(command: Command, told: &dyn Fn(Arg) -> Arg) -> Command {
    let command = command.mut_args(|arg| match arg.get_action().takes_values() {
        true => arg.allow_negative_numbers(true),
        false => arg,
    });
    let takes_scene = command.get_arguments().any(|arg| arg.get_id() == "scene");
    let command = if takes_scene { command.mut_args(told) } else { command };
    command.mut_subcommands(|below| tell(below, told))
}

/// Returns a script with which a shell completes commands and options.
#[cfg(feature = "manual")]
pub(super) fn completions(shell: clap_complete::Shell) -> String {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut command(), "slump", &mut text);
    String::from_utf8_lossy(&text).into_owned()
}

/// Returns the manual page of the command whose words are `names`, such as `problem` and `solve`, or of the whole
/// program if `names` is empty.
///
/// # Errors
/// If there is no command with these words.
#[cfg(feature = "manual")]
pub(super) fn page(names: &[String]) -> Result<String> {
    let mut command = command();
    command.build();
    let found = names.iter().try_fold(&command, |command, name| command.find_subcommand(name));
    let allowed = "the name of a command that --help lists";
    let found = found.ok_or_else(|| Error::value("command", names.join(" "), allowed))?;
    let mut text = Vec::new();
    let page = clap_mangen::Man::new(found.clone());
    page.render(&mut text).map_err(|error| Error::file("man", error))?;
    Ok(String::from_utf8_lossy(&text).into_owned())
}
