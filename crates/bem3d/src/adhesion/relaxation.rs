//! Following the fronts of a short range over several cells in one update.
//!
//! With the attraction from the gaps of the update before, a front moves by about one cell before the contact
//! has to be solved anew. Before that, the cells beside a front follow one another here, by the inverse W of
//! the kernel: with Q the net pressure that holds the gaps, a change e of one gap changes Q by `W e`. A cell
//! is in balance where it is open and `Q + f s(g) = 0`, or closed and `Q + f s(0) >= 0`; f, what its
//! neighbours multiply its attraction by, stays as it is.
//!
//! No gap passes an equilibrium. A cell that is out of balance by e moves by `e/W_0` at a time, W_0 the
//! cell's own entry: less than what balances it with the others held, because its attraction moves it further
//! in the same direction. All other entries of W are negative, so that a cell that closes makes others close,
//! and one that opens makes them open; gaps that all close from above an equilibrium end above it. Cells that
//! are out of reach are held, which makes changes smaller. This holds for exact contact, an approach or a
//! force; contact is solved to a share of the last change only, and with a prescribed mean gap the map is not
//! monotone. The tests of these cases are `followed_fronts_go_on_and_pass_no_equilibrium` and
//! `newton_steps_leave_the_branch_in_none_of_thousands_of_states`.

use super::attraction::Attraction;
use super::equilibrium::Equilibrium;
use super::law::AttractionLaw;
use crate::geometry::{Grid, Window};
use crate::kernel::Inverse;
use crate::real::largest_difference;
use contact_model::{Boundary, Interrupted, Stop};

// Half and twice the value of each constant below change the work by less than 3 % (11 paths of short range with
// 65 cells a side, at a tolerance of 1e-5).

/// Cells are moved that are out of balance by more than this, over the peak, ...
const BALANCED: f64 = 0.02;
/// ... or by more than this share of the largest change of an attraction, where that is less.
const SHARE: f64 = 0.1;
/// Moves of a cell before the next one moves.
const MOVES: usize = 3;
/// Rounds over all cells that are out of balance, at most.
const ROUNDS: u32 = 50;
/// No cell of the set.
const NONE: u32 = u32::MAX;

/// Pressures and attractions on the cells of a state.
#[derive(Debug)]
pub struct Tractions<'a> {
    /// Contact pressure.
    pub pressure: &'a mut [f64],
    /// Attraction.
    pub attraction: &'a mut [f64],
}

/// The lattice that fronts move over.
#[derive(Debug, Clone, Copy)]
pub struct FrontLattice<'a> {
    /// The inverse of its kernel near a cell.
    pub inverse: &'a Inverse,
    /// Its cells.
    pub grid: Grid,
    /// Whether it goes on at its other side.
    pub boundary: Boundary,
}

/// Follows the fronts of a state from the attraction of its gaps, `to.attraction`, to where they come to rest
/// under W, or part of the way. On return `to` holds the tractions there.
///
/// # Errors
/// [`Interrupted`] by the stop; `to` is then as it was.
///
/// Cost: for each cell and round a product with the part of W within its reach.
pub fn follow(
    attraction: &Attraction,
    lattice: FrontLattice<'_>,
    state: &Equilibrium,
    to: &mut Tractions<'_>,
    stop: Stop<'_>,
) -> Result<(), Interrupted> {
    let FrontLattice { inverse, grid, boundary } = lattice;
    let Some(window) = state.cells.window() else { return Ok(()) };
    let mut fronts = Fronts::new(attraction, inverse, state, window);
    let change = largest_difference(to.attraction, &state.attraction);
    let least = (BALANCED * attraction.law.peak).min(SHARE * change);
    let changes = to.attraction.iter().zip(&state.attraction).map(|(to, from)| (to - from).abs());
    let mut out_of_balance: Vec<usize> =
        changes.enumerate().filter(|(_, change)| *change > least).map(|(i, _)| i).collect();
    // The last round in which a cell was listed.
    let mut listed = vec![0; state.cells.len()];
    for round in 1..=ROUNDS {
        let mut beside = Vec::new();
        for &i in &out_of_balance {
            fronts.balance(i);
            for k in fronts.nearest(i) {
                if std::mem::replace(&mut listed[k], round) < round {
                    beside.push(k);
                }
            }
        }
        if boundary == Boundary::Periodic {
            fronts.around.fold(&mut fronts.net, grid);
        }
        beside.retain(|&i| fronts.is_off_balance(i, least));
        out_of_balance = beside;
        if out_of_balance.is_empty() {
            break;
        }
        if stop.stops() {
            return Err(Interrupted);
        }
    }
    fronts.write(to);
    Ok(())
}

