//! `diagnose`, `add` and `improve` on plants whose hidden effect is known here and nowhere else.

use super::bench::Bench;
use serde_json::Value;

const LINEAR: &str =
    "hold = \"zero\"\n[terms]\ninertia = \"fit\"\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n";

/// A record of a linear oscillator under a multisine with this hidden in it, as `NAME.csv`.
fn simulate(bench: &Bench, name: &str, seed: u64, noise: f64, hidden: &str, stages: &str) {
    let scenario = format!(
        "terms = [\"qdd\", \"qd\", \"q\", \"coulomb_friction\"]\nduration = 30.0\nseed = {seed}\n\
         excitation = {{ kind = \"multisine\", from = 1.0, to = 12.0, count = 30, rms = 5.0, sample_time = 5e-3 }}\n\
         [hidden]\n{hidden}\n[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 40.0, 0.0]\n{stages}"
    );
    bench.write("plant.toml", &scenario);
    let (data, noise) = (format!("{name}.csv"), noise.to_string());
    bench.json(&["simulate", "plant.toml", "--noise", &noise, "-o", &data, "--json"]);
}

fn diagnose(bench: &Bench, data: &[&str]) -> Value {
    bench.write("model.toml", LINEAR);
    bench.json(&[&["diagnose"], data, &["--model", "model.toml", "--json"]].concat())
}

fn three_lines(bench: &Bench, data: &str) -> Vec<String> {
    let output = bench.run(&["diagnose", data, "--model", "model.toml"]);
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().take(3).map(String::from).collect()
}

#[test]
fn a_missing_effect_is_named_in_three_lines_and_in_json() {
    let bench = Bench::new("missing");
    simulate(&bench, "a", 11, 2e-3, "coulomb_friction = 0.8", "");
    simulate(&bench, "b", 12, 2e-3, "coulomb_friction = 0.8", "");
    let found = diagnose(&bench, &["a.csv", "b.csv@5:25"]);
    assert_eq!((&found["verdict"], &found["effect"]), (&"missing".into(), &"coulomb_friction".into()), "{found:#}");
    let best = &found["candidates"][0];
    let number = |key: &str| best[key].as_f64().unwrap();
    assert!((number("coefficient") - 0.8).abs() < 5.0 * number("std"), "{best}");
    assert!(number("error_after") < 0.5 * number("error_before") && number("p_value") < 0.01, "{best}");
    assert!(best["doubt"].is_null() && number("score") < 3.0 * 0.5_f64.ln() && number("resemblance") < 0.99, "{best}");
    assert!(found["explained"].as_f64().unwrap() > 0.9, "{found:#}");
    assert_eq!(found["errors"].as_array().unwrap().len(), 3, "{found:#}");
    let lengths: Vec<f64> = (0..3).map(|index| found["errors"][index]["window"].as_f64().unwrap()).collect();
    let period = found["period"].as_f64().unwrap();
    for (length, share) in lengths.iter().zip([0.1, 0.3, 1.0]) {
        assert!((length / (share * period) - 1.0).abs() < 1e-6, "{length} is not {share} of {period}");
    }
    let lines = three_lines(&bench, "a.csv");
    assert!(lines[0].starts_with("missing: coulomb_friction, 0."), "{lines:#?}");
    assert!(lines[1].starts_with("how sure: by chance ") && lines[1].contains(" → "), "{lines:#?}");
    assert!(lines[2].starts_with("decides: "), "{lines:#?}");
}

#[test]
fn a_complete_model_is_adequate_and_leaves_what_its_sensors_would() {
    let bench = Bench::new("adequate");
    for seed in [21, 22, 23] {
        simulate(&bench, &format!("a{seed}"), seed, 2e-3, "", "");
        let data = format!("a{seed}.csv");
        let found = diagnose(&bench, &[&data]);
        assert_eq!((&found["verdict"], &found["effect"]), (&"adequate".into(), &Value::Null), "{found:#}");
        for error in found["errors"].as_array().unwrap() {
            let [before, after, floor] = ["before", "after", "floor"].map(|key| error[key].as_f64().unwrap());
            assert!(before == after && (0.8..1.25).contains(&(after / floor)), "{error}");
        }
        let lines = three_lines(&bench, &data);
        assert!(lines[0].starts_with("nothing is missing"), "{lines:#?}");
        assert!(lines[2].starts_with("decides: no further recording"), "{lines:#?}");
    }
}

