//! The orders in which a sweep can visit the contacts.

use crate::setting::words;

words! {
    /// The order of a sweep.
    #[derive(Default)]
    pub enum Ordering {
        /// Alternating between distant stretches of the order of detection: the fastest sweep.
        #[default]
        Interleaved = "interleaved", "distant contacts in turn: the fastest sweep";
        /// As detected: sorted by grain i, then by j.
        Detected = "detected", "as detected: sorted by grain";
        /// From the lowest contact against gravity to the highest.
        BottomUp = "bottom-up", "from the lowest contact to the highest";
        /// Interleaved, every second sweep backward.
        Symmetric = "symmetric", "interleaved, every second sweep backward";
        /// By colours: no two contacts of a colour share a grain.
        Coloured = "coloured", "contacts that share no grain follow each other";
    }
}
