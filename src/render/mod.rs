//! Pictures of snapshots.
