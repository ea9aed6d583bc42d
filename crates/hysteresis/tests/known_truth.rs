//! Dirty records of loops that are known exactly: the fit must find them within what the dirt allows.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::f64::consts::PI;

use hysteresis::synthetic::{self, DirtyRecord, Drive};
use hysteresis::{Fit, FitError, FitSettings, Loop, Note, Record, fit};
use num_complex::Complex64;

/// A rounded loop with an even harmonic, 15 harmonics.
fn truth() -> Loop {
    let symmetric = synthetic::dahl_loop(8e-6, 12.0, 6e6, 15).unwrap();
    synthetic::with_harmonic(&symmetric, 2, Complex64::new(0.5, -0.3)).unwrap()
}

fn fitted(record: &Record) -> Fit {
    fit(record, &FitSettings::default()).unwrap()
}

/// Largest error of a harmonic relative to |F_1|, and the error of the amplitude relative to it.
fn errors(found: &Fit, exact: &Loop) -> (f64, f64) {
    let one = found.hysteresis_loop.coefficients();
    let other = exact.coefficients();
    let largest = (1..one.len().max(other.len()))
        .map(|k| {
            let at = |c: &[Complex64]| c.get(k).copied().unwrap_or_default();
            (at(one) - at(other)).norm()
        })
        .fold(0.0, f64::max);
    let amplitude = found.hysteresis_loop.displacement_amplitude() / exact.displacement_amplitude() - 1.0;
    (largest / exact.force_amplitude(), amplitude.abs())
}

#[test]
fn the_dahl_loop_has_the_area_of_its_closed_form() {
    let (a, slip_force, stiffness) = (8e-6, 12.0, 6e6);
    let slip_way: f64 = slip_force / stiffness;
    let area = 4.0 * slip_force * (a - slip_way * (a / slip_way).tanh());
    let dahl = synthetic::dahl_loop(a, slip_force, stiffness, 63).unwrap();
    // The projection is a trapezoid rule with 4096 points over a force with two kinks.
    assert!((dahl.dissipation() / area - 1.0).abs() < 1e-6, "{} {area}", dahl.dissipation());
    let gap = 3e-6;
    let inner = a - 0.5 * gap;
    let area = 4.0 * slip_force * (inner - slip_way * (inner / slip_way).tanh());
    let backlash = synthetic::backlash_loop(a, slip_force, stiffness, gap, 63).unwrap();
    assert!((backlash.dissipation() / area - 1.0).abs() < 1e-5, "{} {area}", backlash.dissipation());
}

#[test]
fn an_elastic_coulomb_loop_has_the_describing_function_of_its_closed_form() {
    let (amplitude, stiffness, slip_force) = (8e-6, 6e6, 12.0);
    let slip_way: f64 = slip_force / stiffness;
    let turn = (1.0 - 2.0 * slip_way / amplitude).acos();
    let in_phase = stiffness * amplitude / PI * (turn - 0.5 * (2.0 * turn).sin());
    let quadrature = 4.0 * slip_force / PI * (1.0 - slip_way / amplitude);
    // From rest, without run-up: the first quarter cycle is not on the loop.
    let (mut slider, mut last) = (0.0, 0.0);
    let samples = 1000;
    let (mut w, mut f) = (Vec::new(), Vec::new());
    for j in 0..6 * samples {
        let displacement = amplitude * (2.0 * PI * f64::from(j) / f64::from(samples)).sin();
        slider = f64::clamp(slider + stiffness * (displacement - last), -slip_force, slip_force);
        last = displacement;
        w.push(displacement);
        f.push(slider);
    }
    // Written with few digits it has steps, but no backlash.
    let rounded = Record::new(
        None,
        w.iter().map(|w| (w / 4e-7).round() * 4e-7).collect(),
        f.iter().map(|f| f64::round(*f)).collect(),
    );
    let notes = fitted(&rounded.unwrap()).notes;
    assert!(!notes.iter().any(|note| matches!(note, Note::Backlash { .. })), "{notes:?}");

    let found = fitted(&Record::new(None, w, f).unwrap());
    let first = found.hysteresis_loop.coefficients()[1];
    // The kinks lie anywhere between two samples: (π/1000)² of the jump in slope, about stiffness ×
    // amplitude.
    let error = (first - Complex64::new(in_phase, quadrature)).norm();
    assert!(error < (PI / 1000.0).powi(2) * stiffness * amplitude, "{error}");
    assert!(found.is_symmetric() && found.cycles == 6);
}

