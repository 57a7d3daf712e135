//! A path of loads: straight pieces, each divided into steps while the path is followed.

use crate::scenes::read::key::{Context, Key, KeyTable};
use crate::scenes::read::{Entry, Places, PrescribedLoad, ReadResult, System, printed};
use contact_model::{ContactState, Error, Load, NormalLoad, Result, Size, Step, Tangential};
use surface_io::Dimension;

/// Largest number of loads or states; more are taken for a typing error.
pub(crate) const MOST: u64 = 10_000;
/// A value between two others that is smaller than this many roundings of the larger one is zero. The product
/// and the sum that make it have less than three.
const ROUNDINGS: f64 = 4.0;

/// A straight piece of a path.
///
/// Its states divide the way from where the path stands to its end into equal parts. A load that the piece
/// before prescribed as well begins at the value prescribed there. Where a piece prescribes another quantity
/// than the one before (an approach after a force), that quantity begins at its value in the state that was
/// reached, which each model and each surface has its own of.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPiece {
    /// Its end, which the last of its states has exactly.
    pub end: Step,
    /// Number of its states, >= 1.
    pub states: usize,
}

/// A piece with one state.
impl From<Step> for PathPiece {
    fn from(end: Step) -> Self {
        Self { end, states: 1 }
    }
}

/// The step that leads to a state of a path. `reached` gives the states before it by their number; only the
/// last state of the piece before is looked at, so that a path which is resumed has the same steps.
///
/// # Errors
/// [`Error::Unsupported`] with the name of the model where that state lacks the quantity that the piece
/// prescribes anew, [`Error::Domain`] for a state beyond the end of the path.
pub(crate) fn step_to<'a>(
    state: usize,
    pieces: &[PathPiece],
    model: &'static str,
    reached: impl Fn(usize) -> Option<&'a ContactState>,
) -> Result<Step> {
    let mut first = 0;
    let mut before: Option<Step> = None;
    for &PathPiece { end, states } in pieces {
        let part = state - first + 1;
        if part == states {
            return Ok(end);
        }
        if part < states {
            let from = match before {
                None => beginning(end),
                Some(before) => {
                    let stands = first.checked_sub(1).and_then(&reached);
                    let lacks = |quantity: &str| {
                        let what = format!(
                            "a piece of {states} states that begins to prescribe {quantity}: the state before it has none"
                        );
                        Error::unsupported(model, what)
                    };
                    let normal = normal_start(before.load.normal, end.load.normal, stands);
                    let tangential = tangential_start(before.load.tangential, end.load.tangential, stands);
                    let load =
                        Load { normal: normal.map_err(lacks)?, tangential: tangential.map_err(lacks)? };
                    Step { load, ..before }
                }
            };
            return Ok(between(from, end, part as f64 / states as f64));
        }
        first += states;
        before = Some(end);
    }
    Err(Error::domain("state", state as f64, format!("a number below {first}, the states of the path")))
}

/// The cycles of a path: the first and the last state of each, where the path has a corner and stands at the same
/// load.
///
/// A corner is an end of a piece behind which the load does not go on in the direction in which it came, so that
/// the way through a load is no end of a cycle. What comes before the first corner, the first loading, belongs to no
/// cycle. Cycles do not overlap.
pub(crate) fn cycles(pieces: &[PathPiece]) -> Vec<[usize; 2]> {
    let corners: Vec<usize> = (0..pieces.len()).filter(|&end| is_corner(pieces, end)).collect();
    let mut states = 0;
    let mut last_states = Vec::with_capacity(pieces.len());
    for piece in pieces {
        states += piece.states;
        last_states.push(states - 1);
    }
    let mut cycles = Vec::new();
    let mut first = 0;
    while let Some(&begin) = corners.get(first) {
        let load = pieces[begin].end.load;
        // A load that is held, while time passes, makes no cycle.
        let moves = |end: usize| pieces[begin + 1..end].iter().any(|piece| piece.end.load != load);
        match corners[first + 1..].iter().position(|&end| pieces[end].end.load == load && moves(end)) {
            Some(after) => {
                first += 1 + after;
                cycles.push([last_states[begin], last_states[corners[first]]]);
            }
            None => first += 1,
        }
    }
    cycles
}

