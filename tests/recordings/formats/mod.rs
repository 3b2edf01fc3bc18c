//! Tests of recordings for ParaView and OVITO: their contents, and that they are complete at every time. The scripts in
//! `tests/clients/` read such recordings with ParaView and OVITO.

mod vtp;
mod whole;

use std::path::Path;
use std::sync::Arc;

use glam::DVec2;
use slump::data::{FormatName, Recording, RecordingMark, RunFacts};
use slump::sim::{
    ContactState, ContactStatus, GrainState, Moment, Observables, OtherBody, Settings, Surroundings,
};
use slump::world::{Boundary, Disc};

/// A number whose shortest exact decimal form needs all digits of a double.
const THIRD: f64 = 1.0 / 3.0;

fn about() -> RunFacts {
    RunFacts {
        facts: vec![("program".into(), "slump".into()), ("bond".into(), "20 <&> 30".into())],
    }
}

/// Returns a handmade state of three grains on a floor and on a disc that is not a grain. One grain is marked as lost
/// (it has left the scene).
fn moment(step: u64) -> Moment {
    let grain = |id: u32, x: f64, y: f64, radius: f64| GrainState {
        id,
        position: DVec2::new(x, y),
        unwrapped: DVec2::new(x, y),
        angle: -0.0,
        velocity: DVec2::new(THIRD, -2e-9),
        angular_velocity: 1e22,
        radius,
        mass: 0.125,
        feels_gravity: true,
        tone: 0,
        material: 0,
        lost: false,
    };
    let lost = GrainState { lost: true, ..grain(2, -1e6, 0.0, 0.5) };
    let contact = ContactState {
        grain: 0,
        other: OtherBody::Grain(1),
        normal: -DVec2::X,
        gap: -5e-324,
        point: DVec2::new(0.5, 0.25),
        branch: -DVec2::X,
        force: DVec2::new(-THIRD, 1.5),
        normal_force: THIRD,
        tangential_force: -1.5,
        status: ContactStatus::Slip,
        bond_stretch: None,
        age_steps: step,
    };
    let on_disc = ContactState { other: OtherBody::FixedDisc(0), normal: DVec2::Y, ..contact };
    let on_floor =
        ContactState { grain: 1, other: OtherBody::Boundary(0), branch: 0.5 * DVec2::Y, ..on_disc };
    let surroundings = Surroundings {
        fixed_discs: vec![Disc { position: DVec2::new(0.0, -1.0), radius: 0.75 }],
        boundaries: vec![Boundary::HalfSpace { point: DVec2::ZERO, normal: DVec2::Y }],
        centre_of_attraction: None,
        periodic: None,
        materials: Vec::new(),
        mean_diameter: 1.0,
        gravity_magnitude: 9.8,
        moving: Vec::new(),
    };
    Moment {
        observables: Observables { step, time_secs: step as f64 * 0.1, ..Observables::default() },
        settings: Settings::default(),
        grains: vec![grain(0, 0.0, 0.25, 0.5), grain(1, 1.0, 0.25, THIRD), lost],
        contacts: vec![contact, on_disc, on_floor],
        surroundings: Arc::new(surroundings),
        first_fixed_id: 3,
    }
}

/// Checks that a text begins with the lines of a pattern, and returns the rest of the text. In the pattern, a line `…`
/// matches any number of lines, and `…` at the end of a line matches the rest of that line.
fn after<'a>(mut text: &'a str, pattern: &str) -> &'a str {
    let mut skips = false;
    for wanted in pattern.lines() {
        if wanted == "…" {
            skips = true;
            continue;
        }
        loop {
            let (line, rest) = text.split_once('\n').unwrap_or_else(|| panic!("no {wanted}"));
            text = rest;
            let is_it = match wanted.strip_suffix('…') {
                Some(beginning) => line.starts_with(beginning),
                None => line == wanted,
            };
            if is_it {
                break;
            }
            assert!(skips, "{line}\nis not\n{wanted}");
        }
        skips = false;
    }
    text
}

const FORMATS: &[FormatName] = &[FormatName::Vtk, FormatName::Ovito, FormatName::Fields];

fn start(folder: &Path) -> Recording {
    Recording::start(folder, FORMATS, &about(), false).expect("a recording")
}

/// Resumes a recording at a step number. The recording keeps the frames up to this step that are complete in every
/// format.
fn go_on(folder: &Path, step: u64) -> Recording {
    let index = std::fs::read_to_string(folder.join("frames.csv")).unwrap_or_default();
    let whole = index.rfind('\n').map_or("", |end| &index[..end]);
    let steps = whole.lines().filter_map(|row| row.split(',').next()?.parse::<u64>().ok());
    let frames = steps.filter(|&there| there <= step).count() as u64;
    let mark = RecordingMark { frames, ..RecordingMark::default() };
    Recording::go_on(folder, FORMATS, &about(), step, &mark).expect("a recording to go on with")
}

/// Records frames with these numbers. Frame n shows the state after step 10 n.
fn write_frames(recording: &mut Recording, numbers: std::ops::Range<u64>) {
    for number in numbers {
        recording.add(moment(10 * number)).expect("a frame");
    }
    recording.flush().expect("frames");
}
