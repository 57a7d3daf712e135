//! What a scene will do, with which grid, and what it will cost.

pub(crate) mod accuracy;
pub(crate) mod assumptions;
pub(crate) mod calibration;
pub(crate) mod cost;
pub(crate) mod grid_comparison;
pub(crate) mod interface_of_state;
pub(crate) mod model_on_surface;
pub(crate) mod scene_plan;
pub(crate) mod thresholds;

pub(crate) use accuracy::{Candidate, ErrorsOfStates, choose, within};
pub(crate) use assumptions::{Assumptions, is_tilted};
pub(crate) use cost::Cost;
pub(crate) use grid_comparison::{GridComparison, GridErrors, RMS_SLOPE, compared, on_grid, solved_map};
pub(crate) use interface_of_state::with_interface;
pub(crate) use model_on_surface::{FORMAT, ModelOnSurface, probe};
pub(crate) use scene_plan::{ModelPlan, Plan, PredictedFrom, check, of_slopes};
pub(crate) use thresholds::{RefinedThreshold, Threshold, refining_solves, thresholds_of};
