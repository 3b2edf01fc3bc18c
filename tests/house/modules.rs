//! The modules of a crate, the names that each makes visible, and what a path from one of them means.
//!
//! Reads less of the language than a compiler: no name that a macro makes, and no method, for which
//! types would be needed. A re-export, a glob and a renaming are followed to the file that defines
//! the item.

use std::collections::{BTreeMap, HashMap};

use syn::visit::Visit;
use syn::{Item, ItemMod, ItemUse};

use super::uses::{Import, imports, is_for_tests};

/// Re-exports of re-exports are followed so far; globs that import each other would never end.
const LONGEST_CHAIN: usize = 16;

/// A crate without its tests.
#[derive(Default)]
pub struct House {
    /// Paths of the files, from the root of the crate.
    pub files: Vec<String>,
    /// All modules; the first is the crate's root.
    pub modules: Vec<Module>,
}

/// A module, inline or a file.
pub struct Module {
    /// Index of the file that it stands in.
    pub file: usize,
    /// What it consists of.
    pub items: Vec<Item>,
    parent: Option<usize>,
    names: HashMap<String, Vec<Meaning>>,
    globs: Vec<Vec<String>>,
}

/// What a name stands for. Types, values and macros may share one.
enum Meaning {
    Defined,
    Module(usize),
    Imported(Vec<String>),
}

/// What a path leads to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// A module.
    Module(usize),
    /// An item, by the file that defines it.
    Item(usize),
}

impl House {
    /// The crate whose root is `lib.rs`.
    pub fn build(sources: &BTreeMap<String, String>) -> Self {
        let mut house = Self::default();
        house.add_file(sources, "lib.rs", None, "");
        house
    }

    fn add_file(
        &mut self,
        sources: &BTreeMap<String, String>,
        path: &str,
        parent: Option<usize>,
        folder: &str,
    ) -> usize {
        let items = match syn::parse_file(&sources[path]) {
            Ok(file) => file.items,
            Err(error) => panic!("{path}: {error}"),
        };
        self.files.push(path.to_owned());
        self.add_module(sources, self.files.len() - 1, parent, folder, items)
    }

    /// Adds a module whose children have their files in `folder`, which ends in a slash unless empty.
    fn add_module(
        &mut self,
        sources: &BTreeMap<String, String>,
        file: usize,
        parent: Option<usize>,
        folder: &str,
        mut items: Vec<Item>,
    ) -> usize {
        let index = self.modules.len();
        let mut names = Names::default();
        items.iter().for_each(|item| names.visit_item(item));
        let Names { names, globs } = names;
        self.modules.push(Module { file, items: Vec::new(), parent, names, globs });
        for item in &mut items {
            let Item::Mod(declared @ ItemMod { .. }) = item else { continue };
            if is_for_tests(&declared.attrs) {
                continue;
            }
            let name = declared.ident.to_string();
            let inside = format!("{folder}{name}/");
            let child = match declared.content.take() {
                Some((_, items)) => self.add_module(sources, file, Some(index), &inside, items),
                None => {
                    let own_folder = format!("{inside}mod.rs");
                    let beside = format!("{folder}{name}.rs");
                    let path = if sources.contains_key(&beside) { beside } else { own_folder };
                    self.add_file(sources, &path, Some(index), &inside)
                }
            };
            self.modules[index].names.entry(name).or_default().push(Meaning::Module(child));
        }
        self.modules[index].items = items;
        index
    }

    /// What a path that stands in a module leads to; nothing where it leaves the crate.
    pub fn resolve(&self, from: usize, path: &[String]) -> Vec<Place> {
        self.follow(from, path, LONGEST_CHAIN)
    }

    fn follow(&self, from: usize, path: &[String], chain: usize) -> Vec<Place> {
        let Some((first, rest)) = path.split_first() else { return Vec::new() };
        let mut places = match first.as_str() {
            "crate" => vec![Place::Module(0)],
            "self" => vec![Place::Module(from)],
            "super" => self.modules[from].parent.map(Place::Module).into_iter().collect(),
            name => self.named(from, name, chain),
        };
        for name in rest {
            let step = |place| match place {
                Place::Module(module) if name == "super" => {
                    self.modules[module].parent.map(Place::Module).into_iter().collect()
                }
                Place::Module(module) => self.named(module, name, chain),
                // A variant or an associated item stands where its type stands.
                Place::Item(_) => vec![place],
            };
            places = places.into_iter().flat_map(step).collect();
        }
        places
    }

    /// What a name means in a module.
    fn named(&self, module: usize, name: &str, chain: usize) -> Vec<Place> {
        let Some(chain) = chain.checked_sub(1) else { return Vec::new() };
        let Module { file, names, globs, .. } = &self.modules[module];
        if let Some(meanings) = names.get(name) {
            let place = |meaning: &Meaning| match meaning {
                Meaning::Defined => vec![Place::Item(*file)],
                Meaning::Module(module) => vec![Place::Module(*module)],
                Meaning::Imported(path) => self.follow(module, path, chain),
            };
            return meanings.iter().flat_map(place).collect();
        }
        let through = |glob: &Vec<String>| self.follow(module, glob, chain);
        let modules = globs.iter().flat_map(through).filter_map(|place| match place {
            Place::Module(module) => Some(module),
            Place::Item(_) => None,
        });
        modules.flat_map(|module| self.named(module, name, chain)).collect()
    }
}

/// Collects what a module defines and imports, functions' own imports included.
#[derive(Default)]
struct Names {
    names: HashMap<String, Vec<Meaning>>,
    globs: Vec<Vec<String>>,
}

impl Names {
    fn add(&mut self, name: &syn::Ident, meaning: Meaning) {
        self.names.entry(name.to_string()).or_default().push(meaning);
    }
}

impl<'ast> Visit<'ast> for Names {
    fn visit_item(&mut self, item: &'ast Item) {
        let name = match item {
            Item::Const(item) => Some(&item.ident),
            Item::Enum(item) => Some(&item.ident),
            Item::Fn(item) => Some(&item.sig.ident),
            Item::Macro(item) => item.ident.as_ref(),
            Item::Static(item) => Some(&item.ident),
            Item::Struct(item) => Some(&item.ident),
            Item::Trait(item) => Some(&item.ident),
            Item::Type(item) => Some(&item.ident),
            Item::Union(item) => Some(&item.ident),
            _ => None,
        };
        if let Some(name) = name {
            self.add(name, Meaning::Defined);
        }
        syn::visit::visit_item(self, item);
    }

    fn visit_item_mod(&mut self, _: &'ast ItemMod) {}

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        if is_for_tests(&item.attrs) {
            return;
        }
        for Import { path, name } in imports(item) {
            match name {
                Some(name) => {
                    self.names.entry(name).or_default().push(Meaning::Imported(path));
                }
                None => self.globs.push(path),
            }
        }
    }
}
