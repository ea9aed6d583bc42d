//! Stands in for laws that are not there yet.
#![allow(missing_docs)]

use contact::{JointChange, JointLaw, JointMarks, JointMotion, JointWorkspace, LawError, ParameterError};

#[derive(Debug, Clone, Copy)]
pub(crate) struct FrictionContactParameters {
    pub(crate) tangential_stiffness: f64,
    pub(crate) normal_stiffness: f64,
    pub(crate) friction_coefficient: f64,
    pub(crate) preload: Option<f64>,
    pub(crate) gap: Option<f64>,
}

#[derive(Debug)]
pub(crate) struct FrictionContact(FrictionContactParameters, usize);

impl FrictionContact {
    pub(crate) fn new(p: FrictionContactParameters, tangential: usize) -> Result<Self, ParameterError> {
        for (key, value) in [
            ("tangential_stiffness", p.tangential_stiffness),
            ("normal_stiffness", p.normal_stiffness),
            ("friction_coefficient", p.friction_coefficient),
        ] {
            if value <= 0.0 {
                return Err(ParameterError::new(key, format!("must be positive, got {value}")));
            }
        }
        Ok(Self(p, tangential))
    }
}

#[derive(Debug)]
struct Nothing;

impl JointWorkspace for Nothing {
    fn as_any_mut(&mut self) -> &mut dyn std::any::Any {
        self
    }
}

impl JointLaw for FrictionContact {
    fn name(&self) -> &'static str {
        "friction_contact"
    }
    fn directions(&self) -> usize {
        self.1 + 1
    }
    fn length(&self, _: usize) -> f64 {
        self.0.friction_coefficient * self.0.preload.or(self.0.gap).unwrap_or(1.0)
    }
    fn stiffness(&self, _: usize) -> f64 {
        self.0.normal_stiffness
    }
    fn workspace(&self, _: usize) -> Box<dyn JointWorkspace> {
        Box::new(Nothing)
    }
    fn force(
        &self,
        _: &JointMotion,
        _: &mut dyn JointWorkspace,
        _: &mut [f64],
    ) -> Result<JointMarks, LawError> {
        Err(LawError::NoMotion)
    }
    fn derivative(&self, _: &JointMotion, _: &JointChange, _: &mut dyn JointWorkspace, _: &mut [f64]) {}
}
