//! The attraction between the cells of a grid: a law of each cell's gap and, for a short range, what its
//! neighbours change.
//!
//! # A short range on cells
//!
//! JKR's limit has no length below which the attraction acts, a grid has its cell. The work of adhesion w is
//! put into the last cells of a contact, by the law `s = s0 (1 - g/g0)` with `s0 = c sqrt(E* w/a)` and
//! `g0 = 2 w/s0`, a the longer side of a cell.
//!
//! Where a straight front bears the tension t on its last closed cells and the next are open by g, `t g/2` is
//! the energy release rate, exactly (virtual crack closure). At the rate w, `t/sqrt(E* w/a)` is 1.077 along
//! the rows of cells, 1.266 along their diagonals and tends to 1.46 for directions of large numbers; Pohrt
//! and Popov's criterion has 1.4537. With c = 1.077 the law is the line between both states of a front along
//! the rows: it moves through the cells without a barrier. With a larger c it is trapped; with a smaller one
//! cells begin to open while those before them still do, and fronts of all directions move at nearly w. With
//! c = 0.7 and the factor below, Johnson's wave on 256 cells is drawn off at 1.034 of its pressure where its
//! fronts lie along the rows, at 1.013 along the diagonals and at 1.001 along (1, 2); that is 5, 2 and 0 % of
//! w, and finer cells do not lower it. Curved fronts, whose directions vary, are trapped by half a percent.
//!
//! What is left is a line tension. At c = 0.7 a front of length L has the energy `-0.44 a w L` beside that of
//! the area, in all directions, so that a round contact of radius R acts as if w were `w (1 + 0.44 a/R)`.
//! With the attached share of a cell `x = (1 - g/g0)^2`, the mean J over the neighbours within 4 a and the
//! mean m of |x| over J, a front has the length `(2/m) sum x_i (1 - (J x)_i)`. Adding `b a w` times that to
//! the energy makes the attraction of a cell `(1 + B (2 (J x)_i - 1)) s(g)`, `B = 2 b a/m`: as before on a
//! straight front, less in a corner of the contact. Fronts become sharper too, and their tension vanishes at
//! b = 0.389. The error of pull-off forces is then of second order in `a/R`. `fronts` repeats the
//! calibration.

use super::law::{Law, Shape};
use crate::geometry::{CellSet, Grid, Window};
use crate::real::{Real, each};
use contact_model::Boundary;
use numerics::parallel::widest;

/// The factor b of the length of fronts in the energy, in longer sides of a cell times the work of adhesion:
/// their line tension then is zero.
const FRONT_WIDTH: f64 = 0.389;
/// Radius of the neighbourhood in longer sides of a cell. A larger one takes contacts that lie near each
/// other for one.
const RADIUS: f64 = 4.0;

/// The attraction between the cells of a grid.
#[derive(Debug, Clone)]
pub struct Attraction {
    /// Of one cell by itself.
    pub law: Law,
    /// The neighbours that matter, for a short range.
    neighbours: Option<Neighbours>,
}

/// The mean J over the neighbours of a cell.
#[derive(Debug, Clone)]
struct Neighbours {
    grid: Grid,
    periodic: bool,
    /// Most columns and rows away.
    reach: (usize, usize),
    /// Weights of one row of neighbours after the other, all rows of the same length; their sum is 1.
    weights: Vec<f64>,
    /// How much stronger than a cell on a straight front one is that has all neighbours, relative.
    strength: f64,
}

impl Attraction {
    /// Of a finite range: no cell asks for its neighbours.
    pub fn of(law: Law) -> Self {
        Self { law, neighbours: None }
    }

    /// Of a short range, of this work of adhesion over `pi E*` times the height, on a grid.
    pub fn short(work: f64, grid: Grid, boundary: Boundary) -> Self {
        let (x, y) = grid.cell();
        let side = x.max(y);
        Self {
            law: Law::short(work, side),
            neighbours: Some(Neighbours::new(grid, boundary == Boundary::Periodic, side)),
        }
    }

    /// The largest traction of all gaps.
    pub fn strongest(&self) -> f64 {
        self.law.peak * (1.0 + self.neighbours.as_ref().map_or(0.0, |n| n.strength))
    }

