//! `stickslip orbit`: the exact periodic motion at one frequency.

use std::fmt::Write as _;
use std::io;

use num_complex::Complex64;
use orbit::{EventKind, Orbit, OrbitError};
use scene::{Frequencies, Harmonics, Named, Scene, Spectrum, direction_names};
use serde::Serialize;
use study::Truths;

use crate::arguments::{OrbitArguments, TableFormat, TextFormat, in_file, read_scene};
use crate::check::count;
use crate::ending::{Ending, Failure, say};
use crate::figure::{self, Figure};
use crate::output::{self, Output};
use crate::progress::posed;

/// Looks for the orbit and writes what was asked for.
pub fn run(arguments: &OrbitArguments) -> Result<Ending, Failure> {
    let format = form(arguments)?;
    let figure = arguments.plot.as_deref().map(Figure::new).transpose()?;
    output::distinct(&arguments.scene, &[&arguments.output, &arguments.waveform, &arguments.plot])?;
    let scene = read_scene(&arguments.scene)?;
    let scene = match Frequencies::one(arguments.frequency) {
        // A structure that is reduced is so for the frequency that is asked for, and for many harmonics.
        Ok(one) => scene.with_frequencies(one),
        Err(_) => scene,
    };
    let scene = match scene.harmonics() {
        Harmonics::All(n) if n < START => {
            scene.with_harmonics(START).map_err(|error| in_file(&arguments.scene, error))?
        }
        _ => scene,
    };
    let problem = posed(&scene).map_err(|error| in_file(&arguments.scene, error))?;
    let truths = Truths::new(&scene, START).map_err(|error| in_file(&arguments.scene, error))?;
    let answer = Output::open(arguments.output.as_deref())?;
    let period = arguments.waveform.as_deref().map(|path| Output::open(Some(path))).transpose()?;

    let orbit = match truths.orbit(arguments.frequency) {
        Ok(orbit) => orbit,
        Err(error) if never(&error) => return Err(in_file(&arguments.scene, error)),
        Err(error) => {
            say(format_args!("no orbit at {} Hz: {error}", arguments.frequency));
            return Ok(Ending::SomeFailed);
        }
    };
    let motion = Motion {
        scene: &scene,
        outputs: &problem.output,
        contacts: problem.contacts.iter().map(|contact| contact.name.as_str()).collect(),
        joints: problem.joints.iter().map(|joint| (joint.name.as_str(), joint.directions.len())).collect(),
        orbit: &orbit,
        frequency: arguments.frequency,
    };
    answer.write(|out| match format {
        TextFormat::Text => out.write_all(motion.text().as_bytes()),
        TextFormat::Json => scene::write_json(out, &motion.answer(usize::from(arguments.harmonics))),
    })?;
    if let Some(output) = period {
        output.write(|out| motion.waveform(out))?;
    }
    if let Some(figure) = figure {
        figure::orbit(figure, &motion)?;
    }
    Ok(Ending::Done)
}

/// The form of the answer: what was asked for, else by its file's name, as of answers that are tables as well.
fn form(arguments: &OrbitArguments) -> Result<TextFormat, Failure> {
    if let Some(format) = arguments.format {
        return Ok(format);
    }
    match output::table_format(None, arguments.output.as_deref())? {
        TableFormat::Text => Ok(TextFormat::Text),
        TableFormat::Json => Ok(TextFormat::Json),
        TableFormat::Csv | TableFormat::Npz | TableFormat::Parquet => Err(Failure::input(
            "-o: an orbit is no table; name the file .json or .txt, or write its motion with --waveform FILE.csv",
        )),
    }
}

/// Whether the scene has no orbit at any frequency.
fn never(error: &OrbitError) -> bool {
    use OrbitError::{Mixed, NoExcitation, NoMechanism, SingularMass};
    matches!(error, NoMechanism { .. } | Mixed { .. } | SingularMass | NoExcitation)
}

/// Harmonics of the solution from which the orbit is looked for.
const START: usize = 31;

/// Instants of a period in a waveform.
pub const INSTANTS: usize = 2048;

/// Events that are listed for readers.
const LISTED: usize = 24;

