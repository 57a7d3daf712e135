//! What will be computed, what will not and why, and what it will cost.

use crate::scenes::plan::model_on_surface::MILLISECONDS_OF_PICTURE;
use crate::scenes::plan::{Assumptions, Cost, ModelOnSurface, calibration, probe};
use crate::scenes::read::{
    Diagnostic, EffectLine, LoadRequest, Numerics, PrescribedLoad, Result, SceneFile, System, amount, cells,
    description, effect_lines, short, words,
};
use bem3d::UNRESOLVED_RANGE;
use contact_model::units::{ascii, number, rounded};
use contact_model::{Adhesion, Boundary, Cells, Hardness, NormalLoad, Step, Surface};
use runs::amounts::{duration, memory, time};
use std::fmt;

/// What a predicted cost rests on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PredictedFrom {
    /// The sizes of the scene and times that are compiled in. Operator applications and linear solves, which
    /// are not predicted then, are 0 in [`Cost`].
    Sizes,
    /// Small solves of the same kind, made for the plan.
    SmallSolves,
}

impl PredictedFrom {
    /// In words, with what the prediction is worth.
    pub fn words(self) -> &'static str {
        match self {
            Self::Sizes => "from the sizes and times stored in the program, within a factor of ten",
            Self::SmallSolves => {
                "from small solves on this machine, scaled with the cells, within a factor of six"
            }
        }
    }
}

/// What one model will do.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelPlan {
    /// Its name.
    pub name: &'static str,
    /// Its grid.
    pub grid: String,
    /// What to expect of its numbers.
    pub accuracy: String,
    /// Predicted for all surfaces and loads; `None` before a prediction.
    pub predicted: Option<Cost>,
}

/// What a scene will do.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The comment at the head of the scene.
    pub shows: String,
    /// What is pressed.
    pub surface: String,
    /// Metadata of its file.
    pub metadata: Option<String>,
    /// The map of a file as it is solved: after crop, fill and detrend; `None` for other surfaces and for
    /// maps of more than 4096 x 4096 cells.
    pub prepared: Option<surface_io::Description>,
    /// Remarks on the scene.
    pub notes: Vec<Diagnostic>,
    /// E*, and which bodies have it.
    pub contact_modulus: String,
    /// What lies outside of the rectangle.
    pub boundary: Boundary,
    /// The body below the roughness, in words; empty without one.
    on_body: String,
    /// Whether numbers carry units.
    pub system: System,
    /// Number of states for each surface, and of surfaces.
    pub states: usize,
    /// Surfaces.
    pub surfaces: usize,
    /// Every effect, on or off.
    pub effects: Vec<EffectLine>,
    /// Every output, asked for or not.
    pub outputs: Vec<(&'static str, bool)>,
    /// The models in their order.
    pub models: Vec<ModelPlan>,
    /// Seconds of one thread for pictures of fields and distributions, which are not in the predicted costs.
    pub seconds_of_pictures: f64,
    /// What the predicted costs rest on; `None` before a prediction.
    pub predicted_from: Option<PredictedFrom>,
}

/// Checks that every model can answer the scene, on small grids.
///
/// # Errors
/// [`crate::scenes::Error::Scene`] at the name of the first model that cannot, with those that can.
pub fn check(scene: &SceneFile) -> Result<()> {
    if scene.requested.outputs.mean_gap && scene.effects.boundary != contact_model::Boundary::Periodic {
        let diagnostic = Diagnostic::new("a mean gap is requested, but the boundary is free")
            .with_help("add `boundary = \"periodic\"` to [effects], or request the `gap` field");
        return Err(scene.at_output("mean_gap", diagnostic).into());
    }
    for model in 0..scene.models.len() {
        let unit = ModelOnSurface { model, surface: 0 };
        if let Err(error) = unit.probe(scene) {
            return Err(match &error {
                contact_model::Error::OutOfRange { name, .. } if name == UNRESOLVED_RANGE => {
                    scene.at_effect("adhesion", unresolved(scene, &error))
                }
                _ => scene.at_model(model, refused(scene, &error)),
            }
            .into());
        }
    }
    Ok(())
}

/// Cells too large for the range of an attraction.
fn unresolved(scene: &SceneFile, error: &contact_model::Error) -> Diagnostic {
    Diagnostic::new(words::refusal(scene, error)).with_help(
        "more cells, a smaller part of the surface or a longer `range`; without `range` the adhesion is of short range (JKR), which any cell resolves",
    )
}

