//! `fmi2ResourceLocation`: a URI (RFC 3986) to a path.

use std::path::PathBuf;

/// `file:///a%20b`, `file:/a`, `file://localhost/a` and a plain path. On Windows the slash before
/// a drive letter goes.
pub fn path(location: &str) -> PathBuf {
    let path = match location.strip_prefix("file:") {
        None => location.to_owned(),
        Some(rest) => {
            let rest = rest.strip_prefix("//").map_or(rest, without_host);
            decoded(rest)
        }
    };
    let drive = matches!(path.as_bytes(), [b'/', letter, b':', ..] if letter.is_ascii_alphabetic());
    if cfg!(windows) && drive { path[1..].into() } else { path.into() }
}

/// What follows the authority; a missing slash before the path is forgiven.
fn without_host(rest: &str) -> &str {
    rest.strip_prefix("localhost").unwrap_or(rest)
}

/// `%41` is `A`; what is no such triple stays, and bytes that are not UTF-8 are replaced.
fn decoded(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut decoded, mut at) = (Vec::with_capacity(bytes.len()), 0);
    while let Some(&byte) = bytes.get(at) {
        let hex = text.get(at + 1..at + 3).filter(|_| byte == b'%');
        let triple = hex
            .filter(|hex| hex.bytes().all(|digit| digit.is_ascii_hexdigit()))
            .and_then(|hex| u8::from_str_radix(hex, 16).ok());
        decoded.push(triple.unwrap_or(byte));
        at += if triple.is_some() { 3 } else { 1 };
    }
    String::from_utf8_lossy(&decoded).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_spelling_of_a_folder() {
        for (location, expected) in [
            ("file:///tmp/a", "/tmp/a"),
            ("file:/tmp/a", "/tmp/a"),
            ("file://localhost/tmp/a/", "/tmp/a/"),
            ("file:///tmp/a%20b%C3%A9/%25", "/tmp/a bé/%"),
            ("file:///tmp/100%/%4", "/tmp/100%/%4"),
            ("/tmp/a%20b", "/tmp/a%20b"),
            ("relative", "relative"),
            ("file:", ""),
        ] {
            assert_eq!(path(location), PathBuf::from(expected), "{location}");
        }
    }
}
