//! Tests that every renderer draws the same picture. These tests need a graphics driver.

use image::RgbaImage;
use rand::{RngExt, SeedableRng};

use super::*;

/// Opens all GPUs of this machine. If the machine has no GPU, the test fails, because nothing would be compared.
fn gpus() -> Vec<Renderer> {
    let found: Vec<Renderer> = [RendererChoice::Vulkan, RendererChoice::Gl]
        .into_iter()
        .filter_map(|choice| Renderer::new(choice).ok())
        .collect();
    assert!(
        !found.is_empty(),
        "no GPU driver: install mesa-vulkan-drivers and libvulkan1, or libegl1 and libgl1-mesa-dri"
    );
    found
}

fn largest_difference(a: &RgbaImage, b: &RgbaImage) -> u8 {
    assert_eq!(a.dimensions(), b.dimensions());
    a.as_raw().iter().zip(b.as_raw()).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

/// Compares the pictures of all GPUs with the picture of the processor. A difference of 3/255 per channel is allowed.
fn assert_agreement(picture: &Picture, width: u32, height: u32) {
    let expected = primitives::draw(picture, width, height);
    for mut renderer in gpus() {
        let drawn = renderer.draw(picture, width, height).unwrap();
        let difference = largest_difference(&drawn, &expected);
        println!("{}: {difference}", renderer.name());
        assert!(difference <= 3, "{} differs by {difference}", renderer.name());
    }
}

fn random_picture(seed: u64, width: u32, height: u32, count: usize) -> Picture {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut point = |overhang: f32| {
        let mut along = |length: u32| {
            let reach = length as f32 / 2.0 + overhang;
            random.random_range(-reach..reach)
        };
        [along(width), along(height)]
    };
    let points: Vec<[f32; 2]> = (0..3 * count).map(|_| point(20.0)).collect();
    let mut number = |low: f32, high: f32| random.random_range(low..high);
    let mut colours = || Colour {
        red: number(0.0, 1.0),
        green: number(0.0, 1.0),
        blue: number(0.0, 1.0),
        alpha: number(0.3, 1.0),
    };
    let pairs: Vec<[Colour; 2]> = (0..2 * count).map(|_| [colours(), colours()]).collect();
    let mut discs = Vec::new();
    let mut links = Vec::new();
    for index in 0..count {
        let angle = number(0.0, 6.3);
        discs.push(DiscInstance {
            centre: points[index],
            radius: number(0.1, 40.0),
            outline_width: number(0.0, 3.0),
            mark_half_width: number(-1.0, 2.0),
            direction: [angle.cos(), angle.sin()],
            fill: pairs[index][0],
            outline: pairs[index][1],
        });
        links.push(LinkInstance {
            start: points[count + index],
            end: points[2 * count + index],
            half_width: number(0.1, 8.0),
            colour: pairs[count + index][0],
        });
    }
    let mut picture = Picture::new(Colour::WHITE);
    let late = discs.split_off(count / 2);
    picture.push_discs(discs);
    picture.push_links(links);
    picture.push_discs(late);
    picture
}

#[test]
#[ignore = "needs a graphics driver"]
fn random_primitives_agree() {
    for seed in 0..6 {
        assert_agreement(&random_picture(seed, 301, 203, 60), 301, 203);
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn an_empty_picture_is_its_ground() {
    let picture = Picture::new(Colour::hex(0x1180fe));
    let mut renderers = gpus();
    renderers.push(Renderer::new(RendererChoice::Cpu).unwrap());
    for mut renderer in renderers {
        let image = renderer.draw(&picture, 7, 5).unwrap();
        assert_eq!(image.dimensions(), (7, 5));
        assert!(image.pixels().all(|pixel| pixel.0 == [0x11, 0x80, 0xfe, 0xff]));
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn a_renderer_draws_pictures_of_changing_size() {
    for mut renderer in gpus() {
        for (width, height) in [(64, 48), (65, 33), (64, 48)] {
            let picture = random_picture(9, width, height, 10);
            let drawn = renderer.draw(&picture, width, height).unwrap();
            assert!(largest_difference(&drawn, &primitives::draw(&picture, width, height)) <= 3);
        }
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn impossible_sizes_are_named() {
    let picture = Picture::new(Colour::WHITE);
    let mut renderers = gpus();
    renderers.push(Renderer::new(RendererChoice::Cpu).unwrap());
    for mut renderer in renderers {
        let side = renderer.largest_side() + 1;
        for (width, height) in [(0, 10), (10, 0), (side, 10), (10, side)] {
            let message = renderer.draw(&picture, width, height).unwrap_err().to_string();
            assert!(message.starts_with(&format!("size is {width}x{height}, but must be")));
        }
        assert!(renderer.draw(&picture, 10, 10).is_ok(), "a refused size must break nothing");
    }
}

#[test]
#[ignore = "needs a graphics driver"]
fn links_and_discs_thinner_than_a_pixel_fade() {
    let mut picture = Picture::new(Colour::WHITE);
    let across = |y, half_width| LinkInstance {
        start: [-20.0, y],
        end: [20.0, y],
        half_width,
        colour: Colour::BLACK,
    };
    picture.push_links(vec![across(5.5, 0.5), across(-4.5, 0.125)]);
    let image = primitives::draw(&picture, 40, 20);
    assert_eq!(image.get_pixel(20, 4).0, [0, 0, 0, 255]);
    assert_eq!(image.get_pixel(20, 14).0, [191, 191, 191, 255]);
    assert_agreement(&picture, 40, 20);
}
