//! Flow against elimination without subtractions, against closed forms, and against hostile values.

use super::*;
use contact_model::Size;
use proptest::prelude::*;
use std::collections::BTreeMap;

/// Conductance of the network of cells by elimination of one cell after the other (star-mesh transform),
/// which adds, multiplies and divides positive numbers only and is exact to rounding at any contrast. It
/// writes out the network anew, and shares no line with the solver. Cost: O(N width^2), with fill-in between
/// cells of a band.
fn eliminated(k: &Field, axis: FlowAxis, boundary: Boundary) -> f64 {
    let [repeats_x, repeats_y] = boundary.repeats();
    let is_x = axis == FlowAxis::X;
    let (layers, width, repeats) =
        if is_x { (k.columns(), k.rows(), repeats_y) } else { (k.rows(), k.columns(), repeats_x) };
    let at = |layer: usize, place: usize| if is_x { k.at(layer, place) } else { k.at(place, layer) };
    let aspect = if is_x { k.dy() / k.dx() } else { k.dx() / k.dy() };
    let mean = |a: f64, b: f64| if a > 0.0 && b > 0.0 { 2.0 / (1.0 / a + 1.0 / b) } else { 0.0 };
    // Conductances of the cells that are left, and to both edges, as the last two.
    let cells = layers * width;
    let mut rows: Vec<BTreeMap<usize, f64>> = vec![BTreeMap::default(); cells + 2];
    let mut join = |a: usize, b: usize, weight: f64| {
        if weight > 0.0 && a != b {
            *rows[a].entry(b).or_default() += weight;
            *rows[b].entry(a).or_default() += weight;
        }
    };
    for layer in 0..layers {
        for place in 0..width {
            let cell = layer * width + place;
            let own = at(layer, place);
            if place + 1 < width || repeats {
                let next = (place + 1) % width;
                join(cell, layer * width + next, mean(own, at(layer, next)) / aspect);
            }
            if layer + 1 < layers {
                join(cell, cell + width, mean(own, at(layer + 1, place)) * aspect);
            }
            if layer == 0 {
                join(cell, cells, 2.0 * own * aspect);
            }
            if layer + 1 == layers {
                join(cell, cells + 1, 2.0 * own * aspect);
            }
        }
    }
    for cell in 0..cells {
        let row: Vec<(usize, f64)> = std::mem::take(&mut rows[cell]).into_iter().collect();
        let pivot: f64 = row.iter().map(|(_, weight)| weight).sum();
        for (i, &(a, to_a)) in row.iter().enumerate() {
            rows[a].remove(&cell);
            for &(b, to_b) in &row[i + 1..] {
                let weight = to_a * (to_b / pivot);
                *rows[a].entry(b).or_default() += weight;
                *rows[b].entry(a).or_default() += weight;
            }
        }
    }
    rows[cells].get(&(cells + 1)).copied().unwrap_or(0.0)
}

/// Rounding of the reference, some thousand operations one after the other.
const REFERENCE: f64 = 1e-12;
/// The width that is requested.
const WIDTH: f64 = 1e-10;

fn field(columns: usize, rows: usize, value: impl Fn(usize, usize) -> f64) -> Field {
    let values = (0..columns * rows).map(|cell| value(cell % columns, cell / columns)).collect();
    Field::new([columns, rows], [columns as f64, rows as f64], values).unwrap()
}

