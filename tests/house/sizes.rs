//! How long files and functions are.

use proc_macro2::Span;
use syn::visit::Visit;
use syn::{Block, ImplItemFn, ItemFn, Signature, TraitItemFn};

/// A file has at most so many lines.
const LONGEST_FILE: usize = 300;
/// A function has at most so many lines, from its signature to its closing brace.
const LONGEST_FUNCTION: usize = 60;

/// One sentence for everything in a file that is too long.
pub fn complaints(path: &str, text: &str) -> Vec<String> {
    let mut functions = LongFunctions::default();
    match syn::parse_file(text) {
        Ok(file) => functions.visit_file(&file),
        Err(error) => panic!("{path}: {error}"),
    }
    let lines = text.lines().count();
    let file = (lines > LONGEST_FILE)
        .then(|| format!("{path} has {lines} lines; {LONGEST_FILE} are allowed"));
    let functions = functions.found.into_iter().map(|(name, lines)| {
        format!("{path}: {name} has {lines} lines; {LONGEST_FUNCTION} are allowed")
    });
    file.into_iter().chain(functions).collect()
}

#[derive(Default)]
struct LongFunctions {
    found: Vec<(String, usize)>,
}

impl LongFunctions {
    fn look_at(&mut self, signature: &Signature, block: &Block) {
        let line = |span: Span| span.start().line;
        let lines = line(block.brace_token.span.close()) - line(signature.fn_token.span) + 1;
        if lines > LONGEST_FUNCTION {
            self.found.push((signature.ident.to_string(), lines));
        }
    }
}

impl<'ast> Visit<'ast> for LongFunctions {
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.look_at(&item.sig, &item.block);
        syn::visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        self.look_at(&item.sig, &item.block);
        syn::visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast TraitItemFn) {
        if let Some(block) = &item.default {
            self.look_at(&item.sig, block);
        }
        syn::visit::visit_trait_item_fn(self, item);
    }
}
