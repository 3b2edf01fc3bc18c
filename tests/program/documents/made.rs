//! Parts of the book that are made of what the program declares, between `<!-- made: NAME -->` and `<!-- end -->`.
//! `SLUMP_BLESS=1 cargo test --release --test program documents` makes them anew.

use std::fmt::Write as _;

use clap::Arg;
use slump::setting::Kind;
use slump::sim::{AlarmKind, Settings};

use super::{book, root};
use crate::program::{folder, json, read, slump, succeed, write};

const PARTS: [(&str, fn() -> String); 5] = [
    ("commands", commands),
    ("settings", settings),
    ("columns", columns),
    ("verdicts", verdicts),
    ("alarms", alarms),
];
const END: &str = "<!-- end -->";

fn begin(name: &str) -> String {
    format!("<!-- made: {name} -->\n")
}

/// A page with its made parts replaced.
fn with_parts(text: &str, part: impl Fn(&str, fn() -> String) -> String) -> String {
    PARTS.iter().fold(text.to_owned(), |text, (name, make)| {
        let Some((before, rest)) = text.split_once(&begin(name)) else { return text };
        let (_, after) = rest.split_once(END).unwrap_or_else(|| panic!("{name} has no end"));
        format!("{before}{}{}{END}{after}", begin(name), part(name, *make))
    })
}

/// A page without what is made, which nobody reads from the first line to the last.
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

/// Tables of a command's options, by heading; those of `known` are told of elsewhere.
fn tables_of(command: &clap::Command, known: &[String]) -> String {
    let is_told = |arg: &&Arg| {
        let name = arg.get_id().as_str();
        !["help", "version"].contains(&name) && !known.iter().any(|it| it == name)
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
        let takes_scene = command.get_arguments().any(|arg| arg.get_id() == "scene");
        let also = if takes_scene {
            " It takes the options of scene, physics and solver above, too."
        } else {
            ""
        };
        let _ = write!(text, "\n## slump {name}\n\n{about}.{also}\n");
        let known = if takes_scene { &known[..] } else { &[] };
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

/// Where a scene file has a setting: its table and its name there.
fn place_in_scene_file(name: &str, kind: Kind) -> (String, String) {
    use slump::setting::Value as Setting;
    let default = Settings::default();
    let others = match kind {
        Kind::Number => vec![Setting::Number(0.123)],
        Kind::Count => vec![Setting::Count(77)],
        Kind::Switch => vec![Setting::Switch(true), Setting::Switch(false)],
        Kind::Word(words) => words.iter().map(|word| Setting::Word(word.name)).collect(),
    };
    let before = serde_json::to_value(default).expect("JSON");
    for other in others {
        let mut changed = default;
        assert!(changed.set(name, other), "{name}");
        let after = serde_json::to_value(changed).expect("JSON");
        for (group, value) in after.as_object().expect("a table") {
            let Some(fields) = value.as_object() else {
                if before[group] != *value {
                    return (String::new(), group.clone());
                }
                continue;
            };
            if let Some((field, _)) =
                fields.iter().find(|(field, value)| before[group].get(field) != Some(value))
            {
                return (format!("[{group}]"), field.clone());
            }
        }
    }
    panic!("no scene file says {name}")
}

fn settings() -> String {
    let mut text =
        "\n| table | name | option | default | what it is |\n|---|---|---|---|---|\n".to_owned();
    for about in Settings::about() {
        let (table, field) = place_in_scene_file(about.name, about.kind);
        let default = Settings::default().get(about.name).expect("a setting");
        let help = cell(about.help);
        let _ =
            writeln!(text, "| `{table}` | `{field}` | `--{}` | {default} | {help} |", about.name);
    }
    text.replace("| `` |", "| |")
}

/// The columns of all tables, as a recording describes them.
fn columns() -> String {
    let folder = folder();
    let out = folder.path().join("run");
    succeed(slump("--headless --times 0 --data-format csv --data").arg(&out));
    let described = json(out.join("data.json"));
    let mut text = String::new();
    for (name, columns) in described["tables"].as_object().expect("tables") {
        let _ = write!(text, "\n## {name}\n\n| column | unit | what it is |\n|---|---|---|\n");
        for column in columns.as_array().expect("columns") {
            let said = |field: &str| cell(column[field].as_str().unwrap_or_default());
            let _ = writeln!(text, "| `{}` | {} | {} |", said("name"), said("unit"), said("about"));
        }
    }
    text
}

/// The variants that the page has room for.
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
    for scene in scenes {
        let _ = write!(text, "| *{scene}* |");
        for variant in VARIANTS {
            let levels = rows.iter().filter(|row| row[0] == scene && row[1] == variant);
            let verdicts: String = levels
                .map(|row| match row[3] {
                    "holds" => '●',
                    "degrades" => '◐',
                    _ => '○',
                })
                .collect();
            let _ = write!(text, " {verdicts} |");
        }
        text.push('\n');
    }
    text
}

fn alarms() -> String {
    let mut text = "\n| alarm | what is so |\n|---|---|\n".to_owned();
    for alarm in AlarmKind::ALL {
        let _ = writeln!(text, "| `{}` | {} |", alarm.name(), alarm.hint());
    }
    text
}
