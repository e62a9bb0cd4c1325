//! Samples that no sensor should send.

use super::configurations::{self, Configuration};
use super::for_each;
use super::running::{bytes, go_on};
use std::panic::AssertUnwindSafe;
use std::sync::Mutex;
use switchid::identify::{Channels, Sample};

/// Samples of a stream: a first law is found well before its end.
const LENGTH: usize = 1000;

fn changed(samples: &[Sample], change: impl Fn(usize, &mut Sample)) -> Vec<Sample> {
    let change = |(index, sample): (usize, &Sample)| {
        let mut sample = *sample;
        change(index, &mut sample);
        sample
    };
    samples.iter().enumerate().map(change).collect()
}

fn scaled(samples: &[Sample], factor: f64) -> Vec<Sample> {
    changed(samples, |_, sample| {
        sample.q *= factor;
        sample.qd *= factor;
        sample.excitation *= factor;
    })
}

/// The streams, each with its name.
fn streams(good: &[Sample]) -> Vec<(&'static str, Vec<Sample>)> {
    let standing = |q: f64, excitation: f64| {
        changed(good, move |_, sample| *sample = Sample { t: sample.t, q, qd: 0.0, excitation })
    };
    let spike = |size: f64| {
        changed(good, move |index, sample| {
            if index % 500 == 400 {
                *sample = Sample { t: sample.t, q: size, qd: -size, excitation: size };
            }
        })
    };
    vec![
        ("jittered steps", changed(good, |index, sample| sample.t += 1e-3 * (index as f64 * 2.4).sin())),
        ("last bits of the time jitter", changed(good, |index, sample| sample.t *= 1.0 + 1e-15 * (index % 3) as f64)),
        ("gaps", changed(good, |index, sample| sample.t += 10.0 * (index / 350) as f64)),
        ("far from zero", changed(good, |_, sample| sample.t += 1e9)),
        ("before zero", changed(good, |_, sample| sample.t -= 1e3)),
        ("one sample", good[..1].to_vec()),
        ("two samples", good[..2].to_vec()),
        ("all zero", standing(0.0, 0.0)),
        ("a constant displacement", standing(1.0, 0.0)),
        ("all constant", standing(-3.0, 2.0)),
        ("no excitation", changed(good, |_, sample| sample.excitation = 0.0)),
        (
            "it stops",
            changed(good, |index, sample| {
                if index > 800 {
                    *sample = Sample { t: sample.t, ..good[800] }
                }
            }),
        ),
        ("it steps", changed(good, |index, sample| sample.q += (index / 500) as f64)),
        ("huge", scaled(good, 1e30)),
        ("tiny", scaled(good, 1e-30)),
        ("as large as numbers are", scaled(good, 1e307)),
        ("as small as numbers are", scaled(good, 5e-324)),
        ("spikes", spike(1e3)),
        ("huge spikes", spike(1e30)),
        ("spikes as large as numbers are", spike(f64::MAX)),
    ]
}

#[test]
fn no_stream_gives_a_nan_or_a_panic() {
    let broken = Mutex::new(Vec::new());
    for_each(|configuration| {
        let good = &configurations::samples(configuration.settings.channels)[..LENGTH];
        for (name, stream) in streams(good) {
            let run = || go_on(&mut configuration.fresh(), &stream);
            if std::panic::catch_unwind(AssertUnwindSafe(run)).is_err() {
                broken.lock().unwrap().push(format!("{}: {name}", configuration.name));
            }
        }
    });
    let broken = broken.into_inner().unwrap();
    assert!(broken.is_empty(), "the messages stand above:\n{}", broken.join("\n"));
}

/// Good samples with others in between that must be skipped.
fn spoiled(good: &[Sample], channels: Channels) -> Vec<Sample> {
    let mut spoiled = Vec::new();
    for (index, sample) in good.iter().enumerate() {
        spoiled.push(*sample);
        let (none, before) = (f64::NAN, sample.t - 0.1);
        spoiled.push(match index % 7 {
            0 => Sample { t: none, ..*sample },
            1 => Sample { t: before, ..*sample },
            2 => Sample { t: sample.t, q: 1e9, ..*sample },
            3 if channels.q => Sample { t: sample.t + 2e-3, q: none, ..*sample },
            4 if channels.qd => Sample { t: sample.t + 2e-3, qd: f64::INFINITY, ..*sample },
            5 if channels.excitation => Sample { t: sample.t + 2e-3, excitation: f64::NEG_INFINITY, ..*sample },
            _ => Sample { t: sample.t + 1e-3, qd: 7.0, ..*sample },
        });
    }
    spoiled
}

#[test]
fn a_skipped_sample_leaves_no_trace() {
    for_each(|configuration: &Configuration| {
        let channels = configuration.settings.channels;
        let good = configurations::samples(channels);
        let (mut clean, mut disturbed) = (configuration.fresh(), configuration.fresh());
        let expected = go_on(&mut clean, &good);
        let seen: Vec<_> = go_on(&mut disturbed, &spoiled(&good, channels));
        assert!(seen.chunks(2).zip(&expected).all(|(pair, bits)| pair.iter().all(|seen| seen == bits)));
        assert!(bytes(&clean) == bytes(&disturbed), "{}", configuration.name);
    });
}

#[test]
fn a_channel_that_is_not_measured_is_ignored() {
    for_each(|configuration| {
        let run = |absent: f64| {
            let mut identifier = configuration.fresh();
            go_on(&mut identifier, &configurations::samples_with(configuration.settings.channels, absent));
            bytes(&identifier)
        };
        assert!(run(0.0) == run(1e3), "{}: its value counts", configuration.name);
        assert!(run(0.0) == run(f64::NAN), "{}: it must be a number", configuration.name);
    });
}
