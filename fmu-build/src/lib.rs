//! Packs the two shell libraries into FMUs of FMI 2.0 and 3.0, and looks into FMUs.
//!
//! Everything that an FMU says about itself is generated from the signal tables in
//! `lander_models::signals`: `description` writes the XML, `documentation` the HTML page.

mod archive;
pub mod capabilities;
pub mod check;
pub mod describe;
mod description;
mod documentation;
mod error;
mod importer;
pub mod model;
pub mod package;
pub mod platform;
pub mod ssp;
mod stamp;
mod terminals;
mod units;
pub mod vehicle;
mod xml;

pub use error::Error;
pub use stamp::Stamp;
