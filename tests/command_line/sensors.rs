//! What `diagnose` and `improve` make of sensors that keep other times than the motion, of lost samples, and of records
//! that show little.

use super::bench::Bench;
use serde_json::Value;

/// Seeds of every record here; each claim holds under all of them.
const SEEDS: [u64; 3] = [301, 302, 303];

/// Sample time of the records, s.
const DT: f64 = 1e-3;

const LINEAR: &str =
    "hold = \"zero\"\n[terms]\ninertia = \"fit\"\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n";

/// Rows t, q, q̇, F of a linear oscillator under a multisine.
fn oscillator(bench: &Bench, seed: u64, hidden: &str) -> Vec<[f64; 4]> {
    bench.write("model.toml", LINEAR);
    let excitation = "kind = \"multisine\", from = 1.0, to = 12.0, count = 30, rms = 5.0, sample_time = 1e-3";
    let scenario = format!(
        "terms = [\"qdd\", \"qd\", \"q\"]\nduration = 20.0\nseed = {seed}\nnoise = {{ q = 2e-3, qd = 2e-3 }}\n\
         excitation = {{ {excitation} }}\n[hidden]\n{hidden}\n[[stage]]\nstart = 0.0\ncoefficients = [1.0, 0.6, 40.0]\n"
    );
    bench.write("plant.toml", &scenario);
    bench.json(&["simulate", "plant.toml", "-o", "plant.csv", "--force", "--json"]);
    let text = std::fs::read_to_string(bench.0.join("plant.csv")).unwrap();
    let number = |cell: &str| cell.parse::<f64>().unwrap();
    let row = |line: &str| <[f64; 4]>::try_from(line.split(',').map(number).collect::<Vec<_>>()).unwrap();
    text.lines().skip(1).map(row).collect()
}

fn write(bench: &Bench, name: &str, rows: &[[f64; 4]]) {
    let line = |row: &[f64; 4]| row.map(|value| value.to_string()).join(",") + "\n";
    bench.write(name, &("t,q,qd,F\n".to_string() + &rows.iter().map(line).collect::<String>()));
}

/// The rows with one column as it stood `by` samples before; later where `by` is negative.
fn shifted(rows: &[[f64; 4]], column: usize, by: isize) -> Vec<[f64; 4]> {
    let last = rows.len() as isize - 1;
    let at = |index: usize| rows[(index as isize - by).clamp(0, last) as usize][column];
    let moved = (0..rows.len()).map(|index| {
        let mut row = rows[index];
        row[column] = at(index);
        row
    });
    moved.skip(by.unsigned_abs()).take(rows.len() - 2 * by.unsigned_abs()).collect()
}

fn diagnose(bench: &Bench, rows: &[[f64; 4]]) -> Value {
    write(bench, "data.csv", rows);
    bench.json(&["diagnose", "data.csv", "--model", "model.toml", "--json"])
}

/// Whether a line of the answer says it.
fn says(found: &Value, words: &str) -> bool {
    found["answer"].as_array().unwrap().iter().any(|line| line.as_str().unwrap().contains(words))
}

/// A delay of `timing`, with its std, within 4 std or a twentieth of a sample of the truth.
fn assert_delay(found: &Value, key: &str, truth: f64) {
    let timing = &found["timing"];
    let [delay, std] = [key.to_string(), format!("{key}_std")].map(|key| timing[key].as_f64().unwrap());
    assert!((delay - truth).abs() < (4.0 * std).max(0.05 * DT), "{key}: {delay} ± {std}, true {truth}: {timing}");
    assert!(std > 0.0 && std < DT, "{key}: {delay} ± {std}");
}

#[test]
fn a_velocity_that_comes_late_is_said_with_its_delay() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("late-velocity-{seed}"));
        let rows = oscillator(&bench, seed, "");
        let late = diagnose(&bench, &shifted(&rows, 2, 1));
        assert_delay(&late, "qd_delay", DT);
        assert!(says(&late, "sensors: qd comes ") && says(&late, " late against q"), "{:#}", late["answer"]);
        assert_eq!((&late["effect"], &late["timing"]["qd_is_derivative"]), (&Value::Null, &false.into()), "{late:#}");
        let punctual = diagnose(&bench, &rows);
        assert_delay(&punctual, "qd_delay", 0.0);
        assert!(!says(&punctual, "qd comes"), "{:#}", punctual["answer"]);
    }
}

