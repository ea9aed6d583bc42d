//! `--plot`: from results to the drawing module, where this build has it.

use std::path::{Path, PathBuf};

use contact::identification::Identification;
#[cfg(feature = "plot")]
use contact::identification::Magnitude;
use hysteresis::{Fit, Record};
use scene::{BackboneOutcome, CurveOutcome, PeaksOutcome, Scene, Solved};
use study::Truncation;

use crate::ending::Failure;
use crate::orbit::Motion;
use crate::output::unwritable;
use crate::study::Picture;

/// A picture that can be drawn: its file has a known form and a folder to lie in.
#[derive(Debug)]
pub struct Figure(PathBuf);

impl Figure {
    /// Checks before any work what can be checked.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        if cfg!(not(feature = "plot")) {
            return Err(Failure::input(
                "--plot: this build draws no pictures; build it with the feature \"plot\", or draw the JSON result with a tool of yours",
            ));
        }
        let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
        if !matches!(extension.as_deref(), Some("svg" | "png")) {
            return Err(Failure::input(format!("--plot {}: name the file .svg or .png", path.display())));
        }
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        if path.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
            return Err(unwritable(path, "there is no such folder, or it is one itself"));
        }
        Ok(Self(path.to_owned()))
    }
}

/// Draws the response of every output dof.
#[cfg(feature = "plot")]
pub fn response(figure: Figure, scene: &Scene, solved: &Solved) -> Result<(), Failure> {
    use plot::{Panel, Response, write_response};

    let responses = solved.responses();
    let panels: Vec<Panel> = (responses.responses.into_iter())
        .map(|response| Panel {
            title: response.dof,
            contact: response.contact,
            linear: response.linear,
            extrapolated: responses.extrapolated.clone(),
            unstable: responses.unstable.clone(),
        })
        .collect();
    let known = panels.iter().flat_map(|panel| panel.contact.iter().chain(&panel.linear));
    if known.filter_map(|(_, amplitude)| *amplitude).next().is_none() {
        crate::ending::say(format_args!("no picture was drawn: no point was solved"));
        return Ok(());
    }
    let quantity = format!("|W_{}|", responses.harmonic);
    let drawing = Response { title: scene.name().to_owned(), panels, quantity };
    write_response(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

/// Loops that one sheet holds.
#[cfg(feature = "plot")]
const LOOPS: usize = 12;

/// Draws friction force against relative displacement: of contacts in several directions the tangential ones.
#[cfg(feature = "plot")]
pub fn contact_loops(figure: Figure, scene: &Scene, motion: &scene::Motion) -> Result<(), Failure> {
    use plot::{ContactLoop, ContactLoops, write_contact_loops};

    let mut loops = Vec::new();
    for contact in scene.contact_motions(&motion.waveform) {
        // The normal direction comes last; what contacts in one direction have is the whole of it.
        let tangential = contact.directions.len().saturating_sub(1).max(1);
        for direction in contact.directions.iter().take(tangential) {
            // As a rig would measure it: against the force on the first body.
            let points = direction.displacement.iter().zip(direction.force).map(|(w, f)| (*w, -f)).collect();
            loops.push(ContactLoop {
                title: [contact.name, direction.name].join(" ").trim_end().to_owned(),
                points,
            });
        }
    }
    if loops.len() > LOOPS {
        crate::ending::say(format_args!("note: --loops draws the first {LOOPS} of {} loops", loops.len()));
        loops.truncate(LOOPS);
    }
    if loops.is_empty() {
        crate::ending::say(format_args!("no loops were drawn: the scene has no contact"));
        return Ok(());
    }
    let drawing = ContactLoops { title: scene.name().to_owned(), loops };
    write_contact_loops(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

#[cfg(not(feature = "plot"))]
pub fn contact_loops(figure: Figure, _: &Scene, _: &scene::Motion) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

/// Draws the averaged cycle of a record and the series fitted to it.
#[cfg(feature = "plot")]
pub fn hysteresis_loop(figure: Figure, record: &Record, fit: &Fit) -> Result<(), Failure> {
    use plot::{LoopPlot, write_loop};

    let a = fit.hysteresis_loop.displacement_amplitude();
    let cycle = &fit.mean_cycle;
    let steady = |values: &[f64]| values.get(fit.steady_samples.clone()).unwrap_or_default().to_vec();
    let (w, f) = (steady(&record.displacement), steady(&record.force));
    let drawing = LoopPlot {
        title: String::new(),
        measured: cycle.displacement.iter().copied().zip(cycle.force.iter().copied()).collect(),
        fitted: cycle
            .theta
            .iter()
            .map(|&theta| (a * theta.cos(), fit.hysteresis_loop.force(theta)))
            .collect(),
        record: w
            .into_iter()
            .map(|w| w - fit.displacement_mean)
            .zip(f.into_iter().map(|f| f - fit.force_mean))
            .collect(),
    };
    write_loop(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

/// Draws loops and the scaling laws over the amplitude.
#[cfg(feature = "plot")]
pub fn scaling(figure: Figure, found: &Identification) -> Result<(), Failure> {
    use plot::{ScalingPlot, write_scaling};

    let drawing = ScalingPlot {
        force: match found.kind {
            Magnitude::TurningPoints => "turning-point force / F*",
            Magnitude::FirstHarmonic => "first harmonic / F*",
        },
        magnitudes: found.points.iter().map(|point| (point.alpha, point.magnitude)).collect(),
        phases: found.points.iter().map(|point| (point.alpha, point.phase)).collect(),
        magnitude: Box::new(|alpha| found.magnitude.law.value(alpha)),
        phase: Box::new(|alpha| found.phase.law.value(alpha)),
    };
    write_scaling(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

/// Draws errors against the number of harmonics.
#[cfg(feature = "plot")]
pub fn truncation(figure: Figure, study: &Truncation, required: Option<f64>) -> Result<(), Failure> {
    use plot::{TruncationPlot, write_truncation};

    if study.rows.iter().all(|row| row.error.is_none()) {
        crate::ending::say(format_args!("no picture was drawn: no error is known"));
        return Ok(());
    }
    let rows = study.rows.chunks(study.harmonics.len().max(1)).zip(&study.rates);
    let curve = |(rows, rate): (&[study::Row], &study::Rate)| {
        let points = rows.iter().map(|row| (row.harmonics, row.error)).collect();
        (format!("{} Hz", rate.frequency), points)
    };
    let drawing = TruncationPlot {
        title: study.scene.clone(),
        curves: rows.map(curve).collect(),
        // What stick and slip make of a displacement: W_k ~ k^-4.
        slope: Some((-3.5, "(N+1)⁻³·⁵")),
        required,
    };
    write_truncation(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

/// Draws displacements and contact forces of an orbit over its period.
#[cfg(feature = "plot")]
pub fn orbit(figure: Figure, motion: &Motion) -> Result<(), Failure> {
    use plot::{OrbitPanel, OrbitPlot, write_orbit};

    let period = motion.orbit.period();
    let times: Vec<f64> = motion.instants().chain([period]).collect();
    let over = |value: &dyn Fn(f64) -> f64| times.iter().map(|t| (t / period, value(*t))).collect();
    let dofs = motion.dofs().map(|(name, dof)| OrbitPanel {
        title: name.to_owned(),
        quantity: ("displacement", "m"),
        values: over(&|t| motion.orbit.displacement(dof, t)),
        events: Vec::new(),
    });
    let events = motion.orbit.events();
    let forces = motion.forces();
    let contacts = forces.iter().map(|force| {
        let at = |t: f64| motion.force(force, t);
        OrbitPanel {
            title: format!("{}, on its first body", force.name),
            quantity: ("force", "N"),
            values: over(&at),
            events: (events.iter().filter(|event| event.contact == force.contact))
                .map(|event| (event.time / period, at(event.time)))
                .collect(),
        }
    });
    let drawing = OrbitPlot {
        title: format!("{} at {} Hz", motion.scene.name(), motion.frequency),
        panels: dofs.chain(contacts).collect(),
    };
    write_orbit(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

/// Draws a response curve with its folds.
#[cfg(feature = "plot")]
pub fn curve(figure: Figure, curve: &CurveOutcome) -> Result<(), Failure> {
    use plot::{CurvePanel, CurvePlot, write_curve};

    let known =
        |dof: usize, point: &scene::CurveOutcomePoint| Some((point.parameter, curve.amplitude(dof, point)?));
    let panel = |(dof, name): (usize, &String)| CurvePanel {
        title: name.clone(),
        points: curve.points.iter().filter_map(|point| known(dof, point)).collect(),
        unstable: (curve.points.iter().filter(|point| known(dof, point).is_some()))
            .map(|point| point.point.is_unstable())
            .collect(),
        folds: curve.points.iter().filter(|point| point.fold).filter_map(|point| known(dof, point)).collect(),
    };
    let drawing = CurvePlot {
        title: curve.scene.clone(),
        parameter: match curve.parameter.as_str() {
            "frequency" => "frequency (Hz)".into(),
            pointer => pointer.into(),
        },
        panels: curve.dofs.iter().enumerate().map(panel).collect(),
        quantity: "|W_1|".into(),
    };
    write_curve(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

#[cfg(not(feature = "plot"))]
pub fn curve(figure: Figure, _: &CurveOutcome) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

/// Draws natural frequency and damping ratio over the amplitude.
#[cfg(feature = "plot")]
pub fn backbone(figure: Figure, mode: &BackboneOutcome) -> Result<(), Failure> {
    use plot::{BackbonePlot, write_backbone};

    let drawing = BackbonePlot {
        title: format!("{}, mode {}", mode.scene, mode.mode),
        amplitude: format!("|W_1| of {}", mode.dof),
        points: mode.points.iter().map(|p| (p.amplitude, p.point.frequency, p.damping_ratio)).collect(),
        expected: mode.expected.map(|e| (e.amplitude, e.natural_frequency, e.damping_ratio)),
    };
    write_backbone(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

#[cfg(not(feature = "plot"))]
pub fn backbone(figure: Figure, _: &BackboneOutcome) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

/// Draws the highest peak and its frequency over an entry.
#[cfg(feature = "plot")]
pub fn peaks(figure: Figure, found: &PeaksOutcome) -> Result<(), Failure> {
    use plot::{HighestPeak, PeakPlot, PeakPlotCurve, write_peaks};

    let highest = |point: &scene::PeaksPoint| {
        let peak = point.highest()?;
        let (frequency, amplitude) = (peak.point.frequency, peak.amplitude);
        Some(HighestPeak { branch: peak.branch, frequency, amplitude })
    };
    let lowest = |optimum: &scene::PeaksOptimum| Some((optimum.point.parameter, highest(&optimum.point)?));
    let curve = |curve: &scene::PeaksCurve| PeakPlotCurve {
        name: format!("N = {}", curve.harmonics),
        points: curve.points.iter().map(|point| (point.parameter, highest(point))).collect(),
        optimum: curve.optimum.as_ref().and_then(lowest),
    };
    let drawing = PeakPlot {
        title: found.scene.clone(),
        parameter: found.parameter.clone(),
        logarithmic: found.logarithmic,
        quantity: format!("peak of |W_{}| of {}", found.harmonic, found.dof),
        curves: found.curves.iter().map(curve).collect(),
    };
    write_peaks(&drawing, &figure.0).map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

#[cfg(not(feature = "plot"))]
pub fn peaks(figure: Figure, _: &PeaksOutcome) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

/// Draws a quantity over one varied entry or over two.
#[cfg(feature = "plot")]
pub fn study(figure: Figure, picture: Picture) -> Result<(), Failure> {
    use plot::{HeatMap, Parameter, ParameterPlot, write_heat_map, write_parameter};

    let parameter = |axis: &study::Axis| Parameter {
        label: axis.pointer.clone(),
        values: axis.values.clone(),
        logarithmic: axis.logarithmic,
    };
    let Picture { axes, quantity, curves } = picture;
    let drawn = match (axes, curves) {
        ([x, y], curves) => {
            let values = curves.into_iter().next_back().map(|(_, values)| values).unwrap_or_default();
            let cells = values.chunks(y.values.len()).map(<[_]>::to_vec).collect();
            write_heat_map(&HeatMap { x: parameter(x), y: parameter(y), quantity, cells }, &figure.0)
        }
        ([x], curves) => write_parameter(&ParameterPlot { x: parameter(x), quantity, curves }, &figure.0),
        _ => return Ok(()),
    };
    drawn.map_err(|error| unwritable(&figure.0, format!("{error:#}")))
}

#[cfg(not(feature = "plot"))]
pub fn study(figure: Figure, _: Picture) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

#[cfg(not(feature = "plot"))]
pub fn truncation(figure: Figure, _: &Truncation, _: Option<f64>) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

#[cfg(not(feature = "plot"))]
pub fn orbit(figure: Figure, _: &Motion) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

#[cfg(not(feature = "plot"))]
pub fn scaling(figure: Figure, _: &Identification) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

#[cfg(not(feature = "plot"))]
pub fn response(figure: Figure, _: &Scene, _: &Solved) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}

#[cfg(not(feature = "plot"))]
pub fn hysteresis_loop(figure: Figure, _: &Record, _: &Fit) -> Result<(), Failure> {
    Err(unwritable(&figure.0, "this build draws no pictures"))
}
