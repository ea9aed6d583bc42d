//! scratch
use contact::{Coulomb, CoulombParameters};
use faer::{Mat, mat};
use hbm::*;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::sync::Arc;
use stickslip_tests::*;

#[test]
fn explore() {
    for n in [1usize, 3, 5, 7, 15, 31] {
        let mut settings = Settings::new(n);
        settings.stability = true;
        settings.all_solutions = true;
        let plan = Plan::new(&scene_p_cubic(), &settings).unwrap();
        for hertz in [10.0, 30.0, 43.24, 60.0, 108.0] {
            let t = std::time::Instant::now();
            let s = plan.solve(hertz, &mut plan.workspace());
            let dt = t.elapsed();
            for s in std::iter::once(&s).chain(&s.others) {
                let st = s.stability.as_ref().unwrap();
                println!("{n} {hertz} {:?} {:?} err {:.2e} {:?}", st.verdict, st.multipliers, st.error, dt);
            }
        }
    }
}
