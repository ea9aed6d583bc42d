//! What a study's results depend on, in a few letters: so that half a result is never continued with another study.

use std::fmt;
use std::path::{Path, PathBuf};

/// Names the contents of a study's file, its scene and its records (FNV-1a, 64 bits).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Of a study's text and the files it leads to; a file that cannot be read counts as empty.
    pub(crate) fn of(text: &str, scene: &Path, records: &[PathBuf]) -> Self {
        let version = Self::default().and(env!("CARGO_PKG_VERSION").as_bytes()).and(text.as_bytes());
        let files = std::iter::once(scene).chain(records.iter().map(PathBuf::as_path));
        files.fold(version, |sum, file| sum.and(&std::fs::read(file).unwrap_or_default()))
    }

    /// With another text after it; its length counts, so that texts cannot run into each other.
    fn and(self, bytes: &[u8]) -> Self {
        let length = (bytes.len() as u64).to_le_bytes();
        let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        Self(length.iter().chain(bytes).fold(self.0, step))
    }
}

impl fmt::Display for Fingerprint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::Fingerprint;

    #[test]
    fn other_texts_have_other_fingerprints() {
        let of =
            |texts: &[&str]| texts.iter().fold(Fingerprint::default(), |sum, text| sum.and(text.as_bytes()));
        assert_eq!(of(&["ab", "c"]), of(&["ab", "c"]));
        assert_ne!(of(&["ab", "c"]), of(&["a", "bc"]));
        assert_ne!(of(&["ab"]), of(&["ba"]));
        assert_eq!(of(&[]).to_string(), "cbf29ce484222325");
    }
}
