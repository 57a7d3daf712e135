//! The recipe of a linear system: a pure function of sizes, with the measured constants of [`Tuning`].

use super::two_level::Split;
use super::two_transforms::TwoTransforms;
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::NormalTable;
use crate::tuning::Tuning;
use std::fmt;

/// How one application of the influence matrix is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Application {
    /// Sum over all pairs.
    Direct,
    /// Smooth part on a lattice, near part by pairs.
    TwoLevel(Split),
    /// Smooth part on a lattice, near part by a transform of little more than the window.
    TwoTransforms(Split),
    /// Transform of the window.
    Fft(Lengths),
}

impl Application {
    /// An upper estimate of its error over the largest displacement.
    pub fn error(self) -> f64 {
        match self {
            Self::Direct => 0.0,
            Self::TwoLevel(split) => split.error(),
            // Sets that fill their window change by pressures without order, whose error is larger.
            Self::TwoTransforms(split) => 2.0 * split.error(),
            Self::Fft(_) => 1e-6,
        }
    }
}

/// The preconditioner of a system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Conditioning {
    /// None.
    Identity,
    /// The inverse of the kernel wrapped on a torus around the window.
    Torus {
        /// Circular lengths of the torus.
        lengths: Lengths,
        /// Whether residuals are extended into the gaps between contacts.
        extended: bool,
    },
}

/// How one linear system on a set of cells is solved.
///
/// Vectors are in double precision where the application is, in single precision where a transform is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Recipe {
    /// Bounding box of the set.
    pub window: Window,
    /// The influence matrix.
    pub application: Application,
    /// The preconditioner.
    pub conditioning: Conditioning,
}

impl Recipe {
    /// Whether vectors are in single precision, which is enough for a transform in single precision.
    pub fn is_single(&self) -> bool {
        matches!(self.application, Application::Fft(_) | Application::TwoTransforms(_))
            || self.has_preconditioner()
    }

    /// Whether there is a preconditioner.
    pub fn has_preconditioner(&self) -> bool {
        self.conditioning != Conditioning::Identity
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.application {
            Application::Direct => write!(f, "direct")?,
            Application::TwoLevel(Split { spacing, reach, order }) => {
                write!(f, "two levels, spacing {spacing} reach {reach} order {order}")?;
            }
            Application::TwoTransforms(Split { spacing, reach, order }) => {
                write!(f, "two transforms, spacing {spacing} reach {reach} order {order}, f32 in f64")?;
            }
            Application::Fft(Lengths { x, y }) => write!(f, "fft {x} x {y}, f32 in f64")?,
        }
        match self.conditioning {
            Conditioning::Identity => Ok(()),
            Conditioning::Torus { lengths: Lengths { x, y }, extended } => {
                write!(f, ", {}torus inverse {x} x {y}", if extended { "extended " } else { "" })
            }
        }
    }
}

/// The time of one application of a kernel by its size, ns.
#[derive(Debug, Clone, Copy)]
pub struct Costs<'a> {
    tuning: &'a Tuning,
    components: f64,
    entries: f64,
}

impl<'a> Costs<'a> {
    /// Of a kernel with this number of components and of entries.
    pub fn new(tuning: &'a Tuning, components: usize, entries: usize) -> Self {
        Self { tuning, components: components as f64, entries: entries as f64 }
    }

    /// A sum over all pairs: a product for each entry.
    pub fn direct(&self, sources: usize, targets: usize) -> f64 {
        self.entries * self.tuning.pair_ns * sources as f64 * targets as f64
    }

    /// Transforms of each component in double precision.
    pub fn transforms(&self, lengths: Lengths) -> f64 {
        let points = lengths.points() as f64;
        self.components * self.tuning.point_ns * points * points.log2()
    }
}

/// Chooses recipes for one grid.
#[derive(Debug, Clone, Copy)]
pub struct Planner<'a> {
    /// The kernel.
    pub table: &'a NormalTable,
    /// The cost model.
    pub tuning: &'a Tuning,
    /// Whether approximations of the far field may be chosen.
    pub two_levels: bool,
}

