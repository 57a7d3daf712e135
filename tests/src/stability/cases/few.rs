//! One cell, two cells, tiny grids.

use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::{press, press_both};
use bem3d::love::influence;
use contact_model::{HeightMap, Load, Result};
use std::f64::consts::PI;

/// Rounding of sets of a few cells.
const ROUNDING: f64 = 1e-12;

pub(super) const CASES: [HardCase; 6] = [
    HardCase {
        name: "one cell",
        why: "a search direction is 0/0 once its mean is taken out",
        asserted: "k = pi E* h_c/(4 ln(1 + sqrt 2)) and d = F/k, on 1 x 1 cells and on the summit of a rough surface",
        bound: ROUNDING,
        solve: one_cell,
    },
    HardCase {
        name: "two adjacent cells",
        why: "the smallest coupled set; symmetric, so neither cell may leave",
        asserted: "k = 2 pi E* h_c/(I(0,0) + I(1,0)) = 1.376821433419 E* h_c",
        bound: ROUNDING,
        solve: |ledger, _| two_cells(ledger, (1, 0), 1.376_821_433_419),
    },
    HardCase {
        name: "two diagonal cells",
        why: "they touch in a corner, where the logarithms of the kernel are singular",
        asserted: "k = 2 pi E* h_c/(I(0,0) + I(1,1)) = 1.478329831506 E* h_c",
        bound: ROUNDING,
        solve: |ledger, _| two_cells(ledger, (1, 1), 1.478_329_831_506),
    },
    HardCase {
        name: "two distant summits",
        why: "clusters coupled by one part in a thousand: a window around both is almost empty",
        asserted: "k = 2 pi E* h_c/(I(0,0) + I(N-1,N-1)); a summit that is lower joins at the approach z/(1 - I(N-1,N-1)/I(0,0))",
        bound: ROUNDING,
        solve: two_summits,
    },
    HardCase {
        name: "a single spike",
        why: "one cell carries everything until the plain around it is reached",
        asserted: "one cell's k up to the approach z/(1 - I(far)/I(0,0)) at which the farthest corner touches; more cells beyond",
        bound: ROUNDING,
        solve: spike,
    },
    HardCase {
        name: "grids of 1, 2 and 3 cells",
        why: "transforms of length 1, 2 and 4; every cell is an edge",
        asserted: "k of full contact by elimination and 0.891106989, 0.993186221, 1.040161425 E* L, and at heavy loads on rough heights",
        bound: 1e-9,
        solve: smallest_grids,
    },
];

/// A map with height 0 on the cells that `face` selects, and lower by one side elsewhere.
pub(super) fn faces(cells: usize, face: impl Fn(usize, usize) -> bool) -> Result<HeightMap> {
    map(cells, 1.0, |x, y| if face(x, y) { 0.0 } else { -1.0 })
}

fn one_cell(ledger: &mut Ledger, _: Effort) -> Result<()> {
    let exact = PI / (4.0 * (1.0 + 2_f64.sqrt()).ln());
    let flat = map(1, 1.0, |_, _| -3.5)?;
    for load in [Load::force(0.3), Load::force(1e-200), Load::force(1e150), Load::approach(1e-12)] {
        let state = press_both(ledger, &flat, load)?;
        ledger.near("k", stiffness(&state)?, exact);
        ledger.near("F/d", state.force / approach(&state)?, exact);
    }
    for cells in [16, 33, 65] {
        let map = rough_map(2.6, cells, 8)?;
        let state = press_both(ledger, &map, Load::force(1e-12))?;
        ledger.contact(&state, 1, exact * map.dx())?;
        ledger.near("F/d", state.force / approach(&state)?, exact * map.dx());
    }
    Ok(())
}