    /// Area of a contact, in cells: with a short range the attached shares of all cells, which is where
    /// fronts have their elastic tips to a tenth of a cell; otherwise the closed cells.
    pub fn area(&self, closed: &CellSet, gap: &[f64]) -> f64 {
        match &self.neighbours {
            Some(_) => gap.iter().map(|&g| self.law.attached(g)).sum(),
            None => closed.len() as f64,
        }
    }

    /// The cells that a small change of the load finds attached, where fronts stay: with a short range those
    /// that hold more than half of their work. `None`: the attraction moves with the gaps.
    pub fn held(&self, cells: &CellSet, gap: &[f64]) -> Option<CellSet> {
        self.neighbours.as_ref().map(|_| cells.filter(gap, |g| self.law.attached(g) > 0.5))
    }

    /// Whether the attraction moves over the grid by whole cells, so that the force changes in steps that no
    /// derivative at a state shows: the fronts of a short range, the edges of Dugdale's zones.
    pub fn moves_by_cells(&self) -> bool {
        self.neighbours.is_some() || self.law.shape == Shape::Uniform
    }

    /// The cells that attract with at least half of the work of adhesion left: of a short range the attached
    /// ones, of Dugdale's law those within the range.
    pub fn attracting(&self, cells: &CellSet, gap: &[f64]) -> CellSet {
        self.held(cells, gap).unwrap_or_else(|| cells.filter(gap, |g| g < self.law.range))
    }

    /// By what the attraction of each cell is multiplied; `None`: 1.
    fn factors(&self, cells: &CellSet, gap: &[f64]) -> Option<Vec<f64>> {
        let neighbours = self.neighbours.as_ref()?;
        let attached: Vec<f64> = gap.iter().map(|&g| self.law.attached(g)).collect();
        let mut factors = neighbours.mean(cells, &attached);
        each(&mut factors, |f| *f = 1.0 + neighbours.strength * (2.0 * *f - 1.0));
        Some(factors)
    }

    /// Tractions of gaps on cells; other cells are open.
    pub fn tractions(&self, cells: &CellSet, gap: &[f64]) -> Vec<f64> {
        self.times_factors(cells, gap, |g| self.law.traction(g))
    }

    /// Magnitudes of the derivatives of the tractions, each in the gap of its own cell and with the
    /// neighbours held.
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
        gap.iter().zip(mean).map(|(g, mean)| own(g) * (1.0 - neighbours.strength * (1.0 - mean))).sum()
    }

    /// Largest distance of attractions from the law of their gaps, over that in contact.
    pub fn mismatch(&self, cells: &CellSet, attraction: &[f64], gap: &[f64]) -> f64 {
        let pairs = attraction.iter().zip(gap);
        match self.factors(cells, gap) {
            Some(factors) => (pairs.zip(factors))
                .map(|((&s, &g), f)| (s - f * self.law.traction(g)).abs() / self.law.peak)
                .fold(0.0, f64::max),
            None => pairs.map(|(&s, &g)| self.law.mismatch(s, g)).fold(0.0, f64::max),
        }
    }

    /// By how much the attractions differ in all from the law of their gaps; at the jump of Dugdale's law
    /// none do.
    pub fn imbalance(&self, cells: &CellSet, attraction: &[f64], gap: &[f64]) -> f64 {
        let pairs = attraction.iter().zip(gap);
        match self.factors(cells, gap) {
            Some(factors) => {
                pairs.zip(factors).map(|((&s, &g), f)| (s - f * self.law.traction(g)).abs()).sum()
            }
            None => pairs.map(|(&s, &g)| self.law.peak * self.law.mismatch(s, g)).sum(),
        }
    }

    /// How the attraction of open cells with these gaps follows the gaps of the others:
    /// `coupled(v) = R^-1 C R^-1 v`, C the negative of those derivatives and R the roots of the slopes.
    /// `None`: it does not.
    pub fn coupling<'a>(
        &'a self,
        open: &'a CellSet,
        gap: &[f64],
        root: &[f64],
    ) -> Option<impl Fn(&[f64]) -> Vec<f64> + 'a> {
        let neighbours = self.neighbours.as_ref()?;
        let work = -self.law.energy(0.0);
        let share: Vec<f64> =
            gap.iter().zip(root).map(|(&g, r)| self.law.traction(g) / (r * work.sqrt())).collect();
        Some(move |v: &[f64]| {
            let weighted: Vec<f64> = v.iter().zip(&share).map(|(v, s)| v * s).collect();
            let mut mean = neighbours.mean(open, &weighted);
            mean.iter_mut().zip(&share).for_each(|(m, s)| *m *= 2.0 * neighbours.strength * s);
            mean
        })
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_wrap)] // Small numbers.
impl Attraction {
    /// How much stronger than on a straight front a cell is that has all neighbours.
    pub fn strength(&self) -> f64 {
        self.neighbours.as_ref().map_or(0.0, |n| n.strength)
    }