/// A number in [0, 1) for a cell (SplitMix64).
fn uniform(seed: u64) -> f64 {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Bounds hold for the reference, are as narrow as `width`, and the continuum is not below the network.
fn assert_bounds(k: &Field, axis: FlowAxis, boundary: Boundary, width: f64) -> SheetFlow {
    let exact = eliminated(k, axis, boundary);
    let flow = conductance(k, axis, boundary).unwrap();
    let FlowBounds { lower, upper } = flow.network;
    assert!(
        lower <= exact * (1.0 + REFERENCE) && exact * (1.0 - REFERENCE) <= upper,
        "{lower} {exact} {upper}"
    );
    assert!(flow.network.relative_width() <= width, "{} of {exact}", flow.network.relative_width());
    let continuum = flow.continuum.unwrap();
    assert!(continuum.lower >= lower * (1.0 - REFERENCE) && continuum.upper >= continuum.lower);
    flow
}

/// As much flows into every cell as out of it.
fn assert_conserved(k: &Field, flow: &SheetFlow, axis: FlowAxis) {
    let [x, y] = &flow.flux;
    let (q, layers, side) = match axis {
        FlowAxis::X => (x, k.columns(), k.dy()),
        FlowAxis::Y => (y, k.rows(), k.dx()),
    };
    // Means over faces: the flow through every layer is half of that through its two sides, which are all the
    // same.
    let total = flow.network.middle();
    for layer in 0..layers {
        let through: f64 = match axis {
            FlowAxis::X => (0..k.rows()).map(|row| q.at(layer, row)).sum(),
            FlowAxis::Y => q.row(layer).iter().sum(),
        };
        approx::assert_relative_eq!(through * side, total, max_relative = 1e-9);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn bounds_hold_at_any_contrast(
        columns in 1_usize..14, rows in 1_usize..14, seed in 0_u64..1000, decades in 0.0..20.0_f64,
        open in 0.5..1.0_f64,
        oblong in 0.1..10.0_f64, boundary in proptest::sample::select(Boundary::ALL), is_x: bool,
    ) {
        let axis = if is_x { FlowAxis::X } else { FlowAxis::Y };
        let values = (0..columns * rows).map(|cell| {
            let at = seed * 1000 + cell as u64;
            if uniform(at) < open { 10_f64.powf(-decades * uniform(at + 500_000_000)) } else { 0.0 }
        });
        let size = Size { x: columns as f64 * oblong, y: rows as f64 };
        let k = Field::new([columns, rows], size, values.collect()).unwrap();
        let flow = assert_bounds(&k, axis, boundary, WIDTH);
        if flow.network.lower > 0.0 {
            assert_conserved(&k, &flow, axis);
        } else {
            prop_assert_eq!((flow.network, flow.continuum), (FlowBounds::ZERO, Some(FlowBounds::ZERO)));
        }
    }
}

#[test]
fn a_hierarchy_of_many_levels_agrees_with_elimination() {
    for (decades, boundary) in
        [(2.0, Boundary::Free), (9.0, Boundary::Periodic), (18.0, Boundary::PeriodicAlongX)]
    {
        // Neighbours are independent, which is the hardest case for a hierarchy.
        let k = field(44, 37, |x, y| 10_f64.powf(-decades * uniform((y * 44 + x) as u64)));
        let flow = assert_bounds(&k, FlowAxis::Y, boundary, WIDTH);
        assert_conserved(&k, &flow, FlowAxis::Y);
    }
}

#[test]
fn rows_in_series_and_strips_side_by_side_are_exact() {
    let of = |i: usize| 1.0 + (i * i % 7) as f64;
    for boundary in Boundary::ALL {
        let k = field(5, 8, |_, y| of(y));
        let series = conductance(&k, FlowAxis::Y, *boundary).unwrap();
        let exact = 5.0 / (0..8).map(|y| 1.0 / of(y)).sum::<f64>();
        let parallel = conductance(&k, FlowAxis::X, *boundary).unwrap();
        let sum = (0..8).map(of).sum::<f64>() / 5.0;
        for (flow, exact) in [(series, exact), (parallel, sum)] {
            for bounds in [flow.network, flow.continuum.unwrap()] {
                assert!(bounds.contains(exact) && bounds.relative_width() < WIDTH, "{bounds:?} {exact}");
            }
        }
    }
}

#[test]
fn a_quarter_of_a_ring_has_its_logarithm() {
    // A quarter of a ring with the radii a and b has the conductance ln(b/a)/(pi/2) from one end to the
    // other. One end is on the last column. The other one is on a row of large conductivity, which leads to
    // the first column.
    const INNER: f64 = 0.25;
    const OUTER: f64 = 0.75;
    const COLLECTOR: f64 = 1e6;
    // The circles are staircases of cells: an error of first order in the size of a cell, 0.04 on the finest
    // grid.
    const STAIRCASE: f64 = 0.05;
    let exact = (OUTER / INNER).ln() / std::f64::consts::FRAC_PI_2;
    let errors = [16, 32, 64].map(|cells: usize| {
        let ring = field(cells, cells + 1, |x, y| {
            let across = 1.0 - (x as f64 + 0.5) / cells as f64;
            if y == 0 {
                return if across > INNER { COLLECTOR } else { 0.0 };
            }
            let radius = across.hypot((y as f64 - 0.5) / cells as f64);
            f64::from((INNER..OUTER).contains(&radius))
        });
        let flow = conductance(&ring, FlowAxis::X, Boundary::Free).unwrap();
        (flow.continuum.unwrap().middle() / exact - 1.0).abs()
    });
    assert!(errors[2] < errors[1] && errors[1] < errors[0] && errors[2] < STAIRCASE, "{errors:?}");
}

#[test]
fn a_checkerboard_lies_between_the_bounds_of_the_continuum() {
    // Squares of 1 and 100, four by four, with insulating sides: 10 exactly (Keller, J. Math. Phys. 5, 548
    // (1964), by the duality of the map with itself turned). The bounds converge slowly, because the flux at
    // corners is singular. Duality holds for both bounds too: a stream function of the map is a potential of
    // the turned one, so that their product is 100 up to what the last steps of the solvers leave.
    const LEFT: f64 = 2e-4;
    let board = |cells: usize| {
        field(
            4 * cells,
            4 * cells,
            |x, y| if (x / cells + y / cells).is_multiple_of(2) { 1.0 } else { 100.0 },
        )
    };
    let mut last = f64::INFINITY;
    for cells in [4, 8, 16] {
        let flow = conductance(&board(cells), FlowAxis::X, Boundary::Free).unwrap();
        let bounds = flow.continuum.unwrap();
        assert!(bounds.contains(10.0) && flow.network.upper < 10.0, "{bounds:?}");
        approx::assert_relative_eq!(bounds.lower * bounds.upper, 100.0, max_relative = LEFT);
        assert!(bounds.upper - bounds.lower < last);
        last = bounds.upper - bounds.lower;
    }
}

#[test]
fn another_program_has_a_flow_between_the_bounds() {
    const REYNOLDSFLOW: f64 = 0.049_061_204_523_33;
    let (numbers, _) = include_bytes!("../../tests/data/gap64.f64").as_chunks::<8>();
    let gap = Field::new(64, 1.0, numbers.iter().map(|&n| f64::from_le_bytes(n)).collect()).unwrap();
    let leak = leakage(&gap, FlowAxis::Y, Boundary::PeriodicAlongX).unwrap();
    assert!(
        leak.network.contains(REYNOLDSFLOW) && leak.network.relative_width() < WIDTH,
        "{:?}",
        leak.network
    );
    let mut cubes = gap.clone();
    cubes.values_mut().iter_mut().for_each(|g| *g = g.powi(3));
    assert_bounds(&cubes, FlowAxis::Y, Boundary::PeriodicAlongX, WIDTH);
}

#[test]
fn gaps_over_six_decades_and_one_closed_row() {
    let gap = field(40, 40, |x, y| 10_f64.powf(-6.0 * uniform((x + 40 * y) as u64)));
    let leak = leakage(&gap, FlowAxis::X, Boundary::PeriodicAlongY).unwrap();
    assert!(
        leak.network.lower > 0.0 && leak.network.relative_width() < WIDTH,
        "{:?} {}",
        leak.network,
        leak.network.relative_width()
    );
    // Wide pools behind one row of narrow cells: potentials in the pools differ by less than their rounding.
    let pools = field(40, 40, |_, y| if y == 20 { 1e-6 } else { 1.0 });
    let leak = leakage(&pools, FlowAxis::Y, Boundary::Free).unwrap();
    let exact = 40.0 / (39.0 + 1e18);
    assert!(leak.network.contains(exact) && leak.network.relative_width() < WIDTH, "{:?}", leak.network);
    let closed = field(40, 40, |_, y| if y == 20 { 0.0 } else { 1.0 });
    let leak = leakage(&closed, FlowAxis::Y, Boundary::Free).unwrap();
    assert_eq!((leak.network, leak.continuum), (FlowBounds::ZERO, Some(FlowBounds::ZERO)));
    // Half of the cells have the potential of each edge, and those in contact none.
    assert_eq!(
        leak.flow.potential.values().iter().filter(|p| p.to_bits() == 1.0_f64.to_bits()).count(),
        20 * 40
    );
    assert_eq!(leak.flow.reached.iter().filter(|&&reached| reached).count(), 39 * 40);
}

#[test]
fn maps_of_one_cell_one_row_and_one_column() {
    for boundary in Boundary::ALL {
        for axis in [FlowAxis::X, FlowAxis::Y] {
            for (columns, rows) in [(1, 1), (1, 7), (7, 1), (2, 7), (7, 2), (2, 2)] {
                let k = field(columns, rows, |x, y| 1.0 + (x + 2 * y) as f64);
                assert_bounds(&k, axis, *boundary, WIDTH);
            }
        }
    }
    let one = Field::new(1, [2.0, 1.0], vec![3.0]).unwrap();
    let flow = conductance(&one, FlowAxis::X, Boundary::Periodic).unwrap();
    assert!(flow.network.contains(1.5) && flow.continuum.unwrap().contains(1.5));
}

#[test]
fn cells_that_touch_at_corners_carry_nothing_between_them() {
    let k = field(4, 4, |x, y| f64::from((x / 2 + y / 2) % 2 == 0));
    let flow = conductance(&k, FlowAxis::X, Boundary::Free).unwrap();
    assert_eq!((flow.network, flow.continuum), (FlowBounds::ZERO, Some(FlowBounds::ZERO)));
    // Two channels that touch at corners: each of them carries its own flow.
    let k = field(6, 4, |x, y| f64::from(y == 0 || y == 3 || (x == 2 && y == 1) || (x == 3 && y == 2)));
    let flow = assert_bounds(&k, FlowAxis::X, Boundary::Free, WIDTH);
    approx::assert_relative_eq!(flow.potential.at(2, 1), flow.potential.at(2, 0), max_relative = 1e-6);
}

#[test]
fn hostile_values_are_refused_by_name_or_answered() {
    let row = |values: &[f64]| Field::new([values.len(), 1], 1.0, values.to_vec()).unwrap();
    let text = |gap: &[f64]| leakage(&row(gap), FlowAxis::X, Boundary::Free).unwrap_err().to_string();
    assert_eq!(
        text(&[1.0, f64::INFINITY]),
        "gap[0, 1] = inf: expected a finite gap: undefined points are to be filled or cropped"
    );
    assert!(text(&[f64::NAN, 1.0]).starts_with("gap[0, 0] = NaN"));
    assert!(text(&[1e200, 1e200]).contains("conductance"), "its cube overflows");
    let of = |k: &[f64]| conductance(&row(k), FlowAxis::X, Boundary::Free);
    assert!(of(&[1.0, -1.0]).unwrap_err().to_string().starts_with("conductivity[0, 1] = -1"));
    assert!(of(&[f64::NAN]).is_err() && of(&[f64::INFINITY]).is_err());
    assert!(of(&[f64::MAX, f64::MAX]).is_ok() || of(&[f64::MAX]).is_err());
    // Contact may be negative by rounding, and nothing flows where all is closed.
    let closed = leakage(&row(&[-1e-20, 0.0, -3.0]), FlowAxis::X, Boundary::Free).unwrap();
    assert_eq!((closed.network, closed.mean_gap, closed.flow_factor), (FlowBounds::ZERO, 0.0, None));
    // The smallest numbers are in units of the largest of them; beside a large one they are neglected above.
    let tiny = of(&[5e-324, 5e-324]).unwrap();
    assert!(tiny.network.contains(2.5e-324) && tiny.network.upper > 0.0);
    let beside = of(&[1.0, 1e-310, 1.0]).unwrap();
    assert!(beside.network.lower <= 0.0 && beside.network.upper > 1e-310 && beside.network.upper < 1e-190);
    let options = FlowOptions { tolerance: f64::NAN, ..FlowOptions::default() };
    assert!(conductance_until(&row(&[1.0]), FlowAxis::X, Boundary::Free, options, &never).is_err());
}

#[test]
fn a_smooth_gap_has_a_flow_factor_of_one_and_a_flow_in_si() {
    let gap = Field::new([8, 4], [2e-3, 1e-3], vec![1e-6; 32]).unwrap();
    let leak = leakage(&gap, FlowAxis::X, Boundary::Free).unwrap();
    assert!(leak.flow_factor.unwrap().contains(1.0));
    // 1 bar, water: (1e-6)^3/(12 1e-3) (1e-3/2e-3) 1e5.
    let flow = leak.flow_rate(1e5, 1e-3).unwrap();
    approx::assert_relative_eq!(flow.network.middle(), 1e-18 * 0.5 * 1e5 / 12e-3, max_relative = WIDTH);
    assert!(leak.flow_rate(-1.0, 1.0).is_err() && leak.flow_rate(1.0, 0.0).is_err());
    // The flux per width for a pressure drop of 1 is g^3/L everywhere.
    leak.flow.flux[0]
        .values()
        .iter()
        .for_each(|&q| approx::assert_relative_eq!(q, 1e-18 / 2e-3, max_relative = 1e-9));
}

#[test]
fn a_map_beyond_the_memory_is_refused_and_a_stop_is_heard() {
    assert!(flow_memory(40_000, FlowOptions::default()) > 5e11);
    let refused = check_memory(contact_model::Cells::from(40_000), BYTES_PER_CELL);
    assert!(matches!(refused, Err(Error::OutOfMemory { bytes, .. }) if bytes > 4e11), "{refused:?}");
    let gap = field(30, 30, |x, y| 1.0 + uniform((x + 30 * y) as u64));
    let stopped = leakage_until(&gap, FlowAxis::X, Boundary::Free, FlowOptions::default(), &|| true);
    assert!(matches!(stopped, Err(Error::Stopped { .. })));
}

#[cfg(feature = "rayon")]
#[test]
fn no_bit_depends_on_the_number_of_threads() {
    let gap = field(400, 400, |x, y| 10_f64.powf(-3.0 * uniform((x / 3 + 400 * (y / 3)) as u64)));
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| leakage(&gap, FlowAxis::Y, Boundary::Periodic).unwrap())
    };
    assert_eq!(with(1), with(3));
}

