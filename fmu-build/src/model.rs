//! The models that are packed, and their names. All names follow from `Interface::model`.

use lander_models::signals::{GUIDANCE, Interface, TRUTH};

pub const MODELS: [&Interface; 2] = [&TRUTH, &GUIDANCE];

/// FMI platform tuple of the libraries.
pub const PLATFORM: &str = "x86_64-linux";

/// `lander_truth`: the model name as a C identifier.
pub fn identifier(interface: &Interface) -> String {
    interface.model.replace('-', "_")
}

/// `lander-truth.fmu`.
pub fn archive_file(interface: &Interface) -> String {
    format!("{}.fmu", interface.model)
}

/// `liblander_truth_fmu.so`: what cargo names the shell's library.
pub fn library_file(interface: &Interface) -> String {
    format!("lib{}_fmu.so", identifier(interface))
}

/// Where FMI looks for the library in the archive.
pub fn library_entry(interface: &Interface) -> String {
    format!("binaries/{PLATFORM}/{}.so", identifier(interface))
}
