//! The attraction between the cells of a grid: a law of each cell's gap and, for a short range, a factor that
//! depends on its neighbours.
//!
//! # A short range on cells
//!
//! JKR's limit has no range of attraction, but a grid has the size of its cell. The work of adhesion w is put
//! into the last cells of a contact, by a law of the gap with the largest traction `s0 = c sqrt(E* w/a)`, a
//! the longer side of a cell: with `y = 1 - g/g0`,
//!
//! ```text
//! s = s0 y (0.4 + 2.2 y - 1.6 y^2),    g0 = (15/8) w/s0.
//! ```
//!
//! Where a straight front bears the tension t on its last closed cells and the next are open by g, `t g/2` is
//! the energy release rate, exactly (virtual crack closure). At the rate w, `t/sqrt(E* w/a)` is 1.077 along
//! the rows of cells, 1.266 along their diagonals and tends to 1.46 for directions of large numbers; Pohrt
//! and Popov's criterion has 1.4537. With a smaller c cells begin to open while those before them still do,
//! and fronts of all directions move at nearly w.
//!
//! What is left is a line tension. At c = 0.59 a front of length L has the energy `-0.50 a w L` beside that of
//! the area, in all directions, so that a round contact of radius R acts as if w were `w (1 + 0.50 a/R)`. With
//! the attached share x of a cell, the part of its work that it still holds, the mean J over neighbours at a
//! distance and the mean m of |x| over J, a front has the length `(2/m) sum x_i (1 - (J x)_i)`. Adding `b a w`
//! times that to the energy makes the attraction of a cell `(1 + B (2 (J x)_i - 1)) s(g)`, `B = 2 b a/m`: as
//! before on a straight front, less in a corner of the contact. The tension vanishes at b = 0.48; b = 0.415
//! leaves -0.06, which balances the error of second order, about -1.3 (a/R)^2 of the force, where R at
//! pull-off is 10 to 50 cells.
//!
//! # Trapping
//!
//! A straight front has a place in each row of cells where it holds on longest: it recedes when the release
//! rate reaches the largest over its places, and advances at the least. Three choices make them nearly equal.
//!
//! - Neighbours are a ring, weights `1 - ((r - 4 a)/1.5 a)^2`. The factor falls across a front with
//!   the slope `2 B p`, p the share of the neighbours in a strip of unit width along it, and this fall
//!   sharpens the front and traps it. A ring of radius r has the slope `2 b a/r^2`, a disc with weights
//!   `1 - (r/R)^2` has `10 b a/R^2`: a ring of 4 cells traps as little as a disc of 9, and mixes less of other
//!   contacts nearby.
//! - The law is level in contact. Its kink there and that at the range trap fronts; the latter is needed,
//!   since a law that is level at both ends has a longer range.
//! - c = 0.59 is where waves of 64 to 256 cells come off within 1 % at all places of their fronts on the grid;
//!   a longer zone of open cells traps less, but its error of second order grows with the square of b.
//!
//! Along the rows of square cells the release rates are 1.013 w receding and 0.991 w advancing, along the
//! diagonals 1.005 and 0.997, along (1, 2) 1.002 and 0.999; the line with c = 0.7 and a disc of 4 cells had
//! 1.059 and 0.962 along the rows. On oblong cells they are nearer to w. `fronts` repeats the calibration.

use super::law::{AttractionLaw, LawShape};
use super::neighbours::Neighbours;
use super::pairs::Pairs;
use crate::geometry::{CellSet, Grid};
use crate::kernel::Inverse;
use crate::real::each;
use contact_model::Boundary;

/// The factor b of the length of fronts in the energy, in longer sides of a cell times the work of adhesion.
const FRONT_WIDTH: f64 = 0.415;
/// Radius of the ring of neighbours, and how far from it they lie at most, in longer sides of a cell.
const RING: (f64, f64) = (4.0, 1.5);
/// Distance up to which cells follow a moved cell of a front, in sides of a square cell.
const FOLLOWING: f64 = 5.0;

/// The attraction between the cells of a grid.
#[derive(Debug, Clone)]
pub struct Attraction {
    /// The law of a single cell.
    pub law: AttractionLaw,
    /// The neighbours that matter, for a short range.
    neighbours: Option<Neighbours>,
    /// By which share the attraction of a cell whose neighbours are all attached exceeds that of a cell on a
    /// straight front.
    strength: f64,
    /// For a short range: the inverse kernel by which the cells of a front follow one that moves.
    inverse: Option<Inverse>,
}

