//! Where sliders rest that never slip while others do: at the mean displacement, or as near to it as friction allows.
//!
//! Periodicity leaves that open: the orbits of a family differ in it. The rule of the contact laws picks one. At every instant the
//! slider lies within the reach ρ(τ) of the body at u(τ); of all places that do so for all τ it takes the one nearest to the mean
//! ū ([`crate::reachable`]). Moving the slider moves the orbit and with it ū: `place(s) − s = 0` is solved by Broyden's method, every
//! orbit on the way by shooting.

use std::f64::consts::TAU;

use faer::Mat;
use faer::linalg::solvers::Solve;

use crate::error::OrbitError;
use crate::path::{Element, Path, Piece};
use crate::piecewise::Piecewise;
use crate::polynomial::{Polynomial, TERMS};
use crate::press::length;
use crate::reachable::{Stretch, nearest};
use crate::scaled::Scaled;
use crate::settings::EventKind;
use crate::shooting::{Closed, again};

/// Steps of Broyden's method.
const MOST_STEPS: usize = 40;
/// Distance from its place at which a slider is there, relative to the motion of the body.
const NEAR: f64 = 1e-13;
/// Radians of slip in a period that are none: a slider that was dragged to its place on the way from the start touches its limit
/// there, and what it slips goes with the cube of this.
const GRAZE: f64 = 1e-4;
/// Distance that is good enough where rounding allows no less.
const NEAR_ENOUGH: f64 = 1e-10;

/// A slider that never slips.
struct Resting {
    contact: usize,
    /// It touches its limit.
    grazes: bool,
    /// Its entries in the state, one a direction, and their change by a unit of its spring's elongation.
    entries: Vec<usize>,
    gain: f64,
    links: Vec<usize>,
    /// Of its spring.
    stiffness: f64,
    /// Its press; `None` where the reach is constant.
    press: Option<usize>,
}

/// Where a slider is and where it should be.
struct Place {
    now: [f64; 2],
    wanted: [f64; 2],
    /// Largest displacement of the body.
    size: f64,
}

impl Place {
    fn missed(&self) -> [f64; 2] {
        [self.wanted[0] - self.now[0], self.wanted[1] - self.now[1]]
    }

    fn is_within(&self, near: f64) -> bool {
        length(self.missed()) <= near * self.size
    }
}

/// An orbit and its sliders.
struct Trial {
    closed: Closed,
    path: Path,
    places: Vec<Place>,
}

/// The orbit of the family of `closed` on which all sliders rest where they should.
pub(crate) fn settle(map: &mut Piecewise, closed: Closed, closure: f64) -> Result<Closed, OrbitError> {
    let system = map.system();
    let path = map.record(&closed.state, TAU)?.0;
    let known = closed.clone();
    let resting = resting(system, &path);
    if resting.is_empty() || path.events.is_empty() {
        return Ok(closed);
    }
    let flat = |all: &[Place], of: fn(&Place) -> [f64; 2]| -> Vec<f64> {
        let coordinates = all.iter().zip(&resting);
        coordinates.flat_map(|(place, slider)| of(place).into_iter().take(slider.links.len())).collect()
    };
    let places = |closed: &Closed, path: &Path| -> Vec<Place> {
        resting.iter().map(|slider| slider.place(system, closed, path)).collect()
    };
    let mut now = Trial { places: places(&closed, &path), closed, path };
    let count = flat(&now.places, Place::missed).len();
    let response = Response::new(system, &resting, &now.path);
    let mut slope = response.slope(count);
    for _ in 0..MOST_STEPS {
        if now.places.iter().all(|place| place.is_within(NEAR)) {
            return Ok(now.closed);
        }
        let missed = flat(&now.places, Place::missed);
        let right = Mat::from_fn(count, 1, |i, _| missed.get(i).map_or(0.0, |missed| -missed));
        let step = slope.partial_piv_lu().solve(&right);
        let step: Vec<f64> = step.col(0).iter().copied().collect();
        let mut next = None;
        for share in [1.0, 0.5, 0.2, 0.05] {
            let start = response.shifted(&now.closed.state, &step, share);
            let Some(closed) = again(map, &start, &now.closed, closure) else { continue };
            let path = map.record(&closed.state, TAU)?.0;
            if self::resting(system, &path).iter().map(|s| &s.entries).eq(resting.iter().map(|s| &s.entries))
            {
                next = Some(Trial { places: places(&closed, &path), closed, path });
                break;
            }
        }
        let Some(next) = next else { break };
        // Broyden: the least change of the slope that agrees with what this step has done.
        let difference = |of: fn(&Place) -> [f64; 2]| -> Vec<f64> {
            flat(&next.places, of).iter().zip(flat(&now.places, of)).map(|(new, old)| new - old).collect()
        };
        let (way, change) = (difference(|place| place.now), difference(Place::missed));
        let square: f64 = way.iter().map(|x| x * x).sum();
        if square == 0.0 {
            break;
        }
        for (i, change) in change.iter().enumerate() {
            let seen: f64 = way.iter().enumerate().map(|(j, way)| slope[(i, j)] * way).sum();
            for (j, way) in way.iter().enumerate() {
                slope[(i, j)] += (change - seen) * way / square;
            }
        }
        now = next;
    }
    match now.places.iter().zip(&resting).find(|(place, _)| !place.is_within(NEAR_ENOUGH)) {
        None => Ok(now.closed),
        // One that moves a little has no other place.
        Some(_) if resting.iter().any(|slider| slider.grazes) => Ok(known),
        Some((_, slider)) => Err(OrbitError::Resting { contact: slider.contact }),
    }
}

