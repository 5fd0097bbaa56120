//! Pictures of numbers as SVG: a frame with axes, and what is drawn in it. No fonts, scripts or files from
//! elsewhere, so a picture also stands inside an HTML page.

use std::fmt::Write;

/// A panel in pixels, and the values at its edges.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    /// Values at the left and right edge.
    pub x: [f64; 2],
    /// Values at the lower and upper edge.
    pub y: [f64; 2],
}

impl Frame {
    pub fn px(&self, x: f64) -> f64 {
        self.left + (x - self.x[0]) / (self.x[1] - self.x[0]) * self.width
    }

    pub fn py(&self, y: f64) -> f64 {
        self.top + self.height - (y - self.y[0]) / (self.y[1] - self.y[0]) * self.height
    }

    /// Border, ticks with their numbers, and words on the three sides.
    pub fn axes(&self, title: &str, x_label: &str, y_label: &str) -> String {
        self.axes_beside(title, x_label, y_label, 36.0)
    }

    /// The same, with the words of the vertical axis so many pixels from the frame.
    pub fn axes_beside(&self, title: &str, x_label: &str, y_label: &str, beside: f64) -> String {
        let Self { left, top, width, height, .. } = *self;
        let bottom = top + height;
        let mut out = format!(
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             fill=\"none\" stroke=\"#333\"/>\n"
        );
        for tick in ticks(self.x) {
            let x = self.px(tick);
            out += &line([x, bottom], [x, bottom + 4.0], "#333");
            out += &text(x, bottom + 15.0, "middle", 10, &label(tick));
        }
        for tick in ticks(self.y) {
            let y = self.py(tick);
            out += &line([left - 4.0, y], [left, y], "#333");
            out += &text(left - 6.0, y + 3.5, "end", 10, &label(tick));
        }
        out += &text(left + width / 2.0, top - 7.0, "middle", 12, title);
        out += &text(left + width / 2.0, bottom + 29.0, "middle", 11, x_label);
        let (x, y) = (left - beside, top + height / 2.0);
        let _ = writeln!(
            out,
            "<g transform=\"rotate(-90 {x:.1} {y:.1})\">{}</g>",
            text(x, y, "middle", 11, y_label).trim_end()
        );
        out
    }

    /// A rectangle of values, cut off at the frame.
    pub fn rectangle(&self, x: [f64; 2], y: [f64; 2], fill: &str) -> String {
        let [x0, x1] = x.map(|x| self.px(x.clamp(self.x[0], self.x[1])));
        let [y0, y1] = y.map(|y| self.py(y.clamp(self.y[0], self.y[1])));
        format!(
            "<rect x=\"{x0:.2}\" y=\"{y1:.2}\" width=\"{:.2}\" height=\"{:.2}\" fill=\"{fill}\" \
             shape-rendering=\"crispEdges\"/>\n",
            x1 - x0,
            y0 - y1
        )
    }

    /// A line through points, of which those outside the frame are left out.
    pub fn path(&self, points: &[[f64; 2]], style: &str) -> String {
        let inside = |[x, y]: &&[f64; 2]| {
            (self.x[0]..=self.x[1]).contains(x) && (self.y[0]..=self.y[1]).contains(y)
        };
        let pixels: Vec<String> = points
            .iter()
            .filter(inside)
            .map(|[x, y]| format!("{:.2},{:.2}", self.px(*x), self.py(*y)))
            .collect();
        format!("<polyline points=\"{}\" fill=\"none\" {style}/>\n", pixels.join(" "))
    }

    pub fn dot(&self, [x, y]: [f64; 2], radius: f64, fill: &str) -> String {
        format!(
            "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"{radius}\" fill=\"{fill}\"/>\n",
            self.px(x),
            self.py(y)
        )
    }
}

/// The whole picture around its parts.
pub fn picture(width: f64, height: f64, parts: &str) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n{parts}</svg>\n"
    )
}

pub fn line(from: [f64; 2], to: [f64; 2], stroke: &str) -> String {
    styled_line(from, to, &format!("stroke=\"{stroke}\""))
}

/// `style` is attributes, `stroke` among them.
pub fn styled_line(from: [f64; 2], to: [f64; 2], style: &str) -> String {
    format!(
        "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" {style}/>\n",
        from[0], from[1], to[0], to[1]
    )
}

/// `anchor` is `start`, `middle` or `end`.
pub fn text(x: f64, y: f64, anchor: &str, size: u32, words: &str) -> String {
    if words.is_empty() {
        return String::new();
    }
    let words = escaped(words);
    format!(
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{size}\">{words}</text>\n"
    )
}

/// Words as XML and HTML take them.
pub fn escaped(words: &str) -> String {
    words.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Some five round numbers within a range.
pub fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let raw = (high - low) / 5.0;
    if !(raw.is_finite() && raw > 0.0) {
        return Vec::new();
    }
    let power = libm::pow(10.0, libm::log10(raw).floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    let step = step.into_iter().find(|step| *step >= raw * 0.999).unwrap_or(raw);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|n| n as f64 * step).collect()
}

/// A tick's number without the tail of its rounding.
fn label(tick: f64) -> String {
    let rounded = format!("{tick:.6}");
    match tick.abs() {
        0.0 => "0".to_owned(),
        1e-3..1e6 => rounded.trim_end_matches('0').trim_end_matches('.').to_owned(),
        _ => format!("{tick:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_within() {
        assert_eq!(ticks([0.0, 3.0]), [0.0, 1.0, 2.0, 3.0]);
        assert_eq!(ticks([-0.4, 0.45]).len(), 5);
        assert!(ticks([1.0, 1.0]).is_empty() && ticks([0.0, f64::NAN]).is_empty());
        assert_eq!([0.1 + 0.2, 0.0, 2e-5, 1500.0].map(label), ["0.3", "0", "2e-5", "1500"]);
    }

    #[test]
    fn values_land_on_their_pixels_and_words_stay_words() {
        let frame = Frame {
            left: 10.0,
            top: 20.0,
            width: 100.0,
            height: 50.0,
            x: [0.0, 2.0],
            y: [1.0, 2.0],
        };
        assert_eq!((frame.px(1.0), frame.py(1.0), frame.py(2.0)), (60.0, 70.0, 20.0));
        let cut = frame.rectangle([1.0, 5.0], [0.0, 1.5], "red");
        assert!(cut.contains("x=\"60.00\" y=\"45.00\" width=\"50.00\" height=\"25.00\""), "{cut}");
        assert!(text(0.0, 0.0, "end", 9, "a < b & c").contains("a &lt; b &amp; c"));
    }
}
