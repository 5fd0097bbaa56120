//! docs/VALIDATION.md: what the tests of this run claimed and measured.

use std::collections::BTreeSet;
use std::fs;

use crate::steps::{Failure, say};
use crate::workspace::Workspace;

/// What becomes of a document that is out of date.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Accept {
    /// It is a failed check.
    No,
    /// It is written anew.
    Yes,
}

/// Before the tests: no record of an older run survives.
pub fn start() -> Result<(), Failure> {
    let folder = claims::records_folder();
    claims::clear(&folder).map_err(|error| Failure::new(format!("{}: {error}", folder.display())))
}

/// After the tests: the document says what they measured.
pub fn finish(workspace: &Workspace, accept: Accept) -> Result<(), Failure> {
    let told = claims::render(&claims::records_folder()).map_err(Failure::new)?;
    let file = workspace.root.join("docs/VALIDATION.md");
    // No document yet is an empty one.
    let kept = fs::read_to_string(&file).unwrap_or_default();
    if told == kept {
        return Ok(());
    }
    for line in differences(&kept, &told) {
        say(&mut std::io::stderr(), &line);
    }
    match accept {
        Accept::Yes => fs::write(&file, told)
            .map_err(|error| Failure::new(format!("{}: {error}", file.display()))),
        Accept::No => Err(Failure::new(
            "docs/VALIDATION.md is not what the tests measured: look at the difference, and if it is \
             meant run `cargo verify --accept`",
        )),
    }
}

/// Lines of only one of two documents, told as in a diff.
fn differences(old: &str, new: &str) -> Vec<String> {
    let only_in = |text: &str, other: &str, sign: char| -> Vec<String> {
        let others: BTreeSet<&str> = other.lines().collect();
        let own = text.lines().filter(|line| !others.contains(line));
        own.map(|line| format!("{sign} {line}")).collect()
    };
    [only_in(old, new, '-'), only_in(new, old, '+')].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_that_is_gone_and_one_that_moved_are_told() {
        let told = differences("a\nb 1\nc\n", "a\nb 2\n");
        assert_eq!(told, ["- b 1", "- c", "+ b 2"]);
    }
}
