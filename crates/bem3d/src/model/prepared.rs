//! One surface, ready to be loaded.

use super::medium;
use super::memory::IndentationMemory;
use super::options::{Bem3d, Method, NAME};
use super::profile;
use super::sliding::SurfaceFriction;
use crate::active_set::{self, Bounds, Candidates, Control, Guess, LastState, Limits, Problem, Solved};
use crate::geometry::{CellSet, Grid};
use crate::parts::Recorder;
use crate::real::{each, sum_of_pairs, update};
use crate::response::NormalStiffness;
use crate::response::normal::magnification;
use crate::tuning::Tuning;
use contact_model::{
    Boundary, Effects, Error, Hardness, HeightMap, Interrupted, Nondimensionalisation, Normalisation,
    Outputs, Result, Scene, Size, Stop, Surface, never,
};
use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

/// The stiffnesses of a state.
#[derive(Debug)]
pub(super) struct Tangent {
    /// Along the branch, on the cells that respond.
    pub stiffness: NormalStiffness,
    /// The cells that respond.
    pub cells: CellSet,
    /// The stiffness of the whole contact, where it differs and is requested; also `None` for complete
    /// contact.
    pub whole: Option<NormalStiffness>,
}

impl Tangent {
    /// Steps of conjugate gradients.
    pub fn steps(&self) -> usize {
        self.stiffness.steps + self.whole.as_ref().map_or(0, |whole| whole.steps)
    }
}

/// One surface, ready to be loaded.
#[derive(Debug)]
pub struct PreparedSurface {
    pub(super) options: Bem3d,
    pub(super) outputs: Outputs,
    pub(super) effects: Effects,
    pub(super) problem: Problem,
    pub(super) nondimensional: Nondimensionalisation,
    /// Unit of lengths normal to the surface: the rms height where there is one.
    pub(super) height: f64,
    pub(super) normalisation: Normalisation,
    /// The hardness, nondimensional: the upper bound of the net pressure.
    pub(super) hardness: Option<f64>,
    /// The rms gradient, once it was asked for.
    pub(super) gradient: OnceLock<f64>,
    /// Mean of z over the defined points.
    pub(super) mean: f64,
    /// Number of defined points.
    pub(super) defined: usize,
    pub(super) last: Option<LastState>,
    /// The memory of a path with a hardness; `None` without a path.
    pub(super) memory: Option<IndentationMemory>,
    /// The displacement by the history of a viscoelastic body, row-major in units of the height; empty where there is
    /// none.
    pub(super) crept: Vec<f64>,
    /// Friction, and what it remembers of a path.
    pub(super) sliding: Option<SurfaceFriction>,
    /// Sides of the map.
    pub(super) size: Size,
    /// Whether it is a profile: a body uniform along y.
    pub(super) is_profile: bool,
    /// Compression of a whole layer per mean pressure, where states have an approach to it.
    pub(super) whole_compression: Option<f64>,
}

impl Bem3d {
    /// The heights of a scene: given, or generated on the cells of this model.
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a line; errors of generating a surface.
    pub fn heights(&self, scene: &Scene, seed: u64) -> Result<Arc<HeightMap>> {
        self.heights_until(scene, seed, &never)
    }

    /// As [`Bem3d::heights`], unless the stop ends it.
    ///
    /// # Errors
    /// [`Error::Stopped`] by the stop; as [`Bem3d::heights`].
    pub fn heights_until(&self, scene: &Scene, seed: u64, stop: Stop<'_>) -> Result<Arc<HeightMap>> {
        match &scene.surface {
            Surface::Heights(map) | Surface::Profile(map) => Ok(Arc::clone(map)),
            Surface::Line { .. } => Err(Error::unsupported(NAME, "a line (it needs a map)")),
            surface => surface_gen::height_map_until(surface, self.grid(surface.size()), seed, stop),
        }
    }
}

/// Depths below the highest point: differences first, so that an offset of the heights changes nothing.
fn depths(map: &HeightMap) -> Vec<f64> {
    let highest = map.highest();
    let mut depths = vec![0.0; map.heights().len()];
    update(&mut depths, map.heights(), |depth, h| *depth = highest - h);
    depths
}

/// The rms height of the defined points of a map.
fn rms_of_defined(depths: &[f64], map: &HeightMap) -> f64 {
    if map.undefined() == 0 {
        surface_gen::rms_height(depths)
    } else {
        surface_gen::rms_height(&depths.iter().copied().filter(|depth| depth.is_finite()).collect::<Vec<_>>())
    }
}

