//! Records the processor, the date and the command of a measurement, so that timings can be attributed to a machine.

use std::time::SystemTime;

use serde::Serialize;

use crate::error::{Error, Result};

#[derive(Clone, Debug, Serialize)]
pub(crate) struct Machine {
    /// Version and commit of the program.
    pub version: String,
    pub processor: String,
    pub cores: usize,
    /// Date of the measurement in UTC: year-month-day.
    pub date: String,
    pub command: String,
    /// Hash of the program and the processor's name. Computing times are comparable only if this hash is the same.
    #[serde(skip)]
    pub fingerprint: String,
}

impl Machine {
    pub(crate) fn this(version: &str) -> Result<Self> {
        let processor = processor();
        let program = std::env::current_exe().map_err(|error| Error::file("slump", error))?;
        let bytes = std::fs::read(&program).map_err(|error| Error::file(&program, error))?;
        let mut hasher = blake3::Hasher::new();
        hasher.update(&bytes);
        hasher.update(processor.as_bytes());
        // Command-line bytes that are not valid Unicode are replaced by a substitute character.
        let arguments = std::env::args_os().skip(1).map(|it| it.to_string_lossy().into_owned());
        let arguments = arguments.collect::<Vec<_>>().join(" ");
        Ok(Self {
            version: version.to_owned(),
            processor,
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            date: date_of(SystemTime::now()),
            command: format!("slump {arguments}"),
            fingerprint: hasher.finalize().to_hex()[..12].to_owned(),
        })
    }

    pub(crate) fn words(&self) -> String {
        let Self { version, processor, cores, date, command, .. } = self;
        let cores = if *cores == 1 { "1 core".into() } else { format!("{cores} cores") };
        format!("slump {version}; {processor}, {cores}; {date}; {command}")
    }
}

/// Returns year, month and day in UTC. The clock may be wrong, so any time is accepted.
fn date_of(now: SystemTime) -> String {
    let unknown = || "a day that no calendar has".to_owned();
    jiff::Timestamp::try_from(now)
        .map_or_else(|_| unknown(), |now| now.strftime("%Y-%m-%d").to_string())
}

/// Returns the name of the processor according to Linux, or else the processor architecture.
fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = text.lines().find_map(|line| {
        let (key, value) = line.split_once(':')?;
        (key.trim() == "model name").then(|| value.trim().to_owned())
    });
    named.filter(|name| !name.is_empty()).unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    #[test]
    fn a_clock_beyond_the_calendar_is_no_panic() {
        let date = |secs| date_of(SystemTime::UNIX_EPOCH + Duration::from_secs(secs));
        assert_eq!(date(86_400), "1970-01-02");
        let year_10000 = 253_402_300_800;
        assert_eq!(date(year_10000 - 86_400 * 2), "9999-12-30");
        assert_eq!(date(2 * year_10000), "a day that no calendar has");
    }
}
