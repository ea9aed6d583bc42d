//! A scene as numbers, and what is asked of the scripts.

use std::path::Path;

use anyhow::{Context, Result};
use serde::Serialize;
use serde_json::{Value, json};

/// A scene of two masses with one contact to the ground.
pub(super) struct Scene {
    /// Solved here, at `frequencies`.
    pub(super) scene: scene::Scene,
    /// As its file has it.
    json: Value,
    /// In Hz.
    pub(super) frequencies: Vec<f64>,
}

/// One run of a script.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Case {
    pub(super) harmonics: usize,
    /// The harmonics themselves: odd ones, as the scenes need no others.
    orders: Vec<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<&'static str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steps: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<f64>,
    tolerance: f64,
    repeats: usize,
    frequencies: Vec<f64>,
}

/// `count` frequencies from `from` to `to`.
pub(super) fn evenly(from: f64, to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| from + (to - from) * i as f64 / (count - 1) as f64).collect()
}

impl Scene {
    pub(super) fn read(root: &Path, file: &str, frequencies: Vec<f64>) -> Result<Self> {
        let path = root.join(file);
        let text = std::fs::read_to_string(&path).with_context(|| file.to_owned())?;
        let mut json: Value = serde_json::from_str(&text).with_context(|| file.to_owned())?;
        json["output"] = json["model"]["dofs"].clone();
        Self::of(json, frequencies)
    }

    fn of(mut json: Value, frequencies: Vec<f64>) -> Result<Self> {
        json["frequencies"] = json!(frequencies);
        let scene = scene::Scene::from_str(&json.to_string(), Path::new("."))?;
        Ok(Self { scene, json, frequencies })
    }

    /// The same at other frequencies.
    pub(super) fn at(&self, frequencies: Vec<f64>) -> Result<Self> {
        Self::of(self.json.clone(), frequencies)
    }

    pub(super) fn name(&self) -> &str {
        self.scene.name()
    }
}

impl Case {
    pub(super) fn balance(
        scene: &Scene,
        harmonics: usize,
        samples: usize,
        tolerance: f64,
        repeats: usize,
    ) -> Self {
        Self {
            harmonics,
            orders: (1..=harmonics).step_by(2).collect(),
            samples: Some(samples),
            method: None,
            steps: None,
            accuracy: None,
            tolerance,
            repeats,
            frequencies: scene.frequencies.clone(),
        }
    }

    /// Both ways to step through time, from coarse to fine.
    pub(super) fn stepping(scene: &Scene) -> Vec<Self> {
        let blank = Self { samples: None, ..Self::balance(scene, 31, 0, 1e-7, 0) };
        let newmark = [64, 256, 1024].map(|steps| Self {
            method: Some("newmark"),
            steps: Some(steps),
            ..blank.clone()
        });
        let adaptive = [1e-3, 1e-5].map(|accuracy| Self {
            method: Some("solve_ivp"),
            accuracy: Some(accuracy),
            ..blank.clone()
        });
        newmark.into_iter().chain(adaptive).collect()
    }
}

/// The request of a script.
pub(super) fn text(scene: &Scene, cases: &[Case]) -> Result<String> {
    let (model, law) = (&scene.json["model"], &scene.json["contacts"][0]["law"]);
    let force = &scene.json["excitation"][0]["amplitude"];
    let numbers = json!({
        "mass": model["mass"], "damping": model["damping"], "stiffness": model["stiffness"],
        "force": force, "law": law,
    });
    Ok(serde_json::to_string(&json!({"scene": numbers, "cases": cases}))?)
}