impl Planner<'_> {
    fn costs(&self) -> Costs<'_> {
        Costs::new(self.tuning, 1, 1)
    }

    fn fft_ns(&self, lengths: Lengths) -> f64 {
        self.costs().transforms(lengths)
    }

    fn direct_ns(&self, sources: usize, targets: usize) -> f64 {
        self.costs().direct(sources, targets)
    }

    fn knows_far_field(&self) -> bool {
        self.two_levels && self.table.kernel().has_far_field_of_squares()
    }

    /// The cheapest transforms of a window in single precision with their time, ns; `every_lag`: whether the
    /// kernel must be right at every lag.
    fn transforms(&self, window: Window, every_lag: bool) -> (f64, Application) {
        let tuning = self.tuning;
        let lengths = if every_lag {
            self.table.exact_lengths(window)
        } else {
            self.table.shortened_lengths(window, tuning.shortened)
        };
        let one = (tuning.single * self.fft_ns(lengths), Application::Fft(lengths));
        if !self.knows_far_field() {
            return one;
        }
        let split = TwoTransforms::split_at(tuning.dense_reach, tuning.dense_order);
        let [near, far] = [split.near_lengths(window), Lengths::free(split.lattice(window))];
        let time = tuning.single * (self.fft_ns(near) + self.fft_ns(far))
            + tuning.filter_ns * (split.order * window.count()) as f64;
        if time < one.0 { (time, Application::TwoTransforms(split)) } else { one }
    }

    /// The cheapest way to five digits or more between two sets inside a window.
    ///
    /// Cost: nothing for a dense set, a count of the cells on coarse tiles for a scattered one.
    pub fn fast(&self, sources: &CellSet, targets: &CellSet, window: Window) -> Application {
        self.fastest(sources, targets, window).1
    }

    /// The same with its time, ns.
    fn fastest(&self, sources: &CellSet, targets: &CellSet, window: Window) -> (f64, Application) {
        let tuning = self.tuning;
        let direct = self.direct_ns(sources.len(), targets.len());
        let mut best = self.transforms(window, true);
        if direct <= best.0 {
            best = (direct, Application::Direct);
        }
        let cells = sources.len().max(targets.len());
        let few = cells <= tuning.largest_scattered && cells * tuning.scattered <= window.count();
        if !(few && self.knows_far_field()) {
            return best;
        }
        for spacing in [4, 8, 16, 32] {
            let split = Split { spacing, reach: tuning.reach, order: tuning.order };
            let transform = self.fft_ns(Lengths::free(split.lattice(window)));
            let weights = split.order * split.order * (sources.len() + targets.len());
            let far = transform + tuning.spread_ns * weights as f64;
            if far >= best.0 {
                continue;
            }
            let near = tuning.close_pair_ns * close_pairs(sources, targets, window, split.radius());
            if far + near < best.0 {
                best = (far + near, Application::TwoLevel(split));
            }
        }
        best
    }

    /// The recipe of a system on a set of which `contact` cells are known to be in contact. `every_lag`:
    /// whether the kernel must be exact at every lag, as for the stiffness, or may be that of a shorter
    /// torus, as for corrections of the pressure: at a prescribed force their sum is zero, so that long lags
    /// matter little, and the exact gap that is evaluated afterwards includes the rest.
    pub fn system(&self, set: &CellSet, contact: usize, every_lag: bool) -> Option<Recipe> {
        let (window, tuning) = (set.window()?, self.tuning);
        let share = contact as f64 / window.count() as f64;
        let (fastest, application) = self.fastest(set, set, window);
        let torus = self.table.torus_lengths(window);
        // Transforms of the window and of the torus against more steps of what is fastest alone.
        let conditioned = self.transforms(window, true).0 + tuning.single * self.fft_ns(torus);
        let large = contact > tuning.largest_factor
            && share >= tuning.preconditioned_large
            && conditioned <= tuning.preconditioner_saves * fastest;
        let application = match application {
            Application::Fft(_) | Application::TwoTransforms(_) => self.transforms(window, every_lag).1,
            _ if large => self.transforms(window, every_lag).1,
            other => other,
        };
        let conditioning = if large || share >= tuning.preconditioned {
            let extended = contact >= tuning.extended;
            Conditioning::Torus { lengths: torus, extended }
        } else {
            Conditioning::Identity
        };
        Some(Recipe { window, application, conditioning })
    }

    /// Whether systems on a set of `n` cells are solved by factorisation.
    pub fn factors(&self, n: usize, window: Window) -> bool {
        let (cells, tuning) = (n as f64, self.tuning);
        let factor = tuning.factors * (tuning.factor_ns * cells.powi(3) / 3.0 + 4.0 * cells * cells);
        let iterate = tuning.applications * self.transforms(window, true).0.min(self.direct_ns(n, n));
        n <= tuning.always_factored || (n <= tuning.largest_factor && factor <= iterate)
    }
}

