//! Shapes made by hand.

use super::few::faces;
use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::{against_relaxation, press, press_both};
use contact_model::{HeightMap, Load, Result};

/// Two solves with the tolerance 1e-10, one by relaxation to rounding.
const RELAXED: f64 = 1e-8;

pub(super) const CASES: [HardCase; 5] = [
    HardCase {
        name: "a saw-tooth",
        why: "cliffs beside summits: neighbours of contact cells are out of reach",
        asserted: "contact set exactly, F and k by relaxation; in full contact dF = k dd exactly, k of the square",
        bound: RELAXED,
        solve: saw_tooth,
    },
    HardCase {
        name: "anisotropic surfaces",
        why: "ridges along one axis: contact sets eight times as long as wide",
        asserted: "contact set exactly, F and k by relaxation and elimination, along x and along y",
        bound: RELAXED,
        solve: anisotropic,
    },
    HardCase {
        name: "flat rectangles",
        why: "long windows: transforms of different lengths in x and y",
        asserted: "k/(E* sqrt(A)) = 1.181626 (2:1) and 1.271291 (4:1), extrapolated from two grids; equal for either direction",
        bound: 1e-3,
        solve: rectangles,
    },
    HardCase {
        name: "wedges",
        why: "first touch along a line; a tilted plane touches along one edge of the square",
        asserted: "contact set exactly, F and k by relaxation and elimination",
        bound: RELAXED,
        solve: wedges,
    },
    HardCase {
        name: "a moat",
        why: "a rim shields what lies inside it: cells far from any contact touch late, and a guess grows the wrong way",
        asserted: "contact set exactly, F and k by relaxation and elimination",
        bound: RELAXED,
        solve: moat,
    },
];

fn saw_tooth(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let cells = 32;
    let teeth = map(cells, 1.0, |x, _| (x % 8) as f64 / 8.0)?;
    for d in [0.01, 0.2, 0.7, 1.5] {
        against_relaxation(ledger, &teeth, d)?;
    }
    let [one, other] = [Load::approach(60.0), Load::approach(90.0)];
    let (one, other) = (press_both(ledger, &teeth, one)?, press_both(ledger, &teeth, other)?);
    let all: Vec<usize> = (0..cells * cells).collect();
    for state in [&one, &other] {
        ledger.contact(state, all.len(), 1.140_213_49)?;
    }
    ledger.near("dF/dd in full contact", (other.force - one.force) / 30.0, stiffness(&one)?);
    Ok(())
}

fn anisotropic(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(32, 48);
    for fractal_dimension in [2.2, 2.8] {
        let drawn = rough_map(fractal_dimension, cells, 11)?;
        let at = |x: usize, y: usize| drawn.heights()[y * cells + x];
        // Ridges: the waves of every eighth row, drawn out.
        let along_y = map(cells, 1.0, |x, y| at(x, y / 8))?;
        let along_x = map(cells, 1.0, |x, y| at(y, x / 8))?;
        for d in [0.02, 0.4, 1.5, 4.0] {
            against_relaxation(ledger, &along_y, d)?;
            against_relaxation(ledger, &along_x, d)?;
        }
    }
    Ok(())
}

fn rectangles(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let width = effort.pick(16, 32);
    for (aspect, exact) in [(2, 1.181_626), (4, 1.271_291)] {
        let k = |ledger: &mut Ledger, width: usize, turned: bool| -> Result<f64> {
            let length = aspect * width;
            let inside = |along: usize, across: usize| along < length && across < width;
            let map = faces(length, |x, y| if turned { inside(y, x) } else { inside(x, y) })?;
            let state = press(ledger, &map, Load::approach(1e-3))?;
            let area = (length * width) as f64 * map.dx() * map.dx();
            Ok(stiffness(&state)? / area.sqrt())
        };
        let (coarse, fine) = (k(ledger, width, false)?, k(ledger, 2 * width, false)?);
        // First order in the cell (the edge singularity): the extrapolated value.
        ledger.near("rectangle", 2.0 * fine - coarse, exact);
        let turned = k(ledger, width, true)?;
        ledger.must((turned / coarse - 1.0).abs() < 1e-9, || format!("{turned} turned, {coarse} not"));
    }
    Ok(())
}

fn wedges(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 48);
    let shapes: [fn(f64, f64) -> f64; 4] =
        [|x, _| -x.abs(), |x, y| -(x + y).abs(), |x, _| 0.3 * x, |x, y| 0.3 * x + 0.1 * y];
    for shape in shapes {
        let at = |i: usize| (i as f64 - 0.5 * (cells - 1) as f64) / cells as f64;
        let body = map(cells, 1.0, |x, y| shape(at(x), at(y)))?;
        for d in [1e-3, 0.03, 0.2, 0.6] {
            against_relaxation(ledger, &body, d)?;
        }
    }
    Ok(())
}

fn moat(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 48);
    let centre = 0.5 * (cells - 1) as f64;
    let ring = |island: f64| -> Result<HeightMap> {
        map(cells, 1.0, |x, y| {
            let r = (x as f64 - centre).hypot(y as f64 - centre) / cells as f64;
            match r {
                r if r < 0.1 => island,
                r if r < 0.25 => -2.0,
                r if r < 0.35 => 0.0,
                _ => -0.5,
            }
        })
    };
    for island in [-0.05, 0.0, 0.05] {
        let map = ring(island)?;
        for d in [0.01, 0.06, 0.3, 2.0, 8.0] {
            against_relaxation(ledger, &map, d)?;
        }
    }
    // What the rim shields: the island alone touches at its depth, within the rim later.
    let low = ring(-0.05)?;
    let shielded = press(ledger, &low, Load::approach(0.051))?;
    let rim: Vec<usize> = (0..cells * cells).filter(|&i| low.heights()[i] >= 0.0).collect();
    ledger.near("k of the rim alone", stiffness(&shielded)?, PlainSum::of(&low).stiffness(&rim));
    Ok(())
}
