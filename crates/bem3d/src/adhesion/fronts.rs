//! Straight fronts of a short range on an infinite grid, along lattice directions of small integers; the
//! constants of [`super::attraction`] are derived from them.
//!
//! A strip of attached cells between two fronts along the direction (p, q) is pulled off a plane by a
//! displacement. All cells of a row along the front have the same state, so that the rows are the unknowns;
//! the two fronts are mirror images. The attached share of the strip is prescribed and its displacement
//! follows, so that every equilibrium is met, those between two stable places too. Over one row the energy
//! release rate then has a largest value, at which a front recedes, and a least, at which it advances; their
//! mean is w. `cargo test --release -p bem3d fronts -- --nocapture` prints the table.

#![allow(clippy::needless_range_loop)] // Indices as in the formulas.
#![allow(clippy::cast_possible_wrap, clippy::cast_sign_loss)] // Small numbers.

use super::attraction::Attraction;
use super::law::AttractionLaw;
use super::tests::eliminated;
use crate::geometry::Grid;
use crate::kernel::love::influence_of_rectangle;
use crate::real::dot;
use contact_model::Boundary;
use std::f64::consts::{E, PI};

/// Cells of a row that are summed to each side; the rest of the row is an integral.
const ROW: i64 = 6000;
/// Half of the width of the strip, in longer sides of a cell: the release rate is off by the square of the
/// zone over it.
const HALF: f64 = 30.0;
/// How far rows beyond the strip are unknowns, in longer sides of a cell.
const BEYOND: f64 = 10.0;
/// Number of positions of the front in each row.
const PLACES: usize = 16;

/// A lattice row n of the direction (p, q) is the cells `(i, j)` with `q i - p j = n`; cells have the sides
/// `stretch` and `1/stretch`.
#[derive(Clone, Copy)]
struct Direction {
    p: i64,
    q: i64,
    stretch: f64,
}

/// Energy and release rates of fronts along one direction, over all their positions on the grid.
struct Front {
    /// Energy of a length of front, over w and the longer side of a cell.
    tension: f64,
    /// Energy release rate over w: mean, that of receding and that of advancing.
    mean: f64,
    receding: f64,
    advancing: f64,
}

impl Direction {
    /// The direction (p, q) on square cells.
    const fn square(p: i64, q: i64) -> Self {
        Self { p, q, stretch: 1.0 }
    }

    /// Length along a front after which it repeats itself.
    fn period(&self) -> f64 {
        (self.p as f64 * self.stretch).hypot(self.q as f64 / self.stretch)
    }

    /// A cell of row n.
    fn cell(&self, n: i64) -> (i64, i64) {
        let mut found = (0, 0);
        for i in 0..self.p.max(1) {
            // q i - p j = n.
            if self.p == 0 {
                found = (n / self.q, 0);
            } else if (self.q * i - n) % self.p == 0 {
                found = (i, (self.q * i - n) / self.p);
            }
        }
        found
    }

    /// Displacement in row n under a unit of pressure on the cells of row 0, `pi E* u`, less the logarithm of
    /// a line load's reach.
    fn influence(&self, n: i64) -> f64 {
        let (i, j) = self.cell(n);
        let length = self.period();
        let (across, along) = (self.stretch.powi(2), self.stretch.powi(-2));
        let middle = -((i * self.p) as f64 * across + (j * self.q) as f64 * along) / (length * length);
        let first = middle.round() as i64;
        let sum: f64 = (-ROW..=ROW)
            .map(|k| {
                let (x, y) = (i + (first + k) * self.p, j + (first + k) * self.q);
                influence_of_rectangle(x.unsigned_abs() as usize, y.unsigned_abs() as usize, self.stretch)
            })
            .sum();
        sum - 2.0 / length * ((ROW as f64 + 0.5) * length).ln()
    }