impl Attraction {
    /// The attraction of a finite range, in which neighbours play no part.
    pub fn of(law: AttractionLaw) -> Self {
        Self { law, neighbours: None, strength: 0.0, inverse: None }
    }

    /// The attraction of a finite range in the units of a body whose modulus is this many times as large.
    pub fn over(&self, modulus: f64) -> Self {
        Self::of(AttractionLaw { peak: self.law.peak / modulus, ..self.law })
    }

    /// The attraction of short range on a grid. `work` is the work of adhesion over `pi E*` times the height.
    pub fn short(work: f64, grid: Grid, boundary: Boundary) -> Self {
        let (x, y) = grid.cell();
        let side = x.max(y);
        let ring = (RING.0 * side, RING.1 * side);
        let neighbours = Neighbours::ring(grid, boundary == Boundary::Periodic, ring);
        Self {
            law: AttractionLaw::short(work, side),
            strength: 2.0 * FRONT_WIDTH * side / neighbours.distance,
            neighbours: Some(neighbours),
            inverse: Some(Inverse::within(grid, FOLLOWING)),
        }
    }

    /// The largest traction of all gaps.
    pub fn strongest(&self) -> f64 {
        self.law.peak * (1.0 + self.strength)
    }

    /// By which share the attraction of a cell whose neighbours are all attached exceeds that on a straight
    /// front.
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// The inverse of the kernel near a cell, by which the cells of a front follow one another; `None`: fronts
    /// are not followed.
    pub fn inverse(&self) -> Option<&Inverse> {
        self.inverse.as_ref()
    }

    /// Area of a contact, in cells: with a short range the attached shares of all cells, which is where
    /// fronts have their elastic tips to a tenth of a cell; otherwise the closed cells.
    pub fn area(&self, closed: &CellSet, gap: &[f64]) -> f64 {
        match &self.neighbours {
            Some(_) => gap.iter().map(|&g| self.law.attached(g)).sum(),
            None => closed.len() as f64,
        }
    }

    /// The cells that stay attached under a small change of the load in which fronts do not move: with a
    /// short range those that hold more than half of their work. `None`: the attraction follows the gaps.
    pub fn held(&self, cells: &CellSet, gap: &[f64]) -> Option<CellSet> {
        self.neighbours.as_ref().map(|_| cells.filter(gap, |g| self.law.attached(g) > 0.5))
    }

    /// Whether cells may be attached in part.
    pub fn has_shares(&self) -> bool {
        self.neighbours.is_some()
    }

    /// The cells that are attached in part or as a whole, with their attached shares. `None`: the attraction has a
    /// range of its own, and cells are in contact or not.
    pub fn attached(&self, cells: &CellSet, gap: &[f64]) -> Option<(CellSet, Vec<f64>)> {
        self.neighbours.as_ref()?;
        let shares: Vec<f64> = gap.iter().map(|&g| self.law.attached(g)).collect();
        let attached = cells.filter(&shares, |share| share > 0.0);
        let on_attached = attached.carry(cells, &shares);
        Some((attached, on_attached))
    }

    /// Whether the attraction moves over the grid by whole cells, so that the force changes in steps that no
    /// derivative at a state shows: the fronts of a short range, the edges of Dugdale's zones.
    pub fn moves_by_cells(&self) -> bool {
        self.neighbours.is_some() || self.law.shape == LawShape::Uniform
    }

    /// The cells that attract with at least half of the work of adhesion left: of a short range the attached
    /// ones, of Dugdale's law those within the range.
    pub fn attracting(&self, cells: &CellSet, gap: &[f64]) -> CellSet {
        self.held(cells, gap).unwrap_or_else(|| cells.filter(gap, |g| g < self.law.range))
    }

    /// The factor of the attraction of each cell; `None`: all factors are 1.
    fn factors(&self, cells: &CellSet, gap: &[f64]) -> Option<Vec<f64>> {
        let neighbours = self.neighbours.as_ref()?;
        let attached: Vec<f64> = gap.iter().map(|&g| self.law.attached(g)).collect();
        let mut factors = neighbours.mean(cells, &attached);
        each(&mut factors, |f| *f = 1.0 + self.strength * (2.0 * *f - 1.0));
        Some(factors)
    }

