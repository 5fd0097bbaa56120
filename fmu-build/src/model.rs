//! The models that are packed, and their names. All names follow from `Interface::model`.

use fmi_adapter::Variant;
use lander_models::signals::{GUIDANCE, Interface, TRUTH};

use crate::platform::Platform;

pub const MODELS: [&Interface; 2] = [&TRUTH, &GUIDANCE];

/// `lander_truth`: the model name as a C identifier.
pub fn identifier(interface: &Interface) -> String {
    interface.model.replace('-', "_")
}

/// `lander-truth.fmi3.fmu`.
pub fn archive_file(interface: &Interface, variant: Variant) -> String {
    format!("{}.{}.fmu", interface.model, variant.name())
}

/// What cargo names the shell's library: `liblander_truth_fmu.so`, `lander_truth_fmu.dll`.
pub fn library_files(interface: &Interface) -> [String; 2] {
    let name = identifier(interface);
    [format!("lib{name}_fmu.so"), format!("{name}_fmu.dll")]
}

/// Where FMI looks for the library of a platform in the archive.
pub fn library_entry(interface: &Interface, variant: Variant, platform: Platform) -> String {
    let (folder, extension) = (platform.folder(variant), platform.extension());
    format!("binaries/{folder}/{}.{extension}", identifier(interface))
}
