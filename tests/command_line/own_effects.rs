//! Effects of the user's own, as formulas: identified sample by sample, in records that switch, and carried by FMUs.

use super::bench::Bench;

/// A linear plant under a multisine with something hidden in it, and further stages.
fn scenario(hidden: &str, stages: &str) -> String {
    format!(
        "terms = [\"qdd\", \"qd\", \"q\"]\nduration = 24.0\nseed = 5\nnoise = {{ q = 2e-3, qd = 5e-3 }}\n\
         excitation = {{ kind = \"multisine\", from = 0.5, to = 12.0, count = 12, rms = 4.0, sample_time = 2e-3 }}\n\
         {hidden}\n[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 20.0]\n{stages}"
    )
}

const DRAG: &str = "[hidden]\ntip_drag = { coefficient = 1.5, v = 0.5, expression = \"abs(qd/v)^1.5*sign(qd)\" }\n";

const MODEL: &str = "[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\ntip_drag = { coefficient = \"fit\", v = 0.5 }\n\
                     [effects.tip_drag]\nexpression = \"abs(qd/v)^1.5*sign(qd)\"\n";

#[test]
fn a_formula_is_identified_and_a_switch_beside_it_seen() {
    let bench = Bench::new("own_effect");
    bench.write("model.toml", MODEL);
    bench.write("plant.toml", &scenario(DRAG, "[[stage]]\nstart = 12.0\ncoefficients = [1.0, 0.6, 26.0]\n"));
    bench.json(&["simulate", "plant.toml", "-o", "record.csv", "--json"]);
    let found = bench.json(&["identify", "record.csv", "--model", "model.toml", "--json"]);
    let stages = found["stages"].as_array().unwrap();
    assert_eq!(stages.len(), 2, "{found}");
    for (stage, stiffness) in stages.iter().zip([20.0, 26.0]) {
        assert_eq!(stage["valid"], true);
        for (term, truth) in [("qdd", 1.0), ("qd", 0.6), ("q", stiffness), ("tip_drag", 1.5)] {
            let [value, std] = ["coefficients", "std"].map(|key| stage[key][term].as_f64().unwrap());
            assert!((value - truth).abs() < 4.0 * std && std < 0.2 * truth, "{term}: {value} ± {std}");
        }
        assert!(stage["law"].as_str().unwrap().contains("tip_drag"), "{stage}");
    }
    let without =
        MODEL.split("[effects").next().unwrap().replace("tip_drag = { coefficient = \"fit\", v = 0.5 }\n", "");
    bench.write("without.toml", &without);
    let lacking = bench.json(&["identify", "record.csv", "--model", "without.toml", "--json"]);
    let last =
        |found: &serde_json::Value| found["stages"].as_array().unwrap().last().unwrap()["coefficients"]["q"].as_f64();
    assert!(last(&lacking) != last(&found), "the formula says something");
}

#[test]
fn a_law_that_gives_f_may_have_a_formula() {
    let bench = Bench::new("own_force_law");
    bench.write(
        "plant.toml",
        "terms = [\"qd\", \"q\"]\nduration = 20.0\nnoise = { q = 1e-5, qd = 1e-4, F = 0.5 }\n\
         excitation = { kind = \"multisine\", from = 1.0, to = 20.0, count = 10, rms = 0.01, sample_time = 1e-3 }\n\
         [hidden]\nstop = { coefficient = 8.0, w = 0.01, expression = \"sinh(q/w)\" }\n\
         [[stage]]\nstart = 0.0\ncoefficients = [300.0, 2000.0]\n",
    );
    bench.json(&["simulate", "plant.toml", "-o", "record.csv", "--json"]);
    let terms = "[terms]\nqd = \"fit\"\nq = \"fit\"\nstop = { coefficient = \"fit\", w = 0.01 }\n";
    bench.write("model.toml", &format!("{terms}[effects.stop]\nexpression = \"sinh(q/w)\"\n"));
    let found = bench.json(&["identify", "record.csv", "--model", "model.toml", "--json"]);
    let stage = &found["stages"][0];
    for (term, truth) in [("qd", 300.0), ("q", 2000.0), ("stop", 8.0)] {
        let [value, std] = ["coefficients", "std"].map(|key| stage[key][term].as_f64().unwrap());
        assert!((value - truth).abs() < 4.0 * std && std < 0.05 * truth, "{term}: {value} ± {std}");
    }
}

