//! Checks that links in the documentation lead to existing targets and that checked numbers equal those of their
//! reports.

use serde_json::Value;

use super::{pages, root};
use crate::program::{json, read};

/// Returns text and target of each link of a page outside code blocks.
fn links(text: &str) -> Vec<(&str, &str)> {
    let prose = text.split("```").step_by(2);
    let found = prose.flat_map(|prose| {
        prose.match_indices("](").filter_map(|(at, _)| {
            let target = prose[at + 2..].split_once(')')?.0;
            Some((&prose[prose[..at].rfind('[')? + 1..at], target))
        })
    });
    found.collect()
}

/// Returns the anchor that GitHub gives to a heading, for links to the heading.
fn anchor(heading: &str) -> String {
    let heading = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = heading.chars().filter(|it| it.is_alphanumeric() || matches!(it, ' ' | '-' | '_'));
    kept.map(|it| if it == ' ' { '-' } else { it }).collect()
}

/// A number in the documentation that must agree with a report. A comment below its table or paragraph names the
/// report: `<!-- checked: REPORT.json 0.252 /pointer, … -->`, or `<!-- checked: REPORT.md words #heading, … -->`.
struct CheckedNumber<'a> {
    /// The table or paragraph above the comment, in which the number must occur.
    block: &'a str,
    report: &'a str,
    number: &'a str,
    pointer: &'a str,
}

fn checked_numbers(text: &str) -> Vec<CheckedNumber<'_>> {
    let mut found = Vec::new();
    for (at, _) in text.match_indices("<!-- checked: ") {
        let comment = &text[at + "<!-- checked: ".len()..];
        let comment = comment.split("-->").next().unwrap_or_default().trim();
        let (report, numbers) = comment.split_once(' ').unwrap_or((comment, ""));
        let above = text[..at].trim_end();
        let block = &above[above.rfind("\n\n").map_or(0, |start| start + 2)..];
        for entry in numbers.split(", ") {
            let (number, pointer) = entry.trim().rsplit_once(' ').unwrap_or((entry, ""));
            found.push(CheckedNumber { block, report, number, pointer });
        }
    }
    found
}

/// Returns a table or paragraph without its comments, as a reader sees it.
pub(super) fn without_comments(block: &str) -> String {
    let mut parts = block.split("<!--");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once("-->").map_or("", |(_, after)| after))
}

/// Returns true if a text of the documentation is the number `value` of a report, rounded to the digits of the text:
/// `−.25`, `+0.3`, `49`, `1.2e-3`.
fn is_printed(text: &str, value: &Value) -> bool {
    let Some(number) = value.as_f64() else { return value.as_str() == Some(text) };
    let plain = text.replace('−', "-").replace('+', "");
    let mantissa = plain.split('e').next().unwrap_or_default();
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let rounded = match plain.contains('e') {
        true => format!("{number:.digits$e}"),
        false => format!("{number:.digits$}"),
    };
    rounded.parse::<f64>().ok() == plain.parse().ok()
}

/// Returns the text below a heading, up to the next heading.
fn section(text: &str, name: &str) -> String {
    let lines = text.lines().skip_while(|it| !(it.starts_with('#') && anchor(it) == name));
    lines.skip(1).take_while(|it| !it.starts_with('#')).collect::<Vec<_>>().join("\n")
}

#[test]
fn links_lead_somewhere_and_numbers_are_those_of_their_reports() {
    let mut wrong = Vec::new();
    let mut numbers = 0;
    for page in pages() {
        let text = read(&page);
        let folder = page.parent().expect("a folder");
        for CheckedNumber { block, report, number, pointer } in checked_numbers(&text) {
            numbers += 1;
            let path = folder.join(report);
            let is_right = match pointer.strip_prefix('#') {
                Some(heading) => section(&read(&path), heading).contains(number),
                None => json(&path).pointer(pointer).is_some_and(|value| is_printed(number, value)),
            };
            if !is_right || !without_comments(block).contains(number) {
                let page = page.strip_prefix(root()).expect("a page of ours").display();
                wrong.push(format!("{page}: {number} is not that of {report} {pointer}"));
            }
        }
        for (said, target) in links(&text) {
            if target.contains("://") {
                continue;
            }
            let (path, fragment) = target.split_once('#').unwrap_or((target, ""));
            let path = if path.is_empty() { page.clone() } else { folder.join(path) };
            let mut complain = |what: &str| {
                let page = page.strip_prefix(root()).expect("a page of ours").display();
                wrong.push(format!("{page}: [{said}]({target}): {what}"));
            };
            if !path.exists() {
                complain("no such file");
            } else if target.contains(".md#") && target.contains("/reports/") {
                numbers += 1;
                if !section(&read(&path), fragment).contains(said) {
                    complain("the report's section has no such words");
                }
            } else if let Some(pointer) = target.contains(".json#").then_some(fragment) {
                numbers += 1;
                match json(&path).pointer(pointer) {
                    Some(value) if is_printed(said, value) => {}
                    Some(value) => complain(&format!("the report has {value}")),
                    None => complain("nothing is there"),
                }
            } else if !fragment.is_empty()
                && !read(&path).lines().any(|it| it.starts_with('#') && anchor(it) == fragment)
            {
                complain("no such heading");
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(numbers > 100, "{numbers} numbers of reports");
}

/// Largest width of a picture that fits a page of the documentation, pixels.
const MOST_WIDTH: u32 = 1_200;

#[test]
fn every_picture_fits_a_page_is_shown_and_says_its_result() {
    let texts: Vec<String> = pages().iter().map(read).collect();
    for entry in std::fs::read_dir(root().join("screenshots")).expect("pictures") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        let (width, _) = image::image_dimensions(&path).expect("a picture");
        assert!(width <= MOST_WIDTH, "{name} is {width} pixels wide, but may have {MOST_WIDTH}");
        let shown = texts.iter().flat_map(|text| links(text)).filter(|(_, to)| to.ends_with(&name));
        let said: Vec<&str> = shown.map(|(said, _)| said).collect();
        assert!(!said.is_empty(), "no page shows {name}");
        assert!(said.iter().all(|said| said.split(' ').count() > 10), "{name}: {said:?}");
    }
}

#[test]
fn a_comment_names_the_numbers_of_the_block_above_it() {
    let text = "One.\n\n| a | 0.5 |\n| b | 2 |\n<!-- checked: r.json 0.5 /a, 2 /b/0 -->\n\nTwo.";
    let found = checked_numbers(text);
    assert_eq!(found.len(), 2);
    assert_eq!((found[1].report, found[1].number, found[1].pointer), ("r.json", "2", "/b/0"));
    assert_eq!(found[1].block, "| a | 0.5 |\n| b | 2 |");
    assert_eq!(without_comments("a <!-- 3 --> b"), "a  b");
}

#[test]
fn a_number_is_held_to_the_digits_that_it_shows() {
    for (text, value) in
        [("0.24", 0.2417), ("−.25", -0.2543), ("+0.3", 0.264), ("49", 49.0), ("1.3e-3", 1.26e-3)]
    {
        assert!(is_printed(text, &Value::from(value)), "{text}");
    }
    for (text, value) in [("0.25", 0.2417), ("0.25", -0.2543), ("much", 0.3), ("", 0.0)] {
        assert!(!is_printed(text, &Value::from(value)), "{text}");
    }
}
