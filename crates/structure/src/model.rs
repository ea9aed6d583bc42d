//! The linear structure: mass, damping and stiffness.

use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par, Side};

use crate::error::ModelError;

/// How damping is given.
#[derive(Debug, Clone, PartialEq)]
pub enum Damping {
    /// D itself, any square matrix, in N s/m.
    Matrix(Mat<f64>),
    /// D = mass · M + stiffness · C.
    Rayleigh {
        /// Factor on M in 1/s.
        mass: f64,
        /// Factor on C in s.
        stiffness: f64,
    },
    /// The same ratio of critical damping in every mode of (M, C).
    ModalRatio(f64),
}

/// A linear structure with n dofs.
#[derive(Debug, Clone)]
pub struct Model {
    mass: Mat<f64>,
    damping: Mat<f64>,
    stiffness: Mat<f64>,
    base_loads: Vec<Vec<f64>>,
}

/// Relative asymmetry that is taken for rounding in a file.
const SYMMETRY: f64 = 1e-9;

/// Eigenvalue of the mass, relative to the largest, below which it counts as zero.
const MASSLESS: f64 = 1e-13;

impl Model {
    /// Checks the matrices: n × n, finite, mass and stiffness symmetric, mass positive semidefinite.
    ///
    /// # Errors
    /// [`ModelError`] naming the matrix and the entry.
    pub fn new(mass: Mat<f64>, damping: Damping, stiffness: Mat<f64>) -> Result<Self, ModelError> {
        let n = mass.nrows();
        if n == 0 {
            return Err(ModelError::new("mass", "is empty"));
        }
        let mass = symmetric("mass", check("mass", mass, n)?)?;
        let stiffness = symmetric("stiffness", check("stiffness", stiffness, n)?)?;
        semidefinite(&mass)?;
        let damping = match damping {
            Damping::Matrix(damping) => check("damping", damping, n)?,
            Damping::Rayleigh { mass: a, stiffness: b } => {
                check("damping", Mat::from_fn(n, n, |i, j| a * mass[(i, j)] + b * stiffness[(i, j)]), n)?
            }
            Damping::ModalRatio(ratio) => modal_damping(&mass, &stiffness, ratio)?,
        };
        let base_load = (0..n).map(|i| (0..n).map(|j| mass[(i, j)]).sum()).collect();
        Ok(Self { mass, damping, stiffness, base_loads: vec![base_load] })
    }

    /// The same structure with other base motions: for each of them M r in kg, where r is the displacement of every dof
    /// that goes with a unit displacement of the base. A base acceleration a acts as −M r a. Without this there is one:
    /// every dof moves with the base, r = 1.
    ///
    /// # Errors
    /// A vector that has not one finite number a dof.
    pub fn with_base_loads(mut self, base_loads: Vec<Vec<f64>>) -> Result<Self, ModelError> {
        let n = self.dofs();
        if base_loads.iter().any(|load| load.len() != n || load.iter().any(|x| !x.is_finite())) {
            return Err(ModelError::new("mass", format!("base loads must have {n} finite numbers")));
        }
        self.base_loads = base_loads;
        Ok(self)
    }

    /// M r in kg of every base motion.
    pub fn base_loads(&self) -> &[Vec<f64>] {
        &self.base_loads
    }

    /// M in kg.
    pub fn mass(&self) -> &Mat<f64> {
        &self.mass
    }

    /// D in N s/m, however it was given.
    pub fn damping(&self) -> &Mat<f64> {
        &self.damping
    }

    /// C in N/m.
    pub fn stiffness(&self) -> &Mat<f64> {
        &self.stiffness
    }

    /// Number of dofs n.
    pub fn dofs(&self) -> usize {
        self.mass.nrows()
    }

    /// Natural frequencies of the structure without contacts and damping in Hz, ascending. Massless dofs have none;
    /// an unstable direction (negative stiffness) is left out. Empty when neither mass nor stiffness is positive
    /// definite.
    pub fn natural_frequencies(&self) -> Vec<f64> {
        let Some(modes) = Modes::of(&self.mass, &self.stiffness) else { return Vec::new() };
        let mut frequencies: Vec<f64> = modes
            .squares
            .iter()
            .filter(|square| square.is_finite() && **square >= 0.0)
            .map(|square| square.sqrt() / std::f64::consts::TAU)
            .collect();
        frequencies.sort_by(f64::total_cmp);
        frequencies
    }

