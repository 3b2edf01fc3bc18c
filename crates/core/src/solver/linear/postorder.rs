//! The same elimination in an order that keeps together what works on the same numbers.
//!
//! The parent of a place is the first of its later neighbours: the one that its elimination changes next. These are
//! trees, and any order that has every place before its parent makes the same factors with the same fill. In one that
//! finishes a subtree before it begins the next, what a place changes was made not long ago, and places whose
//! neighbours are alike follow each other (J. W. H. Liu, 1990).

const NONE: u32 = u32::MAX;

/// What it takes; memory is kept between orders.
#[derive(Clone, Debug, Default)]
pub(super) struct Postorder {
    /// By place: a child, and the next one of the same parent.
    first_child: Vec<u32>,
    next_child: Vec<u32>,
    /// By place: the child with the most later neighbours, which comes right before its parent.
    heir: Vec<u32>,
    /// By place: how many later neighbours its heir has.
    most: Vec<usize>,
    stack: Vec<u32>,
    /// The places in their new order, last first.
    pub reversed: Vec<u32>,
}

impl Postorder {
    /// Orders places whose parents (none: no later neighbour) and numbers of later neighbours are given.
    pub(super) fn arrange(&mut self, parents: impl ExactSizeIterator<Item = (Option<u32>, usize)>) {
        let Self { first_child, next_child, heir, most, stack, reversed } = self;
        for links in [&mut *first_child, next_child, heir] {
            links.clear();
            links.resize(parents.len(), NONE);
        }
        most.clear();
        most.resize(parents.len(), 0);
        stack.clear();
        reversed.clear();
        for (place, (parent, neighbours)) in parents.enumerate() {
            let child = place as u32;
            let Some(parent) = parent else {
                stack.push(child);
                continue;
            };
            let parent = parent as usize;
            next_child[place] = std::mem::replace(&mut first_child[parent], child);
            if heir[parent] == NONE || neighbours >= most[parent] {
                (heir[parent], most[parent]) = (child, neighbours);
            }
        }
        // Every place before its children, the heir first of them; and then all of it backwards.
        while let Some(place) = stack.pop() {
            reversed.push(place);
            let heir = heir[place as usize];
            let mut child = first_child[place as usize];
            while child != NONE {
                if child != heir {
                    stack.push(child);
                }
                child = next_child[child as usize];
            }
            if heir != NONE {
                stack.push(heir);
            }
        }
    }
}
