//! Amplitudes over frequency with and without contacts, and their peaks.

use num_complex::Complex64;

use crate::run::Solved;

/// A response over frequency: (Hz, amplitude in m); `None` where there is no solution.
pub type Curve = Vec<(f64, Option<f64>)>;

/// The response of one dof, with contacts and without.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// The dof.
    pub dof: String,
    /// Amplitude with contacts.
    pub contact: Curve,
    /// Amplitude of the structure without contacts.
    pub linear: Curve,
}

/// The responses of all output dofs.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    /// Harmonic of Ω whose amplitude |W_k| is given: the lowest that is excited.
    pub harmonic: usize,
    /// One entry an output dof.
    pub responses: Vec<Response>,
    /// One entry a frequency: some contact's law is extrapolated.
    pub extrapolated: Vec<bool>,
    /// Likewise: the point is known to be unstable.
    pub unstable: Vec<bool>,
}

/// A maximum of a response.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// In Hz.
    pub frequency: f64,
    /// In m.
    pub amplitude: f64,
}

/// A resonance: the peak with contacts and the one without.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Resonance {
    /// With contacts.
    pub contact: Option<Peak>,
    /// Without.
    pub linear: Option<Peak>,
}

impl Resonance {
    fn frequency(&self) -> f64 {
        self.contact.or(self.linear).map_or(0.0, |peak| peak.frequency)
    }

    /// 1 − amplitude with contacts / amplitude without.
    pub fn reduction(&self) -> Option<f64> {
        Some(1.0 - self.contact?.amplitude / self.linear?.amplitude)
    }
}

impl Responses {
    pub(crate) fn new(solved: &Solved) -> Self {
        let plan = &solved.prepared.plan;
        let harmonic = plan.facts().fundamental.max(1);
        let column = plan.orders().iter().position(|order| *order == harmonic);
        let solutions = solved.solutions();
        let mut workspace = plan.workspace();
        let mut responses: Vec<Response> = (solved.prepared.scene.output().into_iter())
            .map(|dof| Response { dof: dof.to_owned(), contact: Vec::new(), linear: Vec::new() })
            .collect();
        for solution in solutions {
            let linear = plan.linear_response(solution.frequency, &mut workspace).unwrap_or_default();
            for (i, response) in responses.iter_mut().enumerate() {
                let amplitude = |rows: &[Vec<Complex64>]| Some(rows.get(i)?.get(column?)?.norm());
                response.contact.push((solution.frequency, amplitude(&solution.displacement)));
                response.linear.push((solution.frequency, amplitude(&linear)));
            }
        }
        let left = |solution: &hbm::Solution| {
            let joints = solution.joints.iter().map(|joint| joint.extrapolated);
            solution.contacts.iter().map(|contact| contact.extrapolated).chain(joints).any(|left| left)
        };
        let unstable =
            |s: &hbm::Solution| s.stability.as_ref().is_some_and(|s| s.verdict == hbm::Verdict::Unstable);
        Self {
            harmonic,
            responses,
            extrapolated: solutions.iter().map(left).collect(),
            unstable: solutions.iter().map(unstable).collect(),
        }
    }
}

/// Amplitude relative to the highest of both curves below which a dof is at rest.
const NEGLIGIBLE: f64 = 1e-9;

impl Response {
    /// The resonances in the order of frequency. A peak with contacts belongs to the nearest one without that no
    /// nearer peak has taken; a curve without a peak shows its highest point.
    pub fn resonances(&self) -> Vec<Resonance> {
        let ends = [highest(&self.contact), highest(&self.linear)];
        let floor = NEGLIGIBLE * ends.iter().flatten().map(|peak| peak.amplitude).fold(0.0, f64::max);
        let counting = |curve| peaks(curve).into_iter().filter(|peak| peak.amplitude > floor).collect();
        let (mut contact, mut linear): (Vec<Peak>, Vec<Peak>) =
            (counting(&self.contact), counting(&self.linear));
        if contact.is_empty() && linear.is_empty() {
            let [contact, linear] = ends;
            return vec![Resonance { contact, linear }];
        }
        let mut resonances = Vec::new();
        while let Some((i, j)) = nearest(&contact, &linear) {
            resonances.push(Resonance { contact: Some(contact.remove(i)), linear: Some(linear.remove(j)) });
        }
        resonances.extend(contact.into_iter().map(|peak| Resonance { contact: Some(peak), linear: None }));
        resonances.extend(linear.into_iter().map(|peak| Resonance { contact: None, linear: Some(peak) }));
        resonances.sort_by(|a, b| a.frequency().total_cmp(&b.frequency()));
        resonances
    }
}

