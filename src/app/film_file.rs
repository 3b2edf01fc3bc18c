//! The files that the record is shown in as moving pictures.

use std::path::Path;

use image::RgbaImage;

use crate::error::Result;
use crate::film::{Animation, Video};
use crate::output::Texts;

/// What the record is made into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FilmFormat {
    /// MP4.
    Video,
    /// An animation that repeats, with at most 256 colours a picture.
    Gif,
}

impl FilmFormat {
    /// What it is called.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Video => "video",
            Self::Gif => "GIF",
        }
    }

    /// How names of its files end.
    pub(super) fn ending(self) -> &'static str {
        match self {
            Self::Video => "mp4",
            Self::Gif => "gif",
        }
    }

    /// Pictures a second that it can have, nearest to so many.
    pub(crate) fn nearest_rate_hz(self, rate_hz: f64) -> f64 {
        match self {
            Self::Video => rate_hz,
            Self::Gif => Animation::nearest_rate_hz(rate_hz),
        }
    }

    /// A size (px) that it can have, nearest above.
    pub(crate) fn size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            Self::Video => size.map(|side| side.next_multiple_of(2)),
            Self::Gif => size,
        }
    }

    /// Starts a file of so many pictures a second.
    pub(super) fn start(self, path: &Path, rate_hz: f64) -> Result<FilmFile> {
        Ok(match self {
            Self::Video => FilmFile::Video(Box::new(Video::start(path, rate_hz)?)),
            Self::Gif => FilmFile::Gif(Animation::start(path, rate_hz)?),
        })
    }
}

/// A file that is being made, and is there once it is finished.
pub(super) enum FilmFile {
    Video(Box<Video>),
    Gif(Animation),
}

impl FilmFile {
    /// Adds a picture; `texts` is what the file says of itself.
    pub(super) fn add(&mut self, image: RgbaImage, texts: &Texts) -> Result<()> {
        match self {
            Self::Video(video) => video.add(&image, texts),
            Self::Gif(gif) => gif.add(image, texts),
        }
    }

    /// Ends it and gives it its name. Whether there is one: none has no picture.
    pub(super) fn finish(self) -> Result<bool> {
        match self {
            Self::Video(video) => video.finish(),
            Self::Gif(gif) => gif.finish(),
        }
    }
}
