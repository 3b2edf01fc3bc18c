//! Animations.

use std::path::{Path, PathBuf};

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbaImage};
use tempfile::NamedTempFile;

use crate::error::{Error, Result};
use crate::output::{finish_file, start_file};

/// Time that each picture is shown, ms: 25 pictures a second, which viewers keep up with.
const PICTURE_MS: u32 = 40;
/// The encoder's own scale from 1 (slowest, best colours) to 30.
const ENCODER_SPEED: i32 = 10;

/// An animation that is there once it is finished.
pub(super) struct Animation {
    path: PathBuf,
    /// Two handles of one file: the encoder keeps the one that it writes to.
    encoder: GifEncoder<std::fs::File>,
    file: NamedTempFile,
}

impl Animation {
    /// Starts an animation.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn start(path: &Path) -> Result<Self> {
        let refuse = |error: &dyn std::fmt::Display| Error::file(path, error);
        let file = start_file(path)?;
        let handle = file.as_file().try_clone().map_err(|error| refuse(&error))?;
        let mut encoder = GifEncoder::new_with_speed(handle, ENCODER_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| refuse(&error))?;
        Ok(Self { path: path.to_owned(), encoder, file })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// Names the file and what the encoder says.
    pub(super) fn add(&mut self, image: RgbaImage) -> Result<()> {
        let delay = Delay::from_numer_denom_ms(PICTURE_MS, 1);
        self.encoder
            .encode_frame(Frame::from_parts(image, 0, 0, delay))
            .map_err(|error| Error::file(&self.path, error))
    }

    /// Ends the animation and gives it its name.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn finish(self) -> Result<()> {
        // The encoder writes the end of the file when it is dropped.
        drop(self.encoder);
        finish_file(self.file, &self.path)
    }
}
