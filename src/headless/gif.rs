//! Animations.

use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::{Path, PathBuf};

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, RgbaImage};

use crate::error::{Error, Result};
use crate::output::Draft;

/// Time that each picture is shown, ms: 25 pictures a second, which viewers keep up with.
const PICTURE_MS: u32 = 40;
/// The encoder's own scale from 1 (slowest, best colours) to 30.
const ENCODER_SPEED: i32 = 10;

/// An animation that is there once it is finished.
pub(super) struct Animation {
    path: PathBuf,
    /// Two handles of one file: the encoder keeps the one that it writes to.
    encoder: GifEncoder<File>,
    draft: Draft,
    pictures: usize,
    /// Length of the pictures that are in the file, bytes; none where it has no lengths.
    whole: Option<u64>,
}

impl Animation {
    /// Starts an animation.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn start(path: &Path) -> Result<Self> {
        let refuse = |error: &dyn std::fmt::Display| Error::file(path, error);
        let mut draft = Draft::start(path)?;
        let handle = draft.file().try_clone().map_err(|error| refuse(&error))?;
        let mut encoder = GifEncoder::new_with_speed(handle, ENCODER_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| refuse(&error))?;
        Ok(Self { path: path.to_owned(), encoder, draft, pictures: 0, whole: None })
    }

    /// Adds a picture.
    ///
    /// # Errors
    /// Names the file and what the encoder says; the pictures before stay.
    pub(super) fn add(&mut self, image: RgbaImage) -> Result<()> {
        let delay = Delay::from_numer_denom_ms(PICTURE_MS, 1);
        let added = self.encoder.encode_frame(Frame::from_parts(image, 0, 0, delay));
        let file = self.draft.file();
        match (added, self.whole) {
            (Ok(()), _) => {
                self.pictures += 1;
                self.whole = file.stream_position().ok();
                return Ok(());
            }
            (Err(error), Some(whole)) => {
                // A part of the picture may be there.
                let _ = file.set_len(whole).and_then(|()| file.seek(SeekFrom::Start(whole)));
                Err(error)
            }
            (Err(error), None) => Err(error),
        }
        .map_err(|error| Error::file(&self.path, error))
    }

    /// Ends the animation and gives it its name. Whether there is one: none has no picture.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(super) fn finish(self) -> Result<bool> {
        // The encoder writes the end of the file when it is dropped.
        drop(self.encoder);
        if self.pictures == 0 {
            return Ok(false);
        }
        self.draft.finish(true).map(|()| true)
    }
}
