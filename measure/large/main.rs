//! What a large recording costs: `cargo xtask large [--rows N] [--switchid PATH]`.
//!
//! A Duffing oscillator under a multisine, 1 kHz, with sensor noise and one switch, is written as text with four
//! columns. The commands run on it as a user runs them. Memory is the largest resident set of the process ÷ the bytes
//! of its columns as numbers; time is processor time ÷ that of the identifier alone over the same samples in memory, in
//! the same run, so that what else the machine does counts little. Linux only: figures come from /proc.

mod process;

use clap::Parser;
use process::{Cost, own_time};
use std::error::Error;
use std::path::{Path, PathBuf};
use switchid::identify::{Identifier, Recording, Settings, settings_for};
use switchid::law::{Hold, Model};

type Failure = Box<dyn Error>;

const MODEL: &str = "[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n\"q^3\" = \"fit\"\n";

/// Bytes of a row: t, q, q̇ and F.
const ROW: f64 = 32.0;

/// Commands whose cost is shown, with what follows the recording.
const COMMANDS: [&str; 4] = ["check", "identify", "compare", "diagnose"];

#[derive(Parser)]
struct Arguments {
    /// Rows of the recording
    #[arg(long, default_value_t = 5_000_000)]
    rows: usize,
    /// The command line that is measured
    #[arg(long)]
    switchid: PathBuf,
}

fn main() -> Result<(), Failure> {
    let arguments = Arguments::parse();
    let folder = tempfile::tempdir()?;
    let data = write(folder.path(), &arguments)?;
    let alone = streaming(&data)?;
    let bytes = ROW * arguments.rows as f64;
    println!("{} rows, {:.0} MB of columns in {:.0} MB of text", arguments.rows, 1e-6 * bytes, 1e-6 * length(&data)?);
    println!("the identifier alone: {alone:.1} s of processor time\n");
    println!(
        "| command | peak memory ÷ columns | time ÷ identifier alone | ÷ `identify` | wall, s |\n|---|---|---|---|---|"
    );
    let costs: Vec<Cost> =
        COMMANDS.iter().map(|command| cost(&arguments.switchid, command, &data)).collect::<Result<_, _>>()?;
    let identify = costs[1].time;
    for (command, Cost { peak, time, wall }) in COMMANDS.iter().zip(costs) {
        let (memory, beside, share) = (peak / bytes, time / alone, time / identify);
        println!("| `{command}` | {memory:.2} | {beside:.3} | {share:.3} | {wall:.0} |");
    }
    Ok(())
}

/// Writes model and recording; where the recording is.
fn write(folder: &Path, arguments: &Arguments) -> Result<PathBuf, Failure> {
    let duration = (arguments.rows - 1) as f64 * 1e-3;
    let scenario = format!(
        "terms = [\"qdd\", \"qd\", \"q\", \"q^3\"]\nduration = {duration}\nseed = 5\nnoise = {{ q = 0.001, qd = 0.002 }}\n\
         initial = {{ q = 0.5, qd = 0.0 }}\n\
         excitation = {{ kind = \"multisine\", from = 1.0, to = 12.0, count = 20, rms = 2.0 }}\n\
         [[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.3, 4.0, 2.0]\n\
         [[stage]]\nstart = {:.3}\ncoefficients = [1.0, 0.6, 4.0, 2.0]\n",
        0.5 * duration
    );
    let [plant, model, data] = ["plant.toml", "model.toml", "large.csv"].map(|name| folder.join(name));
    std::fs::write(&plant, scenario)?;
    std::fs::write(model, MODEL)?;
    let mut simulate = std::process::Command::new(&arguments.switchid);
    let done = simulate.arg("simulate").arg(plant).arg("-o").arg(&data).output()?;
    if done.status.success() { Ok(data) } else { Err(String::from_utf8_lossy(&done.stderr).into()) }
}

fn length(data: &Path) -> Result<f64, Failure> {
    Ok(std::fs::metadata(data)?.len() as f64)
}

/// Processor time of the identifier over all samples, s.
fn streaming(data: &Path) -> Result<f64, Failure> {
    let model = Model::from_toml(MODEL)?;
    let recording: Recording = switchid::data::open_recording(&data.display().to_string(), &model)?.recording;
    let settings = Settings { hold: Hold::Zero, ..settings_for(&recording, Settings::default()) };
    let mut identifier = Identifier::new(&model, settings)?;
    let begun = own_time();
    for index in 0..recording.count() {
        identifier.step(recording.sample(index))?;
    }
    let time = own_time() - begun;
    if identifier.output().valid { Ok(time) } else { Err("no law was validated".into()) }
}

fn cost(switchid: &Path, command: &str, data: &Path) -> Result<Cost, Failure> {
    let mut run = std::process::Command::new(switchid);
    run.arg(command).arg(data).arg("--model").arg(data.with_file_name("model.toml"));
    process::cost(&mut run)
}
