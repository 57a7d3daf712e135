//! Scenes: a short text file says what is pressed, what is asked and which effects count; only that is computed.

#![allow(clippy::format_push_string, clippy::format_collect)] // Text is built once per file: clear beats one allocation less.

mod columns;
mod effects;
mod entries;
mod error;
mod info;
mod loads;
mod make;
mod manifest;
mod numerics;
mod outputs;
mod pictures;
mod plan;
mod relief;
mod run;
mod scan;
mod scene_file;
mod store;
mod trouble;
mod unit;

pub use effects::{EffectLine, effect_lines};
pub use entries::System;
pub use error::{Error, Result};
pub use info::info;
pub use loads::{Loads, Prescribed, Request};
pub use make::Make;
pub use numerics::{AnyModel, Numerics};
pub use outputs::{Asked, Format};
pub use plan::{Cost, ModelPlan, Plan, check};
pub use relief::Relief;
pub use run::{Halt, Options, Outcome, run};
pub use scene_file::{Chance, SceneFile};
pub use trouble::Trouble;
