//! The short answer for a terminal: peaks, worst points, statuses, notes, time.

use std::fmt::Write as _;

use comfy_table::{CellAlignment, ContentArrangement, LineStyle, Table, presets};
use scene::{Outcome, Peak, Point, Responses, Solved};

use crate::check::count;
use crate::ending::Failure;
use crate::output;

/// Points in the list of the worst.
const WORST: usize = 3;

/// Prints the table.
pub fn print(solved: &Solved, outcome: &Outcome) -> Result<(), Failure> {
    output::print(&text(&solved.responses(), outcome, solved.interrupted())).map(|_| ())
}

fn text(responses: &Responses, outcome: &Outcome, interrupted: bool) -> String {
    let mut text = format!("{}\n", heading(outcome));
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}", peaks(responses));
    let _ = writeln!(text, "{}", statuses(&outcome.points, interrupted));
    for line in worst(&outcome.points) {
        let _ = writeln!(text, "{line}");
    }
    for note in &outcome.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let timing = &outcome.timing;
    let threads = count(timing.threads, "thread", "threads");
    let _ = writeln!(
        text,
        "time: {} to read and plan, {} to solve on {threads}",
        duration(timing.setup_s),
        duration(timing.solve_s)
    );
    text
}

fn heading(outcome: &Outcome) -> String {
    let ends = outcome.points.first().zip(outcome.points.last());
    let range = match ends {
        Some((first, last)) if outcome.points.len() > 1 => {
            format!("{} points from {} to {} Hz", outcome.points.len(), first.frequency, last.frequency)
        }
        Some((only, _)) => format!("{} Hz", only.frequency),
        None => "no point".into(),
    };
    let harmonics = || outcome.points.iter().map(|point| point.harmonics);
    let (least, most) = (harmonics().min().unwrap_or(0), harmonics().max().unwrap_or(0));
    let harmonics = if least == most { most.to_string() } else { format!("{least} to {most}") };
    format!("{}: {range}, N = {harmonics}", outcome.scene)
}

fn peaks(responses: &Responses) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::NOTHING.header_separator(LineStyle::none().fill('─').junction('─')))
        .set_content_arrangement(ContentArrangement::Disabled);
    let amplitude = format!("|W_{}| [m]", responses.harmonic);
    let without = format!("{amplitude} without");
    table.set_header(["dof", "peak [Hz]", &amplitude, "without contact forces [Hz]", &without, "reduction"]);
    for response in &responses.responses {
        for resonance in response.resonances() {
            let [hertz, metres] = peak(resonance.contact);
            let [linear_hertz, linear_metres] = peak(resonance.linear);
            let reduction = resonance.reduction().map_or("-".into(), |part| format!("{:.1} %", 100.0 * part));
            table.add_row([response.dof.clone(), hertz, metres, linear_hertz, linear_metres, reduction]);
        }
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn peak(peak: Option<Peak>) -> [String; 2] {
    peak.map_or(["-".into(), "-".into()], |peak| {
        [format!("{:.4}", peak.frequency), format!("{:.4e}", peak.amplitude)]
    })
}

fn statuses(points: &[Point], interrupted: bool) -> String {
    let of = |status: &str| points.iter().filter(|point| point.status == status).count();
    let counts = ["converged", "stuck", "failed"].map(|status| (status, of(status)));
    let present = counts.iter().filter(|(_, number)| *number > 0);
    let list: Vec<String> = present.map(|(status, number)| format!("{number} {status}")).collect();
    let stopped = if interrupted { "; stopped before the last point" } else { "" };
    format!("points: {}{stopped}", if list.is_empty() { "none".into() } else { list.join(", ") })
}

/// Failed points and why; without any, the largest residual and the longest iteration.
fn worst(points: &[Point]) -> Vec<String> {
    let failed: Vec<&Point> = points.iter().filter(|point| point.reason.is_some()).collect();
    let mut lines: Vec<String> = (failed.iter().take(WORST))
        .map(|point| {
            format!("failed at {} Hz: {}", point.frequency, point.reason.as_deref().unwrap_or_default())
        })
        .collect();
    if failed.len() > WORST {
        lines.push(format!("and {} more; -o FILE.json has the reason of each", failed.len() - WORST));
    }
    let solved = || points.iter().filter(|point| point.reason.is_none());
    let largest = solved().max_by(|a, b| a.residual.total_cmp(&b.residual));
    if let Some(point) = largest.filter(|point| point.residual > 0.0) {
        lines.push(format!("worst residual: {:.1e} at {} Hz", point.residual, point.frequency));
    }
    let error = |point: &Point| point.truncation_error.unwrap_or(-1.0);
    let largest = solved().max_by(|a, b| error(a).total_cmp(&error(b)));
    if let Some((point, error)) = largest.and_then(|point| Some((point, point.truncation_error?))) {
        let (n, at) = (point.harmonics, point.frequency);
        lines.push(format!("worst truncation error (estimate): {error:.1e} at {at} Hz with N = {n}"));
    }
    if let Some(point) = solved().max_by_key(|point| point.iterations).filter(|point| point.iterations > 1) {
        lines.push(format!("most iterations: {} at {} Hz", point.iterations, point.frequency));
    }
    lines
}

/// Three digits in a readable unit.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => format!("{:.0} µs", 1e6 * s),
        s if s < 1.0 => format!("{:.1} ms", 1e3 * s),
        s => format!("{s:.2} s"),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use scene::{RunOptions, Scene};

    use super::{duration, text};

    fn table(stiffness: f64, frequencies: &str) -> String {
        let scene = format!(
            r#"{{"name": "one", "model": {{"dofs": ["w"], "mass": [[1]], "damping": [[1]], "stiffness": [[{stiffness}]]}},
                 "excitation": [{{"dof": "w", "amplitude": 1}}, {{"dof": "w", "amplitude": 1, "harmonic": 0}}],
                 "contacts": [{{"name": "c", "between": ["w", "ground"], "law": {{"type": "linear", "stiffness": 0}}}}],
                 "frequencies": {frequencies}}}"#
        );
        let scene = Scene::from_str(&scene, Path::new(".")).unwrap();
        let prepared = scene.prepare().unwrap();
        let solved = prepared.solve(&RunOptions::default());
        text(&solved.responses(), &solved.outcome(), false)
    }

    #[test]
    fn it_names_peaks_statuses_and_time() {
        let text = table(39.4784, r#"{"from": 0.5, "to": 1.5, "step": 0.1}"#);
        assert!(text.starts_with("one: 11 points from 0.5 to 1.5 Hz, N = 1\n"), "{text}");
        let row = text.lines().find(|line| line.starts_with(" w")).unwrap();
        assert!(row.contains(" 1.0000 ") && row.contains("0.0 %"), "{text}");
        assert!(text.contains("\npoints: 11 converged\n"), "{text}");
        assert!(text.lines().last().unwrap().starts_with("time: "), "{text}");
    }

    #[test]
    fn it_says_why_points_failed() {
        let text = table(0.0, "[0]");
        assert!(text.starts_with("one: 0 Hz, N = 1\n"), "{text}");
        assert!(text.contains("points: 1 failed\nfailed at 0 Hz: "), "{text}");
    }

    #[test]
    fn durations_are_readable() {
        assert_eq!([3e-6, 0.25, 12.0].map(duration), ["3 µs", "250.0 ms", "12.00 s"]);
    }
}