    /// Tension of the last closed cells of a strip and opening of the next ones, where the energy release
    /// rate is `w = 1`.
    fn edge(&self) -> (f64, f64) {
        const ROWS: usize = 300;
        let length = self.period();
        let influence: Vec<f64> = (0..=ROWS as i64).map(|k| self.influence(k) / PI).collect();
        // Pressures of the same displacement everywhere.
        let matrix: Vec<Vec<f64>> =
            (0..ROWS).map(|i| (0..ROWS).map(|k| influence[i.abs_diff(k)]).collect()).collect();
        let p = eliminated(matrix, vec![1.0; ROWS]);
        let beside = dot(&p, &(0..ROWS).map(|k| influence[ROWS - k]).collect::<Vec<_>>());
        // The stress intensity of a strip of half width h under the line load P is P/sqrt(pi h); at w it is
        // sqrt(2).
        let line = p.iter().sum::<f64>() / length;
        let scale = 2f64.sqrt() / (line / (PI * 0.5 * ROWS as f64 / length).sqrt());
        (scale * p[ROWS - 1], scale * (1.0 - beside))
    }

    /// The properties of fronts where a cell with all neighbours is stronger by the share `strength`.
    fn front(&self, strength: f64, attraction: &Attraction) -> Front {
        let strip = Strip::new(self, strength, attraction);
        let period = self.period();
        let (mut net, mut drawn) = strip.attached();
        let first = strip.share(&net, drawn);
        let mut front = Front { tension: 0.0, mean: 0.0, receding: 0.0, advancing: f64::INFINITY };
        for k in 0..PLACES {
            // Half of the strip loses a row.
            (net, drawn) = strip.with_share(net, drawn, first - k as f64 / (PLACES as f64 * period));
            let (release, energy) = strip.measured(&net, drawn);
            front.tension += energy / (strip.side * PLACES as f64);
            front.mean += release / PLACES as f64;
            front.receding = front.receding.max(release);
            front.advancing = front.advancing.min(release);
        }
        front
    }
}

/// Half of a strip, in units of the side of a square cell of the same area and with `E* = w = 1`.
struct Strip {
    law: AttractionLaw,
    strength: f64,
    /// Longer side of a cell.
    side: f64,
    half: f64,
    /// Distance of the rows.
    spacing: f64,
    influence: Vec<Vec<f64>>,
    /// Weights of the neighbours.
    weights: Vec<Vec<f64>>,
}

impl Strip {
    fn new(direction: &Direction, strength: f64, attraction: &Attraction) -> Self {
        let length = direction.period();
        let side = direction.stretch.max(direction.stretch.recip());
        let half = HALF * side;
        let n = ((HALF + BEYOND) * side * length) as usize;
        // Rows lie half a row and more from the middle of the strip. With this reach the energy release rate
        // falls as the strip narrows: fronts are stable.
        let reach = 2.0 / (PI * length) * (E * half / 4.0).ln();
        let single: Vec<f64> = (0..2 * n as i64).map(|k| direction.influence(k) / PI).collect();
        let influence =
            (0..n).map(|i| (0..n).map(|k| single[i.abs_diff(k)] + single[i + k + 1] + 2.0 * reach).collect());
        let mut weights = vec![vec![0.0; n]; n];
        for (i, j, weight) in attraction.weights() {
            let across = direction.q * i as i64 - direction.p * j as i64;
            for row in 0..n {
                let other = row as i64 + across;
                let other = if other < 0 { -other - 1 } else { other };
                if let Some(sum) = weights[row].get_mut(other as usize) {
                    *sum += weight;
                }
            }
        }
        let law = AttractionLaw { peak: PI * attraction.law.peak, ..attraction.law };
        Self { law, strength, side, half, spacing: length.recip(), influence: influence.collect(), weights }
    }

    fn gaps(&self, net: &[f64], drawn: f64) -> Vec<f64> {
        self.influence.iter().map(|row| dot(row, net) + drawn).collect()
    }

    /// Attached shares and factors of the rows.
    fn factors(&self, gap: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let attached: Vec<f64> = gap.iter().map(|&g| self.law.attached(g)).collect();
        let factor = |row: &Vec<f64>| 1.0 + self.strength * (2.0 * dot(row, &attached) - 1.0);
        let factors = self.weights.iter().map(factor).collect();
        (attached, factors)
    }

