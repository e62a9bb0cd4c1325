//! What one command says of a record and a model, the others say as well, in one format.

use super::bench::Bench;

/// A record of a linear oscillator with an effect hidden in it, `data.csv`; a linear model whose inertia stands last.
fn bench(name: &str, hidden: &str) -> Bench {
    let bench = Bench::new(name);
    let excitation = "kind = \"multisine\", from = 1.0, to = 12.0, count = 30, rms = 5.0, sample_time = 2e-3";
    let plant = format!(
        "terms = [\"qdd\", \"qd\", \"q\"]\nduration = 25.0\nseed = 31\nnoise = {{ q = 2e-3, qd = 2e-3 }}\n\
         excitation = {{ {excitation} }}\n[hidden]\n{hidden}\n[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 40.0]\n"
    );
    bench.write("plant.toml", &plant);
    bench.json(&["simulate", "plant.toml", "-o", "data.csv", "--json"]);
    let units = "[units]\nq = \"m\"\nqd = \"m/s\"\nF = \"N\"\n";
    let terms = "linear_damping = \"fit\"\nlinear_stiffness = \"fit\"\ninertia = \"fit\"\n";
    bench.write("model.toml", &format!("hold = \"zero\"\n{units}[terms]\n{terms}"));
    bench
}

const MODEL: [&str; 2] = ["--model", "model.toml"];

fn text(bench: &Bench, arguments: &[&str]) -> String {
    String::from_utf8(bench.run(arguments).stdout).unwrap()
}

#[test]
fn identify_names_what_its_law_lacks_and_the_command_that_tells_more() {
    let bench = bench("voice-lacks", "coulomb_friction = 0.6");
    let arguments = [&["identify", "data.csv"], &MODEL[..]].concat();
    let report = bench.json(&[&arguments[..], &["--json"]].concat());
    assert_eq!(report["missing"], "coulomb_friction");
    let missing = &report["stages"][0]["missing"];
    assert_eq!(missing["effect"], "coulomb_friction");
    let nats = missing["evidence"].as_f64().unwrap();
    let said = text(&bench, &arguments);
    let line = format!(
        "this law lacks coulomb_friction ({nats:.0} nats): run `switchid diagnose data.csv --model model.toml`"
    );
    assert!(said.contains(&line), "{said}");
    let told = text(&bench, &[&["diagnose", "data.csv"], &MODEL[..]].concat());
    assert!(told.starts_with("missing: coulomb_friction, ("), "{told}");
}

#[test]
fn a_complete_law_lacks_nothing_in_any_command() {
    let bench = bench("voice-complete", "");
    let report = bench.json(&[&["identify", "data.csv", "--json"], &MODEL[..]].concat());
    assert!(report["missing"].is_null() && report["stages"][0]["missing"].is_null(), "{report:#}");
    let compared = bench.json(&[&["compare", "data.csv", "--json"], &MODEL[..]].concat());
    assert_eq!(compared["verdict"], "at_noise", "{compared:#}");
}

#[test]
fn numbers_have_the_digits_of_their_std_and_a_unit_and_the_inertia_comes_first() {
    let bench = bench("voice-format", "");
    for command in ["identify", "compare", "limits"] {
        let said = text(&bench, &[&[command, "data.csv"], &MODEL[..]].concat());
        let law = said.lines().find(|line| line.ends_with(" = F")).unwrap();
        let (_, law) = law.split_once(": ").unwrap();
        assert!(law.split(' ').nth(1) == Some("q̈"), "{command}: {law}");
        let values: Vec<&str> = said.lines().filter(|line| line.contains('±') && line.contains("N s/m")).collect();
        assert_eq!(values.len(), 1, "{command}: {said}");
        let (value, std) = values[0].split_once('±').unwrap();
        let value = value.split_once('(').unwrap().1.trim();
        let std = std.split_once(") N s/m").unwrap().0.trim();
        let decimals = |number: &str| number.split_once('.').unwrap().1.len();
        assert_eq!(decimals(value), decimals(std), "{command}: {value}, {std}");
        assert_eq!(std.trim_start_matches(['0', '.']).len(), 2, "{command}: {std}");
    }
}

#[test]
fn what_improve_calls_complete_compare_does_too_and_a_refitted_model_is_taken_as_it_is() {
    let bench = bench("voice-improve", "coulomb_friction = 0.6");
    let improve = |extra: &[&'static str]| {
        let report = bench.json(&[&["improve", "data.csv", "--json"], &MODEL[..], extra].concat());
        assert_eq!(
            (&report["verdict"], &report["steps"][1]["effect"]),
            (&"adequate".into(), &"coulomb_friction".into())
        );
    };
    improve(&["-o", "numbers.toml"]);
    improve(&["-o", "fit.toml", "--refit"]);
    for model in ["numbers.toml", "fit.toml"] {
        let compared = bench.json(&["compare", "data.csv", "--model", model, "--json"]);
        assert_eq!(compared["verdict"], "at_noise", "{model}: {compared:#}");
        let said = text(&bench, &["compare", "data.csv", "--model", model]);
        assert!(said.contains("nothing to gain here"), "{model}: {said}");
    }
    let written = std::fs::read_to_string(bench.0.join("fit.toml")).unwrap();
    assert!(
        written.contains("\"coulomb_friction\" = \"fit\"") && written.contains("\"inertia\" = \"fit\""),
        "{written}"
    );
    let report = bench.json(&["identify", "data.csv", "--model", "fit.toml", "--json"]);
    assert!(report["missing"].is_null(), "{report:#}");
    let friction = report["stages"][0]["coefficients"]["coulomb_friction"].as_f64().unwrap();
    assert!((friction - 0.6).abs() < 0.05, "{friction}");
    bench.write("libswitchid_fmu_identifier.so", "stands in");
    bench.json(&["fmu", "--model", "fit.toml", "-o", "axis.fmu", "--binaries", ".", "--json"]);
    bench.refused(&["identify", "data.csv", "--model", "numbers.toml"], &["nothing to identify", "\"fit\""]);
}
