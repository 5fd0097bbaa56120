//! What the tests prove, told once: a test measures and asserts a claim in one call, which leaves
//! a record; `cargo verify` renders docs/VALIDATION.md from the records. For tests only.

mod record;
mod render;

use std::panic::Location;
use std::path::PathBuf;

pub use record::{Record, clear, records_folder};
pub use render::render;

/// What a measured value must satisfy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Its magnitude, at most.
    AtMost(f64),
    AtLeast(f64),
}

impl Bound {
    /// Never by NaN.
    pub fn holds(self, measured: f64) -> bool {
        match self {
            Self::AtMost(limit) => measured.abs() <= limit,
            Self::AtLeast(limit) => measured >= limit,
        }
    }

    /// Whether `a` comes nearer to breaking the bound than `b`.
    fn worse(self, a: f64, b: f64) -> bool {
        match self {
            _ if b.is_nan() => false,
            _ if a.is_nan() => true,
            Self::AtMost(_) => a.abs() > b.abs(),
            Self::AtLeast(_) => a < b,
        }
    }
}

/// A property of the kit, what it is held against, and how closely.
#[derive(Clone, Copy, Debug)]
#[must_use = "a claim is only told once it is asserted: call `holds`"]
pub struct Claim<'a> {
    /// Unique in the workspace: letters, digits and dashes.
    pub id: &'a str,
    /// Heading that it is told under.
    pub section: &'a str,
    pub claim: &'a str,
    /// What nobody here wrote: a closed form, another engine, published numbers.
    pub reference: &'a str,
    /// Of the measured value and the bound; empty for a pure number.
    pub unit: &'a str,
    pub bound: Bound,
    /// Where the bound comes from.
    pub origin: &'a str,
    /// Results smaller than this are rounding noise, or below what the method resolves, and told
    /// as such: another processor may round otherwise. 0 where there is none.
    pub noise: f64,
}

impl Claim<'_> {
    /// Asserts the bound, then records the result.
    ///
    /// # Panics
    /// If the bound is broken, or the record cannot be written.
    #[track_caller]
    pub fn holds(self, measured: f64) {
        self.holds_for([measured]);
    }

    /// Asserts the bound for each of several measurements, and records the worst.
    ///
    /// # Panics
    /// As `holds`, and if there is no measurement at all.
    #[track_caller]
    pub fn holds_for(self, measured: impl IntoIterator<Item = f64>) {
        let worst = measured.into_iter().reduce(|a, b| if self.bound.worse(a, b) { a } else { b });
        let Some(measured) = worst else { panic!("{}: nothing was measured", self.id) };
        let record = Record::of(&self, measured, place(Location::caller()));
        println!("{}: {measured:e} {}", self.claim, self.unit);
        assert!(self.bound.holds(measured), "{} is broken: {record:#?}", self.id);
        if let Err(error) = record.write(&records_folder()) {
            panic!("the record of {} cannot be written: {error}", self.id);
        }
    }
}

/// `truth-model/tests/slide.rs:33` for a caller there, from wherever it was compiled.
fn place(caller: &Location) -> String {
    let file = PathBuf::from(caller.file());
    let shown = file.strip_prefix(record::workspace()).unwrap_or(&file);
    format!("{}:{}", shown.display(), caller.line())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_holds_up_to_its_limit_and_never_for_nan() {
        assert!(Bound::AtMost(1.0).holds(-1.0) && !Bound::AtMost(1.0).holds(-1.01));
        assert!(Bound::AtLeast(3.8).holds(3.8) && !Bound::AtLeast(3.8).holds(-4.0));
        assert!(!Bound::AtMost(1.0).holds(f64::NAN) && !Bound::AtLeast(0.0).holds(f64::NAN));
    }

    #[test]
    fn the_worst_of_several_is_the_one_nearest_to_breaking_the_bound() {
        let worst = |bound: Bound, values: [f64; 3]| {
            values.into_iter().reduce(|a, b| if bound.worse(a, b) { a } else { b }).unwrap()
        };
        assert_eq!(worst(Bound::AtMost(1.0), [0.1, -0.3, 0.2]), -0.3);
        assert_eq!(worst(Bound::AtLeast(1.0), [3.0, 2.0, 4.0]), 2.0);
        assert!(worst(Bound::AtMost(1.0), [0.1, f64::NAN, 0.2]).is_nan());
        assert!(worst(Bound::AtLeast(1.0), [f64::NAN, 2.0, 4.0]).is_nan());
    }
}
