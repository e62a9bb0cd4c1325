//! Shell completion and the man page, out of the command line itself.

use super::error::CommandError;
use super::output;
use clap::{Args, Command};
use clap_complete::Shell;

const FILES: &str = r#"
.SH FILES
.TP
.B DATA
a recording: text (CSV and its relatives), a spreadsheet, MAT (5 to 7.3), MDF 4 or Parquet; DATA@t0:t1 is a section, in seconds
.TP
.B MODEL
a model in TOML; \fBswitchid init\fR writes one to begin with
.TP
.B \-
standard output, wherever a command writes a file
.SH ENVIRONMENT
.TP
.B NO_COLOR
no colours in help and errors
.TP
.B SWITCHID_DATA
where the project's own tests look for real recordings; no command reads it
.SH EXIT STATUS
0: done. 1: a check failed. 2: wrong usage or bad input; the message names file, line, column or key and what mends it. With
\fB\-\-json\fR the last line on standard error is a JSON document {"error", "exit_status"}.
"#;

/// Print completions for a shell
#[derive(Args)]
#[command(after_help = "Examples:\n  switchid completions bash > ~/.local/share/bash-completion/completions/switchid")]
pub(super) struct CompletionArguments {
    /// The shell
    shell: Shell,
}

/// Print the man page
#[derive(Args)]
#[command(after_help = "Examples:\n  switchid manual > switchid.1 && man ./switchid.1")]
pub(super) struct ManualArguments {}

/// Prints the completions of a command line.
///
/// # Errors
/// What writing says.
pub(super) fn completions(arguments: &CompletionArguments, mut command: Command) -> Result<(), CommandError> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "switchid", &mut text);
    output::print(&String::from_utf8_lossy(&text))
}

/// Prints the man page of a command line.
///
/// # Errors
/// What writing says.
pub(super) fn manual(mut command: Command) -> Result<(), CommandError> {
    let failed = |error: std::io::Error| CommandError::write("standard output", error);
    let mut text = Vec::new();
    command.build();
    clap_mangen::Man::new(command.clone()).render(&mut text).map_err(failed)?;
    text.extend(FILES.as_bytes());
    for own in command.get_subcommands().filter(|own| own.get_name() != "help") {
        text.extend(format!(".SH SWITCHID {}\n", own.get_name().to_uppercase()).bytes());
        let man = clap_mangen::Man::new(own.clone());
        man.render_synopsis_section(&mut text).map_err(failed)?;
        man.render_options_section(&mut text).map_err(failed)?;
    }
    output::print(&String::from_utf8_lossy(&text))
}
