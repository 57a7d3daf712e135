//! Curves drawn from the states.

use crate::scenes::read::{LoadRequest, PrescribedLoad, SceneFile, cycles, depends_on_path, words};
use crate::scenes::run::{StateRecord, Warning, rests_on_few_cells};
use crate::scenes::tell::{Mean, StateTable, columns, ensemble, smooth_ball};
use contact_model::quantities::StateQuantity;
use contact_model::{Adhesion, Boundary, Hardness};
use plots::{Chart, Curve};

/// The quantity along the horizontal axis.
#[derive(Clone, Copy)]
enum HorizontalAxis {
    StateQuantity(&'static StateQuantity),
    /// The number that the loads prescribe, where it is no quantity: a mean pressure.
    Load,
}

/// A chart for every requested quantity that varies, with its name, followed by that of the deviations, which
/// there is where the curves of several models coincide. The files are `curve-NAME.svg` and `.png`.
pub(crate) fn charts(states: &StateTable<'_>) -> Vec<(String, Chart)> {
    let scene = states.scene;
    let mut charts = Vec::new();
    for (x, y) in pairs(scene) {
        let chart = chart(states, x, y);
        if chart.curves.iter().any(|c| varies(&c.points)) {
            let deviation = deviation(scene, &chart, y);
            charts.push((y.name.to_owned(), chart));
            charts.extend(deviation.map(|chart| (format!("{}{DEVIATION}", y.name), chart)));
        }
    }
    charts
}

/// Ending of the names of pictures of deviations.
const DEVIATION: &str = "-deviation";
/// Curves that differ by less than this share everywhere cannot be distinguished in one chart.
const TOGETHER: f64 = 0.1;

/// The deviations of all curves from the first one in per cent, where the curves cannot be distinguished.
fn deviation(scene: &SceneFile, chart: &Chart, y: &'static StateQuantity) -> Option<Chart> {
    let [first, others @ ..] = &chart.curves[..] else { return None };
    if scene.is_history() || others.is_empty() {
        return None;
    }
    let of = |curve: &Curve| -> Option<Curve> {
        let pairs = || curve.points.iter().zip(&first.points);
        let same =
            curve.points.len() == first.points.len() && pairs().all(|(a, b)| (a.0 / b.0 - 1.0).abs() < HELD);
        let points: Vec<(f64, f64)> = pairs().map(|(a, b)| (a.0, 100.0 * (a.1 / b.1 - 1.0))).collect();
        let together = points.iter().all(|point| point.1.abs() < 100.0 * TOGETHER);
        let careful = points.iter().zip(&curve.points).filter(|(_, point)| curve.careful.contains(point));
        let careful = careful.map(|(shown, _)| *shown).collect();
        (same && together).then(|| Curve { label: curve.label.clone(), points, careful, ..Curve::default() })
    };
    let curves = chart.curves.iter().map(of).collect::<Option<Vec<Curve>>>()?;
    // Equal formulas differ only by rounding.
    let differ = curves.iter().flat_map(|curve| &curve.points).any(|point| point.1.abs() > 100.0 * HELD);
    if !differ {
        return None;
    }
    let shown = if y.symbol.is_empty() { y.words.to_owned() } else { format!("${}$", y.symbol) };
    Some(Chart {
        title: format!("{}, difference from {}", chart.title, first.label),
        y_label: format!("{shown} above that of {} (%)", first.label),
        subtitle: words::scene_name(scene),
        curves,
        ..chart.clone()
    })
}

/// The names of all files of [`charts`].
pub(crate) fn curve_files(scene: &SceneFile) -> Vec<String> {
    let names = pairs(scene).into_iter().map(|(_, y)| y.name);
    let names = names.flat_map(|y| ["", DEVIATION].map(|kind| format!("curve-{y}{kind}")));
    names.flat_map(|name| ["svg", "png"].map(|end| format!("{name}.{end}"))).collect()
}

/// The pairs of quantities that are drawn: each quantity over the load, over the time, or over the quantity
/// of a loop. Of a history over time with cycles the force is drawn over the distance.
fn pairs(scene: &SceneFile) -> Vec<(HorizontalAxis, &'static StateQuantity)> {
    let drawn = || columns::asked(scene).filter(|quantity| quantity.drawn);
    let named = |name: &str| columns::asked(scene).find(|quantity| quantity.name == name);
    let over = |x: &'static str| -> Vec<(HorizontalAxis, &'static StateQuantity)> {
        let Some(axis) = named(x) else { return Vec::new() };
        drawn().filter(|y| y.name != x).map(|y| (HorizontalAxis::StateQuantity(axis), y)).collect()
    };
    if let LoadRequest::Loads(loads) = &scene.request {
        // A force that is prescribed in another form is not a result.
        let answers = |pairs: Vec<(HorizontalAxis, &'static StateQuantity)>| {
            pairs.into_iter().filter(|(_, y)| y.name != "force").collect()
        };
        return match loads.kind {
            PrescribedLoad::Force => over("force"),
            PrescribedLoad::ForceBar => answers(over("force_bar")),
            PrescribedLoad::MeanPressure => answers(drawn().map(|y| (HorizontalAxis::Load, y)).collect()),
            PrescribedLoad::Approach => over("approach"),
            PrescribedLoad::MeanGap => over("mean_gap"),
        };
    }
    let distance = if scene.effects.boundary == Boundary::Periodic { "mean_gap" } else { "approach" };
    let force_loop =
        named(distance).zip(named("force")).map(|(d, force)| (HorizontalAxis::StateQuantity(d), force));
    if depends_on_path(&scene.effects) {
        // The loop of the force, and everything else over the force.
        let rest = over("force").into_iter().filter(|(_, y)| y.name != distance);
        return force_loop.into_iter().chain(rest).collect();
    }
    if scene.effects.friction == contact_model::Friction::Off {
        let mut pairs = over("time");
        // Of cycles the loop of the force says more than the force over time.
        if let Some(force_loop) = force_loop.filter(|_| !cycles(scene.request.pieces()).is_empty()) {
            pairs.retain(|(_, y)| y.name != "force");
            pairs.insert(0, force_loop);
        }
        return pairs;
    }
    over(if scene.request.shears() == [false, true] {
        "tangential_displacement_y"
    } else {
        "tangential_displacement"
    })
}