#[test]
fn a_clean_record_gives_back_its_loop() {
    let found = fitted(&DirtyRecord::new(truth()).generate());
    let (harmonics, amplitude) = errors(&found, &truth());
    assert_eq!((found.cycles, found.branches), (5, (5, 4)));
    assert!((found.period.unwrap() - 2.0).abs() < 1e-6);
    assert!(harmonics < 1e-6 && amplitude < 3e-8, "{harmonics:e} {amplitude:e}");
    assert!(found.noise < 1e-4, "{}", found.noise);
    assert!(found.notes.iter().any(|note| matches!(note, Note::RunUpRunDown { .. })));
}

#[test]
fn whole_cycles_are_counted_wherever_the_record_begins() {
    for cycles in 1..=4 {
        for tenth in 0..10 {
            let start = f64::from(tenth) / 10.0 + 0.013;
            for with_time in [true, false] {
                let record =
                    DirtyRecord { with_time, ..DirtyRecord::steady_only(truth(), cycles, start) }.generate();
                let found = fit(&record, &FitSettings::default())
                    .unwrap_or_else(|e| panic!("{cycles} cycles from {start}: {e}"));
                assert_eq!(found.cycles, cycles, "from {start}");
                let (harmonics, amplitude) = errors(&found, &truth());
                // The parabola takes tips no deeper than 1e-3 for it: 1e-6/6 · 3/35 of the amplitude.
                assert!(
                    harmonics < 2e-7 && amplitude < 3e-8,
                    "{cycles} from {start}: {harmonics:e} {amplitude:e}"
                );
                if with_time && cycles > 1 {
                    assert!((found.period.unwrap() - 2.0).abs() < 1e-5, "{:?}", found.period);
                } else if !with_time {
                    assert_eq!(found.period, None);
                }
            }
        }
    }
}

#[test]
fn noise_enters_no_further_than_its_standard_error() {
    let (mut worst, mut squares, mut count) = (0.0_f64, 0.0, 0.0);
    let (mut claims, mut spurious) = (Vec::new(), 0);
    for seed in 0..20 {
        let dirty = DirtyRecord { force_noise: 0.05, seed, ..DirtyRecord::new(truth()) };
        let found = fitted(&dirty.generate());
        assert!((found.noise / 0.05 - 1.0).abs() < 0.1, "{}", found.noise);
        // 5 unloading and 4 loading branches of 256 samples: E|error|² = s² (1/5 + 1/4)/256.
        let force = truth().force_amplitude();
        let error = 0.05 * force * (0.45_f64 / 256.0).sqrt();
        claims.extend(found.harmonic_noise.iter().skip(1).map(|claimed| (claimed / error).powi(2)));
        spurious += found.kept_harmonics().filter(|k| *k > 15).count();
        for (k, exact) in truth().coefficients().iter().enumerate().skip(1) {
            let coefficient = found.hysteresis_loop.coefficients().get(k).copied().unwrap_or_default();
            if coefficient == Complex64::ZERO {
                // Dropped: it was lost in noise.
                assert!(exact.norm() < (3.0 + 4.0) * error, "harmonic {k}");
                continue;
            }
            let off = (coefficient - exact).norm() / error;
            worst = worst.max(off);
            squares += off * off;
            count += 1.0;
            let claimed = found.harmonic_noise[k] / error;
            assert!((0.4..2.0).contains(&claimed), "harmonic {k} claims {claimed} of its standard error");
        }
    }
    let rms = f64::sqrt(squares / count);
    // 20 records of 31 harmonics, 7 degrees of freedom each.
    let claimed = (claims.iter().sum::<f64>() / claims.len() as f64).sqrt();
    assert!((claimed - 1.0).abs() < 0.05, "{claimed}");
    // Noise passes with e^{−9} a harmonic; here are 320.
    assert!(spurious <= 1, "{spurious}");
    // |error|² is exponentially distributed: of 300, none is above 4² but with a probability of 3e-5.
    assert!(worst < 4.0, "{worst}");
    assert!((0.8..1.25).contains(&rms), "{rms}");
}