/// Whether the end of a piece is a corner. That of the first piece is one where the load turns back alone, since a
/// tangential load usually begins there; the end of the path always is.
fn is_corner(pieces: &[PathPiece], end: usize) -> bool {
    let here = pieces[end].end.load;
    let Some(next) = pieces.get(end + 1) else { return true };
    let before = end.checked_sub(1).map_or_else(|| beginning(pieces[0].end), |before| pieces[before].end);
    let (Some(came), Some(goes)) = (change(before.load, here), change(here, next.end.load)) else {
        return end > 0;
    };
    let normal = came.0 * goes.0;
    let tangential = came.1[0] * goes.1[0] + came.1[1] * goes.1[1];
    let turns_back = normal < 0.0 || tangential < 0.0;
    turns_back || end > 0 && normal <= 0.0 && tangential <= 0.0
}

/// The change of the normal and of the tangential load, where both prescribe the same quantities.
fn change(from: Load, to: Load) -> Option<(f64, [f64; 2])> {
    let normal = match (from.normal, to.normal) {
        (NormalLoad::Force(a), NormalLoad::Force(b))
        | (NormalLoad::Approach(a), NormalLoad::Approach(b))
        | (NormalLoad::MeanGap(a), NormalLoad::MeanGap(b)) => b - a,
        _ => return None,
    };
    let tangential = match (from.tangential, to.tangential) {
        (Tangential::Force(a), Tangential::Force(b))
        | (Tangential::Displacement(a), Tangential::Displacement(b)) => [b[0] - a[0], b[1] - a[1]],
        _ => return None,
    };
    Some((normal, tangential))
}

/// The state without contact and load, with the quantities that the first step prescribes.
fn beginning(first: Step) -> Step {
    let normal = match first.load.normal {
        NormalLoad::Approach(_) => NormalLoad::Approach(0.0),
        // The distance at first touch is not known here.
        NormalLoad::MeanGap(gap) => NormalLoad::MeanGap(gap),
        _ => NormalLoad::Force(0.0),
    };
    let tangential = match first.load.tangential {
        Tangential::Displacement(_) => Tangential::Displacement([0.0; 2]),
        _ => Tangential::default(),
    };
    Step::new(0.0, Load { normal, tangential })
}

/// The normal load at which a piece begins; the name of the quantity that the reached state lacks otherwise.
fn normal_start(
    before: NormalLoad,
    end: NormalLoad,
    reached: Option<&ContactState>,
) -> std::result::Result<NormalLoad, &'static str> {
    match (before, end) {
        (NormalLoad::Force(_), NormalLoad::Force(_))
        | (NormalLoad::Approach(_), NormalLoad::Approach(_))
        | (NormalLoad::MeanGap(_), NormalLoad::MeanGap(_)) => Ok(before),
        (_, NormalLoad::Approach(_)) => {
            reached.and_then(|state| state.approach).map(NormalLoad::Approach).ok_or("an approach")
        }
        (_, NormalLoad::MeanGap(_)) => {
            reached.and_then(|state| state.mean_gap).map(NormalLoad::MeanGap).ok_or("a mean gap")
        }
        _ => reached.map(|state| NormalLoad::Force(state.force)).ok_or("a force"),
    }
}

/// As [`normal_start`], of the tangential load.
fn tangential_start(
    before: Tangential,
    end: Tangential,
    reached: Option<&ContactState>,
) -> std::result::Result<Tangential, &'static str> {
    let reached = reached.and_then(|state| state.tangential.as_ref());
    match (before, end) {
        (Tangential::Force(_), Tangential::Force(_))
        | (Tangential::Displacement(_), Tangential::Displacement(_)) => Ok(before),
        (_, Tangential::Displacement(_)) => reached
            .map(|state| Tangential::Displacement(state.displacement))
            .ok_or("a tangential displacement"),
        _ => reached.map(|state| Tangential::Force(state.force)).ok_or("a tangential force"),
    }
}

