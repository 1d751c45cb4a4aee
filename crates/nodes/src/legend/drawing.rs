//! The legend as a picture: a dark panel, the bar, ticks and numbers in the letters of `embedded-graphics`.

use std::convert::Infallible;

use embedded_graphics::Pixel;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::ascii::{FONT_4X6, FONT_6X10, FONT_8X13, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::BinaryColor;
use embedded_graphics::prelude::Drawable;
use embedded_graphics::text::{Baseline, Text};

use super::marks::Mark;

/// Linear premultiplied colours: of the panel, and of numbers and ticks.
const PANEL: [f32; 4] = [0.0, 0.0, 0.0, 0.7];
const INK: [f32; 4] = [0.9, 0.9, 0.9, 1.0];

/// Pixels of the small legend.
const HEIGHT: u32 = 224;
const PADDING: u32 = 6;
const BAR: u32 = 10;
const GAP: u32 = 7;
const TICK: u32 = 4;
const SMALL_TICK: u32 = 2;
/// The bar ends so far before the panel, for half of a number has to stand beside its end.
const BAR_MARGIN: u32 = 10;

/// A legend at one size.
struct Form {
    /// Pixels of one pixel of the small one.
    scale: u32,
    number: &'static MonoFont<'static>,
    exponent: &'static MonoFont<'static>,
}

const FORMS: [Form; 2] = [
    Form {
        scale: 1,
        number: &FONT_6X10,
        exponent: &FONT_4X6,
    },
    Form {
        scale: 2,
        number: &FONT_10X20,
        exponent: &FONT_8X13,
    },
];

/// Two legends side by side: the small one, and one twice as large.
pub struct Drawing {
    extent: [u32; 2],
    texels: Vec<[f32; 4]>,
}

impl Drawing {
    /// Its width and height in texels.
    #[must_use]
    pub fn texels(marks: &[Mark]) -> [u32; 2] {
        [3 * width(marks), 2 * HEIGHT]
    }

    /// Draws the legends of these marks and of the linear colour at each share of the bar.
    #[must_use]
    pub fn of(marks: &[Mark], color: impl Fn(f64) -> [f64; 3]) -> Self {
        let extent = Self::texels(marks);
        let mut drawing = Self {
            extent,
            texels: vec![[0.0; 4]; extent[0] as usize * extent[1] as usize],
        };
        drawing.legend(0, &FORMS[0], marks, &color);
        drawing.legend(width(marks), &FORMS[1], marks, &color);
        drawing
    }

    /// The texels, x fastest.
    #[must_use]
    pub fn into_texels(self) -> Vec<[f32; 4]> {
        self.texels
    }

    fn legend(&mut self, left: u32, form: &Form, marks: &[Mark], color: impl Fn(f64) -> [f64; 3]) {
        let scaled = |length: u32| length * form.scale;
        self.fill([left, 0], [scaled(width(marks)), scaled(HEIGHT)], PANEL);
        let bar = left + scaled(PADDING);
        let rows = scaled(HEIGHT - 2 * BAR_MARGIN);
        for row in 0..rows {
            let share = 1.0 - (f64::from(row) + 0.5) / f64::from(rows);
            #[expect(clippy::cast_possible_truncation, reason = "colours are shown")]
            let [r, g, b] = color(share).map(|component| component as f32);
            let at = [bar, scaled(BAR_MARGIN) + row];
            self.fill(at, [scaled(BAR), 1], [r, g, b, 1.0]);
        }
        let ticks = bar + scaled(BAR);
        for mark in marks {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "shares are 0 to 1"
            )]
            let row = ((1.0 - mark.share.clamp(0.0, 1.0)) * f64::from(rows - form.scale)) as u32;
            let y = scaled(BAR_MARGIN) + row;
            let length = if mark.number.is_empty() {
                SMALL_TICK
            } else {
                TICK
            };
            self.fill([ticks, y], [scaled(length), form.scale], INK);
            self.number([ticks + scaled(GAP), y + form.scale / 2], form, mark);
        }
    }

    fn fill(&mut self, [left, top]: [u32; 2], [width, height]: [u32; 2], color: [f32; 4]) {
        for y in top..top + height {
            for x in left..left + width {
                self.set(x, y, color);
            }
        }
    }

    fn set(&mut self, x: u32, y: u32, color: [f32; 4]) {
        if x < self.extent[0] && y < self.extent[1] {
            self.texels[(y * self.extent[0] + x) as usize] = color;
        }
    }

    /// Writes a mark's number, its middle at the height of `y`.
    fn number(&mut self, [x, y]: [u32; 2], form: &Form, mark: &Mark) {
        let point = |x: u32, y: u32| Point::new(x.cast_signed(), y.cast_signed());
        let style = |font| MonoTextStyle::new(font, BinaryColor::On);
        let number = Text::with_baseline(
            &mark.number,
            point(x, y),
            style(form.number),
            Baseline::Middle,
        );
        let Ok(end) = number.draw(self);
        let raised = y.saturating_sub(form.number.character_size.height / 2);
        let exponent = Text::with_baseline(
            &mark.exponent,
            Point::new(end.x, raised.cast_signed()),
            style(form.exponent),
            Baseline::Middle,
        );
        let Ok(_) = exponent.draw(self);
    }
}

impl OriginDimensions for Drawing {
    fn size(&self) -> Size {
        Size::new(self.extent[0], self.extent[1])
    }
}

impl DrawTarget for Drawing {
    type Color = BinaryColor;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<BinaryColor>>>(
        &mut self,
        pixels: I,
    ) -> Result<(), Infallible> {
        for Pixel(at, color) in pixels {
            if let (true, Ok(x), Ok(y)) = (color.is_on(), u32::try_from(at.x), u32::try_from(at.y))
            {
                self.set(x, y, INK);
            }
        }
        Ok(())
    }
}

/// Pixels of the small legend's width: of the larger one's numbers half, so that both fit.
fn width(marks: &[Mark]) -> u32 {
    let letters = |text: &str, font: &MonoFont<'_>| {
        u32::try_from(text.len()).unwrap_or(0) * font.character_size.width
    };
    let pixels = |form: &Form, mark: &Mark| {
        let all = letters(&mark.number, form.number) + letters(&mark.exponent, form.exponent);
        all.div_ceil(form.scale)
    };
    let widths = FORMS
        .iter()
        .flat_map(|form| marks.iter().map(move |mark| pixels(form, mark)));
    PADDING + BAR + GAP + widths.max().unwrap_or(0) + PADDING
}
