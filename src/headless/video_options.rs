//! Options of videos.

use std::path::PathBuf;

use crate::error::{Error, Result};

/// Fewest and most pictures a second that players are asked for.
pub(crate) const VIDEO_RATES_HZ: [f64; 2] = [1.0, 240.0];
/// The shortest and longest side of a video, px: AV1 has none that are longer.
pub(crate) const VIDEO_SIDES: [u32; 2] = [16, 65_534];

/// Options of videos.
#[derive(Clone, Debug, Default, clap::Args)]
pub(crate) struct VideoOptions {
    /// Write the pictures as a video too: AV1 in MP4, at the pace of simulated time
    #[arg(long, value_name = "FILE", help_heading = "Pictures", conflicts_with = "times")]
    pub video: Option<PathBuf>,
    /// Simulated seconds in a second of the video: 0.1 is ten times slower than it was, and asks for 250 pictures
    /// per simulated second unless --fps says otherwise [default: 1]
    #[arg(long, value_name = "N", help_heading = "Pictures", allow_negative_numbers = true)]
    pub video_speed: Option<f64>,
}

impl VideoOptions {
    /// Simulated seconds in a second of the video; of pictures without a video in a second of what is shown.
    ///
    /// # Errors
    /// Where it is none, or there is no video.
    pub(super) fn speed(&self) -> Result<f64> {
        let Some(speed) = self.video_speed else { return Ok(1.0) };
        if self.video.is_none() {
            return Err(Error::value("video-speed", speed, "left out where --video is not given"));
        }
        if speed > 0.0 && speed.is_finite() {
            return Ok(speed);
        }
        Err(Error::value("video-speed", speed, "a finite number > 0"))
    }
}

/// Whether this build can write videos.
///
/// # Errors
/// Says what is missing; `given` is what asks for one.
pub(crate) fn check_built(given: impl std::fmt::Display) -> Result<()> {
    if cfg!(feature = "video") {
        return Ok(());
    }
    Err(Error::value("video", given, "left out in this build, which has not the feature video"))
}