    /// Natural frequencies in Hz of the structure with `springs` added, each with its half-power bandwidth
    /// φᵀ D φ/(2π φᵀ M φ) in Hz. A spring of so many N/m resists the displacement Σ coefficient · dof.
    pub fn modes_with(&self, springs: &[(Vec<(usize, f64)>, f64)]) -> Vec<(f64, f64)> {
        let mut stiffness = self.stiffness.clone();
        for (parts, k) in springs {
            for &(row, by_row) in parts {
                for &(column, by_column) in parts {
                    stiffness[(row, column)] += by_row * by_column * k;
                }
            }
        }
        let Some(modes) = Modes::of(&self.mass, &stiffness) else { return Vec::new() };
        let damping = modes.shapes.transpose() * &self.damping * &modes.shapes;
        let of = |(r, square): (usize, &f64)| {
            let hertz = square.sqrt() / std::f64::consts::TAU;
            hertz.is_finite().then(|| (hertz, damping[(r, r)].abs() / std::f64::consts::TAU))
        };
        modes.squares.iter().enumerate().filter_map(of).collect()
    }
}

impl ModelError {
    pub(crate) fn new(matrix: &'static str, problem: impl Into<String>) -> Self {
        Self { matrix, problem: problem.into() }
    }
}

fn check(name: &'static str, matrix: Mat<f64>, n: usize) -> Result<Mat<f64>, ModelError> {
    if matrix.nrows() != n || matrix.ncols() != n {
        let size = format!("{} x {}", matrix.nrows(), matrix.ncols());
        return Err(ModelError::new(name, format!("must be {n} x {n} as the mass has {n} rows, got {size}")));
    }
    for j in 0..n {
        for i in 0..n {
            if !matrix[(i, j)].is_finite() {
                return Err(ModelError::new(name, format!("entry [{i}][{j}] is not a finite number")));
            }
        }
    }
    Ok(matrix)
}

/// Checks symmetry up to rounding, and makes it exact.
fn symmetric(name: &'static str, matrix: Mat<f64>) -> Result<Mat<f64>, ModelError> {
    let n = matrix.nrows();
    for j in 0..n {
        for i in 0..j {
            let (upper, lower) = (matrix[(i, j)], matrix[(j, i)]);
            // Against the diagonal, so that a model with masses of very different size is judged fairly.
            let size =
                upper.abs().max(lower.abs()).max((matrix[(i, i)] * matrix[(j, j)]).abs().sqrt() * 1e-3);
            if (upper - lower).abs() > SYMMETRY * size {
                return Err(ModelError::new(
                    name,
                    format!(
                        "must be symmetric, but entry [{i}][{j}] is {upper} and entry [{j}][{i}] is {lower}"
                    ),
                ));
            }
        }
    }
    Ok(Mat::from_fn(n, n, |i, j| 0.5 * (matrix[(i, j)] + matrix[(j, i)])))
}

/// D^{-1/2} A D^{-1/2} with D the magnitudes of the diagonal: masses and stiffnesses of very different size become
/// comparable, and definiteness does not change.
fn balanced(matrix: &Mat<f64>) -> Mat<f64> {
    let scale = |i: usize| match matrix[(i, i)].abs().sqrt() {
        0.0 => 1.0,
        root => root,
    };
    Mat::from_fn(matrix.nrows(), matrix.ncols(), |i, j| matrix[(i, j)] / (scale(i) * scale(j)))
}

fn semidefinite(mass: &Mat<f64>) -> Result<(), ModelError> {
    let values = balanced(mass)
        .self_adjoint_eigenvalues(Side::Lower)
        .map_err(|_| ModelError::new("mass", "its eigenvalues could not be computed"))?;
    let largest = values.iter().fold(0.0_f64, |top, v| top.max(v.abs()));
    let smallest = values.iter().copied().fold(f64::INFINITY, f64::min);
    if largest == 0.0 {
        return Err(ModelError::new("mass", "is zero; at least one dof needs a mass"));
    }
    if smallest < -MASSLESS * largest * mass.nrows() as f64 {
        return Err(ModelError::new(
            "mass",
            "must be positive semidefinite, but has a negative eigenvalue (a motion with negative kinetic energy)",
        ));
    }
    Ok(())
}

/// Undamped modes: squares of the angular frequencies (infinite where massless) and the matrix that modal damping
/// needs.
struct Modes {
    squares: Vec<f64>,
    /// One column a mode, φᵀ M φ = 1; zero for massless directions.
    shapes: Mat<f64>,
    /// Σ over modes of 2 ω (M φ)(M φ)ᵀ with φᵀ M φ = 1: damping of unit ratio.
    unit_damping: Mat<f64>,
}