#[test]
fn one_noisy_cycle_tells_its_noise_from_what_the_series_leaves() {
    for seed in 0..10 {
        let clean = DirtyRecord::steady_only(truth(), 1, 0.1);
        let found = fitted(&DirtyRecord { force_noise: 0.03, seed, ..clean }.generate());
        // 512 samples less 63 coefficients: the RMS of normal noise is known to 1/√(2·449) = 3.3 %.
        assert!((found.noise / 0.03 - 1.0).abs() < 0.13, "{}", found.noise);
        assert!(found.notes.contains(&Note::SingleCycle));
        let error = 0.03 * truth().force_amplitude() * 2.0 / 512.0_f64.sqrt();
        let first = found.hysteresis_loop.coefficients()[1] - truth().coefficients()[1];
        assert!(first.norm() < 4.0 * error, "{} {error}", first.norm());
        assert!((found.harmonic_noise[1] / error - 1.0).abs() < 0.13, "{}", found.harmonic_noise[1] / error);
    }
}

#[test]
fn a_curve_read_off_a_figure_is_enough() {
    // 61 points without time, evenly spaced along the displacement, so few near the tips.
    let curve = DirtyRecord {
        samples_per_cycle: 60.0,
        drive: Drive::Triangle,
        with_time: false,
        ..DirtyRecord::steady_only(truth(), 1, 0.25)
    };
    let found = fitted(&curve.generate());
    // The widest gap is arccos(1 − 2/30) = 0.367 rad at the tips: π/0.367 = 8.
    let coarse = found.notes.iter().any(|note| matches!(note, Note::CoarseSampling { harmonics: 8, .. }));
    assert!(coarse && found.cycles == 1 && found.period.is_none(), "{:?}", found.notes);
    let (_, amplitude) = errors(&found, &truth());
    let dissipation = found.hysteresis_loop.dissipation() / truth().dissipation() - 1.0;
    assert!(amplitude < 1e-12, "{amplitude:e}");
    // Chords between 30 points of a branch.
    assert!(dissipation.abs() < 0.01, "{dissipation}");
}

#[test]
fn the_same_few_phases_over_and_over_tell_few_harmonics() {
    let dirty = DirtyRecord { samples_per_cycle: 12.0, ..DirtyRecord::steady_only(truth(), 6, 0.0) };
    let found = fitted(&dirty.generate());
    assert!(found.notes.contains(&Note::CoarseSampling { harmonics: 3, asked: 31 }), "{:?}", found.notes);
}

#[test]
fn more_than_a_cycle_and_less_than_two_have_one_area() {
    let mut record = DirtyRecord::steady_only(truth(), 2, 0.8).generate();
    for column in [&mut record.displacement, &mut record.force].into_iter().chain(&mut record.time) {
        column.truncate(700);
    }
    let found = fitted(&record);
    assert!((found.direct_dissipation / truth().dissipation() - 1.0).abs() < 1e-3, "{found:?}");
}

#[test]
fn much_noise_in_the_displacement_does_not_make_the_loop_wider() {
    for seed in 0..5 {
        let dirty = DirtyRecord { displacement_noise: 0.05, seed, ..DirtyRecord::new(truth()) };
        let (_, amplitude) = errors(&fitted(&dirty.generate()), &truth());
        // A tip is the middle of a parabola through about 70 samples: 1.5 · 0.05/√70; nine tips, three
        // standard errors. The largest samples are 0.12 too far out.
        assert!(amplitude < 3.0 * 1.5 * 0.05 / 70.0_f64.sqrt() / 3.0, "{amplitude:e}");
    }
}

#[test]
fn noise_is_not_taken_for_backlash() {
    let stiff = synthetic::dahl_loop(8e-6, 12.0, 1e7, 31).unwrap();
    for seed in 0..20 {
        let dirty = DirtyRecord {
            force_noise: 0.05,
            displacement_noise: 0.02,
            samples_per_cycle: 400.0,
            seed,
            ..DirtyRecord::new(stiff.clone())
        };
        let found = fitted(&dirty.generate());
        assert!(!found.notes.iter().any(|note| matches!(note, Note::Backlash { .. })), "{:?}", found.notes);
    }
}

#[test]
fn noise_in_the_displacement_hardly_moves_the_loop() {
    for seed in 0..5 {
        let dirty = DirtyRecord { displacement_noise: 0.01, seed, ..DirtyRecord::new(truth()) };
        let found = fitted(&dirty.generate());
        let (harmonics, amplitude) = errors(&found, &truth());
        assert_eq!(found.cycles, 5);
        assert!(amplitude < 2e-3 && harmonics < 4e-3, "{harmonics:e} {amplitude:e}");
        assert!(!found.notes.iter().any(|note| matches!(note, Note::InteriorReversals { .. })));
    }
}

