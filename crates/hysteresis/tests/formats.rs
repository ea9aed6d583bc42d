//! Records in the files of NumPy, MATLAB and modal test systems, as NumPy, SciPy and pyuff write them
//! (`tests/reference/formats.py`): each holds the same motion.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::f64::consts::PI;
use std::path::PathBuf;

use hysteresis::{ReadOptions, Record};
use proptest::prelude::*;

fn file(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/formats").join(name)
}

/// Options as the command line takes them.
fn options(columns: &str, units: &str) -> ReadOptions {
    let mut options = ReadOptions::default();
    if !columns.is_empty() {
        options.columns = columns.parse().unwrap();
    }
    if !units.is_empty() {
        options.units = units.parse().unwrap();
    }
    options
}

fn read(name: &str, columns: &str, units: &str) -> Record {
    Record::read(&file(name), &options(columns, units)).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(name: &str, columns: &str, units: &str) -> String {
    let error = Record::read(&file(name), &options(columns, units)).unwrap_err().to_string();
    assert!(error.contains(name), "the error does not name the file: {error}");
    error
}

/// 8 cos τ µm and 12 cos(τ + 1) N in quarters, 16 samples a cycle, 64 a second.
fn assert_is_the_motion(record: &Record, timed: bool, case: &str) {
    assert_eq!((record.len(), record.force.len()), (49, 49), "{case}");
    let quarters = |value: f64| (4.0 * value).round() / 4.0;
    for (sample, (w, f)) in record.displacement.iter().zip(&record.force).enumerate() {
        let tau = sample as f64 * 2.0 * PI / 16.0;
        let expected = quarters(8.0 * tau.cos()) * 1e-6;
        assert!((w - expected).abs() < 1e-20, "{case}, sample {sample}: {w} for {expected}");
        assert_eq!(*f, quarters(12.0 * (tau + 1.0).cos()), "{case}, sample {sample}");
    }
    assert_eq!(record.time.is_some(), timed, "{case}");
    for (sample, t) in record.time.iter().flatten().enumerate() {
        assert_eq!(*t, sample as f64 / 64.0, "{case}, sample {sample}");
    }
}

const SI: &str = "displacement=um,force=N";
const TIMED: &str = "displacement=um,force=N,time=s";

#[test]
fn every_file_is_the_same_record() {
    for (name, columns, units, timed) in [
        ("c_f8.npy", "displacement=1,force=2", SI, false),
        ("big_f8.npy", "displacement=1,force=2", SI, false),
        ("fortran_f4.npy", "displacement=2,force=3", SI, false),
        ("fortran_f4.npy", "time=1,displacement=2,force=3", TIMED, true),
        ("structured.npy", "", "", true),
        ("named.npz", "", "", true),
        ("named.npz", "displacement=displacement [um],force=FORCE", "", true),
        ("matrix.npz", "displacement=rig:2,force=rig:3", SI, false),
        ("ambiguous.npz", "displacement=d", SI, false),
        ("v5.mat", "", TIMED, true),
        ("compressed.mat", "", SI, false),
        ("matrix.mat", "time=1,displacement=2,force=3", TIMED, true),
        ("matrix.mat", "time=data:1,displacement=data:2,force=data:3", TIMED, true),
        ("struct.mat", "", SI, false),
        ("struct.mat", "displacement=rig.disp,force=rig.force", SI, false),
        ("big.mat", "", SI, false),
        ("even_double.uff", "", "", true),
        ("even_double.uff", "displacement=12+X,force=12+X", "", true),
        ("even_double.uff", "displacement=1,force=2", "", true),
        ("even_double.uff", "displacement=Displacement,force=Force of the rig", "", true),
        ("uneven_double.uff", "displacement=3+X,force=7+X", "", true),
        ("uneven_double.uff", "displacement=slider,force=load cell", "", true),
        // Found by their units alone.
        ("uneven_double.uff", "", "", true),
        ("even_single.uff", "", SI, true),
    ] {
        let record = read(name, columns, units);
        assert_is_the_motion(&record, timed, &format!("{name} {columns}"));
    }
}

#[test]
fn types_of_integers_are_read_as_what_they_hold() {
    let record = read("quarters_i2.npy", "displacement=1,force=2", "displacement=m,force=N");
    assert_eq!(&record.displacement[..4], [32.0, 30.0, 23.0, 12.0]);
    let record = read("types.mat", "", "displacement=m,force=N");
    assert_eq!(
        (&record.displacement[..2], &record.force[..4]),
        (&[8.0, 7.5][..], &[26.0, 9.0, -10.0, -27.0][..])
    );
}

#[test]
fn what_cannot_be_read_is_refused_with_what_to_do() {
    let says = |name: &str, columns: &str, units: &str, words: &[&str]| {
        let error = refused(name, columns, units);
        for word in words {
            assert!(error.contains(word), "{name} {columns}: {word:?} is not in: {error}");
        }
    };
    says("c_f8.npy", "", SI, &["displacement", "49 x 2", "--columns displacement=1"]);
    says("c_f8.npy", "displacement=1,force=2", "", &["no unit", "--units displacement=um"]);
    says("c_f8.npy", "displacement=1,force=3", SI, &["no column number 3", "force"]);
    says("c_f8.npy", "displacement=1,force=1", SI, &["both the displacement and the force"]);
    says("wide.npy", "displacement=1,force=2", SI, &["transpose"]);
    says("vector.npy", "displacement=1,force=2", SI, &["no column number 2"]);
    says("pickled.npy", "displacement=1,force=2", SI, &["pickled"]);
    says("ambiguous.npz", "", SI, &["`d`", "`x`", "--columns displacement=d"]);
    says("matrix.npz", "", SI, &["`rig:2`", "--columns displacement=rig:1"]);
    says("matrix.npz", "displacement=remark,force=rig:3", SI, &["`remark`", "texts"]);
    says("named.npz", "displacement=slip", "", &["no column `slip`", "`displacement [um]`"]);
    says("v5.mat", "", "", &["`disp`", "no unit", "--units displacement=um"]);
    says("v5.mat", "displacement=remark", SI, &["text"]);
    says("complex.mat", "displacement=disp", SI, &["complex"]);
    says("struct.mat", "displacement=rig.disp,force=version", SI, &["1 samples", "49"]);
    says("v73.mat", "", SI, &["7.3", "-v7"]);
    says("v4.mat", "", SI, &["-v7"]);
    says("even_single.uff", "", "", &["no unit", "--units displacement=um"]);
    says("even_double.uff", "displacement=2,force=1", "", &["the file says that it is a force"]);
    says("even_double.uff", "displacement=5+Y", "", &["`5+Y`", "12+X"]);
    says("binary.uff", "", "", &["58b", "ASCII"]);
}

/// A file with other bytes in a place.
fn changed(name: &str, from: &str, to: &str) -> Vec<u8> {
    let text = std::fs::read_to_string(file(name)).unwrap();
    assert!(text.contains(from), "{name} has no {from:?}");
    text.replacen(from, to, 1).into_bytes()
}

fn uff_error(bytes: &[u8]) -> String {
    Record::from_bytes(bytes, &options("", "")).unwrap_err().to_string()
}

#[test]
fn universal_files_that_do_not_fit_are_refused() {
    let spectrum = changed(
        "even_double.uff",
        "    1         0    0         0       NONE",
        "    4         0    0         0       NONE",
    );
    assert!(uff_error(&spectrum).contains("12+X"));
    let acceleration = changed(
        "even_double.uff",
        "         8    0    0    0 Displacement",
        "        12    0    0    0 Displacement",
    );
    assert!(uff_error(&acceleration).contains("acceleration"));
    let short =
        changed("even_double.uff", "         4        49         1", "         4        52         1");
    assert!(uff_error(&short).contains("49 numbers instead of 52"), "{}", uff_error(&short));
    let other_times = changed("even_double.uff", "  1.56250e-02", "  1.55250e-02");
    assert!(uff_error(&other_times).contains("same instants"));
    let word = changed("even_double.uff", "7.50000000000e+00", "7.5000000000xe+00");
    assert!(uff_error(&word).contains("line 14: expected numbers"), "{}", uff_error(&word));
    assert!(uff_error(b"    -1\n   151\nx\n    -1\n").contains("no function"));
}

#[test]
fn numbers_of_fortran_are_read() {
    // Touching columns, D for E, and an exponent of three digits without a letter.
    let written = changed(
        "even_double.uff",
        "   8.00000000000e+00   7.50000000000e+00",
        "8.00000000000000D+00-7.5000000000000D+00",
    );
    let record = Record::from_bytes(&written, &options("", "")).unwrap();
    assert_eq!(&record.displacement[..2], [8.0 * 1e-6, -7.5 * 1e-6]);
    let written = changed("even_double.uff", "   8.00000000000e+00", "  8.00000000000-100");
    let record = Record::from_bytes(&written, &options("", "")).unwrap();
    assert_eq!(record.displacement[0], 8e-100 * 1e-6);
}

const UFF: [&str; 3] = ["even_double.uff", "uneven_double.uff", "even_single.uff"];

proptest! {
    #[test]
    fn a_damaged_universal_file_is_a_record_or_an_error(
        name in prop::sample::select(UFF.to_vec()),
        end in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
    ) {
        let mut bytes = std::fs::read(file(name)).unwrap();
        for (place, value) in &changes {
            let at = place.index(bytes.len());
            bytes[at] = *value;
        }
        for bytes in [&bytes[..], &bytes[..end.index(bytes.len())]] {
            match Record::from_bytes(bytes, &options("", SI)) {
                Ok(record) => prop_assert!(record.displacement.iter().chain(&record.force).all(|x| x.is_finite())),
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }

    #[test]
    fn any_text_after_the_first_lines_is_a_record_or_an_error(text in "([ 0-9.eED+-]{0,90}\n){0,30}") {
        let _ = Record::from_bytes(format!("    -1\n    58\n{text}").as_bytes(), &options("", SI));
    }
}
