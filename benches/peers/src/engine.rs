//! Interface and settings of all engines that this benchmark compares.

/// Settings of a game engine.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Simulated time that one call of `step` advances, s.
    pub time_step_secs: f64,
    /// Number of substeps in one call of `step`.
    pub substeps: u32,
    /// Stiffness of contacts as a frequency, Hz. Engines lower this frequency if a substep is too long for it.
    pub contact_hertz: f32,
}

/// Overlap that an engine does not push out (its *slop*), in mean diameters.
pub const SLOP_IN_DIAMETERS: f64 = 5e-4;

/// A pile in an engine, advanced step by step.
pub trait Engine {
    /// Advances the pile by one time step of the setting.
    fn step(&mut self);
    /// Returns the centres of the grains, m.
    fn positions(&mut self) -> Vec<[f64; 2]>;
}
