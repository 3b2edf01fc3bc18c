//! From the colours of a picture to those of a video.
//!
//! ITU-R BT.709-6, item 3: with R', G', B' in 0 … 1,
//!
//! ```text
//! Y' = 0.2126 R' + 0.7152 G' + 0.0722 B'
//! C_B = (B' − Y') / 1.8556,   C_R = (R' − Y') / 1.5748
//! ```
//!
//! and in 8 bits of the limited range (items 4.4 to 4.6) Y' becomes 16 + 219 Y', and C becomes 128 + 224 C.
//!
//! There are half as many C across and down. Decoders take them to lie on every other column and between two rows
//! (AV1 specification, 6.4.2, `CSP_VERTICAL`), so each is the mean of two rows, and across a mean with the weights
//! 1, 2, 1 about its column.

use image::RgbaImage;

/// Y', C_B and C_R of a picture, row by row from the top.
pub(super) struct Planes {
    /// As many as there are pixels.
    pub luma: Vec<u8>,
    /// Half as many across and down, each.
    pub chroma: [Vec<u8>; 2],
}

/// Y' of R', G', B', all in the units of the latter.
fn luma_of([red, green, blue]: [f32; 3]) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

fn byte(value: f32) -> u8 {
    // Rounds, and stays within 0 … 255 by itself.
    (value + 0.5) as u8
}

impl Planes {
    /// Those of an opaque picture with an even number of rows and columns.
    pub(super) fn of(image: &RgbaImage) -> Self {
        let (width, height) = (image.width() as usize, image.height() as usize);
        let pixels = image.as_raw();
        let pixel = |column: usize, row: usize| {
            let at = 4 * (row * width + column);
            [0, 1, 2].map(|channel| f32::from(pixels[at + channel]))
        };
        let luma = pixels
            .chunks_exact(4)
            .map(|it| byte(16.0 + 219.0 / 255.0 * luma_of([it[0], it[1], it[2]].map(f32::from))));
        let mut planes = Self { luma: luma.collect(), chroma: [Vec::new(), Vec::new()] };
        for row in (0..height).step_by(2) {
            for column in (0..width).step_by(2) {
                let left = column.saturating_sub(1);
                let mut mean = [0.0; 3];
                for (from, weight) in [(left, 0.125), (column, 0.25), (column + 1, 0.125)] {
                    for side in [row, row + 1] {
                        let found = pixel(from, side);
                        mean.iter_mut().zip(found).for_each(|(sum, it)| *sum += weight * it);
                    }
                }
                let luma = luma_of(mean);
                let scale = 224.0 / 255.0;
                planes.chroma[0].push(byte(128.0 + scale * (mean[2] - luma) / 1.8556));
                planes.chroma[1].push(byte(128.0 + scale * (mean[0] - luma) / 1.5748));
            }
        }
        planes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The colour bars of BT.709 at full saturation: R', G', B', and Y', C_B, C_R in 8 bits (ITU-R BT.709-6; the same
    /// as in EBU Tech 3320, where they are in 10 bits).
    const BARS: [([u8; 3], [u8; 3]); 8] = [
        ([255, 255, 255], [235, 128, 128]),
        ([255, 255, 0], [219, 16, 138]),
        ([0, 255, 255], [188, 154, 16]),
        ([0, 255, 0], [173, 42, 26]),
        ([255, 0, 255], [78, 214, 230]),
        ([255, 0, 0], [63, 102, 240]),
        ([0, 0, 255], [32, 240, 118]),
        ([0, 0, 0], [16, 128, 128]),
    ];

    #[test]
    fn colour_bars_are_those_of_the_standard() {
        for ([red, green, blue], [luma, b, r]) in BARS {
            let image = RgbaImage::from_pixel(4, 2, image::Rgba([red, green, blue, 255]));
            let planes = Planes::of(&image);
            assert_eq!(planes.luma, [luma; 8], "{red} {green} {blue}");
            assert_eq!(planes.chroma, [vec![b; 2], vec![r; 2]], "{red} {green} {blue}");
        }
    }

    #[test]
    fn chroma_lies_on_the_even_columns_and_between_the_rows() {
        // Columns that grow redder by 40 each: a mean about an even column has that column's red.
        let image = RgbaImage::from_fn(6, 2, |x, _| image::Rgba([40 * x as u8, 0, 0, 255]));
        let found = Planes::of(&image).chroma[1].clone();
        let of = |red: f32| byte(128.0 + 224.0 / 255.0 * red * (1.0 - 0.2126) / 1.5748);
        // The first has its own column again in place of one beyond the edge.
        assert_eq!(found, [of(10.0), of(80.0), of(160.0)]);
    }
}
