//! Which alarms a run raised.

use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::sim::AlarmKind;

/// Kinds of alarms, each once. In files their names, with spaces between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Alarms(u8);

impl Alarms {
    /// Whether there are some of that kind.
    pub(crate) fn has(self, kind: AlarmKind) -> bool {
        self.0 & (1 << kind as u8) != 0
    }

    fn kinds(self) -> impl Iterator<Item = AlarmKind> {
        AlarmKind::ALL.into_iter().filter(move |kind| self.has(*kind))
    }
}

impl FromIterator<AlarmKind> for Alarms {
    fn from_iter<I: IntoIterator<Item = AlarmKind>>(kinds: I) -> Self {
        Self(kinds.into_iter().fold(0, |all, kind| all | 1 << kind as u8))
    }
}

impl fmt::Display for Alarms {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names: Vec<_> = self.kinds().map(AlarmKind::name).collect();
        formatter.write_str(&names.join(" "))
    }
}

impl Serialize for Alarms {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

impl<'de> Deserialize<'de> for Alarms {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let kind = |name: &str| {
            let found = AlarmKind::ALL.into_iter().find(|kind| kind.name() == name);
            found.ok_or_else(|| D::Error::custom(format!("{name} is no kind of alarm")))
        };
        String::deserialize(deserializer)?.split_whitespace().map(kind).collect()
    }
}
