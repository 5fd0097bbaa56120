#!/usr/bin/env bash
# Builds FMUs that hold a library for each of several platforms, and proves what they need:
#
#     fmu-build/release.sh [--check] [FOLDER]     default: target/release-fmu
#
# x86_64-linux and aarch64-linux run wherever glibc is 2.17 or newer (2012), x86_64-windows on
# Windows 10; PLATFORMS="x86_64-linux …" builds fewer. Linker and C libraries are Zig's, which comes
# from PyPI with cargo-zigbuild into a Python environment below target.
#
# Rust's standard library for a platform is the installed one (`rustup target add`), else it is
# compiled from its source: that of `rustup component add rust-src`, or of RUST_LIBRARY, the folder
# `library` of the compiler's own version (Debian's package rust-src has it in /usr/src).
#
# --check compiles everything a second time, from a copy of the sources in another folder, with
# another target folder and another cargo home, and fails unless all files have equal bytes.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
check=false
if [ "${1:-}" = --check ]; then
    check=true
    shift
fi
target=$(realpath --canonicalize-missing "${CARGO_TARGET_DIR:-target}")
out=$(realpath --canonicalize-missing "${1:-$target/release-fmu}")
cargo_home=${CARGO_HOME:-$HOME/.cargo}
platforms=${PLATFORMS:-x86_64-linux aarch64-linux x86_64-windows}
# The one date: of archive entries, and of the link in a Windows library.
export SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-315532800}
sysroot=$(rustc --print sysroot)
rust_library=${RUST_LIBRARY:-$sysroot/lib/rustlib/src/rust/library}

tools=$target/zig-tools
if [ ! -x "$tools/bin/cargo-zigbuild" ]; then
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet ziglang==0.17.1 cargo-zigbuild==0.24.0
fi
PATH="$tools/bin:$PATH"

# The name that Rust has for a platform, with the least glibc.
triple() {
    case $1 in
    x86_64-linux) echo x86_64-unknown-linux-gnu.2.17 ;;
    aarch64-linux) echo aarch64-unknown-linux-gnu.2.17 ;;
    x86_64-windows) echo x86_64-pc-windows-gnu ;;
    *)
        echo "error: no platform $1" >&2
        exit 2
        ;;
    esac
}

# compile SOURCES TARGET CARGO_HOME OUT: libraries for each platform, then the FMUs and SSPs. No
# path of this machine remains in a library.
compile() (
    cd "$1"
    export CARGO_TARGET_DIR=$2 CARGO_HOME=$3
    RUSTFLAGS="--remap-path-prefix=$3=/cargo --remap-path-prefix=$2=/target"
    export RUSTFLAGS="$RUSTFLAGS --remap-path-prefix=$1=/lander"
    libraries=()
    for platform in $platforms; do
        triple=$(triple "$platform")
        echo "== $platform" >&2
        options=(--release --package lander-truth-fmu --package scvx-guidance-fmu)
        if [ -d "$sysroot/lib/rustlib/${triple%.2.17}/lib" ]; then
            cargo zigbuild "${options[@]}" --target "$triple"
        elif [ -d "$rust_library" ]; then
            RUSTFLAGS="$RUSTFLAGS --remap-path-prefix=$rust_library=/rust/library" \
                RUSTC_BOOTSTRAP=1 __CARGO_TESTS_ONLY_SRC_ROOT=$rust_library \
                cargo zigbuild "${options[@]}" --target "$triple" -Z build-std=std,panic_unwind
        else
            echo "error: no standard library for $platform, and no source in $rust_library" >&2
            exit 1
        fi
        libraries+=(--libraries "$2/${triple%.2.17}/release")
    done
    "$packer" build "${libraries[@]}" --out "$4"
    "$packer" ssp --fmus "$4"
)

cargo build --release --package fmu-build --target-dir "$target/packer"
packer=$target/packer/release/fmu-build
compile "$root" "$target/portable" "$cargo_home" "$out"

# Every platform is there and needs nothing newer or foreign; the library for this one is run.
demands=(--glibc 2.17)
for platform in $platforms; do
    demands+=(--platform "$platform")
done
"$packer" check "${demands[@]}" "$out"/*.fmu

if $check; then
    again=$(mktemp --directory)
    trap 'rm -rf "$again"' EXIT
    mkdir "$again/sources" "$again/home"
    git ls-files -z | xargs --null cp --parents --target-directory="$again/sources"
    # The same downloads under another path.
    ln -s "$cargo_home/registry" "$again/home/registry"
    compile "$again/sources" "$again/a-longer-name-for-target" "$again/home" "$again/fmu"
    (cd "$out" && sha256sum -- *.fmu *.ssp) >"$again/first"
    (cd "$again/fmu" && sha256sum -- *.fmu *.ssp) >"$again/second"
    if ! diff "$again/first" "$again/second"; then
        echo "error: the second compilation gives other bytes" >&2
        exit 1
    fi
    cat "$again/first"
    echo "two compilations gave equal bytes"
fi
