//! A study as one HTML page that needs nothing else: figures inside as SVG, and beside it as files with
//! their data.

pub mod campaign;
pub mod design;
pub mod design_figures;
pub mod figures;
pub mod map;
pub mod rare;

use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::csv::quoted;
use crate::landing::{Error, write_whole};
use crate::study::shard::{BUILD, VERSION};
use crate::study::{Study, StudyError};
use crate::svg::escaped;

/// A figure and the numbers in it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Of its files.
    pub name: String,
    pub caption: String,
    pub svg: String,
    pub csv: String,
}

/// A table that is also a file.
#[derive(Clone, Debug, Serialize)]
pub struct Table {
    /// Of its file.
    pub name: String,
    pub caption: String,
    pub header: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Columns without any cell that begins with a number.
    fn columns_of_words(&self) -> impl Iterator<Item = usize> {
        let number = |cell: &String| {
            cell.split([' ', '<']).find(|w| !w.is_empty()).is_some_and(|w| w.parse::<f64>().is_ok())
        };
        let words =
            move |column: &usize| !self.rows.iter().filter_map(|row| row.get(*column)).any(number);
        (0..self.header.len()).filter(words)
    }

    /// The cells as the page shows them.
    pub fn csv(&self) -> String {
        let lines = std::iter::once(&self.header).chain(&self.rows);
        lines
            .map(|cells| cells.iter().map(|c| quoted(c)).collect::<Vec<_>>().join(",") + "\n")
            .collect()
    }
}

/// Columns of words beyond these are not laid out as such.
const COLUMNS: usize = 15;

/// Styles of the classes `w1`, `w2` …: a column of words is read from the left.
fn style_of_words() -> String {
    let column = |n: usize| format!(".w{n} td:nth-child({n}),.w{n} th:nth-child({n})");
    let columns: Vec<String> = (1..=COLUMNS).map(column).collect();
    columns.join(",") + "{text-align:left}"
}

/// A page as it is written.
pub struct Page {
    title: String,
    body: String,
    figures: Vec<Figure>,
    tables: Vec<Table>,
}

const STYLE: &str = "body{font:15px/1.45 sans-serif;max-width:1040px;margin:2em auto;padding:0 1em;color:#222}\
    table{border-collapse:collapse;margin:.6em 0}td,th{border:1px solid #ccc;padding:.2em .6em;text-align:right}\
    th{background:#f2f2f2}td:first-child,th:first-child,.t td,.t th{text-align:left}\
    pre{background:#f6f6f6;padding:.8em;overflow:auto;font-size:13px}figure{margin:1.2em 0}\
    figcaption,.caption{color:#555;font-size:13px;max-width:760px}.caption{margin-top:0}svg{max-width:100%;height:auto}";

impl Page {
    pub fn new(title: &str) -> Self {
        Self {
            title: title.to_owned(),
            body: String::new(),
            figures: Vec::new(),
            tables: Vec::new(),
        }
    }

    pub fn heading(&mut self, words: &str) {
        self.body += &format!("<h2>{}</h2>\n", escaped(words));
    }

    pub fn paragraph(&mut self, words: &str) {
        self.body += &format!("<p>{}</p>\n", escaped(words));
    }

    pub fn code(&mut self, words: &str) {
        self.body += &format!("<pre>{}</pre>\n", escaped(words));
    }

    /// Long text behind a click.
    pub fn folded(&mut self, title: &str, words: &str) {
        let (title, words) = (escaped(title), escaped(words));
        self.body += &format!("<details><summary>{title}</summary><pre>{words}</pre></details>\n");
    }

    /// `class` is `t` for a table of words, empty for one of numbers.
    pub fn table(&mut self, class: &str, header: &[&str], rows: &[Vec<String>]) {
        let row = |tag: &str, cells: Vec<String>| {
            let cells: String =
                cells.iter().map(|c| format!("<{tag}>{}</{tag}>", escaped(c))).collect();
            format!("<tr>{cells}</tr>\n")
        };
        self.body += &format!("<table class=\"{class}\">\n");
        self.body += &row("th", header.iter().map(|cell| (*cell).to_owned()).collect());
        for cells in rows {
            self.body += &row("td", cells.clone());
        }
        self.body += "</table>\n";
    }

    /// A table with its own file, behind a click.
    pub fn folded_table(&mut self, title: &str, table: Table) {
        self.body += &format!("<details><summary>{}</summary>\n", escaped(title));
        self.filed_table(table);
        self.body += "</details>\n";
    }

    /// A table with its own file.
    pub fn filed_table(&mut self, table: Table) {
        let header: Vec<&str> = table.header.iter().map(String::as_str).collect();
        let class: Vec<String> =
            table.columns_of_words().map(|column| format!("w{}", column + 1)).collect();
        self.table(&class.join(" "), &header, &table.rows);
        self.body += &format!(
            "<p class=\"caption\">{} Data: tables/{}.csv.</p>\n",
            escaped(&table.caption),
            table.name
        );
        self.tables.push(table);
    }

    pub fn figure(&mut self, figure: Figure) {
        self.body += &format!(
            "<figure>{}<figcaption>{} Data: figures/{}.csv.</figcaption></figure>\n",
            figure.svg,
            escaped(&figure.caption),
            figure.name
        );
        self.figures.push(figure);
    }

    /// What the rows come from.
    pub fn origin(&mut self, study: &Study) {
        self.paragraph(&format!(
            "Version {VERSION}, build {BUILD}, seed {}, SHA-256 of study, scenario, vehicle and map {}.",
            study.seed, study.hash
        ));
    }

    /// What every study's page ends with.
    pub fn study_file(&mut self, study: &Study) {
        self.heading("The files");
        self.folded(&format!("{}.toml, the study", study.name), &study.text);
        let [scenario, vehicle] = [&study.scenario_file, &study.vehicle_file]
            .map(|file| file.file_name().unwrap_or_default().to_string_lossy());
        self.folded(&format!("{scenario}, the scenario as read"), &study.scenario.to_string());
        self.folded(&format!("{vehicle}, the vehicle as read"), &study.vehicle.to_string());
    }

    pub fn to_html(&self) -> String {
        let (title, body, words) = (escaped(&self.title), &self.body, style_of_words());
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title>\n\
             <style>{STYLE}{words}</style></head>\n<body>\n<h1>{title}</h1>\n{body}</body></html>\n"
        )
    }

    /// Writes `NAME.html` and the files of figures and tables.
    pub fn write(&self, folder: &Path, name: &str) -> Result<(), Error> {
        let figures = made(folder.join("figures"))?;
        if !self.tables.is_empty() {
            let tables = made(folder.join("tables"))?;
            for table in &self.tables {
                write_whole(&tables.join(format!("{}.csv", table.name)), &table.csv())?;
            }
        }
        for figure in &self.figures {
            write_whole(&figures.join(format!("{}.svg", figure.name)), &figure.svg)?;
            write_whole(&figures.join(format!("{}.csv", figure.name)), &figure.csv)?;
        }
        write_whole(&folder.join(format!("{name}.html")), &self.to_html())
    }
}

fn made(folder: PathBuf) -> Result<PathBuf, Error> {
    fs::create_dir_all(&folder)
        .map_err(|source| StudyError::File { file: folder.clone(), source })?;
    Ok(folder)
}

/// A share as per cent with its bounds.
pub fn percent([share, low, high]: [f64; 3]) -> [String; 2] {
    let [share, low, high] = [share, low, high].map(|share| 100.0 * share);
    [format!("{share:.2} %"), format!("{low:.3} to {high:.3} %")]
}
