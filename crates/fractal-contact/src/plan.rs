//! What will be computed, what will not and why, and what it will cost.

use crate::effects::{EffectLine, effect_lines};
use crate::error::{Error, Result};
use crate::loads::Request;
use crate::numerics::{AnyModel, Numerics};
use crate::outputs::Asked;
use crate::scene_file::SceneFile;
use crate::trouble::Trouble;
use crate::unit::{Unit, probe};
use contact_model::Surface;
use std::fmt;
use std::time::{Duration, Instant};

/// Cells a side, and elements, of the solves that the cost is predicted from.
const CALIBRATION_CELLS: usize = 65;
/// A large grid is predicted from a quarter of its cells a side, at most these.
const LARGEST_CALIBRATION: usize = 257;
const CALIBRATION_ELEMENTS: usize = 1 << 12;
const WARM_CELLS: usize = 17;
/// Loads solved for it at most, spread over those asked for.
const CALIBRATION_LOADS: usize = 4;
/// It stops by itself after this time.
const CALIBRATION_TIME: Duration = Duration::from_secs(3);
/// Time of one load over cells a side: N^1.9 to N^2.6 as measured by `cargo xtask bench --scaling`.
const TIME_EXPONENT: f64 = 2.3;
/// Applications of the operator over cells a side, as measured by the same.
const APPLICATIONS_EXPONENT: f64 = 0.3;
/// Memory of one solve of bem3d per cell of the grid, in bytes: heights, tables, transforms of the bounding box when contact fills it.
const BYTES_PER_CELL: f64 = 250.0;

/// What a run costs, or will cost.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cost {
    /// Seconds of one thread.
    pub seconds: f64,
    /// Memory of one thread at the peak, bytes; 0 where nothing to speak of.
    pub memory: f64,
    /// Applications of the elastic operator.
    pub applications: f64,
    /// Linear systems solved.
    pub linear_solves: f64,
    /// Fields over the grid.
    pub fields: f64,
    /// Their bytes.
    pub field_bytes: f64,
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
    /// An estimate for all surfaces and loads; `None` before calibration.
    pub predicted: Option<Cost>,
}

/// What a scene will do.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The comment at the head of the scene.
    pub shows: String,
    /// What is pressed.
    pub relief: String,
    /// What was understood of its file.
    pub understood: Option<String>,
    /// E*.
    pub modulus: f64,
    /// Whether numbers are in SI.
    pub units: &'static str,
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
}

/// Checks that every model can answer the scene, on small grids.
///
/// # Errors
/// [`Error::Scene`] at the name of the first model that cannot, with those that can.
pub fn check(scene: &SceneFile) -> Result<()> {
    for model in 0..scene.models.len() {
        let unit = Unit { model, surface: 0 };
        if let Err(error) = unit.probe(scene) {
            return Err(scene.at_model(model, refused(scene, &error)).into());
        }
    }
    if scene.asked.mean_gap && scene.effects.boundary != contact_model::Boundary::Periodic {
        let trouble = Trouble::new("a mean gap is asked for, but the boundary is free")
            .with_help("add `boundary = \"periodic\"` to [effects], or ask for the `gap` field");
        return Err(scene.at_output("mean_gap", trouble).into());
    }
    Ok(())
}

fn refused(scene: &SceneFile, error: &contact_model::Error) -> Trouble {
    let able: Vec<&str> = Numerics::ALL
        .iter()
        .filter(|m| m.is_history() == scene.is_history())
        .map(|m| m.reduced(CALIBRATION_CELLS, CALIBRATION_ELEMENTS))
        .filter(|m| probe(scene, m, true).is_ok())
        .map(|m| m.name())
        .collect();
    let help = if able.is_empty() {
        "no model answers all of it: remove an effect, an output or the model from `models`".to_owned()
    } else {
        format!("models that answer all of this scene: {}; or remove the effect or output", able.join(", "))
    };
    Trouble::new(error.to_string()).with_help(help)
}

impl Plan {
    /// The plan of a scene without prediction.
    ///
    /// # Errors
    /// As [`check`].
    pub fn new(scene: &SceneFile) -> Result<Self> {
        check(scene)?;
        let models = scene
            .models
            .iter()
            .map(|m| ModelPlan {
                name: m.name(),
                grid: grid(scene, m),
                accuracy: m.accuracy(scene.relief.is_rough(), cells(scene, m)),
                predicted: None,
            })
            .collect();
        Ok(Self {
            shows: scene.comment(),
            relief: scene.relief.describe(),
            understood: scene.understood.clone(),
            modulus: scene.modulus,
            units: match scene.system {
                crate::System::Si => "SI (m, N, Pa, s)",
                crate::System::None => "none: the scene's own",
            },
            states: scene.request.count(),
            surfaces: scene.chance.surfaces,
            effects: effect_lines(&scene.effects),
            outputs: scene.asked.lines(),
            models,
        })
    }

