//! Small parts that the paper's figures share.

use crate::svg::{Frame, styled_line, text};

/// Colours of curves, told apart by lightness too.
pub const COLOURS: [&str; 6] = ["#1a365d", "#2b6cb0", "#38a169", "#d69e2e", "#dd6b20", "#c53030"];

/// The `index`th entry of a figure's key, above its frame.
pub fn key(frame: &Frame, index: usize, name: &str, colour: &str) -> String {
    let left = frame.left + 110.0 * index as f64;
    let y = frame.top - 12.0;
    let style = format!("stroke=\"{colour}\" stroke-width=\"3\"");
    styled_line([left, y], [left + 18.0, y], &style)
        + &text(left + 23.0, y + 4.0, "start", 11, name)
}
