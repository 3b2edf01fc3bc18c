//! Animations.

use std::fs::File;
use std::io::{Seek, SeekFrom};
use std::path::{Path, PathBuf};

use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use image::RgbaImage;

use crate::error::{Error, Result};
use crate::output::{PendingFile, Texts};

/// Hundredths of a second in a second, the unit in which a file says how long a picture is shown.
const CENTISECS: f64 = 100.0;
/// Viewers take what is shorter for a mistake and show it for a tenth of a second.
const LEAST_CENTISECS: f64 = 2.0;
/// The encoder looks at every n-th pixel when it chooses colours: at so many pixels, and at all of a small picture, in
/// which a legend of colours has few.
const LOOKED_AT: u32 = 100_000;
/// It looks at one in ten at least.
const MOST_PASSED: u32 = 10;

/// An animation that is there once it is finished.
pub(crate) struct Animation {
    path: PathBuf,
    /// Time that each picture is shown.
    picture_centisecs: u16,
    /// Two handles of one file: the encoder keeps the one that it writes to.
    encoder: Option<Encoder<File>>,
    draft: PendingFile,
    pictures: usize,
    /// Length of the pictures that are in the file, bytes; none where it has no lengths.
    whole: Option<u64>,
}

impl Animation {
    /// Pictures a second of an animation that comes nearest to so many, since a file counts in hundredths of a second.
    #[cfg(feature = "window")]
    pub(crate) fn nearest_rate_hz(rate_hz: f64) -> f64 {
        CENTISECS / f64::from(Self::centisecs(rate_hz))
    }

    fn centisecs(rate_hz: f64) -> u16 {
        (CENTISECS / rate_hz).round().max(LEAST_CENTISECS) as u16
    }

    /// Starts an animation of so many pictures a second, or of [`Self::nearest_rate_hz`].
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(crate) fn start(path: &Path, rate_hz: f64) -> Result<Self> {
        let draft = PendingFile::start(path)?;
        let (path, picture_centisecs) = (path.to_owned(), Self::centisecs(rate_hz));
        Ok(Self { path, picture_centisecs, encoder: None, draft, pictures: 0, whole: None })
    }

    /// Adds a picture. The first comes after what the animation says of itself, a comment.
    ///
    /// # Errors
    /// Names the file and what the encoder says; the pictures before stay.
    pub(crate) fn add(&mut self, image: RgbaImage, texts: &Texts) -> Result<()> {
        let added = self.encode(image, texts);
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

    fn encode(
        &mut self,
        mut image: RgbaImage,
        texts: &Texts,
    ) -> std::result::Result<(), EncodingError> {
        let side = |pixels: u32| u16::try_from(pixels).map_err(|_| too_large());
        let (width, height) = (side(image.width())?, side(image.height())?);
        let encoder = match &mut self.encoder {
            Some(encoder) => encoder,
            none => {
                let mut encoder = Encoder::new(self.draft.file().try_clone()?, width, height, &[])?;
                encoder.set_repeat(Repeat::Infinite)?;
                let lines = texts.lines();
                // A block of a comment holds no more than 255 bytes.
                let blocks: Vec<&[u8]> = lines.as_bytes().chunks(255).collect();
                encoder.write_raw_extension(AnyExtension(Extension::Comment as u8), &blocks)?;
                none.insert(encoder)
            }
        };
        let every = (image.width() * image.height() / LOOKED_AT).clamp(1, MOST_PASSED);
        let mut frame = Frame::from_rgba_speed(width, height, &mut image, every as i32);
        (frame.delay, frame.dispose) = (self.picture_centisecs, DisposalMethod::Background);
        encoder.write_frame(&frame)
    }

    /// Ends the animation and gives it its name. Whether there is one: none has no picture.
    ///
    /// # Errors
    /// Names the file and what the system says.
    pub(crate) fn finish(self) -> Result<bool> {
        // The encoder writes the end of the file when it is dropped.
        drop(self.encoder);
        if self.pictures == 0 {
            return Ok(false);
        }
        self.draft.finish(true).map(|()| true)
    }
}

fn too_large() -> EncodingError {
    std::io::Error::new(std::io::ErrorKind::InvalidInput, "a side has more than 65,535 pixels")
        .into()
}

#[cfg(test)]
mod tests {
    use image::codecs::gif::GifDecoder;
    use image::{AnimationDecoder, Rgba};

    use super::*;

    /// A legend has few of the pixels of a picture and most of its colours.
    #[test]
    fn a_legend_of_colours_keeps_them_in_a_picture_of_any_size() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("legend.gif");
        for side in [160u32, 480, 960] {
            let height = side * 5 / 8;
            let picture = RgbaImage::from_fn(side, height, |x, y| {
                let part = (255 * y / height) as u8;
                let is_grain = (x / 20 + y / 20) % 3 == 0;
                let edge = (x % 20 * 12) as u8;
                Rgba(match x * 80 / side {
                    74 => [255 - part, part / 2, part, 255],
                    0..60 if is_grain => [edge, edge, edge, 255],
                    _ => [255; 4],
                })
            });
            let mut animation = Animation::start(&path, 25.0).expect("a place");
            animation.add(picture.clone(), &Texts::default()).expect("a picture");
            assert!(animation.finish().expect("an animation"));
            let file = std::io::BufReader::new(File::open(&path).expect("a file"));
            let frames = GifDecoder::new(file).expect("a GIF").into_frames();
            let frames = frames.collect_frames().expect("pictures");
            let channels = picture.as_raw().iter().zip(frames[0].buffer().as_raw());
            let largest = channels.map(|(one, other)| one.abs_diff(*other)).max();
            assert!(largest < Some(12), "{side}: {largest:?}");
        }
    }
}
