//! How a number of a row is plotted against simulated time.

/// Something to plot of rows of a kind.
#[derive(Clone, Copy, Debug)]
pub struct Quantity<Row: 'static> {
    /// Its name on buttons.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// Its unit, if that takes prefixes such as k.
    pub unit: &'static str,
    /// Whether equal distances are equal factors.
    pub logarithmic: bool,
    /// Its value.
    pub value: fn(&Row) -> f64,
    /// What is shown beside it where there is any, the first dashed and the second dotted: names and values.
    pub beside: &'static [Beside<Row>],
}

/// Name and value.
pub type Beside<Row> = (&'static str, fn(&Row) -> Option<f64>);

impl<Row> Quantity<Row> {
    /// Without a unit, on a linear axis, alone.
    pub const PLAIN: Self = Self {
        name: "",
        title: "",
        unit: "",
        logarithmic: false,
        value: |_| f64::NAN,
        beside: &[],
    };
}