/// The pair of peaks whose frequencies differ least, by ratio.
fn nearest(contact: &[Peak], linear: &[Peak]) -> Option<(usize, usize)> {
    let distance = |c: &Peak, l: &Peak| (c.frequency / l.frequency).ln().abs();
    let row = |(i, c)| linear.iter().enumerate().map(move |(j, l)| (distance(c, l), (i, j)));
    let pairs = contact.iter().enumerate().flat_map(row);
    pairs.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, pair)| pair)
}

/// A maximum rises above both its neighbouring valleys by this part of itself, or it is rounding.
const PROMINENCE: f64 = 1e-3;

/// Local maxima inside the range that rise clearly, in the order of the curve. Where a point is missing nothing is
/// known: no maximum lies beside it, and no valley beyond it.
pub fn peaks(curve: &[(f64, Option<f64>)]) -> Vec<Peak> {
    let amplitude = |i: usize| curve.get(i).and_then(|(_, amplitude)| *amplitude);
    // How far the curve falls from `top` at `i` before it rises above it or ends.
    let fall = |top: f64, way: &mut dyn Iterator<Item = usize>| {
        let below = way.map_while(amplitude).take_while(|a| *a <= top);
        top - below.fold(top, f64::min)
    };
    let peak = |i: usize| {
        let top = amplitude(i)?;
        let higher = top > amplitude(i.checked_sub(1)?)? && top >= amplitude(i + 1)?;
        let prominence = fall(top, &mut (0..i).rev()).min(fall(top, &mut (i + 1..curve.len())));
        let frequency = curve.get(i)?.0;
        (higher && prominence > PROMINENCE * top).then_some(Peak { frequency, amplitude: top })
    };
    (0..curve.len()).filter_map(peak).collect()
}

/// The highest point of a curve, its ends included.
pub fn highest(curve: &[(f64, Option<f64>)]) -> Option<Peak> {
    let points = curve
        .iter()
        .filter_map(|(frequency, amplitude)| Some(Peak { frequency: *frequency, amplitude: (*amplitude)? }));
    points.max_by(|a, b| a.amplitude.total_cmp(&b.amplitude))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(amplitudes: &[f64]) -> Curve {
        let known = |a: f64| a.is_finite().then_some(a);
        amplitudes.iter().enumerate().map(|(i, a)| (i as f64, known(*a))).collect()
    }

    #[test]
    fn peaks_lie_inside_and_beside_known_points() {
        let found = peaks(&curve(&[9.0, 1.0, 3.0, 2.0, 5.0, 5.0, 1.0, 8.0, f64::NAN]));
        assert_eq!(found.iter().map(|p| p.frequency).collect::<Vec<_>>(), [2.0, 4.0]);
        assert_eq!(peaks(&curve(&[1.0, 1.0000001, 1.0, 1.0001, 1.0])), []);
        assert_eq!(highest(&curve(&[f64::NAN])), None);
        assert_eq!(highest(&curve(&[9.0, 1.0])).unwrap().frequency, 0.0);
    }

    #[test]
    fn resonances_are_paired_by_nearness() {
        let response = |contact: &[f64], linear: &[f64]| Response {
            dof: "w".into(),
            contact: curve(contact),
            linear: curve(linear),
        };
        let two = response(&[0.0, 1.0, 0.0, 2.0, 0.0], &[0.0, 4.0, 0.0, 4.0, 0.0]).resonances();
        assert_eq!(two.iter().map(|r| r.reduction().unwrap()).collect::<Vec<_>>(), [0.75, 0.5]);
        let one = response(&[0.0, 1.0, 1.5, 2.0, 0.0], &[0.0, 4.0, 0.0, 4.5, 0.0]).resonances();
        assert_eq!(one.iter().map(|r| r.contact.map(|p| p.frequency)).collect::<Vec<_>>(), [None, Some(3.0)]);
        let rest = response(&[0.0, 1e-24, 0.0, 2e-24, 0.0], &[0.0, 4.0, 0.0, 4.5, 0.0]).resonances();
        assert!(rest.iter().all(|r| r.contact.is_none()) && rest.len() == 2);
        let none = response(&[1.0, 2.0], &[2.0, 1.0]).resonances();
        assert_eq!(none[0].reduction(), Some(0.0));
    }
}
