//! A real record that switches and drifts: `cargo xtask dropbear FOLDER [PICTURE.svg]`, FOLDER that of `dropbear.csv`.
//! Prints the figures of docs/dropbear.md and draws its picture.

mod measure;
mod plot;

use measure::{Failure, Figures, figures, identify, read};
use std::path::PathBuf;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let folder = arguments.next().ok_or("name the folder that holds dropbear.csv")?;
    let beam = read(&folder.join("dropbear.csv"))?;
    let modes = identify(&beam)?;
    print(&figures(&beam, &modes));
    if let Some(picture) = arguments.next() {
        std::fs::write(picture, plot::picture(&beam, &modes)?)?;
    }
    Ok(())
}

fn print(figures: &Figures) {
    println!("| figure | |\n|---|---|");
    println!("| time from 0.7 s on for which a law is validated | {:.1} % |", 100.0 * figures.identified);
    println!("| the same while the beam is still | {:.1} % |", 100.0 * figures.identified_still);
    println!("| error of the frequency, median | {:.2} % |", 100.0 * figures.median);
    println!("| error of the frequency, 90th percentile | {:.2} % |", 100.0 * figures.ninth_decile);
    println!("| residual of each window under the law known at its start | {:.3} |", figures.residual);
    println!("| (error ÷ stated std)² of the stiffness, mean | {:.2} |", figures.normalised_error);
}
