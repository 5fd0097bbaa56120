//! Arithmetic that gives equal bits on every host.
//!
//! `+ - * / sqrt` and rounding are exact in IEEE 754; `sin`, `exp`, `powf` and their like are not.
//! Those of `f64` go to the host's C library, each rounding in its own way, so this workspace calls the
//! `libm` crate: plain Rust, the same instructions everywhere. `powi` leaves its order of
//! products to the compiler: whole powers are written out. `clippy.toml` forbids both.

/// `x²`, as one product.
#[must_use]
pub const fn square(x: f64) -> f64 {
    x * x
}
