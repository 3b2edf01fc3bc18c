//! Tries inputs one after the other. While an input is tried, a file contains it, so that it remains if the process
//! ends.

use std::io::Write;
use std::sync::{Arc, Mutex};

use super::Target;
use crate::program::*;

/// Time after which an input counts as a hang. It is longer than any input takes, even on a busy machine. On an idle
/// machine the slowest inputs take ten seconds: fifty long time steps of small grains, with a stepper that divides each
/// step into many substeps to remain stable.
const SLOWEST: Duration = Duration::from_secs(200);

/// Tries inputs. A failing input stays in its file, whether it panics, hangs or ends the process.
pub struct Trial {
    path: PathBuf,
    begun: Arc<Mutex<Option<Instant>>>,
    pub inputs: u64,
    pub taken: u64,
}

impl Trial {
    pub fn start(Target { name, ending, .. }: Target) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("fuzz");
        std::fs::create_dir_all(&folder).expect("a folder");
        let path = folder.join(format!("{name}-{}.{ending}", std::process::id()));
        let begun = Arc::new(Mutex::new(None));
        watch(path.clone(), Arc::clone(&begun));
        Self { path, begun, inputs: 0, taken: 0 }
    }

    /// Tries an input: writes it to the file and calls `check` with the text and the path.
    pub fn of(&mut self, text: &str, check: &mut impl FnMut(&str, &Path) -> bool) {
        write(&self.path, text);
        *self.begun.lock().expect("a time") = Some(Instant::now());
        let taken = check(text, &self.path);
        *self.begun.lock().expect("a time") = None;
        self.inputs += 1;
        self.taken += u64::from(taken);
    }
}

impl Drop for Trial {
    fn drop(&mut self) {
        *self.begun.lock().expect("a time") = None;
        if std::thread::panicking() {
            eprintln!("the input that failed is {}", self.path.display());
        } else {
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Starts a thread that ends the process if an input hangs, because a hanging test cannot end itself.
fn watch(path: PathBuf, begun: Arc<Mutex<Option<Instant>>>) {
    std::thread::spawn(move || {
        // The owner of the trial has the other reference, so the loop ends with the trial.
        while Arc::strong_count(&begun) > 1 {
            std::thread::sleep(Duration::from_millis(200));
            let hangs = |begun: Instant| begun.elapsed() > SLOWEST;
            if begun.lock().expect("a time").is_some_and(hangs) {
                // The test framework delays printed lines, and the process ends here, so the message is written
                // directly.
                let said = format!("no end after {SLOWEST:?}; the input is {}\n", path.display());
                let _ = std::io::stderr().write_all(said.as_bytes());
                std::process::exit(1);
            }
        }
    });
}