    /// Columns, rows and weights of the neighbours.
    pub fn weights(&self) -> impl Iterator<Item = (i64, i64, f64)> + '_ {
        self.neighbours.iter().flat_map(|n| {
            let (across, along) = (n.reach.0 as i64, n.reach.1 as i64);
            let row = 2 * across + 1;
            (n.weights.iter().enumerate())
                .map(move |(k, &w)| (k as i64 % row - across, k as i64 / row - along, w))
        })
    }
}

impl Neighbours {
    fn new(grid: Grid, periodic: bool, side: f64) -> Self {
        let (dx, dy) = grid.cell();
        let radius = RADIUS * side;
        let reach = |cell: f64| (radius / cell).ceil() as usize - 1;
        let (across, along) = (reach(dx), reach(dy));
        let mut weights = Vec::with_capacity((2 * across + 1) * (2 * along + 1));
        let (mut total, mut moment) = (0.0, 0.0);
        for j in 0..=2 * along {
            for i in 0..=2 * across {
                let (x, y) = (dx * (i as f64 - across as f64), dy * (j as f64 - along as f64));
                let weight = (1.0 - (x * x + y * y) / (radius * radius)).max(0.0);
                total += weight;
                moment += 0.5 * weight * (x.abs() + y.abs());
                weights.push(weight);
            }
        }
        each(&mut weights, |w| *w /= total);
        let strength = 2.0 * FRONT_WIDTH * side * total / moment;
        Self { grid, periodic, reach: (across, along), weights, strength }
    }

    /// Columns and rows of a window with the neighbours around it.
    fn room(&self, window: Window) -> (usize, usize) {
        (window.width + 2 * self.reach.0, window.height + 2 * self.reach.1)
    }

    /// Writes values on a set where they belong in its window with the neighbours around it.
    fn spread<T: Real>(&self, cells: &CellSet, values: &[T], window: Window, around: &mut [T]) {
        let ((across, along), (width, _)) = (self.reach, self.room(window));
        around.fill(T::default());
        for row in cells.rows() {
            row.spread(values, &mut around[(row.y + along - window.y) * width + across..], window.x);
        }
        if self.periodic {
            // The window has all cells that are whole periods apart.
            let columns = images(across, window.width, self.grid.columns);
            for line in around.chunks_exact_mut(width) {
                for &(to, from) in &columns {
                    line[to] = line[from];
                }
            }
            for (to, from) in images(along, window.height, self.grid.rows) {
                around.copy_within(from * width..(from + 1) * width, to * width);
            }
        }
    }

