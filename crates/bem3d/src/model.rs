//! The boundary-element model behind the common traits.

mod last;
mod mean_gap;

use crate::active_set::{self, Guess, Limits, Problem, Solved, Target};
use crate::cells::CellSet;
use crate::seed;
use crate::stiffness::{self, Stiffness};
use crate::strategy;
use contact_model::{
    Boundary, Certificate, ContactModel, ContactState, Effects, Error, Fields, HeightMap, Load,
    Nondimensionalisation, Normalisation, Outputs, Patches, PreparedContact, Result, Scene, SolveReport,
    Source, Status, Stop, Surface, Work,
};
use last::Last;
use std::f64::consts::PI;
use std::sync::Arc;

/// Times that the contact set is settled further for the sake of the stiffness, and by how much each time: its error falls with the
/// certificate.
const TIGHTENINGS: usize = 5;
const TIGHTER: f64 = 0.5;
const TIGHTEST: f64 = 0.1;
/// Share of the tolerance that is aimed at.
const ENOUGH: f64 = 0.7;

/// A stiffness is solved again when its magnification turns out so many times the one that was expected.
const MISJUDGED: f64 = 1.5;
/// Name of the model.
const NAME: &str = "bem3d";

/// Numerics of the boundary-element model.
///
/// ```
/// use bem3d::Bem3d;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// // Two cells a side, all four in contact: k = 0.993186221 E* L (data/paper/VALUES.md).
/// let model = Bem3d { cells: 2, ..Bem3d::default() };
/// let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
/// let state = model.prepare(&scene, 0)?.solve(Load::Force(1.0))?;
/// assert!((state.stiffness.unwrap() - 0.993186221).abs() < 1e-9);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bem3d {
    /// Cells a side, N >= 1. Ignored where the scene brings its own map.
    pub cells: usize,
    /// Bound t of the certificate and of the estimated relative error of k ([`Certificate::meets`]).
    ///
    /// The certificate counts gaps in rms heights, so that at a prescribed force the approach is good to a few t (at worst about ten) of
    /// the rms height, not of itself: a light load on a rough surface wants a smaller t for a precise d.
    pub tolerance: f64,
    /// Rounds of the active set at most (each a handful of operator applications).
    pub rounds: usize,
    /// How small sets are solved.
    pub method: Method,
}

/// How the linear systems of one active set are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Method {
    /// Factor small sets, iterate on large ones: whichever is cheaper.
    #[default]
    Auto,
    /// Iterate always.
    Iterative,
    /// One grid and one operator, to compare with: no factors, no two-level sums, no coarse grids to begin on.
    SingleLevel,
}

impl Default for Bem3d {
    fn default() -> Self {
        Self { cells: 257, tolerance: 1e-6, rounds: 200, method: Method::Auto }
    }
}

impl ContactModel for Bem3d {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "A. E. H. Love, Phil. Trans. R. Soc. A 228, 377 (1929)",
                what: "displacement under uniform pressure on a rectangle",
            },
            Source {
                citation: "R. Pohrt, V. L. Popov, A. E. Filippov, Phys. Rev. E 86, 026710 (2012)",
                what: "problem, surfaces, normalisation (Eqs. 2-10)",
            },
        ]
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        scene.validate()?;
        let boundary = scene.effects.boundary;
        if boundary != Boundary::Periodic {
            scene.refuse_effects(NAME)?;
        }
        Effects { boundary: Boundary::Free, ..scene.effects }.refuse(NAME)?;
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return Err(Error::domain("tolerance", self.tolerance, "a number in (0, 1)"));
        }
        let map = match &scene.surface {
            Surface::Heights(map) => Arc::clone(map),
            Surface::Line { .. } => return Err(Error::unsupported(NAME, "a line (it needs a map)")),
            surface => surface_gen::height_map(surface, self.cells, seed)?,
        };
        let has_rms = matches!(scene.surface, Surface::SelfAffine(_) | Surface::Heights(_));
        Ok(Box::new(Prepared::new(*self, scene, &map, has_rms)?))
    }
}