fn refused(scene: &SceneFile, error: &contact_model::Error) -> Diagnostic {
    if !matches!(error, contact_model::Error::Unsupported { .. }) {
        return Diagnostic::new(words::refusal(scene, error))
            .with_help("check the numbers of [scene] and of the model");
    }
    let able: Vec<&str> = Numerics::all()
        .map(|m| m.probe(scene.surface.size()))
        .filter(|m| probe(scene, m).is_ok())
        .map(|m| m.name())
        .collect();
    let help = if able.is_empty() {
        "no model answers all of it: remove an effect, an output or the model from `models`".to_owned()
    } else {
        format!("models that answer all of this scene: {}; or remove the effect or output", able.join(", "))
    };
    Diagnostic::new(error.to_string()).with_help(help)
}

impl Plan {
    /// The plan of a scene without prediction.
    ///
    /// # Errors
    /// As [`check`].
    pub fn new(scene: &SceneFile) -> Result<Self> {
        check(scene)?;
        let assumptions = Assumptions::measured(scene);
        let unconfirmed = |m: &Numerics| match m {
            Numerics::Bem3d(_) if scene.is_unconfirmed => "; error of the grid estimated, not confirmed",
            _ => "",
        };
        let taken = |m: &Numerics| assumptions.as_ref().map_or_else(String::new, |a| a.taken(m));
        let models = scene
            .models
            .iter()
            .map(|m| ModelPlan {
                name: m.name(),
                grid: grid(scene, m),
                accuracy: m.accuracy(cells(scene, m)) + &taken(m) + unconfirmed(m),
                predicted: None,
            })
            .collect();
        let prepared = prepared(scene);
        let of_slopes = of_slopes(scene.system, prepared.as_ref());
        Ok(Self {
            shows: scene.comment(),
            surface: scene.surface.describe(scene.system),
            metadata: scene.metadata.clone(),
            prepared,
            notes: scene
                .notes
                .iter()
                .cloned()
                .chain(assumptions.iter().flat_map(|a| a.notes(scene)))
                .chain(of_slopes)
                .chain(beyond_hardness(scene))
                .chain(without_grid_error(scene))
                .chain(small_tabor_parameter(scene))
                .collect(),
            contact_modulus: words::contact_modulus(scene),
            boundary: scene.effects.boundary,
            on_body: on_body(scene),
            system: scene.system,
            states: scene.request.count(),
            surfaces: scene.sampling.surfaces,
            effects: effect_lines(&scene.effects, scene.system),
            outputs: scene.requested.lines(),
            models,
            seconds_of_pictures: seconds_of_pictures(scene),
            predicted_from: None,
        })
    }

