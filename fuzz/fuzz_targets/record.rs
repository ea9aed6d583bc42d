//! Any bytes are a record or an error; a record has a loop or an error.

#![no_main]

use hysteresis::{FitSettings, ReadOptions, Record};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    match Record::parse(&text, &ReadOptions::default()) {
        Ok(record) => match hysteresis::fit(&record, &FitSettings::default()) {
            Ok(fit) => assert!(fit.hysteresis_loop.displacement_amplitude() > 0.0 && fit.noise >= 0.0),
            Err(error) => assert!(!error.to_string().is_empty()),
        },
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
