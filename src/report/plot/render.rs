//! From a figure to the bytes of its files.

use base64::Engine;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

use super::pdf::PdfBackend;

/// DejaVu Sans, cut down to the characters that reports use, so that text looks the same on machines without fonts.
pub const FONT: &[u8] = include_bytes!("../../../assets/dejavu-sans-subset.ttf");
/// Its name in pictures.
pub const FONT_NAME: &str = "DejaVu Sans";

/// A picture could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("a picture cannot be drawn: {0}")]
pub struct PlotError(String);

impl PlotError {
    pub(in crate::report) fn new(why: String) -> PlotError {
        PlotError(why)
    }
}

/// A picture's files.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// As text.
    pub svg: String,
    /// As pixels.
    pub png: Vec<u8>,
    /// As a page.
    pub pdf: Vec<u8>,
}

/// What a picture can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Format {
    /// Lines and text, for browsers and for other programs to change.
    Svg,
    /// Pixels.
    Png,
    /// A page, for documents.
    Pdf,
}

impl Format {
    /// How its files end.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Svg => "svg",
            Format::Png => "png",
            Format::Pdf => "pdf",
        }
    }
}

impl Rendered {
    /// The file of a format.
    pub fn bytes(&self, format: Format) -> &[u8] {
        match format {
            Format::Svg => self.svg.as_bytes(),
            Format::Png => &self.png,
            Format::Pdf => &self.pdf,
        }
    }
}

/// What can be drawn on any backend.
pub trait Figure {
    /// Width and height, in pixels.
    fn size(&self) -> (u32, u32);

    /// Draws it on an area of that size.
    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>) -> Drawn<DB>;
}

/// How drawing on a backend ends.
pub type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

/// Makes the font known; to be called before anything is drawn.
pub fn bring_font() -> Result<(), PlotError> {
    register_font(FONT_NAME, FontStyle::Normal, FONT).map_err(|_| PlotError("its font is broken".to_owned()))
}

/// Draws a figure in all formats.
pub fn render(figure: &impl Figure) -> Result<Rendered, PlotError> {
    Ok(Rendered { svg: svg(figure)?, png: png(figure)?, pdf: pdf(figure)? })
}

/// The same with a size in cm, which the files tell, if there is one.
pub fn render_in(figure: &impl Figure, cm: Option<(f64, f64)>) -> Result<Rendered, PlotError> {
    let mut rendered = render(figure)?;
    if let Some((width, height)) = cm {
        let (across, down) = figure.size();
        let in_pixels = format!("<svg width=\"{across}\" height=\"{down}\"");
        rendered.svg = rendered.svg.replacen(&in_pixels, &format!("<svg width=\"{width}cm\" height=\"{height}cm\""), 1);
    }
    Ok(rendered)
}

/// Pixels of an inch, as CSS and PDF have them, and centimetres.
const PIXELS_AN_INCH: f64 = 96.0;
const CM_AN_INCH: f64 = 2.54;

/// A size in cm in pixels.
pub fn pixels((width, height): (f64, f64)) -> (u32, u32) {
    let pixels = |cm: f64| (cm / CM_AN_INCH * PIXELS_AN_INCH).round() as u32;
    (pixels(width), pixels(height))
}

fn pdf(figure: &impl Figure) -> Result<Vec<u8>, PlotError> {
    let mut bytes = Vec::new();
    let backend = PdfBackend::new(&mut bytes, figure.size()).map_err(|error| PlotError(error.to_string()))?;
    draw_on(figure, backend)?;
    Ok(bytes)
}

fn svg(figure: &impl Figure) -> Result<String, PlotError> {
    let mut text = String::new();
    draw_on(figure, SVGBackend::with_string(&mut text, figure.size()))?;
    // The font travels with the picture.
    let font = base64::engine::general_purpose::STANDARD.encode(FONT);
    let style =
        format!("<style>@font-face{{font-family:\"{FONT_NAME}\";src:url(data:font/ttf;base64,{font})}}</style>\n");
    let body = text.find("<svg").and_then(|start| text[start..].find('>').map(|end| start + end + 1)).unwrap_or(0);
    text.insert_str(body, &style);
    Ok(text)
}

fn png(figure: &impl Figure) -> Result<Vec<u8>, PlotError> {
    let (width, height) = figure.size();
    let mut pixels = vec![0; (width * height * 3) as usize];
    draw_on(figure, BitMapBackend::with_buffer(&mut pixels, (width, height)))?;
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    // Twice to three times as large as the best, and many times as fast.
    encoder.set_compression(png::Compression::Fast);
    let failed = |error: png::EncodingError| PlotError(error.to_string());
    let mut writer = encoder.write_header().map_err(failed)?;
    writer.write_image_data(&pixels).map_err(failed)?;
    writer.finish().map_err(failed)?;
    Ok(bytes)
}

fn draw_on<DB: DrawingBackend>(figure: &impl Figure, backend: DB) -> Result<(), PlotError> {
    let area = backend.into_drawing_area();
    let drawn = area.fill(&WHITE).and_then(|()| figure.draw(&area)).and_then(|()| area.present());
    drawn.map_err(|error| PlotError(error.to_string()))
}
