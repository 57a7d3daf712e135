//! Ties: several cells that come into contact at the same load.

use super::few::faces;
use crate::stability::case::{Effort, HardCase};
use crate::stability::ledger::{Ledger, approach, pressure, stiffness};
use crate::stability::maps::{map, rough_map};
use crate::stability::plain::PlainSum;
use crate::stability::press::{against_relaxation, press, press_both, tight};
use contact_model::{ContactModel, HeightMap, Load, Result};

pub(super) const CASES: [HardCase; 5] = [
    HardCase {
        name: "flat top",
        why: "every cell of a plateau touches at once: the set jumps from none to all",
        asserted: "k of 8 x 8 cells by elimination and 1.106498258 x 8 E* h_c, at any light load",
        bound: 1e-9,
        solve: flat_top,
    },
    HardCase {
        name: "flat maps",
        why: "rms height 0: no unit for gaps, no F_bar",
        asserted: "k of full contact and F = k d for loads of 1e-200 to 1e200; F_bar is refused",
        bound: 1e-9,
        solve: flat_maps,
    },
    HardCase {
        name: "quantised heights",
        why: "heights in steps of rms/4: hundreds of exact ties, and a contact set that rounding could choose",
        asserted: "moving every height by at most e moves d at a given force by at most 2 e (excess, in e)",
        bound: 1e-3,
        solve: quantised,
    },
    HardCase {
        name: "symmetric bodies",
        why: "orbits of eight cells reach their edge together and must join and leave together",
        asserted: "the pressure has all eight symmetries of the square (relative to its largest value)",
        bound: 1e-8,
        solve: symmetric,
    },
    HardCase {
        name: "a checkerboard",
        why: "all black cells touch together; the kernel is nearest to singular at this wave",
        asserted: "light loads: black cells only, F and k by relaxation and elimination; heavy: k of full contact",
        bound: 1e-8,
        solve: checkerboard,
    },
];

fn flat_top(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for (cells, x0, y0) in [(8, 0, 0), (33, 3, 20), (64, 56, 56), (65, 28, 1)] {
        let inside = |x: usize, y: usize| (x0..x0 + 8).contains(&x) && (y0..y0 + 8).contains(&y);
        let map = faces(cells, inside)?;
        let contact: Vec<usize> = (0..cells * cells).filter(|i| inside(i % cells, i / cells)).collect();
        let exact = PlainSum::of(&map).stiffness(&contact);
        ledger.near("printed k", exact, 1.106_498_258 * 8.0 * map.dx());
        for load in [Load::approach(1e-6), Load::force(1e-12), Load::force(1e-3)] {
            let state = press_both(ledger, &map, load)?;
            ledger.contact(&state, 64, exact)?;
        }
    }
    Ok(())
}

fn flat_maps(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for cells in [2, 7, 31] {
        let all: Vec<usize> = (0..cells * cells).collect();
        let exact = PlainSum::new([cells; 2], [1.0 / cells as f64; 2]).stiffness(&all);
        for height in [0.0, 1e9] {
            let flat = map(cells, 1.0, |_, _| height)?;
            for size in [1e-200, 1e-12, 0.3, 1e12, 1e200] {
                for load in [Load::force(size), Load::approach(size)] {
                    let state = press(ledger, &flat, load)?;
                    ledger.contact(&state, all.len(), exact)?;
                    ledger.near("F/d", state.force / approach(&state)?, exact);
                }
            }
            let contact = tight().prepare(&crate::stability::scene(flat), 0)?;
            ledger.must(contact.normalisation().force_bar(1.0).is_err(), || "F_bar of a flat map".to_owned());
        }
    }
    Ok(())
}

/// `|d(h + e) - d(h)|` at one force: with `g = u + h_max - h - d`, raising h by less than e at every cell
/// lowers the mean plane's own approach by less than e (a higher surface is touched earlier), and `h_max`
/// moves by less than e too.
fn quantised(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let cells = effort.pick(33, 65);
    for (fractal_dimension, step) in [(2.0, 0.25), (2.5, 0.25), (3.0, 0.5)] {
        let drawn = rough_map(fractal_dimension, cells, 4)?;
        let steps = map(cells, 1.0, |x, y| (drawn.heights()[y * cells + x] / step).round() * step)?;
        let e = 1e-3;
        let moved = map(cells, 1.0, |x, y| {
            steps.heights()[y * cells + x] + e * ((13 * x + 29 * y * y) as f64).sin()
        })?;
        for force in [1e-4, 1e-2, 0.3, 20.0] {
            let d = approach(&press_both(ledger, &steps, Load::force(force))?)?;
            let other = approach(&press(ledger, &moved, Load::force(force))?)?;
            ledger.enter(((other - d).abs() / e - 2.0).max(0.0));
        }
        for d in [1e-3, 0.3, 1.5] {
            // Steps that touch are flat; the set is theirs.
            let mut beside = Ledger::default();
            against_relaxation(&mut beside, &steps, d)?;
            let (figure, broken) = beside.close();
            ledger.must(broken.is_empty() && figure.is_some_and(|f| f < 1e-8), || {
                format!("D_f {fractal_dimension}, d {d}: {figure:?} {broken:?}")
            });
        }
    }
    Ok(())
}

fn symmetric(ledger: &mut Ledger, effort: Effort) -> Result<()> {
    let sizes: &[usize] = effort.pick(&[16, 33], &[16, 33, 64, 129]);
    for &cells in sizes {
        let centre = 0.5 * (cells - 1) as f64;
        let bodies: [fn(f64, f64) -> f64; 4] = [
            |x, y| -(x * x + y * y),
            |x, y| -x.hypot(y).sqrt(),
            |x, y| (6.0 * x).cos() * (6.0 * y).cos(),
            |x, y| -(x.abs().max(y.abs())),
        ];
        for body in bodies {
            let at = |i: usize| (i as f64 - centre) / cells as f64;
            let map = map(cells, 1.0, |x, y| body(at(x), at(y)))?;
            for force in [1e-9, 1e-4, 1e-2, 1.0] {
                let state = press_both(ledger, &map, Load::force(force))?;
                let p = HeightMap::new(cells, 1.0, pressure(&state)?.to_vec())?;
                for turned in [p.mirrored(), p.transposed()] {
                    ledger.field(p.heights(), turned.heights(), p.highest());
                }
            }
        }
    }
    Ok(())
}

fn checkerboard(ledger: &mut Ledger, _: Effort) -> Result<()> {
    for cells in [3, 8, 17, 20] {
        let board = map(cells, 1.0, |x, y| if (x + y) % 2 == 0 { 0.0 } else { -1.0 })?;
        let black = (cells * cells).div_ceil(2);
        let light = press_both(ledger, &board, Load::approach(1e-3))?;
        ledger.contact_cells(&light, black);
        against_relaxation(ledger, &board, 1e-3)?;
        ledger.near("F = k d", light.force, stiffness(&light)? * 1e-3);
        let all: Vec<usize> = (0..cells * cells).collect();
        let full = PlainSum::of(&board).stiffness(&all);
        let heavy = press_both(ledger, &board, Load::force(1e3))?;
        ledger.contact(&heavy, all.len(), full)?;
    }
    Ok(())
}
