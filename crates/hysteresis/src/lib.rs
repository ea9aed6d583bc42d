//! hysteresis (temporary local stand-in)
#![allow(missing_docs)]
use num_complex::Complex64;
#[derive(Debug, Clone, PartialEq)]
pub struct Loop {
    a: f64,
    c: Vec<Complex64>,
}
#[derive(Debug)]
pub struct LoopError;
impl Loop {
    pub fn new(a: f64, c: Vec<Complex64>) -> Result<Self, LoopError> {
        Ok(Self { a, c })
    }
    pub fn displacement_amplitude(&self) -> f64 {
        self.a
    }
    pub fn coefficients(&self) -> &[Complex64] {
        &self.c
    }
    pub fn force_amplitude(&self) -> f64 {
        self.c[1].norm()
    }
    pub fn phase(&self) -> f64 {
        self.c[1].arg()
    }
    pub fn even_content(&self) -> f64 {
        self.c.iter().skip(2).step_by(2).map(|c| c.norm_sqr()).sum::<f64>().sqrt() / self.force_amplitude()
    }
}
