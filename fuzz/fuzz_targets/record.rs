//! Any bytes are a record or an error, in every format of a record; a record has a loop or an error.

#![no_main]

use hysteresis::{FitSettings, ReadOptions, Record};
use libfuzzer_sys::fuzz_target;

fn check(bytes: &[u8], options: &ReadOptions) {
    match Record::from_bytes(bytes, options) {
        Ok(record) => match hysteresis::fit(&record, &FitSettings::default()) {
            Ok(fit) => assert!(fit.hysteresis_loop.displacement_amplitude() > 0.0 && fit.noise >= 0.0),
            Err(error) => assert!(!error.to_string().is_empty()),
        },
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

fuzz_target!(|bytes: &[u8]| {
    check(bytes, &ReadOptions::default());
    // What has no names and no units needs them.
    if let (Ok(columns), Ok(units)) =
        ("displacement=1,force=2".parse(), "displacement=um,force=N,time=s".parse())
    {
        check(bytes, &ReadOptions { columns, units, ..ReadOptions::default() });
    }
});