#[test]
fn a_velocity_that_is_computed_from_q_is_no_second_measurement() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("derivative-{seed}"));
        let rows = oscillator(&bench, seed, "");
        let differences = |pair: &[[f64; 4]]| [pair[1][0], pair[1][1], (pair[1][1] - pair[0][1]) / DT, pair[1][3]];
        let found = diagnose(&bench, &rows.windows(2).map(differences).collect::<Vec<_>>());
        assert_eq!(found["timing"]["qd_is_derivative"], true, "{found:#}");
        assert!(says(&found, "qd is computed from q"), "{:#}", found["answer"]);
        assert_eq!(found["effect"], Value::Null, "{found:#}");
        let measured = diagnose(&bench, &rows);
        assert_eq!(measured["timing"]["qd_is_derivative"], false, "{measured:#}");
    }
}

#[test]
fn an_excitation_recorded_late_is_timing_and_no_effect() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("late-force-{seed}"));
        let found = diagnose(&bench, &shifted(&oscillator(&bench, seed, ""), 3, 7));
        assert_eq!(found["effect"], Value::Null, "{found:#}");
        assert_delay(&found, "F_delay", 7.0 * DT);
        assert!(says(&found, "sensors: F comes 7.0") || says(&found, "sensors: F comes 6.9"), "{:#}", found["answer"]);
    }
}

#[test]
fn an_excitation_that_acts_late_is_an_effect() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("delay-{seed}"));
        let found = diagnose(&bench, &shifted(&oscillator(&bench, seed, ""), 3, -30));
        assert_eq!((&found["verdict"], &found["effect"]), (&"missing".into(), &"excitation_delay".into()), "{found:#}");
        let delay = found["candidates"][0]["inner"]["delay"].as_f64().unwrap();
        assert!((delay - 30.0 * DT).abs() < 0.5 * DT, "{delay}");
    }
}

/// What the excitation was at a lost sample nobody knows: a little more is left than the sensors would leave.
#[test]
fn a_complete_model_lacks_nothing_where_samples_are_lost() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("lost-{seed}"));
        let mut state = seed;
        let mut arrives = |_: &[f64; 4]| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % 100 >= 3
        };
        let rows = oscillator(&bench, seed, "");
        let kept: Vec<[f64; 4]> = rows.iter().copied().filter(|row| arrives(row)).collect();
        assert!(rows.len() - kept.len() > rows.len() / 50, "{} of {} are kept", kept.len(), rows.len());
        let found = diagnose(&bench, &kept);
        assert_eq!(found["effect"], Value::Null, "{found:#}");
        for error in found["errors"].as_array().unwrap() {
            let [after, floor] = ["after", "floor"].map(|key| error[key].as_f64().unwrap());
            assert!(after < 1.5 * floor, "{error}");
        }
    }
}

/// Far below its resonance an oscillator follows its excitation: F = k q but for the noise.
#[test]
fn a_record_on_which_f_is_nearly_a_function_of_q_claims_nothing() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("slow-{seed}"));
        let rows = oscillator(&bench, seed, "");
        for follow in [1.0, 0.0] {
            let slow = |row: &[f64; 4]| {
                let (sin, cos) = (0.7 * row[0]).sin_cos();
                let noise = follow * 1e-4 * (row[1] * 1e5).sin();
                [row[0], sin + noise, 0.7 * cos + noise, 40.0 * sin]
            };
            write(&bench, "slow.csv", &rows.iter().map(slow).collect::<Vec<_>>());
            let output = bench.run(&["diagnose", "slow.csv", "--model", "model.toml", "--json"]);
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(matches!(output.status.code(), Some(0 | 2)), "seed {seed}: {said}");
            if output.status.success() {
                let found: Value = serde_json::from_slice(&output.stdout).unwrap();
                assert_eq!(found["effect"], Value::Null, "seed {seed}: {found:#}");
            }
        }
    }
}

