//! A progress bar on standard error, for work that takes longer than a second; and Ctrl-C.

use std::io::{self, IsTerminal};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use scene::{Prepared, Problem, Scene, SceneError};

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

/// A line on standard error about set-up that takes longer than a second; it goes when this is dropped.
pub struct Waiting {
    words: Option<Sender<String>>,
    thread: Option<JoinHandle<()>>,
}

impl Waiting {
    /// Begins to wait for `what`; nothing is shown when nobody watches.
    pub fn new(what: impl Into<String>) -> Self {
        if !io::stderr().is_terminal() {
            return Self { words: None, thread: None };
        }
        let (words, heard) = channel();
        let first = what.into();
        let thread = std::thread::spawn(move || show(first, &heard));
        Self { words: Some(words), thread: Some(thread) }
    }

    /// What is being done by now.
    pub fn step(&self, progress: scene::Progress) {
        use scene::Progress::{Checking, ConstraintModes, Factorising, Modes};
        let Some(words) = &self.words else { return };
        let text = match progress {
            Factorising => "reducing the structure: factorising its stiffness".to_owned(),
            ConstraintModes => "reducing the structure: static shapes of the kept dofs".to_owned(),
            Modes { found, of } => format!("reducing the structure: {found} of {of} modes"),
            Checking { done, of } => {
                format!("reducing the structure: compared with the full one at {done} of {of} frequencies")
            }
        };
        // A line that is gone needs no words.
        let _ = words.send(text);
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.words = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Keeps the line alive until nobody speaks any more.
fn show(mut text: String, heard: &Receiver<String>) {
    let began = Instant::now();
    let mut line: Option<ProgressBar> = None;
    loop {
        match heard.recv_timeout(Duration::from_millis(100)) {
            Ok(words) => text = words,
            Err(RecvTimeoutError::Timeout) if began.elapsed() > PATIENCE => {
                let line = line.get_or_insert_with(ProgressBar::new_spinner);
                line.set_message(format!("{text} ({:.0} s)", began.elapsed().as_secs_f64()));
                line.tick();
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    if let Some(line) = line {
        line.finish_and_clear();
    }
}

/// Makes a scene ready to be solved.
pub fn prepared(scene: &Scene) -> Result<Prepared<'_>, SceneError> {
    let waiting = Waiting::new("making the scene ready");
    scene.prepare_with(&mut |progress| waiting.step(progress))
}

/// Makes a scene's problem, its structure reduced where that is needed.
pub fn posed(scene: &Scene) -> Result<&Problem, SceneError> {
    let waiting = Waiting::new("making the scene ready");
    scene.problem_with(&mut |progress| waiting.step(progress))
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
