//! Figures as a journal prints them: the forced response, a measured loop and the scaling laws, as SVG or PNG.
//!
//! The corridor: data ([`Response`], [`LoopPlot`], [`ScalingPlot`]) → [`Chart`](chart::Chart), one pair of boxed axes with its curves,
//! drawn by kuva → [`sheet`], charts side by side, one SVG → [`image`], PNG by resvg with its own fonts, written
//! whole or not at all.
//!
//! The same data give the same bytes: no clock, no system fonts, no random ids.

mod axis;
mod chart;
mod image;
mod legend;
mod loop_plot;
mod pen;
mod response;
mod scaling_plot;
mod sheet;

pub use loop_plot::{LoopPlot, write_loop};
pub use response::{Panel, Response, write_response};
pub use scaling_plot::{ScalingPlot, write_scaling};
