//! What a solution is compared with: the spectra of a periodic motion that is known better.

use hbm::{Plan, Solution};
use num_complex::Complex64;

/// Displacement spectra of the output dofs at one frequency, and how well they are known.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// In Hz.
    pub frequency: f64,
    /// `W_0 … W_K` in m, one-sided; one row per output dof.
    pub spectra: Vec<Vec<Complex64>>,
    /// Relative l2 error of the spectra themselves, estimated; smaller errors than this cannot be measured.
    pub accuracy: f64,
}

impl Reference {
    /// The motion of a solved point; `None` when it is not solved. `accuracy` is its own relative error.
    pub fn of_solution(plan: &Plan, solution: &Solution, accuracy: f64) -> Option<Self> {
        if !solution.status.solved() {
            return None;
        }
        let orders = plan.orders();
        let length = orders.last().map_or(0, |last| last + 1);
        let spread = |row: &Vec<Complex64>| {
            let mut spectrum = vec![Complex64::ZERO; length];
            for (&k, &w) in orders.iter().zip(row) {
                if let Some(place) = spectrum.get_mut(k) {
                    *place = w;
                }
            }
            spectrum
        };
        let spectra = solution.displacement.iter().map(spread).collect();
        Some(Self { frequency: solution.frequency, spectra, accuracy })
    }

    /// `√(Σ_k |W_k − R_k|² / Σ_k |R_k|²)` of a solution, the worst of its output dofs; infinite when it failed.
    pub fn error(&self, plan: &Plan, solution: &Solution) -> f64 {
        if !solution.status.solved() {
            return f64::INFINITY;
        }
        let spectra: Vec<Spectrum> = solution
            .displacement
            .iter()
            .map(|row| Spectrum { orders: plan.orders(), amplitudes: row.as_slice() })
            .collect();
        self.distance(&spectra)
    }

    /// The same for spectra from anywhere, one per output dof.
    pub fn distance(&self, spectra: &[Spectrum<'_>]) -> f64 {
        let rows = self.spectra.iter().zip(spectra);
        rows.map(|(reference, spectrum)| spectrum.distance(reference)).fold(0.0, f64::max)
    }
}

/// A spectrum of which only some harmonics are listed; the others are zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum<'a> {
    /// Harmonics of Ω, ascending.
    pub orders: &'a [usize],
    /// One-sided amplitudes, one an order.
    pub amplitudes: &'a [Complex64],
}

impl Spectrum<'_> {
    fn distance(&self, reference: &[Complex64]) -> f64 {
        let known = |k: usize| reference.get(k).copied().unwrap_or_default();
        let listed = || self.orders.iter().zip(self.amplitudes);
        let difference: f64 = listed().map(|(&k, w)| (w - known(k)).norm_sqr()).sum();
        let left_out = |k: &usize| self.orders.binary_search(k).is_err();
        let rest: f64 = (0..reference.len()).filter(left_out).map(|k| known(k).norm_sqr()).sum();
        let size: f64 = reference.iter().map(Complex64::norm_sqr).sum();
        let square = difference + rest;
        if size > 0.0 {
            (square / size).sqrt()
        } else if square > 0.0 {
            f64::INFINITY
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn harmonics_that_are_not_listed_count_as_zero() {
        let one = Complex64::new(3.0, 4.0);
        let reference = Reference {
            frequency: 1.0,
            spectra: vec![vec![Complex64::ZERO, one, Complex64::ZERO, Complex64::new(0.0, 0.5)]],
            accuracy: 0.0,
        };
        let spectrum = Spectrum { orders: &[1], amplitudes: &[one] };
        let expected = 0.5 / (25.25_f64).sqrt();
        assert!((reference.distance(&[spectrum]) - expected).abs() < 1e-15);
        // A harmonic beyond those of the reference is an error too.
        let more = Spectrum { orders: &[1, 3, 9], amplitudes: &[one, Complex64::new(0.0, 0.5), one] };
        assert!((reference.distance(&[more]) - 5.0 / (25.25_f64).sqrt()).abs() < 1e-15);
    }
}
