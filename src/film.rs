//! Animated pictures of a run: GIF animations, and MP4 videos that ffmpeg encodes.

use std::fs::File;
use std::io::ErrorKind::NotFound;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;

use gif::{AnyExtension, DisposalMethod, Encoder, EncodingError, Extension, Frame, Repeat};
use image::RgbaImage;
use tempfile::NamedTempFile;

use crate::error::{Error, Result};
use crate::output::{DraftFile, PendingFile, Texts, folder_of};

/// Lowest and highest allowed frame rate of a video, Hz.
pub(crate) const VIDEO_RATES_HZ: [f64; 2] = [1.0, 240.0];
/// Shortest and longest allowed side of a video, pixels. Encoders refuse longer sides.
pub(crate) const VIDEO_SIDES: [u32; 2] = [16, 16_384];
/// Encoders of ffmpeg for videos that browsers can play, in order of preference, with options for good quality. The
/// first encoder that the installed ffmpeg has is used.
const ENCODERS: [(&str, &[&str]); 4] = [
    ("libx264", &["-crf", "18"]),
    ("libopenh264", &["-b:v", "8M"]),
    ("libsvtav1", &["-crf", "24", "-preset", "8"]),
    ("libvpx-vp9", &["-crf", "24", "-b:v", "0", "-cpu-used", "4"]),
];

/// Conversion factor from seconds to hundredths of a second, the unit of durations in GIF files.
const CENTISECS: f64 = 100.0;
/// Shortest duration of a picture in a GIF, hundredths of a second. Viewers show pictures of shorter duration for a
/// tenth of a second.
const LEAST_CENTISECS: f64 = 2.0;
/// Number of sampled pixels from which the GIF encoder chooses the colours of a picture. It samples every n-th pixel,
/// so that about this many are sampled. It samples all pixels of a small picture, because the colours of the legend
/// have few pixels.
const LOOKED_AT: u32 = 100_000;
/// Largest distance n between two sampled pixels: the GIF encoder samples at least one in ten pixels.
const MOST_PASSED: u32 = 10;

/// A GIF animation that is being written. The file gets its final name when the animation is finished.
pub(crate) struct Animation {
    path: PathBuf,
    picture_centisecs: u16,
    /// The GIF encoder with its own handle of the file; `None` before the first picture. The unfinished file `draft`
    /// has another handle, because the encoder owns the handle to which it writes.
    encoder: Option<Encoder<DraftFile>>,
    draft: PendingFile,
    pictures: usize,
    /// Length of the file after the last complete picture, bytes; `None` if the output is a device or pipe, which has
    /// no length.
    whole: Option<u64>,
}

impl Animation {
    /// Returns the frame rate of a GIF nearest to `rate_hz`, Hz. Durations of pictures in a GIF are multiples of a
    /// hundredth of a second, so not every rate is possible.
    #[cfg(feature = "panels")]
    pub(crate) fn nearest_rate_hz(rate_hz: f64) -> f64 {
        CENTISECS / f64::from(Self::centisecs(rate_hz))
    }

    fn centisecs(rate_hz: f64) -> u16 {
        (CENTISECS / rate_hz).round().max(LEAST_CENTISECS) as u16
    }

    /// Starts an animation with `rate_hz` pictures per second, rounded as in [`Self::nearest_rate_hz`].
    pub(crate) fn start(path: &Path, rate_hz: f64) -> Result<Self> {
        let draft = PendingFile::start(path)?;
        let (path, picture_centisecs) = (path.to_owned(), Self::centisecs(rate_hz));
        Ok(Self { path, picture_centisecs, encoder: None, draft, pictures: 0, whole: None })
    }

