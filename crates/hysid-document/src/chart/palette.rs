//! Colours. The one place that names them.
//!
//! A drawing in a page contains markers, which the page's style sheet turns into colours that suit a light or a dark
//! page. A drawing for print contains the colours of a light page.

use std::sync::LazyLock;

use plotters::style::RGBColor;

use super::{Colour, LEVELS, RAMP, SERIES};

/// A marker and the colours that it stands for.
struct Tone {
    marker: RGBColor,
    light: &'static str,
    dark: &'static str,
}

const fn tone(marker: (u8, u8, u8), light: &'static str, dark: &'static str) -> Tone {
    Tone { marker: RGBColor(marker.0, marker.1, marker.2), light, dark }
}

/// Marker of axes and text.
pub(super) const INK: RGBColor = RGBColor(0x11, 0x11, 0x11);

/// Marker of the lines of the grid.
pub(super) const GRID: RGBColor = RGBColor(0xDD, 0xDD, 0xDD);

const MEASURED: Tone = tone((0x80, 0x80, 0x80), "#b4bec9", "#66717e");
const SIMULATED: Tone = tone((0x00, 0x60, 0xD0), "#0a5fd1", "#62a8ff");
const INPUT: Tone = tone((0x20, 0x80, 0x40), "#1a7f4b", "#4cc38a");
const ERROR: Tone = tone((0xC0, 0x40, 0x20), "#c2410c", "#ff8a5c");
const FAINT: Tone = tone((0xB0, 0xB0, 0xB0), "#b6bdc6", "#5b6470");
const BAND: Tone = tone((0xA0, 0xC8, 0xF0), "#0a5fd14d", "#62a8ff59");

/// The series differ in hue and in lightness.
const ONE_OF_SERIES: [Tone; SERIES] = [
    tone((0x01, 0x60, 0xD0), "#0a5fd1", "#62a8ff"),
    tone((0x02, 0x40, 0x20), "#c2410c", "#ff8a5c"),
    tone((0x03, 0x80, 0x40), "#1a7f4b", "#4cc38a"),
    tone((0x04, 0x60, 0xA0), "#7d3fb0", "#c49bf0"),
    tone((0x05, 0x90, 0x10), "#a16207", "#e0b04a"),
    tone((0x06, 0x90, 0x90), "#0e7490", "#5cc5d6"),
];

/// The ramp: hue and lightness go one way, so that it is told apart without colour vision. From the map viridis of Stéfan
/// van der Walt and Nathaniel Smith, without the end that is too pale or too dark for the page.
const ONE_OF_RAMP: [Tone; RAMP] = [
    tone((0x30, 0x40, 0x50), "#45085b", "#f0e524"),
    tone((0x30, 0x40, 0x51), "#482374", "#c9e023"),
    tone((0x30, 0x40, 0x52), "#433b83", "#a2da38"),
    tone((0x30, 0x40, 0x53), "#3b518a", "#7cd150"),
    tone((0x30, 0x40, 0x54), "#32658d", "#59c764"),
    tone((0x30, 0x40, 0x55), "#2a798e", "#3dba74"),
    tone((0x30, 0x40, 0x56), "#238b8d", "#28ac81"),
    tone((0x30, 0x40, 0x57), "#209d89", "#209e88"),
    tone((0x30, 0x40, 0x58), "#2aaf7f", "#22908c"),
    tone((0x30, 0x40, 0x59), "#49c06e", "#26828e"),
    tone((0x30, 0x40, 0x5A), "#72ce55", "#2c738e"),
    tone((0x30, 0x40, 0x5B), "#a2da38", "#32648d"),
];

/// The levels of a heat map, from the lowest.
const LEVEL: [Tone; 12] = [
    tone((0x10, 0x21, 0x33), "#b8651b", "#e08b4a"),
    tone((0x10, 0x21, 0x32), "#eda85f", "#8a4b1f"),
    tone((0x10, 0x21, 0x31), "#f9dcb8", "#4a2f1c"),
    tone((0x10, 0x20, 0x30), "#eef1f5", "#20262d"),
    tone((0x10, 0x20, 0x31), "#cfe3f5", "#12395c"),
    tone((0x10, 0x20, 0x32), "#a6cdec", "#17527a"),
    tone((0x10, 0x20, 0x33), "#74b3df", "#1b6f8f"),
    tone((0x10, 0x20, 0x34), "#4595cf", "#2a8c93"),
    tone((0x10, 0x20, 0x35), "#2076b8", "#4fab86"),
    tone((0x10, 0x20, 0x36), "#0b5799", "#8bc86d"),
    tone((0x10, 0x20, 0x37), "#073c75", "#cfde5c"),
    tone((0x10, 0x20, 0x38), "#04234d", "#fdf3a0"),
];

