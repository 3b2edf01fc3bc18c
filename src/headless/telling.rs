//! What is said of a run, and whether it goes on.

use std::ops::ControlFlow;

use crate::error::{Error, legible};
use crate::output::{Signal, caught_signal, note_line};
use crate::scene::Scene;
use crate::sim::{Alarm, AlarmKind, Observables, Simulation, Tally};
use crate::solver::Method;

/// Whether a run goes on: until a signal comes.
pub(super) fn go_on() -> ControlFlow<()> {
    caught_signal().map_or(ControlFlow::Continue(()), |_| ControlFlow::Break(()))
}

/// That a signal ended the run after its last step.
pub(super) fn interrupted(signal: Signal, last: &Observables) -> Error {
    let (signal, exit_code) = (signal.name(), signal.exit_code());
    Error::Interrupted { signal, exit_code, step: last.step, time_secs: last.time_secs }
}

/// Says on stderr what went wrong, and what is most likely to help. A state that is no longer finite
/// ends the run with an error of its own.
pub(super) fn tell_of_alarms(scene: &Scene, alarms: &[Alarm]) {
    for alarm in alarms.iter().filter(|alarm| alarm.kind != AlarmKind::NotFinite) {
        note_line(format_args!("{}: {}", scene.name, alarm.message(&scene.settings())));
    }
}

/// Says on stderr how many steps were not solved as asked.
pub(super) fn tell_of_unconverged_steps(scene: &Scene, tally: &Tally) {
    if tally.unconverged_steps > 0 {
        let instead = match tally.fallback_steps {
            0 => String::new(),
            steps => {
                format!(", {steps} fell back on bounds of friction, solved with a certificate")
            }
        };
        note_line(legible(&format!(
            "{} (Bond {}, time step {} s): {} of {} steps did not reach tolerance {:e} within {} \
             sweeps, {} of them stalled (more sweeps would be of no use){}; largest residual {:.1e}",
            scene.name,
            scene.parameters.bond,
            scene.parameters.time_step_secs,
            tally.unconverged_steps,
            tally.steps,
            scene.solver.tolerance,
            scene.solver.max_sweeps,
            tally.stalled_steps,
            instead,
            tally.largest_residual
        )));
    }
}

/// Says on stderr which method `auto` took at last.
pub(super) fn tell_of_picked_method(scene: &Scene, simulation: &Simulation) {
    if scene.solver.method == Method::Auto {
        let contacts = simulation.contacts_together();
        let name = simulation.picked_method().name();
        let of = if scene.solver.islands { " of the largest island" } else { "" };
        note_line(format_args!("auto took {name} for {contacts} contacts{of}"));
    }
}