/// An orbit and the names that belong to its dofs and contacts.
pub struct Motion<'a> {
    pub scene: &'a Scene,
    /// Numbers of its output dofs in the orbit.
    pub outputs: &'a [usize],
    /// Names of the contacts in one direction.
    pub contacts: Vec<&'a str>,
    /// Names of those in several, and how many.
    pub joints: Vec<(&'a str, usize)>,
    pub orbit: &'a Orbit,
    pub frequency: f64,
}

/// A force of a contact, in one of its directions.
pub struct Force {
    /// The contact's number as events count it.
    pub contact: usize,
    /// The joint and its direction, of a contact in several.
    direction: Option<(usize, usize)>,
    /// For readers.
    pub name: String,
}

/// `orbit --format json`.
#[derive(Serialize)]
struct Answer<'a> {
    format_version: u32,
    scene: &'a str,
    units: &'static str,
    frequency: f64,
    period: f64,
    closure: f64,
    energy_error: f64,
    displacement: Named<Spectrum>,
    amplitude: Named<f64>,
    contacts: Named<Contact>,
    /// Contacts in several directions.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<Named<Joint>>,
    events: Vec<Event<'a>>,
}

#[derive(Serialize)]
struct Contact {
    force: Spectrum,
    dissipation: f64,
}

#[derive(Serialize)]
struct Joint {
    directions: Named<Direction>,
    dissipation: f64,
}

#[derive(Serialize)]
struct Direction {
    force: Spectrum,
}

#[derive(Serialize)]
struct Event<'a> {
    time: f64,
    contact: &'a str,
    slider: usize,
    begins: &'static str,
    direction: i8,
}

