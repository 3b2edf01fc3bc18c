//! Videos of runs.

use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::video_options::{VIDEO_RATES_HZ, VIDEO_SIDES, check_built};
use crate::error::{Error, Result};
use crate::output::Texts;

impl HeadlessOptions {
    /// How many pictures a second of the video has.
    ///
    /// # Errors
    /// Where this build has no videos, or the rate or the size are not those of one.
    pub(super) fn video_rate_hz(&self) -> Result<f64> {
        if let Some(path) = &self.video.video {
            check_built(path.display())?;
            let size = self.size()?;
            let [least, most] = VIDEO_SIDES;
            let is_side = |side: u32| side.is_multiple_of(2) && (least..=most).contains(&side);
            if !is_side(size.width) || !is_side(size.height) {
                let allowed =
                    format!("even and from {least} to {most} pixels on both sides for a video");
                return Err(Error::value(
                    "size",
                    format!("{}x{}", size.width, size.height),
                    allowed,
                ));
            }
        }
        let speed = self.video.speed()?;
        let rate_hz = self.pictures_per_sec()? * speed;
        let [least, most] = VIDEO_RATES_HZ;
        if self.video.video.is_none() || (least..=most).contains(&rate_hz) {
            return Ok(rate_hz);
        }
        let found = format!("{} at --video-speed {speed}", self.pictures_per_sec()?);
        let allowed = format!("such that a second of the video has {least} to {most} pictures");
        Err(Error::value("fps", found, allowed))
    }
}

/// A video of a run, and what it says of itself.
#[cfg(feature = "video")]
pub(crate) struct VideoFile {
    video: crate::film::Video,
    texts: Texts,
}

#[cfg(feature = "video")]
impl VideoFile {
    pub(crate) fn start(path: &Path, size: [u32; 2], rate_hz: f64) -> Result<Self> {
        let video = crate::film::Video::start(path, size, rate_hz)?;
        Ok(Self { video, texts: Texts::default() })
    }

    pub(crate) fn add(&mut self, image: &RgbaImage, texts: &Texts) -> Result<()> {
        self.texts.clone_from(texts);
        self.video.add(image)
    }

    pub(crate) fn finish(self) -> Result<bool> {
        self.video.finish(&self.texts)
    }
}

/// What a build without videos has in its place, which it never comes to.
#[cfg(not(feature = "video"))]
pub(crate) struct VideoFile;

#[cfg(not(feature = "video"))]
impl VideoFile {
    pub(crate) fn start(path: &Path, _: [u32; 2], _: f64) -> Result<Self> {
        check_built(path.display()).map(|()| Self)
    }

    pub(crate) fn add(&mut self, _: &RgbaImage, _: &Texts) -> Result<()> {
        Ok(())
    }

    pub(crate) fn finish(self) -> Result<bool> {
        Ok(false)
    }
}
