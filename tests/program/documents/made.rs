//! Checks the parts of the documentation that are generated from the program's declarations, between `<!-- made: NAME
//! -->` and `<!-- end -->`. The command `SLUMP_BLESS=1 cargo test --release --test program documents` generates these
//! parts again.

use std::fmt::Write as _;

use clap::Arg;
use serde_json::Value;
use slump::setting::Kind;
use slump::sim::{AlarmKind, Settings};

use super::{book, root};
use crate::program::{Command, folder, json, read, run, said, sentence, slump, succeed, write};

/// Name of a generated part of the documentation, and the function that generates it.
type Part = (&'static str, fn() -> String);

const PARTS: [Part; 4] =
    [("commands", commands), ("settings", settings), ("columns", columns), ("verdicts", verdicts)];
const END: &str = "<!-- end -->";

fn begin(name: &str) -> String {
    format!("<!-- made: {name} -->\n")
}

/// Returns a page in which the function `part` has replaced the generated parts.
fn with_parts(text: &str, part: impl Fn(&str, fn() -> String) -> String) -> String {
    PARTS.iter().fold(text.to_owned(), |text, (name, make)| {
        let Some((before, rest)) = text.split_once(&begin(name)) else { return text };
        let (_, after) = rest.split_once(END).unwrap_or_else(|| panic!("{name} has no end"));
        format!("{before}{}{}{END}{after}", begin(name), part(name, *make))
    })
}

/// Returns a page without its generated parts, which do not count in the length of the page.
pub(super) fn without_tables_of_declarations(text: &str) -> String {
    with_parts(text, |_, _| String::new())
}

#[test]
fn made_parts_are_those_of_today() {
    let mut stale = Vec::new();
    let mut seen = 0;
    for page in book() {
        let text = read(&page);
        seen += text.matches("<!-- made: ").count();
        let today = with_parts(&text, |_, make| make());
        if today != text {
            match std::env::var_os("SLUMP_BLESS") {
                Some(_) => write(&page, today),
                None => stale.push(page),
            }
        }
    }
    assert!(stale.is_empty(), "made anew by SLUMP_BLESS=1: {stale:?}");
    assert_eq!(seen, PARTS.len(), "each part once");
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

fn option_row(arg: &Arg) -> String {
    let values = arg.get_value_names().unwrap_or_default();
    let value = match (values.first(), arg.get_action().takes_values()) {
        (Some(name), true) if arg.get_num_args().is_some_and(|it| it.min_values() == 0) => {
            format!(" [{name}]")
        }
        (Some(name), true) => format!(" {name}"),
        _ => String::new(),
    };
    let name = match arg.get_long() {
        Some(long) => format!("--{long}{value}"),
        None => value.trim().to_owned(),
    };
    let aliases = arg.get_visible_aliases().unwrap_or_default();
    let aliases: String = aliases.iter().map(|it| format!(", `--{it}`")).collect();
    let mut help = cell(&arg.get_help().map(ToString::to_string).unwrap_or_default());
    let default: Vec<_> = arg.get_default_values().iter().map(|it| it.to_string_lossy()).collect();
    if arg.get_action().takes_values() && !default.is_empty() {
        let _ = write!(help, " [default: {}]", default.join(", "));
    }
    for word in arg
        .get_possible_values()
        .iter()
        .filter(|word| word.get_name() != "true" && word.get_name() != "false")
    {
        let about =
            word.get_help().map(|it| format!(": {}", cell(&it.to_string()))).unwrap_or_default();
        let _ = write!(help, "<br>`{}`{about}", word.get_name());
    }
    format!("| `{}`{aliases} | {help} |\n", cell(&name))
}

/// Returns Markdown tables of a command's options, one for each heading. Options in `known` are omitted, because
/// another table has them.
fn tables_of(command: &clap::Command, known: &[String]) -> String {
    let is_told = |arg: &&Arg| {
        let name = arg.get_id().as_str();
        let is_known = known.iter().any(|it| it == name) && !arg.is_positional();
        !["help", "version"].contains(&name) && !arg.is_hide_set() && !is_known
    };
    let mut headings: Vec<Option<&str>> = Vec::new();
    for arg in command.get_arguments().filter(is_told) {
        if !headings.contains(&arg.get_help_heading()) {
            headings.push(arg.get_help_heading());
        }
    }
    let mut text = String::new();
    for heading in headings {
        let title = heading.unwrap_or("option");
        let _ = write!(text, "\n| {title} | |\n|---|---|\n");
        let args = command.get_arguments().filter(is_told);
        args.filter(|arg| arg.get_help_heading() == heading)
            .for_each(|arg| text.push_str(&option_row(arg)));
    }
    text
}

fn commands() -> String {
    let root = slump::cli::command();
    let mut text = format!("## slump\n{}", tables_of(&root, &[]));
    let known: Vec<String> = root
        .get_arguments()
        .filter(|arg| arg.get_help_heading().is_some())
        .map(|arg| arg.get_id().to_string())
        .collect();
    let mut add = |name: &str, command: &clap::Command| {
        let about = command.get_about().map(ToString::to_string).unwrap_or_default();
        let has = |name: &str| command.get_arguments().any(|arg| arg.get_id() == name);
        let also = match (has("frames"), has("scene")) {
            (true, _) => " It takes all options above but the window's.",
            (false, true) => " It takes the options of scene, physics and solver above, too.",
            (false, false) => "",
        };
        let _ = write!(text, "\n## slump {name}\n\n{about}.{also}\n");
        let known = if has("scene") { &known[..] } else { &[] };
        text.push_str(&tables_of(command, known));
    };
    for command in root.get_subcommands() {
        let below: Vec<_> = command.get_subcommands().collect();
        if below.is_empty() || command.get_arguments().any(|arg| arg.get_id() == "out") {
            add(command.get_name(), command);
        }
        for below in below {
            add(&format!("{} {}", command.get_name(), below.get_name()), below);
        }
    }
    text
}

/// Returns the tables of a scene file that contain settings: their names and contents.
fn tables(settings: &Settings) -> [(&'static str, Value); 4] {
    let Settings { stepper, parameters, solver, remedies } = settings;
    let stepper = serde_json::json!({ "stepper": stepper });
    let json = [
        serde_json::to_value(parameters),
        serde_json::to_value(solver),
        serde_json::to_value(remedies),
    ];
    let [parameters, solver, remedies] = json.map(|table| table.expect("JSON"));
    [
        ("", stepper),
        ("`[parameters]`", parameters),
        ("`[solver]`", solver),
        ("`[remedies]`", remedies),
    ]
}

/// Returns the table of a scene file that contains a setting, and the name of the setting in this table.
fn place_in_scene_file(name: &str, kind: Kind) -> (&'static str, String) {
    use slump::setting::Value as Setting;
    let others = match kind {
        Kind::Number => vec![Setting::Number(0.123)],
        Kind::Count => vec![Setting::Count(77)],
        Kind::Switch => vec![Setting::Switch(true), Setting::Switch(false)],
        Kind::Word(words) => words.iter().map(|word| Setting::Word(word.name)).collect(),
    };
    let before = tables(&Settings::default());
    for other in others {
        let mut changed = Settings::default();
        assert!(changed.set(name, other), "{name}");
        for ((table, after), (_, before)) in tables(&changed).into_iter().zip(&before) {
            let mut fields = after.as_object().expect("a table").iter();
            if let Some((field, _)) = fields.find(|(field, value)| before.get(field) != Some(value))
            {
                return (table, field.clone());
            }
        }
    }
    panic!("no scene file says {name}")
}

fn settings() -> String {
    let mut text =
        "\n| table | name | option | default | meaning |\n|---|---|---|---|---|\n".to_owned();
    for about in Settings::about() {
        let (table, field) = place_in_scene_file(about.name, about.kind);
        let default = Settings::default().get(about.name).expect("a setting");
        let help = cell(about.help);
        let _ = writeln!(text, "| {table} | `{field}` | `--{}` | {default} | {help} |", about.name);
    }
    text
}

/// Returns descriptions of the columns of all recorded tables as Markdown. They are taken from the manifest of a
/// recording (the file that describes it).
fn columns() -> String {
    let folder = folder();
    let out = folder.path().join("run");
    succeed(slump("--headless --times 0 --data-format csv --data").arg(&out));
    let described = json(out.join("data.json"));
    let mut text = String::new();
    for (name, columns) in described["tables"].as_object().expect("tables") {
        let _ = write!(text, "\n## {name}\n\n| column | unit | meaning |\n|---|---|---|\n");
        for column in columns.as_array().expect("columns") {
            let said = |field: &str| cell(column[field].as_str().unwrap_or_default());
            let _ = writeln!(text, "| `{}` | {} | {} |", said("name"), said("unit"), said("about"));
        }
    }
    text
}

/// Configurations (solvers, steppers, friction models and the preset `robust`) that the documentation's table of
/// stability tests shows.
const VARIANTS: [&str; 11] = [
    "default",
    "nsgs",
    "newton",
    "nncg",
    "admm",
    "tgs-soft",
    "avbd",
    "dem",
    "associated",
    "desaxce",
    "robust",
];

fn verdicts() -> String {
    let table = read(root().join("tests/physics/stability/table.csv"));
    let rows: Vec<Vec<&str>> =
        table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let mut scenes: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    scenes.dedup();
    let mut text = format!(
        "\n| challenge | {} |\n|---|{}\n",
        VARIANTS.join(" | "),
        "---|".repeat(VARIANTS.len())
    );
    for scene in &scenes {
        let _ = write!(text, "| *{scene}* |");
        for variant in VARIANTS {
            let levels = rows.iter().filter(|row| row[0] == *scene && row[1] == variant);
            let verdicts: String = levels
                .map(|row| match row[3] {
                    "holds" => '●',
                    "degrades" => '◐',
                    "fails" => '○',
                    _ => '–',
                })
                .collect();
            let _ = write!(text, " {verdicts} |");
        }
        text.push('\n');
    }
    let fails = |scene: &&&str| {
        rows.iter().any(|row| row[0] == **scene && row[1] == "default" && row[3] != "holds")
    };
    let (all, failed) = (scenes.len(), scenes.iter().filter(fails).count());
    let _ = writeln!(
        text,
        "\nThe default holds at every level of {} of {all} challenges.",
        all - failed
    );
    text
}

#[test]
fn every_alarm_is_explained() {
    let page = read(root().join("docs/runs.md"));
    for alarm in AlarmKind::ALL {
        assert!(page.contains(&format!("\n| `{}` |", alarm.name())), "{alarm} has no row");
    }
}

#[test]
fn shells_and_man_can_read_what_the_program_says_of_itself() {
    let printed = |line: &str| {
        let output = run(&mut slump(line));
        assert!(output.status.success(), "{line}: {}", said(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    let folder = folder();
    let file = folder.path().join("slump.bash");
    write(&file, printed("completions bash"));
    // Returns the words that the shell offers as completions after `line`, for a last word that begins with `last`.
    let offered = |line: &str, last: &str| {
        let script = format!(
            "source '{}'; COMP_WORDS=({line} '{last}'); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); \
             _slump slump '{last}' \"${{COMP_WORDS[COMP_CWORD - 1]}}\"; echo \"${{COMPREPLY[@]}}\"",
            file.display()
        );
        let output = Command::new("bash").args(["-c", &script]).output().expect("bash starts");
        assert!(output.status.success(), "{}", said(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    assert_eq!(offered("slump", "bud").trim(), "budget");
    assert_eq!(offered("slump run", "--check").trim(), "--checkpoint-every");
    assert!(offered("slump run --stepper", "").contains("tgs-soft"));
    assert!(printed("completions fish").contains("checkpoint-every"));
    assert!(printed("completions zsh").starts_with("#compdef slump"));

    // The manual page describes each option by its short or long help text.
    let page = printed("man run");
    for about in ["Make a new pile", "Start the pile from these discs", "a scene file", "[pile: "] {
        assert!(page.contains(about), "{about} in {page}");
    }
    let unknown = sentence(&mut slump("man bouquet"));
    assert!(unknown.contains("bouquet"), "{unknown}");
}
