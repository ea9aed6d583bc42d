//! Motion of a smooth system: Gauss collocation with steps chosen by the decay of the Legendre coefficients of the
//! acceleration, and the derivative of every step.

use std::f64::consts::PI;

use faer::Mat;
use faer::linalg::solvers::{PartialPivLu, Solve};

use crate::collocation::{Row, STAGES, Tableau};
use crate::error::OrbitError;
use crate::path::{Path, Piece};
use crate::polynomial::TERMS;
use crate::scaled::{Scaled, add_product};
use crate::shooting::{Map, Passage};

/// Corrections of the accelerations in a step.
const MOST_CORRECTIONS: usize = 12;
/// First guess of the length of a step.
const FIRST: f64 = 0.1;
/// Steps below this phase are given up.
const SHORTEST: f64 = 1e-10;
/// Displacement in units of the quasi-static inertia response beyond which the motion counts as unbounded.
const BOUND: f64 = 1e9;

/// The period map of a smooth system; states are (y, y').
pub(crate) struct Smooth<'a> {
    system: &'a Scaled,
    tableau: Tableau,
    /// Relative error of a step.
    tolerance: f64,
    y: Vec<f64>,
    v: Vec<f64>,
    /// Entry `[stage][dof]`.
    acceleration: Vec<f64>,
}

/// What one attempt at a step gave.
struct Attempt {
    /// Relative size of the last Legendre coefficients.
    error: f64,
    /// (∂y''/∂y, ∂y''/∂y') at each node, with the opposite sign; entry `[stage][row][column]`.
    slopes: (Vec<f64>, Vec<f64>),
}

impl<'a> Smooth<'a> {
    pub(crate) fn new(system: &'a Scaled, tolerance: f64) -> Self {
        let n = system.dofs;
        Self {
            system,
            tableau: Tableau::new(),
            tolerance: tolerance.max(2e-15),
            y: vec![0.0; n],
            v: vec![0.0; n],
            acceleration: vec![0.0; STAGES * n],
        }
    }

    /// A passage with its record; returns the end state.
    pub(crate) fn record(
        &mut self,
        from: &[f64],
        until: f64,
    ) -> Result<(Path, Vec<f64>, Passage), OrbitError> {
        let mut path = Path::default();
        let passage = self.follow(from, until, None, Some(&mut path))?;
        Ok((path, self.y.iter().chain(&self.v).copied().collect(), passage))
    }

    fn follow(
        &mut self,
        from: &[f64],
        until: f64,
        mut derivative: Option<&mut Mat<f64>>,
        mut path: Option<&mut Path>,
    ) -> Result<Passage, OrbitError> {
        let n = self.system.dofs;
        let (y, v) = from.split_at(n.min(from.len()));
        self.y.copy_from_slice(y);
        self.v.copy_from_slice(v);
        if let Some(derivative) = derivative.as_deref_mut() {
            *derivative = Mat::identity(2 * n, 2 * n);
        }
        let mut peak = (size(&self.y), size(&self.v));
        let (mut tau, mut length, mut goal) = (0.0, 0.0, 0.0);
        while tau < until {
            if tau >= goal {
                // Every half period begins alike, so that both halves of a mirrored motion have the same steps.
                goal = if until > PI && goal < PI { PI } else { until };
                length = FIRST;
                self.acceleration.fill(0.0);
            }
            let step = length.min(goal - tau);
            let attempt = self.attempt(tau, step, &mut peak);
            let error = attempt.as_ref().map_or(f64::INFINITY, |attempt| attempt.error / self.tolerance);
            let ideal = step * (0.9 * error.powf(-1.0 / STAGES as f64)).clamp(0.25, 2.0);
            let Some(attempt) = attempt.filter(|_| error <= 1.0) else {
                length = ideal.min(0.8 * step);
                if length < SHORTEST {
                    return Err(match peak.0 > 1e6 {
                        true => OrbitError::Unbounded,
                        false => OrbitError::Stiff { time: tau / self.system.omega },
                    });
                }
                continue;
            };
            if let Some(derivative) = derivative.as_deref_mut() {
                self.differentiate(step, &attempt, derivative);
            }
            if let Some(path) = path.as_deref_mut() {
                path.pieces.push(self.piece(tau, step));
            }
            self.finish(step);
            let reached = size(&self.y);
            if reached.is_nan() || reached > BOUND {
                return Err(OrbitError::Unbounded);
            }
            // A last step cut short says nothing about the next.
            length = if step < length { length.max(ideal) } else { ideal };
            tau = if goal - tau <= step { goal } else { tau + step };
        }
        Ok(Passage { peak })
    }

