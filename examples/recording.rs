//! Your own recording: its stages, and the law of each.
//! `cargo run --release --example recording -- record.csv model.toml`

use std::path::Path;
use switchid::data::{open_model, open_recording};
use switchid::identify::{choose_hold, settings_for};
use switchid::{Settings, identify_recording};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(data), Some(model)) = (arguments.next(), arguments.next()) else {
        return Err("name a recording (CSV, MAT or Parquet) and a model file (TOML)".into());
    };
    let model = open_model(Path::new(&model))?;
    let opened = open_recording(&data, &model)?;
    let recording = &opened.recording;

    let mut settings = settings_for(recording, Settings::default());
    settings.hold = model.hold.unwrap_or_else(|| choose_hold(&model, recording, &settings));
    let found = identify_recording(&model, settings, recording, |_, _| {})?;
    for stage in &found.stages {
        let law = stage.law(recording.channels().excitation).unwrap_or_else(|| "not known".into());
        println!("{:.3} s to {:.3} s: {law}", stage.start, stage.end);
    }
    Ok(())
}