/// One surface, ready to be pressed.
#[derive(Debug)]
struct Prepared {
    options: Bem3d,
    outputs: Outputs,
    problem: Problem,
    nondimensional: Nondimensionalisation,
    /// Unit of lengths normal to the surface: the rms height where there is one.
    height: f64,
    normalisation: Normalisation,
    /// Mean of z.
    mean: f64,
    last: Option<Last>,
    /// Mean gap at the load solved last, where the square repeats itself.
    gap: Option<(Load, f64)>,
}

impl Prepared {
    fn new(options: Bem3d, scene: &Scene, map: &HeightMap, has_rms: bool) -> Result<Self> {
        if map.rows() != map.columns() || !map.size().is_square() {
            return Err(Error::unsupported(NAME, "a rectangle or cells that are not square"));
        }
        if map.undefined() > 0 {
            return Err(Error::unsupported(NAME, "a map with undefined points"));
        }
        let highest = map.highest();
        // Differences first: an offset of the heights changes nothing.
        let mut z: Vec<f64> = map.heights().iter().map(|h| highest - h).collect();
        let rms = surface_gen::rms_height(&z);
        let height = if rms > 0.0 { rms } else { 1.0 };
        for z in &mut z {
            *z /= height;
        }
        let nondimensional = Nondimensionalisation::new(scene.modulus, map.dx(), height)?;
        let mean = z.iter().sum::<f64>() / z.len() as f64;
        let mut problem = Problem::new(map.columns(), Arc::new(z), scene.effects.boundary);
        problem.levels = options.method != Method::SingleLevel;
        problem.operators.two_levels &= problem.levels;
        let normalisation =
            Normalisation { modulus: scene.modulus, length: map.length(), height: has_rms.then_some(rms) };
        Ok(Self {
            options,
            outputs: scene.outputs,
            problem,
            nondimensional,
            height,
            normalisation,
            mean,
            last: None,
            gap: None,
        })
    }

    fn is_periodic(&self) -> bool {
        self.problem.operators.table().boundary() == Boundary::Periodic
    }

    /// The guess for a target: the tangent at the last state, or a cold start.
    fn guess(&mut self, target: Target, limits: Limits, stop: Stop<'_>) -> Guess {
        if let Some(last) = &self.last
            && let Some(guess) = last.predict(target)
        {
            let problem = &mut self.problem;
            if !problem.levels {
                return guess;
            }
            let promised = || active_set::promised(problem, &guess);
            if !strategy::start_anew(&last.contact, last.ratio(target), promised) {
                return guess;
            }
        }
        seed::cold(&mut self.problem, target, limits, stop)
    }

    /// The stiffness of a state from a guess of q and of k.
    fn tangent(
        &mut self,
        solved: &Solved,
        mut guess: Option<Vec<f64>>,
        k: Option<f64>,
        stop: Stop<'_>,
    ) -> Stiffness {
        if let Some(q) = solved.q.clone() {
            return stiffness::factored(&mut self.problem, solved, q);
        }
        let mut expected = k.map_or(1.0, |k| self.magnification(k));
        let mut steps = 0;
        loop {
            let tolerance = self.options.tolerance / expected;
            let mut tangent = stiffness::solve(&mut self.problem, solved, guess, tolerance, stop);
            steps += tangent.steps;
            tangent.steps = steps;
            let found = self.magnification(tangent.value);
            if found <= MISJUDGED * expected || tangent.q.is_empty() || stop() {
                return tangent;
            }
            expected = found;
            guess = Some(tangent.q);
        }
    }

    /// Relative error of k itself.
    fn stiffness_error(&self, tangent: &Stiffness) -> f64 {
        tangent.error() * self.magnification(tangent.value)
    }

