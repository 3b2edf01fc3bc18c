//! Interface and settings that all compared engines share.

/// Settings of a game engine.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Time of one call, s.
    pub time_step_secs: f64,
    /// Substeps of one call.
    pub substeps: u32,
    /// Stiffness of contacts as a frequency, Hz. Engines lower it if a substep is too long.
    pub contact_hertz: f32,
}

/// Overlap that an engine does not push out, in diameters (its *slop*).
pub const SLOP_IN_DIAMETERS: f64 = 5e-4;

/// A pile in an engine.
pub trait Engine {
    /// Advances by one time step of the setting.
    fn step(&mut self);
    /// Centres of the grains, m.
    fn positions(&mut self) -> Vec<[f64; 2]>;
}
