//! Any bytes are a matrix or an error, in every format of a matrix file.

#![no_main]

use std::io::Cursor;

use libfuzzer_sys::fuzz_target;
use structure::{MatrixFile, MatrixFileError, parse_matrix_market, parse_npy, parse_npz};

fn check(read: Result<MatrixFile, MatrixFileError>) {
    match read {
        Ok(file) => {
            assert_eq!(file.matrix.nrows(), file.matrix.ncols());
            assert!(file.matrix.val().iter().all(|value| value.is_finite()));
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fuzz_target!(|bytes: &[u8]| {
    check(parse_matrix_market(bytes, bytes.len() as u64));
    check(parse_npy(bytes, bytes.len() as u64));
    check(parse_npz(Cursor::new(bytes), None));
});
