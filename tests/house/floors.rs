//! Which folders may use which.

use super::uses::Uses;

/// From the ground up; a folder uses only those of the floors below its own.
const FLOORS: &[&[&str]] = &[
    &["error"],
    &["setting", "output", "threads"],
    &["world"],
    &["contact"],
    &["solver"],
    &["sim"],
    &["granular"],
    &["data"],
    &["scene"],
    &["render", "interchange", "record"],
    &["study"],
    &["headless"],
    &["app"],
    &["cli"],
];

/// One sentence for each use that does not point downward.
pub fn complaints(uses: &Uses) -> Vec<String> {
    let mut complaints = Vec::new();
    for ((user, used), names) in uses {
        let folders = [user, used].map(|path| folder(path));
        // The crate's root says what there is and has no floor.
        if folders[0] == folders[1] || folders[0] == "lib" {
            continue;
        }
        let names = names.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        match folders.map(floor) {
            [Some(user_floor), Some(used_floor)] if used_floor < user_floor => {}
            [Some(_), Some(_)] => complaints.push(format!(
                "{user} uses {used}, which does not lie below {}: {names}",
                folders[0]
            )),
            _ => complaints.push(format!("{user} or {used} is in no folder that has a floor")),
        }
    }
    complaints
}

fn folder(path: &str) -> &str {
    path.split('/').next().unwrap_or(path).trim_end_matches(".rs")
}

fn floor(folder: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&folder))
}
