//! Figures as PDF: a page of their size, text as text, in the font that they bring along.

use ab_glyph::{Font, FontRef};
use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, Str};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontTransform,
    text_anchor,
};

use super::render::FONT;

/// Points, of which an inch has 72, a pixel, of which it has 96.
const POINTS: f32 = 0.75;

/// A letter's height as plotters counts it against the size of its font, as in the other formats.
const FONT_SIZE: f32 = 1.24;

/// What a font's measures are told in.
const THOUSAND: f32 = 1000.0;

/// The name of the font on the page.
const FONT_NAME: Name<'static> = Name(b"F");
/// Its own.
const BASE_FONT: Name<'static> = Name(b"DejaVuSans");
const IDENTITY: SystemInfo<'static> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

/// Draws a figure as the only page of a document.
pub struct PdfBackend<'a> {
    size: (u32, u32),
    content: Content,
    font: FontRef<'static>,
    /// Where the document goes once it is drawn.
    bytes: &'a mut Vec<u8>,
}

/// The document has no form: its font is broken.
#[derive(Debug, thiserror::Error)]
#[error("its font is broken")]
pub struct BrokenFont;

type Drawn = Result<(), DrawingErrorKind<BrokenFont>>;

impl<'a> PdfBackend<'a> {
    /// A page of so many pixels.
    pub fn new(bytes: &'a mut Vec<u8>, size: (u32, u32)) -> Result<PdfBackend<'a>, BrokenFont> {
        let font = FontRef::try_from_slice(FONT).map_err(|_| BrokenFont)?;
        let mut content = Content::new();
        // Pixels from the top left.
        content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, POINTS * size.1 as f32]);
        content.set_line_join(pdf_writer::types::LineJoinStyle::MiterJoin);
        Ok(PdfBackend { size, content, font, bytes })
    }

    /// The width of a text in a font of size 1.
    fn width(&self, text: &str) -> f32 {
        text.chars().map(|letter| self.advance(self.font.glyph_id(letter).0)).sum()
    }

    fn advance(&self, glyph: u16) -> f32 {
        let em = self.font.units_per_em().unwrap_or(THOUSAND);
        self.font.h_advance_unscaled(ab_glyph::GlyphId(glyph)) / em
    }

    fn path(&mut self, points: impl IntoIterator<Item = BackendCoord>) {
        for (index, (x, y)) in points.into_iter().enumerate() {
            // The middle of a pixel.
            let (x, y) = (x as f32 + 0.5, y as f32 + 0.5);
            if index == 0 {
                self.content.move_to(x, y)
            } else {
                self.content.line_to(x, y)
            };
        }
    }

    fn stroke(&mut self, style: &impl BackendStyle) {
        let [red, green, blue] = on_white(style.color());
        self.content.set_stroke_rgb(red, green, blue).set_line_width(style.stroke_width() as f32);
    }

    fn fill(&mut self, color: BackendColor) {
        let [red, green, blue] = on_white(color);
        self.content.set_fill_rgb(red, green, blue);
    }

    /// The whole document.
    fn document(&mut self) -> Vec<u8> {
        let mut pdf = Pdf::new();
        let [catalog, pages, page, content, font, letters, about, file, unicode] =
            [1, 2, 3, 4, 5, 6, 7, 8, 9].map(Ref::new);
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([page]).count(1);
        let (width, height) = (POINTS * self.size.0 as f32, POINTS * self.size.1 as f32);
        let mut sheet = pdf.page(page);
        sheet.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
        sheet.resources().fonts().pair(FONT_NAME, font);
        sheet.finish();
        pdf.stream(content, &std::mem::replace(&mut self.content, Content::new()).finish());
        let encoding = Name(b"Identity-H");
        pdf.type0_font(font)
            .base_font(BASE_FONT)
            .encoding_predefined(encoding)
            .descendant_font(letters)
            .to_unicode(unicode);
        let mut of_letters = pdf.cid_font(letters);
        of_letters.subtype(CidFontType::Type2).base_font(BASE_FONT).system_info(IDENTITY).font_descriptor(about);
        of_letters.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let glyphs = self.font.glyph_count() as u16;
        of_letters.widths().consecutive(0, (0..glyphs).map(|glyph| THOUSAND * self.advance(glyph)));
        of_letters.finish();
        let em = self.font.units_per_em().unwrap_or(THOUSAND);
        let [ascent, descent] =
            [self.font.ascent_unscaled(), self.font.descent_unscaled()].map(|unscaled| THOUSAND * unscaled / em);
        let mut descriptor = pdf.font_descriptor(about);
        descriptor.name(BASE_FONT).flags(FontFlags::SYMBOLIC).bbox(Rect::new(
            -THOUSAND,
            descent,
            2.0 * THOUSAND,
            ascent,
        ));
        descriptor
            .italic_angle(0.0)
            .ascent(ascent)
            .descent(descent)
            .cap_height(0.73 * THOUSAND)
            .stem_v(80.0)
            .font_file2(file);
        descriptor.finish();
        pdf.stream(file, FONT).pair(Name(b"Length1"), FONT.len() as i32);
        let mut meaning = UnicodeCmap::new(Name(b"Letters"), IDENTITY);
        let mut letters: Vec<(u16, char)> =
            self.font.codepoint_ids().map(|(glyph, letter)| (glyph.0, letter)).collect();
        letters.sort_unstable();
        letters.iter().for_each(|&(glyph, letter)| meaning.pair(glyph, letter));
        pdf.cmap(unicode, &meaning.finish());
        pdf.finish()
    }
}

