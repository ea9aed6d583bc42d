use contact::*;
use faer::mat;
use hbm::*;
use num_complex::Complex64;
use std::sync::Arc;

fn problem_r() -> Problem {
    Problem {
        model: Model::new(
            mat![[3.98, 0.0], [0.0, 1.27]],
            Damping::Matrix(mat![[24.0, 0.0], [0.0, 24.0]]),
            mat![[8.2e5, -4.1e5], [-4.1e5, 4.1e5]],
        )
        .unwrap(),
        excitation: vec![Excitation {
            dof: 1,
            harmonic: 1,
            amplitude: 9.1,
            phase: 0.0,
            kind: ExcitationKind::Force,
        }],
        contacts: vec![Contact {
            name: "root".into(),
            first: 0,
            second: None,
            law: Arc::new(
                ElasticCoulomb::new(ElasticCoulombParameters {
                    stiffness: 6.705e6,
                    slip_force: 6.705e6 * 2.232e-6,
                })
                .unwrap(),
            ),
            scale: 1.0,
        }],
        output: vec![0, 1],
    }
}

#[test]
fn scene_r() {
    let exact = [
        (57.0, 2.774688183e-6),
        (62.0, 2.943539707e-6),
        (75.0, 1.988362982e-5),
        (100.0, 2.388795768e-5),
        (108.0, 2.781522903e-5),
        (112.0, 5.219603747e-6),
    ];
    for n in [1, 3, 7, 15, 31] {
        let mut settings = Settings::new(n);
        settings.samples = Some(4096);
        let plan = Plan::new(&problem_r(), &settings).unwrap();
        let mut ws = plan.workspace();
        for (hz, w) in exact {
            let s = plan.solve(hz, &mut ws);
            println!(
                "N={n} {hz} {:?} res {:.1e} rel {:.3e} stats {:?} tp {:?}",
                s.status,
                s.residual,
                s.displacement.first().map_or(f64::NAN, |d| d[0].norm() / w - 1.0),
                s.stats,
                s.contacts.first().map(|c| (c.turning_points, c.state))
            );
        }
    }
}

#[test]
fn loop_scene() {
    let phase = PhaseLaw::default();
    let first = Complex64::from_polar(12.0, std::f64::consts::PI + phase.value(1.0));
    let z = Complex64::ZERO;
    let l = hysteresis::Loop::new(
        8e-6,
        vec![z, first, z, Complex64::new(0.6, 2.3), z, Complex64::new(0.3, 0.8), z, Complex64::new(0.1, 0.3)],
    )
    .unwrap();
    let mut p = problem_r();
    p.contacts[0].law =
        Arc::new(ScaledLoop::new(&l, 0.0, MagnitudeLaw::default(), phase, Symmetry::Auto).unwrap());
    for n in [1, 3, 7, 15, 31] {
        let plan = Plan::new(&p, &Settings::new(n)).unwrap();
        let freqs: Vec<f64> = (15..=200).map(|f| f as f64).collect();
        let t = std::time::Instant::now();
        let sw = sweep(&plan, &freqs, &SweepOptions { threads: Some(1), ..Default::default() });
        let dt = t.elapsed();
        let failed: Vec<_> =
            sw.solutions.iter().filter(|s| !s.status.solved()).map(|s| s.frequency).collect();
        let it: usize = sw.solutions.iter().map(|s| s.stats.iterations).sum();
        println!(
            "N={n} failed {failed:?} iterations {it} {:?}/pt; fallback {:?}",
            dt / 186,
            sw.solutions
                .iter()
                .filter(|s| s.stats.contact_homotopies + s.stats.extra_rungs > 0)
                .map(|s| s.frequency)
                .collect::<Vec<_>>()
        );
        let s = &sw.solutions[40];
        println!("   55 Hz alpha {}", s.displacement[0][0].norm() / 8e-6);
    }
}
