//! Pictures to packets of AV1.

use std::sync::Arc;

use image::RgbaImage;
use rav1e::color::{
    ChromaSamplePosition, ColorDescription, ColorPrimaries, MatrixCoefficients, PixelRange,
    TransferCharacteristics,
};
use rav1e::prelude::{
    Config, Context, EncoderConfig, EncoderStatus, FrameType, InvalidConfig, Rational,
};

use super::colours::Planes;

/// The encoder's own scale from 0 (slowest) to 10. At 8 a file is half as long, and takes four times the time.
const SPEED: u8 = 10;
/// The encoder's scale of losses, 0 … 255: at 50 pictures of a pile come back at some 45 dB; at 100, half as long,
/// lines of a pixel show a shade around them.
const LOSS: usize = 50;
/// In so many parts threads may encode a picture: fixed, since the file hangs on it.
const PARTS: usize = 4;
/// Levels of AV1 (specification, annex A.3), from the least.
const LEVELS: std::ops::RangeInclusive<u8> = 0..=31;
/// What begins a packet, and is to be left out in MP4 (AV1 in ISOBMFF, 2.4): a temporal delimiter.
const DELIMITER: [u8; 2] = [0x12, 0x00];
/// Kind of the unit that says what a sequence is like (AV1 specification, 6.2.2).
const SEQUENCE_HEADER: u8 = 1;

/// The encoded picture or pictures of one moment.
pub(super) struct Packet {
    pub data: Vec<u8>,
    /// Whether it needs none before it.
    pub is_key: bool,
}

/// An encoder of pictures of one size.
pub(super) struct PictureEncoder {
    context: Context<u8>,
    config: EncoderConfig,
    sequence_header: Vec<u8>,
}

impl PictureEncoder {
    /// One whose pictures are shown for `ticks` of so many a second; each second one needs none before it.
    pub(super) fn start(
        threads: usize,
        [width, height]: [u32; 2],
        [ticks, ticks_per_sec]: [u32; 2],
    ) -> Result<Self, InvalidConfig> {
        let pictures_in_a_second = u64::from((ticks_per_sec / ticks).max(1));
        let config = EncoderConfig {
            width: width as usize,
            height: height as usize,
            time_base: Rational::new(u64::from(ticks), u64::from(ticks_per_sec)),
            chroma_sample_position: ChromaSamplePosition::Vertical,
            pixel_range: PixelRange::Limited,
            color_description: Some(ColorDescription {
                color_primaries: ColorPrimaries::BT709,
                transfer_characteristics: TransferCharacteristics::BT709,
                matrix_coefficients: MatrixCoefficients::BT709,
            }),
            quantizer: LOSS,
            // No picture waits for later ones: half the time, for a tenth more bytes.
            low_latency: true,
            tiles: PARTS,
            min_key_frame_interval: pictures_in_a_second,
            max_key_frame_interval: pictures_in_a_second,
            ..EncoderConfig::with_speed_preset(SPEED)
        };
        let at = |level, time_base| {
            let config = EncoderConfig { level_idx: Some(level), time_base, ..config.clone() };
            Config::new().with_encoder_config(config).with_threads(threads)
        };
        // The encoder's check of a level takes seconds a picture for pictures a second (rav1e 0.8.1,
        // `Config::validate`), so it is asked with the one for the other.
        let rate = Rational::from_reciprocal(config.time_base);
        // The last of them has no limits.
        let level = LEVELS.clone().find(|&level| at(level, rate).validate().is_ok());
        let level = level.unwrap_or(*LEVELS.end());
        let context = at(level, config.time_base).new_context()?;
        let config = EncoderConfig { level_idx: Some(level), ..config };
        Ok(Self { context, config, sequence_header: Vec::new() })
    }

    /// Columns and rows.
    pub(super) fn size(&self) -> [u16; 2] {
        // The encoder has refused larger ones.
        [self.config.width as u16, self.config.height as u16]
    }

    pub(super) fn ticks_per_picture(&self) -> u32 {
        self.config.time_base.num as u32
    }

    pub(super) fn level(&self) -> u8 {
        self.config.level_idx.unwrap_or(*LEVELS.end())
    }

    /// What says what the sequence is like, once there is a packet.
    pub(super) fn sequence_header(&self) -> &[u8] {
        &self.sequence_header
    }

    /// Takes in a picture, and hands out what is encoded.
    pub(super) fn add(&mut self, image: &RgbaImage) -> Result<Vec<Packet>, EncoderStatus> {
        let planes = Planes::of(image);
        let width = self.config.width;
        let mut frame = self.context.new_frame();
        let [luma, blue, red] = &mut frame.planes;
        luma.copy_from_raw_u8(&planes.luma, width, 1);
        blue.copy_from_raw_u8(&planes.chroma[0], width / 2, 1);
        red.copy_from_raw_u8(&planes.chroma[1], width / 2, 1);
        self.context.send_frame(Arc::new(frame))?;
        self.packets()
    }

    /// What is left, after the last picture.
    pub(super) fn finish(&mut self) -> Result<Vec<Packet>, EncoderStatus> {
        self.context.flush();
        self.packets()
    }

    fn packets(&mut self) -> Result<Vec<Packet>, EncoderStatus> {
        let mut packets = Vec::new();
        loop {
            match self.context.receive_packet() {
                Ok(packet) => {
                    let data = packet.data.strip_prefix(&DELIMITER).unwrap_or(&packet.data);
                    if self.sequence_header.is_empty() {
                        self.sequence_header =
                            first_sequence_header(data).unwrap_or_default().to_owned();
                    }
                    let is_key = packet.frame_type == FrameType::KEY;
                    packets.push(Packet { data: data.to_owned(), is_key });
                }
                Err(EncoderStatus::Encoded) => {}
                Err(EncoderStatus::NeedMoreData | EncoderStatus::LimitReached) => {
                    return Ok(packets);
                }
                Err(error) => return Err(error),
            }
        }
    }
}

/// The sequence header that a packet begins with, head and all. A head is a byte with the kind in bits 3 to 6, and
/// the length of the rest follows in groups of seven bits, the lowest first (AV1 specification, 5.3.2 and 4.10.5).
fn first_sequence_header(packet: &[u8]) -> Option<&[u8]> {
    if packet.first()? >> 3 & 0xf != SEQUENCE_HEADER {
        return None;
    }
    let last = packet[1..].iter().position(|byte| byte & 0x80 == 0)?;
    let groups = packet[1..=last + 1].iter().enumerate();
    let length = groups.map(|(group, byte)| usize::from(byte & 0x7f) << (7 * group)).sum::<usize>();
    packet.get(..2 + last + length)
}
