//! A periodic function given by its harmonics: values and range.

use std::f64::consts::TAU;

use contact::{Motion, TurningPoints};
use num_complex::Complex64;

/// `W_0 … W_N` from amplitudes at some harmonics.
pub(crate) fn dense(orders: &[usize], amplitudes: &[Complex64]) -> Vec<Complex64> {
    let present = || orders.iter().copied().zip(amplitudes.iter().copied());
    let highest = present().map(|(order, _)| order).max().unwrap_or(0);
    let mut spectrum = vec![Complex64::ZERO; highest + 1];
    for (order, amplitude) in present() {
        if let Some(entry) = spectrum.get_mut(order) {
            *entry = amplitude;
        }
    }
    spectrum
}

/// `(w, dw/dτ)` at `count` instants of a period, the first at τ = 0.
pub(crate) fn samples(spectrum: &[Complex64], count: usize) -> (Vec<f64>, Vec<f64>) {
    let at = |j: usize| {
        let step = Complex64::cis(TAU * j as f64 / count as f64);
        let start = (Complex64::ONE, 0.0, 0.0, 0.0);
        let (_, _, w, v) = spectrum.iter().fold(start, |(wave, k, w, v), amplitude| {
            let term = amplitude * wave;
            (wave * step, k + 1.0, w + term.re, v - k * term.im)
        });
        (w, v)
    };
    (0..count).map(at).unzip()
}

/// Half the peak-to-peak range, exact to rounding.
pub(crate) fn half_range(spectrum: &[Complex64]) -> f64 {
    let count = (8 * spectrum.len()).next_power_of_two().max(64);
    let (displacement, velocity) = samples(spectrum, count);
    let mut points = TurningPoints::default();
    let motion =
        Motion { spectrum, displacement: &displacement, velocity: &velocity, odd: false, omega: 1.0 };
    match points.find(&motion) {
        Ok(()) => points.amplitude(),
        Err(_) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_exact() {
        let re = |value: f64| Complex64::new(value, 0.0);
        assert_eq!(half_range(&[re(5.0)]), 0.0);
        assert!((half_range(&[re(5.0), Complex64::from_polar(2.0, 0.3)]) - 2.0).abs() < 1e-14);
        // cos τ + ½ cos 2τ: 3/2 at τ = 0, −¾ where cos τ = −½.
        assert!((half_range(&[re(0.0), re(1.0), re(0.5)]) - 1.125).abs() < 1e-14);
    }

    #[test]
    fn harmonics_find_their_place() {
        let one = Complex64::ONE;
        assert_eq!(dense(&[1, 3], &[one, 2.0 * one]), [0.0 * one, one, 0.0 * one, 2.0 * one]);
        // Amplitudes end where a solution has fewer harmonics than the plan.
        assert_eq!(dense(&[1, 3], &[one]), [0.0 * one, one]);
    }
}
