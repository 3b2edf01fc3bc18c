//! How far long work on the solver's thread has come.

/// How far a long preparation has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// 0 … 1.
    pub part: f32,
    /// One line.
    pub text: String,
}