    /// Accelerations that satisfy the equation of motion at all nodes of a step; `None` when they were not found.
    fn attempt(&mut self, tau: f64, h: f64, peak: &mut (f64, f64)) -> Option<Attempt> {
        let n = self.system.dofs;
        let mut lu: Option<PartialPivLu<f64>> = None;
        let mut last = f64::INFINITY;
        for _ in 0..MOST_CORRECTIONS {
            let (residual, slopes) = self.residual(tau, h, &mut (0.0, 0.0));
            let factors = match lu.take() {
                Some(factors) => factors,
                None => self.jacobian(h, &slopes).partial_piv_lu(),
            };
            let correction = factors.solve(&residual);
            let mut change = 0.0_f64;
            for (i, a) in self.acceleration.iter_mut().enumerate() {
                let by = correction[(i, 0)];
                *a -= by;
                change = change.max(by.abs());
            }
            let whole = size(&self.acceleration);
            if !change.is_finite() || !whole.is_finite() {
                self.acceleration.fill(0.0);
                return None;
            }
            // Rounding is reached when corrections cease to shrink.
            if change <= 1e-15 * whole || (change <= 1e-12 * whole && change >= 0.5 * last) || whole == 0.0 {
                let mut seen = *peak;
                let (_, slopes) = self.residual(tau, h, &mut seen);
                let error = self.error(n, h, seen);
                *peak = seen;
                return Some(Attempt { error, slopes });
            }
            // Slow convergence asks for a new derivative.
            if change <= 0.05 * last {
                lu = Some(factors);
            }
            last = change;
        }
        self.acceleration.fill(0.0);
        None
    }

    /// `a + M̃⁻¹(D̃ v + K̃ y + Σ β φ − load)` at the nodes, with its derivatives by y and v.
    fn residual(&self, tau: f64, h: f64, peak: &mut (f64, f64)) -> (Mat<f64>, (Vec<f64>, Vec<f64>)) {
        let (system, n) = (self.system, self.system.dofs);
        let mut out = Mat::zeros(STAGES * n, 1);
        let mut slopes = (Vec::with_capacity(STAGES * n * n), Vec::with_capacity(STAGES * n * n));
        let (mut y, mut v, mut rest) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let rows = self.tableau.nodes.iter().zip(&self.tableau.once).zip(&self.tableau.twice);
        for (stage, ((c, once), twice)) in rows.enumerate() {
            self.state(h, *c, once, twice, &mut y, &mut v);
            *peak = (peak.0.max(size(&y)), peak.1.max(size(&v)));
            rest.fill(0.0);
            system.add_load(tau + c * h, 0, -1.0, &mut rest);
            add_product(&system.stiffness_rate, &y, 1.0, &mut rest);
            add_product(&system.damping_rate, &v, 1.0, &mut rest);
            let first = slopes.0.len();
            slopes.0.extend_from_slice(&system.stiffness_rate);
            slopes.1.extend_from_slice(&system.damping_rate);
            for link in &system.links {
                let (force, by_y, by_v) = system.smooth(link, link.relative(&y), link.relative(&v));
                for (i, acceleration) in link.acceleration.iter().enumerate() {
                    if let Some(rest) = rest.get_mut(i) {
                        *rest += force * acceleration;
                    }
                    for &(j, beta) in &link.ends {
                        let entry = first + i * n + j;
                        if let (Some(k), Some(d)) = (slopes.0.get_mut(entry), slopes.1.get_mut(entry)) {
                            *k += acceleration * beta * by_y;
                            *d += acceleration * beta * by_v;
                        }
                    }
                }
            }
            let own = self.acceleration.iter().skip(stage * n);
            for (i, (rest, a)) in rest.iter().zip(own).enumerate() {
                out[(stage * n + i, 0)] = a + rest;
            }
        }
        (out, slopes)
    }

    /// y and v at a node.
    fn state(&self, h: f64, c: f64, once: &Row, twice: &Row, y: &mut [f64], v: &mut [f64]) {
        let n = self.system.dofs;
        for (i, ((y, v), (y0, v0))) in y.iter_mut().zip(v).zip(self.y.iter().zip(&self.v)).enumerate() {
            let a = self.acceleration.iter().skip(i).step_by(n);
            let (mut first, mut second) = (0.0, 0.0);
            for ((a, once), twice) in a.zip(once).zip(twice) {
                first += a * once;
                second += a * twice;
            }
            (*y, *v) = (y0 + h * c * v0 + h * h * second, v0 + h * first);
        }
    }

    /// The derivative of the residual by the accelerations.
    fn jacobian(&self, h: f64, slopes: &(Vec<f64>, Vec<f64>)) -> Mat<f64> {
        let n = self.system.dofs;
        let at = |values: &[f64], stage: usize, i: usize, j: usize| {
            values.get((stage * n + i) * n + j).copied().unwrap_or(0.0)
        };
        let entry = |table: &[Row; STAGES], i: usize, j: usize| {
            table.get(i).and_then(|row| row.get(j)).copied().unwrap_or(0.0)
        };
        Mat::from_fn(STAGES * n, STAGES * n, |row, column| {
            let ((p, i), (q, j)) = ((row / n, row % n), (column / n, column % n));
            let unit = if row == column { 1.0 } else { 0.0 };
            unit + h * entry(&self.tableau.once, p, q) * at(&slopes.1, p, i, j)
                + h * h * entry(&self.tableau.twice, p, q) * at(&slopes.0, p, i, j)
        })
    }