    /// Adds a picture. With the first picture, `texts` (descriptive texts such as title and settings) are written into
    /// the file as a comment; later `texts` are ignored.
    pub(crate) fn add(&mut self, image: RgbaImage, texts: &Texts) -> Result<()> {
        let added = self.encode(image, texts);
        let file = self.draft.file();
        if added.is_ok() {
            self.pictures += 1;
            self.whole = file.stream_position().ok();
        } else if let Some(whole) = self.whole {
            // After an error the file may contain a part of the picture, which is removed.
            let _ = file.set_len(whole).and_then(|()| file.seek(SeekFrom::Start(whole)));
        }
        added.map_err(|error| Error::file(&self.path, error))
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
                // A block of a comment in a GIF has at most 255 bytes.
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

    /// Ends the animation and gives the file its final name. Returns false if there was no picture and hence no file.
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

/// Returns an error if a file name does not have the ending of the file's format, such as `.gif`. Devices and pipes may
/// have any name. `option` is the name of the option that gives the file, and `other` names the option for another
/// format; both are parts of the error message.
pub(crate) fn check_ending(option: &str, path: &Path, ending: &str, other: &str) -> Result<()> {
    let is_special = path.metadata().is_ok_and(|there| !there.is_file() && !there.is_dir());
    let has_ending = path.extension().is_some_and(|it| it.eq_ignore_ascii_case(ending));
    if has_ending || is_special {
        return Ok(());
    }
    let allowed =
        format!("a name that ends with .{ending}, as the file is written in that format: {other}");
    Err(Error::value(option, path.display(), allowed))
}

/// An MP4 video that is being written. The file gets its final name when the video is finished.
pub(crate) struct Video {
    path: PathBuf,
    rate_hz: f64,
    /// The running encoder. It starts with the first picture, whose size becomes the size of the video.
    ffmpeg: Option<Ffmpeg>,
}

impl Video {
    /// Starts a video with `rate_hz` pictures per second.
    pub(crate) fn start(path: &Path, rate_hz: f64) -> Result<Self> {
        check_ffmpeg(path.display())?;
        Ok(Self { path: path.to_owned(), rate_hz, ffmpeg: None })
    }

    /// Adds a picture. All pictures must have the size of the first picture, and width and height must be even. The
    /// texts of the first picture become the video's comment.
    pub(crate) fn add(&mut self, image: &RgbaImage, texts: &Texts) -> Result<()> {
        let added = match &mut self.ffmpeg {
            Some(ffmpeg) => ffmpeg.add(image),
            none => Ffmpeg::start(&self.path, image, self.rate_hz, texts)
                .and_then(|ffmpeg| none.insert(ffmpeg).add(image)),
        };
        added.map_err(|error| Error::file(&self.path, error))
    }

    /// Ends the video and gives the file its final name. Returns false if there was no picture and hence no file.
    pub(crate) fn finish(self) -> Result<bool> {
        let Some(mut ffmpeg) = self.ffmpeg else { return Ok(false) };
        ffmpeg.finish().map_err(|error| Error::file(&self.path, error))?;
        let mut draft = PendingFile::start(&self.path)?;
        std::io::copy(ffmpeg.encoded.as_file_mut(), draft.file())
            .map_err(|error| Error::file(&self.path, error))?;
        draft.finish(true).map(|()| true)
    }
}

/// A running ffmpeg process. When this value is dropped, the process ends and its temporary file is deleted.
struct Ffmpeg {
    process: Child,
    /// Temporary file that ffmpeg writes. At the end ffmpeg inserts the index of pictures at the beginning of the file,
    /// so a pipe cannot be used.
    encoded: NamedTempFile,
    messages: File,
}

impl Ffmpeg {
    fn start(path: &Path, image: &RgbaImage, rate_hz: f64, texts: &Texts) -> std::io::Result<Self> {
        let (encoder, options) = encoder().map_err(std::io::Error::other)?;
        let mut builder = tempfile::Builder::new();
        builder.prefix(".slump-").suffix(".mp4");
        let encoded = builder.tempfile_in(folder_of(path)).or_else(|_| builder.tempfile())?;
        let messages = tempfile::tempfile()?;
        let mut command = Command::new("ffmpeg");
        command
            .args(["-hide_banner", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba"])
            .args(["-s", &format!("{}x{}", image.width(), image.height())])
            .args(["-r", &rate_hz.to_string(), "-i", "-", "-an", "-c:v", encoder])
            .args(options)
            // One key frame per second, so that players can jump to each second.
            .args(["-g", &rate_hz.ceil().to_string()])
            .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"])
            .args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"])
            .args(["-color_range", "tv", "-movflags", "+faststart"])
            .args(["-metadata", &format!("comment={}", texts.lines()), "-f", "mp4", "-y"])
            .arg(encoded.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(messages.try_clone()?);
        // ffmpeg gets a process group of its own, so that Ctrl-C ends only the run of this program. The program then
        // finishes the video.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        #[cfg(windows)]
        std::os::windows::process::CommandExt::creation_flags(
            &mut command,
            windows_sys::Win32::System::Threading::CREATE_NEW_PROCESS_GROUP,
        );
        Ok(Self { process: command.spawn()?, encoded, messages })
    }

    fn add(&mut self, image: &RgbaImage) -> std::io::Result<()> {
        let written = self.process.stdin.as_mut().map(|stdin| stdin.write_all(image.as_raw()));
        match written {
            Some(Ok(())) => Ok(()),
            // ffmpeg has closed its input. `finish` returns the error message of ffmpeg.
            Some(Err(error)) => self.finish().and(Err(error)),
            None => Err(std::io::Error::other("ffmpeg has ended")),
        }
    }

    fn finish(&mut self) -> std::io::Result<()> {
        drop(self.process.stdin.take());
        let status = self.process.wait()?;
        if status.success() {
            return Ok(());
        }
        let mut bytes = Vec::new();
        self.messages.seek(SeekFrom::Start(0))?;
        self.messages.read_to_end(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes);
        let last = text.lines().rfind(|line| !line.trim().is_empty());
        let reason = last.map_or_else(|| status.to_string(), |line| line.trim().to_owned());
        Err(std::io::Error::other(format!("ffmpeg failed: {reason}")))
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        // Both calls do nothing if the process has already ended.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// Returns the name and options of the first video encoder of ffmpeg that is available, or an error message that says
/// which program is missing.
fn encoder() -> std::result::Result<(&'static str, &'static [&'static str]), &'static str> {
    static FOUND: OnceLock<std::result::Result<usize, &str>> = OnceLock::new();
    let find = || {
        let listed = Command::new("ffmpeg")
            .args(["-hide_banner", "-encoders"])
            .stdin(Stdio::null())
            .output()
            .map_err(|error| match error.kind() {
                NotFound => "left out where there is no ffmpeg: install it (`apt install ffmpeg`)",
                _ => "left out where the system starts no further program",
            })?;
        let text = String::from_utf8_lossy(&listed.stdout);
        let has = |name| text.lines().any(|line| line.split_whitespace().nth(1) == Some(name));
        ENCODERS.iter().position(|(name, _)| has(*name)).ok_or(
            "left out where ffmpeg has no encoder that browsers play: install one with libx264, libopenh264, \
             libsvtav1 or libvpx-vp9",
        )
    };
    FOUND.get_or_init(find).map(|index| ENCODERS[index])
}

/// Checks that ffmpeg can encode videos. `given` is the user's value of the option that needs ffmpeg; the error message
/// contains it.
pub(crate) fn check_ffmpeg(given: impl std::fmt::Display) -> Result<()> {
    encoder().map(drop).map_err(|missing| {
        Error::value("video", given, format!("{missing}; a GIF and frames need nothing more"))
    })
}

#[cfg(test)]
mod tests {
    use image::codecs::gif::GifDecoder;
    use image::{AnimationDecoder, Rgba};

    use super::*;

    /// Tests that a GIF keeps the colours of the legend. A legend has only few pixels of a picture, but most of the
    /// picture's colours.
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