/// Reversals under dry friction are kinks that no smoothed motion has: what they leave is the floor of a complete law,
/// and hides no force that is missing.
#[test]
fn the_kinks_of_dry_friction_are_no_missing_effect() {
    let bench = Bench::new("kinks");
    bench.write("dry.toml", &format!("{LINEAR}coulomb_friction = \"fit\"\n"));
    let wobble = "wobble = { coefficient = 0.5, expression = \"q*sin(3.3*t)\" }";
    for seed in [24, 25, 26] {
        for (more, verdict) in [("", "adequate"), (wobble, "unexplained")] {
            let name = format!("{verdict}{seed}");
            simulate(&bench, &name, seed, 2e-4, &format!("coulomb_friction = 0.8\n{more}"), "");
            let found = bench.json(&["diagnose", &format!("{name}.csv"), "--model", "dry.toml", "--json"]);
            assert_eq!((&found["verdict"], &found["effect"]), (&verdict.into(), &Value::Null), "{seed}: {found:#}");
        }
    }
}

/// The error that a form without the hidden force leaves is told, and no effect of the catalogue takes it.
fn assert_unexplained(bench: &Bench, data: &str, least: f64) {
    let found = diagnose(bench, &[data]);
    assert_eq!((&found["verdict"], &found["effect"]), (&"unexplained".into(), &Value::Null), "{found:#}");
    let error = &found["errors"][1];
    let [after, floor] = ["after", "floor"].map(|key| error[key].as_f64().unwrap());
    assert!(after > least && after > 10.0 * floor, "{error}");
    let left = found["left"].as_str().unwrap();
    assert!(left.contains(&format!("{:.2} %", 100.0 * after)), "{left}: {after}");
    let lines = three_lines(bench, data);
    assert!(lines[0].starts_with("unexplained: ") && lines[0].ends_with(left), "{lines:#?}");
    assert!(lines[2].starts_with("decides: a recording at other "), "{lines:#?}");
}

#[test]
fn an_unmeasured_force_is_no_effect_of_the_catalogue() {
    let bench = Bench::new("unexplained");
    for seed in [31, 32, 33] {
        let hum = "hum = { coefficient = 1.5, expression = \"sin(9.31*t)\" }";
        simulate(&bench, &format!("a{seed}"), seed, 2e-3, hum, "");
        assert_unexplained(&bench, &format!("a{seed}.csv"), 0.1);
    }
}

#[test]
fn a_drifting_stiffness_is_no_effect_of_the_catalogue() {
    let bench = Bench::new("drift");
    for seed in [41, 42, 43] {
        let drift = "drift = { coefficient = 0.2, expression = \"q*t\" }";
        simulate(&bench, &format!("a{seed}"), seed, 2e-3, drift, "");
        assert_unexplained(&bench, &format!("a{seed}.csv"), 0.05);
    }
}

/// S of a candidate.
fn score(found: &Value, effect: &Value) -> f64 {
    let own = |candidate: &&Value| candidate["effect"] == *effect;
    found["candidates"].as_array().unwrap().iter().find(own).unwrap()["score"].as_f64().unwrap()
}

#[test]
fn what_is_beaten_beyond_chance_is_not_tied_though_it_takes_nearly_as_much() {
    let bench = Bench::new("beaten");
    for seed in [61, 62, 63] {
        let (name, data) = (format!("a{seed}"), format!("a{seed}.csv"));
        simulate(&bench, &name, seed, 0.05, "quadratic_damping = 3.0", "");
        let found = diagnose(&bench, &[&data]);
        assert_eq!(found["effect"], "quadratic_damping", "{found:#}");
        let [best, other] = ["quadratic_damping", "cubic_damping"].map(|effect| score(&found, &effect.into()));
        assert!(other < 0.6 * best, "{other} of {best}");
        assert!(!found["indistinguishable"].to_string().contains("cubic_damping"), "{found:#}");
    }
}