/// A quantity that changes by less than this share of its largest value counts as constant: the rest is the
/// tolerance of the solver.
const HELD: f64 = 1e-5;

/// Whether a curve varies. A constant (such as a prescribed force), a single state or a curve over a constant
/// time is not drawn.
fn varies(points: &[(f64, f64)]) -> bool {
    let changes = |of: fn(&(f64, f64)) -> f64| {
        let ends = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        let (low, high) = points.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        high - low > HELD * low.abs().max(high.abs())
    };
    changes(|p| p.0) && changes(|p| p.1)
}

impl HorizontalAxis {
    /// Its name in words and its symbol.
    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::StateQuantity(quantity) => (quantity.words, quantity.symbol),
            Self::Load => ("mean pressure", "\\bar{p}"),
        }
    }

    fn unit(self, scene: &SceneFile) -> &'static str {
        match self {
            Self::StateQuantity(quantity) => columns::column(scene, quantity).unit,
            Self::Load => columns::prescribed(scene).map_or("1", |column| column.unit),
        }
    }

    /// The label without a unit.
    fn label(self) -> String {
        let (words, symbol) = self.words();
        if symbol.is_empty() { words.to_owned() } else { format!("{words} ${symbol}$") }
    }

    fn of_mean(self, mean: &Mean) -> Option<f64> {
        match self {
            Self::StateQuantity(quantity) => Some(mean.of(quantity)?.0),
            Self::Load => mean.prescribed,
        }
    }
}

/// The curves in a chart of a quantity: the quantity itself and, for an area, also the corrected area, which
/// is smaller because boundary cells count in part.
fn drawn_with(scene: &SceneFile, y: &'static StateQuantity) -> Vec<(&'static StateQuantity, &'static str)> {
    let corrected = columns::asked(scene).find(|quantity| quantity.name == "area_corrected");
    match corrected {
        Some(corrected) if y.name == "area" => vec![(y, ", as counted"), (corrected, ", corrected")],
        _ => vec![(y, "")],
    }
}

