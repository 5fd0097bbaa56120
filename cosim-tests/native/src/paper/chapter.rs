//! A chapter of the report: what the paper prints, what this kit finds, and why they differ.

use serde_json::json;

use crate::report::{Figure, Page, Table};

/// In the order in which they are read.
enum Block {
    Words(String),
    Differs(String),
    Table(Table),
    Figure(Figure),
}

pub struct Chapter {
    title: String,
    blocks: Vec<Block>,
}

impl Chapter {
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), blocks: Vec::new() }
    }

    pub fn words(&mut self, words: impl Into<String>) {
        self.blocks.push(Block::Words(words.into()));
    }

    /// One line on what differs, and why.
    pub fn differs(&mut self, words: impl Into<String>) {
        self.blocks.push(Block::Differs(words.into()));
    }

    pub fn table(&mut self, name: &str, caption: &str, header: &[&str], rows: Vec<Vec<String>>) {
        self.blocks.push(Block::Table(Table {
            name: name.to_owned(),
            caption: caption.to_owned(),
            header: header.iter().map(|cell| (*cell).to_owned()).collect(),
            rows,
        }));
    }

    pub fn figure(&mut self, figure: Figure) {
        self.blocks.push(Block::Figure(figure));
    }

    /// Its tables and remarks; figures have files of their own.
    pub fn to_json(&self) -> serde_json::Value {
        let tables = self.blocks.iter().filter_map(|block| match block {
            Block::Table(table) => Some(json!(table)),
            _ => None,
        });
        let differs = self.blocks.iter().filter_map(|block| match block {
            Block::Differs(words) => Some(words),
            _ => None,
        });
        json!({
            "title": self.title,
            "differs": differs.collect::<Vec<_>>(),
            "tables": tables.collect::<Vec<_>>(),
        })
    }

    pub fn print(self, page: &mut Page) {
        page.heading(&self.title);
        for block in self.blocks {
            match block {
                Block::Words(words) => page.paragraph(&words),
                Block::Differs(words) => page.paragraph(&format!("What differs: {words}")),
                Block::Table(table) => page.filed_table(table),
                Block::Figure(figure) => page.figure(figure),
            }
        }
    }
}

/// A cell with so many decimals; a zero has no sign, and an infinite bound is none.
pub fn cell(value: f64, decimals: usize) -> String {
    if value.is_infinite() {
        return "none".to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.trim_start_matches(['-', '0', '.']).is_empty() {
        true => text.trim_start_matches('-').to_owned(),
        false => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_is_rounded_and_a_zero_has_no_sign() {
        assert_eq!([cell(-0.04, 1), cell(-0.06, 1), cell(12.0, 0)], ["0.0", "-0.1", "12"]);
        assert_eq!(cell(f64::NEG_INFINITY, 2), "none");
    }
}
