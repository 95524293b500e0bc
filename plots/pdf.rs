//! A drawing as PDF with its texts as texts, for papers: one page of the size of the drawing.
//!
//! Only the letters that a drawing has are taken over from the built-in font. A pixel is 1/96 of an inch, as for browsers.

use std::collections::BTreeMap;

use pdf_writer::types::{CidFontType, FontFlags, LineJoinStyle, SystemInfo, UnicodeCmap};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, Str, TextStr};
use subsetter::GlyphRemapper;
use ttf_parser::{Face, GlyphId};

use crate::PlotError;
use crate::canvas::{Align, Canvas, Colour, Item, Spot, Stroke, Text};
use crate::png::in_built_in_font;
use crate::style;

/// Points to a pixel.
const POINT: f32 = 0.75;

/// A quarter of a circle as a curve of third order: how far its inner points lie from its ends, over the radius.
const QUARTER: f64 = 0.552_284_749_830_793_5;

/// How strongly streams are packed, 0 to 10.
const PACKED: u8 = 6;

/// Both cuts of the built-in font: name in the page, name of the font, file.
const CUTS: [(Name<'_>, &str, &[u8]); 2] =
    [(Name(b"R"), "NotoSans", notosans::REGULAR_TTF), (Name(b"B"), "NotoSans-Bold", notosans::BOLD_TTF)];

/// How glyphs are called in a page: by their numbers.
const IDENTITY: SystemInfo<'_> = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };

impl Canvas {
    /// The drawing as PDF.
    ///
    /// # Errors
    ///
    /// If the built-in font is refused.
    pub fn pdf(&self) -> Result<Vec<u8>, PlotError> {
        let [mut regular, mut bold] = [Cut::new(0)?, Cut::new(1)?];
        let content = page(self, &mut regular, &mut bold);
        let mut ids = (1..).map(Ref::new);
        let mut next = || ids.next().unwrap_or(Ref::new(i32::MAX));
        let (catalog, pages, one, stream, info) = (next(), next(), next(), next(), next());
        let mut pdf = Pdf::new();
        pdf.catalog(catalog).pages(pages);
        pdf.pages(pages).kids([one]).count(1);
        pdf.document_info(info).title(TextStr(&self.title)).producer(TextStr("frazil"));
        let used: Vec<(Ref, &Cut)> =
            [&regular, &bold].into_iter().filter(|cut| !cut.letters.is_empty()).map(|cut| (next(), cut)).collect();
        let mut sheet = pdf.page(one);
        sheet.media_box(Rect::new(0.0, 0.0, POINT * self.width as f32, POINT * self.height as f32));
        sheet.parent(pages).contents(stream);
        let mut resources = sheet.resources();
        let mut fonts = resources.fonts();
        for (id, cut) in &used {
            fonts.pair(CUTS[cut.which].0, *id);
        }
        fonts.finish();
        resources.finish();
        sheet.finish();
        pdf.stream(stream, &packed(&content)).filter(Filter::FlateDecode);
        for (id, cut) in used {
            cut.embed(&mut pdf, id, [next(), next(), next(), next()])?;
        }
        Ok(pdf.finish())
    }
}

fn packed(bytes: &[u8]) -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(bytes, PACKED)
}

/// A cut of the font, and the letters that are used of it.
struct Cut {
    which: usize,
    face: Face<'static>,
    glyphs: GlyphRemapper,
    /// What each glyph in use stands for, and its width in thousandths of the size.
    letters: BTreeMap<u16, (char, f32)>,
}

impl Cut {
    fn new(which: usize) -> Result<Self, PlotError> {
        let face = Face::parse(CUTS[which].2, 0).map_err(|_| PlotError::Font)?;
        Ok(Cut { which, face, glyphs: GlyphRemapper::new(), letters: BTreeMap::new() })
    }

    /// Lengths of the font in thousandths of the size.
    fn thousandths(&self, units: f32) -> f32 {
        1000.0 * units / f32::from(self.face.units_per_em())
    }

    /// A text as numbers of glyphs, and its width over the size.
    fn set(&mut self, text: &str) -> (Vec<u8>, f64) {
        let (mut numbers, mut width) = (Vec::with_capacity(2 * text.len()), 0.0);
        for (meant, shown) in text.chars().zip(in_built_in_font(text).chars()) {
            let glyph = self.face.glyph_index(shown).unwrap_or(GlyphId(0));
            let own = self.thousandths(f32::from(self.face.glyph_hor_advance(glyph).unwrap_or(0)));
            let number = self.glyphs.remap(glyph.0);
            self.letters.insert(number, (meant, own));
            numbers.extend(number.to_be_bytes());
            width += f64::from(own) / 1000.0;
        }
        (numbers, width)
    }

    /// Writes the font with the letters that are used.
    fn embed(&self, pdf: &mut Pdf, id: Ref, [cid, descriptor, cmap, file]: [Ref; 4]) -> Result<(), PlotError> {
        let (_, name, bytes) = CUTS[self.which];
        let subset = subsetter::subset(bytes, 0, &self.glyphs).map_err(|_| PlotError::Font)?;
        // Six letters tell that it is a part of a font.
        let name = format!("FRAZIL+{name}");
        let name = Name(name.as_bytes());
        pdf.type0_font(id)
            .base_font(name)
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(cmap);
        let mut font = pdf.cid_font(cid);
        font.subtype(CidFontType::Type2).base_font(name).system_info(IDENTITY).font_descriptor(descriptor);
        font.default_width(0.0).cid_to_gid_map_predefined(Name(b"Identity"));
        let mut widths = font.widths();
        for (number, (_, width)) in &self.letters {
            widths.consecutive(*number, [*width]);
        }
        widths.finish();
        font.finish();
        let bounds = self.face.global_bounding_box();
        let [left, low, right, high] =
            [bounds.x_min, bounds.y_min, bounds.x_max, bounds.y_max].map(|edge| self.thousandths(f32::from(edge)));
        let ascent = self.thousandths(f32::from(self.face.ascender()));
        let descent = self.thousandths(f32::from(self.face.descender()));
        let capital = self.face.capital_height().map_or(ascent, |height| self.thousandths(f32::from(height)));
        pdf.font_descriptor(descriptor)
            .name(name)
            .flags(FontFlags::NON_SYMBOLIC)
            .bbox(Rect::new(left, low, right, high))
            .italic_angle(0.0)
            .ascent(ascent)
            .descent(descent)
            .cap_height(capital)
            .stem_v(if self.which == 0 { 80.0 } else { 140.0 })
            .font_file2(file);
        let mut letters = UnicodeCmap::new(Name(b"Letters"), IDENTITY);
        for (number, (letter, _)) in &self.letters {
            letters.pair(*number, *letter);
        }
        pdf.cmap(cmap, &letters.finish());
        pdf.stream(file, &packed(&subset)).filter(Filter::FlateDecode);
        Ok(())
    }
}

/// What is drawn on the page, in pixels from its upper left corner.
fn page(canvas: &Canvas, regular: &mut Cut, bold: &mut Cut) -> Vec<u8> {
    let mut content = Content::new();
    content.transform([POINT, 0.0, 0.0, -POINT, 0.0, POINT * canvas.height as f32]);
    content.set_line_join(LineJoinStyle::RoundJoin);
    fill(&mut content, Colour::WHITE);
    content.rect(0.0, 0.0, canvas.width as f32, canvas.height as f32).fill_nonzero();
    for item in &canvas.items {
        match item {
            Item::Line { points, stroke } => {
                outline(&mut content, stroke);
                path(&mut content, points);
                content.stroke();
            }
            Item::Area { ring, fill: colour } if ring.len() > 2 => {
                fill(&mut content, *colour);
                path(&mut content, ring);
                content.close_path().fill_nonzero();
            }
            Item::Area { .. } => {}
            Item::Disc { at, radius, fill: colour } => {
                fill(&mut content, *colour);
                circle(&mut content, *at, *radius);
                content.fill_nonzero();
            }
            Item::Circle { at, radius, stroke } => {
                outline(&mut content, stroke);
                circle(&mut content, *at, *radius);
                content.stroke();
            }
            Item::Text(own) => text(&mut content, own, if own.bold { bold } else { regular }),
        }
    }
    content.finish().into_vec()
}

fn shares(Colour(red, green, blue): Colour) -> [f32; 3] {
    [red, green, blue].map(|tone| f32::from(tone) / 255.0)
}

fn fill(content: &mut Content, colour: Colour) {
    let [red, green, blue] = shares(colour);
    content.set_fill_rgb(red, green, blue);
}

fn outline(content: &mut Content, stroke: &Stroke) {
    let [red, green, blue] = shares(stroke.colour);
    content.set_stroke_rgb(red, green, blue).set_line_width(stroke.width as f32);
    content.set_dash_pattern(stroke.dash.iter().map(|length| *length as f32), 0.0);
}

fn path(content: &mut Content, points: &[Spot]) {
    let mut points = points.iter().map(|(x, y)| (*x as f32, *y as f32));
    if let Some((x, y)) = points.next() {
        content.move_to(x, y);
    }
    for (x, y) in points {
        content.line_to(x, y);
    }
}

fn circle(content: &mut Content, (x, y): Spot, radius: f64) {
    let at = |across: f64, down: f64| ((x + radius * across) as f32, (y + radius * down) as f32);
    let (start_x, start_y) = at(1.0, 0.0);
    content.move_to(start_x, start_y);
    let mut from = (1.0, 0.0);
    for to in [(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)] {
        let (ax, ay) = at(from.0 + QUARTER * to.0, from.1 + QUARTER * to.1);
        let (bx, by) = at(to.0 + QUARTER * from.0, to.1 + QUARTER * from.1);
        let (end_x, end_y) = at(to.0, to.1);
        content.cubic_to(ax, ay, bx, by, end_x, end_y);
        from = to;
    }
    content.close_path();
}

fn text(content: &mut Content, text: &Text, cut: &mut Cut) {
    let (glyphs, width) = cut.set(&text.text);
    let before = text.size
        * width
        * match text.align {
            Align::Start => 0.0,
            Align::Middle => 0.5,
            Align::End => 1.0,
        };
    let (x, y) = text.at;
    let matrix = if text.upward {
        [0.0, -1.0, -1.0, 0.0, x as f32, (y + before) as f32]
    } else {
        [1.0, 0.0, 0.0, -1.0, (x - before) as f32, y as f32]
    };
    fill(content, style::INK);
    content.begin_text();
    content.set_font(CUTS[cut.which].0, text.size as f32).set_text_matrix(matrix).show(Str(&glyphs));
    content.end_text();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_has_the_size_of_the_drawing_and_the_letters_that_it_uses_alone() {
        let mut canvas = Canvas::new(400.0, 200.0, "A title");
        let blank = canvas.pdf().expect("a page");
        canvas.text((10.0, 20.0), "front (m): 10⁻³ °C −5", 16.0, Align::Start);
        canvas.upward((30.0, 40.0), "up");
        let plain = canvas.pdf().expect("a page");
        canvas.bold((10.0, 60.0), "bold", 20.0, Align::Middle);
        let both = canvas.pdf().expect("a page");
        let has = |pdf: &[u8], words: &str| pdf.windows(words.len()).any(|part| part == words.as_bytes());
        assert!(blank.starts_with(b"%PDF-") && has(&blank, "/MediaBox [0 0 300 150]") && has(&blank, "A title"));
        assert!(!has(&blank, "NotoSans") && has(&plain, "FRAZIL+NotoSans") && !has(&plain, "NotoSans-Bold"));
        assert!(has(&both, "FRAZIL+NotoSans-Bold"));
        // The whole font has half a million bytes.
        assert!(both.len() < 30_000, "{}", both.len());
        assert_eq!(both, canvas.pdf().expect("a page"), "the same bits each time");
    }

    #[test]
    fn a_text_is_as_wide_as_elsewhere() {
        let mut cut = Cut::new(0).expect("a font");
        let (numbers, width) = cut.set("closure (d)");
        assert_eq!(numbers.len(), 2 * "closure (d)".len());
        // Whole pixels of large letters, and kerning, make the difference.
        assert!((100.0 * width / crate::png::text_width("closure (d)", 100.0, false) - 1.0).abs() < 0.02);
    }
}