fn two_cells(ledger: &mut Ledger, (dx, dy): (usize, usize), printed: f64) -> Result<()> {
    for (cells, (x0, y0)) in [(2, (0, 0)), (3, (1, 1)), (7, (2, 4)), (64, (62, 0))] {
        let pair = [(x0, y0), (x0 + dx, y0 + dy)];
        let map = faces(cells, |x, y| pair.contains(&(x, y)))?;
        for load in [Load::approach(1e-3), Load::force(1e-6), Load::force(1e-150)] {
            let state = press_both(ledger, &map, load)?;
            ledger.contact(&state, 2, 2.0 * PI * map.dx() / (influence(0, 0) + influence(dx, dy)))?;
            ledger.near("k as printed", stiffness(&state)?, printed * map.dx());
        }
    }
    Ok(())
}

fn two_summits(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let sizes: &[usize] = effort.pick(&[9, 101, 512], &[9, 101, 512, 2049]);
    for &cells in sizes {
        let far = influence(cells - 1, cells - 1) / influence(0, 0);
        let last = cells - 1;
        let even = map(cells, 1.0, |x, y| if x == y && (x == 0 || x == last) { 1.0 } else { 0.0 })?;
        let cell = even.dx();
        let one = PI * cell / influence(0, 0);
        let state = press_both(ledger, &even, Load::force(1e-3 * cell))?;
        ledger.contact(&state, 2, 2.0 * one / (1.0 + far))?;
        // The lower one, z below, is lowered by far x d while the first alone carries.
        let z = 1e-3;
        let uneven = map(cells, 1.0, |x, y| match (x, y) {
            (0, 0) => 1.0,
            (x, y) if x == last && y == last => 1.0 - z,
            _ => 0.0,
        })?;
        let joins = z / (1.0 - far);
        for (factor, count, k) in [(0.999_9, 1, one), (1.000_1, 2, 2.0 * one / (1.0 + far))] {
            let state = press_both(ledger, &uneven, Load::approach(factor * joins))?;
            ledger.contact(&state, count, k)?;
        }
    }
    Ok(())
}

fn spike(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for cells in [9, 64, 101] {
        let map = map(cells, 1.0, |x, y| if (x, y) == (4, 5) { 1.0 } else { 0.0 })?;
        let one = PI * map.dx() / influence(0, 0);
        // The spike presses its surroundings down with it: the farthest corner is touched first.
        let corner = (4_usize.max(cells - 1 - 4), 5_usize.max(cells - 1 - 5));
        let joins = 1.0 / (1.0 - influence(corner.0, corner.1) / influence(0, 0));
        for d in [1e-12, 1e-3, 0.9, 0.999_9 * joins] {
            let state = press_both(ledger, &map, Load::approach(d))?;
            ledger.contact(&state, 1, one)?;
        }
        let state = press(ledger, &map, Load::approach(1.000_1 * joins))?;
        let count = state.report.contact_cells;
        ledger.must(count.is_some_and(|c| c > 1), || format!("{count:?} cells beyond the kink"));
    }
    Ok(())
}

fn smallest_grids(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for (cells, printed) in [(1, 0.891_106_989), (2, 0.993_186_221), (3, 1.040_161_425)] {
        let all: Vec<usize> = (0..cells * cells).collect();
        let exact = PlainSum::new([cells; 2], [1.0 / cells as f64; 2]).stiffness(&all);
        // Half a unit of the ninth printed digit.
        ledger.near("printed k", exact, printed);
        let flat = map(cells, 1.0, |_, _| 0.0)?;
        let uneven = map(cells, 1.0, |x, y| 0.1 * ((3 * x + 7 * y) as f64).sin())?;
        for (map, load) in [
            (&flat, Load::force(1.0)),
            (&flat, Load::approach(1e-100)),
            (&uneven, Load::force(1e3)),
            (&uneven, Load::approach(1e4)),
        ] {
            let state = press_both(ledger, map, load)?;
            ledger.contact(&state, all.len(), exact)?;
        }
    }
    Ok(())
}
