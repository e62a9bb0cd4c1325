//! Sections of the Silverbox recording, its channels' means taken off: the offsets are instrument error.

use crate::error::Error;
use std::fmt::Write;
use std::ops::Range;
use std::path::Path;

/// The first two multisines.
pub const TRAINING: Range<usize> = 40_700..58_000;

/// Gaussian noise of growing amplitude.
pub const ARROW_HEAD: Range<usize> = 100..40_575;

/// The linear model. The excitation comes from a generator behind an anti-aliasing filter, which its source says.
pub const MODEL: &str =
    "hold = \"band_limited\"\n[terms]\ninertia = \"fit\"\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n";

/// The whole recording: t, input, output.
pub struct Recording(Vec<[f64; 3]>);

/// Reads the file.
///
/// # Errors
/// [`Error::File`]; [`Error::Records`] names the line that is no three numbers.
pub fn read(path: &Path) -> Result<Recording, Error> {
    let text = std::fs::read_to_string(path);
    let text = text.map_err(|source| Error::File { action: "read", path: path.to_path_buf(), source })?;
    let wrong =
        |line: usize| Error::Records { text: format!("{}, line {}: not three numbers", path.display(), line + 1) };
    let lines = text.lines().enumerate().skip(1);
    lines.map(|(index, line)| row(line).ok_or_else(|| wrong(index))).collect::<Result<_, _>>().map(Recording)
}

fn row(line: &str) -> Option<[f64; 3]> {
    let numbers: Option<Vec<f64>> = line.split(',').map(|cell| cell.trim().parse().ok()).collect();
    numbers?.try_into().ok()
}

impl Recording {
    /// A section as CSV.
    pub fn section(&self, samples: Range<usize>) -> String {
        let rows = &self.0;
        let mean = |column: usize| rows.iter().map(|row| row[column]).sum::<f64>() / rows.len() as f64;
        let (input, output) = (mean(1), mean(2));
        rows.iter().take(samples.end).skip(samples.start).fold("t,q,F\n".to_string(), |mut text, [t, u, y]| {
            let _ = writeln!(text, "{t},{},{}", y - output, u - input);
            text
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_has_the_whole_recordings_means_off() {
        let recording = Recording(vec![[0.0, 1.0, 5.0], [0.1, 2.0, 5.0], [0.2, 6.0, 8.0]]);
        assert_eq!(recording.section(1..3), "t,q,F\n0.1,-1,-1\n0.2,2,3\n");
    }

    #[test]
    fn a_line_is_three_numbers() {
        assert_eq!(row("0, 1.5,-2e-3"), Some([0.0, 1.5, -2e-3]));
        assert_eq!((row("0,1"), row("0,1,x"), row("0,1,2,3")), (None, None, None));
    }
}
