//! The page: claims first, then section by section, pictures beside it in a folder of its name.

use super::Failure;
use super::figure::{Claim, Section};
use std::path::{Path, PathBuf};
use switchid::report::{Figure, svg};

/// Characters in a line of the page.
const LONGEST: usize = 120;

/// Where the page of a folder of pictures stands.
pub fn path(out: &Path) -> PathBuf {
    out.with_extension("md")
}

/// Writes pictures and page.
///
/// # Errors
/// What drawing or writing says.
pub fn write(out: &Path, sections: &[Section], seeds: u64) -> Result<(), Failure> {
    sections.iter().try_for_each(|section| pictures(out, section))?;
    let parts = sections.iter().map(|section| text(out, section));
    let page = [head(sections, seeds)].into_iter().chain(parts).collect::<Vec<_>>().join("\n");
    Ok(std::fs::write(path(out), wrapped(&page))?)
}

/// Writes the pictures of a section.
///
/// # Errors
/// What drawing or writing says.
pub fn pictures(out: &Path, section: &Section) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    for picture in &section.pictures {
        let figure = Figure { panels: picture.panels.clone(), ..Figure::default() };
        std::fs::write(out.join(format!("{}.svg", picture.name)), svg(&figure)?)?;
    }
    Ok(())
}

/// A section in Markdown.
pub fn text(out: &Path, section: &Section) -> String {
    let folder = out.file_name().unwrap_or_default().to_string_lossy();
    let pictures = section.pictures.iter().map(|picture| {
        let short = picture.caption.split(';').next().unwrap_or_default();
        format!("![{short}]({folder}/{}.svg)\n\n*{}*\n\n", picture.name, picture.caption)
    });
    format!("## {}\n\n{}{}\n", section.title, pictures.collect::<String>(), section.text.trim_end())
}

fn head(sections: &[Section], seeds: u64) -> String {
    let claims: String = sections.iter().flat_map(|section| &section.claims).map(claim).collect();
    let seeds = if seeds == 50 { String::new() } else { format!(" --seeds {seeds}") };
    format!(
        "# The published method, ours, and what is possible\n\n\
         Written by `cargo xtask study{seeds}`, text, tables and pictures. Both methods are switchid's (`--method publication` and the default), \
         ours with one default configuration throughout; limits are those of `switchid limits`. Seeds are others than any that \
         something was chosen by. e is eq. (8) of the publication: Σ(θ − θ*)² ÷ Σθ*².\n\n\
         ## The publication's claims\n\nA claim is confirmed where it holds for both plants.\n\n{claims}"
    )
}

fn claim(claim: &Claim) -> String {
    let verdict = |holds: bool| if holds { "confirmed" } else { "refuted" };
    let (published, ours) = (verdict(claim.published), verdict(claim.ours));
    format!("- **{}**: {published} of the published method, {ours} of ours: {}\n", claim.claim, claim.evidence)
}

/// The page with its long lines broken at spaces; tables and pictures as they are.
fn wrapped(page: &str) -> String {
    page.lines().map(|line| if line.starts_with(['|', '!']) { format!("{line}\n") } else { broken(line) }).collect()
}

/// A line broken at spaces, what follows indented where it is an item of a list.
fn broken(line: &str) -> String {
    let indent = if line.starts_with("- ") { "  " } else { "" };
    let mut lines = vec![String::new()];
    for word in line.split(' ') {
        let length = lines.last().map_or(0, |last| last.chars().count());
        if length > 0 && length + 1 + word.chars().count() > LONGEST {
            lines.push(format!("{indent}{word}"));
        } else if let Some(last) = lines.last_mut() {
            last.push_str(if length > 0 { " " } else { "" });
            last.push_str(word);
        }
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::super::figure::Picture;
    use super::super::lines::{decades, line};
    use super::*;
    use switchid::report::{Axis, Panel};

    fn section(points: &[(f64, f64)]) -> Section {
        let layers = [("ours", 1.0), ("published", 2.0)]
            .map(|(name, factor)| line(name, points.iter().map(|(x, y)| (*x, Some(factor * y)))));
        let y = decades("e", points.iter().map(|point| point.1));
        let panel = Panel { title: "t".into(), x: Axis::log("σ").over(0.01, 0.1), y, layers: layers.to_vec() };
        Section {
            title: "Title",
            text: "words".into(),
            pictures: vec![Picture { name: "p".into(), caption: "c".into(), panels: vec![panel] }],
            claims: vec![Claim { claim: "x", published: true, ours: false, evidence: "0.1".into() }],
        }
    }

    #[test]
    fn the_page_links_its_pictures_and_tells_the_verdicts() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("study");
        write(&out, &[section(&[(0.01, 1e-6), (0.1, 1e-2)])], 3).unwrap();
        let page = std::fs::read_to_string(path(&out)).unwrap();
        assert!(page.contains("- **x**: confirmed of the published method, refuted of ours: 0.1\n"), "{page}");
        assert!(page.contains("![c](study/p.svg)") && page.contains("--seeds 3`"), "{page}");
        assert!(std::fs::read_to_string(out.join("p.svg")).unwrap().contains("ours"));
    }

    #[test]
    fn no_line_of_prose_is_longer_than_a_terminal_and_no_word_is_lost() {
        let words = ["wörd"; 60].join(" ");
        let page = wrapped(&format!("{words}\n\n- {words}\n| {words} |\n"));
        let lines: Vec<&str> = page.lines().filter(|line| !line.starts_with('|')).collect();
        assert!(lines.iter().all(|line| line.chars().count() <= LONGEST), "{page}");
        assert_eq!(page.matches("wörd").count(), 180);
        assert!(page.contains("\n  wörd") && page.ends_with(&format!("| {words} |\n")), "{page}");
    }

    #[test]
    fn values_beyond_the_axes_and_none_at_all_are_drawn_too() {
        for points in [&[(0.001, 1e-300), (0.05, f64::NAN), (0.1, f64::INFINITY)][..], &[]] {
            let panels = section(points).pictures[0].panels.clone();
            assert!(svg(&Figure { panels, ..Figure::default() }).unwrap().starts_with("<svg"));
        }
    }
}