    /// Pressure, and stiffness where asked for. The stiffness may call for a tighter pressure than the certificate does: as long as
    /// undecided cells could change it by more than the tolerance, the set is settled further.
    fn settle(&mut self, target: Target, mut limits: Limits, stop: Stop<'_>) -> (Solved, Option<Stiffness>) {
        let guess = self.guess(target, limits, stop);
        let mut solved = active_set::solve(&mut self.problem, target, guess, limits, stop);
        // Full contact of a periodic square has no finite stiffness.
        let full = self.is_periodic() && solved.contact.len() == self.problem.side.pow(2);
        if full || !self.outputs.needs_stiffness() {
            return (solved, None);
        }
        // The last state is not needed any more, and as large as the contact.
        let last = self.last.take();
        let k = last.as_ref().and_then(|last| last.tangent.as_ref()).map(|&(_, k)| k);
        let q = last.and_then(|last| last.tangent_at(&solved));
        let mut tangent = self.tangent(&solved, q, k, stop);
        for _ in 0..TIGHTENINGS {
            if solved.status != Status::Converged
                || self.stiffness_error(&tangent) <= self.options.tolerance
                || stop()
            {
                break;
            }
            // The state may be better than it was asked to be: begin there.
            let share = ENOUGH * self.options.tolerance / self.stiffness_error(&tangent);
            limits.tolerance =
                share.clamp(TIGHTEST, TIGHTER) * limits.tolerance.min(solved.look.evidence.worst());
            let steps = solved.steps + tangent.steps;
            let next = active_set::resume(&mut self.problem, target, &solved, limits, stop);
            if next.look.evidence.worst() >= solved.look.evidence.worst() {
                solved.steps += next.steps;
                break;
            }
            // The tighter state counts as converged when it meets the tolerance that was asked for.
            let converged = next.look.evidence.worst() <= self.options.tolerance;
            let status = if converged { Status::Converged } else { next.status };
            let q = next.contact.carry(&solved.contact, &tangent.q);
            solved = Solved { status, steps: next.steps + steps, ..next };
            tangent = self.tangent(&solved, Some(q), k, stop);
        }
        (solved, Some(tangent))
    }

    fn state(
        &mut self,
        solved: Solved,
        tangent: Option<Stiffness>,
        load_error: f64,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let force: f64 = solved.p.iter().sum();
        let periodic = self.is_periodic();
        let certificate = Certificate {
            duality_gap: solved.look.evidence.duality_gap,
            penetration: solved.look.evidence.penetration,
            complementarity: solved.look.evidence.complementarity,
            load_error,
            stiffness_error: tangent.as_ref().map(|t| self.stiffness_error(t)),
        };
        let met = certificate.meets(self.options.tolerance);
        let status = match solved.status {
            Status::Converged if met => Status::Converged,
            Status::Converged if stop() => Status::Stopped,
            Status::Converged => Status::Stagnated,
            other => other,
        };
        let fields = self.fields(&solved)?;
        let report = SolveReport {
            work: Work::of(std::mem::take(&mut self.problem.operators.solves), fields.as_ref()),
            status,
            strategy: self.problem.operators.describe(&solved),
            iterations: solved.steps + tangent.as_ref().map_or(0, |t| t.steps),
            applications: std::mem::take(&mut self.problem.operators.applications),
            contact_cells: Some(solved.contact.len()),
            certificate,
        };
        let state = ContactState {
            force: self.nondimensional.force(PI * force)?,
            approach: if periodic { None } else { Some(self.nondimensional.approach(solved.d)?) },
            stiffness: match &tangent {
                Some(t) => Some(self.nondimensional.stiffness(PI * t.value * self.magnification(t.value))?),
                None => None,
            },
            area: if self.outputs.area {
                Some(self.nondimensional.area(solved.contact.len() as f64)?)
            } else {
                None
            },
            conductance: None,
            patches: self.patches(&solved.contact)?,
            fields,
            report,
        }
        .completed(&self.outputs, self.normalisation.modulus)?;
        if status == Status::Converged {
            self.remember(solved, tangent);
            Ok(state)
        } else if status == Status::Stopped {
            Err(Error::Stopped { best: Some(Box::new(state)) })
        } else {
            Err(Error::NotConverged { best: Box::new(state) })
        }
    }

