//! Scenes: a short text file describes the bodies in contact, the effects to include and the requested
//! results; nothing else is computed.
//!
//! # What it computes
//!
//! A scene asks a [`Question`]: `[scene]` (models, material, surface, loads or a path), `[effects]`, `[outputs]`,
//! `[models.NAME]` (numerics) and `[sampling]`. It is read from TOML, set key by key, or written in Rust. With the
//! files that it names it is a [`SceneFile`]. [`Plan`] says what will be computed, what will
//! not and why, and what it will cost. [`run`] solves the scene with every model that it names and writes
//! `results.csv`, `manifest.json` and the files that the scene requests. [`info`] describes the contents of a
//! file, and [`GeneratedSurface`] writes a random surface into one. A [`Registry`] adds the user's own models
//! to those that scenes can name. The mechanics are those of the model crates; the program `fractal-contact`
//! is a thin layer on this library.
//!
//! ```
//! use fractal_contact::scenes::{Options, Plan, SceneFile, run};
//! use runs::{CsvFile, Silent};
//!
//! // Hertz: F = (4/3) E* sqrt(R) d^1.5 = 1 at d = 0.8254818122 (E* = R = 1).
//! let text = "[scene]\nunits = \"none\"\nmodels = [\"hertz\", \"mdr1d\"]\ncontact_modulus = 1\nforce = 1\n\
//!             [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 4\n";
//! let scene = SceneFile::parse("hertz.toml".as_ref(), text.into())?;
//! let out = std::env::temp_dir().join(format!("fractal-contact-doc-{}", std::process::id()));
//! let options = Options { out: out.clone(), threads: 1, fresh: false };
//! let outcome = run(&scene, &Plan::new(&scene)?, &options, &Silent, &contact_model::never)?;
//! let approach = CsvFile::read(&outcome.files[0])?.numbers("approach")?;
//! assert!(approach.iter().flatten().all(|d| (d - 0.8254818122).abs() < 1e-9));
//! # std::fs::remove_dir_all(out).ok();
//! # Ok::<(), fractal_contact::scenes::Error>(())
//! ```
//!
//! # Conventions
//!
//! * Physical scenes give every dimensional number with its unit (`"70 GPa"`), results are in SI; `units =
//!   "none"` takes plain numbers in any consistent units. A number without a unit is an error, as is a unit
//!   where there should be none.
//! * Loads are `force`, `force_bar` (F/(E* h L) with each surface's own measured rms height; rough surfaces
//!   only), `mean_pressure`, `approach` or, with periodic boundaries, `mean_gap`: one number, a list, or `{
//!   from, to, count }`, logarithmic unless `spacing = "linear"`. They are solved in the order given;
//!   increasing is the fastest.
//! * Effects that depend on the path (friction, rheology) need `[[scene.path]]` instead: the ends of straight
//!   pieces, each with `states` points. A quantity that a step does not name keeps its value. One that a
//!   step prescribes in place of another (an approach after a force) begins at its value in the state that
//!   was reached.
//! * `[scene.surface]` is random (`self_affine`) or a `file`; `[scene.body]` is a sphere, cone, ...; with
//!   both, their heights are added.
//! * `side = s` is a square, `size = [Lx, Ly]` a rectangle; L is `sqrt(Lx Ly)`, mean pressure and contact
//!   fraction are over `Lx Ly`. Undefined points of a file are an error unless they are filled or kept
//!   (`undefined = "no_contact"`). NPY arrays are `[row, column]`, rows along y.
//! * Effects and outputs are off unless named. If a model lacks an effect or an output, that is an error
//!   before anything is computed; the message names the models that have it.
//! * A load outside a model's range has a row with the reason (`status` is `refused`), and the other loads
//!   are solved.
//! * `results.csv` has the same bytes for any number of threads; after an interruption, states that follow
//!   the kept ones of a surface agree within the tolerance. Times and the machine are in `manifest.json`.
//!
//! # Errors
//!
//! A mistake in a scene is a [`Diagnostic`], and so is a note on a renamed key: it holds a message, the line
//! with the place underlined, and a remedy. Unknown keys are mistakes. The tables are read key by key rather
//! than derived, because a derived reader knows neither units nor remedies, and loses the place of a value in
//! an enum.
//!
//! # How accurate, how fast
//!
//! The accuracy is that of the models; the plan states it for each. Reading, planning and writing take
//! milliseconds. [`Plan::calibrated`] predicts the cost: it solves a few of the loads on a grid of a quarter of
//! the cells (at most 257, at most 3 s) and scales by measured exponents, within a factor of six on the scenes
//! of `data/scenes`, files and pictures apart. [`Plan::for_run`] does so only where the sizes of the scene and
//! stored times predict more than 5 s. No grid is chosen by these times: [`SceneFile::with_grid_for_accuracy`]
//! compares a budget with times that are compiled in.
//!
//! # What it does not do
//!
//! No mechanics of its own, no error budgets of means (the figures of the paper have them).

mod answer;
mod plan;
mod read;
mod run;
mod tell;

pub use analysis::AccuracyTarget;
pub use answer::{RunInMemory, run, run_in_memory, run_scene_shard};
pub use plan::calibration::{required_memory, seconds_of_rough_sweep};
pub use plan::cost::Cost;
pub use plan::model_on_surface::FORMAT;
pub use plan::scene_plan::{ModelPlan, Plan, PredictedFrom, check};
pub use read::accuracy_target::RequestedAccuracy;
pub use read::asked_surface::{AskedBody, AskedFile, AskedSecond, AskedSelfAffine, AskedSurface};
pub use read::diagnostic::Diagnostic;
pub use read::distributed::Distributed;
pub use read::effects::{EFFECT_KEYS, EffectKey, EffectLine, effect_lines, parse_effects};
pub use read::entries::System;
pub use read::error::{Error, Result};
pub use read::generated_surface::{AskedTwin, GeneratedSurface, write_map, write_twin};
pub use read::key::SceneKey;
pub use read::load_kind::PrescribedLoad;
pub use read::loads::{AskedLoads, LoadList, LoadRequest};
pub use read::missing_keys::{MissingKey, missing_keys};
pub use read::numerics::Numerics;
pub use read::outputs::{FieldFormat, RequestedOutputs};
pub use read::path::{AskedStep, PathPiece};
pub use read::question::{AskedSampling, Material, Question, meant_by_flag, meant_by_output, scene_keys};
pub use read::random_surface::{RandomSpectrum, RandomSurface};
pub use read::registered_model::RegisteredModel;
pub use read::registry::Registry;
pub use read::scene_file::{Sampling, SceneFile};
pub use read::scene_surface::SceneSurface;
pub use run::ensemble::{jobs_of_scenes, solve_jobs, solve_jobs_in_order};
pub use run::outcome::{Options, SceneOutcome};
pub use run::pilot::SharedStop;
pub use run::scene_job::{SceneJob, jobs};
pub use run::state_result::ModelResult;
pub use run::warnings::{StateNotes, Warning};
pub use tell::info::{DescribedFile, describe_file, info, info_json, info_statistics};
pub use tell::page::page_parts;
