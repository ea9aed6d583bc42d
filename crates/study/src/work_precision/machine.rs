//! What a time was measured on.

use std::fs;

use serde::{Deserialize, Serialize};

/// A computer and a compiler.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Logical cores.
    pub cores: usize,
    /// Operating system and architecture.
    pub os: String,
    /// Version of the compiler.
    pub rustc: String,
}

impl Machine {
    /// This one; the compiler's version is what the caller knows of it.
    pub fn here(rustc: String) -> Self {
        Self {
            cpu: cpu().unwrap_or_else(|| "unknown processor".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, |cores| cores.get()),
            os: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            rustc,
        }
    }
}

/// Where the system tells it.
fn cpu() -> Option<String> {
    let text = fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    let name = line.split_once(':')?.1.split_whitespace().collect::<Vec<_>>().join(" ");
    (!name.is_empty()).then_some(name)
}