/// A point of a straight piece whose ends prescribe the same quantities.
fn between(from: Step, to: Step, t: f64) -> Step {
    let mix = |a: f64, b: f64| zero_if_rounded(a + (b - a) * t, [a, b]);
    let both = |a: [f64; 2], b: [f64; 2]| [mix(a[0], b[0]), mix(a[1], b[1])];
    let normal = match (from.load.normal, to.load.normal) {
        (NormalLoad::Force(a), NormalLoad::Force(b)) => NormalLoad::Force(mix(a, b)),
        (NormalLoad::Approach(a), NormalLoad::Approach(b)) => NormalLoad::Approach(mix(a, b)),
        (NormalLoad::MeanGap(a), NormalLoad::MeanGap(b)) => NormalLoad::MeanGap(mix(a, b)),
        (_, other) => other,
    };
    let tangential = match (from.load.tangential, to.load.tangential) {
        (Tangential::Force(a), Tangential::Force(b)) => Tangential::Force(both(a, b)),
        (Tangential::Displacement(a), Tangential::Displacement(b)) => Tangential::Displacement(both(a, b)),
        (_, other) => other,
    };
    Step::new(mix(from.time, to.time), Load { normal, tangential })
}

/// A value between two ends: exactly zero where it differs from that by the rounding of the ends alone, so
/// that a division which passes through zero meets it.
pub(crate) fn zero_if_rounded(value: f64, ends: [f64; 2]) -> f64 {
    let largest = ends[0].abs().max(ends[1].abs());
    if value.abs() <= ROUNDINGS * f64::EPSILON * largest { 0.0 } else { value }
}

/// A step of `[[scene.path]]`, by the keys that are given.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct AskedStep {
    /// End of a straight piece of the path.
    pub time: Option<f64>,
    /// Normal load there.
    pub normal: Option<(PrescribedLoad, f64)>,
    /// Tangential load there.
    pub tangential: Option<Tangential>,
    /// Number of equal parts of the piece.
    pub states: Option<u64>,
}

/// Keys of a step.
pub(crate) static PATH_KEYS: KeyTable<AskedStep> = KeyTable {
    name: "scene.path",
    kind: "",
    alternatives: &[
        &["force", "approach", "mean_pressure", "mean_gap"],
        &["tangential_force", "tangential_displacement"],
    ],
    everyday: &[],
    keys: &[
        Key {
            name: "time",
            takes: "time",
            about: "time at the end of this straight piece of the path",
            default: "that of the step before",
            read: |step, entry, context| {
                entry.quantity(Dimension::TIME, context.system).map(|time| step.time = Some(time))
            },
            print: |step, system| step.time.map(|time| printed::quantity(time, Dimension::TIME, system)),
        },
        Key {
            name: "force",
            takes: "force",
            about: "normal force at the end of the piece",
            default: "that of the step before",
            read: |step, entry, context| read_normal(step, PrescribedLoad::Force, entry, context),
            print: |step, system| print_normal(step, PrescribedLoad::Force, system),
        },
        Key {
            name: "mean_pressure",
            takes: "pressure",
            about: "force over the nominal contact area",
            default: "that of the step before",
            read: |step, entry, context| read_normal(step, PrescribedLoad::MeanPressure, entry, context),
            print: |step, system| print_normal(step, PrescribedLoad::MeanPressure, system),
        },
        Key {
            name: "approach",
            takes: "length",
            about: "approach of the bodies; free boundaries",
            default: "that of the step before",
            read: |step, entry, context| read_normal(step, PrescribedLoad::Approach, entry, context),
            print: |step, system| print_normal(step, PrescribedLoad::Approach, system),
        },
        Key {
            name: "mean_gap",
            takes: "length",
            about: "distance between the mean planes; periodic boundaries",
            default: "that of the step before",
            read: |step, entry, context| read_normal(step, PrescribedLoad::MeanGap, entry, context),
            print: |step, system| print_normal(step, PrescribedLoad::MeanGap, system),
        },
        Key {
            name: "tangential_force",
            takes: "force, or `[x, y]`",
            about: "tangential force along x, or along x and y; at most the [sliding force](friction.md#one-step-is-one-increment)",
            default: "that of the step before",
            read: |step, entry, context| {
                let force = read_tangential(entry, Dimension::FORCE, context.system)?;
                step.tangential = Some(Tangential::Force(force));
                Ok(())
            },
            print: |step, system| match step.tangential {
                Some(Tangential::Force(force)) => Some(print_pair(force, Dimension::FORCE, system)),
                _ => None,
            },
        },
        Key {
            name: "tangential_displacement",
            takes: "length, or `[x, y]`",
            about: "tangential displacement along x, or along x and y",
            default: "that of the step before",
            read: |step, entry, context| {
                let displacement = read_tangential(entry, Dimension::LENGTH, context.system)?;
                step.tangential = Some(Tangential::Displacement(displacement));
                Ok(())
            },
            print: |step, system| match step.tangential {
                Some(Tangential::Displacement(displacement)) => {
                    Some(print_pair(displacement, Dimension::LENGTH, system))
                }
                _ => None,
            },
        },
        Key {
            name: "states",
            takes: "whole number >= 1",
            about: "number of equal parts of the piece, each with a state at its end; a quantity prescribed anew begins at its value in the state reached",
            default: "1",
            read: |step, entry, _| entry.count(1).map(|states| step.states = Some(states)),
            print: |step, _| step.states.map(|states| states.to_string()),
        },
    ],
};

