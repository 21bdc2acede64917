//! From a figure to the bytes of its files.

use base64::Engine;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

/// DejaVu Sans, cut down to the characters that reports use, so that text looks the same on machines without fonts.
const FONT: &[u8] = include_bytes!("../../../assets/dejavu-sans-subset.ttf");
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

/// Draws a figure in both formats.
pub fn render(figure: &impl Figure) -> Result<Rendered, PlotError> {
    Ok(Rendered { svg: svg(figure)?, png: png(figure)? })
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
