//! Files that NumPy wrote (`tests/reference/matrices.py`), and any bytes.

use std::path::{Path, PathBuf};

use faer::{Mat, mat};
use proptest::prelude::*;

use super::*;

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/matrices").join(name)
}

fn chain() -> Mat<f64> {
    mat![[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]
}

fn error(name: &str) -> String {
    read_npy(&file(name)).unwrap_err().to_string()
}

#[test]
fn every_type_and_order_is_the_same_matrix() {
    for name in ["c_f8", "fortran_f8", "big_f8", "f4", "i8", "big_i2", "i1"] {
        let read = read_npy(&file(&format!("{name}.npy"))).unwrap();
        assert_eq!((read.matrix.to_dense(), read.notes.len()), (chain(), 0), "{name}");
    }
    for name in ["order_c.npy", "order_fortran.npy"] {
        assert_eq!(read_npy(&file(name)).unwrap().matrix.to_dense(), mat![[1.0, 2.0], [3.0, 4.0]], "{name}");
    }
}

#[test]
fn a_triangle_and_a_vector_are_completed_and_said() {
    let upper = read_npy(&file("upper.npy")).unwrap();
    assert_eq!((upper.matrix.to_dense(), &upper.notes[..]), (chain(), &[MatrixNote::OneTriangle][..]));
    let vector = read_npy(&file("vector.npy")).unwrap();
    assert_eq!((vector.matrix.val(), &vector.notes[..]), (&[1.0, 2.0, 3.0][..], &[MatrixNote::Diagonal][..]));
}

#[test]
fn what_is_no_matrix_is_refused() {
    assert!(error("complex.npy").contains("complex"));
    assert!(error("text.npy").contains("texts"));
    assert!(error("cube.npy").contains("array of 2 x 2 x 2"));
    assert!(error("wide.npy").contains("this one is 2 x 3"));
    assert!(error("csc.npz").contains("does not begin with"));
    assert!(error("none.npy").contains("cannot be read"));
}

fn with_header(header: &str, data: &[u8]) -> Vec<u8> {
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn parse(bytes: &[u8]) -> Result<MatrixFile, MatrixFileError> {
    parse_npy(bytes, bytes.len() as u64)
}

#[test]
fn impossible_sizes_are_refused_before_memory_is_taken() {
    let header = |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let error = |bytes: Vec<u8>| parse(&bytes).unwrap_err().to_string();
    assert!(error(with_header(&header("(1000000, 1000000)"), &[0; 8])).contains("cannot hold"));
    assert!(error(with_header(&header("(10000000000, 10000000000)"), &[0; 8])).contains("cannot hold"));
    // A whole file whose length is right, cut off by someone else.
    assert!(
        parse_npy(&with_header(&header("(2, 2)"), &[0; 24])[..], 200)
            .unwrap_err()
            .to_string()
            .contains("ends after")
    );
    assert!(error(with_header(&header("(0, 0)"), &[])).contains("empty"));
    assert!(error(with_header(&header("()"), &[0; 8])).contains("no dimension"));
}

proptest! {
    #[test]
    fn any_bytes_are_a_matrix_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse(&bytes);
    }

    #[test]
    fn any_header_is_a_matrix_or_an_error(
        header in "\\{'descr': '[<>|=][fiubcSU][0-9]{1,2}', 'fortran_order': (True|False), 'shape': \\([0-9, L]{0,12}\\), \\}",
        data in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        if let Ok(read) = parse(&with_header(&header, &data)) {
            prop_assert!(read.matrix.val().iter().all(|value| value.is_finite()));
        }
    }
}
