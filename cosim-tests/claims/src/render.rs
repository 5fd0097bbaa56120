//! docs/VALIDATION.md: one table a section, one row a claim.

use std::fs;
use std::path::Path;

use crate::{Bound, Record};

const HEAD: &str = "\
# Validation

Written by `cargo verify --accept` from what the tests measured; `cargo verify` fails when it is out of date.
Each row was asserted by the test that it names: a result beyond its bound is a failed test, not a row.
Of several measurements the worst is told. Results are rounded to two digits; `< x` is below rounding or what
the method resolves.
";

/// The document of all records in `folder`.
///
/// # Errors
/// If a record cannot be read, or an id was claimed twice. The message names the record.
pub fn render(folder: &Path) -> Result<String, String> {
    let mut records = read_all(folder)?;
    records.sort_by(|a, b| (&a.section, &a.id, &a.test).cmp(&(&b.section, &b.id, &b.test)));
    let mut document = HEAD.to_owned();
    for (n, record) in records.iter().enumerate() {
        if let Some(twin) = records[..n].iter().find(|other| other.id == record.id) {
            let (id, first, second) = (&record.id, &twin.test, &record.test);
            return Err(format!("two claims are called {id}: in {first} and {second}"));
        }
        if n == 0 || records[n - 1].section != record.section {
            document.push_str(&format!("\n## {}\n\n", record.section));
            document
                .push_str("| claim | reference | result | bound | origin of the bound | test |\n");
            document.push_str("|---|---|---|---|---|---|\n");
        }
        document.push_str(&row(record));
    }
    Ok(document)
}

fn read_all(folder: &Path) -> Result<Vec<Record>, String> {
    let named = |what: &Path, error: String| format!("{}: {error}", what.display());
    let entries = fs::read_dir(folder).map_err(|error| named(folder, error.to_string()))?;
    entries
        .map(|entry| {
            let path = entry.map_err(|error| named(folder, error.to_string()))?.path();
            let text =
                fs::read_to_string(&path).map_err(|error| named(&path, error.to_string()))?;
            Record::parse(&text).map_err(|error| named(&path, error))
        })
        .collect()
}

fn row(record: &Record) -> String {
    let with_unit = |figure: String| match record.unit.as_str() {
        "" => figure,
        unit if unit.starts_with('°') => format!("{figure}{unit}"),
        unit => format!("{figure} {unit}"),
    };
    let result = if record.measured.abs() < record.noise {
        format!("< {}", rounded(record.noise, 2))
    } else {
        rounded(record.measured, 2)
    };
    let bound = match record.bound {
        Bound::AtMost(limit) => format!("≤ {}", rounded(limit, 3)),
        Bound::AtLeast(limit) => format!("≥ {}", rounded(limit, 3)),
    };
    let cells = [
        record.claim.clone(),
        record.reference.clone(),
        with_unit(result),
        with_unit(bound),
        record.origin.clone(),
        format!("`{}`", record.test.split(':').next().unwrap_or_default()),
    ];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

/// So many significant digits, whole numbers whole: decimals where they are few, else a power of
/// ten.
fn rounded(value: f64, digits: usize) -> String {
    if value.fract() == 0.0 && value.abs() < 1e6 {
        return format!("{value:.0}");
    }
    let short = format!("{value:.0$e}", digits - 1);
    let rounded: f64 = short.parse().unwrap_or(value);
    if (1e-3..1e6).contains(&rounded.abs()) { format!("{rounded}") } else { format!("{rounded:e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn record(id: &str, section: &str, test: &str, measured: f64) -> Record {
        Record {
            id: id.into(),
            section: section.into(),
            claim: "error".into(),
            reference: "|v|".into(),
            unit: "m".into(),
            bound: Bound::AtMost(1e-4),
            origin: "list".into(),
            noise: 1e-12,
            measured,
            test: test.into(),
        }
    }

    #[test]
    fn figures_have_few_digits_and_whole_numbers_all_of_them() {
        let cases = [
            (0.0, "0"),
            (217.0, "217"),
            (0.012_34, "0.012"),
            (-0.996, "-1"),
            (2.34e-7, "2.3e-7"),
            (1234.5, "1200"),
        ];
        for (value, shown) in cases {
            assert_eq!(rounded(value, 2), shown);
        }
    }

    #[test]
    fn rows_are_sorted_noise_is_called_so_and_ids_are_unique() {
        let folder = std::env::temp_dir().join(format!("claims-{}", std::process::id()));
        let records = [
            record("b", "Two", "t.rs:1", 1e-13),
            record("a", "Two", "t.rs", 0.5e-4),
            record("c", "One", "t.rs", -2e-5),
        ];
        records.iter().for_each(|record| record.write(&folder).unwrap());
        let document = render(&folder).unwrap();
        let rows: Vec<_> = document.lines().filter(|line| line.starts_with("| error")).collect();
        let expected = ["-2e-5 m", "5e-5 m", "< 1e-12 m"]
            .map(|result| format!("| error | \\|v\\| | {result} | ≤ 1e-4 m | list | `t.rs` |"));
        assert_eq!(rows, expected);
        record("a", "Other", "t.rs:9", 0.0).write(&folder).unwrap();
        let error = render(&folder).unwrap_err();
        crate::clear(&folder).unwrap();
        assert!(error.contains("a: in t.rs:9 and t.rs"), "{error}");
    }
}
