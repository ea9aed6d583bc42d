//! How an orbit is looked for.

/// A state of motion to begin with.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct State {
    /// In m, one a dof.
    pub displacement: Vec<f64>,
    /// In m/s, one a dof.
    pub velocity: Vec<f64>,
    /// Spring force in N of every slider (times the contact's scale), contact by contact in the order of their
    /// mechanisms, then of every joint, one a tangential direction; in rig convention.
    pub sliders: Vec<f64>,
}

/// How an orbit is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Largest difference between the ends of a period, relative to the orbit's own size, that is accepted. Newton's
    /// method goes on to rounding.
    pub closure: f64,
    /// Periods that are followed from the start before the period map is solved, at most. Newton's method is tried
    /// early, and again after twice as many periods whenever it fails.
    pub settling_periods: usize,
    /// The state at t = 0 to start from; `None` is rest. Where several orbits exist it chooses among them: Newton's
    /// method is then tried before any period is followed.
    pub start: Option<State>,
    /// Relative local error of the integrator of smooth systems. Piecewise-linear systems are followed to rounding.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { closure: 1e-12, settling_periods: 400, start: None, tolerance: 1e-14 }
    }
}

/// What happens to a slider or contact at an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// It begins to slip.
    Slip,
    /// It sticks again: the slider's velocity is zero.
    Stick,
    /// The bodies of a contact separate.
    Open,
    /// They touch again.
    Close,
}

/// An event of the orbit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// Instant in s, in [0, T).
    pub time: f64,
    /// Contact it belongs to; joints are counted on after the contacts.
    pub contact: usize,
    /// Slider of that contact; 0 for contacts that open.
    pub slider: usize,
    /// What begins.
    pub kind: EventKind,
    /// Direction of the slip that begins or ends: +1 or −1; 0 in two tangential directions, and for contacts that open or close.
    pub direction: i8,
}
