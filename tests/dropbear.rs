//! A real record whose stiffness switches and drifts (DROPBEAR), from its strain alone in real time, to the floors of
//! its figures.
//!
//! The folder is named by `SWITCHID_DATA`; without it the test says that it skips, and in CI that is a failure.

#[path = "../measure/dropbear/measure.rs"]
mod measure;

use measure::{figures, identify, read};
use std::path::Path;

#[test]
fn the_stiffness_of_a_beam_is_followed_while_its_roller_moves() {
    let Some(folder) = std::env::var_os("SWITCHID_DATA") else {
        assert!(std::env::var_os("CI").is_none(), "SWITCHID_DATA is not set: in CI the recordings must be read");
        eprintln!("SKIPPED: dropbear (set SWITCHID_DATA to the folder of recordings)");
        return;
    };
    let beam = read(&Path::new(&folder).join("dropbear/dropbear.csv")).unwrap();
    let modes = identify(&beam).unwrap();
    let found = figures(&beam, &modes);
    assert!(found.identified >= 0.9 && found.identified_still <= 0.01, "{found:?}");
    assert!(found.median <= 0.015 && found.ninth_decile <= 0.065, "{found:?}");
    assert!(found.residual <= 0.13, "{found:?}");
    assert!((0.5..2.0).contains(&found.normalised_error), "{found:?}");
    let shown = modes.iter().flatten();
    assert!(shown.clone().count() > 0 && shown.into_iter().all(|mode| mode.frequency_std() > 0.0));
}
