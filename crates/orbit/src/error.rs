//! Why there is no orbit to report.

use thiserror::Error;

/// Why there is no orbit to report.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum OrbitError {
    /// Not supported by this method.
    #[error("no exact orbit of contact \"{contact}\" ({law}): {why}")]
    NoMechanism {
        /// Name of the contact.
        contact: String,
        /// Name of its law.
        law: &'static str,
        /// Why, and what to do about it.
        why: &'static str,
    },
    /// Sliders and contacts that open are followed by their events, smooth forces by an integrator; not both at once.
    #[error(
        "no exact orbit of contact \"{smooth}\" (a smooth law) together with contact \"{sliders}\" (sliders, or a \
         contact that opens): leave one of them out, or replace it by a linear spring"
    )]
    Mixed {
        /// Name of a contact with a smooth law.
        smooth: String,
        /// Name of a contact with sliders or of one that opens.
        sliders: String,
    },
    /// A matrix has the wrong size.
    #[error("the {matrix} matrix is {rows} × {columns}, but there are {dofs} dofs")]
    Size {
        /// mass, damping or stiffness.
        matrix: &'static str,
        /// Rows it has.
        rows: usize,
        /// Columns it has.
        columns: usize,
        /// Rows and columns it should have.
        dofs: usize,
    },
    /// There is nothing that could move.
    #[error("the structure has no dofs")]
    Empty,
    /// A number is infinite or not a number.
    #[error("{what} is not finite")]
    NotFinite {
        /// What was given.
        what: String,
    },
    /// A load or contact names a dof that does not exist.
    #[error("{what} is at dof {dof}, but there are {dofs} dofs (the first is 0)")]
    Dof {
        /// The load or contact.
        what: String,
        /// The dof it names.
        dof: usize,
        /// Number of dofs.
        dofs: usize,
    },
    /// A contact's factor is not positive.
    #[error("the scale of contact \"{contact}\" must be positive, got {scale}")]
    Scale {
        /// Name of the contact.
        contact: String,
        /// What was given.
        scale: f64,
    },
    /// A joint has more or fewer directions than its law.
    #[error("joint \"{joint}\" has {given} directions, but its law has {expected}")]
    Directions {
        /// Name of the joint.
        joint: String,
        /// As given.
        given: usize,
        /// As the law has.
        expected: usize,
    },
    /// Static response is no orbit.
    #[error("the frequency must be positive, got {frequency} Hz")]
    Frequency {
        /// In Hz.
        frequency: f64,
    },
    /// The state to start from does not fit the system.
    #[error("the state to start from has {given} {what}, but the system has {expected}")]
    Start {
        /// displacements, velocities or sliders.
        what: &'static str,
        /// As given.
        given: usize,
        /// As needed.
        expected: usize,
    },
    /// A dof without mass follows no differential equation of second order.
    #[error(
        "the mass matrix is singular or not positive on its diagonal: give every dof a mass, or condense dofs without one"
    )]
    SingularMass,
    /// No load changes with time.
    #[error("no load changes with time: without excitation there is no orbit to follow")]
    NoExcitation,
    /// All sliders stick all the time.
    #[error(
        "every slider sticks all period: the motion is linear, its harmonics k ≥ 1 are those of the structure with all \
         sliders locked, but where the sliders rest, and with it the mean, depends on history. Raise the load, or \
         replace the sliders by springs"
    )]
    Stuck,
    /// The place of a slider that never slips was not found.
    #[error(
        "contact {contact} (the first is 0, joints counted on) sticks all period while others slip, and the place nearest to the mean \
         where it may rest was not found"
    )]
    Resting {
        /// Its number, joints counted on after the contacts.
        contact: usize,
    },
    /// Newton's method on the period map did not get close enough.
    #[error(
        "the orbit does not close: after {periods} periods and {iterations} steps of Newton's method the two ends of a \
         period still differ by {closure:.1e} of its size. Start closer to it, or allow more periods to settle"
    )]
    NotClosed {
        /// Smallest relative difference reached.
        closure: f64,
        /// Periods followed before Newton's method.
        periods: usize,
        /// Steps of Newton's method, all attempts together.
        iterations: usize,
    },
    /// The motion repeats, but only after several periods of the excitation.
    #[error(
        "the motion repeats only after {periods} periods of the excitation (to {closure:.1e} of its size): it is \
         subharmonic, and no orbit of one period was found beside it"
    )]
    Subharmonic {
        /// Periods of the excitation in one of the motion.
        periods: usize,
        /// Relative difference of the motion after as many periods.
        closure: f64,
    },
    /// The motion grows without limit.
    #[error(
        "the motion grows beyond all bounds: the system is unstable, or excited at resonance without damping"
    )]
    Unbounded,
    /// Events pile up at one instant.
    #[error("events pile up at {time:e} s: sliders begin and cease to slip without time passing")]
    Chatter {
        /// Instant in s.
        time: f64,
    },
    /// The eigenvalues of the monodromy matrix were not found.
    #[error("the Floquet multipliers of the orbit could not be computed: the eigenvalue iteration failed")]
    Eigenvalues,
    /// Steps of the integrator become too small.
    #[error("the integrator cannot keep its tolerance at {time:e} s: the force changes too fast")]
    Stiff {
        /// Instant in s.
        time: f64,
    },
}
