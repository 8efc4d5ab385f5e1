//! Charts as a file: SVG and PDF with text as text, or PNG.

use std::collections::HashMap;
use std::path::Path;

use anyhow::{Context, Result, anyhow};
use hysid_document::chart::{Appearance, PIXELS_PER_MILLIMETRE, sheet};
use hysid_document::{Chart, Problem};
use hysid_files::GENERATOR;
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, TextStr};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree};

use super::fonts;
use crate::messages::Usage;

const POINTS_PER_PIXEL: f32 = 72.0 / 96.0;

const PIXELS_PER_INCH: f64 = 96.0;

const MOST_DOTS: f64 = 2e8;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Scalable vector graphics.
    Svg,
    /// Portable document format.
    Pdf,
    /// Portable network graphics.
    Png,
}

impl Format {
    /// Format by the ending of a file name.
    pub fn of(path: &Path) -> Result<Self> {
        match path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("pdf") => Ok(Self::Pdf),
            Some("png") => Ok(Self::Png),
            _ => Err(Problem::request(format!(
                "{}: the ending tells the format of the figure: .svg, .pdf or .png",
                crate::files::shown(path)
            ))
            .into()),
        }
    }
}

/// How a figure looks on paper.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    pub width: f64,
    /// Height, in millimetres; `None` for that of the charts.
    pub height: Option<f64>,
    /// Family of the font, or `serif` or `sans-serif`.
    pub font: String,
    /// Size of the text, in points.
    pub points: f64,
    pub dots_per_inch: f64,
}

impl Style {
    pub fn pixels(&self) -> f64 {
        self.width * PIXELS_PER_MILLIMETRE
    }
}

/// The charts as the content of a file. Charts that are half as wide as the figure stand side by side.
///
/// # Errors
/// A machine without fonts, a height that has no room for the charts, a PNG that is too large.
pub fn drawing(charts: Vec<Chart>, style: &Style, format: Format, title: &str) -> Result<Vec<u8>> {
    let are_side_by_side = charts.iter().all(|chart| chart.size.0 < 0.75 * style.pixels());
    let columns = if are_side_by_side { 2 } else { 1 };
    if format == Format::Svg {
        let appearance = Appearance::of_print(fonts::as_style(&style.font), style.points);
        let charts = in_height(charts, columns, style, &appearance)?;
        return Ok(sheet(&charts, columns, &appearance, title, GENERATOR).into_bytes());
    }
    let (database, family) = fonts::found(&style.font)?;
    let appearance = Appearance::of_print(family, style.points);
    let charts = in_height(charts, columns, style, &appearance)?;
    let drawing = sheet(&charts, columns, &appearance, title, GENERATOR);
    let options = Options { fontdb: database, ..Options::default() };
    let tree = Tree::from_str(&drawing, &options).context("the drawing cannot be read")?;
    match format {
        Format::Pdf => pdf(&tree, title),
        _ => png(&tree, style.dots_per_inch, title),
    }
}

/// The charts in the height that is asked for.
fn in_height(
    charts: Vec<Chart>,
    columns: usize,
    style: &Style,
    appearance: &Appearance,
) -> Result<Vec<Chart>> {
    let Some(height) = style.height else { return Ok(charts) };
    let rows: Vec<f64> =
        charts.chunks(columns).map(|row| row.iter().map(|chart| chart.size.1).fold(0.0, f64::max)).collect();
    let gaps = appearance.row_gap() * (rows.len() - 1) as f64;
    let factor = (height * PIXELS_PER_MILLIMETRE - gaps) / rows.iter().sum::<f64>();
    let charts: Vec<Chart> = charts
        .into_iter()
        .map(|chart| {
            let height = factor * chart.size.1;
            chart.with_height(height)
        })
        .collect();
    match charts.iter().all(Chart::has_room) {
        true => Ok(charts),
        false => Err(Usage(format!(
            "--height {height} has no room for {}: choose more, or draw fewer with --only",
            hysid_document::count(charts.len(), "chart")
        ))
        .into()),
    }
}

/// A page of the drawing's size.
fn pdf(tree: &Tree, title: &str) -> Result<Vec<u8>> {
    let (chunk, drawing) = svg2pdf::to_chunk(tree, svg2pdf::ConversionOptions::default())
        .map_err(|error| anyhow!("the drawing cannot be written as PDF: {error}"))?;
    let mut next = Ref::new(1);
    let [info, catalog, pages, page, content] = std::array::from_fn(|_| next.bump());
    let mut numbers = HashMap::new();
    let chunk = chunk.renumber(|old| *numbers.entry(old).or_insert_with(|| next.bump()));
    let drawing = numbers[&drawing];
    let size = tree.size();
    let (width, height) = (POINTS_PER_PIXEL * size.width(), POINTS_PER_PIXEL * size.height());
    let name = Name(b"drawing");
    let mut pdf = Pdf::new();
    // First, so that Hysid finds its name near the beginning of the file.
    pdf.document_info(info).creator(TextStr(GENERATOR)).title(TextStr(title));
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut written = pdf.page(page);
    written.media_box(Rect::new(0.0, 0.0, width, height)).parent(pages).contents(content);
    written.resources().x_objects().pair(name, drawing);
    written.finish();
    let mut stream = Content::new();
    // The drawing is one unit wide and high.
    stream.transform([width, 0.0, 0.0, height, 0.0, 0.0]).x_object(name);
    pdf.stream(content, &stream.finish());
    pdf.extend(&chunk);
    Ok(pdf.finish())
}

/// Dots, with their distance, the title and the name of the program.
fn png(tree: &Tree, dots_per_inch: f64, title: &str) -> Result<Vec<u8>> {
    let scale = dots_per_inch / PIXELS_PER_INCH;
    let side = |pixels: f32| (scale * f64::from(pixels)).round();
    let (width, height) = (side(tree.size().width()), side(tree.size().height()));
    if width * height > MOST_DOTS {
        return Err(Usage(format!(
            "a PNG of {width} x {height} dots is too large: lower --dpi, or choose PDF or SVG"
        ))
        .into());
    }
    let mut pixels = Pixmap::new(width as u32, height as u32).context("a figure without size")?;
    resvg::render(tree, Transform::from_scale(scale as f32, scale as f32), &mut pixels.as_mut());
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (dots_per_inch / 0.0254).round() as u32;
    let density = png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter };
    encoder.set_pixel_dims(Some(density));
    encoder.add_text_chunk("Software".into(), GENERATOR.into())?;
    encoder.add_itxt_chunk("Title".into(), title.into())?;
    let mut writer = encoder.write_header()?;
    // The background is opaque, so that there is no transparency to store.
    let colours: Vec<u8> =
        pixels.pixels().iter().flat_map(|dot| [dot.red(), dot.green(), dot.blue()]).collect();
    writer.write_image_data(&colours)?;
    writer.finish()?;
    Ok(bytes)
}