/// Behind a constriction that conducts 10^-24 of what is before it, potentials differ from 1 by no more than the
/// rounding of two numbers. The exact conductance was computed with fractions.
#[test]
fn bounds_hold_where_potentials_are_lost_in_rounding() {
    let sides = [2.0 * 13.118_726_623_021_562, 2.0 * 0.012_750_527_070_610_607];
    let values = vec![0.469_233_863_394_444_2, 0.331_370_398_340_935_3, 7.352_737_073_843_674e-9, 0.0];
    let found = leakage(&Field::new([2, 2], sides, values).unwrap(), FlowAxis::Y, Boundary::Free).unwrap();
    assert!(found.network.contains(4.089_880_826_007_546_7e-22), "{found:?}");
    assert!(found.network.relative_width() < 1e-10);
}

/// Bounds are in their order whatever the gaps are.
#[test]
fn bounds_of_wild_maps_do_not_cross() {
    let mut state = 1_u64;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    for _ in 0..1500 {
        let cells = [1 + (4.0 * random()) as usize, 1 + (4.0 * random()) as usize];
        let decades = 20.0 * random();
        let sides = [cells[0] as f64, cells[1] as f64 * 10_f64.powf(6.0 * random() - 3.0)];
        let gap = |open: f64, power: f64| if open < 0.2 { 0.0 } else { 10_f64.powf(-decades * power) };
        let values = (0..cells[0] * cells[1]).map(|_| gap(random(), random())).collect();
        let gap = Field::new(cells, sides, values).unwrap();
        let boundary = [Boundary::Free, Boundary::Periodic][usize::from(random() < 0.5)];
        let axis = [FlowAxis::X, FlowAxis::Y][usize::from(random() < 0.5)];
        let Ok(found) = leakage(&gap, axis, boundary) else { continue };
        let continuum = found.continuum.unwrap();
        assert!(found.network.lower <= found.network.upper, "{gap:?} {axis:?} {boundary:?} {found:?}");
        assert!(continuum.lower <= continuum.upper, "{gap:?} {axis:?} {boundary:?} {found:?}");
        // The harmonic network underestimates the continuum.
        let slack = 1.0 + 1e-9;
        assert!(found.network.lower <= continuum.upper * slack, "{gap:?} {axis:?} {boundary:?} {found:?}");
        let inside = found.flow.potential.values().iter().all(|p| (0.0..=1.0).contains(p));
        assert!(inside, "{gap:?} {axis:?} {boundary:?} {found:?}");
    }
}
