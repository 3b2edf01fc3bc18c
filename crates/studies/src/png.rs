//! Encodes pictures as PNG, with texts about their origin, such as the command line.

use std::path::Path;

use image::{RgbImage, RgbaImage};
use png::{BitDepth, ColorType, Encoder, EncodingError};

use crate::error::{Error, Result};
use crate::output::{PendingFile, Texts};

/// Writes a picture to a PNG file that also contains `texts`. The function does not wait until the disk has stored the
/// file, because a picture that is lost in a power failure can be drawn again.
///
/// # Errors
/// If the file cannot be written. The error names the file and gives the message of the operating system.
pub fn write_png(path: &Path, image: &RgbaImage, texts: &Texts) -> Result<()> {
    let bytes = encoded([image.width(), image.height()], ColorType::Rgba, image.as_raw(), texts);
    let mut draft = PendingFile::start(path)?;
    draft.write(&bytes.map_err(|error| Error::file(path, error))?)?;
    draft.finish(false)
}

/// Returns a picture without transparency as the bytes of a PNG file that also contains `texts`.
///
/// # Errors
/// If the picture has no pixels.
pub fn png_of_rgb(image: &RgbImage, texts: &Texts) -> Result<Vec<u8>> {
    encoded([image.width(), image.height()], ColorType::Rgb, image.as_raw(), texts)
        .map_err(|error| Error::file("picture", error))
}

fn encoded(
    size: [u32; 2],
    colours: ColorType,
    pixels: &[u8],
    texts: &Texts,
) -> std::result::Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(colours);
    encoder.set_depth(BitDepth::Eight);
    for (keyword, text) in texts.iter() {
        // More programs can read plain text chunks (tEXt) than international ones (iTXt). Plain chunks cannot contain
        // Δ.
        if text.is_ascii() {
            encoder.add_text_chunk(keyword.into(), text.into())?;
        } else {
            encoder.add_itxt_chunk(keyword.into(), text.into())?;
        }
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_says_what_it_is_and_has_the_pixels_that_it_had() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let image = RgbaImage::from_fn(7, 5, |x, y| image::Rgba([x as u8, y as u8, 9, 200]));
        let mut texts = Texts::default();
        texts.add("Command line", "slump --headless");
        texts.add("World 1", "Δt 1e-3 s");
        write_png(&path, &image, &texts).unwrap();
        assert_eq!(image::open(&path).unwrap().into_rgba8(), image);
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        reader.finish().unwrap();
        let info = reader.info();
        let plain: Vec<_> = info
            .uncompressed_latin1_text
            .iter()
            .map(|chunk| (&*chunk.keyword, &*chunk.text))
            .collect();
        assert_eq!(plain[1..], [("Command line", "slump --headless")]);
        assert_eq!(plain[0].0, "Software");
        assert_eq!(info.utf8_text.len(), 1);
        assert_eq!(info.utf8_text[0].get_text().unwrap(), "Δt 1e-3 s");
        // The bytes of the file do not depend on the time of writing.
        let again = folder.path().join("b.png");
        write_png(&again, &image, &texts).unwrap();
        assert_eq!(std::fs::read(path).unwrap(), std::fs::read(again).unwrap());
    }
}
