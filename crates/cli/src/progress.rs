//! A progress bar on standard error, for work that takes longer than a second; and Ctrl-C.

use std::io::{self, IsTerminal};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::ending::say;

/// Work shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar that appears when it is worth it.
pub struct Progress {
    began: Instant,
    points: usize,
    what: &'static str,
    watched: bool,
    bar: OnceLock<ProgressBar>,
}

impl Progress {
    /// A bar for this many points; none when nobody watches.
    pub fn new(points: usize) -> Self {
        Self::of(points, "points")
    }

    /// A bar for something else than points.
    pub fn of(points: usize, what: &'static str) -> Self {
        Self {
            began: Instant::now(),
            points,
            what,
            watched: io::stderr().is_terminal(),
            bar: OnceLock::new(),
        }
    }

    /// So many points are finished.
    pub fn finished(&self, points: usize) {
        if self.watched && self.began.elapsed() > PATIENCE {
            self.bar.get_or_init(|| self.draw()).set_position(points as u64);
        }
    }

    fn draw(&self) -> ProgressBar {
        let bar = ProgressBar::new(self.points as u64);
        let style =
            ProgressStyle::with_template(&format!("{{bar:40}} {{pos}}/{{len}} {}, {{eta}} left", self.what));
        bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
    }

    /// Takes the bar away.
    pub fn clear(&self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// A flag that Ctrl-C raises. The second Ctrl-C ends the program at once.
pub fn interrupt() -> &'static AtomicBool {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        say(format_args!("stopping; finished points are kept (Ctrl-C again to quit at once)"));
    };
    // Without a handler Ctrl-C simply ends the program.
    let _ = ctrlc::set_handler(handler);
    &INTERRUPTED
}