#[test]
fn what_cannot_be_told_apart_is_a_tie_with_the_recording_that_would() {
    let bench = Bench::new("tie");
    for seed in [51, 52, 53] {
        let (name, data) = (format!("a{seed}"), format!("a{seed}.csv"));
        simulate(&bench, &name, seed, 0.1, "cubic_stiffness = 7.0", "");
        let found = diagnose(&bench, &[&data]);
        assert_eq!(found["verdict"], "missing", "{found:#}");
        let group = found["indistinguishable"][0].as_array().unwrap();
        assert!(group.len() > 1 && group.contains(&"cubic_stiffness".into()), "{group:?}");
        assert_eq!(group[0], found["effect"], "the best first");
        assert!(
            group.iter().all(|id| (score(&found, id) - score(&found, &group[0])).abs() <= 0.15 + 1e-9),
            "{found:#}"
        );
        let lines = three_lines(&bench, &data);
        assert!(lines[0].contains("; this record cannot tell it from "), "{lines:#?}");
        assert!(lines[2].starts_with("decides: a longer or larger motion, between "), "{lines:#?}");
    }
}

#[test]
fn an_effect_of_one_stage_only_is_missing_there() {
    let bench = Bench::new("stages");
    let second = "[[stage]]\nstart = 15.0\ncoefficients = [1.0, 0.6, 55.0, 1.0]\n";
    simulate(&bench, "a", 61, 2e-3, "", second);
    let found = diagnose(&bench, &["a.csv"]);
    let stages = found["stages"].as_array().unwrap();
    assert_eq!(stages.len(), 2, "{found:#}");
    assert!((stages[1]["start"].as_f64().unwrap() - 15.0).abs() < 0.5, "{found:#}");
    assert_eq!((&stages[0]["verdict"], &stages[1]["verdict"]), (&"adequate".into(), &"missing".into()), "{found:#}");
    assert_eq!((&found["verdict"], &found["effect"]), (&"missing".into(), &"coulomb_friction".into()), "{found:#}");
    let lines = three_lines(&bench, "a.csv");
    assert_eq!(lines[0], "missing in stage 2 of 2 only: coulomb_friction");
}

#[test]
fn what_all_stages_lack_is_named_beside_a_switch() {
    let bench = Bench::new("beside");
    let second = "[[stage]]\nstart = 15.0\ncoefficients = [1.0, 0.6, 52.0, 0.0]\n";
    for (effect, value) in [("coulomb_friction", 0.8), ("cubic_stiffness", 6.0), ("quadratic_damping", 0.5)] {
        simulate(&bench, effect, 31, 2e-3, &format!("{effect} = {value:.1}"), second);
        let found = diagnose(&bench, &[&format!("{effect}.csv")]);
        let stages = found["stages"].as_array().unwrap();
        assert_eq!(stages.len(), 2, "{effect}: {found:#}");
        assert!((stages[1]["start"].as_f64().unwrap() - 15.0).abs() < 0.5, "{effect}: {found:#}");
        assert!(stages.iter().all(|stage| stage["effect"] == effect), "{effect}: {found:#}");
    }
}

#[test]
fn a_switch_is_seen_behind_an_effect_that_is_larger() {
    let bench = Bench::new("behind");
    let second = "[[stage]]\nstart = 15.0\ncoefficients = [1.0, 0.6, 44.0, 0.0]\n";
    for (effect, value) in [("constant_force", 8.0), ("cubic_stiffness", 60.0), ("quadratic_damping", 3.0)] {
        simulate(&bench, effect, 77, 2e-3, &format!("{effect} = {value:.1}"), second);
        let found = diagnose(&bench, &[&format!("{effect}.csv")]);
        let stages = found["stages"].as_array().unwrap();
        assert_eq!(stages.len(), 2, "{effect}: {found:#}");
        assert!((stages[1]["start"].as_f64().unwrap() - 15.0).abs() < 0.5, "{effect}: {found:#}");
        assert!(stages.iter().all(|stage| stage["effect"] == effect), "{effect}: {found:#}");
    }
}

