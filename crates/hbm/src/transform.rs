//! Between harmonics and samples of one period: realfft plans made once, called without allocating.

use std::sync::Arc;

use num_complex::Complex64;
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

/// Transforms of M real samples over one period.
#[derive(Clone)]
pub(crate) struct Transform {
    samples: usize,
    forward: Arc<dyn RealToComplex<f64>>,
    inverse: Arc<dyn ComplexToReal<f64>>,
}

/// Buffers of a transform for one thread.
#[derive(Debug, Clone)]
pub(crate) struct Buffers {
    bins: Vec<Complex64>,
    time: Vec<f64>,
    scratch: Vec<Complex64>,
}

impl Transform {
    pub(crate) fn new(samples: usize) -> Self {
        let mut planner = RealFftPlanner::new();
        Self {
            samples,
            forward: planner.plan_fft_forward(samples),
            inverse: planner.plan_fft_inverse(samples),
        }
    }

    pub(crate) fn samples(&self) -> usize {
        self.samples
    }

    pub(crate) fn buffers(&self) -> Buffers {
        let scratch = self.forward.get_scratch_len().max(self.inverse.get_scratch_len());
        Buffers {
            bins: vec![Complex64::ZERO; self.samples / 2 + 1],
            time: vec![0.0; self.samples],
            scratch: vec![Complex64::ZERO; scratch],
        }
    }

    /// Samples of `Re Σ_k a_k e^{ikτ}` at τ_j = 2πj/M, with amplitudes `a_0, a_1, …` (at most M/2 of them).
    pub(crate) fn to_time(
        &self,
        amplitudes: impl Iterator<Item = Complex64>,
        samples: &mut [f64],
        buffers: &mut Buffers,
    ) {
        buffers.bins.fill(Complex64::ZERO);
        for (k, (bin, amplitude)) in buffers.bins.iter_mut().zip(amplitudes).enumerate() {
            *bin = if k == 0 { Complex64::from(amplitude.re) } else { 0.5 * amplitude };
        }
        if let Some(last) = buffers.bins.last_mut() {
            last.im = 0.0;
        }
        // Lengths match by construction, the only way this can fail.
        let _ = self.inverse.process_with_scratch(&mut buffers.bins, samples, &mut buffers.scratch);
    }

    /// Two-sided Fourier coefficients `(1/M) Σ_j x_j e^{−iqτ_j}` for q = 0 … M/2, in `buffers`.
    pub(crate) fn to_coefficients<'b>(&self, samples: &[f64], buffers: &'b mut Buffers) -> &'b [Complex64] {
        buffers.time.copy_from_slice(samples);
        let _ = self.forward.process_with_scratch(&mut buffers.time, &mut buffers.bins, &mut buffers.scratch);
        let scale = 1.0 / self.samples as f64;
        for bin in &mut buffers.bins {
            *bin *= scale;
        }
        &buffers.bins
    }
}

impl std::fmt::Debug for Transform {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Transform({})", self.samples)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn agrees_with_the_definition() {
        let amplitudes =
            [Complex64::new(0.3, 0.0), Complex64::new(1.0, -2.0), Complex64::ZERO, Complex64::new(0.1, 0.7)];
        let transform = Transform::new(16);
        let mut buffers = transform.buffers();
        let mut samples = vec![0.0; 16];
        transform.to_time(amplitudes.iter().copied(), &mut samples, &mut buffers);
        for (j, x) in samples.iter().enumerate() {
            let tau = TAU * j as f64 / 16.0;
            let expected: f64 =
                amplitudes.iter().enumerate().map(|(k, a)| (a * Complex64::cis(k as f64 * tau)).re).sum();
            assert!((x - expected).abs() < 1e-15 * 10.0);
        }
        let back = transform.to_coefficients(&samples, &mut buffers);
        assert!((back[0] - amplitudes[0]).norm() < 1e-15);
        for (k, coefficient) in back.iter().enumerate().skip(1) {
            let expected = amplitudes.get(k).copied().unwrap_or_default() * 0.5;
            assert!((coefficient - expected).norm() < 1e-15);
        }
    }
}
