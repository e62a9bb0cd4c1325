//! Models without inertia: F is the output, which a machine's motion brings about.

use super::bench::{Bench, plain};

const DAMPER: &str =
    "[terms]\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\ncoulomb_friction = \"fit\"\nq^3 = \"maybe\"\n";

fn scenario(rest: &str) -> String {
    format!(
        "terms = [\"qd\", \"q\", \"coulomb_friction\"]\nduration = 12.0\nseed = 4\nnoise = {{ q = 1e-5, qd = 1e-4, F = 0.5 }}\n{rest}\n\
         [[stage]]\nstart = 0.0\ncoefficients = [300.0, 2000.0, 15.0]\n\
         [[stage]]\nstart = 8.0\ncoefficients = [450.0, 2000.0, 15.0]\n"
    )
}

fn multisine() -> String {
    let sines = "kind = \"multisine\", from = 1.0, to = 10.0, count = 8, rms = 0.01, sample_time = 2e-3";
    scenario(&format!("excitation = {{ {sines} }}"))
}

fn bench(name: &str) -> Bench {
    let bench = Bench::new(name);
    bench.write("model.toml", &DAMPER.replace("q^3", "\"q^3\""));
    bench.write("damper.toml", &multisine());
    bench.json(&["simulate", "damper.toml", "-o", "damper.csv", "--json"]);
    bench
}

#[test]
fn a_simulated_damper_is_identified_through_its_switch() {
    let bench = bench("force-identify");
    let found = bench.json(&["identify", "damper.csv", "--model", "model.toml", "--trace", "trace.csv", "--json"]);
    assert_eq!(found["output"], "F");
    let stages = found["stages"].as_array().unwrap();
    assert_eq!(stages.len(), 2, "{found:#}");
    for (stage, damping) in stages.iter().zip([300.0, 450.0]) {
        assert!(stage["identified"].is_number() && stage["explained"].as_f64().unwrap() > 0.99, "{stage:#}");
        for (term, truth) in [("qd", damping), ("q", 2000.0), ("coulomb_friction", 15.0)] {
            let [value, std] = ["coefficients", "std"].map(|key| stage[key][term].as_f64().unwrap());
            assert!((value - truth).abs() < 4.5 * std && std < 0.02 * truth, "{term}: {value} ± {std}");
            let ratio = stage["limit"]["std_to_limit"][term].as_f64().unwrap();
            assert!((0.9..1.3).contains(&ratio), "{term}: {ratio} times the limit");
        }
        assert_eq!(stage["coefficients"]["q^3"], 0.0, "{stage:#}");
    }
    assert!((stages[1]["start"].as_f64().unwrap() - 8.0).abs() < 0.05);
    assert!((found["noise"]["F"].as_f64().unwrap() / 0.5 - 1.0).abs() < 0.1, "{found:#}");
    let trace = std::fs::read_to_string(bench.0.join("trace.csv")).unwrap();
    let header = trace.lines().next().unwrap();
    assert!(header.contains("prediction.F") && !header.contains("prediction.q"), "{header}");
}

#[test]
fn its_limits_are_those_of_the_force() {
    let bench = bench("force-limits");
    let asked = ["limits", "damper.csv@0:8", "--model", "model.toml", "--json", "--change", "linear_damping=450"];
    let limits = bench.json(&[&asked[..], &["--noise", "F=0.5"]].concat());
    let twice = bench.json(&[&asked[..], &["--noise", "F=1"]].concat());
    let std = |report: &serde_json::Value| report["coefficient_std"]["qd"].as_f64().unwrap();
    assert!((std(&twice) / std(&limits) - 2.0).abs() < 1e-9, "{limits:#}");
    assert!(limits["relative_error"].as_f64().unwrap() < 1e-4);
    let delay = |report: &serde_json::Value| report["detection"]["median"].as_f64().unwrap();
    assert!(delay(&twice) > delay(&limits), "{limits:#}");
    bench.refused(&["limits", "damper.csv", "--model", "model.toml", "--noise", "q=1"], &["--noise q=1", "F=0.5"]);
}

#[test]
fn what_it_lacks_is_said() {
    let bench = bench("force-refused");
    let model = ["--model", "model.toml"];
    bench.write("free.csv", &plain("t,q,qd", 50));
    bench
        .refused(&[&["identify", "free.csv"], &model[..]].concat(), &["model.toml", "no inertia", "F is not measured"]);
    let without_q = std::fs::read_to_string(bench.0.join("damper.csv")).unwrap().replacen("t,q,", "t,x,", 1);
    bench.write("velocity.csv", &without_q);
    let words = ["model.toml", "\"linear_stiffness\" depends on q", "not measured"];
    bench.refused(&[&["identify", "velocity.csv"], &model[..]].concat(), &words);
    let publication = ["identify", "damper.csv", "--method", "publication"];
    bench.refused(&[&publication[..], &model[..]].concat(), &["model.toml", "laws of motion"]);
}

#[test]
fn motions_that_no_machine_imposes_are_refused() {
    let bench = Bench::new("force-scenario");
    let refused = |text: &str, words: &[&str]| {
        bench.write("bad.toml", text);
        bench.refused(&["simulate", "bad.toml", "-o", "bad.csv"], &[&["bad.toml"], words].concat());
        assert!(!bench.0.join("bad.csv").exists());
    };
    refused(&scenario("excitation = { kind = \"white_noise\" }"), &["\"white_noise\" has no velocity", "multisine"]);
    refused(&scenario("excitation = { kind = \"none\" }"), &["\"none\" imposes no motion", "qdd"]);
    refused(
        &(multisine().replace("duration", "initial = { q = 0.0, qd = 1.0 }\nduration")),
        &["initial.qd = 1", "imposes q"],
    );
    refused(&multisine().replace("\"q\"", "\"F\""), &["\"F\" depends on F"]);
}
