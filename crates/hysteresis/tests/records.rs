//! Reading records: every form a file may have, and what is said about one that cannot be read.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use hysteresis::{
    Column, Columns, ForceSign, ForceUnit, LengthUnit, ReadOptions, Record, RecordError, TimeUnit, Units,
};
use proptest::prelude::*;

fn read(text: &str) -> Record {
    Record::parse(text, &ReadOptions::default()).unwrap_or_else(|error| panic!("{text:?}: {error}"))
}

fn refused(text: &str) -> String {
    Record::parse(text, &ReadOptions::default()).unwrap_err().to_string()
}

/// The record that most texts below describe.
fn is_example(record: &Record) {
    let near = |found: &[f64], exact: [f64; 3]| {
        assert_eq!(found.len(), 3);
        for (one, other) in found.iter().zip(exact) {
            assert!((one - other).abs() <= 1e-15 * other.abs(), "{one} {other}");
        }
    };
    near(record.time.as_deref().unwrap(), [0.0, 0.5, 1.0]);
    near(&record.displacement, [1.5e-6, -2e-6, 0.25e-6]);
    near(&record.force, [-1.0, 2.5, 3e3]);
}

#[test]
fn every_usual_form_of_a_table_is_the_same_record() {
    for text in [
        "time [s],displacement [um],force [N]\n0,1.5,-1\n0.5,-2,2.5\n1,0.25,3e3\n",
        "\u{feff}time [s],displacement [um],force [N]\r\n0,1.5,-1\r\n0.5,-2,2.5\r\n1,0.25,3e3\r\n\r\n\r\n",
        "Time (s); Displacement (\u{b5}m); Force (kN)\n0;1,5;-0,001\n0,5;-2;0,0025\n1;0,25;3\n",
        "time [s]\tdisplacement [\u{3bc}m]\tforce [mN]\n0\t1,5\t-1000\n0,5\t-2\t2500\n1\t0,25\t3000000\n",
        "  time [ms]  displacement [nm]  force [N]\n  0   1500  -1\n 500  -2000 2.5\n 1000 250   3000\n",
        "# rig 3\n\ntime [s],displacement [um],force [N]\n# warm\n0,1.5,-1\n\n0.5,-2,2.5\n1,0.25,3e3",
        "\"time [s]\",\"displacement [um]\",\"force [N]\"\n\"0\",\"1.5\",\"-1\"\n0.5,-2,2.5\n1,0.25,3e3\n",
        "time,displacement,force\ns,um,N\n0,1.5,-1\n0.5,-2,2.5\n1,0.25,3e3\n",
        "time,displacement,force\n[s],[um],[N]\n0,1.5,\u{2212}1\n0.5,-2,2.5\n1,0.25,3e3\n",
        "f [N],note,d [um],t [s],\n-1,a,1.5,0,\n2.5,b,-2,0.5,\n3e3,,0.25,1,\n",
        "time [s],displacement [um],force [N]\r0,1.5,-1\r0.5,-2,2.5\r1,0.25,3e3\r",
        "t [s],sensor A [um],load cell [N]\n0,1.5,-1\n0.5,-2,2.5\n1,0.25,3e3\n",
    ] {
        is_example(&read(text));
    }
}

#[test]
fn files_are_read_in_the_encodings_of_measuring_software() {
    let text = "time [s],displacement [\u{b5}m],force [N]\n0,1.5,-1\n0.5,-2,2.5\n1,0.25,3e3\n";
    let latin: Vec<u8> = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let little: Vec<u8> =
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> =
        std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect();
    let folder = tempfile::tempdir().unwrap();
    for bytes in [text.as_bytes().to_vec(), latin, little, big] {
        let path = folder.path().join("record.csv");
        std::fs::write(&path, bytes).unwrap();
        is_example(&Record::read(&path, &ReadOptions::default()).unwrap());
    }
    let missing = folder.path().join("missing.csv");
    let error = Record::read(&missing, &ReadOptions::default()).unwrap_err();
    assert!(matches!(&error, RecordError::Unreadable { .. }) && error.to_string().contains("missing.csv"));
    let path = folder.path().join("empty.csv");
    std::fs::write(&path, "").unwrap();
    let error = Record::read(&path, &ReadOptions::default()).unwrap_err().to_string();
    assert!(error.contains("empty.csv: there are no samples"), "{error}");
}

