//! Whether every file is lived in.

use std::collections::BTreeMap;

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::Visit;
use syn::{Ident, ItemFn, ItemMod};

/// Files of `src/` that no `mod` names: they are not compiled.
pub fn without_a_door(sources: &BTreeMap<String, String>) -> Vec<String> {
    let mut known = vec!["lib.rs".to_owned(), "main.rs".to_owned()];
    for (path, text) in sources {
        let folder = path.trim_end_matches("lib.rs").trim_end_matches("mod.rs");
        let folder =
            folder.strip_suffix(".rs").map_or(folder.to_owned(), |stem| format!("{stem}/"));
        let mut modules = Modules::default();
        if let Ok(file) = syn::parse_file(text) {
            modules.visit_file(&file);
        }
        let beside =
            |name: &Ident| [format!("{folder}{name}.rs"), format!("{folder}{name}/mod.rs")];
        known.extend(modules.found.iter().flat_map(beside));
    }
    sources.keys().filter(|path| !known.contains(path)).cloned().collect()
}

#[derive(Default)]
struct Modules {
    found: Vec<Ident>,
}

impl<'ast> Visit<'ast> for Modules {
    fn visit_item_mod(&mut self, item: &'ast ItemMod) {
        self.found.push(item.ident.clone());
    }
}

/// Files of a folder none of whose functions the registry names.
pub fn without_a_row(
    sources: &BTreeMap<String, String>,
    folder: &str,
    registry: &str,
) -> Vec<String> {
    let mut named = Vec::new();
    let tokens: TokenStream = sources[registry].parse().unwrap();
    collect_words(tokens, &mut named);
    let is_missed = |(path, text): &(&String, &String)| {
        let Ok(file) = syn::parse_file(text) else { return true };
        let names = file.items.iter().filter_map(|item| match item {
            syn::Item::Fn(ItemFn { sig, .. }) => Some(sig.ident.to_string()),
            _ => None,
        });
        path.starts_with(folder)
            && !path.ends_with("mod.rs")
            && !names.into_iter().any(|name| named.contains(&name))
    };
    sources.iter().filter(is_missed).map(|(path, _)| path.clone()).collect()
}

fn collect_words(tokens: TokenStream, words: &mut Vec<String>) {
    for token in tokens {
        match token {
            TokenTree::Group(group) => collect_words(group.stream(), words),
            TokenTree::Ident(word) => words.push(word.to_string()),
            TokenTree::Punct(_) | TokenTree::Literal(_) => {}
        }
    }
}
