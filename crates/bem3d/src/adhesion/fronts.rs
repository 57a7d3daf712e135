//! Straight fronts of a short range on an infinite grid, in directions of small numbers: what the constants
//! of [`super::attraction`] rest on.
//!
//! A strip of attached cells between two fronts along the direction (p, q) is drawn off a plane by a
//! displacement. All cells of a row along the front do the same, so that rows are the unknowns.
//! `cargo test --release -p bem3d fronts -- --nocapture` prints the table.

#![allow(clippy::needless_range_loop)] // Indices as in the formulas.
#![allow(clippy::cast_possible_wrap, clippy::cast_sign_loss)] // Small numbers.

use super::attraction::Attraction;
use super::law::Law;
use super::tests::eliminated;
use crate::geometry::Grid;
use crate::kernel::love::influence_of_rectangle;
use crate::real::dot;
use contact_model::Boundary;
use std::f64::consts::{E, PI};

/// Cells of a row that are summed to each side; the rest of the row is an integral.
const ROW: i64 = 1000;
/// Half of the width of the strip, in cells: the release rate is off by the square of the zone over it.
const HALF: f64 = 40.0;

/// A lattice row n of the direction (p, q) is the cells `(i, j)` with `q i - p j = n`.
struct Direction {
    p: i64,
    q: i64,
}

/// What fronts of a direction do, averaged over their place on the grid.
#[derive(Default)]
struct Front {
    /// Energy of a length of front, over w a.
    tension: f64,
    /// Energy release rate over w: least and most.
    release: (f64, f64),
}

impl Direction {
    /// Cells along a front after which it repeats itself, as a length.
    fn period(&self) -> f64 {
        (self.p as f64).hypot(self.q as f64)
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
        let middle = -((i * self.p + j * self.q) as f64) / (length * length);
        let first = middle.round() as i64;
        let sum: f64 = (-ROW..=ROW)
            .map(|k| {
                let (x, y) = (i + (first + k) * self.p, j + (first + k) * self.q);
                influence_of_rectangle(x.unsigned_abs() as usize, y.unsigned_abs() as usize, 1.0)
            })
            .sum();
        sum - 2.0 / length * ((ROW as f64 + 0.5) * length).ln()
    }

    /// Weights of the neighbours, summed over each row.
    fn neighbours(&self, attraction: &Attraction) -> Vec<(i64, f64)> {
        let mut rows: Vec<(i64, f64)> = Vec::new();
        for (i, j, weight) in attraction.weights() {
            let n = self.q * i - self.p * j;
            match rows.iter_mut().find(|(row, _)| *row == n) {
                Some((_, sum)) => *sum += weight,
                None => rows.push((n, weight)),
            }
        }
        rows
    }

    /// Tension of the last cells of a strip that all hold on and opening of the next ones, where fronts
    /// release `w = 1`.
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