    /// In which units files hold their numbers.
    pub fn units(&self) -> &'static str {
        match self.system {
            System::Si => "SI in files (m, N, Pa, s)",
            System::None => "none: the scene's own",
        }
    }

    /// The map as it is solved, without the exponent: the reports give the exponent of the statistics instead,
    /// which has an interval and knows where the spectrum ends.
    pub(crate) fn as_solved(&self) -> Option<surface_io::Description> {
        Some(self.prepared.clone()?.without_fit())
    }

    /// The plan with what it will cost, from small solves of the same kind here and now. Takes a few seconds
    /// at most.
    ///
    /// # Errors
    /// As [`check`].
    pub fn calibrated(scene: &SceneFile) -> Result<Self> {
        calibration::jobs_in_memory(scene, 1)?;
        let mut plan = Self::new(scene)?;
        for (numerics, model) in scene.models.iter().zip(&mut plan.models) {
            model.predicted = Some(calibration::predict(scene, numerics));
        }
        plan.predicted_from = Some(PredictedFrom::SmallSolves);
        Ok(plan)
    }

    /// The plan of a scene that is solved at once: where its sizes predict some seconds at most, small solves
    /// would take as long as the scene, and there are none.
    ///
    /// # Errors
    /// As [`check`].
    pub fn for_run(scene: &SceneFile) -> Result<Self> {
        calibration::jobs_in_memory(scene, 1)?;
        let costs: Option<Vec<Cost>> =
            (0..scene.models.len()).map(|model| calibration::from_sizes(scene, model)).collect();
        let Some(costs) =
            costs.filter(|costs| costs.iter().map(|cost| cost.seconds).sum::<f64>() <= FEW_SECONDS)
        else {
            return Self::calibrated(scene);
        };
        let mut plan = Self::new(scene)?;
        for (cost, model) in costs.into_iter().zip(&mut plan.models) {
            model.predicted = Some(cost);
        }
        plan.predicted_from = Some(PredictedFrom::Sizes);
        Ok(plan)
    }

    /// The plan in a line, for this many threads: models, grids, boundary, states and predicted time.
    pub fn line(&self, threads: usize) -> String {
        let of_model = |model: &ModelPlan| match model.grid.as_str() {
            NO_GRID | OWN_GRID => model.name.to_owned(),
            grid => format!("{}, {grid}", model.name),
        };
        let models: Vec<String> = self.models.iter().map(of_model).collect();
        let boundary = match self.boundary {
            Boundary::Periodic => "periodic boundary",
            Boundary::PeriodicAlongX => "boundary periodic along x",
            Boundary::PeriodicAlongY => "boundary periodic along y",
            _ => "free boundary",
        };
        let states = if self.states == 1 { "1 state".to_owned() } else { format!("{} states", self.states) };
        let surfaces =
            if self.surfaces > 1 { format!(" on each of {} surfaces", self.surfaces) } else { String::new() };
        let time = self.predicted().map_or_else(String::new, |cost| {
            let at_once = threads.clamp(1, self.models.len() * self.surfaces);
            match (cost.seconds + self.seconds_of_pictures) / at_once as f64 {
                seconds if seconds < 1.0 => ", less than 1 s".to_owned(),
                seconds => format!(", about {}", duration(seconds)),
            }
        });
        let then = if models.len() > 1 { ";" } else { "," };
        format!("{}{then} {boundary}{}, {states}{surfaces}{time}", models.join("; "), self.on_body)
    }

    /// What is predicted of a model, in words.
    pub fn predicted_words(&self, model: &ModelPlan) -> Option<String> {
        let cost = model.predicted?;
        Some(match self.predicted_from {
            Some(PredictedFrom::Sizes) => time(cost.seconds),
            _ => cost.to_string(),
        })
    }

    /// The sum over the models.
    pub fn predicted(&self) -> Option<Cost> {
        self.models.iter().map(|m| m.predicted).try_fold(Cost::default(), |sum, cost| {
            let cost = cost?;
            Some(Cost {
                seconds: sum.seconds + cost.seconds,
                memory: sum.memory.max(cost.memory),
                applications: sum.applications + cost.applications,
                linear_solves: sum.linear_solves + cost.linear_solves,
                fields: sum.fields + cost.fields,
                field_bytes: sum.field_bytes + cost.field_bytes,
            })
        })
    }
}

/// Below this many seconds of predicted work a scene is solved without small solves before it.
const FEW_SECONDS: f64 = 5.0;
/// What stands in place of a grid where a model has none, and where it is not known here.
const NO_GRID: &str = "none: a formula";
const OWN_GRID: &str = "the model's own";
/// Its spectrum takes seconds and three times its memory on the largest map.
const LARGEST_DESCRIBED: usize = 1 << 24;
/// A common range of van der Waals forces, in metres, and the smallest of Tabor's parameters of which adhesion of short
/// range is an approximation of some per cent.
const RANGE_OF_ATTRACTION: f64 = 0.3e-9;
const SHORT_RANGE: f64 = 5.0;
/// Largest rms slope of which linear elasticity of half-spaces is an approximation of some per cent.
const SMALL_SLOPE: f64 = 0.3;
/// Below it a unit or a size is more often wrong than a surface so smooth; chosen, not measured.
const FLAT_SLOPE: f64 = 3e-4;

/// Without units, heights may have a scale of their own.
pub(crate) fn of_slopes(system: System, map: Option<&surface_io::Description>) -> Option<Diagnostic> {
    let slope = map?.rms_slope;
    let (what, help) = if slope > SMALL_SLOPE {
        (
            "every model here assumes small slopes",
            "If they are, take the results as those of a linear theory: slopes above 0.3 are not small.",
        )
    } else if slope > 0.0 && slope < FLAT_SLOPE {
        (
            "few surfaces are that smooth",
            "If they are, a mean pressure of E* times the slope closes nearly all of the contact.",
        )
    } else {
        return None;
    };
    let message = format!("the rms slope of the map is {}, and {what}", short(slope));
    let help = format!("Are the unit of the heights and the size of the map right? {help}");
    (system == System::Si).then(|| Diagnostic::note(message).with_help(help))
}

