//! Small files whose matrices are known, and any bytes.

use faer::mat;
use proptest::prelude::*;

use super::*;
use crate::matrix_file::MatrixNote;

fn parse(text: &str) -> Result<MatrixFile, MatrixFileError> {
    parse_matrix_market(text.as_bytes(), text.len() as u64)
}

fn coordinate_file(symmetry: &str, entries: &str) -> String {
    let count = entries.lines().filter(|line| !line.trim().is_empty()).count();
    format!("%%MatrixMarket matrix coordinate real {symmetry}\n% a comment\n\n3 3 {count}\n{entries}")
}

fn refused(text: &str, words: &str) {
    let error = parse(text).unwrap_err().to_string();
    assert!(error.contains(words), "{text}\nexpected {words}\ngot {error}");
}

const FULL: &str = "1 1 2\n2 1 -1\n1 2 -1\n2 2 2\n3 2 -1\n2 3 -1\n3 3 1\n";
const LOWER: &str = "1 1 2.0\n2 1 -1e0\n2 2 2\n3 2 -1\n3 3 1\n";
const UPPER: &str = "1 1 2\n1 2 -1.0D+00\n2 2 2\n2 3 -1\n3 3 1";

#[test]
fn every_form_of_a_symmetric_matrix_is_the_same() {
    let truth = mat![[2.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]];
    let mixed = "1 1 2\n2 1 -1\n2 2 2\n2 3 -1\n3 3 1\n";
    let array = "%%matrixmarket MATRIX array real general\r\n3 3\r\n2\r\n-1\r\n0\r\n-1\r\n2\r\n-1\r\n0\r\n-1\r\n1\r\n";
    let packed = "%%MatrixMarket matrix array integer symmetric\n3 3\n2\n-1\n0\n2\n-1\n1\n";
    for (text, notes) in [
        (coordinate_file("general", FULL), vec![]),
        (coordinate_file("symmetric", LOWER), vec![]),
        (coordinate_file("symmetric", UPPER), vec![MatrixNote::UpperTriangle]),
        (coordinate_file("symmetric", mixed), vec![MatrixNote::MixedTriangles]),
        (coordinate_file("symmetric", FULL), vec![MatrixNote::BothTriangles]),
        (coordinate_file("general", LOWER), vec![MatrixNote::OneTriangle]),
        (coordinate_file("general", UPPER), vec![MatrixNote::OneTriangle]),
        (array.to_owned(), vec![]),
        (packed.to_owned(), vec![]),
        (
            coordinate_file("general", &FULL.replace("3 3 1", "3 3 0.25\n3 3 0.75")),
            vec![MatrixNote::Repeated(1)],
        ),
    ] {
        let read = parse(&text).unwrap();
        assert_eq!(read.matrix.to_dense(), truth, "{text}");
        assert_eq!(read.notes, notes, "{text}");
    }
}

#[test]
fn a_diagonal_needs_no_mirror() {
    for symmetry in ["general", "symmetric"] {
        let read = parse(&coordinate_file(symmetry, "1 1 1\n2 2 2\n3 3 3\n")).unwrap();
        assert_eq!((read.matrix.val(), read.notes.len()), (&[1.0, 2.0, 3.0][..], 0));
    }
}

#[test]
fn a_skew_matrix_changes_sign() {
    let read = parse(&coordinate_file("skew-symmetric", "2 1 5\n")).unwrap();
    assert_eq!(read.matrix.to_dense(), mat![[0.0, -5.0, 0.0], [5.0, 0.0, 0.0], [0.0, 0.0, 0.0]]);
    refused(&coordinate_file("skew-symmetric", "2 1 5\n2 2 1\n"), "row 2, column 2 is not zero");
    refused(&coordinate_file("skew-symmetric", "2 1 5\n1 2 -5\n"), "both sides");
}

