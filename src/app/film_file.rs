//! The files that the record is shown in as moving pictures.

use std::path::Path;

use image::RgbaImage;

use crate::error::Result;
use crate::output::{Animation, Texts};

/// What the record is made into.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum FilmFormat {
    /// AV1 in MP4.
    #[cfg(feature = "video")]
    Video,
    /// An animation that repeats, with at most 256 colours a picture.
    Gif,
}

impl FilmFormat {
    /// What it is called.
    pub(crate) fn name(self) -> &'static str {
        match self {
            #[cfg(feature = "video")]
            Self::Video => "video",
            Self::Gif => "GIF",
        }
    }

    /// How names of its files end.
    pub(super) fn ending(self) -> &'static str {
        match self {
            #[cfg(feature = "video")]
            Self::Video => "mp4",
            Self::Gif => "gif",
        }
    }

    /// Pictures a second that it can have, nearest to so many.
    pub(super) fn nearest_rate_hz(self, rate_hz: f64) -> f64 {
        match self {
            #[cfg(feature = "video")]
            Self::Video => rate_hz,
            Self::Gif => Animation::nearest_rate_hz(rate_hz),
        }
    }

    /// A size (px) that it can have, nearest above.
    pub(crate) fn size(self, size: [u32; 2]) -> [u32; 2] {
        match self {
            #[cfg(feature = "video")]
            Self::Video => size.map(|side| side.next_multiple_of(2)),
            Self::Gif => size,
        }
    }

    /// Starts a file of pictures of that size (px) that follow each other by so many a second.
    pub(super) fn start(self, path: &Path, size: [u32; 2], rate_hz: f64) -> Result<FilmFile> {
        let _ = size;
        Ok(match self {
            #[cfg(feature = "video")]
            Self::Video => {
                FilmFile::Video(Box::new(crate::output::Video::start(path, size, rate_hz)?))
            }
            Self::Gif => FilmFile::Gif(Animation::start(path, rate_hz)?),
        })
    }
}

/// A file that is being made, and is there once it is finished.
pub(super) enum FilmFile {
    #[cfg(feature = "video")]
    Video(Box<crate::output::Video>),
    Gif(Animation),
}

impl FilmFile {
    /// Adds a picture; `texts` is what the file says of itself.
    pub(super) fn add(&mut self, image: RgbaImage, texts: &Texts) -> Result<()> {
        match self {
            #[cfg(feature = "video")]
            Self::Video(video) => video.add(&image),
            Self::Gif(gif) => gif.add(image, texts),
        }
    }

    /// Ends it and gives it its name.
    pub(super) fn finish(self, texts: &Texts) -> Result<()> {
        let _ = texts;
        match self {
            #[cfg(feature = "video")]
            Self::Video(video) => video.finish(texts).map(|_| ()),
            Self::Gif(gif) => gif.finish().map(|_| ()),
        }
    }
}
