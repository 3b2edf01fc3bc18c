//! Which file uses what of which other: paths in code, types, attributes and macros, and imports.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::Visit;
use syn::{
    Attribute, ImplItemFn, Item, ItemConst, ItemEnum, ItemFn, ItemImpl, ItemMod, ItemStatic,
    ItemStruct, ItemTrait, ItemType, ItemUse, Macro, Meta, UseTree, Visibility,
};

use super::modules::{House, Place};

/// For each pair of files, user first, the paths by which the one uses the other.
pub type Uses = BTreeMap<(String, String), BTreeSet<String>>;

/// What the files of a crate use of each other, apart from the files that `skip` names.
pub fn between_files(house: &House, skip: impl Fn(&str) -> bool) -> Uses {
    let mut uses = Uses::new();
    for (index, module) in house.modules.iter().enumerate() {
        let user = &house.files[module.file];
        if skip(user) {
            continue;
        }
        let mut paths = Paths::default();
        module.items.iter().for_each(|item| paths.visit_item(item));
        for Path { segments, re_export } in paths.found {
            for place in house.resolve(index, &segments) {
                let Place::Item(file) = place else { continue };
                let used = &house.files[file];
                if used != user && !(re_export && is_face_of(user, used)) {
                    let names = uses.entry((user.clone(), used.clone())).or_default();
                    names.insert(segments.join("::"));
                }
            }
        }
    }
    uses
}

/// Whether a file is the `mod.rs` of a folder that the other lies in: what it re-exports of that is
/// the folder's face.
fn is_face_of(user: &str, used: &str) -> bool {
    let folder = user.strip_suffix("mod.rs").or_else(|| user.strip_suffix("lib.rs"));
    folder.is_some_and(|folder| used.starts_with(folder))
}

/// A path that an import brings in.
pub struct Import {
    /// From where.
    pub path: Vec<String>,
    /// What it is called here; nothing for a glob.
    pub name: Option<String>,
}

/// What a `use` declaration brings in.
pub fn imports(item: &ItemUse) -> Vec<Import> {
    let mut found = Vec::new();
    if item.leading_colon.is_none() {
        collect_imports(&item.tree, &mut Vec::new(), &mut found);
    }
    found
}

fn collect_imports(tree: &UseTree, path: &mut Vec<String>, found: &mut Vec<Import>) {
    let length = path.len();
    let (last, name) = match tree {
        UseTree::Path(step) => {
            path.push(step.ident.to_string());
            collect_imports(&step.tree, path, found);
            path.truncate(length);
            return;
        }
        UseTree::Group(group) => {
            group.items.iter().for_each(|tree| collect_imports(tree, path, found));
            return;
        }
        UseTree::Glob(_) => return found.push(Import { path: path.clone(), name: None }),
        UseTree::Name(name) => (name.ident.to_string(), name.ident.to_string()),
        UseTree::Rename(name) => (name.ident.to_string(), name.rename.to_string()),
    };
    let (path, name) = match (last.as_str(), path.last()) {
        ("self", Some(parent)) if name == "self" => (path.clone(), parent.clone()),
        ("self", Some(_)) => (path.clone(), name),
        _ => (path.iter().cloned().chain([last]).collect(), name),
    };
    found.push(Import { path, name: Some(name) });
}

/// Whether something is compiled for tests alone.
pub fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if attribute.path().is_ident("cfg") => {
            let predicate = list.tokens.to_string();
            predicate.split(|letter: char| !letter.is_alphanumeric()).any(|word| word == "test")
        }
        _ => false,
    })
}

struct Path {
    segments: Vec<String>,
    re_export: bool,
}

/// Collects the paths of a module's own code.
#[derive(Default)]
struct Paths {
    found: Vec<Path>,
}

impl Paths {
    fn add(&mut self, segments: Vec<String>) {
        self.found.push(Path { segments, re_export: false });
    }

    /// Paths in what a macro or an attribute is given, which need not be Rust.
    fn scan(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut before = String::new();
        for token in tokens {
            match token {
                TokenTree::Ident(name) if before == "::" => {
                    // Without a beginning it goes on behind generic arguments or leaves the crate.
                    if !path.is_empty() {
                        path.push(name.to_string());
                    }
                    before.clear();
                }
                TokenTree::Ident(name) => {
                    self.add(std::mem::take(&mut path));
                    if before != "." && before != "'" {
                        path.push(name.to_string());
                    }
                    before.clear();
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' && before == ":" => {
                    before.push(':');
                }
                TokenTree::Punct(mark) => {
                    if mark.as_char() != ':' {
                        self.add(std::mem::take(&mut path));
                    }
                    before = mark.to_string();
                }
                TokenTree::Group(group) => {
                    self.add(std::mem::take(&mut path));
                    self.scan(group.stream());
                    before.clear();
                }
                TokenTree::Literal(_) => before.clear(),
            }
        }
        self.add(path);
    }
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item(&mut self, item: &'ast Item) {
        let (Item::Const(ItemConst { attrs, .. })
        | Item::Enum(ItemEnum { attrs, .. })
        | Item::Fn(ItemFn { attrs, .. })
        | Item::Impl(ItemImpl { attrs, .. })
        | Item::Static(ItemStatic { attrs, .. })
        | Item::Struct(ItemStruct { attrs, .. })
        | Item::Trait(ItemTrait { attrs, .. })
        | Item::Type(ItemType { attrs, .. })
        | Item::Use(ItemUse { attrs, .. })) = item
        else {
            return syn::visit::visit_item(self, item);
        };
        if !is_for_tests(attrs) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        if !is_for_tests(&item.attrs) {
            syn::visit::visit_impl_item_fn(self, item);
        }
    }

    // Modules are visited by themselves.
    fn visit_item_mod(&mut self, _: &'ast ItemMod) {}

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let re_export = !matches!(item.vis, Visibility::Inherited);
        let imports = imports(item).into_iter();
        self.found.extend(imports.map(|Import { path, .. }| Path { segments: path, re_export }));
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.leading_colon.is_none() {
            self.add(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        self.visit_path(&call.path);
        self.scan(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let Meta::List(list) = &attribute.meta {
            self.scan(list.tokens.clone());
        }
    }
}