    /// Equilibria of strips, in units of a and with `E* = w = 1`.
    fn front(&self, strength: f64, attraction: &Attraction) -> Front {
        let length = self.period();
        let law = Law { peak: PI * attraction.law.peak, ..attraction.law };
        let spacing = length.recip();
        let n = (2.0 * (HALF + 6.0) * length) as usize;
        let influence: Vec<f64> = (0..n as i64).map(|k| self.influence(k) / PI).collect();
        let neighbours = self.neighbours(attraction);
        let places = [0.1, 0.35];
        let mut front = Front { release: (f64::INFINITY, 0.0), ..Front::default() };
        for place in places {
            let half = HALF + place;
            // With this reach the energy release rate falls as the strip narrows: fronts are stable.
            let reach = 2.0 / (PI * length) * (E * half / 4.0).ln();
            let g = |i: usize, k: usize| influence[i.abs_diff(k)] + reach;
            let drawn = (2.0 * PI * half).sqrt() * 2.0 / PI;
            let mut gap: Vec<f64> = (0..n)
                .map(|i| {
                    let x = (i as f64 - 0.5 * (n as f64 - 1.0)) * spacing;
                    if x.abs() < half + 1.0 { 0.0 } else { 2.0 * law.range }
                })
                .collect();
            let mut net = vec![0.0; n];
            let held = |gap: &[f64]| -> (Vec<f64>, Vec<f64>) {
                let attached: Vec<f64> = gap.iter().map(|&g| law.attached(g)).collect();
                let mean = (0..n as i64)
                    .map(|i| {
                        (neighbours.iter())
                            .map(|(k, w)| attached.get((i + k) as usize).map_or(0.0, |a| a * w))
                            .sum()
                    })
                    .collect();
                (attached, mean)
            };
            for _ in 0..5000 {
                let (_, mean) = held(&gap);
                let pull: Vec<f64> =
                    (0..n).map(|i| (1.0 + strength * (2.0 * mean[i] - 1.0)) * law.traction(gap[i])).collect();
                let mut closed: Vec<bool> = gap.iter().map(|&g| g <= 0.0).collect();
                let next = loop {
                    let mut matrix = vec![vec![0.0; n]; n];
                    let mut right = vec![0.0; n];
                    for i in 0..n {
                        if closed[i] {
                            matrix[i] = (0..n).map(|k| g(i, k)).collect();
                            right[i] = -drawn;
                        } else {
                            (matrix[i][i], right[i]) = (1.0, -pull[i]);
                        }
                    }
                    net = eliminated(matrix, right);
                    let next: Vec<f64> = (0..n)
                        .map(|i| {
                            if closed[i] {
                                0.0
                            } else {
                                (0..n).map(|k| g(i, k) * net[k]).sum::<f64>() + drawn
                            }
                        })
                        .collect();
                    let wrong: Vec<usize> = (0..n)
                        .filter(|&i| if closed[i] { net[i] + pull[i] < -1e-12 } else { next[i] < -1e-12 })
                        .collect();
                    if wrong.is_empty() {
                        break next;
                    }
                    for i in wrong {
                        closed[i] = !closed[i];
                    }
                };
                let change = next.iter().zip(&gap).fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
                gap = next;
                if change < 1e-8 {
                    break;
                }
            }
            let (attached, mean) = held(&gap);
            // Half of the width of the strip without cohesive zones that is as stiff.
            let line = net.iter().sum::<f64>() * spacing;
            let tip = E * half * (-PI * drawn / (2.0 * line.abs())).exp();
            let release = line * line / (2.0 * PI * tip);
            // Energies of a length of both fronts: of the work and its zone, and of the same in the strip
            // without one.
            let zone: f64 = 0.5 * dot(&net, &gap);
            let work: f64 =
                -attached.iter().zip(&mean).map(|(a, m)| a * (1.0 - strength * (1.0 - m))).sum::<f64>();
            front.tension += 0.5 * (spacing * (zone + work) + 2.0 * tip) / places.len() as f64;
            front.release = (front.release.0.min(release), front.release.1.max(release));
        }
        front
    }
}

#[test]
fn fronts_have_no_line_tension_and_move_at_w_in_all_directions() {
    let attraction = Attraction::short(1.0 / PI, Grid::square(64, 64), Boundary::Free);
    println!("direction  tension  without neighbours  release rate");
    for (p, q) in [(0, 1), (1, 1), (1, 2)] {
        let direction = Direction { p, q };
        let alone = direction.front(0.0, &attraction);
        let front = direction.front(attraction.strength(), &attraction);
        let (least, most) = front.release;
        println!("({p}, {q})  {:.3}  {:.3}  {least:.4} to {most:.4}", front.tension, alone.tension);
        assert!(front.tension.abs() < 0.02, "{}", front.tension);
        assert!((0.38..0.46).contains(&-alone.tension), "{}", alone.tension);
        assert!(least > 0.99 && most < 1.02, "{least} {most}");
    }
}

/// The table of the book's page on adhesion of short range.
#[test]
fn half_of_tension_and_opening_is_the_release_rate_in_every_direction() {
    // What the width of the strip and of the rows leave.
    const NEAR: f64 = 6e-3;
    for ((p, q), tension, opening) in [
        ((0, 1), 1.077, 1.856),
        ((1, 1), 1.266, 1.580),
        ((1, 2), 1.389, 1.442),
        ((1, 4), 1.442, 1.390),
        ((3, 4), 1.449, 1.383),
    ] {
        let (t, g) = Direction { p, q }.edge();
        println!("({p}, {q})  {t:.4}  {g:.4}  {:.4}", 0.5 * t * g);
        approx::assert_relative_eq!(0.5 * t * g, 1.0, max_relative = 2.0 * NEAR);
        approx::assert_relative_eq!(t, tension, max_relative = NEAR);
        approx::assert_relative_eq!(g, opening, max_relative = NEAR);
    }
}