    /// Error of the step in velocity, relative to the motion's own.
    fn error(&self, n: usize, h: f64, peak: (f64, f64)) -> f64 {
        let tail = self.tableau.legendre.iter().skip(STAGES - 2);
        let worst = tail.flat_map(|row| {
            (0..n).map(move |i| {
                let a = self.acceleration.iter().skip(i).step_by(n);
                a.zip(row).map(|(a, coefficient)| a * coefficient).sum::<f64>().abs()
            })
        });
        h * worst.fold(0.0, f64::max) / peak.1.max(f64::MIN_POSITIVE)
    }

    /// Takes `derivative` over the step.
    fn differentiate(&self, h: f64, attempt: &Attempt, derivative: &mut Mat<f64>) {
        let n = self.system.dofs;
        let lu = self.jacobian(h, &attempt.slopes).partial_piv_lu();
        let slope = |values: &[f64], stage: usize, i: usize, j: usize| {
            values.get((stage * n + i) * n + j).copied().unwrap_or(0.0)
        };
        let old = derivative.clone();
        let node = |stage: usize| self.tableau.nodes.get(stage).copied().unwrap_or(0.0);
        let right = Mat::from_fn(STAGES * n, 2 * n, |row, column| {
            let (stage, i) = (row / n, row % n);
            let terms = (0..n).map(|j| {
                let (y, v) = (old[(j, column)], old[(n + j, column)]);
                slope(&attempt.slopes.0, stage, i, j) * (y + h * node(stage) * v)
                    + slope(&attempt.slopes.1, stage, i, j) * v
            });
            -terms.sum::<f64>()
        });
        let accelerations = lu.solve(&right);
        for column in 0..2 * n {
            for i in 0..n {
                let (mut y, mut v) = (old[(i, column)] + h * old[(n + i, column)], old[(n + i, column)]);
                for (stage, (c, w)) in self.tableau.nodes.iter().zip(&self.tableau.weights).enumerate() {
                    let a = accelerations[(stage * n + i, column)];
                    y += h * h * w * (1.0 - c) * a;
                    v += h * w * a;
                }
                (derivative[(i, column)], derivative[(n + i, column)]) = (y, v);
            }
        }
    }

    /// The end of the step, and a guess of the next step's accelerations: the last one.
    fn finish(&mut self, h: f64) {
        let n = self.system.dofs;
        for (i, (y, v)) in self.y.iter_mut().zip(&mut self.v).enumerate() {
            let (mut first, mut second) = (0.0, 0.0);
            let a = self.acceleration.iter().skip(i).step_by(n);
            for ((a, c), w) in a.zip(&self.tableau.nodes).zip(&self.tableau.weights) {
                first += w * a;
                second += w * (1.0 - c) * a;
            }
            (*y, *v) = (*y + h * *v + h * h * second, *v + h * first);
        }
        let Some(end) = self.acceleration.get((STAGES - 1) * n..).map(<[f64]>::to_vec) else { return };
        self.acceleration.chunks_exact_mut(n).for_each(|row| row.copy_from_slice(&end));
    }

    /// The step as polynomials: accelerations to Legendre coefficients, to powers, integrated twice.
    fn piece(&self, start: f64, h: f64) -> Piece {
        let n = self.system.dofs;
        let mut coefficients = vec![0.0; TERMS * n];
        for (i, (y, v)) in self.y.iter().zip(&self.v).enumerate() {
            let mut set = |j: usize, x: f64| {
                if let Some(slot) = coefficients.get_mut(j * n + i) {
                    *slot += x;
                }
            };
            set(0, *y);
            set(1, h * v);
            for (row, powers) in self.tableau.legendre.iter().zip(&self.tableau.powers) {
                let a = self.acceleration.iter().skip(i).step_by(n);
                let coefficient: f64 = a.zip(row).map(|(a, factor)| a * factor).sum();
                for (j, power) in powers.iter().enumerate() {
                    set(j + 2, h * h * coefficient * power / ((j + 1) * (j + 2)) as f64);
                }
            }
        }
        Piece { start, length: h, coefficients, elastic: Vec::new(), turning: Vec::new() }
    }
}

fn size(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |top: f64, x| if top.is_nan() || x.is_nan() { f64::NAN } else { top.max(x.abs()) })
}

impl Map for Smooth<'_> {
    fn pass(
        &mut self,
        from: &[f64],
        until: f64,
        end: &mut Vec<f64>,
        derivative: Option<&mut Mat<f64>>,
    ) -> Result<Passage, OrbitError> {
        let passage = self.follow(from, until, derivative, None)?;
        end.clear();
        end.extend(self.y.iter().chain(&self.v));
        Ok(passage)
    }

    fn weights(&self, passage: Passage, weights: &mut Vec<f64>) {
        let relative = |size: f64| if size > 0.0 { 1.0 / size } else { 1.0 };
        weights.clear();
        weights.extend(std::iter::repeat_n(relative(passage.peak.0), self.system.dofs));
        weights.extend(std::iter::repeat_n(relative(passage.peak.1), self.system.dofs));
    }

    fn admit(&self, _state: &mut [f64]) {}
}
