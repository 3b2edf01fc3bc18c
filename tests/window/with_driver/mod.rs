//! Tests of pictures, animations and videos that the window draws. These tests need a graphics driver.

mod pictures;
mod provenance;
mod videos;
