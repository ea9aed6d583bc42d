//! Non-negative least squares (Lawson and Hanson's active set), for a few hundred unknowns.

/// Least squares of `‖Σ_j x_j columns_j − target‖` over x ≥ 0.
///
/// The solution is certified by the conditions of optimality: the gradient columnsᵀ (Ax − target) vanishes where x_j > 0
/// and is not negative elsewhere (the tests look).
pub(crate) fn least_squares(columns: &[Vec<f64>], target: &[f64]) -> Vec<f64> {
    let n = columns.len();
    // Columns of unit length, so that one tolerance suits all.
    let lengths: Vec<f64> = columns.iter().map(|c| dot(c, c).sqrt()).collect();
    let scaled: Vec<Vec<f64>> =
        columns.iter().zip(&lengths).map(|(c, l)| c.iter().map(|v| v / l).collect()).collect();
    let mut x = vec![0.0; n];
    let mut active: Vec<usize> = Vec::new();
    let size = dot(target, target).sqrt();
    for _ in 0..10 * n {
        let rest = residual(&scaled, &x, target);
        let pull = |j: usize| scaled.get(j).map_or(0.0, |c| -dot(c, &rest));
        let next = (0..n).filter(|j| !active.contains(j)).max_by(|&i, &j| pull(i).total_cmp(&pull(j)));
        let Some(next) = next.filter(|&j| pull(j) > 1e-13 * size) else { break };
        active.push(next);
        loop {
            let free = unconstrained(&scaled, &active, target);
            // As far towards the free solution as no unknown turns negative; those that stop it leave.
            let step = active
                .iter()
                .zip(&free)
                .filter(|(_, free)| **free <= 0.0)
                .filter_map(|(&j, free)| x.get(j).map(|x| x / (x - free)))
                .fold(1.0, f64::min);
            for (&j, free) in active.iter().zip(&free) {
                if let Some(x) = x.get_mut(j) {
                    *x += step * (free - *x);
                }
            }
            if step >= 1.0 {
                break;
            }
            active.retain(|&j| x.get(j).is_some_and(|x| *x > 1e-14 * size));
            for (j, x) in x.iter_mut().enumerate() {
                if !active.contains(&j) {
                    *x = 0.0;
                }
            }
        }
    }
    x.iter().zip(&lengths).map(|(x, l)| x / l).collect()
}

/// Ax − target.
pub(crate) fn residual(columns: &[Vec<f64>], x: &[f64], target: &[f64]) -> Vec<f64> {
    let mut rest: Vec<f64> = target.iter().map(|t| -t).collect();
    for (column, x) in columns.iter().zip(x).filter(|(_, x)| **x != 0.0) {
        for (rest, v) in rest.iter_mut().zip(column) {
            *rest += x * v;
        }
    }
    rest
}

/// Largest violation of the conditions of optimality, as the cosine between a column and the residual.
#[cfg(test)]
pub(crate) fn violation(columns: &[Vec<f64>], x: &[f64], target: &[f64]) -> f64 {
    let rest = residual(columns, x, target);
    let size = dot(&rest, &rest).sqrt();
    columns
        .iter()
        .zip(x)
        .map(|(column, x)| {
            let cosine = dot(column, &rest) / (size * dot(column, column).sqrt());
            if *x > 0.0 { cosine.abs() } else { (-cosine).max(0.0) }
        })
        .fold(0.0, f64::max)
}

/// Least squares with the active columns alone: orthogonalised twice, back-substituted.
fn unconstrained(columns: &[Vec<f64>], active: &[usize], target: &[f64]) -> Vec<f64> {
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let mut upper: Vec<Vec<f64>> = Vec::new();
    for column in active.iter().filter_map(|&j| columns.get(j)) {
        let mut v = column.clone();
        let mut row = vec![0.0; basis.len()];
        for _ in 0..2 {
            for (q, r) in basis.iter().zip(row.iter_mut()) {
                let part = dot(q, &v);
                *r += part;
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
            }
        }
        let length = dot(&v, &v).sqrt();
        v.iter_mut().for_each(|v| *v /= length);
        row.push(length);
        basis.push(v);
        upper.push(row);
    }
    let mut right: Vec<f64> = basis.iter().map(|q| dot(q, target)).collect();
    for (j, row) in upper.iter().enumerate().rev() {
        let (above, rest) = right.split_at_mut(j);
        if let (Some(x), Some(pivot)) = (rest.first_mut(), row.last()) {
            *x /= pivot;
            above.iter_mut().zip(row).for_each(|(b, r)| *b -= r * *x);
        }
    }
    right
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_solution_is_found_and_certified() {
        // min (x + y − 1)² + (x − y − 3)²: free solution (2, −1), constrained x = 2, y = 0.
        let columns = [vec![1.0, 1.0], vec![1.0, -1.0]];
        let x = least_squares(&columns, &[1.0, 3.0]);
        assert!((x[0] - 2.0).abs() < 1e-15 && x[1] == 0.0, "{x:?}");
        assert!(violation(&columns, &x, &[1.0, 3.0]) < 1e-15);
        assert!(violation(&columns, &[2.1, 0.0], &[1.0, 3.0]) > 1e-2);
    }
}