#[test]
fn offsets_and_drifts_are_removed_and_reported() {
    let dirty = DirtyRecord {
        displacement_offset: 3.0,
        displacement_drift: 0.05,
        force_offset: -2.0,
        force_drift: 0.03,
        steady: 8,
        ..DirtyRecord::new(truth())
    };
    let found = fitted(&dirty.generate());
    let (harmonics, amplitude) = errors(&found, &truth());
    assert_eq!(found.cycles, 8);
    assert!((found.displacement_drift / (0.05 * 8e-6) - 1.0).abs() < 1e-6, "{}", found.displacement_drift);
    let drift = 0.03 * truth().force_amplitude();
    assert!((found.force_drift / drift - 1.0).abs() < 1e-4, "{} {drift}", found.force_drift);
    assert!(found.notes.iter().any(|note| matches!(note, Note::DisplacementDrift { .. })));
    assert!(found.notes.iter().any(|note| matches!(note, Note::ForceDrift { .. })));
    assert!(harmonics < 1e-6 && amplitude < 3e-8, "{harmonics:e} {amplitude:e}");
}

#[test]
fn strong_drift_is_no_run_up() {
    let dirty = DirtyRecord { displacement_drift: 0.5, ..DirtyRecord::steady_only(truth(), 8, 0.1) };
    let found = fitted(&dirty.generate());
    let (harmonics, amplitude) = errors(&found, &truth());
    assert_eq!(found.cycles, 8);
    assert!(harmonics < 1e-6 && amplitude < 3e-8, "{harmonics:e} {amplitude:e}");
}

#[test]
fn a_dwell_at_the_turning_points_does_no_harm() {
    let mut record =
        DirtyRecord { displacement_noise: 1e-3, ..DirtyRecord::steady_only(truth(), 4, 0.1) }.generate();
    let clock: Vec<f64> = (0..record.len() + 9 * 100).map(|j| j as f64 / 356.0).collect();
    for column in [&mut record.displacement, &mut record.force] {
        // Sample 77 + 256 n is nearest to a tip; hold it for 100 samples.
        let held = |(j, x): (usize, &f64)| {
            let times = if j % 256 == 77 { 100 } else { 1 };
            std::iter::repeat_n(*x, times)
        };
        *column = column.iter().enumerate().flat_map(held).collect();
    }
    let time = clock.iter().copied().take(record.displacement.len()).collect();
    let found = fitted(&Record::new(Some(time), record.displacement, record.force).unwrap());
    let (harmonics, amplitude) = errors(&found, &truth());
    assert_eq!(found.cycles, 4);
    assert!((found.period.unwrap() - 2.0).abs() < 0.02, "{:?}", found.period);
    // The tip of a dwell is its largest sample, three or so standard deviations of the noise too far out.
    assert!(harmonics < 6e-3 && amplitude < 3e-3, "{harmonics:e} {amplitude:e} {:?}", found.notes);
}

#[test]
fn odd_sampling_is_no_obstacle() {
    for (samples_per_cycle, jitter, drive, harmonics_bound) in [
        (97.31, 0.4, Drive::Sine, 1e-4),
        (31.7, 0.0, Drive::Sine, 1e-3),
        (17.37, 0.3, Drive::Sine, 5e-3),
        // A sharp tip between two samples cannot be seen: 4 × amplitude / samples from one sample to the
        // next, a quarter of that is missed in the mean, and the force is out by twice as much.
        (200.9, 0.2, Drive::Triangle, 2.0 * 2.0 / 200.9),
        (2000.9, 0.2, Drive::Triangle, 2.0 * 2.0 / 2000.9),
    ] {
        let dirty = DirtyRecord { samples_per_cycle, jitter, drive, steady: 20, ..DirtyRecord::new(truth()) };
        let found = fitted(&dirty.generate());
        let (harmonics, amplitude) = errors(&found, &truth());
        assert_eq!(found.cycles, 20, "{samples_per_cycle}");
        assert!(harmonics < harmonics_bound, "{samples_per_cycle} {drive:?}: {harmonics:e}");
        assert!(amplitude < harmonics_bound, "{samples_per_cycle} {drive:?}: {amplitude:e}");
    }
}