    fn fields(&mut self, solved: &Solved) -> Result<Option<Fields>> {
        if !self.outputs.any_field() {
            return Ok(None);
        }
        let count = self.problem.side * self.problem.side;
        let mut fields = Fields::default();
        if self.outputs.pressure {
            let mut p = vec![0.0; count];
            for (&i, &value) in solved.contact.index().iter().zip(&solved.p) {
                p[i as usize] = self.nondimensional.pressure(PI * value)?;
            }
            fields.pressure = Some(p);
        }
        if self.outputs.displacement || self.outputs.gap {
            let all = CellSet::new(self.problem.side, (0..count as u32).collect());
            let u = self.problem.operators.exact(&solved.contact, &solved.p, &all);
            // What the constant in the kernel adds to every displacement.
            let shift = self.problem.operators.table().shift() * solved.p.iter().sum::<f64>();
            let height = self.height;
            if self.outputs.gap {
                let z = self.problem.candidates.z();
                fields.gap = Some(u.iter().zip(z).map(|(u, z)| (u + z - solved.d) * height).collect());
            }
            if self.outputs.displacement {
                fields.displacement = Some(u.iter().map(|u| (u - shift) * height).collect());
            }
        }
        Ok(Some(fields))
    }

    /// Connected patches of the contact set, where asked for.
    fn patches(&self, contact: &CellSet) -> Result<Option<Patches>> {
        if !self.outputs.contact_patches {
            return Ok(None);
        }
        let boundary = self.problem.operators.table().boundary();
        let sizes = surface_gen::patches(self.problem.side, contact.index(), boundary);
        let areas =
            sizes.into_iter().map(|size| self.nondimensional.area(size as f64)).collect::<Result<_>>()?;
        Ok(Some(Patches::new(areas)))
    }

    /// The state before first touch, and at it.
    fn untouched(&self) -> ContactState {
        let count = self.problem.side * self.problem.side;
        let zeros = |wanted: bool| wanted.then(|| vec![0.0; count]);
        let gap = |z: &[f64], height: f64| z.iter().map(|z| z * height).collect();
        let fields = self.outputs.any_field().then(|| Fields {
            pressure: zeros(self.outputs.pressure),
            displacement: zeros(self.outputs.displacement),
            gap: self.outputs.gap.then(|| gap(self.problem.candidates.z(), self.height)),
        });
        let mut report = SolveReport::exact("no contact");
        report.contact_cells = Some(0);
        report.work = Work::of(0, fields.as_ref());
        ContactState {
            force: 0.0,
            approach: (!self.is_periodic()).then_some(0.0),
            stiffness: self.outputs.needs_stiffness().then_some(0.0),
            area: self.outputs.area.then_some(0.0),
            conductance: None,
            patches: self.outputs.contact_patches.then(Patches::default),
            fields,
            report,
        }
    }
}

