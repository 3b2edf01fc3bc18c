//! The rules, tried on a small house that breaks them.

use std::collections::{BTreeMap, BTreeSet};

use super::circles::Circles;
use super::modules::House;
use super::uses::{Uses, between_files};
use super::{floors, rooms, sizes};

fn uses(files: &[(&str, &str)]) -> Uses {
    let sources: BTreeMap<String, String> =
        files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect();
    between_files(&House::build(&sources), |_| false)
}

/// Pairs of files, user first.
fn pairs(uses: &Uses) -> Vec<(&str, &str)> {
    uses.keys().map(|(user, used)| (user.as_str(), used.as_str())).collect()
}

#[test]
fn a_circle_through_a_re_export_is_found() {
    let uses = uses(&[
        ("lib.rs", "pub mod a; pub mod b;"),
        ("a/mod.rs", "mod deep; mod other; pub use deep::Deep; pub use other::*;"),
        ("a/deep.rs", "use crate::b::helper; pub struct Deep; impl Deep { fn go() { helper() } }"),
        ("a/other.rs", "pub struct Other;"),
        ("b.rs", "use crate::a; pub fn helper() { let _ = (a::Deep, a::Other); }"),
    ]);
    assert_eq!(
        pairs(&uses),
        [("a/deep.rs", "b.rs"), ("b.rs", "a/deep.rs"), ("b.rs", "a/other.rs")]
    );
    let circles = Circles::of(&uses);
    assert_eq!(circles.sets(), [BTreeSet::from(["a/deep.rs", "b.rs"])]);
    let told = circles.to_string();
    assert!(told.contains("a/deep.rs -> b.rs: crate::b::helper"), "{told}");
    assert!(told.contains("b.rs -> a/deep.rs: a::Deep"), "{told}");
    assert!(!told.contains("a/other.rs"), "{told}");
}

#[test]
fn the_smallest_of_several_circles_is_told_first() {
    let uses = uses(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "pub struct A(super::b::B);"),
        ("b.rs", "pub struct B(crate::c::C);"),
        ("c.rs", "use crate::{a::A, b}; pub struct C { a: A, b: Vec<b::B> }"),
    ]);
    let circles = Circles::of(&uses);
    let [set] = circles.sets() else { panic!("{circles}") };
    assert_eq!(set.len(), 3);
    assert_eq!(circles.smallest(set), ["b.rs", "c.rs"]);
}

#[test]
fn what_is_no_use_is_not_counted() {
    let uses = uses(&[
        ("lib.rs", "pub mod face; mod user; use face::Part;"),
        (
            "face/mod.rs",
            "mod part; pub use part::Part; pub use part::{self as renamed, Part as Same};",
        ),
        (
            "face/part.rs",
            "pub struct Part; #[cfg(all(test, feature = \"gpu\"))] mod tests { use crate::user::User; }
             #[cfg(test)] use crate::user::User; #[cfg(test)] mod more;
             impl Part { #[cfg(test)] fn test() { crate::user::User; } }
             pub(in crate::face) fn local(user: f64) -> f64 { user.max(::std::f64::MAX) }",
        ),
        ("face/more.rs", "use crate::user::User;"),
        ("user.rs", "pub struct User;"),
    ]);
    assert_eq!(pairs(&uses), [("lib.rs", "face/part.rs")]);
}

#[test]
fn uses_are_found_wherever_they_stand() {
    let user = |text: &str| {
        let uses = uses(&[
            ("lib.rs", "pub mod a; mod user;"),
            (
                "a/mod.rs",
                "mod b; pub use b::B as Renamed; pub use b::*; pub use inner::*; mod inner;",
            ),
            ("a/b.rs", "pub enum B { One } pub const LIMIT: u32 = 1; pub fn call() {}"),
            ("a/inner.rs", "pub use super::b::*; pub use crate::a::*;"),
            ("user.rs", text),
        ]);
        pairs(&uses).contains(&("user.rs", "a/b.rs"))
    };
    for text in [
        "use crate::a::Renamed;",
        "use crate::a::{Renamed as Again};",
        "use super::a::*; fn f() -> Renamed { todo!() }",
        "fn f(b: &crate::a::B) {}",
        "fn f() { crate::a::call(); }",
        "fn f() { use crate::a; a::B::One; }",
        "use crate::a; fn f() { println!(\"{}\", a::LIMIT); }",
        "use crate::a; #[arg(default_value_t = a::LIMIT)] struct S;",
        "use crate::a::{self as other}; impl S { const X: u32 = other::LIMIT; }",
        "mod inline { use super::super::a::B; }",
        "macro_rules! m { () => { $crate::a::call() } }",
        "impl From<crate::a::B> for u32 {}",
        "use crate::a::inner::LIMIT;",
    ] {
        assert!(user(text), "{text}");
    }
    for text in ["use crate::a;", "use ::a::B;", "use crate::a::nothing;", "fn f() { x.call(); }"] {
        assert!(!user(text), "{text}");
    }
}

#[test]
fn a_use_that_points_upward_is_told() {
    let uses = uses(&[
        ("lib.rs", "mod error; mod scene; mod world; mod shed; use shed::Shed;"),
        ("error.rs", "pub struct Error;"),
        ("world/mod.rs", "use crate::error::Error; use crate::scene::Scene;"),
        ("scene.rs", "pub struct Scene; use crate::shed::Shed;"),
        ("shed.rs", "pub struct Shed;"),
    ]);
    let complaints = floors::complaints(&uses);
    let expected = [
        "scene.rs or shed.rs is in no folder that has a floor",
        "world/mod.rs uses scene.rs, which does not lie below world: crate::scene::Scene",
    ];
    assert_eq!(complaints, expected);
}

#[test]
fn a_room_without_a_door_and_one_without_a_row_are_told() {
    let files = [
        ("lib.rs", "mod a; mod list;"),
        ("list.rs", "const ALL: [Row; 1] = [Row { make: || listed(1) }];"),
        ("a/mod.rs", "mod one; mod two;"),
        ("a/one.rs", "pub fn listed(n: u32) {} fn helper() {}"),
        ("a/two.rs", "pub fn forgotten() {}"),
        ("a/three.rs", "pub fn listed(n: u32) {}"),
    ];
    let sources = files.map(|(path, text)| (path.to_owned(), text.to_owned())).into();
    assert_eq!(rooms::without_a_door(&sources), ["a/three.rs"]);
    assert_eq!(rooms::without_a_row(&sources, "a/", "list.rs"), ["a/two.rs"]);
}

#[test]
fn what_is_too_long_is_named() {
    let text = |lines: usize| {
        let body = "f();\n".repeat(lines - 3);
        format!("impl S {{\n/// Doc.\npub fn long(\n) {{\n{body}}}\n}}\n")
    };
    assert!(sizes::complaints("a.rs", &text(60)).is_empty());
    assert_eq!(sizes::complaints("a.rs", &text(61)), ["a.rs: long has 61 lines; 60 are allowed"]);
    assert!(sizes::complaints("a.rs", &"\n".repeat(300)).is_empty());
    assert_eq!(
        sizes::complaints("a.rs", &"\n".repeat(301)),
        ["a.rs has 301 lines; 300 are allowed"]
    );
}
