//! Tests of the response figure.

use super::*;

/// Two resonances and what friction makes of them, with a gap; the shape matters, not the physics.
pub(super) fn example(panels: usize) -> Response {
    let resonance = |f: f64, at: f64, damping: f64| 1.0 / ((at * at - f * f).hypot(damping * at * f));
    let panel = |n: usize| {
        let size = 0.03 / (1.0 + n as f64);
        let frequencies: Vec<f64> = (0..400).map(|i| 15.0 + 185.0 * f64::from(i) / 399.0).collect();
        let linear = |f: f64| size * (resonance(f, 43.0, 0.02) + 0.4 * resonance(f, 108.0, 0.01));
        let contact = |f: f64| size * (0.6 * resonance(f, 58.0, 0.3) + 0.4 * resonance(f, 107.0, 0.05));
        let missing = |f: f64| (150.0..160.0).contains(&f) && !(154.0..154.5).contains(&f);
        Panel {
            title: format!("w{}", n + 1),
            contact: frequencies.iter().map(|&f| (f, (!missing(f)).then(|| contact(f)))).collect(),
            linear: frequencies.iter().map(|&f| (f, Some(linear(f)))).collect(),
            extrapolated: frequencies.iter().map(|f| (80.0..125.0).contains(f)).collect(),
            unstable: Vec::new(),
        }
    };
    Response {
        title: "two-mass, N = 1".into(),
        panels: (0..panels).map(panel).collect(),
        quantity: "peak displacement".into(),
    }
}

#[test]
fn the_same_data_give_the_same_drawing() {
    assert!(draw(&example(2)).unwrap() == draw(&example(2)).unwrap());
}

#[test]
fn every_dof_axis_and_curve_is_named() {
    let svg = draw(&example(3)).unwrap();
    for word in
        ["w1", "w2", "w3", "frequency (Hz)", "peak displacement (m)", "with contact", "without contact"]
    {
        assert!(svg.contains(&format!(">{word}</text>")), "{word} is missing");
    }
    assert!(svg.contains(">10⁻⁵</text>"), "decades are powers of ten");
    assert!(svg.contains(">extrapolated</text>"));
}

#[test]
fn an_unsolved_stretch_is_a_gap_and_a_lone_point_a_dot() {
    let strokes = |r: &Response| draw(r).unwrap().matches("<path").count();
    let gappy = example(1);
    let mut whole = gappy.clone();
    for panel in &mut whole.panels {
        panel.contact = panel.linear.clone();
    }
    assert_eq!(strokes(&gappy), strokes(&whole) + 1);
    assert!(draw(&gappy).unwrap().contains("<circle"));
    assert!(!draw(&whole).unwrap().contains("<circle"));
}

#[test]
fn nothing_solved_is_an_error_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("empty.svg");
    let mut empty = example(1);
    for panel in &mut empty.panels {
        panel.contact.iter_mut().chain(&mut panel.linear).for_each(|(_, a)| *a = None);
    }
    let error = write_response(&empty, &path).unwrap_err().to_string();
    assert!(error.contains("nothing to plot"), "{error}");
    empty.panels.clear();
    assert!(write_response(&empty, &path).is_err());
    assert!(!path.exists());
}

#[test]
fn one_dof_without_solution_is_said_to_have_none() {
    let mut response = example(2);
    let second = response.panels.last_mut().unwrap();
    second.contact.iter_mut().chain(&mut second.linear).for_each(|(_, a)| *a = None);
    assert!(draw(&response).unwrap().contains(">no solution</text>"));
}

#[test]
fn a_name_cannot_break_the_drawing() {
    let mut response = example(1);
    response.title = "a < b & \"c\"".into();
    response.panels.iter_mut().for_each(|p| p.title = "</svg><script>".into());
    let folder = tempfile::tempdir().unwrap();
    write_response(&response, &folder.path().join("odd.png")).unwrap();
    assert!(!draw(&response).unwrap().contains("<script>"));
}

#[test]
fn stretches_meet_halfway() {
    let panel = Panel {
        title: String::new(),
        contact: [1.0, 2.0, 3.0, 4.0, 5.0].map(|f| (f, Some(1.0))).to_vec(),
        linear: Vec::new(),
        extrapolated: vec![true, false, true, true, false],
        unstable: Vec::new(),
    };
    assert_eq!(extrapolated_stretches(&panel), [(1.0, 1.5), (2.5, 4.5)]);
}

#[test]
fn logarithmic_sweeps_get_a_logarithmic_axis() {
    let linear = (1..=1000).map(f64::from);
    let log = (0..=100).map(|i| 10.0_f64.powf(f64::from(i) * 0.03));
    assert!(!spans_decades(linear));
    assert!(spans_decades(log));
    assert!(!spans_decades([50.0].into_iter()));
}

/// For looking at all of them: `STICKSLIP_FIGURES=folder cargo test -p stickslip figures`.
#[test]
fn figures_of_many_sizes_are_written() {
    let scratch = tempfile::tempdir().unwrap();
    let wanted = std::env::var_os("STICKSLIP_FIGURES");
    let folder = wanted.as_ref().map_or(scratch.path().to_owned(), Into::into);
    for panels in [1, 2, 6, 16] {
        for extension in ["svg", "png"] {
            // Large images take long without optimisation.
            if extension == "svg" || panels == 1 || wanted.is_some() {
                let path = folder.join(format!("response-{panels}.{extension}"));
                write_response(&example(panels), &path).unwrap();
                assert!(path.metadata().unwrap().len() > 1000);
            }
        }
    }
}

#[test]
fn a_single_frequency_is_a_dot_on_labelled_axes() {
    let response = Response {
        title: String::new(),
        panels: vec![Panel {
            title: "tip".into(),
            contact: vec![(55.0, Some(2e-6))],
            linear: vec![(55.0, None)],
            extrapolated: vec![true],
            unstable: Vec::new(),
        }],
        quantity: "amplitude".into(),
    };
    let svg = draw(&response).unwrap();
    assert_eq!(svg.matches("<circle").count(), 1);
    assert!(svg.contains(">10⁻⁶</text>") && svg.contains(">10⁻⁵</text>"));
    assert!(!svg.contains("without contact"), "a curve without points has no name");
}

#[test]
fn harmonics_are_printed_below_the_line() {
    assert_eq!(subscripted("|W_12|, peak_to_peak 3"), "|W₁₂|, peak_to_peak 3");
}

#[test]
fn the_order_of_the_points_does_not_matter() {
    let forwards = example(1);
    let mut backwards = forwards.clone();
    for panel in &mut backwards.panels {
        panel.contact.reverse();
        panel.linear.reverse();
        panel.extrapolated.reverse();
    }
    assert!(draw(&forwards).unwrap() == draw(&backwards).unwrap());
}