    /// Tractions of gaps on cells; other cells are open.
    pub fn tractions(&self, cells: &CellSet, gap: &[f64]) -> Vec<f64> {
        self.times_factors(cells, gap, |g| self.law.traction(g))
    }

    /// Magnitudes of the derivatives of the tractions, each with respect to the gap of its own cell, with the
    /// factors of the neighbours fixed.
    pub fn slopes(&self, cells: &CellSet, gap: &[f64]) -> Vec<f64> {
        self.times_factors(cells, gap, |g| self.law.slope(g))
    }

    fn times_factors(&self, cells: &CellSet, gap: &[f64], of: impl Fn(f64) -> f64) -> Vec<f64> {
        match self.factors(cells, gap) {
            Some(factors) => gap.iter().zip(factors).map(|(&g, f)| f * of(g)).collect(),
            None => gap.iter().map(|&g| of(g)).collect(),
        }
    }

    /// Energy, 0 far apart.
    pub fn energy(&self, cells: &CellSet, gap: &[f64]) -> f64 {
        let own = |g: &f64| self.law.energy(*g);
        let Some(neighbours) = &self.neighbours else { return gap.iter().map(own).sum() };
        let attached: Vec<f64> = gap.iter().map(|&g| self.law.attached(g)).collect();
        let mean = neighbours.mean(cells, &attached);
        gap.iter().zip(mean).map(|(g, mean)| own(g) * (1.0 - self.strength * (1.0 - mean))).sum()
    }

    /// Largest difference of an attraction from the law at its gap, over the attraction in contact.
    pub fn mismatch(&self, cells: &CellSet, attraction: &[f64], gap: &[f64]) -> f64 {
        let pairs = attraction.iter().zip(gap);
        match self.factors(cells, gap) {
            Some(factors) => (pairs.zip(factors))
                .map(|((&s, &g), f)| (s - f * self.law.traction(g)).abs() / self.law.peak)
                .fold(0.0, f64::max),
            None => pairs.map(|(&s, &g)| self.law.mismatch(s, g)).fold(0.0, f64::max),
        }
    }

    /// The sum of the differences of the attractions from the law at their gaps; at the jump of Dugdale's law
    /// there is no difference.
    pub fn imbalance(&self, cells: &CellSet, attraction: &[f64], gap: &[f64]) -> f64 {
        let pairs = attraction.iter().zip(gap);
        match self.factors(cells, gap) {
            Some(factors) => {
                pairs.zip(factors).map(|((&s, &g), f)| (s - f * self.law.traction(g)).abs()).sum()
            }
            None => pairs.map(|(&s, &g)| self.law.peak * self.law.mismatch(s, g)).sum(),
        }
    }

    /// How the attraction of open cells follows the gaps of the others: `R^-1 C R^-1`, C the negative of those
    /// derivatives and R the roots of the slopes. In the numbers of a set of cells with these gaps and roots, 0
    /// on contact. `None`: the attraction of a cell follows its own gap alone.
    pub fn coupling(&self, cells: &CellSet, gap: &[f64], root: &[f64]) -> Option<Pairs> {
        let neighbours = self.neighbours.as_ref()?;
        let factor = -2.0 * self.strength / self.law.energy(0.0);
        let share = |g: f64, r: f64| if r > 0.0 { self.law.traction(g) / r } else { 0.0 };
        let share: Vec<f64> = gap.iter().zip(root).map(|(&g, &r)| share(g, r)).collect();
        let value = |i: usize, k: usize, weight: f64| factor * weight * (share[i] * share[k]);
        Some(neighbours.pairs(cells, |i| share[i] > 0.0, value))
    }
}

#[cfg(test)]
impl Attraction {
    /// Columns, rows and weights of the neighbours.
    pub fn weights(&self) -> impl Iterator<Item = (isize, isize, f64)> + '_ {
        self.neighbours.iter().flat_map(Neighbours::weights)
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_wrap)] // Small numbers.
mod tests {
    use super::*;

