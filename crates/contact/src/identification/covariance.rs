//! (Jᵀ W J)⁻¹ for three numbers, through the triangular factor of √W J.

/// The inverse of Σ_rows row rowᵀ, or none where the columns depend on each other.
pub(super) fn inverse_normal(rows: &[[f64; 3]]) -> Option<[[f64; 3]; 3]> {
    // Modified Gram–Schmidt: √W J = Q R, so the inverse is R⁻¹ R⁻ᵀ and J is never squared.
    let column = |j: usize| rows.iter().map(move |row| row.get(j).copied().unwrap_or_default());
    let mut a: Vec<f64> = column(0).collect();
    let mut b: Vec<f64> = column(1).collect();
    let mut c: Vec<f64> = column(2).collect();
    let (size_a, size_b, size_c) = (norm(&a), norm(&b), norm(&c));
    let r00 = normalise(&mut a, size_a)?;
    let r01 = project_out(&a, &mut b);
    let r02 = project_out(&a, &mut c);
    let r11 = normalise(&mut b, size_b)?;
    let r12 = project_out(&b, &mut c);
    let r22 = normalise(&mut c, size_c)?;

    let (i00, i11, i22) = (1.0 / r00, 1.0 / r11, 1.0 / r22);
    let (i01, i12) = (-r01 * i00 * i11, -r12 * i11 * i22);
    let i02 = (r01 * r12 * i11 - r02) * i00 * i22;
    let c01 = i01 * i11 + i02 * i12;
    let (c02, c12) = (i02 * i22, i12 * i22);
    Some([
        [i00 * i00 + i01 * i01 + i02 * i02, c01, c02],
        [c01, i11 * i11 + i12 * i12, c12],
        [c02, c12, i22 * i22],
    ])
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Divides by the norm; none where almost nothing is left of the column's `size`.
fn normalise(v: &mut [f64], size: f64) -> Option<f64> {
    let length = norm(v);
    if !(length > 1e-12 * size && length.is_finite()) {
        return None;
    }
    for x in v {
        *x /= length;
    }
    Some(length)
}

/// Takes the part along the unit vector `unit` out of `v`, and returns it.
fn project_out(unit: &[f64], v: &mut [f64]) -> f64 {
    let along: f64 = unit.iter().zip(&*v).map(|(x, y)| x * y).sum();
    for (y, x) in v.iter_mut().zip(unit) {
        *y -= along * x;
    }
    along
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_inverse() {
        let rows = [[1.0, 0.3, -2.0], [1.0, 0.9, 0.4], [1.0, 2.5, 0.1], [1.0, -1.0, 0.7]];
        let inverse = inverse_normal(&rows).unwrap();
        for (i, line) in inverse.iter().enumerate() {
            for j in 0..3 {
                let normal = |k: usize| rows.iter().map(|row| row[k] * row[j]).sum::<f64>();
                let product: f64 = line.iter().enumerate().map(|(k, x)| x * normal(k)).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                assert!((product - unit).abs() < 1e-13, "{i} {j}: {product}");
            }
        }
    }

    #[test]
    fn columns_that_depend_on_each_other_have_none() {
        assert!(inverse_normal(&[[1.0, 2.0, 3.0], [1.0, 3.0, 4.0], [1.0, 5.0, 6.0]]).is_none());
        assert!(inverse_normal(&[[1.0, 2.0, 0.0], [1.0, 3.0, 0.0], [1.0, 5.0, 0.0]]).is_none());
    }
}
