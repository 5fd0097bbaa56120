//! Writes XML: elements, attributes, indentation, escapes.

use std::fmt::Write;

pub struct Xml {
    text: String,
    open: Vec<&'static str>,
}

impl Xml {
    pub fn new() -> Self {
        Self { text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(), open: vec![] }
    }

    /// `<name attributes/>`
    pub fn leaf(&mut self, name: &'static str, attributes: &[(&str, &str)]) {
        self.tag(name, attributes, "/>");
    }

    /// `<name attributes>`, what `content` writes, `</name>`
    pub fn element(
        &mut self,
        name: &'static str,
        attributes: &[(&str, &str)],
        content: impl FnOnce(&mut Self),
    ) {
        self.tag(name, attributes, ">");
        self.open.push(name);
        content(self);
        self.open.pop();
        self.indent();
        self.push(format_args!("</{name}>\n"));
    }

    pub fn finish(self) -> String {
        self.text
    }

    fn tag(&mut self, name: &str, attributes: &[(&str, &str)], end: &str) {
        self.indent();
        self.push(format_args!("<{name}"));
        for (key, value) in attributes {
            self.push(format_args!(" {key}=\"{}\"", escape(value)));
        }
        self.push(format_args!("{end}\n"));
    }

    fn indent(&mut self) {
        self.text.extend(std::iter::repeat_n("  ", self.open.len()));
    }

    fn push(&mut self, piece: std::fmt::Arguments) {
        // Writing to a String can't fail.
        let _ = self.text.write_fmt(piece);
    }
}

/// For attribute values and text; HTML takes it too.
pub fn escape(text: &str) -> String {
    let escaped = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    escaped.replace('"', "&quot;")
}