/// The upper bound of the pressure by the hardness of a scene, nondimensional; `None` without a hardness.
fn upper_bound(scene: &Scene, nondimensional: Nondimensionalisation) -> Result<Option<f64>> {
    let Hardness::Limit { pressure } = scene.effects.hardness else { return Ok(None) };
    let upper = nondimensional.pressure_in(pressure) / PI;
    if !(upper.is_finite() && upper > 0.0) {
        let expected = "a pressure nearer to E* times the slope of the surface";
        return Err(Error::domain("hardness", pressure, expected));
    }
    Ok(Some(upper))
}

impl PreparedSurface {
    /// The surface of a scene with these heights.
    pub(super) fn of_map(
        options: Bem3d,
        scene: &Scene,
        map: &HeightMap,
        (tuning, recorder): (&Tuning, &Recorder),
    ) -> Result<Self> {
        let mut z = depths(map);
        let rms = rms_of_defined(&z, map);
        let height = if rms > 0.0 { rms } else { 1.0 };
        each(&mut z, |z| *z /= height);
        let (grid, (dx, dy)) = (Grid::of(map), (map.dx(), map.dy()));
        let length = if grid.has_square_cells() { dx } else { dx.sqrt() * dy.sqrt() };
        let nondimensional = Nondimensionalisation::new(scene.contact_modulus, length, height)?;
        let defined = z.len() - map.undefined();
        let mean = sum_of_pairs(&z, &z, |z, _| if z.is_finite() { z } else { 0.0 }) / defined as f64;
        let medium = medium::of(scene, options.periodic_kernel, length);
        medium::check_thickness(scene, medium, length)?;
        let mut problem = Problem::recorded(grid, Arc::new(z), medium, tuning, recorder);
        problem.nested = options.method != Method::SingleLevel;
        problem.operators.two_levels = problem.nested;
        let hardness = upper_bound(scene, nondimensional)?;
        if let Some(upper) = hardness {
            problem.bounds = Bounds::UpTo(upper);
        }
        let sliding = SurfaceFriction::new(scene, &problem, nondimensional, (tuning, recorder))?;
        let has_rms =
            matches!(scene.surface, Surface::SelfAffine(_) | Surface::Heights(_) | Surface::Profile(_));
        let normalisation = Normalisation {
            contact_modulus: scene.contact_modulus,
            length: map.length(),
            height: has_rms.then_some(rms),
        };
        Ok(Self {
            options,
            effects: scene.effects,
            outputs: profile::outputs(scene.outputs, problem.operators.table().kernel()),
            problem,
            nondimensional,
            height,
            normalisation,
            hardness,
            gradient: OnceLock::new(),
            mean,
            defined,
            last: None,
            memory: None,
            crept: Vec::new(),
            sliding,
            size: map.size(),
            is_profile: matches!(scene.surface, Surface::Profile(_)),
            whole_compression: medium::whole_compression(scene),
        })
    }

    /// Resets to the virgin surface without any state; on a `path` a hardness leaves an indentation from here
    /// on.
    pub(super) fn begin(&mut self, path: bool) {
        if let Some(memory) = self.memory.take() {
            self.problem.candidates = Candidates::new(self.problem.grid(), memory.virgin);
            self.problem.coarser = None;
        }
        self.last = None;
        if let Some(sliding) = &mut self.sliding {
            sliding.begin();
        }
        if path && self.problem.bounds != Bounds::Unlimited {
            self.memory = Some(IndentationMemory::new(self.problem.candidates.shared()));
        }
    }

    /// Returns to another memory of a path; without one the surface is the virgin one.
    pub(super) fn take_memory(&mut self, memory: Option<IndentationMemory>) {
        let gaps = match (&memory, &self.memory) {
            (Some(memory), _) => memory.indented(),
            (None, Some(now)) => Arc::clone(&now.virgin),
            (None, None) => return,
        };
        self.problem.candidates = Candidates::new(self.problem.grid(), gaps);
        self.problem.coarser = None;
        self.memory = memory;
    }

    /// Drops the plans of operators and the buffers of earlier loads, which would affect the rounding of the
    /// next one.
    pub(super) fn forget_plans(&mut self) {
        self.problem.forget_plans();
        if let Some(sliding) = &mut self.sliding {
            sliding.friction.forget_plans();
        }
    }

