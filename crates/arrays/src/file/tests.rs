//! Files that NumPy and SciPy wrote (`tests/reference/formats.py`), whole, cut off and damaged.

use std::path::Path;

use proptest::prelude::*;

use super::*;

fn bytes(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference/formats");
    std::fs::read(folder.join(name)).unwrap()
}

fn opened(bytes: &[u8]) -> Result<ArrayFile<'_>, ArrayError> {
    let format = Format::of(bytes)?.ok_or_else(|| wrong("unknown"))?;
    ArrayFile::open(bytes, format)
}

/// Names, extents and whether they are numbers.
fn listed(name: &str) -> Vec<(String, Vec<usize>, bool)> {
    let bytes = bytes(name);
    let file = opened(&bytes).unwrap();
    file.entries().iter().map(|e| (e.name.clone(), e.shape.clone(), e.other.is_none())).collect()
}

fn entry(name: &str, shape: &[usize], numbers: bool) -> (String, Vec<usize>, bool) {
    (name.to_owned(), shape.to_vec(), numbers)
}

#[test]
fn every_array_is_listed_also_what_is_no_numbers() {
    assert_eq!(listed("c_f8.npy"), [entry("", &[49, 2], true)]);
    assert!(opened(&bytes("pickled.npy")).unwrap_err().to_string().contains("pickled"));
    assert_eq!(
        listed("matrix.npz"),
        [entry("rig", &[49, 3], true), entry("rate", &[], true), entry("remark", &[], false)]
    );
    assert_eq!(listed("structured.npy").len(), 3);
    assert_eq!(listed("structured.npy")[1], entry("displacement [um]", &[49], true));
    assert_eq!(
        listed("v5.mat"),
        [
            entry("disp", &[1, 49], true),
            entry("force", &[1, 49], true),
            entry("time", &[1, 49], true),
            entry("remark", &[1, 5], false)
        ]
    );
    assert_eq!(listed("compressed.mat")[2], entry("cells", &[2, 49], false));
    assert_eq!(
        listed("struct.mat"),
        [
            entry("rig.disp", &[1, 49], true),
            entry("rig.force", &[1, 49], true),
            entry("rig.fs", &[1, 1], true),
            entry("version", &[1, 1], true)
        ]
    );
    assert_eq!(listed("complex.mat")[0], entry("disp", &[1, 49], false));
}

#[test]
fn columns_are_those_of_either_order() {
    for (name, first) in [("c_f8.npy", 0), ("big_f8.npy", 0), ("fortran_f4.npy", 1), ("matrix.mat", 1)] {
        let bytes = bytes(name);
        let file = opened(&bytes).unwrap();
        let entry = &file.entries()[0];
        let column = |at: usize| file.column(entry, at).unwrap();
        // 8 cos and 12 cos(… + 1), in quarters.
        assert_eq!((&column(first)[..4], column(first).len()), (&[8.0, 7.5, 5.75, 3.0][..], 49), "{name}");
        assert_eq!(&column(first + 1)[..4], &[6.5, 2.25, -2.5, -6.75], "{name}");
        assert!(file.column(entry, first + 2).is_err());
    }
}

#[test]
fn other_files_of_matlab_are_refused_with_what_to_do() {
    for name in ["v73.mat", "v4.mat"] {
        match opened(&bytes(name)) {
            Err(error) if name == "v73.mat" => assert!(error.to_string().contains("-v7"), "{error}"),
            Err(error) => assert!(error.to_string().contains("unknown"), "{error}"),
            Ok(_) => panic!("{name} was read"),
        }
    }
    assert!(Format::of(b"\x89HDF\r\n\x1a\n").is_err());
    assert!(Format::of(b"# Created by Octave 8").unwrap_err().to_string().contains("save -v7"));
}

/// Reads all there is in any bytes.
fn read_all(bytes: &[u8]) {
    let Ok(file) = opened(bytes) else { return };
    for entry in file.entries() {
        for column in 0..entry.samples_and_columns().map_or(1, |(_, columns)| columns.min(4)) {
            if let Ok(values) = file.column(entry, column) {
                assert!(values.len() <= 1 << 16, "{} values of a few bytes", values.len());
            }
        }
    }
}

const FILES: [&str; 10] = [
    "c_f8.npy",
    "fortran_f4.npy",
    "structured.npy",
    "named.npz",
    "matrix.npz",
    "v5.mat",
    "compressed.mat",
    "struct.mat",
    "big.mat",
    "types.mat",
];

#[test]
fn a_forged_size_takes_no_memory() {
    // Extents of 2³¹ − 1 x 2³¹ − 1, and a length of almost 4 GB.
    let mut forged = bytes("v5.mat");
    for at in (128..forged.len() - 8).step_by(4) {
        let before: [u8; 8] = forged[at..at + 8].try_into().unwrap();
        for value in [[0xff, 0xff, 0xff, 0x7f], [0xf8, 0xff, 0xff, 0xff]] {
            forged[at..at + 4].copy_from_slice(&value);
            read_all(&forged);
            forged[at + 4..at + 8].copy_from_slice(&value);
            read_all(&forged);
            forged[at..at + 8].copy_from_slice(&before);
        }
    }
}

#[test]
fn a_file_cut_off_anywhere_is_read_in_part_or_refused() {
    for name in FILES {
        let bytes = bytes(name);
        for end in (0..bytes.len()).step_by(3) {
            read_all(&bytes[..end]);
        }
    }
}

proptest! {
    #[test]
    fn any_bytes_are_arrays_or_an_error(
        start in prop::sample::select(vec![&b"\x93NUMPY\x01\x00"[..], b"PK\x03\x04", b""]),
        bytes in prop::collection::vec(any::<u8>(), 0..300),
    ) {
        read_all(&[start, &bytes].concat());
        let mat = [&b"MATLAB 5.0"[..], &[b' '; 114], b"\x00\x01IM", &bytes].concat();
        read_all(&mat);
    }

    #[test]
    fn any_header_is_an_array_or_an_error(
        header in "\\{'descr': ('[<>|=][fiubcSU][0-9]{1,2}'|\\[\\('a', '<f[48]'\\), \\('b', '[<>][ui][124]'\\)\\]), 'fortran_order': (True|False), 'shape': \\([0-9, L]{0,12}\\), \\}",
        data in prop::collection::vec(any::<u8>(), 0..400),
    ) {
        let length = (header.len() as u16).to_le_bytes();
        read_all(&[b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), &data].concat());
    }

    #[test]
    fn a_damaged_file_is_read_or_refused(
        name in prop::sample::select(FILES.to_vec()),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
    ) {
        let mut bytes = bytes(name);
        for (place, value) in changes {
            let at = place.index(bytes.len());
            bytes[at] = value;
        }
        read_all(&bytes);
    }
}