/// The body below the roughness, in words that follow a comma's phrase.
fn on_body(scene: &SceneFile) -> String {
    match scene.body().filter(|_| scene.surface.is_rough()) {
        Some(Surface::Sphere { radius, .. }) => {
            format!(", on a sphere of radius {}", ascii(&amount(*radius, scene.system.shown("m"))))
        }
        Some(body) => format!(", on a {}", body.kind()),
        None => String::new(),
    }
}

/// A mean pressure at which every cell is at the hardness: models refuse such a state.
fn beyond_hardness(scene: &SceneFile) -> Option<Diagnostic> {
    let Hardness::Limit { pressure } = scene.effects.hardness else { return None };
    let area = scene.surface.size().area();
    let (means, rest): (Vec<f64>, _) = match &scene.request {
        LoadRequest::Loads(loads) => {
            let area = match loads.kind {
                PrescribedLoad::MeanPressure => 1.0,
                PrescribedLoad::Force => area,
                PrescribedLoad::ForceBar | PrescribedLoad::Approach | PrescribedLoad::MeanGap => return None,
            };
            (loads.values.iter().map(|value| value / area).collect(), "The other loads are solved.")
        }
        LoadRequest::Path(_) => {
            let mean = |step: &Step| match step.load.normal {
                NormalLoad::Force(force) => Some(force / area),
                _ => None,
            };
            (scene.request.ends().filter_map(mean).collect(), "The path ends before this step.")
        }
    };
    let largest = means.into_iter().filter(|&mean| mean >= pressure).max_by(f64::total_cmp)?;
    let [largest, hardness] =
        [largest, pressure].map(|value| ascii(&amount(value, scene.system.shown("Pa"))));
    let message = format!(
        "a mean pressure of {largest} cannot be reached: at the hardness of {hardness} every cell flows"
    );
    Some(Diagnostic::note(message).with_help(format!("Use a smaller load or a larger `hardness`. {rest}")))
}

/// An adhesion of short range of a ball so hard or so small that the attraction would reach across its gaps.
fn small_tabor_parameter(scene: &SceneFile) -> Option<Diagnostic> {
    let Adhesion::ShortRange { work } = scene.effects.adhesion else { return None };
    let Some(Surface::Sphere { radius, .. }) = scene.body() else { return None };
    let elastic = work / scene.contact_modulus;
    let parameter = (radius * elastic * elastic / RANGE_OF_ATTRACTION.powi(3)).cbrt();
    if scene.system != System::Si || !(parameter > 0.0 && parameter < SHORT_RANGE) {
        return None;
    }
    let message = format!(
        "Tabor's parameter of the ball is {} where the attraction has a range of 0.3 nm: adhesion of short range (JKR) is that of values above {SHORT_RANGE}",
        number(rounded(parameter, 2))
    );
    let help = "Give the range: `adhesion = { work = ..., range = \"0.3 nm\" }`, and use the model `maugis_dugdale` for a smooth ball or `bem3d` for a rough one.";
    Some(scene.at_effect("adhesion", Diagnostic::note(message).with_help(help)))
}

/// An error of the grid that is requested where none is estimated.
fn without_grid_error(scene: &SceneFile) -> Option<Diagnostic> {
    let estimated = |numerics: &Numerics| matches!(numerics, Numerics::Bem3d(_));
    let (why, help) = match scene.request {
        _ if !scene.requested.grid_error => return None,
        LoadRequest::Path(_) => ("along a path", "Compare with a run on smaller cells."),
        LoadRequest::Loads(_) if scene.models.iter().any(estimated) => return None,
        LoadRequest::Loads(_) => {
            ("without the model `bem3d`", "Add `bem3d` to the models, or compare with a run on another grid.")
        }
    };
    let message =
        format!("the error of the grid is not estimated {why}: the columns `_grid_error` stay empty");
    Some(scene.at_output("grid_error", Diagnostic::note(message).with_help(help)))
}

/// Seconds of one thread that the pictures of the fields of all states and of distributions take.
fn seconds_of_pictures(scene: &SceneFile) -> f64 {
    let of_model = |model: usize| {
        let cost = ModelOnSurface { model, surface: 0 }.cost_of_pictures(scene);
        cost as f64 * scene.surfaces_of(&scene.models[model]) as f64
    };
    let fields: f64 = (0..scene.models.len()).map(of_model).sum();
    1e-3 * (fields + MILLISECONDS_OF_PICTURE * scene.requested.distributions.len() as f64)
}