#[test]
fn mistakes_have_their_line() {
    refused("", "the file is empty");
    refused("1 2 3\n", "line 1: a Matrix Market file begins with");
    refused("%%MatrixMarket matrix coordinate pattern general\n", "line 1: a pattern");
    refused("%%MatrixMarket matrix coordinate complex general\n", "line 1: a complex matrix");
    refused("%%MatrixMarket matrix coordinate real hermitian\n", "Hermitian");
    refused("%%MatrixMarket matrix coordinate real general\n% nothing\n", "before it says the size");
    refused(
        "%%MatrixMarket matrix coordinate real general\n2 3 0\n",
        "line 2: a matrix of a structure is square",
    );
    refused("%%MatrixMarket matrix coordinate real general\n2 2\n", "line 2: must be three whole numbers");
    refused("%%MatrixMarket matrix coordinate real general\n0 0 0\n", "line 2: the matrix is empty");
    refused(&coordinate_file("general", "1 1 x\n"), "line 5: \"x\" is no number");
    refused(&coordinate_file("general", "1 1 inf\n"), "line 5: the entry in row 1, column 1 is inf");
    refused(&coordinate_file("general", "0 1 1\n"), "line 5: rows and columns count from 1");
    refused(&coordinate_file("general", "1 4 1\n"), "line 5: the entry in row 1, column 4 is outside");
    refused(&coordinate_file("general", "1 1\n"), "line 5: must be row, column and value");
    refused(&coordinate_file("general", "1 1 1 1\n"), "line 5: must be row, column and value");
    refused(&coordinate_file("general", "1 1 1\n").replace("3 3 1", "3 3 2"), "ends after 1 of the 2");
    refused(&(coordinate_file("general", "1 1 1\n") + "2 2 2\n"), "line 6: follows after");
    refused(&coordinate_file("symmetric", "2 1 5\n1 2 6\n"), "row 2, column 1 is 5 and row 1, column 2 is 6");
    refused(&coordinate_file("symmetric", "2 1 5\n1 2 5\n3 1 1\n"), "in pairs");
    refused("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "before row 2, column 2");
}

#[test]
fn impossible_sizes_are_refused_before_memory_is_taken() {
    let coordinate = "%%MatrixMarket matrix coordinate real general\n";
    refused(&format!("{coordinate}3 3 1000000000000\n"), "promises 1000000000000 entries");
    refused(&format!("{coordinate}1000000000000 1000000000000 1\n1 1 1\n"), "has 1000000000000 rows");
    refused(&format!("{coordinate}3 3 99999999999999999999999\n"), "no whole number");
    refused(
        "%%MatrixMarket matrix array real general\n4000000 4000000\n1\n",
        "promises 16000000000000 entries",
    );
}

proptest! {
    #[test]
    fn any_text_is_a_matrix_or_an_error(text in "(%%MatrixMarket matrix (coordinate|array) real (general|symmetric|skew-symmetric)\n)?[0-9 .e\n%-]{0,200}") {
        if let Ok(read) = parse(&text) {
            prop_assert_eq!(read.matrix.nrows(), read.matrix.ncols());
            prop_assert!(read.matrix.val().iter().all(|value| value.is_finite() && *value != 0.0));
        }
    }

    #[test]
    fn any_bytes_are_a_matrix_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = parse_matrix_market(&bytes[..], bytes.len() as u64);
    }

    #[test]
    fn a_written_matrix_is_read_back(
        values in prop::collection::vec((0_usize..7, 0_usize..7, -1e9_f64..1e9), 0..40),
    ) {
        let mut truth = faer::Mat::<f64>::zeros(7, 7);
        let mut text = format!("%%MatrixMarket matrix coordinate real general\n7 7 {}\n", values.len() + 2);
        // Both triangles, so that nothing is mirrored.
        for (row, column, value) in values.into_iter().chain([(6, 5, 1e10), (5, 6, 1e10)]) {
            truth[(row, column)] += value;
            text += &format!("{} {} {value:e}\n", row + 1, column + 1);
        }
        prop_assert_eq!(parse(&text).unwrap().matrix.to_dense(), truth);
    }
}
