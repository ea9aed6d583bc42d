//! A folder as `.tar.gz`, the same bytes for the same files, and SHA-256 sums.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use flate2::{Compression, GzBuilder};
use sha2::{Digest, Sha256};
use tar::{Builder, EntryType, Header};

/// Packs `folder` into `archive`, under the folder's own name. Names are sorted, owners left out, and every file is of `time`,
/// seconds since 1970.
///
/// # Errors
/// What cannot be read or written.
pub(crate) fn pack(folder: &Path, archive: &Path, time: u64) -> Result<()> {
    let name = folder.file_name().context("a folder without a name")?;
    let file = File::create(archive).with_context(|| archive.display().to_string())?;
    let mut tar = Builder::new(GzBuilder::new().mtime(0).write(file, Compression::best()));
    for path in files(folder)? {
        let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
        let mut header = Header::new_gnu();
        header.set_entry_type(EntryType::Regular);
        header.set_size(bytes.len() as u64);
        header.set_mode(if is_executable(&path)? { 0o755 } else { 0o644 });
        header.set_mtime(time);
        tar.append_data(&mut header, Path::new(name).join(path.strip_prefix(folder)?), bytes.as_slice())?;
    }
    tar.into_inner()?.finish()?.flush()?;
    Ok(())
}

/// Unpacks `archive` into `folder`.
///
/// # Errors
/// What cannot be read or written.
pub(crate) fn unpack(archive: &Path, folder: &Path) -> Result<()> {
    let file = File::open(archive).with_context(|| archive.display().to_string())?;
    tar::Archive::new(flate2::read::GzDecoder::new(file)).unpack(folder).context("the archive")
}

/// All files below a folder, sorted.
fn files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    let mut waiting = vec![folder.to_owned()];
    while let Some(folder) = waiting.pop() {
        for entry in std::fs::read_dir(&folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            if path.is_dir() { waiting.push(path) } else { found.push(path) }
        }
    }
    found.sort();
    Ok(found)
}

#[cfg(unix)]
fn is_executable(path: &Path) -> io::Result<bool> {
    use std::os::unix::fs::PermissionsExt;
    Ok(path.metadata()?.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_executable(path: &Path) -> io::Result<bool> {
    Ok(path.extension().is_some_and(|extension| extension == "exe"))
}

/// The sum of a file in hexadecimal digits, as `sha256sum` prints it.
///
/// # Errors
/// When it cannot be read.
pub(crate) fn sha256(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|mut file| file.read_to_end(&mut bytes))
        .with_context(|| path.display().to_string())?;
    Ok(Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect())
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::{pack, sha256, unpack};

    /// The example of FIPS 180-2, appendix B.1.
    #[test]
    fn a_sum_is_that_of_the_standard() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        fs::write(&path, "abc").unwrap();
        assert_eq!(
            sha256(&path).unwrap(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
        );
    }

    /// Written in another order and later, the archive is the same, and it holds what was packed.
    #[test]
    fn an_archive_depends_on_its_files_alone() {
        let contents = [("a/two", "2"), ("b", "three"), ("a/one", "1")];
        let (folder, mut sums) = (tempfile::tempdir().unwrap(), Vec::new());
        for (place, order) in [("first", [0, 1, 2]), ("second", [2, 0, 1])] {
            let packed = folder.path().join(place).join("packed");
            fs::create_dir_all(packed.join("a")).unwrap();
            for i in order {
                let (name, text) = contents[i];
                fs::write(packed.join(name), text).unwrap();
            }
            let archive = folder.path().join(format!("{place}.tar.gz"));
            pack(&packed, &archive, 1_500_000_000).unwrap();
            sums.push(sha256(&archive).unwrap());
            // A file of another time.
            let file = fs::File::options().write(true).open(packed.join("b")).unwrap();
            file.set_modified(std::time::UNIX_EPOCH).unwrap();
            pack(&packed, &archive, 1_500_000_000).unwrap();
            sums.push(sha256(&archive).unwrap());
        }
        assert!(sums.iter().all(|sum| *sum == sums[0]), "{sums:?}");
        let out = folder.path().join("out");
        unpack(&folder.path().join("first.tar.gz"), &out).unwrap();
        for (name, text) in contents {
            assert_eq!(fs::read_to_string(out.join("packed").join(name)).unwrap(), text);
        }
    }
}