/// Text, axes and grid: the marker, how the style sheet calls it, what it colours, and its colours.
const FRAME: [(RGBColor, &str, &str, &str, &str); 3] = [
    (INK, "ink", "text", "#1b1f24", "#e3e7ec"),
    (INK, "axis", "[stroke=\"#111111\"]", "#57606a", "#9aa4af"),
    (GRID, "grid", "[stroke=\"#DDDDDD\"]", "#e3e6ea", "#30363d"),
];

fn of(colour: Colour) -> &'static Tone {
    match colour {
        Colour::Measured => &MEASURED,
        Colour::Simulated => &SIMULATED,
        Colour::Input => &INPUT,
        Colour::Error => &ERROR,
        Colour::Faint => &FAINT,
        Colour::Band => &BAND,
        Colour::Series(index) => &ONE_OF_SERIES[index % SERIES],
        Colour::Ramp(place) => &ONE_OF_RAMP[place.min(RAMP - 1)],
        Colour::Level(level) => {
            let level = level.clamp(*LEVELS.start(), *LEVELS.end());
            &LEVEL[usize::from(level.abs_diff(*LEVELS.start()))]
        }
    }
}

fn all() -> impl Iterator<Item = &'static Tone> {
    [&MEASURED, &SIMULATED, &INPUT, &ERROR, &FAINT, &BAND]
        .into_iter()
        .chain(&ONE_OF_SERIES)
        .chain(&ONE_OF_RAMP)
        .chain(&LEVEL)
}

impl Colour {
    pub(super) fn marker(self) -> RGBColor {
        of(self).marker
    }
}

/// The marker as it stands in a drawing.
pub(super) fn written(marker: RGBColor) -> String {
    let RGBColor(red, green, blue) = marker;
    format!("#{red:02X}{green:02X}{blue:02X}")
}

/// The style sheet of drawings, to be put into a page once.
pub fn style() -> &'static str {
    static STYLE: LazyLock<String> = LazyLock::new(|| {
        let variables = |light: bool| {
            let frame = FRAME.iter().map(|&(_, name, _, bright, dark)| (name.to_string(), bright, dark));
            let tones = all().map(|tone| (written(tone.marker)[1..].to_string(), tone.light, tone.dark));
            let one = |(name, bright, dark)| format!("--{name}: {}; ", if light { bright } else { dark });
            frame.chain(tones).map(one).collect::<String>()
        };
        let (light, dark) = (variables(true), variables(false));
        let frame = |&(_, name, what, ..): &(RGBColor, &str, &str, &str, &str)| {
            let property = if what == "text" { "fill" } else { "stroke" };
            format!("svg.plot {what} {{ {property}: var(--{name}); }}\n")
        };
        let tone = |tone: &Tone| {
            let marker = written(tone.marker);
            let name = &marker[1..];
            format!(
                "svg.plot [stroke=\"{marker}\"] {{ stroke: var(--{name}); }}\n\
                 svg.plot [fill=\"{marker}\"] {{ fill: var(--{name}); }}\n"
            )
        };
        // A drawing of class `light` is that of a light page anywhere, so that it can be saved.
        format!(
            "svg.plot {{ {light}}}\n\
             @media (prefers-color-scheme: dark) {{ svg.plot:not(.light) {{ {dark}}} }}\n\
             @media print {{ svg.plot, svg.plot:not(.light) {{ {light}}} }}\n\
             {}{}{}",
            include_str!("style.css"),
            FRAME.iter().map(frame).collect::<String>(),
            all().map(tone).collect::<String>()
        )
    });
    &STYLE
}

/// The drawing with the colours of a light page in the place of the markers, for programs that read no style sheets.
pub(super) fn fixed(drawing: &str) -> String {
    let mut text = drawing.replace("fill=\"#111111\"", "fill=\"#000000\"");
    let frame = FRAME.iter().filter(|(_, name, ..)| *name != "ink");
    let frame = frame.map(|&(marker, _, _, light, _)| (marker, light));
    for (marker, light) in frame.chain(all().map(|tone| (tone.marker, tone.light))) {
        let marker = written(marker);
        let (colour, opacity) = light.split_at(7);
        for property in ["stroke", "fill"] {
            let transparency = match u8::from_str_radix(opacity, 16) {
                Ok(share) => format!(" {property}-opacity=\"{:.3}\"", f64::from(share) / 255.0),
                Err(_) => String::new(),
            };
            text = text.replace(
                &format!("{property}=\"{marker}\""),
                &format!("{property}=\"{colour}\"{transparency}"),
            );
        }
    }
    text
}