#[test]
fn chatter_is_noticed_and_averaged_out() {
    let dirty = DirtyRecord { chatter: 0.1, steady: 6, seed: 3, ..DirtyRecord::new(truth()) };
    let found = fitted(&dirty.generate());
    assert!(found.notes.iter().any(|note| matches!(note, Note::Chatter { ratio, .. } if *ratio > 3.0)));
    // Half of every branch carries a sine of 10 %: an RMS of 10 %/2.
    assert!((found.noise / 0.05 - 1.0).abs() < 0.2, "{}", found.noise);
    let dissipation = found.hysteresis_loop.dissipation() / truth().dissipation() - 1.0;
    assert!(dissipation.abs() < 0.01, "{dissipation}");
    let quiet = fitted(&DirtyRecord { force_noise: 0.1, ..DirtyRecord::new(truth()) }.generate());
    assert!(!quiet.notes.iter().any(|note| matches!(note, Note::Chatter { .. })), "{:?}", quiet.notes);
}

#[test]
fn backlash_and_asymmetry_are_noticed_where_they_are() {
    let gap = 3e-6;
    let backlash = synthetic::backlash_loop(8e-6, 12.0, 2e7, gap, 31).unwrap();
    let found = fitted(&DirtyRecord { force_noise: 0.01, ..DirtyRecord::new(backlash) }.generate());
    let width = found.notes.iter().find_map(|note| match note {
        Note::Backlash { width } => Some(*width),
        _ => None,
    });
    // Seen through 31 harmonics and a band of a tenth of the force's range.
    assert!((width.unwrap() / gap - 1.0).abs() < 0.2, "{width:?}");
    assert!(!found.notes.iter().any(|note| matches!(note, Note::Asymmetric { .. })));
    assert!(found.is_symmetric());

    let found = fitted(&DirtyRecord { force_noise: 0.01, ..DirtyRecord::new(truth()) }.generate());
    let asymmetric = |note: &Note| matches!(note, Note::Asymmetric { .. });
    assert!(found.notes.iter().any(asymmetric) && !found.is_symmetric());
    assert!(!found.notes.iter().any(|note| matches!(note, Note::Backlash { .. })), "{:?}", found.notes);
    assert!((found.even_content / truth().even_content() - 1.0).abs() < 0.05);
    assert!(found.hysteresis_loop.odd_part().even_content() == 0.0);
}

#[test]
fn minor_loops_of_the_displacement_are_reported() {
    let mut record = DirtyRecord::steady_only(truth(), 3, 0.0).generate();
    let amplitude = truth().displacement_amplitude();
    for (j, w) in record.displacement.iter_mut().enumerate() {
        *w += 0.1 * amplitude * (10.0 * PI * j as f64 / 256.0).sin();
    }
    let found = fitted(&record);
    assert!(
        found.notes.iter().any(|note| matches!(note, Note::InteriorReversals { .. })),
        "{:?}",
        found.notes
    );
}

#[test]
fn the_area_of_the_raw_curve_is_the_area_of_the_series() {
    for (cycles, start) in [(1, 0.0), (1, 0.4), (3, 0.1)] {
        let found = fitted(&DirtyRecord::steady_only(truth(), cycles, start).generate());
        // The trapezoid rule of 512 chords cuts crests by (2π/512)²/12 of the second derivative at most.
        let exact = truth().dissipation();
        assert!(
            (found.direct_dissipation / exact - 1.0).abs() < 1e-3,
            "{} {exact}",
            found.direct_dissipation
        );
    }
}

#[test]
fn the_same_settings_give_the_same_record_and_fit() {
    let dirty =
        DirtyRecord { force_noise: 0.02, jitter: 0.3, chatter: 0.1, seed: 9, ..DirtyRecord::new(truth()) };
    assert_eq!(dirty.generate(), dirty.generate());
    assert_eq!(fitted(&dirty.generate()), fitted(&dirty.generate()));
    assert_ne!(dirty.generate(), DirtyRecord { seed: 10, ..dirty.clone() }.generate());
}

#[test]
fn a_reference_loop_can_be_made_to_agree_with_a_law() {
    let law = Complex64::from_polar(12.0, 0.491_4 * PI);
    let agreeing = synthetic::with_harmonic(&truth(), 1, law).unwrap();
    assert!((agreeing.force_amplitude() - 12.0).abs() < 1e-14);
    assert!((agreeing.phase() - 0.491_4 * PI).abs() < 1e-15);
    assert!(synthetic::with_harmonic(&truth(), 1, -law).is_err());
}