    pub(super) fn is_periodic(&self) -> bool {
        self.problem.operators.table().boundary() == Boundary::Periodic
    }

    /// Whether states have an approach, which needs displacements that vanish at infinity.
    pub(super) fn has_approach(&self) -> bool {
        self.problem.operators.table().kernel().vanishes_far_away()
    }

    pub(super) fn limits(&self) -> Limits {
        let height = self.normalisation.height.filter(|&h| h > 0.0);
        Limits {
            tolerance: self.options.tolerance,
            height: height.map(|h| self.nondimensional.approach_in(h)),
            outer_iterations: self.options.max_outer_iterations,
            factor: self.options.method == Method::Auto,
            is_guess: false,
        }
    }

    /// The guess for a target: the tangent at the last state, or a cold start.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub(super) fn guess(
        &mut self,
        target: Control,
        limits: Limits,
        stop: Stop<'_>,
    ) -> std::result::Result<Guess, Interrupted> {
        let tuning = *self.problem.operators.tuning();
        if let Some(last) = &self.last
            && let Some(guess) = last.extrapolated(target, &tuning)
        {
            let (nested, cells) = (self.problem.nested, self.problem.grid().count());
            let predicted = || active_set::predicted_cells(&mut self.problem, &guess, stop);
            if !nested || !last.overshoots(target, cells, &tuning, predicted)? {
                return Ok(guess);
            }
        }
        active_set::cold_start(&mut self.problem, target, limits, stop)
    }

    /// The ratio of the relative error of k to that of `1' G^-1 1 = k'` with the constant c in G:
    /// `k = k' / (1 - c k')`.
    ///
    /// 1 with free boundaries; grows without limit towards full contact of a periodic surface.
    pub(super) fn magnification(&self, value: f64) -> f64 {
        magnification(self.problem.operators.table().shift(), value)
    }

    /// Relative error of k itself.
    pub(super) fn stiffness_error(&self, tangent: &NormalStiffness) -> f64 {
        tangent.error() * self.magnification(tangent.k())
    }

    /// Whether every cell of a periodic surface is in contact: the force is then free at a mean gap of zero.
    pub(super) fn is_full(&self, contact: &CellSet) -> bool {
        self.is_periodic() && contact.len() == self.problem.grid().count()
    }

    /// Whether a state is complete contact without an indentation: it has no gap and no finite stiffness.
    pub(super) fn is_complete(&self, solved: &Solved) -> bool {
        self.is_full(&solved.contact) && !self.problem.bounds.is_reached(&solved.p)
    }

    /// The force of all defined cells at the hardness, nondimensional; infinite without one.
    pub(super) fn capacity(&self) -> f64 {
        self.hardness.unwrap_or(f64::INFINITY) * self.defined as f64
    }

    /// Adds the indentation of saturated cells to that of the path.
    pub(super) fn indent(&mut self, saturated: &CellSet, depth: &[f64]) {
        let grid = self.problem.grid();
        let Some(memory) = &mut self.memory else { return };
        if saturated.is_empty() {
            return;
        }
        for (i, depth) in saturated.index(grid).zip(depth) {
            memory.indentation[i] += depth;
        }
        self.problem.candidates = Candidates::new(grid, memory.indented());
        self.problem.coarser = None;
    }

    /// Keeps a state as the start of the next one.
    pub(super) fn remember(&mut self, solved: Solved, tangent: Option<Tangent>) {
        // Cells that flow do not follow the tangent.
        let tangent = tangent.filter(|t| t.stiffness.k() > 0.0).map(|t| {
            let k = t.stiffness.k();
            let [q] = t.stiffness.change;
            let q =
                if t.cells.len() == solved.contact.len() { q } else { solved.contact.carry(&t.cells, &q) };
            (q, k)
        });
        let Solved { contact, p, d, .. } = solved;
        let force = p.iter().sum();
        self.last = Some(LastState { contact, p, d, force, tangent });
    }

    /// Sides of a cell.
    pub(super) fn cell(&self) -> (f64, f64) {
        let grid = self.problem.grid();
        (self.size.x / grid.columns as f64, self.size.y / grid.rows as f64)
    }

    /// Starts the counting of work.
    pub(super) fn begin_count(&mut self) {
        let plans = &mut self.problem.operators.plans;
        (plans.applications, plans.solves, plans.descent, plans.limited) = (0, 0, 0, 0);
    }
}
