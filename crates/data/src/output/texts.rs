//! What files say of themselves.

/// Keywords and texts, in their order. Keywords are ASCII, at most 79 characters: PNG has no others.
#[derive(Clone, Debug, PartialEq)]
pub struct Texts(Vec<(String, String)>);

impl Default for Texts {
    /// The program and its version alone.
    fn default() -> Self {
        let program = concat!("slump ", env!("CARGO_PKG_VERSION"));
        Self(vec![("Software".into(), program.into())])
    }
}

impl Texts {
    /// Says one thing more.
    pub fn add(&mut self, keyword: impl Into<String>, text: impl Into<String>) {
        self.0.push((keyword.into(), text.into()));
    }

    /// The text of a keyword.
    #[cfg(test)]
    pub(crate) fn get(&self, keyword: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == keyword).map(|(_, text)| text.as_str())
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(keyword, text)| (keyword.as_str(), text.as_str()))
    }

    /// A line each: keyword, colon, text.
    pub fn lines(&self) -> String {
        self.iter().map(|(keyword, text)| format!("{keyword}: {text}\n")).collect()
    }
}
