//! A law from one recording on another one that none of its coefficients has seen.

use super::binary::Binary;
use super::figure::Figure;
use super::silverbox;
use crate::error::Error;
use serde_json::Value;
use std::path::Path;

/// Window of the force residual of EMPS, s, as its source measured it.
const EMPS_WINDOW: &str = "0.301";

/// Open-loop horizon of EMPS, s.
const EMPS_HORIZON: &str = "1";

/// Adds an effect to a model on one recording and compares the new one with another.
struct Transfer<'a> {
    model: &'a str,
    effect: &'a str,
    train: &'a str,
    test: &'a str,
    options: &'a [&'a str],
}

impl Transfer<'_> {
    /// The `error` of the comparison; null where there is none, and whether the program crashed.
    fn error(&self, binary: &Binary) -> Result<(Value, bool), Error> {
        binary.write("model.toml", self.model)?;
        let add = ["add", self.effect, "--data", self.train, "--model", "model.toml", "-o", "m2.toml", "--force"];
        if let Err(failure) = binary.ask(&add)?.document {
            eprintln!("{}: {}", self.train, failure.text);
            return Ok((Value::Null, failure.crashed));
        }
        let compare = [&["compare", self.test, "--model", "m2.toml"], self.options].concat();
        Ok(match binary.ask(&compare)?.document {
            Ok(document) => (document["error"].clone(), false),
            Err(failure) => {
                eprintln!("{}: {}", self.test, failure.text);
                (Value::Null, failure.crashed)
            }
        })
    }
}

/// The EMPS test run with the train run's numbers, friction added on the train run: force residual, open loop of 1 s.
/// `model` is the one without friction; its hold is given, the one under which the floors were measured. The second
/// value says whether the program crashed.
///
/// # Errors
/// [`Error::Start`], [`Error::File`].
pub fn emps(binary: &Binary, model: &str, train: &str, test: &str) -> Result<(Vec<Figure>, bool), Error> {
    let options = ["--window", EMPS_WINDOW, "--horizon", EMPS_HORIZON];
    let model = format!("hold = \"linear\"\n{model}");
    let transfer = Transfer { model: &model, effect: "coulomb_friction", train, test, options: &options };
    let (error, crashed) = transfer.error(binary)?;
    let open_loop = error["window_rmse"].as_f64().map(|metres| 1e3 * metres);
    let figures = vec![
        Figure::at_most(
            "EMPS test, train run's numbers: force residual, 0.301 s",
            error["force_residual"].as_f64(),
            0.0447,
            0.042,
        ),
        Figure::at_most("EMPS test, train run's numbers: open loop of 1 s, RMSE in mm", open_loop, 2.15, 2.1),
    ];
    Ok((figures, crashed))
}

/// Silverbox: the cubic spring added on the first multisines, then the arrow head run freely.
///
/// # Errors
/// [`Error::Start`], [`Error::File`], [`Error::Records`].
pub fn silverbox(binary: &Binary, file: &Path) -> Result<(Vec<Figure>, bool), Error> {
    let recording = silverbox::read(file)?;
    binary.write("training.csv", &recording.section(silverbox::TRAINING))?;
    binary.write("arrow.csv", &recording.section(silverbox::ARROW_HEAD))?;
    let model = silverbox::MODEL;
    let transfer =
        Transfer { model, effect: "cubic_stiffness", train: "training.csv", test: "arrow.csv", options: &[] };
    let (error, crashed) = transfer.error(binary)?;
    let nrmse = error["free_run_nrmse"].as_f64();
    Ok((vec![Figure::at_most("Silverbox arrow head: free-run NRMSE", nrmse, 0.0084, 0.006)], crashed))
}
