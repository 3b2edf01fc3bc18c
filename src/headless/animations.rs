//! The pictures of a run as files that move: those that are asked for.

use std::path::Path;

use image::RgbaImage;

use super::HeadlessOptions;
use super::manifest::PictureEntry;
use crate::error::{Error, Result};
use crate::film::{Animation, Video};
use crate::output::{Texts, print_line};

/// Pictures a second of a GIF, which viewers keep up with.
const GIF_RATE_HZ: f64 = 25.0;
/// What ends the command that makes one of them again.
const GIF_WORDS: [&str; 2] = ["--gif", "animation.gif"];
const VIDEO_WORDS: [&str; 2] = ["--video", "video.mp4"];

/// Animation and video of a run.
#[derive(Default)]
pub(super) struct Animations {
    gif: Option<Animation>,
    video: Option<Video>,
}

impl Animations {
    /// Starts those that are asked for, with the pictures that a run has left before it goes on. `told` is what
    /// they say of themselves, made by a command that ends with such words.
    ///
    /// # Errors
    /// Names the file and what the system or ffmpeg says, also of a picture that is no longer there.
    pub(super) fn start(
        options: &HeadlessOptions,
        pictures: &[PictureEntry],
        told: impl Fn(&[&str]) -> Texts,
    ) -> Result<Self> {
        let rate_hz = options.video_rate_hz()?;
        let start = |path: &Path| Video::start(path, rate_hz);
        let animate = |path: &Path| Animation::start(path, GIF_RATE_HZ);
        let mut animations = Self {
            gif: options.gif.as_deref().map(animate).transpose()?,
            video: options.video.as_deref().map(start).transpose()?,
        };
        if animations.gif.is_none() && animations.video.is_none() {
            return Ok(animations);
        }
        for PictureEntry { file, .. } in pictures {
            let path = options.frames.as_deref().unwrap_or(Path::new("")).join(file);
            let image = image::open(&path).map_err(|error| Error::file(&path, error))?;
            animations.add(image.into_rgba8(), &told)?;
        }
        Ok(animations)
    }

    /// Adds a picture to all of them.
    ///
    /// # Errors
    /// Names the file and what it says; the pictures before stay.
    pub(super) fn add(&mut self, image: RgbaImage, told: impl Fn(&[&str]) -> Texts) -> Result<()> {
        let video = self.video.as_mut().map(|video| video.add(&image, &told(&VIDEO_WORDS)));
        let gif = self.gif.as_mut().map(|gif| gif.add(image, &told(&GIF_WORDS)));
        video.transpose().and(gif.transpose()).map(|_| ())
    }

    /// Ends them, gives them their names, and tells which there are when `told` has been.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn finish(self) -> Result<Finished> {
        let video = self.video.map_or(Ok(false), Video::finish);
        let gif = self.gif.map_or(Ok(false), Animation::finish);
        Ok(Finished { gif: gif?, video: video? })
    }
}

/// Which of them have a picture.
pub(super) struct Finished {
    gif: bool,
    video: bool,
}

impl Finished {
    /// Says where they are.
    pub(super) fn tell(&self, options: &HeadlessOptions) {
        let all = [(self.gif, &options.gif), (self.video, &options.video)];
        for path in
            all.into_iter().filter(|(is_there, _)| *is_there).filter_map(|(_, path)| path.as_ref())
        {
            print_line(path.display());
        }
    }
}
