//! Checks that imports have one direction: in each folder of a crate, the dependencies between its files and subfolders
//! form no cycle.
//!
//! A dependency is called an arrow here. It points from a file to the file that defines an item named by the first
//! file, in a `use` or in a path that begins with `crate`, `self` or `super`. Re-exports by a `mod.rs` or `lib.rs` are
//! followed to the defining file and are not arrows themselves. Test modules do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::visit::{self, Visit};
use syn::{Item, UseTree, Visibility};

type Module = Vec<String>;

/// Paths in a source file that lead to items of the file's own crate.
struct Imports<'a> {
    modules: &'a BTreeMap<Module, String>,
    own_names: &'a [&'a str],
    module: Module,
    /// Absolute paths of the items that the file names, without the name of the crate.
    paths: Vec<Module>,
    /// For each public `use`: the exported name (`*` for all names), and the absolute path of the item.
    exports: Vec<(String, Module)>,
    defined: BTreeSet<String>,
}

impl Imports<'_> {
    /// Returns the absolute form of a path that is written in the file, or `None` if the path leads to another crate.
    fn absolute(&self, path: &[String]) -> Option<Module> {
        let (first, mut rest) = path.split_first()?;
        let mut base = self.module.clone();
        match first.as_str() {
            "crate" => base.clear(),
            name if self.own_names.contains(&name) => base.clear(),
            "self" => {}
            "super" => {
                base.pop();
                while rest.first().is_some_and(|name| name == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            name => {
                base.push(name.to_owned());
                if !self.modules.contains_key(&base) {
                    return None;
                }
            }
        }
        base.extend(rest.iter().filter(|name| *name != "self").cloned());
        Some(base)
    }

    fn add_tree(&mut self, tree: &UseTree, before: &mut Vec<String>, is_public: bool) {
        let mut leaf = |path: &[String], exported: String| {
            if let Some(path) = self.absolute(path) {
                if is_public {
                    self.exports.push((exported, path.clone()));
                }
                self.paths.push(path);
            }
        };
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.add_tree(&path.tree, before, is_public);
                before.pop();
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.add_tree(tree, before, is_public);
                }
            }
            UseTree::Name(name) => {
                before.push(name.ident.to_string());
                leaf(before, name.ident.to_string());
                before.pop();
            }
            UseTree::Rename(rename) => {
                before.push(rename.ident.to_string());
                leaf(before, rename.rename.to_string());
                before.pop();
            }
            UseTree::Glob(_) => leaf(before, "*".to_owned()),
        }
    }
}

impl<'ast> Visit<'ast> for Imports<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        let name = match item {
            // Omits test modules. The modules of other files have no content here.
            Item::Mod(_) => return,
            Item::Use(used) => {
                let is_public = !matches!(used.vis, Visibility::Inherited);
                return self.add_tree(&used.tree, &mut Vec::new(), is_public);
            }
            Item::Struct(it) => Some(&it.ident),
            Item::Enum(it) => Some(&it.ident),
            Item::Trait(it) => Some(&it.ident),
            Item::Fn(it) => Some(&it.sig.ident),
            Item::Const(it) => Some(&it.ident),
            Item::Type(it) => Some(&it.ident),
            _ => None,
        };
        self.defined.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {
        // A visibility such as `pub(in super::super)` is not a dependency.
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let names: Vec<_> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if names.len() > 1 && ["crate", "self", "super"].contains(&names[0].as_str()) {
            self.paths.extend(self.absolute(&names));
        }
        visit::visit_path(self, path);
    }
}

fn module_of(file: &str) -> Module {
    let mut module: Module = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    if module.last().is_some_and(|name| ["mod", "lib", "main"].contains(&name.as_str())) {
        module.pop();
    }
    module
}

/// Returns the module that defines the item of an absolute path: the deepest module on the path, or the target of its
/// re-export.
fn definer(path: &[String], imports: &BTreeMap<Module, Imports<'_>>, depth: u32) -> Option<Module> {
    let length = (0..=path.len()).rev().find(|&length| imports.contains_key(&path[..length]))?;
    let (module, rest) = path.split_at(length);
    let (Some((name, rest)), true) = (rest.split_first(), depth > 0) else {
        return Some(module.to_vec());
    };
    for (exported, target) in &imports[module].exports {
        let leads_on = match exported.as_str() {
            "*" => imports.get(target).is_some_and(|it| it.defined.contains(name)),
            exported => exported == name && target != path,
        };
        if leads_on {
            let item = (exported == "*").then_some(name);
            let target: Vec<_> = target.iter().chain(item).chain(rest).cloned().collect();
            return definer(&target, imports, depth - 1);
        }
    }
    Some(module.to_vec())
}

/// Returns all arrows between the files of a crate. An arrow is an import: (file that imports, file that defines the
/// imported item). `sources` contains the files by their names relative to the folder `src`.
pub fn arrows(
    sources: &BTreeMap<String, String>,
    own_names: &[&str],
) -> BTreeSet<(String, String)> {
    let modules: BTreeMap<_, _> =
        sources.keys().map(|file| (module_of(file), file.clone())).collect();
    let imports: BTreeMap<_, _> = modules
        .iter()
        .map(|(module, file)| {
            let mut found = Imports {
                modules: &modules,
                own_names,
                module: module.clone(),
                paths: Vec::new(),
                exports: Vec::new(),
                defined: BTreeSet::new(),
            };
            let text = syn::parse_file(&sources[file]).unwrap_or_else(|it| panic!("{file}: {it}"));
            found.visit_file(&text);
            (module.clone(), found)
        })
        .collect();
    let mut arrows = BTreeSet::new();
    for (module, found) in &imports {
        let from = &modules[module];
        let composes = Path::new(from).ends_with("mod.rs") || Path::new(from).ends_with("lib.rs");
        for path in &found.paths {
            let is_export = composes && found.exports.iter().any(|(_, target)| target == path);
            if let Some(to) = definer(path, &imports, 8).filter(|_| !is_export) {
                arrows.insert((from.clone(), modules[&to].clone()));
            }
        }
    }
    arrows.retain(|(from, to)| from != to);
    arrows
}

/// Returns a description of each cycle of imports: the folder, and the imports between its files and subfolders that form
/// the cycle. An arrow is an import, from the importing file to the imported file.
pub fn circles(arrows: &BTreeSet<(String, String)>) -> Vec<String> {
    let files = arrows.iter().flat_map(|(from, to)| [from, to]);
    let folders: BTreeSet<&str> = files
        .flat_map(|file| file.match_indices('/').map(|(at, _)| &file[..=at]))
        .chain([""])
        .collect();
    let mut circles = Vec::new();
    for folder in folders {
        let child = |file: &'_ str| Some(file.strip_prefix(folder)?.split('/').next()?.to_owned());
        let mut between = BTreeMap::<String, BTreeMap<String, &(String, String)>>::new();
        for arrow in arrows {
            if let (Some(from), Some(to)) = (child(&arrow.0), child(&arrow.1))
                && from != to
            {
                between.entry(from).or_default().insert(to, arrow);
            }
        }
        let reaches = |from: &str, to: &str| {
            let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
            while let Some(at) = left.pop() {
                if at == to {
                    return true;
                }
                if seen.insert(at) {
                    left.extend(between.get(at).into_iter().flatten().map(|(to, _)| to.as_str()));
                }
            }
            false
        };
        for (from, (to, (file, other))) in
            between.iter().flat_map(|(from, targets)| targets.iter().map(move |it| (from, it)))
        {
            if reaches(to, from) {
                circles.push(format!("{folder}: {from} → {to}, as {file} names {other}"));
            }
        }
    }
    circles
}