/// All sliders that never slip along `path`.
fn resting(system: &Scaled, path: &Path) -> Vec<Resting> {
    let sliders = system
        .sliders
        .iter()
        .enumerate()
        .map(|(index, slider)| (index, slider, slip(path, Element::Slider(index))));
    let sliders = sliders.filter(|(.., slip)| *slip < GRAZE).map(|(index, slider, slip)| Resting {
        contact: slider.contact,
        grazes: slip > 0.0,
        entries: vec![2 * system.dofs + index],
        gain: slider.gain,
        links: vec![slider.contact],
        stiffness: slider.stiffness,
        press: None,
    });
    let mut entry = 2 * system.dofs + system.sliders.len();
    let presses = system.frictions().filter_map(|(index, press, friction)| {
        let links: Vec<usize> = friction.links().collect();
        let entries: Vec<usize> = (entry..entry + links.len()).collect();
        entry += links.len();
        let sticks =
            |piece: &&Piece| piece.elastic.get(friction.link).is_some_and(|elastic| elastic.stiffness > 0.0);
        let stuck: f64 = path.pieces.iter().filter(sticks).map(|piece| piece.length).sum();
        let slip = slip(path, Element::Press(index));
        // Without events it may slip all the time, or be apart.
        (slip < GRAZE && stuck > TAU - 2.0 * GRAZE).then_some(Resting {
            contact: press.contact,
            grazes: slip > 0.0,
            entries,
            gain: 1.0,
            links,
            stiffness: friction.stiffness,
            press: Some(index),
        })
    });
    sliders.chain(presses).collect()
}

/// Radians of a period during which a slider slips, as its events say; infinite where its contact opens.
fn slip(path: &Path, element: Element) -> f64 {
    let own = path.events.iter().filter(|event| event.element == element);
    let sum = own.fold(0.0, |sum, event| match event.kind {
        EventKind::Slip => sum - event.tau,
        EventKind::Stick => sum + event.tau,
        EventKind::Open | EventKind::Close => f64::INFINITY,
    });
    if sum < 0.0 { sum + TAU } else { sum }
}

impl Resting {
    fn place(&self, system: &Scaled, closed: &Closed, path: &Path) -> Place {
        let press = self.press.and_then(|press| system.presses.get(press));
        let stretches: Vec<Stretch> = path
            .pieces
            .iter()
            .map(|piece| {
                let along = |link: Option<&usize>| -> Polynomial {
                    let link = link.and_then(|link| system.links.get(*link));
                    link.map_or([0.0; TERMS], |link| piece.relative(link, system.dofs))
                };
                let mut reach = [0.0; TERMS];
                if let Some(press) = press {
                    reach = along(Some(&press.normal)).map(|c| press.reach() * press.stiffness * c);
                }
                if let Some(constant) = reach.first_mut() {
                    *constant += press.map_or(1.0 / self.gain, |press| press.reach() * press.pressure);
                }
                Stretch {
                    length: piece.length,
                    body: [along(self.links.first()), along(self.links.get(1))],
                    reach,
                }
            })
            .collect();
        let u = |link: usize| system.links.get(link).map_or(0.0, |link| link.relative(&closed.state));
        let mut now = [0.0; 2];
        for ((now, &link), &entry) in now.iter_mut().zip(&self.links).zip(&self.entries) {
            *now = u(link) - closed.state.get(entry).copied().unwrap_or(0.0) / self.gain;
        }
        let (wanted, size) = nearest(&stretches, self.links.len());
        Place { now, wanted, size }
    }
}