#[test]
fn the_border_of_two_stages_is_where_the_law_with_the_effect_has_it() {
    let bench = Bench::new("border");
    let second = "[[stage]]\nstart = 15.0\ncoefficients = [1.0, 0.6, 48.0, 0.0]\n";
    for (effect, value) in [("coulomb_friction", 1.5), ("cubic_stiffness", 30.0)] {
        simulate(&bench, effect, 77, 2e-3, &format!("{effect} = {value:.1}"), second);
        let found = diagnose(&bench, &[&format!("{effect}.csv")]);
        let border = found["stages"][1]["start"].as_f64().unwrap();
        assert!((border - 15.0).abs() < 0.2, "{effect}: {border}");
    }
}

#[test]
fn recordings_made_in_different_stages_are_diagnosed_together() {
    let bench = Bench::new("stages_apart");
    let softer = |stiffness: f64| format!("[[stage]]\nstart = 10.0\ncoefficients = [1.0, 0.6, {stiffness}, 0.0]\n");
    simulate(&bench, "a", 72, 2e-3, "coulomb_friction = 0.8", &softer(28.0));
    simulate(&bench, "b", 73, 2e-3, "coulomb_friction = 0.8", &softer(28.0));
    let stages = |data: &[&str]| diagnose(&bench, data)["stages"].as_array().unwrap().len();
    let apart = diagnose(&bench, &["a.csv@0:9.9", "b.csv@12:30"]);
    assert_eq!(apart["stages"].as_array().unwrap().len(), 2, "{apart:#}");
    for stage in apart["stages"].as_array().unwrap() {
        assert_eq!(stage["effect"], "coulomb_friction", "{stage}");
    }
    assert_eq!(stages(&["a.csv@0:9.9", "b.csv@0:9.9"]), 0, "one stage in two recordings is one law");
    let found = diagnose(&bench, &["a.csv"]);
    let border = found["stages"][1]["start"].as_f64().unwrap();
    assert!((border - 10.0).abs() < 0.1, "{border}");
}

#[test]
fn add_and_improve_write_models_that_are_at_the_noise() {
    let bench = Bench::new("add");
    simulate(&bench, "a", 71, 2e-3, "coulomb_friction = 0.8", "");
    simulate(&bench, "b", 72, 2e-3, "coulomb_friction = 0.8", "");
    bench.write("model.toml", LINEAR);
    let add = ["add", "coulomb_friction", "--model", "model.toml", "--data", "a.csv", "-o", "added.toml", "--json"];
    let added = bench.json(&add);
    let error = |key: &str| added[key].as_f64().unwrap();
    assert!(error("error_after") < 0.5 * error("error_before"), "{added}");
    let friction = added["coefficients"]["coulomb_friction"].as_f64().unwrap();
    assert!((friction - 0.8).abs() < 5.0 * added["std"]["coulomb_friction"].as_f64().unwrap(), "{added}");
    let improve =
        ["improve", "a.csv", "--model", "model.toml", "-o", "better.toml", "--picture", "stairs.svg", "--json"];
    let improved = bench.json(&improve);
    assert_eq!((&improved["verdict"], &improved["steps"][0]["effect"]), (&"adequate".into(), &Value::Null));
    assert_eq!(improved["steps"][1]["effect"], "coulomb_friction", "{improved:#}");
    let picture = std::fs::read_to_string(bench.0.join("stairs.svg")).unwrap();
    assert!(picture.contains("<svg") && picture.contains("+ coulomb_friction") && picture.contains("noise floor"));
    for model in ["added.toml", "better.toml"] {
        let compared = bench.json(&["compare", "b.csv", "--model", model, "--json"]);
        assert_eq!(compared["verdict"], "at_noise", "{model}: {compared:#}");
    }
}

