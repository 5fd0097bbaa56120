#!/usr/bin/env bash
# Builds FMUs that run wherever glibc is 2.17 or newer (2012), with Zig's linker and headers:
#
#     fmu-build/release.sh [FOLDER]       default: target/fmu-release
#
# Needs a Python with venv; Zig and cargo-zigbuild come from PyPI. The whole workspace is built, so
# that features unify as in `cargo build` and the numbers are the same.
set -euo pipefail
cd "$(dirname "$0")/.."
target="${CARGO_TARGET_DIR:-target}"
out="${1:-$target/fmu-release}"
triple=x86_64-unknown-linux-gnu
tools="$target/zig-tools"
if [ ! -x "$tools/bin/cargo-zigbuild" ]; then
    python3 -m venv "$tools"
    "$tools/bin/pip" install --quiet ziglang==0.17.1 cargo-zigbuild==0.24.0
fi
PATH="$tools/bin:$PATH" cargo zigbuild --release --workspace --target "$triple.2.17"
"$target/$triple/release/fmu-build" build --out "$out"
"$target/$triple/release/fmu-build" ssp --fmus "$out"

# Proof: no symbol newer than 2.17, and nothing but the libc family.
for library in "$target/$triple/release/"lib*_fmu.so; do
    newest=$(objdump -T "$library" | grep -o 'GLIBC_[0-9.]*' | sort --version-sort --unique | tail -1)
    needed=$(objdump -p "$library" | awk '/NEEDED/ { print $2 }' | sort | paste -s -d ' ')
    echo "$(basename "$library"): $newest; $needed"
    if [ "$(printf '%s\nGLIBC_2.17\n' "$newest" | sort --version-sort | tail -1)" != GLIBC_2.17 ]; then
        echo "error: $library needs $newest" >&2
        exit 1
    fi
    if grep --quiet --invert-match --extended-regexp \
        '^(lib(c|m|dl|rt|pthread|gcc_s)\.so\.[0-9]+|ld-linux.*)$' <<<"${needed// /$'\n'}"; then
        echo "error: $library needs more than libc: $needed" >&2
        exit 1
    fi
done
