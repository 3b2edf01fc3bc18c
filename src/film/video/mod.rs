//! Moving pictures: AV1 in MP4, which browsers and players show as it is.

mod colours;
mod container;
mod encoder;

use std::fs::File;
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use image::RgbaImage;

use self::container::{Movie, Sample, movie_head};
use self::encoder::{Packet, PictureEncoder};
use crate::error::{Error, Result};
use crate::output::folder_of;
use crate::output::{PendingFile, Texts};

/// Ticks a second, of which 24, 25, 30, 48, 50, 60 and 120 pictures a second take a whole number each.
const TICKS_PER_SEC: u32 = 90_000;

/// A video that is there once it is finished. Until then what is encoded waits in a file without a name, so that
/// memory does not grow with it and pipes can be written to: what a file begins with tells the length of all that
/// follows.
pub(crate) struct Video {
    path: PathBuf,
    encoder: PictureEncoder,
    waiting: File,
    samples: Vec<Sample>,
    pictures: usize,
    /// What failed leaves the pictures before; nothing more is encoded after it.
    is_broken: bool,
}

impl Video {
    /// Starts a video of pictures of that size (px, both even) that follow each other by so many a second. As many
    /// threads encode as there are cores; on any number the file is the same.
    ///
    /// # Errors
    /// Names the file and what the system or the encoder says.
    pub(crate) fn start(path: &Path, size: [u32; 2], rate_hz: f64) -> Result<Self> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from);
        Self::start_on(threads, path, size, rate_hz)
    }

    fn start_on(threads: usize, path: &Path, size: [u32; 2], rate_hz: f64) -> Result<Self> {
        let refuse = |error: std::io::Error| Error::file(path, error);
        let ticks = (f64::from(TICKS_PER_SEC) / rate_hz).round().max(1.0) as u32;
        let encoder = PictureEncoder::start(threads, size, [ticks, TICKS_PER_SEC])
            .map_err(|error| Error::file(path, error))?;
        let waiting = tempfile::tempfile_in(folder_of(path)).or_else(|_| tempfile::tempfile());
        Ok(Self {
            path: path.to_owned(),
            encoder,
            waiting: waiting.map_err(refuse)?,
            samples: Vec::new(),
            pictures: 0,
            is_broken: false,
        })
    }

    /// Adds a picture, of the size that all have.
    ///
    /// # Errors
    /// Names the file and what the encoder or the system says; the pictures before stay.
    pub(crate) fn add(&mut self, image: &RgbaImage) -> Result<()> {
        let encoded = self.encoder.add(image).map_err(|error| Error::file(&self.path, error));
        self.keep(encoded)?;
        self.pictures += 1;
        Ok(())
    }

    fn keep(&mut self, encoded: Result<Vec<Packet>>) -> Result<()> {
        let kept = encoded.and_then(|packets| {
            packets.iter().try_for_each(|packet| {
                let bytes = u32::try_from(packet.data.len())
                    .map_err(|error| Error::file(&self.path, error))?;
                let written = self.waiting.write_all(&packet.data);
                written.map_err(|error| Error::file(&self.path, error))?;
                self.samples.push(Sample { bytes, is_key: packet.is_key });
                Ok(())
            })
        });
        self.is_broken |= kept.is_err();
        kept
    }

    /// Ends the video, has it say this of itself, and gives it its name. Whether there is one: none has no picture.
    ///
    /// # Errors
    /// Names the file and what the encoder or the system says; then there is none.
    pub(crate) fn finish(mut self, texts: &Texts) -> Result<bool> {
        if !self.is_broken {
            let encoded = self.encoder.finish().map_err(|error| Error::file(&self.path, error));
            self.keep(encoded)?;
        }
        if self.samples.is_empty() {
            return Ok(false);
        }
        let mut draft = PendingFile::start(&self.path)?;
        let head = movie_head(&Movie {
            size: self.encoder.size(),
            ticks_per_picture: self.encoder.ticks_per_picture(),
            ticks_per_sec: TICKS_PER_SEC,
            level: self.encoder.level(),
            sequence_header: self.encoder.sequence_header(),
            samples: &self.samples,
            texts,
        });
        draft.write(&head.map_err(|error| Error::file(&self.path, error))?)?;
        self.copy_to(&mut draft).map_err(|error| Error::file(&self.path, error))?;
        draft.finish(true).map(|()| true)
    }

    /// What is encoded, without what a failure may have left behind it.
    fn copy_to(&mut self, draft: &mut PendingFile) -> std::io::Result<()> {
        let bytes = self.samples.iter().map(|sample| u64::from(sample.bytes)).sum();
        self.waiting.seek(SeekFrom::Start(0))?;
        let mut whole = std::io::Read::take(&mut self.waiting, bytes);
        std::io::copy(&mut whole, draft.file()).map(drop)
    }
}

#[cfg(test)]
mod tests;