    /// The plan with what it will cost, from small solves of the same kind here and now. Takes a few seconds at most.
    ///
    /// # Errors
    /// As [`check`].
    pub fn calibrated(scene: &SceneFile) -> Result<Self> {
        let mut plan = Self::new(scene)?;
        for (numerics, model) in scene.models.iter().zip(&mut plan.models) {
            model.predicted = Some(predict(scene, numerics));
        }
        Ok(plan)
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

fn grid(scene: &SceneFile, numerics: &Numerics) -> String {
    match numerics {
        Numerics::Bem3d(_) | Numerics::Equivalent(_) => {
            let n = cells(scene, numerics);
            format!("{n} x {n} cells of {:.4e}", scene.relief.side() / n as f64)
        }
        Numerics::Mdr1d(m) if scene.relief.is_rough() => format!("a line of {} elements", m.elements),
        _ => "none: a formula".into(),
    }
}

/// Cells a side: a given map brings its own.
fn cells(scene: &SceneFile, numerics: &Numerics) -> usize {
    match &scene.relief {
        crate::Relief::Plain(Surface::Heights(map)) => map.cells(),
        _ => numerics.size(),
    }
}

/// Time and work of a small twin, scaled. What a small grid refuses is not predicted: its run will tell.
fn predict(scene: &SceneFile, numerics: &Numerics) -> Cost {
    let coarse = (cells(scene, numerics) / 4).clamp(CALIBRATION_CELLS, LARGEST_CALIBRATION);
    let small = numerics.reduced(coarse, CALIBRATION_ELEMENTS);
    // Code and memory that are touched for the first time are no part of what grows with N.
    let warm = numerics.reduced(WARM_CELLS, CALIBRATION_ELEMENTS);
    let _ = small_solves(scene, &warm, WARM_CELLS, &contact_model::never);
    let asked = scene.request.count();
    let total = (asked * scene.chance.surfaces) as f64;
    let begin = Instant::now();
    let stop = || begin.elapsed() > CALIBRATION_TIME;
    let (solved, size) = small_solves(scene, &small, coarse, &stop).unwrap_or_default();
    let mut cost = Cost { seconds: begin.elapsed().as_secs_f64(), ..solved.cost };
    let n = cells(scene, numerics) as f64;
    let per_state = total / (solved.states.max(1)) as f64;
    let (time, applications) = match numerics {
        Numerics::Bem3d(_) | Numerics::Equivalent(_) if size > 0 => {
            let ratio = n / size as f64;
            (ratio.powf(TIME_EXPONENT), ratio.powf(APPLICATIONS_EXPONENT))
        }
        Numerics::Mdr1d(m) => (m.elements as f64 / small.size().max(1) as f64, 1.0),
        _ => (1.0, 1.0),
    };
    let surfaces = scene.chance.surfaces as f64;
    // A line is sorted once, whatever the loads.
    cost.seconds *= time * if matches!(numerics, Numerics::Mdr1d(_)) { surfaces } else { per_state };
    cost.applications *= applications * per_state;
    cost.linear_solves *= per_state;
    cost.fields *= per_state;
    let outputs = &scene.asked.outputs;
    if let Numerics::Bem3d(_) | Numerics::Equivalent(_) = numerics {
        let fields =
            [outputs.pressure, outputs.displacement, outputs.gap].iter().filter(|f| **f).count() as f64;
        cost.fields = fields * total;
        cost.field_bytes = cost.fields * n * n * 8.0;
        cost.memory = n * n * (BYTES_PER_CELL + 8.0 * fields);
    }
    cost
}

#[derive(Default)]
struct Solved {
    states: usize,
    cost: Cost,
}

/// A few of the loads on a small grid; the second number is its cells a side.
fn small_solves(
    scene: &SceneFile,
    numerics: &Numerics,
    coarse: usize,
    stop: &dyn Fn() -> bool,
) -> contact_model::Result<(Solved, usize)> {
    let seed = scene.seed(0);
    let mut physics = scene.scene(numerics, seed)?;
    let mut size = numerics.size();
    if let Surface::Heights(map) = &physics.surface {
        size = map.cells().min(coarse);
        if map.cells() > coarse {
            physics.surface = Surface::Heights(std::sync::Arc::new(thinned(map, coarse)?));
        }
    }
    let mut solved = Solved::default();
    match (numerics.model(), &scene.request) {
        (AnyModel::Contact(model), Request::Loads(loads)) => {
            let mut contact = model.prepare(&physics, seed)?;
            let scales = contact.scales();
            let count = loads.values.len();
            let used = count.min(CALIBRATION_LOADS);
            for i in 0..used {
                let asked = loads.values[i * (count - 1) / (used - 1).max(1)];
                let Ok(state) = loads.load(asked, &scales).and_then(|load| contact.solve_until(load, stop))
                else {
                    continue;
                };
                solved.states += 1;
                solved.cost.applications += state.report.applications as f64;
                solved.cost.linear_solves += state.report.work.linear_solves as f64;
            }
        }
        (AnyModel::History(model), Request::Path(steps)) => {
            let mut contact = model.prepare(&physics, seed)?;
            for step in steps {
                if stop() || contact.advance(*step).is_err() {
                    break;
                }
                solved.states += 1;
            }
        }
        _ => {}
    }
    Ok((solved, size))
}

/// Every so many-th cell of a map.
fn thinned(map: &contact_model::HeightMap, m: usize) -> contact_model::Result<contact_model::HeightMap> {
    let n = map.cells();
    let at = |i: usize| i * n / m;
    let heights = (0..m * m).map(|i| map.heights()[at(i / m) * n + at(i % m)]).collect();
    contact_model::HeightMap::new(m, map.side(), heights)
}

/// A time in words.
pub(crate) fn time(seconds: f64) -> String {
    match seconds {
        s if s < 1e-3 => "under 1 ms".into(),
        s if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        s if s < 120.0 => format!("{s:.1} s"),
        s if s < 7200.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

/// A number of bytes in words.
pub(crate) fn memory(bytes: f64) -> String {
    match bytes {
        b if b < 1e3 => format!("{b:.0} bytes"),
        b if b < 1e6 => format!("{:.0} kB", b / 1e3),
        b if b < 1e9 => format!("{:.0} MB", b / 1e6),
        b => format!("{:.1} GB", b / 1e9),
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

impl fmt::Display for Plan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.shows.is_empty() {
            writeln!(f, "{}\n", self.shows)?;
        }
        writeln!(f, "relief    {}", self.relief)?;
        for line in self.understood.iter().flat_map(|u| u.lines()) {
            writeln!(f, "          {line}")?;
        }
        writeln!(f, "modulus   {} (E*)", self.modulus)?;
        writeln!(f, "units     {}", self.units)?;
        writeln!(f, "states    {} on each of {} surface(s)", self.states, self.surfaces)?;
        writeln!(f, "\neffects")?;
        for line in &self.effects {
            writeln!(f, "  {:10} {:4} {}", line.name, if line.on { "on" } else { "off" }, line.reason)?;
        }
        let names = |asked: bool| {
            let list: Vec<&str> = self.outputs.iter().filter(|(_, a)| *a == asked).map(|(n, _)| *n).collect();
            if list.is_empty() { "none".to_owned() } else { list.join(", ") }
        };
        writeln!(
            f,
            "\noutputs\n  computed   force, approach or gap prescribed with it, certificate; {}",
            names(true)
        )?;
        writeln!(f, "  not asked for, so not computed or stored: {}", names(false))?;
        writeln!(f, "\nmodels")?;
        for model in &self.models {
            writeln!(
                f,
                "  {}\n    grid       {}\n    accuracy   {}",
                model.name, model.grid, model.accuracy
            )?;
            if let Some(cost) = &model.predicted {
                writeln!(f, "    estimate   {cost}")?;
            }
        }
        if let Some(cost) = self.predicted() {
            write!(f, "\nestimate    {} on one thread", time(cost.seconds))?;
            if cost.memory > 0.0 {
                write!(f, ", {} of memory for each thread", memory(cost.memory))?;
            }
            writeln!(
                f,
                " (from small solves on this machine, scaled as N^{TIME_EXPONENT}: within a factor of three)"
            )?;
        }
        Ok(())
    }
}

impl Asked {
    /// Whether any file besides the tables is asked for.
    pub fn any_field_file(&self) -> bool {
        !(self.pressure.is_empty() && self.displacement.is_empty() && self.gap.is_empty())
    }
}

impl Error {
    /// Whether it is a mistake in a scene.
    pub fn is_scene(&self) -> bool {
        matches!(self, Self::Scene(_))
    }
}
