//! The eight-node brick with incompatible modes: bends without shear locking, and passes the patch test.
//!
//! R. L. Taylor, P. J. Beresford, E. L. Wilson, "A non-conforming element for stress analysis", Int. J. Numer. Meth.
//! Engng 10 (1976) 1211–1219. Displacements are `u = Σ N_a(ξ) u_a + Σ_i (1 − ξ_i²) α_i`; the gradients of the second
//! sum are taken with the Jacobian of the element's centre, so that they vanish in the mean, and α is condensed.

use anyhow::{Result, ensure};

use super::material::Material;

/// Nodes of an element: bottom face counterclockwise, then the top face, seen from the top.
pub(super) const NODES: usize = 8;
/// Shape functions with a gradient: the nodes' and three incompatible ones.
const FUNCTIONS: usize = NODES + 3;

/// Natural coordinates of the nodes.
const CORNERS: [[f64; 3]; NODES] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

pub(super) type Block = [[f64; 3]; 3];

/// Blocks of the element's matrices, `[a][b]` for nodes a and b.
pub(super) struct Element {
    /// In N/m.
    pub(super) stiffness: [[Block; NODES]; NODES],
    /// Consistent mass in kg; the same in every direction, so one number a pair of nodes.
    pub(super) mass: [[f64; NODES]; NODES],
}

/// Stiffness and mass of the brick with these nodes, in m, by 2 × 2 × 2 Gauss points.
///
/// # Errors
/// An element that is folded: its Jacobian is not positive everywhere.
pub(super) fn element(nodes: &[[f64; 3]; NODES], material: &Material) -> Result<Element> {
    let centre = jacobian(nodes, [0.0; 3]);
    let centre_volume = determinant(&centre);
    let mut full = [[[[0.0; 3]; 3]; FUNCTIONS]; FUNCTIONS];
    let mut mass = [[0.0; NODES]; NODES];
    for corner in CORNERS {
        let xi = corner.map(|x| x / 3.0_f64.sqrt());
        let at = jacobian(nodes, xi);
        let volume = determinant(&at);
        ensure!(
            volume > 0.0 && centre_volume > 0.0,
            "an element is folded; less --twist, more --elements, or a smaller --chord"
        );
        let mut gradients = [[0.0; 3]; FUNCTIONS];
        let inverse = inverse(&at);
        for (a, gradient) in gradients.iter_mut().take(NODES).enumerate() {
            *gradient = times(&inverse, natural_gradient(a, xi));
        }
        let inverse = self::inverse(&centre);
        for i in 0..3 {
            let mut natural = [0.0; 3];
            natural[i] = -2.0 * xi[i] * centre_volume / volume;
            gradients[NODES + i] = times(&inverse, natural);
        }
        for a in 0..FUNCTIONS {
            for b in 0..FUNCTIONS {
                add_stiffness(&mut full[a][b], &gradients[a], &gradients[b], material, volume);
            }
        }
        let shapes: [f64; NODES] = std::array::from_fn(|a| shape(a, xi));
        for a in 0..NODES {
            for b in 0..NODES {
                mass[a][b] += material.density * shapes[a] * shapes[b] * volume;
            }
        }
    }
    Ok(Element { stiffness: condense(&full), mass })
}

/// λ g hᵀ + μ (h gᵀ + (g·h) 1): the energy of an isotropic body between two functions with gradients g and h.
fn add_stiffness(block: &mut Block, g: &[f64; 3], h: &[f64; 3], material: &Material, volume: f64) {
    let (lambda, mu) = (material.lame() * volume, material.shear() * volume);
    let along = g[0] * h[0] + g[1] * h[1] + g[2] * h[2];
    for i in 0..3 {
        for j in 0..3 {
            block[i][j] += lambda * g[i] * h[j] + mu * h[i] * g[j];
        }
        block[i][i] += mu * along;
    }
}

/// K_uu − K_uα K_αα⁻¹ K_αu, by elimination of the nine incompatible unknowns from the last to the first.
fn condense(full: &[[Block; FUNCTIONS]; FUNCTIONS]) -> [[Block; NODES]; NODES] {
    let mut matrix = [[0.0; 3 * FUNCTIONS]; 3 * FUNCTIONS];
    for (row, cells) in matrix.iter_mut().enumerate() {
        for (column, cell) in cells.iter_mut().enumerate() {
            *cell = full[row / 3][column / 3][row % 3][column % 3];
        }
    }
    for pivot in (3 * NODES..3 * FUNCTIONS).rev() {
        let from = matrix[pivot];
        for row in matrix.iter_mut().take(pivot) {
            let factor = row[pivot] / from[pivot];
            for (cell, other) in row.iter_mut().zip(&from).take(pivot) {
                *cell -= factor * other;
            }
        }
    }
    // Symmetric but for rounding; the two triangles are averaged.
    std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| 0.5 * (matrix[3 * a + i][3 * b + j] + matrix[3 * b + j][3 * a + i]))
            })
        })
    })
}

/// N_a = (1 + ξ ξ_a)(1 + η η_a)(1 + ζ ζ_a)/8.
fn shape(a: usize, xi: [f64; 3]) -> f64 {
    (0..3).map(|i| 0.5 * (1.0 + xi[i] * CORNERS[a][i])).product()
}

fn natural_gradient(a: usize, xi: [f64; 3]) -> [f64; 3] {
    let factor = |i: usize| 0.5 * (1.0 + xi[i] * CORNERS[a][i]);
    let slope = |i: usize| 0.5 * CORNERS[a][i];
    [slope(0) * factor(1) * factor(2), factor(0) * slope(1) * factor(2), factor(0) * factor(1) * slope(2)]
}

/// `[i][j]` = ∂x_j/∂ξ_i.
fn jacobian(nodes: &[[f64; 3]; NODES], xi: [f64; 3]) -> Block {
    let mut jacobian = [[0.0; 3]; 3];
    for (a, node) in nodes.iter().enumerate() {
        let gradient = natural_gradient(a, xi);
        for i in 0..3 {
            for j in 0..3 {
                jacobian[i][j] += gradient[i] * node[j];
            }
        }
    }
    jacobian
}

fn determinant(m: &Block) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
        + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
}

fn inverse(m: &Block) -> Block {
    let determinant = determinant(m);
    let cofactor = |i: usize, j: usize| {
        let (r, s, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[r][c] * m[s][d] - m[r][d] * m[s][c]
    };
    std::array::from_fn(|i| std::array::from_fn(|j| cofactor(j, i) / determinant))
}

fn times(m: &Block, x: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| m[i][0] * x[0] + m[i][1] * x[1] + m[i][2] * x[2])
}