    /// Means over the neighbours of the cells of a set; cells outside of it count 0.
    ///
    /// Cost: half an addition and half a multiplication for each neighbour.
    fn mean(&self, cells: &CellSet, values: &[f64]) -> Vec<f64> {
        let Some(window) = cells.window() else { return Vec::new() };
        let ((across, along), (width, height)) = (self.reach, self.room(window));
        let mut around = vec![0.0; width * height];
        self.spread(cells, values, window, &mut around);
        let (row_length, mut means) = (2 * across + 1, vec![0.0; cells.len()]);
        let line = |y: usize| &around[y * width..][..width];
        cells.update(cells.len() * self.weights.len() / 2, &mut means, |row, means| {
            let (mut pair, mut sums) = (vec![0.0; width], vec![0.0; window.width]);
            let centre = row.y + along - window.y;
            // Rows and columns at the same distance have the same weight.
            for j in 0..=along {
                pair.copy_from_slice(line(centre - j));
                if j > 0 {
                    pair.iter_mut().zip(line(centre + j)).for_each(|(pair, v)| *pair += v);
                }
                let weights = &self.weights[(along + j) * row_length + across..][..=across];
                let own = pair[across..].iter();
                sums.iter_mut().zip(own).for_each(|(sum, v)| *sum += weights[0] * v);
                for (i, &weight) in weights.iter().enumerate().skip(1).take_while(|(_, w)| **w > 0.0) {
                    let sides = pair[across - i..].iter().zip(&pair[across + i..]);
                    widest(
                        #[inline(always)]
                        || sums.iter_mut().zip(sides).for_each(|(sum, (a, b))| *sum += weight * (a + b)),
                    );
                }
            }
            row.collect(&sums, means, window.x);
        });
        means
    }
}

/// Which places of a line have their values from which others, where `length` places after a margin repeat
/// with a period that is no shorter.
fn images(margin: usize, length: usize, period: usize) -> Vec<(usize, usize)> {
    let place = |to: usize| (to + period * margin - margin) % period + margin;
    let beside = (0..margin).chain(margin + length..2 * margin + length);
    beside.map(|to| (to, place(to))).filter(|&(_, from)| from < margin + length).collect()
}

#[cfg(test)]
#[allow(clippy::cast_possible_wrap)] // Small numbers.
mod tests {
    use super::*;

    fn neighbours(attraction: &Attraction) -> &Neighbours {
        attraction.neighbours.as_ref().unwrap()
    }

    #[test]
    fn the_mean_is_the_sum_over_all_pairs() {
        for (grid, boundary) in [
            (Grid::square(9, 7), Boundary::Free),
            (Grid::square(5, 3), Boundary::Periodic),
            (Grid { columns: 4, rows: 14, stretch: 1.7 }, Boundary::Periodic),
        ] {
            let attraction = Attraction::short(1.0, grid, boundary);
            let n = neighbours(&attraction);
            let cells = CellSet::numbered(grid, |i| i % 4 != 1);
            let values: Vec<f64> = (0..cells.len()).map(|i| (i as f64).sin()).collect();
            let places: Vec<(usize, usize)> = cells.places().collect();
            let (across, along) = n.reach;
            for (found, &(x, y)) in n.mean(&cells, &values).iter().zip(&places) {
                let mut expected = 0.0;
                for (k, weight) in n.weights.iter().enumerate() {
                    let i = (x + k % (2 * across + 1)) as isize - across as isize;
                    let j = (y + k / (2 * across + 1)) as isize - along as isize;
                    let at = if boundary == Boundary::Periodic {
                        (i.rem_euclid(grid.columns as isize), j.rem_euclid(grid.rows as isize))
                    } else {
                        (i, j)
                    };
                    for (value, &(a, b)) in values.iter().zip(&places) {
                        if at == (a as isize, b as isize) {
                            expected += weight * value;
                        }
                    }
                }
                approx::assert_relative_eq!(*found, expected, epsilon = 1e-14);
            }
        }
    }

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
            let coupled = attraction.coupling(&open, &on_open, &root).unwrap();
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
                let found: Vec<f64> =
                    (coupled(&unit).iter().zip(&unit).zip(&root)).map(|((c, u), r)| r * (c + u)).collect();
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
        // Half open everywhere, a quarter of the work is held.
        let half = vec![0.5 * attraction.law.range; all.len()];
        approx::assert_relative_eq!(attraction.area(&CellSet::default(), &half), 36.0, max_relative = 1e-12);
        let gap: Vec<f64> =
            (0..all.len()).map(|i| attraction.law.range * if i < 5 { 0.29 } else { 0.3 }).collect();
        assert_eq!(attraction.held(&all, &gap).unwrap().len(), 5);
        // Across gaps: the closed cells, and nothing is held.
        let across = Attraction::of(Law { shape: Shape::Exponential, ..attraction.law });
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