/// The gaps of a state while its fronts are followed.
struct Fronts<'a> {
    law: AttractionLaw,
    /// The least that neighbours can leave of the attraction of a cell.
    least_factor: f64,
    inverse: &'a Inverse,
    state: &'a Equilibrium,
    around: Around,
    /// Numbers of the cells at the places around them, or [`NONE`].
    number: Vec<u32>,
    /// Net pressure that holds the gaps, at the places.
    net: Vec<f64>,
    /// The place of each cell.
    places: Vec<usize>,
    gap: Vec<f64>,
    moved: Vec<bool>,
}

impl<'a> Fronts<'a> {
    fn new(attraction: &Attraction, inverse: &'a Inverse, state: &'a Equilibrium, window: Window) -> Self {
        let cells = &state.cells;
        let around = Around::new(window, inverse.reach);
        let mut number = vec![NONE; around.count()];
        let mut net = vec![0.0; around.count()];
        let mut places = Vec::with_capacity(cells.len());
        for (i, (x, y)) in cells.places().enumerate() {
            let place = around.place(x, y);
            number[place] = i as u32;
            net[place] = state.pressure[i] - state.attraction[i];
            places.push(place);
        }
        let gaps = state.gap.iter().zip(&state.pressure);
        let gap = gaps.map(|(&g, &p)| if p > 0.0 { 0.0 } else { g.max(0.0) }).collect();
        let (law, least_factor) = (attraction.law, 1.0 - attraction.strength());
        let moved = vec![false; cells.len()];
        Self { law, least_factor, inverse, state, around, number, net, places, gap, moved }
    }

    /// The factor by which the neighbours of a cell change its attraction; beyond the range it is the least that
    /// they can leave.
    fn factor(&self, i: usize) -> f64 {
        let alone = self.law.traction(self.state.gap[i]);
        if alone > 0.0 { self.state.lawful[i] / alone } else { self.least_factor }
    }

    /// Moves a cell towards its balance with the others held, and changes the net pressure around it.
    fn balance(&mut self, i: usize) {
        let (place, factor, before) = (self.places[i], self.factor(i), self.gap[i]);
        let (mut g, mut held) = (before, self.net[place]);
        for _ in 0..MOVES {
            let next = (g - (held + factor * self.law.traction(g)) / self.inverse.own).max(0.0);
            held += self.inverse.own * (next - g);
            g = next;
        }
        (self.gap[i], self.moved[i]) = (g, true);
        for (start, weights) in self.around.rows(place).zip(&self.inverse.rows) {
            let start = start - weights.len() / 2;
            let net = &mut self.net[start..start + weights.len()];
            net.iter_mut().zip(weights).for_each(|(net, weight)| *net += weight * (g - before));
        }
    }

    /// A cell and those beside it.
    fn nearest(&self, i: usize) -> impl Iterator<Item = usize> {
        let numbers = self.around.nearest(self.places[i]).filter_map(|place| self.number.get(place));
        numbers.filter(|k| **k != NONE).map(|k| *k as usize)
    }

    /// Whether a cell is out of balance by more than `least`.
    fn is_off_balance(&self, i: usize, least: f64) -> bool {
        let off = self.net[self.places[i]] + self.factor(i) * self.law.traction(self.gap[i]);
        off < -least || (off > least && self.gap[i] > 0.0)
    }