fn prepared(scene: &SceneFile) -> Option<surface_io::Description> {
    let map = scene.surface.given_map().filter(|map| map.heights().len() <= LARGEST_DESCRIBED)?;
    Some(description(map, scene.system))
}

fn grid(scene: &SceneFile, numerics: &Numerics) -> String {
    match numerics {
        Numerics::Bem3d(_) if scene.accuracy.is_some() && !scene.requested.grid_error => {
            "chosen for the accuracy when it is planned".into()
        }
        Numerics::Bem3d(_) | Numerics::Equivalent(_) => {
            let (cells, size) = (cells(scene, numerics), scene.surface.size());
            let Cells { columns, rows } = cells;
            let (dx, dy) = (size.x / columns as f64, size.y / rows as f64);
            let [across, down] = [dx, dy].map(|side| ascii(&amount(side, scene.system.shown("m"))));
            if dx.to_bits() == dy.to_bits() {
                format!("{columns} x {rows} cells of {across}")
            } else {
                format!("{columns} x {rows} cells of {across} x {down}")
            }
        }
        Numerics::Mdr1d(m) if scene.surface.is_rough() => format!("a line of {} elements", m.elements),
        Numerics::Registered(_) => OWN_GRID.into(),
        _ => NO_GRID.into(),
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}, {} operator applications, {} linear solves, {} fields ({})",
            time(self.seconds),
            whole(self.applications),
            whole(self.linear_solves),
            whole(self.fields),
            memory(self.field_bytes)
        )
    }
}

fn whole(v: f64) -> String {
    format!("{v:.0}")
}

impl Plan {
    /// The surface, the bodies, and how many states are solved.
    fn write_question(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "surface   {}", ascii(&self.surface))?;
        for line in self.metadata.iter().flat_map(|u| u.lines()) {
            writeln!(f, "          {line}")?;
        }
        if let Some(description) = self.as_solved() {
            writeln!(f, "as solved")?;
            for line in description.to_string().lines() {
                writeln!(f, "          {line}")?;
            }
        }
        writeln!(f, "material  {}", self.contact_modulus)?;
        writeln!(f, "units     {}", self.units())?;
        match self.surfaces {
            1 => writeln!(f, "states    {} on one surface", self.states)?,
            surfaces => writeln!(f, "states    {} on each of {surfaces} surfaces", self.states)?,
        }
        writeln!(f, "\neffects")?;
        for line in &self.effects {
            let on = if line.on { "on" } else { "off" };
            writeln!(f, "  {:10} {on:4} {}", line.name, ascii(&line.reason))?;
        }
        Ok(())
    }

    /// Writes the outputs that are computed, and those that are not.
    fn write_outputs(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |requested: bool| {
            let list: Vec<&str> =
                self.outputs.iter().filter(|(_, a)| *a == requested).map(|(n, _)| *n).collect();
            if list.is_empty() { "none".to_owned() } else { list.join(", ") }
        };
        writeln!(
            f,
            "\noutputs\n  computed   force, approach or gap prescribed with it, certificate; {}",
            names(true)
        )?;
        writeln!(f, "  not requested, so not computed or stored: {}", names(false))
    }
}

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.shows.is_empty() {
            writeln!(f, "{}\n", self.shows)?;
        }
        for note in &self.notes {
            writeln!(f, "{note}\n")?;
        }
        self.write_question(f)?;
        self.write_outputs(f)?;
        writeln!(f, "\nmodels")?;
        for model in &self.models {
            writeln!(
                f,
                "  {}\n    grid       {}\n    accuracy   {}",
                model.name, model.grid, model.accuracy
            )?;
            if let Some(cost) = self.predicted_words(model) {
                writeln!(f, "    estimate   {cost}")?;
            }
        }
        if let Some(cost) = self.predicted() {
            write!(f, "\nestimate    {} on one thread", time(cost.seconds))?;
            if cost.memory > 0.0 {
                write!(f, ", {} of memory for each thread", memory(cost.memory))?;
            }
            let from = self.predicted_from.map_or("", PredictedFrom::words);
            writeln!(f, " ({from}; files and pictures come on top)")?;
        }
        Ok(())
    }
}