#[test]
fn a_drift_of_q_is_the_sensors_and_no_effect() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("drift-{seed}"));
        let straight = oscillator(&bench, seed, "");
        let size = (straight.iter().map(|row| row[1] * row[1]).sum::<f64>() / straight.len() as f64).sqrt();
        let drifted: Vec<[f64; 4]> =
            straight.iter().map(|[t, q, qd, force]| [*t, q + 0.3 * size * (t / 20.0).powi(2), *qd, *force]).collect();
        let found = diagnose(&bench, &drifted);
        assert_eq!(found["verdict"], "adequate", "seed {seed}: {found:#}");
        assert!(says(&found, "q drifts by"), "{:#}", found["answer"]);
        assert!(!says(&diagnose(&bench, &straight), "q drifts"), "seed {seed}");
        let rubs = oscillator(&bench, seed, "coulomb_friction = 0.8");
        let found = diagnose(&bench, &rubs);
        assert!(found["effect"] == "coulomb_friction" && !says(&found, "q drifts"), "{found:#}");
    }
}

#[test]
fn improve_shows_the_errors_on_a_recording_that_no_coefficient_has_seen() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("validate-{seed}"));
        let friction = "coulomb_friction = 0.8";
        write(&bench, "a.csv", &oscillator(&bench, seed, friction));
        write(&bench, "b.csv", &oscillator(&bench, seed + 50, friction));
        let improve = ["improve", "a.csv", "--model", "model.toml", "-o", "better.toml", "--force"];
        let found = bench.json(&[&improve[..], &["--validate", "b.csv", "--json"]].concat());
        let steps = found["steps"].as_array().unwrap();
        assert_eq!(steps[1]["effect"], "coulomb_friction", "{found:#}");
        let seen = |step: &Value| step["validation"][1]["after"].as_f64().unwrap();
        assert!(seen(&steps[1]) < 0.5 * seen(&steps[0]), "{found:#}");
        // the law of a is as good on b as one that b itself gives
        let add = ["add", "coulomb_friction", "--model", "model.toml", "--data", "b.csv", "-o", "own.toml", "--json"];
        let own = bench.json(&add)["error_after"].as_f64().unwrap();
        assert!((0.7..1.3).contains(&(seen(&steps[1]) / own)), "{own}: {found:#}");
        assert_ne!(steps[1]["validation"][1]["after"], steps[1]["error"]);
        let alone = bench.json(&[&improve[..], &["--json"]].concat());
        assert_eq!(alone["steps"][1]["validation"], Value::Null);
        assert_eq!(alone["steps"][1]["error"], steps[1]["error"], "what validates changes no law");
        let text = String::from_utf8(bench.run(&[&improve[..], &["--validate", "b.csv"]].concat()).stdout).unwrap();
        assert!(text.contains("validation"), "{text}");
    }
}

/// A machine moves a damper with Bouc–Wen hysteresis; F is the output.
#[test]
fn a_hysteresis_is_missing_of_a_law_whose_output_is_f() {
    for seed in SEEDS {
        let bench = Bench::new(&format!("damper-{seed}"));
        let sines = "kind = \"multisine\", from = 1.0, to = 10.0, count = 8, rms = 0.01, sample_time = 2e-3";
        let loop_ = "{ coefficient = 6000.0, yield_displacement = 0.003, share = 0.5, exponent = 1.0 }";
        bench.write(
            "damper.toml",
            &format!(
                "terms = [\"qd\", \"q\"]\nduration = 20.0\nseed = {seed}\nnoise = {{ q = 1e-5, qd = 1e-4, F = 0.5 }}\n\
                 excitation = {{ {sines} }}\n[hidden]\nhysteresis = {loop_}\n\
                 [[stage]]\nstart = 0.0\ncoefficients = [300.0, 2000.0]\n"
            ),
        );
        bench.json(&["simulate", "damper.toml", "-o", "damper.csv", "--json"]);
        bench.write("damper-model.toml", "[terms]\nlinear_damping = \"fit\"\nlinear_stiffness = \"fit\"\n");
        let found = bench.json(&["diagnose", "damper.csv", "--model", "damper-model.toml", "--json"]);
        assert_eq!((&found["verdict"], &found["errors"][0]["target"]), (&"missing".into(), &"F".into()), "{found:#}");
        let tied = found["indistinguishable"].to_string().contains("\"hysteresis\"");
        assert!(found["effect"] == "hysteresis" || tied, "{found:#}");
        assert!(found["explained"].as_f64().unwrap() > 0.9, "{found:#}");
        assert!(says(&found, "F is the output"), "{:#}", found["answer"]);
    }
}