    /// Width of half of the attached strip.
    fn share(&self, net: &[f64], drawn: f64) -> f64 {
        self.spacing * self.factors(&self.gaps(net, drawn)).0.iter().sum::<f64>()
    }

    /// Net pressures of a strip at the displacement at which the energy release rate is w. The attraction of
    /// each sweep follows from the gaps of the one before.
    fn attached(&self) -> (Vec<f64>, f64) {
        let n = self.influence.len();
        let drawn = (2.0 * PI * self.half).sqrt() * 2.0 / PI;
        let inside = |i: usize| (i as f64 + 0.5) * self.spacing < self.half + 1.0;
        let mut gap: Vec<f64> = (0..n).map(|i| if inside(i) { 0.0 } else { 2.0 * self.law.range }).collect();
        let mut net = vec![0.0; n];
        for _ in 0..5000 {
            let (_, factors) = self.factors(&gap);
            let pull: Vec<f64> = factors.iter().zip(&gap).map(|(f, &g)| f * self.law.traction(g)).collect();
            let mut closed: Vec<bool> = gap.iter().map(|&g| g <= 0.0).collect();
            let next = loop {
                let row = |i: usize| {
                    let unit = (0..n).map(|k| f64::from(u8::from(i == k))).collect();
                    if closed[i] { (self.influence[i].clone(), -drawn) } else { (unit, -pull[i]) }
                };
                let (matrix, right) = (0..n).map(row).unzip();
                net = eliminated(matrix, right);
                let mut next = self.gaps(&net, drawn);
                let wrong =
                    |i: &usize| if closed[*i] { net[*i] + pull[*i] < -1e-12 } else { next[*i] < -1e-12 };
                let wrong: Vec<usize> = (0..n).filter(wrong).collect();
                if wrong.is_empty() {
                    next.iter_mut().zip(&closed).filter(|(_, closed)| **closed).for_each(|(g, _)| *g = 0.0);
                    break next;
                }
                for i in wrong {
                    closed[i] = !closed[i];
                }
            };
            let change = next.iter().zip(&gap).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
            gap = next;
            if change < 1e-6 {
                break;
            }
        }
        (net, drawn)
    }

    /// The equilibrium with an attached width of half of the strip, by Newton's method from one nearby.
    fn with_share(&self, mut net: Vec<f64>, mut drawn: f64, width: f64) -> (Vec<f64>, f64) {
        let n = net.len();
        for _ in 0..60 {
            let gap = self.gaps(&net, drawn);
            let (attached, factors) = self.factors(&gap);
            let pull: Vec<f64> = factors.iter().zip(&gap).map(|(f, &g)| f * self.law.traction(g)).collect();
            let closed: Vec<bool> = (0..n).map(|i| gap[i] < net[i] + pull[i]).collect();
            // Of attached shares and of attractions in the gaps; a closed row keeps its gap.
            let lost: Vec<f64> =
                gap.iter().map(|&g| if g > 0.0 { -self.law.traction(g) } else { 0.0 }).collect();
            let derivative = |i: usize, k: usize| {
                let own = if i == k && gap[i] > 0.0 { -factors[i] * self.law.slope(gap[i]) } else { 0.0 };
                own + 2.0 * self.strength * self.law.traction(gap[i]) * self.weights[i][k] * lost[k]
            };
            let mut right: Vec<f64> =
                (0..n).map(|i| if closed[i] { -gap[i] } else { -net[i] - pull[i] }).collect();
            right.push(width - self.spacing * attached.iter().sum::<f64>());
            let off = right.iter().fold(0.0f64, |m, r| m.max(r.abs()));
            if off < 1e-9 {
                return (net, drawn);
            }
            let product = |row: &[f64]| -> Vec<f64> {
                let mut sums = vec![0.0; n + 1];
                for (k, d) in row.iter().enumerate().filter(|(_, d)| **d != 0.0) {
                    sums.iter_mut().zip(&self.influence[k]).for_each(|(sum, g)| *sum += d * g);
                    sums[n] += d;
                }
                sums
            };
            let mut matrix: Vec<Vec<f64>> = (0..n)
                .map(|i| {
                    if closed[i] {
                        let mut row = self.influence[i].clone();
                        row.push(1.0);
                        return row;
                    }
                    let row: Vec<f64> = (0..n).map(|k| derivative(i, k)).collect();
                    let mut row = product(&row);
                    row[i] += 1.0;
                    row
                })
                .collect();
            matrix.push(product(&lost.iter().map(|x| self.spacing * x).collect::<Vec<_>>()));
            let step = eliminated(matrix, right);
            net.iter_mut().zip(&step).for_each(|(p, s)| *p += s);
            drawn += step[n];
        }
        panic!("no equilibrium");
    }