#[test]
fn options_say_what_a_header_does_not() {
    let options = ReadOptions {
        columns: Columns {
            displacement: Some(Column::Number(3)),
            force: Some(Column::Number(1)),
            time: Some(Column::Number(2)),
        },
        units: Units {
            displacement: Some(LengthUnit::Micrometre),
            force: Some(ForceUnit::Newton),
            time: Some(TimeUnit::Second),
        },
        force_sign: ForceSign::Rig,
    };
    is_example(&Record::parse("-1,0,1.5\n2.5,0.5,-2\n3e3,1,0.25\n", &options).unwrap());
    // The same over a header that knows nothing of it, with the reaction's sign.
    let reaction = ReadOptions { force_sign: ForceSign::Reaction, ..options };
    is_example(&Record::parse("a,b,c\n1,0,1.5\n-2.5,0.5,-2\n-3e3,1,0.25\n", &reaction).unwrap());
    // Names, with and without the unit; given units win.
    let named = ReadOptions {
        columns: Columns {
            displacement: Some(Column::Name("LVDT 2 [mm]".into())),
            force: Some(Column::Name("cell b".into())),
            time: None,
        },
        units: Units { displacement: Some(LengthUnit::Micrometre), ..Units::default() },
        force_sign: ForceSign::Rig,
    };
    let text = "time [s],LVDT 1 [mm],LVDT 2 [mm],cell a [N],cell B [N]\n0,9,1.5,9,-1\n0.5,9,-2,9,2.5\n1,9,0.25,9,3e3\n";
    is_example(&Record::parse(text, &named).unwrap());
}

#[test]
fn lines_of_the_samples_are_remembered() {
    let record = read("# a\nd [m],f [N]\n1,2\n\n3,4\n");
    assert_eq!(record.lines, [3, 5]);
    assert_eq!((record.len(), record.is_empty()), (2, false));
}

#[test]
fn every_mistake_is_named_with_its_place_and_a_way_out() {
    let says = |text: &str, words: &[&str]| {
        let message = refused(text);
        for word in words {
            assert!(message.contains(word), "{text:?} gave: {message}");
        }
    };
    says("", &["no samples"]);
    says("# nothing\n\n", &["no samples"]);
    says("d [um],f [N]\n", &["no samples"]);
    says("1,2\n3,4\n", &["line 1 already holds numbers", "--columns displacement=1,force=2"]);
    says("a,b\n1,2\n", &["line 1", "looks like a displacement", "1 `a`, 2 `b`", "--columns displacement=2"]);
    says("a [um],b [mm],f [N]\n1,2,3\n", &["1 `a [um]`, 2 `b [mm]`", "--columns displacement=1"]);
    says("d,f [N]\n1,2\n", &["column 1 (displacement) has no unit", "--units displacement=um"]);
    says("d [um],f [kg]\n1,2\n", &["column 2 (force): `kg` is no unit of force", "lbf"]);
    says("d [um],f [N]\n1,2\n3,abc\n", &["line 3, column 2 (force): `abc` is not a number"]);
    says("d [um],f [N]\n1,2\n3,\n", &["line 3, column 2", "the cell is empty"]);
    says("d [um],f [N]\n1,2\n3\n", &["line 3 has 1 column,", "the force is in column 2"]);
    says("d [um],f [N]\n1,2\nNaN,4\n", &["line 3, column 1 (displacement): `NaN` is not a finite number"]);
    says("d [um],f [kip]\n1,2\n3,-1e308\n", &["line 3, column 2 (force)", "not a finite number"]);
    says("d [um],f [N]\n1,2\n3,inf\n", &["line 3, column 2 (force): `inf`"]);
    says("t [s],d [um],f [N]\n0,1,2\n1,3,4\n0.5,5,6\n", &["line 4, column 1 (time)", "from 1 to 0.5"]);

    let asking = |columns: &str, text: &str, words: &str| {
        let options = ReadOptions { columns: columns.parse().unwrap(), ..ReadOptions::default() };
        let message = Record::parse(text, &options).unwrap_err().to_string();
        assert!(message.contains(words), "{message}");
    };
    asking(
        "force=9",
        "d [um],f [N]\n1,2\n",
        "no column number 9 for the force; the file has 1 `d [um]`, 2 `f [N]`",
    );
    asking("force=cell", "d [um],f [N]\n1,2\n", "no column `cell` for the force");
    asking("force=1", "d [um],f [N]\n1,2\n", "is no unit of force");
    asking("displacement=cell,force=2", "1,2\n3,4\n", "the file has 2 columns and no header");
    let twice = ReadOptions {
        columns: "displacement=1,force=1".parse().unwrap(),
        units: "displacement=um,force=N".parse().unwrap(),
        force_sign: ForceSign::Rig,
    };
    let message = Record::parse("1,2\n3,4\n", &twice).unwrap_err().to_string();
    assert!(message.contains("column 1 would be both the displacement and the force"), "{message}");
    assert!(matches!(Record::new(None, vec![1.0], vec![]), Err(RecordError::Lengths { .. })));
}