#[test]
fn what_a_stream_cannot_know_of_a_formula_is_refused_by_name() {
    let bench = Bench::new("own_refused");
    bench.write("record.csv", &super::bench::plain("t,q,qd,F", 400));
    for (inner, formula, words) in [
        ("", "q*sin(v*t)", ["\"tip_drag\": v is not given", "tip_drag = { coefficient"]),
        (", v = 1", "q*sin(v*t)", ["\"tip_drag\" depends on the time t", "simulate take it"]),
    ] {
        let terms = format!("[terms]\ninertia = \"fit\"\nq = \"fit\"\ntip_drag = {{ coefficient = \"fit\"{inner} }}\n");
        bench.write("model.toml", &format!("{terms}[effects.tip_drag]\nexpression = \"{formula}\"\n"));
        bench.identify_refuses("record.csv", &words);
    }
}

#[test]
fn fmus_carry_a_formula() {
    let bench = Bench::new("own_fmu");
    bench.write("libswitchid_fmu_identifier.so", "identifier's binary");
    bench.write("libswitchid_fmu_plant.so", "plant's binary");
    bench.write("model.toml", MODEL);
    bench.json(&["fmu", "--model", "model.toml", "-o", "I.fmu", "--binaries", ".", "--json"]);
    let xml = super::fmu::files(&bench, "I.fmu").remove("modelDescription.xml").unwrap();
    assert!(xml.contains("name=\"coef.tip_drag\"") && xml.contains("name=\"known.tip_drag\""));
    bench.write("law.toml", &MODEL.replace("\"fit\", v", "1.5, v").replace("\"fit\"", "2.0"));
    bench.json(&["fmu", "--model", "law.toml", "-o", "P.fmu", "--plant", "--binaries", ".", "--json"]);
    let files = super::fmu::files(&bench, "P.fmu");
    let law = switchid::simulate::ParametricLaw::from_toml(&files["resources/plant.toml"]).unwrap();
    assert_eq!((law.effects[0].name(), law.effects[0].values()), ("tip_drag", &[0.5][..]));
    for (name, start) in [("hidden.tip_drag", "1.5"), ("hidden.tip_drag.v", "0.5"), ("stage[1].q", "2.0")] {
        let variable = super::fmu::variable(&files["modelDescription.xml"], name);
        assert!(variable.contains(&format!("start=\"{start}\"")), "{variable}");
    }
}

#[test]
fn what_a_models_own_terms_leave_open_is_fitted_from_a_free_start() {
    let bench = Bench::new("own_open");
    let model = |own: &str, effects: &str| {
        format!("[terms]\ninertia = \"fit\"\nqd = \"fit\"\nq = \"fit\"\n{own} = \"fit\"\n{effects}")
    };
    let formula = "tanh(q/w)";
    for (name, hidden, effects, inner, truth) in [
        ("soft", "{ coefficient = 4.0, w = 0.07, expression = \"tanh(q/w)\" }", formula, "w", 0.07),
        ("dead_zone_stiffness", "{ coefficient = 30.0, gap = 0.21 }", "", "gap", 0.21),
    ] {
        let own =
            if effects.is_empty() { String::new() } else { format!("[effects.{name}]\nexpression = \"{effects}\"\n") };
        bench.write("plant.toml", &scenario(&format!("[hidden]\n{name} = {hidden}\n"), ""));
        bench.write("model.toml", &model(name, &own));
        bench.json(&["simulate", "plant.toml", "-o", "record.csv", "--force", "--json"]);
        let found = bench.json(&["compare", "record.csv", "--model", "model.toml", "--json"]);
        let value = found["inner"][format!("{inner} of {name}")].as_f64().unwrap();
        assert!((value / truth - 1.0).abs() < 0.02, "{name}: {value}");
        let stiffness = found["best"]["coefficients"]["q"].as_f64().unwrap();
        assert!((stiffness / 20.0 - 1.0).abs() < 0.01, "{name}: {stiffness}");
        let lacking = bench.json(&["diagnose", "record.csv", "--model", "model.toml", "--json"]);
        let found = bench.json(&["identify", "record.csv", "--model", "model.toml", "--json"]);
        let value = found["inner"][format!("{inner} of {name}")].as_f64().unwrap();
        let [stiffness, std] = ["coefficients", "std"].map(|key| found["stages"][0][key]["q"].as_f64().unwrap());
        assert!(
            (value / truth - 1.0).abs() < 0.02 && (stiffness - 20.0).abs() < 0.5 + 4.0 * std,
            "{name}: {value}, {stiffness}"
        );
        assert_eq!(lacking["verdict"], "adequate", "{name}: {}", lacking["effect"]);
    }
}