    #[test]
    fn tractions_slopes_and_couplings_are_derivatives_of_the_energy() {
        let grid = Grid { columns: 8, rows: 6, stretch: 1.2 };
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let attraction = Attraction::short(0.3, grid, boundary);
            let cells = CellSet::numbered(grid, |i| i % 5 != 2);
            let range = attraction.law.range;
            let gap: Vec<f64> =
                (0..cells.len()).map(|i| range * (0.5 + 0.6 * (1.3 * i as f64).sin())).collect();
            let h = 1e-6 * range;
            let moved = |i: usize, by: f64| {
                let mut gap = gap.clone();
                gap[i] += by;
                gap
            };
            let tractions = attraction.tractions(&cells, &gap);
            let open = cells.filter(&gap, |g| g > 0.0 && g < range);
            let on_open = open.carry(&cells, &gap);
            let root: Vec<f64> =
                open.carry(&cells, &attraction.slopes(&cells, &gap)).iter().map(|s| s.sqrt()).collect();
            let coupling = attraction.coupling(&open, &on_open, &root).unwrap();
            let places: Vec<(usize, usize)> = cells.places().collect();
            for (k, place) in open.places().enumerate() {
                let i = places.iter().position(|p| *p == place).unwrap();
                let slope = (attraction.energy(&cells, &moved(i, h))
                    - attraction.energy(&cells, &moved(i, -h)))
                    / (2.0 * h);
                approx::assert_relative_eq!(slope, tractions[i], epsilon = 1e-7 * attraction.law.peak);
                let (above, below) =
                    (attraction.tractions(&cells, &moved(i, h)), attraction.tractions(&cells, &moved(i, -h)));
                let expected: Vec<f64> = above.iter().zip(&below).map(|(a, b)| (b - a) / (2.0 * h)).collect();
                let unit: Vec<f64> = (0..open.len()).map(|j| if j == k { root[k] } else { 0.0 }).collect();
                let mut found = unit.clone();
                coupling.add_product(1.0, &unit, &mut found);
                found.iter_mut().zip(&root).for_each(|(found, root)| *found *= root);
                for (found, expected) in found.iter().zip(open.carry(&cells, &expected)) {
                    approx::assert_relative_eq!(
                        *found,
                        expected,
                        epsilon = 1e-6 * attraction.law.peak / range
                    );
                }
            }
            assert!(attraction.mismatch(&cells, &tractions, &gap) <= 0.0);
            assert!(tractions.iter().all(|&t| t <= attraction.strongest()));
        }
    }

    #[test]
    fn mismatch_area_and_held_cells_by_hand() {
        let grid = Grid::square(12, 12);
        let attraction = Attraction::short(0.3, grid, Boundary::Periodic);
        let all = CellSet::all(grid);
        // Without any traction closed cells lack that of cells with all neighbours.
        let (none, closed) = (vec![0.0; all.len()], vec![0.0; all.len()]);
        let lacks = 1.0 + attraction.strength();
        approx::assert_relative_eq!(attraction.mismatch(&all, &none, &closed), lacks, max_relative = 1e-12);
        // Half open everywhere, 7/32 of the work is held.
        let half = vec![0.5 * attraction.law.range; all.len()];
        approx::assert_relative_eq!(attraction.area(&CellSet::default(), &half), 31.5, max_relative = 1e-12);
        let gap: Vec<f64> =
            (0..all.len()).map(|i| attraction.law.range * if i < 5 { 0.28 } else { 0.29 }).collect();
        assert_eq!(attraction.held(&all, &gap).unwrap().len(), 5);
        // Across gaps: the closed cells, and nothing is held.
        let across = Attraction::of(AttractionLaw { shape: LawShape::Exponential, ..attraction.law });
        assert!((across.area(&all, &closed) - 144.0).abs() < 1e-12 && across.held(&all, &gap).is_none());
        approx::assert_relative_eq!(across.mismatch(&all, &none, &closed), 1.0, max_relative = 1e-12);
    }

    #[test]
    fn full_contact_has_the_work_of_adhesion_and_a_straight_front_too() {
        let grid = Grid::square(24, 24);
        let attraction = Attraction::short(0.3, grid, Boundary::Periodic);
        let all = CellSet::all(grid);
        let gap = vec![0.0; all.len()];
        approx::assert_relative_eq!(attraction.energy(&all, &gap), -0.3 * 576.0, max_relative = 1e-12);
        approx::assert_relative_eq!(
            attraction.tractions(&all, &gap)[7],
            attraction.strongest(),
            max_relative = 1e-12
        );
        // A strip has two fronts, each with the line tension b of the correction.
        let strip: Vec<f64> = (0..all.len()).map(|i| if i % 24 < 12 { 0.0 } else { 1e3 }).collect();
        let expected = -0.3 * (288.0 - FRONT_WIDTH * 48.0);
        approx::assert_relative_eq!(attraction.energy(&all, &strip), expected, max_relative = 1e-12);
    }
}
