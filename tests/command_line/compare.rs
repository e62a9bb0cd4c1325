//! What `switchid compare` prints: three lines first, then tables; one JSON document with every key.

use super::bench::{Bench, MODEL, plain};

/// A noisy Duffing record of the built-in plant, `record.csv`, and the numbers of its law.
fn bench(name: &str) -> Bench {
    let bench = Bench::new(name);
    let output = bench.run(&["simulate", "duffing-white", "--seed", "3", "--noise", "0.01", "-o", "record.csv"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    bench
}

#[test]
fn json_has_every_key_for_one_and_for_several_recordings() {
    let bench = bench("compare-json");
    let sections = ["record.csv@0:8", "record.csv@2:8"];
    for data in [&sections[..1], &sections[..]] {
        let report = bench.json(&[&["compare"], data, &["--model", "model.toml", "--json", "--hold", "zero"]].concat());
        for error in [&report["error"], &report["best"]["error"], &report["recordings"][data.len() - 1]["error"]] {
            for key in ["force_residual", "window", "noise_floor", "free_run_nrmse", "window_rmse", "horizon"] {
                assert!(error[key].as_f64().is_some_and(|value| value > 0.0), "{key}: {report:#}");
            }
        }
        assert_eq!(report["recordings"].as_array().unwrap().len(), data.len());
        assert_eq!(report["recordings"][0]["hold"], "zero");
        assert_eq!(report["verdict"], "at_noise", "{report:#}");
        assert!(report["fails"].as_array().unwrap().is_empty(), "{report:#}");
        let free_run = report["error"]["free_run_nrmse"].as_f64().unwrap();
        assert!(free_run < 0.05, "{free_run}");
    }
}

#[test]
fn a_model_without_its_stiffness_fails_somewhere_and_says_so_in_three_lines() {
    let bench = bench("compare-text");
    bench.write("linear.toml", &MODEL.replace("\"q^3\" = \"fit\"\n", ""));
    let arguments = ["compare", "record.csv@0:8", "--model", "linear.toml", "--hold", "zero"];
    let text = String::from_utf8(bench.run(&arguments).stdout).unwrap();
    let heads: Vec<&str> = text.lines().take(3).filter_map(|line| line.split(':').next()).collect();
    assert_eq!(heads, ["how wrong", "where", "next"], "{text}");
    assert!(text.contains("switchid diagnose record.csv@0:8 --model linear.toml"), "{text}");
    let report = bench.json(&[&arguments[..], &["--json"]].concat());
    assert_eq!(report["verdict"], "form_wrong");
    let fails = report["fails"].as_array().unwrap();
    assert!(!fails.is_empty(), "{report:#}");
    for fail in fails {
        assert!(["time", "region"].contains(&fail["kind"].as_str().unwrap()));
        assert!((0.0..=1.0).contains(&fail["share"].as_f64().unwrap()));
        assert!(fail["sentence"].as_str().unwrap().contains("% of the error lies"));
        assert!(fail["bounds"][0]["of"].is_string());
    }
}

#[test]
fn numbers_out_of_range_and_records_that_do_not_move_are_refused() {
    let bench = Bench::new("compare-bad");
    bench.write("data.csv", &plain("t,q,qd,F", 500));
    let compare = |extra: &[&'static str]| [&["compare", "data.csv", "--model", "model.toml"], extra].concat();
    bench.refused(&compare(&["--window", "0"]), &["--window", "positive"]);
    bench.refused(&compare(&["--horizon", "nan"]), &["--horizon", "positive"]);
    bench.refused(&["compare", "absent.csv", "--model", "model.toml"], &["absent.csv"]);
    bench.refused(&["compare", "--model", "model.toml"], &["DATA"]);
}

#[test]
fn short_and_free_records_are_compared() {
    let bench = Bench::new("compare-short");
    bench.write("short.csv", &plain("t,q,F", 12));
    bench.write("free.csv", &plain("t,q,qd", 400));
    for file in ["short.csv", "free.csv"] {
        let report = bench.json(&["compare", file, "--model", "model.toml", "--json"]);
        assert!(report["error"]["force_residual"].as_f64().is_some_and(|value| value >= 0.0), "{file}: {report:#}");
    }
}