    /// Energy release rate, from the half width of the strip without cohesive zones that is as stiff, and the
    /// energy of a length of front: that of the work and its zone, over that of the same in this strip.
    fn measured(&self, net: &[f64], drawn: f64) -> (f64, f64) {
        let gap = self.gaps(net, drawn);
        let (attached, factors) = self.factors(&gap);
        let line = -2.0 * self.spacing * net.iter().sum::<f64>();
        let tip = E * self.half * (-PI * drawn / (2.0 * line)).exp();
        // A factor is 1 + B (2 m - 1), the energy of a row 1 - B (1 - m).
        let held = |(x, f): (&f64, &f64)| 0.5 * x * (1.0 - self.strength + f);
        let work: f64 = attached.iter().zip(&factors).map(held).sum();
        (line * line / (2.0 * PI * tip), self.spacing * (0.5 * dot(net, &gap) - work) + tip)
    }
}

/// Checks bounds of the line tension and of the release rates of receding and advancing straight fronts on
/// these cells.
#[test]
fn fronts_move_at_w_in_all_directions_and_on_oblong_cells() {
    println!("cells  direction  tension  without neighbours  mean, receding, advancing release rate");
    // Cells of 1, 2 and 3 to 1, and no symmetry.
    for (stretch, directions) in [
        (1.0, &[(0, 1), (1, 1), (1, 2), (3, 4)][..]),
        (2f64.sqrt(), &[(0, 1), (1, 0), (1, 1), (1, 2)]),
        (3f64.sqrt(), &[(0, 1), (1, 0), (1, 1)]),
        (1.3f64.sqrt(), &[(0, 1), (1, 0), (2, 1)]),
    ] {
        let grid = Grid { columns: 64, rows: 64, stretch };
        let attraction = Attraction::short(1.0 / PI, grid, Boundary::Free);
        for &(p, q) in directions {
            let direction = Direction { p, q, stretch };
            let alone = direction.front(0.0, &attraction).tension;
            let Front { tension, mean, receding, advancing } =
                direction.front(attraction.strength(), &attraction);
            println!(
                "{:.1} ({p}, {q})  {tension:.3}  {alone:.3}  {mean:.4} {receding:.4} {advancing:.4}",
                stretch * stretch
            );
            assert!((-0.09..-0.05).contains(&tension), "{tension}");
            assert!((0.48..0.52).contains(&-alone), "{alone}");
            assert!((mean - 1.0).abs() < 2e-3, "{mean}");
            assert!(receding < 1.014 && advancing > 0.99, "{receding} {advancing}");
        }
    }
}

/// The table of the book's page on adhesion of short range.
#[test]
fn half_of_tension_and_opening_is_the_release_rate_in_every_direction() {
    // The error of the finite widths of the strip and of the rows.
    const NEAR: f64 = 6e-3;
    for ((p, q), tension, opening) in [
        ((0, 1), 1.077, 1.856),
        ((1, 1), 1.266, 1.580),
        ((1, 2), 1.389, 1.442),
        ((1, 4), 1.442, 1.390),
        ((3, 4), 1.449, 1.383),
    ] {
        let (t, g) = Direction::square(p, q).edge();
        println!("({p}, {q})  {t:.4}  {g:.4}  {:.4}", 0.5 * t * g);
        approx::assert_relative_eq!(0.5 * t * g, 1.0, max_relative = 2.0 * NEAR);
        approx::assert_relative_eq!(t, tension, max_relative = NEAR);
        approx::assert_relative_eq!(g, opening, max_relative = NEAR);
    }
}
