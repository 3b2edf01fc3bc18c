//! Fonts, colours and spacing of the window.

use std::sync::Arc;

use egui::{
    Color32, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, Stroke, TextStyle,
};

use crate::render::{Colour, Theme};

/// Font of all text. It contains all symbols that labels use.
const FONT: &[u8] = include_bytes!("../../assets/fonts/DejaVuSansCondensed.ttf");
const BOLD_FONT: &[u8] = include_bytes!("../../assets/fonts/DejaVuSansCondensed-Bold.ttf");
/// Name of the font family of headings.
const BOLD: &str = "bold";

/// Returns the font family of headings.
pub(crate) fn bold() -> FontFamily {
    FontFamily::Name(BOLD.into())
}

/// Converts a colour of Slump's pictures to egui's type.
pub(crate) fn color32(colour: Colour) -> Color32 {
    let [red, green, blue, alpha] = colour.to_rgba8().0;
    Color32::from_rgba_unmultiplied(red, green, blue, alpha)
}

/// Accent colour of the play button and of the present time in plots.
pub(crate) fn accent(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0x4d, 0xa3, 0xd9) } else { Color32::from_rgb(0x00, 0x6c, 0xa8) }
}

/// Colour of text on the accent colour.
pub(crate) fn on_accent(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0x12, 0x15, 0x1a) } else { Color32::WHITE }
}

/// Colour of error messages and warnings.
pub(crate) fn warning(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0xf0, 0x8a, 0x4a) } else { Color32::from_rgb(0xb8, 0x46, 0x00) }
}

/// Colour of messages of success.
pub(crate) fn good(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(0x5c, 0xc9, 0x8a) } else { Color32::from_rgb(0x0a, 0x7d, 0x46) }
}

/// Returns the colour of a simulation in a comparison. Colour-blind people can distinguish the colours. The first
/// colours are not the colours of pushing and pulling forces.
pub(crate) fn world_colour(index: usize, dark: bool) -> Color32 {
    const COLOURS: [u32; 6] = [0x009e73, 0xaa4499, 0xe69f00, 0x56b4e9, 0x0072b2, 0xd55e00];
    const ON_DARK: [u32; 6] = [0x2fc49a, 0xe09cc4, 0xf0bf4c, 0x56b4e9, 0x9a8cff, 0xe8772e];
    let colours = if dark { ON_DARK } else { COLOURS };
    color32(Colour::hex(colours[index % colours.len()]))
}

/// Sets fonts, spacing and the colours of both themes.
pub fn install(context: &egui::Context) {
    context.set_fonts(fonts());
    context.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Small, FontId::new(11.0, FontFamily::Proportional)),
            (TextStyle::Body, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(13.0, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(15.0, bold())),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = egui::vec2(6.0, 5.0);
        style.spacing.button_padding = egui::vec2(7.0, 3.0);
        style.spacing.interact_size.y = 21.0;
        style.spacing.slider_rail_height = 5.0;
        style.spacing.indent = 16.0;
        style.spacing.icon_width = 13.0;
        style.spacing.icon_width_inner = 8.0;
        style.interaction.tooltip_delay = 0.35;
        for widget in [
            &mut style.visuals.widgets.inactive,
            &mut style.visuals.widgets.hovered,
            &mut style.visuals.widgets.active,
            &mut style.visuals.widgets.open,
        ] {
            widget.corner_radius = CornerRadius::same(4);
        }
    });
    for (theme, palette) in [(egui::Theme::Light, Theme::Light), (egui::Theme::Dark, Theme::Dark)] {
        context.style_mut_of(theme, |style| {
            let dark = palette == Theme::Dark;
            let visuals = &mut style.visuals;
            let accent = accent(dark);
            visuals.panel_fill =
                if dark { Color32::from_rgb(0x1d, 0x21, 0x28) } else { Color32::from_gray(0xf5) };
            visuals.window_fill = visuals.panel_fill;
            visuals.extreme_bg_color =
                if dark { Color32::from_rgb(0x12, 0x15, 0x1a) } else { Color32::WHITE };
            visuals.selection.bg_fill = accent.gamma_multiply(0.45);
            visuals.selection.stroke = Stroke::new(1.0, visuals.strong_text_color());
            visuals.hyperlink_color = accent;
            visuals.warn_fg_color = warning(dark);
            visuals.error_fg_color = warning(dark);
            visuals.slider_trailing_fill = true;
            let text = if dark { Color32::from_gray(214) } else { Color32::from_gray(38) };
            visuals.widgets.noninteractive.fg_stroke.color = text;
            visuals.widgets.inactive.fg_stroke.color = text;
            visuals.weak_text_color =
                Some(if dark { Color32::from_gray(158) } else { Color32::from_gray(96) });
        });
    }
}

fn fonts() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    for (name, bytes) in [("figures", FONT), (BOLD, BOLD_FONT)] {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(bytes)));
    }
    let fallbacks = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    let family = |first: &str| {
        std::iter::once(first.to_owned()).chain(fallbacks.iter().cloned()).collect::<Vec<_>>()
    };
    fonts.families.insert(FontFamily::Proportional, family("figures"));
    fonts.families.insert(bold(), family(BOLD));
    fonts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of a colour (WCAG 2.2).
    fn luminance(colour: Color32) -> f64 {
        let [red, green, blue] = [colour.r(), colour.g(), colour.b()].map(|channel| {
            let part = f64::from(channel) / 255.0;
            if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * red + 0.7152 * green + 0.0722 * blue
    }

    fn contrast(one: Color32, other: Color32) -> f64 {
        let [one, other] = [luminance(one), luminance(other)];
        (one.max(other) + 0.05) / (one.min(other) + 0.05)
    }

    #[test]
    fn contrast_is_that_of_the_guidelines() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        // Example of the guidelines (WCAG): the contrast of #777777 on white is just below 4.5.
        let grey = contrast(Color32::from_gray(0x77), Color32::WHITE);
        assert!((4.47..4.49).contains(&grey), "{grey}");
    }

    #[test]
    fn words_can_be_read_on_every_ground() {
        /// Smallest contrast ratio that level AA of the guidelines (WCAG) allows for text of any size.
        const LEAST: f64 = 4.5;
        let context = egui::Context::default();
        install(&context);
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let dark = theme == egui::Theme::Dark;
            let visuals = context.style_of(theme).visuals.clone();
            let panel = visuals.panel_fill;
            let selection = panel.blend(visuals.selection.bg_fill);
            let mut pairs = vec![
                ("on the accent", on_accent(dark), accent(dark)),
                ("selected", visuals.selection.stroke.color, selection),
            ];
            for ground in [panel, visuals.window_fill, visuals.extreme_bg_color] {
                pairs.extend([
                    ("text", visuals.text_color(), ground),
                    ("strong text", visuals.strong_text_color(), ground),
                    ("weak text", visuals.weak_text_color(), ground),
                    ("accent", accent(dark), ground),
                    ("warning", warning(dark), ground),
                    ("good", good(dark), ground),
                    ("link", visuals.hyperlink_color, ground),
                ]);
            }
            let widgets = &visuals.widgets;
            for widget in [&widgets.inactive, &widgets.hovered, &widgets.active, &widgets.open] {
                let ground = panel.blend(widget.weak_bg_fill);
                pairs.push(("button", widget.fg_stroke.color, ground));
            }
            for (what, words, ground) in pairs {
                let contrast = contrast(ground.blend(words), ground);
                assert!(contrast >= LEAST, "{theme:?}, {what}: {contrast:.2}");
            }
        }
    }
}
