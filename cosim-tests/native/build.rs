//! Gives the program the fingerprint of its sources, which its studies' tables carry.

use std::path::Path;

#[path = "build_fingerprint.rs"]
mod fingerprint;

fn main() -> std::io::Result<()> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize()?;
    for source in fingerprint::SOURCES {
        println!("cargo:rerun-if-changed={}", workspace.join(source).display());
    }
    println!("cargo:rerun-if-changed=build_fingerprint.rs");
    println!("cargo:rustc-env=SOURCES_FINGERPRINT={}", fingerprint::fingerprint(&workspace)?);
    Ok(())
}