proptest! {
    // The same cases every time.
    #![proptest_config(ProptestConfig {
        rng_seed: proptest::test_runner::RngSeed::Fixed(20),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn a_written_record_is_read_back_in_every_unit(
        rows in prop::collection::vec((-1e3..1e3, -1e6..1e6), 1..40),
        length in prop::sample::select(LengthUnit::ALL),
        force in prop::sample::select(ForceUnit::ALL),
        time in prop::sample::select(TimeUnit::ALL),
        timed: bool,
    ) {
        let times = timed.then(|| (0..rows.len()).map(|j| 0.37 * j as f64).collect());
        let (w, f) = rows.into_iter().unzip();
        let record = Record::new(times, w, f).unwrap();
        let again = read(&record.to_csv(length, force, time));
        let near = |a: &[f64], b: &[f64]| {
            // Two roundings: division while writing, multiplication while reading.
            a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 2.5e-16 * a.abs())
        };
        prop_assert!(near(&record.displacement, &again.displacement));
        prop_assert!(near(&record.force, &again.force));
        prop_assert_eq!(record.time.is_some(), again.time.is_some());
        prop_assert!(near(&record.time.unwrap_or_default(), &again.time.unwrap_or_default()));
    }

    #[test]
    fn no_text_is_too_odd(text in "(?s).{0,200}") {
        let _ = Record::parse(&text, &ReadOptions::default());
    }

    #[test]
    fn nothing_that_looks_like_a_table_is_too_odd(
        text in "([a-z\\[\\]()\"; ,\t#\r\u{b5}]{0,12}[,;\t ]){0,4}(\n([-+.,0-9eENa\" ]{0,6}[,;\t ]?){0,4}){0,8}",
        columns in prop::option::of((0_usize..6, 0_usize..6)),
    ) {
        let mut options = ReadOptions {
            units: "displacement=um,force=N,time=s".parse().unwrap(),
            ..ReadOptions::default()
        };
        if let Some((displacement, force)) = columns {
            options.columns.displacement = Some(Column::Number(displacement));
            options.columns.force = Some(Column::Number(force));
        }
        if let Ok(record) = Record::parse(&text, &options) {
            prop_assert_eq!(record.displacement.len(), record.force.len());
            prop_assert!(record.displacement.iter().chain(&record.force).all(|x| x.is_finite()));
        }
    }

    #[test]
    fn no_bytes_are_too_odd(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), bytes).unwrap();
        let _ = Record::read(file.path(), &ReadOptions::default());
    }
}
