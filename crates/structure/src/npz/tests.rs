//! Archives that NumPy and SciPy wrote (`tests/reference/matrices.py`), and any bytes.

use std::io::Cursor;
use std::path::PathBuf;

use faer::{Mat, mat};
use proptest::prelude::*;

use super::*;
use crate::matrix_file::MatrixNote;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/matrices").join(name)
}

fn chain() -> Mat<f64> {
    mat![[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]
}

#[test]
fn every_format_is_the_same_matrix() {
    for (name, entry) in [
        ("csc.npz", None),
        ("csr.npz", None),
        ("coo.npz", None),
        ("one.npz", None),
        ("one.npz", Some("K")),
        ("two.npz", Some("K")),
    ] {
        let read = read_npz(&file(name), entry).unwrap();
        assert_eq!((read.matrix.to_dense(), read.notes.len()), (chain(), 0), "{name}");
    }
    let order = read_npz(&file("csr_order.npz"), None).unwrap();
    assert_eq!(order.matrix.to_dense(), mat![[1.0, 2.0], [3.0, 4.0]]);
    let lower = read_npz(&file("lower.npz"), None).unwrap();
    assert_eq!((lower.matrix.to_dense(), &lower.notes[..]), (chain(), &[MatrixNote::OneTriangle][..]));
}

#[test]
fn what_is_no_matrix_is_refused() {
    let error = |name: &str, entry| read_npz(&file(name), entry).unwrap_err().to_string();
    assert!(error("two.npz", None).contains("several arrays; say which one: K, M"));
    assert!(error("two.npz", Some("C")).contains("there is no array \"C\" in it; it has K, M"));
    assert!(error("dia.npz", None).contains("\"dia\"; save K.tocsc()"));
    assert!(error("c_f8.npy", None).contains("no .npz archive"));
}

proptest! {
    #[test]
    fn a_damaged_archive_is_a_matrix_or_an_error(
        name in prop::sample::select(vec!["csc.npz", "csr.npz", "coo.npz", "one.npz"]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut bytes = std::fs::read(file(name)).unwrap();
        for (place, value) in changes {
            let place = place.index(bytes.len());
            bytes[place] = value;
        }
        let _ = parse_npz(Cursor::new(bytes), None);
    }
}
