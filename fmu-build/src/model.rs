//! The models that are packed, and their names. All names follow from `Interface::model`.

use fmi_adapter::Variant;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};

pub const MODELS: [&Interface; 2] = [&TRUTH, &GUIDANCE];

/// `lander_truth`: the model name as a C identifier.
pub fn identifier(interface: &Interface) -> String {
    interface.model.replace('-', "_")
}

/// `lander-truth.fmi3.fmu`.
pub fn archive_file(interface: &Interface, variant: Variant) -> String {
    format!("{}.{}.fmu", interface.model, variant.name())
}

/// `liblander_truth_fmu.so`: what cargo names the shell's library.
pub fn library_file(interface: &Interface) -> String {
    format!("lib{}_fmu.so", identifier(interface))
}

/// Where FMI looks for the library in the archive: each version has its own name for the platform.
pub fn library_entry(interface: &Interface, variant: Variant) -> String {
    let platform = if variant == Variant::Fmi2 { "linux64" } else { "x86_64-linux" };
    format!("binaries/{platform}/{}.so", identifier(interface))
}