#[test]
fn nothing_is_overwritten_unasked() {
    let bench = Bench::new("overwrite");
    simulate(&bench, "a", 81, 2e-3, "coulomb_friction = 0.8", "");
    bench.write("model.toml", LINEAR);
    let add = ["add", "coulomb_friction", "--model", "model.toml", "--data", "a.csv", "-o", "model.toml"];
    bench.refused(&add, &["model.toml", "exists already", "--force"]);
    bench.refused(&["improve", "a.csv", "--model", "model.toml", "-o", "model.toml"], &["exists already"]);
    assert_eq!(std::fs::read_to_string(bench.0.join("model.toml")).unwrap(), LINEAR);
    assert!(bench.run(&[add.as_slice(), &["--force"]].concat()).status.success());
    assert!(std::fs::read_to_string(bench.0.join("model.toml")).unwrap().contains("coulomb_friction"));
}

#[test]
fn effects_that_are_unknown_or_there_already_are_refused() {
    let bench = Bench::new("effects");
    simulate(&bench, "a", 91, 2e-3, "", "");
    bench.write("model.toml", LINEAR);
    let add = |effect| ["add", effect, "--model", "model.toml", "--data", "a.csv", "-o", "new.toml"];
    bench.refused(&add("colomb_friction"), &["colomb_friction", "did you mean coulomb_friction", "hysteresis"]);
    bench.refused(&add("qd"), &["model.toml has the effect \"qd\" already", "linear_damping"]);
    bench.refused(&["add", "q^3", "--model", "model.toml", "-o", "new.toml"], &["--data"]);
    assert!(!bench.0.join("new.toml").exists());
}

#[test]
fn a_model_without_inertia_is_compared_diagnosed_and_improved_and_refused_where_it_must_move() {
    let bench = Bench::new("massless");
    simulate(&bench, "a", 101, 2e-3, "", "");
    bench.write("model.toml", "hold = \"zero\"\n[terms]\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n");
    let compared = bench.json(&["compare", "a.csv", "--model", "model.toml", "--json"]);
    assert!(compared["error"]["free_run_nrmse"].is_null(), "{compared:#}");
    assert!(compared["error"]["force_residual"].as_f64().unwrap() > 0.1, "{compared:#}");
    let found = bench.json(&["diagnose", "a.csv", "--model", "model.toml", "--json"]);
    assert_eq!((&found["verdict"], &found["effect"]), (&"missing".into(), &"inertia".into()), "{found:#}");
    let improved = bench.json(&["improve", "a.csv", "--model", "model.toml", "-o", "better.toml", "--json"]);
    assert_eq!((&improved["verdict"], &improved["steps"][1]["effect"]), (&"adequate".into(), &"inertia".into()));
    let limits = bench.json(&["limits", "a.csv", "--model", "model.toml", "--json"]);
    assert!(limits["hold"].is_null() && limits["noise"]["F"].as_f64().unwrap() > 0.0, "{limits:#}");
    let readings = std::fs::read_to_string(bench.0.join("a.csv")).unwrap();
    let without_force = readings.lines().map(|line| line.rsplit_once(',').unwrap().0.to_string() + "\n");
    bench.write("free.csv", &without_force.collect::<String>());
    bench.refused(&["diagnose", "free.csv", "--model", "model.toml"], &["free.csv", "no excitation", "inertia = 1.0"]);
}

#[test]
fn a_law_with_memory_runs_freely_and_errs_without_it() {
    let bench = Bench::new("memory");
    let inner = "yield_displacement = 0.05, share = 0.6, exponent = 2.0";
    simulate(&bench, "a", 111, 1e-2, &format!("hysteresis = {{ coefficient = 12.0, {inner} }}"), "");
    let linear = "hold = \"zero\"\n[terms]\ninertia = 1.0\nlinear_damping = 0.6\nlinear_stiffness = 40.0\n";
    let free_run = |text: &str| {
        bench.write("model.toml", text);
        let compared = bench.json(&["compare", "a.csv", "--model", "model.toml", "--json"]);
        compared["error"]["free_run_nrmse"].as_f64().unwrap()
    };
    let without = free_run(linear);
    let with = free_run(&format!("{linear}hysteresis = {{ coefficient = 12.0, {inner} }}\n"));
    assert!(with < 0.05 && with < 0.2 * without, "{with} with the loop, {without} without it");
}