    /// The tractions at these gaps.
    fn write(&self, to: &mut Tractions<'_>) {
        for i in 0..self.gap.len() {
            if self.moved[i] {
                to.attraction[i] = self.factor(i) * self.law.traction(self.gap[i]);
            }
            let bears = self.gap[i] <= 0.0 && (self.state.pressure[i] > 0.0 || self.moved[i]);
            to.pressure[i] = if bears { (self.net[self.places[i]] + to.attraction[i]).max(0.0) } else { 0.0 };
        }
    }
}

/// Places in a window and beside it, in rows.
struct Around {
    window: Window,
    /// Columns and rows beside it.
    reach: (usize, usize),
    /// Places of a row.
    width: usize,
}

impl Around {
    fn new(window: Window, reach: (usize, usize)) -> Self {
        // One more than W reaches, for the nearest of a cell where it reaches none.
        let reach = (reach.0 + 1, reach.1 + 1);
        Self { window, reach, width: window.width + 2 * reach.0 }
    }

    fn count(&self) -> usize {
        self.width * (self.window.height + 2 * self.reach.1)
    }

    fn place(&self, x: usize, y: usize) -> usize {
        (y - self.window.y + self.reach.1) * self.width + x - self.window.x + self.reach.0
    }

    /// The places in the column of a place, from the first row within the reach of W to the last.
    fn rows(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        let (width, rows) = (self.width, self.reach.1 - 1);
        (0..=2 * rows).map(move |row| place + row * width - rows * width)
    }

    /// A place and the eight beside it.
    fn nearest(&self, place: usize) -> impl Iterator<Item = usize> + use<> {
        let width = self.width;
        (0..9).map(move |k| place + k / 3 * width + k % 3 - width - 1)
    }

    /// Adds what lies beside the window to the places in it that are whole periods away.
    fn fold(&self, net: &mut [f64], grid: Grid) {
        let Self { window, reach, width } = *self;
        let lines = net.len() / width;
        // Beside the columns of each row, then beside the rows of each column.
        for (reach, length, period, step, across, lines) in [
            (reach.0, window.width, grid.columns, 1, width, lines),
            (reach.1, window.height, grid.rows, width, 1, width),
        ] {
            let beside = (0..reach).chain(reach + length..length + 2 * reach);
            for (from, line) in beside.flat_map(|from| (0..lines).map(move |line| (from, line))) {
                let to = reach + (from + reach * period - reach) % period;
                let value = std::mem::take(&mut net[line * across + from * step]);
                if to < reach + length {
                    net[line * across + to * step] += value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_beside_a_window_is_folded_by_periods() {
        for (columns, rows, window) in [
            (7, 5, Window { x: 0, y: 0, width: 7, height: 5 }),
            (3, 2, Window { x: 0, y: 0, width: 3, height: 2 }),
            (9, 8, Window { x: 2, y: 1, width: 6, height: 7 }),
        ] {
            let grid = Grid::square(columns, rows);
            let around = Around::new(window, (4, 3));
            let value = |x: usize, y: usize| 1.0 + x as f64 + 20.0 * y as f64;
            let lines = around.count() / around.width;
            let mut net: Vec<f64> =
                (0..around.count()).map(|i| value(i % around.width, i / around.width)).collect();
            around.fold(&mut net, grid);
            let mut expected = vec![0.0; around.count()];
            for (x, y) in (0..lines).flat_map(|y| (0..around.width).map(move |x| (x, y))) {
                // Column and row of the grid, moved by whole periods.
                let (a, b) = (x + 10 * columns - around.reach.0, y + 10 * rows - around.reach.1);
                let (a, b) = (a % columns, b % rows);
                if a < window.width && b < window.height {
                    expected[around.place(a + window.x, b + window.y)] += value(x, y);
                }
            }
            assert_eq!(net, expected);
        }
    }
}
