//! The documents' shell commands, run as they stand.

use crate::command::{root, run};
use crate::error::Error;
use std::process::Command;

/// The documents whose commands a reader runs first.
const DOCUMENTS: [&str; 2] = ["README.md", "docs/command-line.md"];

/// Where their commands write.
const FOLDER: &str = "target/readme";

/// Runs every ```` ```sh ```` block of a document in the workspace's root, in order, one document after the other;
/// lines that call `cargo xtask` are left out, since CI runs those itself.
///
/// # Errors
/// [`Error::Document`] where a document has no such block, [`Error::Failed`] when a command fails.
pub fn commands() -> Result<(), Error> {
    DOCUMENTS.into_iter().try_for_each(commands_of)
}

fn commands_of(document: &str) -> Result<(), Error> {
    let path = root().join(document);
    let text =
        std::fs::read_to_string(&path).map_err(|source| Error::File { action: "read", path: path.clone(), source })?;
    let blocks = shell_blocks(&text);
    if blocks.is_empty() {
        return Err(Error::Document { path, text: "has no ```sh block: its commands are tested from there" });
    }
    // a reader begins with an empty folder: nothing that exists is overwritten unasked
    let _ = std::fs::remove_dir_all(root().join(FOLDER));
    let script = blocks.join("\n");
    run(Command::new("bash").args(["-euxo", "pipefail", "-c", &script]).current_dir(root()), "install bash")
}

fn shell_blocks(text: &str) -> Vec<String> {
    let blocks = text.split("\n```sh\n").skip(1).filter_map(|rest| rest.split("\n```").next());
    blocks.map(without_xtask).filter(|block| !block.trim().is_empty()).collect()
}

fn without_xtask(block: &str) -> String {
    block.lines().filter(|line| !line.trim_start().starts_with("cargo xtask")).collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_shell_blocks_are_run_and_no_chore() {
        let text = "a\n```sh\ncargo xtask test\nls -l\n```\nb\n```rust\nfn f() {}\n```\n```sh\necho 2\n```\n";
        assert_eq!(shell_blocks(text), ["ls -l", "echo 2"]);
    }
}