impl Modes {
    /// From whichever of mass and stiffness is positive definite.
    fn of(mass: &Mat<f64>, stiffness: &Mat<f64>) -> Option<Self> {
        let n = mass.nrows();
        if let Some((values, vectors)) = generalised(stiffness, mass) {
            // C φ = ω² M φ with φᵀ M φ = 1.
            let omega: Vec<f64> = values.iter().map(|v| v.max(0.0).sqrt()).collect();
            let momenta = mass * &vectors;
            let weight = |r: usize| 2.0 * omega.get(r).copied().unwrap_or(0.0);
            let unit_damping = weighted_square(&momenta, weight);
            return Some(Self { squares: values, shapes: vectors, unit_damping });
        }
        // M φ = μ C φ with φᵀ C φ = 1 and μ = 1/ω²: massless directions have μ = 0. M-normalised φ' = φ/√μ = ω φ.
        let (values, vectors) = generalised(mass, stiffness)?;
        let largest = values.iter().copied().fold(0.0_f64, f64::max);
        let massless = move |mu: f64| mu <= MASSLESS * largest;
        let momenta = mass * &vectors;
        let weight = |r: usize| match values.get(r) {
            Some(&mu) if !massless(mu) => 2.0 * mu.powf(-1.5),
            _ => 0.0,
        };
        let unit_damping = weighted_square(&momenta, weight);
        let squares = values.iter().map(|&mu| if massless(mu) { f64::INFINITY } else { 1.0 / mu }).collect();
        let norm = |r: usize| values.get(r).filter(|mu| !massless(**mu)).map_or(0.0, |mu| mu.powf(-0.5));
        let shapes = Mat::from_fn(n, vectors.ncols(), |i, r| vectors[(i, r)] * norm(r));
        Some(Self { squares, shapes, unit_damping })
    }
}

/// Σ of weight(r) x_r x_rᵀ over the columns x_r.
fn weighted_square(columns: &Mat<f64>, weight: impl Fn(usize) -> f64) -> Mat<f64> {
    let weighted = Mat::from_fn(columns.nrows(), columns.ncols(), |i, r| weight(r) * columns[(i, r)]);
    let mut square = Mat::zeros(columns.nrows(), columns.nrows());
    matmul(square.as_mut(), Accum::Replace, weighted.as_ref(), columns.transpose(), 1.0, Par::Seq);
    square
}

/// A φ = λ B φ with φᵀ B φ = 1, through the Cholesky factor of B; `None` when B is not positive definite.
fn generalised(a: &Mat<f64>, b: &Mat<f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    let n = a.nrows();
    // Only a matrix that is definite after balancing counts: the factor of an indefinite one is noise.
    let values = balanced(b).self_adjoint_eigenvalues(Side::Lower).ok()?;
    if values.iter().any(|v| *v <= MASSLESS * n as f64) {
        return None;
    }
    let factor = b.llt(Side::Lower).ok()?;
    let lower = factor.L();
    let solve = |rhs: &mut Mat<f64>| {
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(lower, rhs.as_mut(), faer::Par::Seq);
    };
    let mut half = a.clone();
    solve(&mut half);
    let mut reduced = half.transpose().to_owned();
    solve(&mut reduced);
    // Of a matrix far from one in size, faer's decomposition with vectors loses most digits of the small eigenvalues.
    let size = reduced.norm_max().max(f64::MIN_POSITIVE);
    let scaled = Mat::from_fn(n, n, |i, j| reduced[(i, j)] / size);
    let eigen = scaled.self_adjoint_eigen(Side::Lower).ok()?;
    let values = eigen.S().column_vector().iter().map(|value| value * size).collect();
    let mut vectors = eigen.U().to_owned();
    let upper: MatRef<'_, f64> = lower.transpose();
    faer::linalg::triangular_solve::solve_upper_triangular_in_place(upper, vectors.as_mut(), faer::Par::Seq);
    Some((values, vectors))
}

