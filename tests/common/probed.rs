//! Reads properties of a video file with the program ffprobe.

use std::path::Path;
use std::process::Command;

pub struct Probed {
    pub codec: String,
    pub pixels: String,
    pub colours: String,
    pub size: [u64; 2],
    pub rate_hz: String,
    pub pictures: usize,
    /// Numbers of the key frames of the video; the first frame has number 1.
    pub key_pictures: Vec<usize>,
    pub comment: String,
}

pub fn probe(video: &Path) -> Probed {
    let shown = "stream=codec_name,pix_fmt,color_space,width,height,r_frame_rate:packet=flags:format_tags=comment";
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-of", "json", "-show_entries", shown])
        .arg(video)
        .output()
        .expect("ffprobe, which these tests need: apt install ffmpeg");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let told: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let streams = told["streams"].as_array().expect("streams");
    assert_eq!(streams.len(), 1, "{told}");
    let text = |name: &str| streams[0][name].as_str().expect(name).to_owned();
    let packets = told["packets"].as_array().expect("packets");
    let is_key =
        |packet: &serde_json::Value| packet["flags"].as_str().expect("flags").contains('K');
    Probed {
        codec: text("codec_name"),
        pixels: text("pix_fmt"),
        colours: text("color_space"),
        size: ["width", "height"].map(|side| streams[0][side].as_u64().expect(side)),
        rate_hz: text("r_frame_rate"),
        pictures: packets.len(),
        key_pictures: (1..)
            .zip(packets)
            .filter(|(_, it)| is_key(it))
            .map(|(number, _)| number)
            .collect(),
        comment: told["format"]["tags"]["comment"].as_str().expect("a comment").to_owned(),
    }
}