impl PreparedContact for Prepared {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.gap = None;
        let target = match load.validated()? {
            Load::Force(f) => Target::Force(scaled("force", f, self.nondimensional.force_in(f) / PI)?),
            Load::Approach(d) if !self.is_periodic() => {
                Target::Approach(scaled("approach", d, self.nondimensional.approach_in(d))?)
            }
            Load::MeanGap(gap) if self.is_periodic() => {
                let state =
                    self.press_to(scaled("mean gap", gap, self.nondimensional.approach_in(gap))?, stop)?;
                self.gap = Some((load, gap));
                return Ok(state);
            }
            Load::Approach(_) => {
                let what = "an approach: a periodic contact has a mean gap (Load::MeanGap)";
                return Err(Error::unsupported(NAME, what));
            }
            other => return Err(Error::unsupported(NAME, format!("the load {other:?} (free boundaries)"))),
        };
        if matches!(target, Target::Force(x) | Target::Approach(x) if x <= 0.0) {
            self.gap = Some((load, self.nondimensional.approach(self.mean)?));
            return self.untouched().completed(&self.outputs, self.normalisation.modulus);
        }
        self.problem.operators.applications = 0;
        self.problem.operators.solves = 0;
        let (solved, tangent) = self.settle(target, self.limits(), stop);
        self.gap = Some((load, self.nondimensional.approach(self.gap_of(&solved))?));
        let miss = match target {
            Target::Force(asked) => ((solved.p.iter().sum::<f64>() - asked) / asked).abs(),
            Target::Approach(_) => 0.0,
        };
        self.state(solved, tangent, miss, stop)
    }

    fn mean_gap(&mut self, load: Load) -> Result<f64> {
        if !self.is_periodic() {
            return Err(Error::unsupported(NAME, "a mean gap (free boundaries)"));
        }
        if self.gap.is_none_or(|(at, _)| at != load) {
            self.solve(load)?;
        }
        self.gap.map(|(_, gap)| gap).ok_or_else(|| Error::unsupported(NAME, "a mean gap"))
    }
}

impl Prepared {
    fn limits(&self) -> Limits {
        Limits {
            tolerance: self.options.tolerance,
            height: self
                .normalisation
                .height
                .filter(|&h| h > 0.0)
                .map(|h| self.nondimensional.approach_in(h)),
            rounds: self.options.rounds,
            dense: self.options.method == Method::Auto,
        }
    }

    /// Keeps a state to begin the next from.
    fn remember(&mut self, solved: Solved, tangent: Option<Stiffness>) {
        let Solved { contact, p, d, .. } = solved;
        let force = p.iter().sum();
        let tangent = tangent.map(|t| (t.q, t.value));
        self.last = Some(Last { contact, p, d, force, tangent });
    }
}

/// A load in scaled nondimensional, unless no f64 holds it.
fn scaled(name: &'static str, value: f64, result: f64) -> Result<f64> {
    if result.is_finite() && (result > 0.0 || value <= 0.0) {
        Ok(result)
    } else {
        Err(Error::domain(name, value, "a load nearer to the normalisation of the surface"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::SelfAffine;

    /// A rising path of one surface with and without the stiffness.
    #[test]
    fn a_path_without_stiffness_is_the_same_path() {
        let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
        let scene = Scene::new(surface, 1.0);
        let bare = Scene { outputs: Outputs::default(), ..scene.clone() };
        let model = Bem3d { cells: 40, tolerance: 1e-9, method: Method::Iterative, ..Bem3d::default() };
        let (mut with, mut without) = (model.prepare(&scene, 1).unwrap(), model.prepare(&bare, 1).unwrap());
        for force in [0.01, 0.1, 0.5, 2.0, 10.0, 1.0] {
            let (a, b) =
                (with.solve(Load::Force(force)).unwrap(), without.solve(Load::Force(force)).unwrap());
            approx::assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), max_relative = 1e-7);
            assert!(a.stiffness.is_some() && b.stiffness.is_none());
            assert!(b.report.applications < a.report.applications, "what is not asked for costs nothing");
        }
    }

    #[test]
    fn a_field_counts_as_work() {
        let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        let with = Scene { outputs: Outputs { gap: true, ..scene.outputs }, ..scene.clone() };
        let model = Bem3d { cells: 8, ..Bem3d::default() };
        let work =
            |scene| model.prepare(scene, 0).unwrap().solve(Load::Force(1.0)).unwrap().report.applications;
        assert_eq!(work(&with), work(&scene) + 1);
    }
}