fn modal_damping(mass: &Mat<f64>, stiffness: &Mat<f64>, ratio: f64) -> Result<Mat<f64>, ModelError> {
    if !ratio.is_finite() || ratio < 0.0 {
        return Err(ModelError::new("damping.modal_ratio", format!("must not be negative, got {ratio}")));
    }
    let modes = Modes::of(mass, stiffness).ok_or_else(|| {
        ModelError::new(
            "damping.modal_ratio",
            "needs modes, but neither mass nor stiffness is positive definite; give a damping matrix instead",
        )
    })?;
    if modes.squares.iter().any(|square| *square < 0.0) {
        return Err(ModelError::new(
            "stiffness",
            "has a negative eigenvalue, so modes are unstable; give a damping matrix",
        ));
    }
    let n = mass.nrows();
    Ok(Mat::from_fn(n, n, |i, j| ratio * modes.unit_damping[(i, j)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use faer::mat;

    fn chain() -> (Mat<f64>, Mat<f64>) {
        (mat![[2.0, 0.0], [0.0, 1.0]], mat![[300.0, -100.0], [-100.0, 100.0]])
    }

    #[test]
    fn natural_frequencies_solve_the_characteristic_equation() {
        let (m, c) = chain();
        let model = Model::new(m, Damping::Matrix(Mat::zeros(2, 2)), c).unwrap();
        for hz in model.natural_frequencies() {
            let square = (hz * std::f64::consts::TAU).powi(2);
            let determinant = (300.0 - 2.0 * square) * (100.0 - square) - 1e4;
            assert!(determinant.abs() < 1e-9 * 3e4, "{hz}: {determinant}");
        }
        assert_eq!(model.natural_frequencies().len(), 2);
    }

    #[test]
    fn frequencies_of_a_long_chain_are_exact_whatever_its_units() {
        // Ground, springs k, n masses m: ω = 2 √(k/m) sin((2j − 1)π/(4n + 2)).
        let n = 150;
        for (m, k) in [(1e-3, 1e11), (1.0, 1.0), (1e6, 1e-3)] {
            let stiffness = Mat::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 if i + 1 == n => k,
                0 => 2.0 * k,
                1 => -k,
                _ => 0.0,
            });
            for massless in [false, true] {
                // A massless dof at the end, on a spring of its own, changes nothing but takes the other way.
                let size = n + usize::from(massless);
                let mass = Mat::from_fn(size, size, |i, j| if i == j && i < n { m } else { 0.0 });
                let stiffness = Mat::from_fn(size, size, |i, j| match (i < n && j < n, i == j) {
                    (true, _) => stiffness[(i, j)],
                    (false, true) => k,
                    _ => 0.0,
                });
                let model = Model::new(mass, Damping::Matrix(Mat::zeros(size, size)), stiffness).unwrap();
                for (j, hz) in model.natural_frequencies().iter().enumerate().take(10) {
                    let angle = (2 * j + 1) as f64 * std::f64::consts::PI / (4 * n + 2) as f64;
                    let exact = 2.0 * (k / m).sqrt() * angle.sin() / std::f64::consts::TAU;
                    assert!((hz / exact - 1.0).abs() < 1e-9, "{m} {k} {massless} {j}: {hz} for {exact}");
                }
            }
        }
    }

    #[test]
    fn a_massless_dof_has_no_frequency() {
        let (_, c) = chain();
        let m = mat![[2.0, 0.0], [0.0, 0.0]];
        let model = Model::new(m, Damping::ModalRatio(0.01), c).unwrap();
        // Condensed: k = 300 − 100²/100 = 200, m = 2, ω = 10.
        let frequencies = model.natural_frequencies();
        assert_eq!(frequencies.len(), 1);
        assert!((frequencies[0] * std::f64::consts::TAU - 10.0).abs() < 1e-12);
        // D = 2 ζ ω m on the one mode.
        assert!((model.damping[(0, 0)] - 2.0 * 0.01 * 10.0 * 2.0).abs() < 1e-12);
        assert!(model.damping[(1, 1)].abs() < 1e-12);
    }

    #[test]
    fn modal_damping_gives_every_mode_its_ratio() {
        // One dof: D = 2 ζ √(k m).
        let one = Model::new(mat![[2.0]], Damping::ModalRatio(0.03), mat![[50.0]]).unwrap();
        assert!((one.damping[(0, 0)] - 0.06 * 10.0).abs() < 1e-13);
        // Proportional case: C = 4 M → D = 2 ζ 2 M.
        let m = mat![[2.0, 0.5], [0.5, 1.0]];
        let c = Mat::from_fn(2, 2, |i, j| 4.0 * m[(i, j)]);
        let two = Model::new(m.clone(), Damping::ModalRatio(0.1), c).unwrap();
        for i in 0..2 {
            for j in 0..2 {
                assert!((two.damping[(i, j)] - 0.4 * m[(i, j)]).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn bad_matrices_are_named() {
        let (m, c) = chain();
        let none = || Damping::Matrix(Mat::zeros(2, 2));
        let error = |m: Mat<f64>, d: Damping, c: Mat<f64>| Model::new(m, d, c).unwrap_err();
        assert_eq!(error(mat![[1.0, 0.1], [0.0, 1.0]], none(), c.clone()).matrix, "mass");
        assert_eq!(error(mat![[1.0, 2.0], [2.0, 1.0]], none(), c.clone()).matrix, "mass");
        assert_eq!(error(Mat::zeros(2, 2), none(), c.clone()).matrix, "mass");
        assert_eq!(error(m.clone(), none(), mat![[1.0, 0.5], [0.4, 1.0]]).matrix, "stiffness");
        assert_eq!(error(m.clone(), Damping::Matrix(Mat::zeros(1, 1)), c.clone()).matrix, "damping");
        assert_eq!(error(m, Damping::ModalRatio(-1.0), c).matrix, "damping.modal_ratio");
    }
}
