//! What a scene will do, with which grid, and what it will cost.

pub(crate) mod accuracy;
pub(crate) mod assumptions;
pub(crate) mod calibration;
pub(crate) mod cost;
pub(crate) mod grid_comparison;
pub(crate) mod model_on_surface;
pub(crate) mod scene_plan;
