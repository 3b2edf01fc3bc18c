//! What is in a file, read back box by box.

use std::path::PathBuf;

use image::{Rgba, RgbaImage};
use mp4_atom::{Codec, Colr, Decode, Ftyp, Header, Moov, StszSamples};

use super::*;

/// A dark disc that goes to the right over a light ground, a picture of it after another.
fn moving(number: u32, [width, height]: [u32; 2]) -> RgbaImage {
    let middle = [f64::from(10 + 3 * number), 0.5 * f64::from(height)];
    RgbaImage::from_fn(width, height, |x, y| {
        let away = (f64::from(x) - middle[0]).hypot(f64::from(y) - middle[1]);
        if away < 9.0 { Rgba([40, 60, 120, 255]) } else { Rgba([240, 235, 225, 255]) }
    })
}

fn written(threads: usize, pictures: u32, size: [u32; 2]) -> (Vec<u8>, PathBuf, tempfile::TempDir) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("video.mp4");
    let mut video = Video::start_on(threads, &path, size, 25.0).expect("a video");
    for number in 0..pictures {
        video.add(&moving(number, size)).expect("a picture");
    }
    assert!(!path.exists(), "no half file has the name");
    let mut texts = Texts::default();
    texts.add("Command line", "slump --headless --video a.mp4");
    assert!(video.finish(&texts).expect("a file"));
    (std::fs::read(&path).expect("a file"), path, folder)
}

/// The head of a file, and the bytes of each picture.
fn read(bytes: &[u8]) -> (Moov, Vec<&[u8]>) {
    let mut rest = bytes;
    let kind = Ftyp::decode(&mut rest).expect("a kind");
    assert!(kind.compatible_brands.contains(&b"av01".into()), "{kind:?}");
    let moov = Moov::decode(&mut rest).expect("a head");
    let header = Header::decode(&mut rest).expect("what holds the pictures");
    assert_eq!((header.kind, header.size), (b"mdat".into(), Some(rest.len())));
    let table = &moov.trak[0].mdia.minf.stbl;
    let StszSamples::Different { sizes } = &table.stsz.samples else { panic!("{table:?}") };
    let mut at = table.stco.as_ref().expect("where they begin").entries[0] as usize;
    assert_eq!(at, bytes.len() - rest.len());
    let pictures = sizes.iter().map(|&size| {
        at += size as usize;
        &bytes[at - size as usize..at]
    });
    let pictures = pictures.collect();
    assert_eq!(at, bytes.len(), "nothing is left over");
    (moov, pictures)
}

/// Kinds of the units of a packet, which must fill it (AV1 specification, 5.3).
fn kinds(mut packet: &[u8]) -> Vec<u8> {
    let mut kinds = Vec::new();
    while let [head, rest @ ..] = packet {
        assert_eq!(head & 0x82, 2, "a unit that says its length");
        let groups = rest.iter().position(|byte| byte & 0x80 == 0).expect("a length") + 1;
        let length = (0..groups).map(|at| usize::from(rest[at] & 0x7f) << (7 * at)).sum::<usize>();
        kinds.push(head >> 3 & 0xf);
        packet = &rest[groups + length..];
    }
    kinds
}

#[test]
fn players_are_told_of_every_picture() {
    let (bytes, ..) = written(1, 30, [96, 64]);
    let (moov, pictures) = read(&bytes);
    let media = &moov.trak[0].mdia;
    assert_eq!((media.mdhd.timescale, media.mdhd.duration), (90_000, 30 * 3_600));
    assert_eq!(pictures.len(), 30);
    let timed = &media.minf.stbl.stts.entries[..];
    assert!(
        matches!(timed, [all] if (all.sample_count, all.sample_delta) == (30, 3_600)),
        "{timed:?}"
    );
    // A picture each second needs none before it, and begins with what the sequence is like.
    let keys = media.minf.stbl.stss.as_ref().expect("key pictures");
    assert_eq!(keys.entries, [1, 26]);
    for (number, picture) in (1..).zip(&pictures) {
        let kinds = kinds(picture);
        assert_eq!(kinds[0] == 1, keys.entries.contains(&number), "{kinds:?}");
        assert!(!kinds.contains(&2), "no temporal delimiter: {kinds:?}");
        assert!(kinds.iter().any(|kind| [3, 6].contains(kind)), "a picture: {kinds:?}");
    }
    let [Codec::Av01(codec)] = &media.minf.stbl.stsd.codecs[..] else { panic!("AV1") };
    assert_eq!([codec.visual.width, codec.visual.height], [96, 64]);
    assert_eq!((codec.av1c.seq_profile, codec.av1c.seq_level_idx_0), (0, 0), "the least level");
    assert!(codec.av1c.chroma_subsampling_x && codec.av1c.chroma_subsampling_y);
    assert!(pictures[0].starts_with(&codec.av1c.config_obus) && codec.av1c.config_obus.len() > 4);
    let Some(Colr::Nclx { matrix_coefficients: 1, full_range_flag: false, .. }) = codec.colr else {
        panic!("{:?}", codec.colr)
    };
    let said = moov.udta.as_ref().and_then(|said| said.meta.as_ref()).expect("metadata");
    let list = said.get::<mp4_atom::Ilst>().expect("a list");
    let lines = &list.desc.as_ref().expect("a description").text;
    assert!(lines.contains("Command line: slump --headless --video a.mp4\n"), "{lines}");
}

#[test]
fn the_same_pictures_make_the_same_file_on_any_number_of_threads() {
    // So large that there are several parts to be encoded side by side.
    let (alone, ..) = written(1, 8, [320, 256]);
    for threads in [2, 3] {
        assert!(written(threads, 8, [320, 256]).0 == alone, "{threads} threads");
    }
}

#[test]
fn the_level_is_the_least_that_the_size_fits_in() {
    // AV1 specification, annex A.3: 4.0 up to 2,359,296 pixels and 70,778,880 a second, 4.1 twice as many a second.
    for (size, rate_hz, level) in
        [([1920, 1080], 30.0, 8), ([1920, 1080], 60.0, 9), ([320, 200], 25.0, 0)]
    {
        let ticks = (90_000.0 / rate_hz) as u32;
        let encoder = PictureEncoder::start(1, size, [ticks, 90_000]).expect("an encoder");
        assert_eq!(encoder.level(), level, "{size:?} at {rate_hz}");
    }
}

#[test]
fn no_picture_makes_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("video.mp4");
    let video = Video::start(&path, [64, 48], 25.0).expect("a video");
    assert!(!video.finish(&Texts::default()).expect("no failure"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("a folder").count(), 0);
}

#[test]
fn a_failure_leaves_the_pictures_before_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("video.mp4");
    let size = [96, 64];
    let mut video = Video::start(&path, size, 25.0).expect("a video");
    for number in 0..20 {
        video.add(&moving(number, size)).expect("a picture");
    }
    let before = video.samples.len();
    assert!(before > 0, "the situation: something is encoded");
    // What waits can no longer be written to: a file that is open for reading alone.
    std::fs::write(folder.path().join("read"), "").expect("a file");
    let written = std::mem::replace(
        &mut video.waiting,
        File::open(folder.path().join("read")).expect("a file"),
    );
    let failed = (20..60).find_map(|number| video.add(&moving(number, size)).err());
    assert!(failed.is_some_and(|error| error.to_string().contains("video.mp4")));
    let before = video.samples.len();
    video.waiting = written;
    assert!(video.finish(&Texts::default()).expect("a file"));
    let bytes = std::fs::read(&path).expect("a file");
    assert_eq!(read(&bytes).1.len(), before);
}