impl Motion<'_> {
    /// Names and numbers of the output dofs.
    pub fn dofs(&self) -> impl Iterator<Item = (&str, usize)> {
        self.scene.output().into_iter().zip(self.outputs.iter().copied())
    }

    /// Names of the contacts in one direction, then of those in several: as events count them.
    fn names(&self) -> impl Iterator<Item = &str> {
        self.contacts.iter().copied().chain(self.joints.iter().map(|joint| joint.0))
    }

    /// All forces, those of contacts in several directions one by one.
    pub fn forces(&self) -> Vec<Force> {
        let contacts = self.contacts.iter().enumerate();
        let contacts =
            contacts.map(|(i, name)| Force { contact: i, direction: None, name: (*name).to_owned() });
        let joints = self.joints.iter().enumerate().flat_map(|(i, (joint, directions))| {
            let names = direction_names(*directions).iter().enumerate();
            names.map(move |(d, direction)| Force {
                contact: self.contacts.len() + i,
                direction: Some((i, d)),
                name: format!("{joint} {direction}"),
            })
        });
        contacts.chain(joints).collect()
    }

    /// In N at an instant in s, on the first body.
    pub fn force(&self, force: &Force, time: f64) -> f64 {
        match force.direction {
            None => self.orbit.contact_force(force.contact, time),
            Some((joint, direction)) => self.orbit.joint_force(joint, direction, time),
        }
    }

    /// Half the peak-to-peak displacement in m.
    fn amplitude(&self, dof: usize) -> f64 {
        let (least, most) = self.orbit.range(dof);
        0.5 * (most - least)
    }

    fn events(&self) -> Vec<Event<'_>> {
        let names: Vec<&str> = self.names().collect();
        let event = |event: &orbit::Event| Event {
            time: event.time,
            contact: names.get(event.contact).copied().unwrap_or_default(),
            slider: event.slider,
            begins: match event.kind {
                EventKind::Slip => "slip",
                EventKind::Stick => "stick",
                EventKind::Open => "apart",
                EventKind::Close => "contact",
            },
            direction: event.direction,
        };
        self.orbit.events().iter().map(event).collect()
    }

    fn answer(&self, highest: usize) -> Answer<'_> {
        let spectrum = |values: Vec<Complex64>| Spectrum(values.into_iter().enumerate().collect());
        let named =
            |(name, dof): (&str, usize)| (name.to_owned(), spectrum(self.orbit.spectrum(dof, highest)));
        let contact = |(i, name): (usize, &str)| {
            let force = spectrum(self.orbit.force_spectrum(i, highest));
            (name.to_owned(), Contact { force, dissipation: self.orbit.dissipation(i) })
        };
        let joint = |(i, (name, directions)): (usize, &(&str, usize))| {
            let names = direction_names(*directions).iter().enumerate();
            let direction = |(d, direction): (usize, &&str)| {
                let force = spectrum(self.orbit.joint_force_spectrum(i, d, highest));
                ((*direction).to_owned(), Direction { force })
            };
            let directions = Named(names.map(direction).collect());
            ((*name).to_owned(), Joint { directions, dissipation: self.orbit.joint_dissipation(i) })
        };
        Answer {
            format_version: 1,
            scene: self.scene.name(),
            units: "SI, Hz, rad",
            frequency: self.frequency,
            period: self.orbit.period(),
            closure: self.orbit.closure(),
            energy_error: self.orbit.energy_error(),
            displacement: Named(self.dofs().map(named).collect()),
            amplitude: Named(self.dofs().map(|(name, dof)| (name.to_owned(), self.amplitude(dof))).collect()),
            contacts: Named(self.contacts.iter().copied().enumerate().map(contact).collect()),
            joints: (!self.joints.is_empty())
                .then(|| Named(self.joints.iter().enumerate().map(joint).collect())),
            events: self.events(),
        }
    }

    fn text(&self) -> String {
        let (orbit, hertz) = (self.orbit, self.frequency);
        let mut text = format!("{} at {hertz} Hz: the exact periodic motion\n", self.scene.name());
        // Writing to a String cannot fail.
        for (name, dof) in self.dofs() {
            let first = orbit.spectrum(dof, 1).get(1).map_or(0.0, |w| w.norm());
            let _ = writeln!(text, "{name}: amplitude {:.6e} m, |W_1| {first:.6e} m", self.amplitude(dof));
        }
        let contacts = (0..self.contacts.len()).map(|i| orbit.dissipation(i));
        let joints = (0..self.joints.len()).map(|i| orbit.joint_dissipation(i));
        for (name, dissipation) in self.names().zip(contacts.chain(joints)) {
            let _ = writeln!(text, "{name}: dissipates {dissipation:.4e} J a period");
        }
        let events = self.events();
        let _ = writeln!(
            text,
            "{} in a period of {:.6e} s",
            count(events.len(), "event", "events"),
            orbit.period()
        );
        for event in events.iter().take(LISTED) {
            let direction = match event.direction {
                0 => "",
                1.. => " (+)",
                _ => " (−)",
            };
            let slider = if event.slider > 0 { format!(", slider {}", event.slider) } else { String::new() };
            let Event { time, contact, begins, .. } = event;
            let part = time / orbit.period();
            let _ =
                writeln!(text, "  {time:.6e} s ({part:.4} T)  {contact}{slider}: {begins} begins{direction}");
        }
        if events.len() > LISTED {
            let _ = writeln!(text, "  and {} more; --format json lists all", events.len() - LISTED);
        }
        let _ = writeln!(
            text,
            "the period closes to {:.1e}; work and dissipation differ by {:.1e}",
            orbit.closure(),
            orbit.energy_error()
        );
        text
    }

    /// Instants of one period in s, its end left out.
    pub fn instants(&self) -> impl Iterator<Item = f64> + use<> {
        let period = self.orbit.period();
        (0..INSTANTS).map(move |j| period * j as f64 / INSTANTS as f64)
    }

    fn waveform(&self, out: &mut dyn io::Write) -> io::Result<()> {
        let mut table = csv::Writer::from_writer(out);
        let mut header = vec!["time [s]".to_owned()];
        for (name, _) in self.dofs() {
            header.extend([format!("{name} [m]"), format!("{name} velocity [m/s]")]);
        }
        let forces = self.forces();
        header.extend(forces.iter().map(|force| format!("{} force [N]", force.name)));
        table.write_record(&header)?;
        for time in self.instants() {
            let mut row = vec![time];
            for (_, dof) in self.dofs() {
                row.extend([self.orbit.displacement(dof, time), self.orbit.velocity(dof, time)]);
            }
            row.extend(forces.iter().map(|force| self.force(force, time)));
            table.write_record(row.iter().map(|value| format!("{value:e}")))?;
        }
        table.flush()
    }
}
