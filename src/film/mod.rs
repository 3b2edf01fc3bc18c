//! Pictures one after the other: animations and videos.

mod animation;
#[cfg(feature = "video")]
mod video;

pub(crate) use animation::Animation;
#[cfg(feature = "video")]
pub(crate) use video::Video;