fn read_normal(
    step: &mut AskedStep,
    kind: PrescribedLoad,
    entry: &Entry<'_>,
    context: Context<'_>,
) -> ReadResult<()> {
    step.normal = Some((kind, entry.quantity(kind.record().1, context.system)?));
    Ok(())
}

fn print_normal(step: &AskedStep, kind: PrescribedLoad, system: System) -> Option<String> {
    let (_, value) = step.normal.filter(|(of, _)| *of == kind)?;
    Some(printed::quantity(value, kind.record().1, system))
}

fn print_pair(components: [f64; 2], dimension: Dimension, system: System) -> String {
    let component = |value| printed::quantity(value, dimension, system);
    match components {
        [x, y] if y.to_bits() == 0 => component(x),
        both => printed::list(&both.map(component)),
    }
}

/// Reads `[[scene.path]]`.
pub(crate) fn read_steps(entry: &Entry<'_>, context: Context<'_>) -> ReadResult<Vec<AskedStep>> {
    if !entry.is_list() {
        return Err(entry
            .diagnostic_at_key("`path` is no list of steps")
            .with_help("write [[scene.path]] once for each step"));
    }
    let step = |item: &Entry<'_>| -> ReadResult<AskedStep> {
        let (table, mut step) = (item.table()?, AskedStep::default());
        PATH_KEYS.read(&mut step, &table, context)?;
        table.finish()?;
        Ok(step)
    };
    entry.list().iter().map(step).collect()
}

/// The pieces of a path. `pulls` allows negative loads (adhesion). `size` is that of the nominal contact area,
/// for mean pressures.
pub(crate) fn pieces(
    steps: &[AskedStep],
    pulls: bool,
    size: Size,
    places: &Places,
) -> ReadResult<Vec<PathPiece>> {
    let mut pieces: Vec<PathPiece> = Vec::new();
    let mut last = Step::new(0.0, Load::force(0.0));
    let mut total = 0_u64;
    for (index, step) in steps.iter().enumerate() {
        let place = format!("scene.path.{index}");
        let normal = match step.normal {
            Some((PrescribedLoad::Force | PrescribedLoad::ForceBar, force)) => NormalLoad::Force(force),
            // The mean pressure times the nominal contact area, as for a list of mean pressures.
            Some((PrescribedLoad::MeanPressure, pressure)) => {
                NormalLoad::Force(pressure * size.length() * size.length())
            }
            Some((PrescribedLoad::MeanGap, gap)) => NormalLoad::MeanGap(gap),
            Some((PrescribedLoad::Approach, approach)) => NormalLoad::Approach(approach),
            None if pieces.is_empty() => {
                return Err(places
                    .at_value(&place, "the first step of the path has no normal load")
                    .with_help("give `force`, `mean_pressure`, `approach` or (periodic) `mean_gap`"));
            }
            None => last.load.normal,
        };
        let tangential = step.tangential.unwrap_or(last.load.tangential);
        let count = step.states.unwrap_or(1);
        if step.states.is_some() && count.saturating_add(total) > MOST {
            return Err(places
                .at_value(
                    &format!("{place}.states"),
                    format!("{count} states: expected at most {MOST} along the whole path"),
                )
                .with_help(
                    "states in between are increments of friction, and otherwise only shown: request fewer",
                ));
        }
        let end = Step::new(step.time.unwrap_or(last.time), Load { normal, tangential });
        let checked = if pulls { end.validated_with_adhesion(last.time) } else { end.validated(last.time) };
        checked.map_err(|error| {
            let help = match &error {
                Error::Domain { name, .. } if name == "time" => "times never decrease along a path",
                _ if pulls => "loads are finite numbers",
                _ => "loads are finite, and normal loads at least 0: only `adhesion` in [effects] lets a contact pull",
            };
            places.at_value(&place, error.to_string()).with_help(help)
        })?;
        total = total.saturating_add(count);
        pieces.push(PathPiece { end, states: count as usize });
        last = end;
    }
    if pieces.is_empty() {
        return Err(places
            .at_value("scene.path", "the path has no step")
            .with_help("write [[scene.path]] once for each step"));
    }
    Ok(pieces)
}