/// What a shift of the sliders does to the means of all dofs: (C + Σ k̄ β βᵀ) δȳ = Σ k_t β δs with the mean stiffness k̄ of the links,
/// to which sliders that slip give nothing, since they follow.
struct Response<'a> {
    system: &'a Scaled,
    /// Slider, link and entry in the state of every coordinate.
    coordinates: Vec<(&'a Resting, usize, usize)>,
    /// δȳ by each coordinate; zero where the stiffness is singular.
    means: Vec<Vec<f64>>,
}

impl<'a> Response<'a> {
    fn new(system: &'a Scaled, resting: &'a [Resting], path: &Path) -> Self {
        let n = system.dofs;
        let own = |i: usize, j: usize| system.stiffness.get(i * n + j).copied().unwrap_or(0.0);
        let mut stiffness = Mat::from_fn(n, n, own);
        for (index, link) in system.links.iter().enumerate() {
            let over = |piece: &Piece| piece.elastic.get(index).map_or(0.0, |e| e.stiffness * piece.length);
            let presses = system.presses.iter().any(|press| press.normal == index);
            let whole = path.pieces.iter().filter(|_| presses).map(over).sum::<f64>() / TAU;
            let own = resting.iter().filter(|slider| slider.links.contains(&index));
            let mean = link.spring + whole + own.map(|slider| slider.stiffness).sum::<f64>();
            for &(i, a) in &link.ends {
                for &(j, b) in &link.ends {
                    stiffness[(i, j)] += mean * a * b;
                }
            }
        }
        let coordinates = resting.iter().flat_map(|slider| {
            slider.links.iter().zip(&slider.entries).map(move |(link, entry)| (slider, *link, *entry))
        });
        let coordinates: Vec<_> = coordinates.collect();
        let factors = stiffness.partial_piv_lu();
        let mean = |(slider, link, _): &(&Resting, usize, usize)| -> Vec<f64> {
            let mut force = Mat::zeros(n, 1);
            for &(i, a) in system.links.get(*link).map_or(&[][..], |link| &link.ends) {
                force[(i, 0)] += slider.stiffness * a;
            }
            let found: Vec<f64> = factors.solve(&force).col(0).iter().copied().collect();
            if found.iter().all(|y| y.is_finite()) { found } else { vec![0.0; n] }
        };
        let means = coordinates.iter().map(mean).collect();
        Self { system, coordinates, means }
    }

    fn relative(&self, link: usize, y: &[f64]) -> f64 {
        self.system.links.get(link).map_or(0.0, |link| link.relative(y))
    }

    /// ∂(ū − s)/∂s, where the mean is the place.
    fn slope(&self, count: usize) -> Mat<f64> {
        Mat::from_fn(count, count, |i, j| {
            let (link, mean) = (self.coordinates.get(i).map(|c| c.1), self.means.get(j));
            let moved = link.zip(mean).map_or(0.0, |(link, mean)| self.relative(link, mean));
            moved - if i == j { 1.0 } else { 0.0 }
        })
    }

    /// `state` with the sliders `share · step` away.
    fn shifted(&self, state: &[f64], step: &[f64], share: f64) -> Vec<f64> {
        let mut means = vec![0.0; self.system.dofs];
        for (own, step) in self.means.iter().zip(step) {
            means.iter_mut().zip(own).for_each(|(sum, y)| *sum += share * step * y);
        }
        let mut state = state.to_vec();
        state.iter_mut().zip(&means).for_each(|(y, mean)| *y += mean);
        for ((slider, link, entry), step) in self.coordinates.iter().zip(step) {
            if let Some(slot) = state.get_mut(*entry) {
                *slot += slider.gain * (self.relative(*link, &means) - share * step);
            }
        }
        state
    }
}
