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

/// Adds effects to a model on one recording and compares the new one with another.
struct Transfer<'a> {
    model: &'a str,
    effect: &'a str,
    /// Whether what a diagnosis of the law with it names is added as well.
    goes_on: bool,
    train: &'a str,
    test: &'a str,
    options: &'a [&'a str],
}

impl Transfer<'_> {
    /// The `error` of the comparison; null where there is none, and whether the program crashed.
    fn error(&self, binary: &Binary) -> Result<(Value, bool), Error> {
        binary.write("model.toml", self.model)?;
        let add = ["add", self.effect, "--data", self.train, "--model", "model.toml", "-o", "m2.toml", "--force"];
        let second = |named: &Value| named["effect"].as_str().map(String::from);
        let mut asked = binary.ask(&add)?.document;
        if self.goes_on && asked.is_ok() {
            asked = binary.ask(&["diagnose", self.train, "--model", "m2.toml"])?.document;
            if let Some(named) = asked.as_ref().ok().and_then(second) {
                let more = ["add", &named, "--data", self.train, "--model", "m2.toml", "-o", "m2.toml", "--force"];
                asked = binary.ask(&more)?.document;
            }
        }
        if let Err(failure) = asked {
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

/// The EMPS test run with the train run's numbers, friction and then what a diagnosis names beside it added on the
/// train run: force residual, open loop of 1 s. `model` is the one without friction; its hold is given, the one under
/// which the floors were measured. The second value says whether the program crashed.
///
/// # Errors
/// [`Error::Start`], [`Error::File`].
pub fn emps(binary: &Binary, model: &str, train: &str, test: &str) -> Result<(Vec<Figure>, bool), Error> {
    let options = ["--window", EMPS_WINDOW, "--horizon", EMPS_HORIZON];
    let model = format!("hold = \"linear\"\n{model}");
    let (mut figures, mut crashed) = (Vec::new(), false);
    for (goes_on, effects, [residual, open_loop]) in
        [(false, "one effect", [[0.0447, 0.042], [2.15, 2.1]]), (true, "two effects", [[0.036, 0.025], [1.9, 1.6]])]
    {
        let transfer = Transfer { model: &model, effect: "coulomb_friction", goes_on, train, test, options: &options };
        let (error, fell) = transfer.error(binary)?;
        crashed |= fell;
        let millimetres = error["window_rmse"].as_f64().map(|metres| 1e3 * metres);
        let name = |what: &str| format!("EMPS test, train run's numbers, {effects}: {what}");
        let bounded =
            |what: &str, value: Option<f64>, [floor, aim]: [f64; 2]| Figure::at_most(&name(what), value, floor, aim);
        figures.push(bounded("force residual, 0.301 s", error["force_residual"].as_f64(), residual));
        figures.push(bounded("open loop of 1 s, RMSE in mm", millimetres, open_loop));
    }
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
    let transfer = Transfer {
        model,
        effect: "cubic_stiffness",
        goes_on: false,
        train: "training.csv",
        test: "arrow.csv",
        options: &[],
    };
    let (error, crashed) = transfer.error(binary)?;
    let nrmse = error["free_run_nrmse"].as_f64();
    Ok((vec![Figure::at_most("Silverbox arrow head: free-run NRMSE", nrmse, 0.0084, 0.006)], crashed))
}