/// A colour as it looks on white, each part from 0 to 1.
fn on_white(color: BackendColor) -> [f32; 3] {
    let part = |part: u8| (1.0 - color.alpha * (1.0 - f64::from(part) / 255.0)) as f32;
    [part(color.rgb.0), part(color.rgb.1), part(color.rgb.2)]
}

impl DrawingBackend for PdfBackend<'_> {
    type ErrorType = BrokenFont;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    fn present(&mut self) -> Drawn {
        if self.bytes.is_empty() {
            *self.bytes = self.document();
        }
        Ok(())
    }

    fn draw_pixel(&mut self, point: BackendCoord, color: BackendColor) -> Drawn {
        self.fill(color);
        self.content.rect(point.0 as f32, point.1 as f32, 1.0, 1.0).fill_nonzero();
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.draw_path([from, to], style)
    }

    fn draw_rect<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S, fill: bool) -> Drawn {
        if style.color().alpha == 0.0 {
            return Ok(());
        }
        let (left, top) = (from.0.min(to.0) as f32, from.1.min(to.1) as f32);
        let (width, height) = ((from.0 - to.0).abs() as f32, (from.1 - to.1).abs() as f32);
        if fill {
            self.fill(style.color());
            self.content.rect(left, top, width, height).fill_nonzero();
        } else {
            self.stroke(style);
            self.content.rect(left + 0.5, top + 0.5, width, height).stroke();
        }
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, path: I, style: &S) -> Drawn {
        if style.color().alpha > 0.0 {
            self.stroke(style);
            self.path(path);
            self.content.stroke();
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(&mut self, corners: I, style: &S) -> Drawn {
        if style.color().alpha > 0.0 {
            self.fill(style.color());
            self.path(corners);
            self.content.close_path().fill_nonzero();
        }
        Ok(())
    }

    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let size = style.size() as f32 / FONT_SIZE;
        let width = size * self.width(text);
        let left = match style.anchor().h_pos {
            text_anchor::HPos::Left => 0.0,
            text_anchor::HPos::Center => -width / 2.0,
            text_anchor::HPos::Right => -width,
        };
        let down = size
            * match style.anchor().v_pos {
                text_anchor::VPos::Top => 0.76,
                text_anchor::VPos::Center => 0.27,
                text_anchor::VPos::Bottom => -0.27,
            };
        let (cos, sin) = match style.transform() {
            FontTransform::None => (1.0, 0.0),
            FontTransform::Rotate90 => (0.0, 1.0),
            FontTransform::Rotate180 => (-1.0, 0.0),
            FontTransform::Rotate270 => (0.0, -1.0),
        };
        self.fill(style.color());
        let glyphs: Vec<u8> = text.chars().flat_map(|letter| self.font.glyph_id(letter).0.to_be_bytes()).collect();
        let (x, y) = (x as f32 + left * cos - down * sin, y as f32 + left * sin + down * cos);
        self.content.begin_text().set_font(FONT_NAME, size);
        // The page stands on its head, its letters do not.
        self.content.set_text_matrix([cos, sin, sin, -cos, x, y]).show(Str(&glyphs)).end_text();
        Ok(())
    }
}
