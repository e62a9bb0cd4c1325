use switchid::identify::*;
use switchid::law::*;
use switchid::simulate::*;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let name = &args[1];
    let noise: f64 = args[2].parse().unwrap();
    let seeds: u64 = args[3].parse().unwrap();
    let verbose = args.len() > 4;
    let which = Builtin::from_id(name).unwrap();
    let mut es = vec![];
    let mut det = vec![];
    let mut tr = vec![];
    let (mut missed, mut fa) = (0, 0);
    let mut cpu = 0.0;
    let mut worst: f64 = 0.0;
    let mut steps = 0u64;
    let first = args.get(5).map(|s| s.parse().unwrap()).unwrap_or(0u64);
    for seed in first..first + seeds {
        let sc = if seed == 0 { which.scenario() } else { which.random(seed) };
        let sc = if noise > 0.0 { sc.with_noise(noise) } else { sc };
        let rec = record(&sc).unwrap();
        let model = if which.is_van_der_pol() {
            Model::cubic_library()
        } else {
            Model::of("d", ["qdd", "qd", "q", "q^3"].map(|t| (Term::parse(t).unwrap(), Given::Fit)))
        };
        let mut id = Identifier::new(&model, Settings::default()).unwrap();
        let sw = sc.switch_times();
        let mut bounds = vec![0.0];
        bounds.extend(&sw);
        bounds.push(sc.duration);
        let truth = |st: usize| -> Vec<f64> {
            model
                .terms
                .iter()
                .map(|m| {
                    sc.terms.iter().position(|t| *t == m.term).map(|i| sc.stages[st].coefficients[i]).unwrap_or(0.0)
                })
                .collect()
        };
        let mut stage = 0;
        let mut th = truth(0);
        let mut last_bad = 0.0;
        let mut alarms: Vec<f64> = vec![];
        let mut e = 1.0;
        let mut count = 0;
        let mut se = vec![];
        let mut str_ = vec![];
        let mut ident = vec![];
        let mut idt = None;
        for r in &rec {
            while stage + 1 < bounds.len() - 1 && r.t >= bounds[stage + 1] {
                se.push(e);
                str_.push(last_bad - bounds[stage]);
                ident.push(idt);
                idt = None;
                stage += 1;
                th = truth(stage);
            }
            let t0 = std::time::Instant::now();
            id.step(Sample { t: r.t, q: r.q, qd: r.qd, excitation: r.excitation }).unwrap();
            let d = t0.elapsed().as_secs_f64();
            cpu += d;
            worst = worst.max(d);
            steps += 1;
            let o = id.output();
            if o.switch_count != count {
                count = o.switch_count;
                alarms.push(r.t);
                if verbose {
                    println!("  {:.3} alarm; est start {:.4}", r.t, o.switch_time);
                }
            }
            let s: f64 = th.iter().map(|x| x * x).sum();
            e = id.coefficients().iter().zip(&th).map(|(c, t)| (c.value - t).powi(2)).sum::<f64>() / s;
            if e >= 0.0025 {
                last_bad = r.t;
            }
            if o.valid && idt.is_none() {
                idt = Some(r.t - bounds[stage]);
            }
            if !o.valid {
                idt = None;
            }
            if args.len() > 6 && (r.t * 1000.0).round() as u64 % args[6].parse::<u64>().unwrap() == 0 {
                println!(
                    "{:.3} {:?} valid {} e {:.2e} dev {:.3e} thr {:.3e} nq {:?} th {:?}",
                    r.t,
                    o.status,
                    o.valid,
                    e,
                    o.deviation,
                    o.threshold,
                    o.noise_q,
                    id.coefficients().iter().map(|c| format!("{:.4}", c.value)).collect::<Vec<_>>()
                );
            }
        }
        se.push(e);
        str_.push(last_bad - bounds[stage]);
        ident.push(idt);
        let mut d = vec![];
        let mut ai = 0;
        for (i, s) in sw.iter().enumerate() {
            let next = bounds[i + 2];
            let mut got = None;
            while ai < alarms.len() && alarms[ai] < next {
                if alarms[ai] < *s {
                    fa += 1;
                } else if got.is_none() {
                    got = Some(alarms[ai] - s);
                } else {
                    fa += 1;
                    if verbose {
                        println!("false alarm seed {seed} at {:.3}", alarms[ai]);
                    }
                }
                ai += 1;
            }
            match got {
                Some(x) => d.push(x),
                None => {
                    missed += 1;
                    d.push(f64::NAN);
                    if verbose {
                        println!("missed seed {seed} switch {s}");
                    }
                }
            }
        }
        while ai < alarms.len() {
            if sw.is_empty() {
                fa += 1;
            }
            ai += 1;
        }
        if verbose {
            println!("seed {seed}");
            for i in 0..se.len() {
                println!(
                    "   stage {i} e {:.2e} det {:.4} track {:.3} ident {:?}",
                    se[i],
                    if i > 0 { d[i - 1] } else { 0.0 },
                    str_[i],
                    ident[i]
                );
            }
        }
        es.extend(se);
        det.extend(d);
        tr.extend(&str_[1..]);
        if sw.is_empty() {
            tr.push(str_[0]);
        }
    }
    let q = |v: &mut Vec<f64>| {
        v.sort_by(f64::total_cmp);
        let n = v.len();
        if n == 0 {
            return String::new();
        }
        format!(
            "median {:.3e} p90 {:.3e} max {:.3e} mean {:.3e}",
            v[n / 2],
            v[n * 9 / 10],
            v[n - 1],
            v.iter().sum::<f64>() / n as f64
        )
    };
    println!(
        "{name} noise {noise} seeds {seeds}: missed {missed} false {fa}\n   e     {}\n   det   {}\n   track {}\n   cpu/step {:.2} us worst {:.0} us",
        q(&mut es),
        q(&mut det),
        q(&mut tr),
        cpu / steps as f64 * 1e6,
        worst * 1e6
    );
}
