//! What recordings look like to ParaView and OVITO, and that they stay whole. `tests/clients/` asks those
//! programs themselves.

mod dumps;
mod moments;
mod refusals;
mod series;
mod vtp;
mod whole;
