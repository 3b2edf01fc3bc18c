//! The head of an MP4 file: what is in it, where, and when it is to be shown.

use mp4_atom::{
    Av01, Av1c, Codec, Colr, Desc, Dinf, Dref, Encode, FourCC, Ftyp, Hdlr, Header, Ilst, Mdhd,
    Mdia, Meta, Minf, Moov, Mvhd, Result, Stbl, Stco, Stsc, StscEntry, Stsd, Stss, Stsz,
    StszSamples, Stts, SttsEntry, Tkhd, Tool, Trak, Udta, Url, Visual, Vmhd,
};

use crate::output::Texts;

/// What colours and transfer of BT.709 are called (ITU-T H.273, tables 2 to 4).
const BT_709: u16 = 1;

/// A picture in the file.
pub(super) struct Sample {
    pub bytes: u32,
    /// Whether it needs none before it.
    pub is_key: bool,
}

/// All that players are told of a video.
pub(super) struct Movie<'a> {
    pub size: [u16; 2],
    pub ticks_per_picture: u32,
    pub ticks_per_sec: u32,
    /// Level of AV1.
    pub level: u8,
    pub sequence_header: &'a [u8],
    pub samples: &'a [Sample],
    pub texts: &'a Texts,
}

/// The bytes of a file that stand before its pictures, which follow each other without gaps. Of when it was written
/// nothing is said: the same pictures make the same file.
pub(super) fn movie_head(movie: &Movie<'_>) -> Result<Vec<u8>> {
    // How long it is does not hang on where the pictures begin.
    let begins_at = movie.head(0)?.len();
    movie.head(begins_at as u32)
}

impl Movie<'_> {
    fn head(&self, pictures_at: u32) -> Result<Vec<u8>> {
        let mut head = Vec::new();
        let names = [b"isom", b"iso2", b"mp41", b"av01"].map(FourCC::new);
        let kind =
            Ftyp { major_brand: names[0], minor_version: 512, compatible_brands: names.into() };
        kind.encode(&mut head)?;
        self.moov(pictures_at).encode(&mut head)?;
        let bytes: u64 = self.samples.iter().map(|sample| u64::from(sample.bytes)).sum();
        Header { kind: FourCC::new(b"mdat"), size: Some(bytes as usize) }.encode(&mut head)?;
        Ok(head)
    }

    fn ticks(&self) -> u64 {
        self.samples.len() as u64 * u64::from(self.ticks_per_picture)
    }

    fn moov(&self, pictures_at: u32) -> Moov {
        let (timescale, duration) = (self.ticks_per_sec, self.ticks());
        let [width, height] = self.size;
        let tkhd = Tkhd {
            track_id: 1,
            duration,
            enabled: true,
            in_movie: true,
            width: width.into(),
            height: height.into(),
            ..Tkhd::default()
        };
        let mdhd = Mdhd { timescale, duration, language: "und".into(), ..Mdhd::default() };
        let hdlr = Hdlr { handler: FourCC::new(b"vide"), name: "video".into() };
        let here = Dref { entries: vec![Url::default().into()] };
        let minf = Minf {
            vmhd: Some(Vmhd::default()),
            dinf: Dinf { dref: here },
            stbl: self.stbl(pictures_at),
            ..Minf::default()
        };
        let track = Trak { tkhd, mdia: Mdia { mdhd, hdlr, minf }, ..Trak::default() };
        Moov {
            mvhd: Mvhd {
                timescale,
                duration,
                rate: 1.into(),
                volume: 1.into(),
                next_track_id: 2,
                ..Mvhd::default()
            },
            trak: vec![track],
            udta: Some(self.said()),
            ..Moov::default()
        }
    }

    /// Which bytes are which picture, and when it is shown.
    fn stbl(&self, pictures_at: u32) -> Stbl {
        let count = self.samples.len() as u32;
        let numbered = (1..).zip(self.samples);
        let keys = numbered.filter(|(_, sample)| sample.is_key).map(|(number, _)| number);
        let sizes = self.samples.iter().map(|sample| sample.bytes).collect();
        Stbl {
            stsd: Stsd { codecs: vec![self.codec()] },
            stts: Stts {
                entries: vec![SttsEntry {
                    sample_count: count,
                    sample_delta: self.ticks_per_picture,
                }],
            },
            stss: Some(Stss { entries: keys.collect() }),
            stsc: Stsc {
                entries: vec![StscEntry {
                    first_chunk: 1,
                    samples_per_chunk: count,
                    sample_description_index: 1,
                }],
            },
            stsz: Stsz { samples: StszSamples::Different { sizes } },
            stco: Some(Stco { entries: vec![pictures_at] }),
            ..Stbl::default()
        }
    }

    /// AV1 of 8 bits with half the chroma across and down (AV1 in ISOBMFF, 2.3).
    fn codec(&self) -> Codec {
        let [width, height] = self.size;
        let visual = Visual { data_reference_index: 1, width, height, ..Visual::default() };
        let av1c = Av1c {
            seq_level_idx_0: self.level,
            chroma_subsampling_x: true,
            chroma_subsampling_y: true,
            // Between two rows.
            chroma_sample_position: 1,
            config_obus: self.sequence_header.to_owned(),
            ..Av1c::default()
        };
        let colr = Colr::Nclx {
            colour_primaries: BT_709,
            transfer_characteristics: BT_709,
            matrix_coefficients: BT_709,
            full_range_flag: false,
        };
        Av01 { visual, av1c, colr: Some(colr), ..Av01::default() }.into()
    }

    /// What it says of itself, where players look for it: the program, and all else as its description.
    fn said(&self) -> Udta {
        let tool = self.texts.iter().next().map(|(_, program)| Tool {
            country_indicator: 0,
            language_indicator: 0,
            text: program.to_owned(),
        });
        let lines = Desc { country_indicator: 0, language_indicator: 0, text: self.texts.lines() };
        let list = Ilst { ctoo: tool, desc: Some(lines), ..Ilst::default() };
        let hdlr = Hdlr { handler: FourCC::new(b"mdir"), name: String::new() };
        let mut meta = Meta { hdlr, items: Vec::new() };
        meta.push(list);
        Udta { meta: Some(meta), ..Udta::default() }
    }
}
