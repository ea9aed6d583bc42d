//! Image files: SVG as it is, PNG by resvg; whole or not at all.

use std::ffi::OsString;
use std::path::Path;
use std::{fs, process};

use anyhow::{Context, Result, anyhow, bail};
use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// Resolution of a PNG.
const DOTS_PER_INCH: f32 = 300.0;

/// What a figure file is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ImageFormat {
    /// Scalable.
    Svg,
    /// 300 dots an inch.
    Png,
}

impl ImageFormat {
    /// The format that the extension of `path` asks for.
    ///
    /// # Errors
    /// When the extension is neither `.svg` nor `.png`.
    pub fn of(path: &Path) -> Result<Self> {
        let extension = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match extension.as_str() {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            _ => bail!("{}: a figure is a .svg or a .png file", path.display()),
        }
    }
}

/// Writes a drawing ([`sheet()`](crate::sheet())) to `path`, `.svg` or `.png`.
///
/// # Errors
/// Another extension, or a file that cannot be written; then `path` is as it was.
pub fn write(svg: &str, path: &Path) -> Result<()> {
    let bytes = match ImageFormat::of(path)? {
        ImageFormat::Svg => svg.as_bytes().to_vec(),
        ImageFormat::Png => rasterise(svg, &fonts())?.encode_png()?,
    };
    replace(path, &bytes).with_context(|| format!("{}: cannot be written", path.display()))
}

/// The fonts of all PNG: those of this program, never those of the machine.
fn fonts() -> fontdb::Database {
    let mut fonts = fontdb::Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    fonts
}

fn rasterise(svg: &str, fonts: &fontdb::Database) -> Result<Pixmap> {
    let options = Options { fontdb: std::sync::Arc::new(fonts.clone()), ..Options::default() };
    let tree = Tree::from_str(svg, &options).context("the figure is not valid SVG")?;
    let scale = DOTS_PER_INCH / options.dpi;
    let pixels = |length: f32| (length * scale).ceil() as u32;
    let size = tree.size();
    let mut image = Pixmap::new(pixels(size.width()), pixels(size.height()))
        .ok_or_else(|| anyhow!("the figure is too large for a PNG"))?;
    image.fill(Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut image.as_mut());
    Ok(image)
}

/// Writes beside `path` and renames, so that nobody ever sees half a file.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let mut name = OsString::from(".");
    name.push(path.file_name().unwrap_or_default());
    name.push(format!(".{}", process::id()));
    let beside = path.with_file_name(name);
    fs::write(&beside, bytes).and_then(|()| fs::rename(&beside, path)).inspect_err(|_| {
        // The error that matters is the one above.
        let _ = fs::remove_file(&beside);
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORDS: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"10mm\" viewBox=\"0 0 160 40\" \
                         font-family=\"DejaVu Sans, Verdana\"><text x=\"5\" y=\"25\" font-size=\"20\">10⁻⁶ µm ψ −1</text></svg>";

    fn ink(image: &Pixmap) -> usize {
        image.pixels().iter().filter(|p| p.red() < 128).count()
    }

    #[test]
    fn text_is_drawn_without_any_font_on_the_machine() {
        let with = rasterise(WORDS, &fonts()).unwrap();
        let without = rasterise(WORDS, &fontdb::Database::new()).unwrap();
        assert_eq!(ink(&without), 0);
        assert!(ink(&with) > 1000, "{} dark pixels", ink(&with));
    }

    #[test]
    fn a_png_has_print_resolution() {
        let image = rasterise(WORDS, &fonts()).unwrap();
        let dots_per_inch = f64::from(image.width()) / 40.0 * 25.4;
        assert!((dots_per_inch - 300.0).abs() < 1.0, "{dots_per_inch}");
    }

    #[test]
    fn other_extensions_are_refused() {
        for name in ["a.pdf", "a", "a.jpeg", ".svg"] {
            let error = ImageFormat::of(Path::new(name)).unwrap_err().to_string();
            assert!(error.contains(".svg") && error.contains(".png"), "{error}");
        }
        assert_eq!(ImageFormat::of(Path::new("A.PNG")).unwrap(), ImageFormat::Png);
    }

    #[test]
    fn nothing_is_left_behind_when_a_file_cannot_be_written() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("taken.svg");
        fs::create_dir(&target).unwrap();
        assert!(write(WORDS, &target).is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(write(WORDS, &folder.path().join("no/such/folder.svg")).is_err());
    }
}
