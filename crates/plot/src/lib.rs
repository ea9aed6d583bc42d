//! Figures as a journal prints them, as SVG or PNG.
//!
//! The corridor: data → [`Chart`], one pair of boxed axes with its curves, drawn by kuva → [`sheet()`], charts side by
//! side as one SVG → [`write()`], the SVG itself or a PNG by resvg with its own fonts, whole or not at all. The figures
//! of the command line are ready-made: the forced response ([`Response`]), a measured loop ([`LoopPlot`]), the scaling
//! laws ([`ScalingPlot`]), error against harmonics ([`TruncationPlot`]), an orbit ([`OrbitPlot`]), a nonlinear mode ([`BackbonePlot`]),
//! peaks over a parameter ([`PeakPlot`])
//! and studies of one or two parameters ([`ParameterPlot`], [`HeatMap`]).
//!
//! The same data give the same bytes: no clock, no system fonts, no random ids.

mod axis;
mod backbone_plot;
mod chart;
mod contact_loops;
mod curve_plot;
mod heat_map;
mod image;
mod labels;
mod legend;
mod loop_plot;
mod orbit_plot;
mod parameter_plot;
mod peak_plot;
pub mod pen;
mod response;
mod scaling_plot;
mod sheet;
mod truncation_plot;

pub use axis::Axis;
pub use backbone_plot::{BackbonePlot, write_backbone};
pub use chart::{BOTTOM, BOTTOM_BARE, Chart, Curve, TOP};
pub use contact_loops::{ContactLoop, ContactLoops, write_contact_loops};
pub use curve_plot::{CurvePanel, CurvePlot, write_curve};
pub use heat_map::{HeatMap, Parameter, write_heat_map};
pub use image::write;
pub use loop_plot::{LoopPlot, write_loop};
pub use orbit_plot::{OrbitPanel, OrbitPlot, write_orbit};
pub use parameter_plot::{ParameterPlot, write_parameter};
pub use peak_plot::{HighestPeak, PeakPlot, PeakPlotCurve, write_peaks};
pub use pen::Pen;
pub use response::{Panel, Response, write_response};
pub use scaling_plot::{ScalingPlot, write_scaling};
pub use sheet::{COLUMN, sheet};
pub use truncation_plot::{TruncationPlot, write_truncation};