/// About how many pairs lie within a radius: each tile of that size with the nine around it, by the share of
/// a disc.
fn close_pairs(sources: &CellSet, targets: &CellSet, window: Window, radius: usize) -> f64 {
    let (across, down) = (window.width / radius + 3, window.height / radius + 3);
    let count = |set: &CellSet| {
        let mut tile = vec![0u32; across * down];
        for row in set.rows() {
            let line = ((row.y - window.y) / radius + 1) * across + 1;
            for &x in row.columns {
                tile[line + (x as usize - window.x) / radius] += 1;
            }
        }
        tile
    };
    let (a, b) = (count(sources), count(targets));
    let mut pairs = 0.0;
    for y in 1..down - 1 {
        for x in 1..across - 1 {
            let here = f64::from(b[y * across + x]);
            if here > 0.0 {
                let around = (y - 1..=y + 1).flat_map(|y| (x - 1..=x + 1).map(move |x| y * across + x));
                pairs += here * around.map(|t| f64::from(a[t])).sum::<f64>();
            }
        }
    }
    pairs * std::f64::consts::PI / 9.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use contact_model::Boundary;

    const GRID: Grid = Grid { columns: 2049, rows: 2049, stretch: 1.0 };

    /// One cell in `step`, all over the grid.
    fn every(step: usize) -> CellSet {
        CellSet::from_index(GRID, &(0..2049 * 2049_u32).step_by(step).collect::<Vec<_>>())
    }

    fn with<R>(grid: Grid, boundary: Boundary, ask: impl FnOnce(Planner<'_>) -> R) -> R {
        let table = NormalTable::shared(grid, boundary);
        ask(Planner { table: &table, tuning: &Tuning::DEFAULT, two_levels: true })
    }

    #[test]
    fn small_sets_never_pay_for_the_grid() {
        with(GRID, Boundary::Free, |planner| {
            let window = GRID.window();
            let transforms = planner.fft_ns(Lengths { x: 4096, y: 4096 });
            assert!(planner.direct_ns(300, 3000) < transforms);
            assert!(planner.direct_ns(100_000, 100_000) > transforms);
            assert!(planner.factors(200, window) && !planner.factors(50_000, window));
        });
    }

    #[test]
    fn direct_two_levels_and_transform_in_this_order() {
        let choice = |grid: Grid, boundary, set: &CellSet| {
            with(grid, boundary, |planner| planner.fast(set, set, GRID.window()))
        };
        assert_eq!(choice(GRID, Boundary::Free, &every(200_000)), Application::Direct);
        assert!(matches!(choice(GRID, Boundary::Free, &every(400)), Application::TwoLevel(_)));
        assert!(matches!(choice(GRID, Boundary::Free, &every(3)), Application::TwoTransforms(_)));
        // Its far field is that of square cells on a half-space that does not repeat.
        let oblong = Grid { stretch: 1.2, ..GRID };
        assert!(matches!(choice(oblong, Boundary::Free, &every(400)), Application::Fft(_)));
        let period = Application::Fft(Lengths { x: 2049, y: 2049 });
        assert_eq!(choice(GRID, Boundary::Periodic, &every(400)), period);
    }

    #[test]
    fn a_system_is_planned_by_the_number_of_cells_in_contact() {
        with(GRID, Boundary::Free, |planner| {
            let plan = |set: &CellSet, every_lag| planner.system(set, set.len(), every_lag).unwrap();
            let dense = plan(&every(2), true);
            assert_eq!(
                dense.to_string(),
                "two transforms, spacing 4 reach 12 order 6, f32 in f64, extended torus inverse 2304 x 2304"
            );
            assert!(dense.is_single());
            assert_eq!(plan(&every(2), false).application, dense.application);
            let scattered = plan(&every(400), true);
            assert_eq!(scattered.conditioning, Conditioning::Identity);
            assert!(!scattered.is_single() && scattered.to_string().starts_with("two levels, spacing"));
            // Between both shares the cost of the transforms decides, beside more steps of sums over the same
            // cells.
            for (preconditioner_saves, step, single) in
                [(1e9, 290, true), (1e-9, 290, false), (1e9, 310, false)]
            {
                let tuning = Tuning { preconditioner_saves, ..Tuning::DEFAULT };
                let (set, planner) = (every(step), Planner { tuning: &tuning, ..planner });
                assert_eq!(planner.system(&set, set.len(), true).unwrap().is_single(), single, "{step}");
            }
            let few = CellSet::from_index(GRID, &[5, 2049 * 2000]);
            assert_eq!(planner.system(&few, 0, true).unwrap().to_string(), "direct");
            assert!(planner.system(&CellSet::default(), 0, true).is_none());
        });
        // Without the far field of square cells corrections of the pressure take a shorter torus.
        let oblong = Grid { stretch: 1.2, ..GRID };
        with(oblong, Boundary::Free, |planner| {
            let set = CellSet::all(oblong);
            let lengths = [true, false]
                .map(|every_lag| planner.system(&set, set.len(), every_lag).unwrap().application);
            assert_eq!(lengths, [4096, 3072].map(|n| Application::Fft(Lengths { x: n, y: n })));
        });
    }

    #[test]
    fn close_pairs_are_counted_well_enough() {
        let set = every(41);
        let estimate = close_pairs(&set, &set, GRID.window(), 48);
        let uniform = set.len() as f64 * std::f64::consts::PI * 48.0 * 48.0 / 41.0;
        assert!((0.8..1.1).contains(&(estimate / uniform)), "{}", estimate / uniform);
    }

    #[test]
    fn the_choice_to_factor_is_monotone_in_the_size_of_the_set() {
        with(GRID, Boundary::Free, |planner| {
            for side in [32, 2049] {
                let window = Grid::square(side, side).window();
                let factored: Vec<bool> = (1..9000).step_by(50).map(|n| planner.factors(n, window)).collect();
                assert!(factored.windows(2).all(|w| w[0] || !w[1]), "once too large, always too large");
            }
            let huge = Window { x: 0, y: 0, width: 1 << 19, height: 1 << 19 };
            assert!(!planner.factors(Tuning::DEFAULT.largest_factor + 1, huge));
        });
    }
}