/// A tangential load: one number along x, or a pair along x and along y.
fn read_tangential(entry: &Entry<'_>, dimension: Dimension, system: System) -> ReadResult<[f64; 2]> {
    let component = |item: &Entry<'_>| item.quantity(dimension, system);
    match &entry.list()[..] {
        [x, y] => Ok([component(x)?, component(y)?]),
        [x] if !entry.is_list() => Ok([component(x)?, 0.0]),
        components => {
            let example = match (system, dimension) {
                (System::None, _) => "[25, 10]",
                (System::Si, Dimension::LENGTH) => "[\"2 um\", \"1 um\"]",
                (System::Si, _) => "[\"25 N\", \"10 N\"]",
            };
            let message = format!("a tangential load of {} components", components.len());
            let help = format!("give one value along x, or a pair along x and along y, such as {example}");
            Err(entry.diagnostic(message).with_help(help))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::read::{Entries, LoadRequest};
    use contact_model::{SolveReport, TangentialState};

    fn path(text: &str) -> ReadResult<Vec<PathPiece>> {
        let size = Size { x: 4.0, y: 1.0 };
        Entries::of_text("scene", text, |scene| {
            let context = Context { system: System::None, own: &[] };
            let steps = read_steps(&scene.require("path", "")?, context)?;
            pieces(&steps, true, size, &Places::default())
        })
    }

    /// All steps of a path whose states are all `reached`.
    fn steps(pieces: &[PathPiece], reached: Option<&ContactState>) -> Result<Vec<Step>> {
        let count = pieces.iter().map(|piece| piece.states).sum();
        (0..count).map(|state| step_to(state, pieces, "mine", |_| reached)).collect()
    }

    fn state() -> ContactState {
        ContactState::new(0.75, SolveReport::exact("test"))
    }

    #[test]
    fn cycles_are_between_corners_of_equal_load() {
        let of = |loads: &str| {
            let text: String =
                loads.split(';').map(|load| format!("[[path]]\n{}\nstates = 2\n", load.trim())).collect();
            cycles(&path(&text).unwrap())
        };
        let tangential = |forces: &[&str]| {
            let pieces: Vec<String> =
                forces.iter().map(|force| format!("tangential_force = {force}")).collect();
            of(&format!("force = 3; {}", pieces.join("; ")))
        };
        // To and fro, with the way through zero as a piece of its own or not. The first loading is no part of a cycle.
        assert_eq!(tangential(&["1", "-1", "1", "-1", "1"]), [[3, 7], [7, 11]]);
        assert_eq!(tangential(&["1", "0", "-1", "0", "1", "0"]), [[3, 11]]);
        assert_eq!(tangential(&["1", "0", "1", "0"]), [[3, 7]]);
        assert_eq!(tangential(&["1", "-1", "0.5"]), [[0; 2]; 0]);
        // By displacements, which begin at the first piece that prescribes them.
        assert_eq!(
            of(
                "force = 3; tangential_displacement = 1; tangential_displacement = -1; tangential_displacement = 1"
            ),
            [[3, 7]]
        );
        // Loading and unloading, and a load that goes round.
        assert_eq!(of("force = 3; force = 1; force = 3; force = 1"), [[1, 5]]);
        assert_eq!(of("force = 3; force = 1; force = 2; force = 1"), [[3, 7]]);
        assert_eq!(tangential(&["[1, 0]", "[0, 1]", "[-1, 0]", "[0, -1]", "[1, 0]"]), [[3, 11]]);
        // A load that is held is no cycle, and one that returns after it is.
        assert_eq!(of("force = 3; force = 3; force = 3"), [[0; 2]; 0]);
        assert_eq!(of("force = 3; force = 3; force = 1; force = 3"), [[3, 7]]);
        // No corner, or no path.
        assert_eq!(of("force = 1; force = 2; force = 3"), [[0; 2]; 0]);
        assert_eq!(cycles(&[]), [[0; 2]; 0]);
    }

    #[test]
    fn tangential_loads_have_two_components_and_every_part_mixes_both() {
        let pieces = path(
            "[[path]]\nmean_pressure = 3\n[[path]]\ntangential_force = [2, -4]\nstates = 2\n[[path]]\ntangential_force = 1\n\
             [[path]]\ntangential_displacement = [0.5, 0.25]",
        )
        .unwrap();
        let steps = steps(&pieces, None).unwrap();
        let tangential: Vec<Tangential> = steps.iter().map(|step| step.load.tangential).collect();
        let forces = [[0.0, 0.0], [1.0, -2.0], [2.0, -4.0], [1.0, 0.0]].map(Tangential::Force);
        assert_eq!(tangential[..4], forces);
        assert_eq!(tangential[4], Tangential::Displacement([0.5, 0.25]));
        // The mean pressure of a path is the force over the nominal area, and stays as it was.
        assert!(steps.iter().all(|step| step.load.normal == NormalLoad::Force(12.0)));
        assert_eq!(LoadRequest::Path(pieces).shears(), [true, true]);
        let along_x = path("[[path]]\nmean_gap = 1\ntangential_displacement = 2").unwrap();
        assert_eq!(along_x[0].end.load.normal, NormalLoad::MeanGap(1.0));
        assert_eq!(LoadRequest::Path(along_x).shears(), [true, false]);
        for wrong in ["[]", "[1]", "[1, 2, 3]", "[1, \"2 N\"]", "[1, nan]", "\"1 N\"", "{ x = 1 }"] {
            assert!(path(&format!("[[path]]\nforce = 1\ntangential_force = {wrong}")).is_err(), "{wrong}");
        }
    }

    /// Both quantities begin where the state stands, and end exactly where they are asked to.
    #[test]
    fn quantities_that_are_prescribed_anew_begin_at_the_state_reached() {
        let pieces = path(
            "[[path]]\ntime = 1\nforce = 2\ntangential_force = [0.5, 0.25]\n\
             [[path]]\ntime = 3\napproach = 0.1\ntangential_displacement = [-0.3, 0]\nstates = 4\n\
             [[path]]\nforce = 0.1\nstates = 2\n[[path]]\nmean_gap = 8\nstates = 2\n\
             [[path]]\ntangential_force = [0, 1]\nstates = 2",
        )
        .unwrap();
        let reached = state()
            .with_approach(0.5)
            .with_mean_gap(4.0)
            .with_tangential(TangentialState::new([0.25, -1.0], [0.5, 1.0]));
        let steps = steps(&pieces, Some(&reached)).unwrap();
        let approaches = [0.5 + (0.1 - 0.5) * 0.25, 0.3, 0.5 + (0.1 - 0.5) * 0.75, 0.1];
        let shifts = [[0.3, 0.75], [0.1, 0.5], [-0.1, 0.25], [-0.3, 0.0]];
        for (i, (step, (d, u))) in steps[1..5].iter().zip(approaches.into_iter().zip(shifts)).enumerate() {
            assert_eq!(step.load.normal, NormalLoad::Approach(d), "{i}");
            let Tangential::Displacement([x, y]) = step.load.tangential else { panic!("{step:?}") };
            assert!((x - u[0]).abs() < 1e-15 && (y - u[1]).abs() < 1e-15, "{i}: {step:?}");
            assert!((step.time - (1.5 + 0.5 * i as f64)).abs() < 1e-15, "{step:?}");
        }
        assert_eq!(steps[4], pieces[1].end);
        let normal: Vec<NormalLoad> = steps[5..].iter().map(|step| step.load.normal).collect();
        assert_eq!(normal[..2], [0.75 + (0.1 - 0.75) * 0.5, 0.1].map(NormalLoad::Force));
        assert_eq!(normal[2..], [6.0, 8.0, 8.0, 8.0].map(NormalLoad::MeanGap));
        assert!(steps[4..9].iter().all(|step| step.load.tangential == Tangential::Displacement([-0.3, 0.0])));
        assert_eq!(steps[9].load.tangential, Tangential::Force([0.125, 0.0]));
        assert_eq!(steps[10].load.tangential, Tangential::Force([0.0, 1.0]));
        let request = LoadRequest::Path(pieces);
        assert!(request.begins_at_mean_gap() && request.prescribes_distance());
        let continued = path("[[path]]\nmean_gap = 1\n[[path]]\nmean_gap = 2\nstates = 2").unwrap();
        assert!(!LoadRequest::Path(continued).begins_at_mean_gap());
    }

    /// From the beginning, and where the same quantity goes on, no state is looked at.
    #[test]
    fn quantities_that_go_on_begin_at_the_value_prescribed_before() {
        let pieces = path(
            "[[path]]\napproach = 0.2\ntangential_displacement = 0.4\nstates = 2\n[[path]]\napproach = 0.3\nstates = 2\n\
             [[path]]\napproach = -0.1\ntangential_displacement = 0\nstates = 4",
        )
        .unwrap();
        let steps = steps(&pieces, None).unwrap();
        let normal: Vec<NormalLoad> = steps.iter().map(|step| step.load.normal).collect();
        let last = [0.3 + (-0.1 - 0.3) * 0.25, 0.3 + (-0.1 - 0.3) * 0.5, 0.0, -0.1];
        assert_eq!(normal[..4], [0.1, 0.2, 0.2 + (0.3 - 0.2) * 0.5, 0.3].map(NormalLoad::Approach));
        assert_eq!(normal[4..], last.map(NormalLoad::Approach));
        assert_eq!(steps[0].load.tangential, Tangential::Displacement([0.2, 0.0]));
        assert_eq!(steps[3].load.tangential, Tangential::Displacement([0.4, 0.0]));
        assert_eq!(steps[5].load.tangential, Tangential::Displacement([0.2, 0.0]));
        let gap = path("[[path]]\nmean_gap = 2\nstates = 3").unwrap();
        assert!(
            self::steps(&gap, None).unwrap().iter().all(|step| step.load.normal == NormalLoad::MeanGap(2.0))
        );
        assert!(step_to(3, &gap, "mine", |_| None).unwrap_err().to_string().contains("below 3"));
    }

    /// 0.3 - 0.4 * 3/4 is 5.6e-17 in double precision.
    #[test]
    fn a_division_through_zero_meets_it_exactly() {
        for (from, to, states, zero) in
            [(0.3, -0.1, 4, 2), (-0.1, 0.3, 4, 0), (0.7, -0.1, 8, 6), (1.1, -2.2, 9, 2)]
        {
            let text = format!("[[path]]\nforce = {from}\n[[path]]\nforce = {to}\nstates = {states}");
            let steps = steps(&path(&text).unwrap(), None).unwrap();
            let NormalLoad::Force(force) = steps[1 + zero].load.normal else { panic!("{steps:?}") };
            assert_eq!(force.to_bits(), 0, "from {from} to {to}: {force:e}");
        }
        // What is small and no rounding stays.
        assert!(zero_if_rounded(1e-15, [1.0, -1.0]) > 0.0 && zero_if_rounded(-1e-300, [0.0, -1e-299]) < 0.0);
        assert_eq!(zero_if_rounded(-2e-16, [1.0, -1.0]).to_bits(), 0);
    }

    #[test]
    fn a_state_without_the_quantity_is_told_by_name() {
        for (first, then, quantity) in [
            ("force = 1", "approach = 2", "an approach"),
            ("force = 1", "mean_gap = 2", "a mean gap"),
            ("force = 1", "tangential_displacement = 2", "a tangential displacement"),
            ("force = 1\ntangential_displacement = 1", "tangential_force = 2", "a tangential force"),
        ] {
            let pieces =
                |states| path(&format!("[[path]]\n{first}\n[[path]]\n{then}\nstates = {states}")).unwrap();
            let refused = steps(&pieces(3), Some(&state())).unwrap_err().to_string();
            assert_eq!(
                refused,
                format!(
                    "the model mine does not support a piece of 3 states that begins to prescribe {quantity}: the state before it has none"
                )
            );
            // One state is the end itself.
            assert_eq!(steps(&pieces(1), None).unwrap().len(), 2);
        }
    }
}