/// The states of one model.
fn curve(
    states: &StateTable<'_>,
    model: &'static str,
    (x, y): (HorizontalAxis, &'static StateQuantity),
) -> Curve {
    let StateTable { scene, means, .. } = states;
    let shown = |(x, y): &(f64, f64)| scene.is_history() || (*x != 0.0 && *y != 0.0);
    let label = words::model_name(model).to_owned();
    if means.is_empty() {
        let records = states.of_model(model);
        let state = |record: &StateRecord| {
            let solved = record.solved()?;
            let number = |of: &StateQuantity| {
                of.number(&solved.state, &solved.normalisation).filter(|v| v.is_finite())
            };
            let x = match x {
                HorizontalAxis::StateQuantity(quantity) => number(quantity)?,
                HorizontalAxis::Load => scene.request.prescribed(record.index)?,
            };
            let error = solved.grid.as_ref().and_then(|grid| grid.of(y.name)).map(|error| error.error);
            Some(((x, number(y)?), (error, rests_on_few_cells(&solved.state))))
        };
        let states: Vec<_> = records.filter_map(state).filter(|(point, _)| shown(point)).collect();
        // The band is given by a factor, because an error larger than the value itself would have no lower
        // end on logarithmic axes.
        let end = |((x, y), (error, _)): &((f64, f64), (Option<f64>, bool))| {
            error.map(|error| (*x, y / (1.0 + error), y * (1.0 + error)))
        };
        let band = states.iter().filter_map(end).collect();
        let careful = states.iter().filter(|(_, (_, few))| *few && !scene.is_history());
        let careful = careful.map(|(point, _)| *point).collect();
        let mut points: Vec<(f64, f64)> = states.iter().map(|(point, _)| *point).collect();
        if begins_at_zero(scene, x) && points.first().is_some_and(|first| *first != (0.0, 0.0)) {
            points.insert(0, (0.0, 0.0));
        }
        return Curve { label, points, band, careful };
    }
    let of = || means.iter().filter(move |mean| mean.model == model && mean.surfaces > 0);
    let points = of().filter_map(|mean| Some((x.of_mean(mean)?, mean.of(y)?.0)));
    let band = of().filter_map(|mean| {
        let (x, (y, half)) = (x.of_mean(mean)?, mean.interval(y)?);
        Some((x, y - half?, y + half?))
    });
    Curve { label, points: points.filter(shown).collect(), band: band.collect(), ..Curve::default() }
}

/// Whether a chart of a path begins at zero, with the bodies apart: over time, so that the immediate response
/// to a step of the load is seen, and over a load that leaves an indentation.
fn begins_at_zero(scene: &SceneFile, x: HorizontalAxis) -> bool {
    let over = |name: &str| matches!(x, HorizontalAxis::StateQuantity(quantity) if quantity.name == name);
    let effects = &scene.effects;
    scene.is_history()
        && effects.boundary == Boundary::Free
        && effects.adhesion == Adhesion::Off
        && (over("time") || effects.hardness != Hardness::Off)
}

/// Over how many of the requested surfaces the means are, and what is shaded. An interrupted run has fewer.
fn mean_over(means: &[Mean], asked: usize, shaded: bool) -> String {
    let solved = |mean: &&Mean| mean.surfaces > 1 || asked == 1;
    let counts: Vec<usize> = means.iter().filter(solved).map(|mean| mean.surfaces).collect();
    let (few, many) = (counts.iter().min().copied(), counts.iter().max().copied());
    let surfaces = match (few, many) {
        (Some(few), Some(many)) if few == many && many < asked => format!("{few} of {asked}"),
        (Some(few), Some(many)) if few < many => format!("{few} to {many} of {asked}"),
        _ => asked.to_string(),
    };
    let shaded = match few.zip(many).filter(|_| shaded) {
        Some((few, many)) => format!("; shaded: 95 % interval {}", ensemble::distribution(few, many)),
        None => String::new(),
    };
    format!("; means over {surfaces} surfaces{shaded}")
}

fn chart(states: &StateTable<'_>, x: HorizontalAxis, y: &'static StateQuantity) -> Chart {
    let StateTable { scene, means, .. } = states;
    let quantities = drawn_with(scene, y);
    let of_model = |model: &'static str| {
        let curve =
            |(y, suffix): &(&'static StateQuantity, &'static str)| (curve(states, model, (x, y)), *suffix);
        let mut curves: Vec<(Curve, &str)> =
            quantities.iter().map(curve).filter(|(curve, _)| !curve.points.is_empty()).collect();
        // A model without cells has no corrected area.
        let several = curves.len() > 1;
        curves.iter_mut().filter(|_| several).for_each(|(curve, suffix)| curve.label += suffix);
        curves.into_iter().map(|(curve, _)| curve).collect::<Vec<_>>()
    };
    let mut curves: Vec<Curve> = scene.models.iter().flat_map(|m| of_model(m.name())).collect();
    let smooth = smooth_ball::states(scene);
    let points = smooth.iter().filter_map(|(index, state, normalisation)| {
        let x = match x {
            HorizontalAxis::StateQuantity(quantity) => quantity.number(state, normalisation)?,
            HorizontalAxis::Load => scene.request.prescribed(*index)?,
        };
        Some((x, y.number(state, normalisation)?))
    });
    let points: Vec<(f64, f64)> = points.collect();
    if !points.is_empty() {
        curves.push(Curve { label: smooth_ball::LABEL.into(), points, ..Curve::default() });
    }
    let mut title = format!("{} over {}", y.words, x.words().0);
    title[..1].make_ascii_uppercase();
    // A single load has no band.
    let shaded = curves.iter().any(|curve| curve.band.len() > 1);
    let surfaces = match scene.sampling.surfaces {
        1 if shaded => "; shaded: the estimated error of the grid, as a factor".to_owned(),
        1 => String::new(),
        asked => mean_over(means, asked, shaded),
    };
    Chart {
        title,
        subtitle: format!("{}{surfaces}", words::scene_name(scene)),
        x_label: x.label(),
        y_label: HorizontalAxis::StateQuantity(y).label(),
        curves,
        logarithmic: !scene.is_history(),
        directed: scene.is_history(),
        careful: Warning::FewCells.label().to_owned(),
    }
    .in_units([x, HorizontalAxis::StateQuantity(y)].map(|axis| axis.unit(scene)))
}

#[cfg(test)]
mod tests {
    use super::varies;

    #[test]
    fn constant_quantities_are_not_drawn() {
        let points = |values: &[f64]| (1_u8..).map(f64::from).zip(values.iter().copied()).collect::<Vec<_>>();
        assert!(!varies(&points(&[1.0])) && varies(&points(&[1.0, 1.1])) && varies(&points(&[0.0, 1e-300])));
        assert!(!varies(&[]) && !varies(&points(&[0.2, 0.2 + 1e-9])) && !varies(&points(&[0.0, 0.0])));
        assert!(!varies(&[(0.0, 1.0), (0.0, 2.0)]));
    }
}