#[test]
fn what_is_no_loop_is_refused_with_the_reason() {
    let good = DirtyRecord::steady_only(truth(), 2, 0.0).generate();
    let refused = |record: &Record| match fit(record, &FitSettings::default()) {
        Ok(found) => panic!("fitted: {:?} {:?}", found.hysteresis_loop, found.notes),
        Err(error) => error,
    };
    let with = |w: Vec<f64>, f: Vec<f64>| Record::new(None, w, f).unwrap();
    let count = good.len();

    let error = refused(&with(vec![1e-6], vec![1.0]));
    assert_eq!(error, FitError::TooFewSamples { found: 1, needed: 8 });
    assert!(refused(&with(vec![], vec![])).to_string().contains("0 samples"));

    let constant = refused(&with(good.displacement.clone(), vec![2.0; count]));
    assert!(constant.to_string().starts_with("the force is constant (2e0"), "{constant}");
    let constant = refused(&with(vec![0.0; count], good.force.clone()));
    assert!(constant.to_string().starts_with("the displacement is constant"), "{constant}");

    let mut holed = good.clone();
    holed.force[17] = f64::NAN;
    assert!(refused(&holed).to_string().starts_with("sample 18: the force"), "{}", refused(&holed));
    holed.force.pop();
    assert!(matches!(refused(&holed), FitError::Lengths { .. }));

    let reversed = refused(&with(good.displacement.clone(), good.force.iter().map(|f| -f).collect()));
    assert!(
        matches!(reversed, FitError::AgainstMotion { work } if (work / truth().dissipation() + 1.0).abs() < 1e-3)
    );
    assert!(reversed.to_string().contains("--flip-force"), "{reversed}");

    let spring =
        refused(&with(good.displacement.clone(), good.displacement.iter().map(|w| 1e6 * w).collect()));
    assert!(matches!(spring, FitError::NoArea { .. }), "{spring}");

    // Half a cycle, three quarters of one, and one whose force does not close.
    let cut = |samples: usize, start: f64| {
        let mut record = DirtyRecord::steady_only(truth(), 2, start).generate();
        record.time = None;
        record.displacement.truncate(samples);
        record.force.truncate(samples);
        record
    };
    for (samples, start) in [(256, 0.25), (200, 0.8), (384, 0.0), (384, 0.2), (450, 0.5), (300, 0.1)] {
        let error = refused(&cut(samples, start));
        assert!(matches!(error, FitError::OpenCurve { .. }), "{samples} {start} {error}");
    }
    let mut leaning = cut(512, 0.0);
    for (j, f) in leaning.force.iter_mut().enumerate() {
        *f += 0.02 * j as f64;
    }
    let open = refused(&leaning);
    assert!(open.to_string().contains("its ends differ by"), "{open}");

    let growing = DirtyRecord { run_up: 4, steady: 0, run_down: 4, ..DirtyRecord::new(truth()) };
    let error = refused(&growing.generate());
    assert!(matches!(error, FitError::NotSteady { .. }), "{error}");

    for settings in [
        FitSettings { max_harmonics: 0, ..FitSettings::default() },
        FitSettings { steady_tolerance: f64::NAN, ..FitSettings::default() },
        FitSettings { significance: -1.0, ..FitSettings::default() },
        FitSettings { closure_tolerance: 0.0, ..FitSettings::default() },
    ] {
        assert!(matches!(fit(&good, &settings), Err(FitError::Setting { .. })));
    }
}

#[test]
fn any_samples_at_all_give_a_fit_or_an_error() {
    use rand::{RngExt as _, SeedableRng};
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
    for round in 0..400 {
        let n = rng.random_range(0..60);
        // Few distinct values make plateaus, ties and repeated times.
        let mut column = |levels: i32| -> Vec<f64> {
            (0..n)
                .map(|_| f64::from(rng.random_range(-levels..=levels)) * 10.0_f64.powi(round % 20 - 10))
                .collect()
        };
        let (w, f) = (column(1 + round % 5), column(3));
        let mut time = column(20);
        time.sort_by(f64::total_cmp);
        if let Ok(found) = fit(&Record::new(Some(time), w, f).unwrap(), &FitSettings::default()) {
            assert!(found.hysteresis_loop.dissipation() > 0.0 && found.noise.is_finite());
        }
    }
}
