//! Percolation against a search by brute force, against duality, and against the threshold of the square
//! lattice.

use super::*;
use contact_model::Size;
use proptest::prelude::*;

/// A map of integers, so that gaps are equal often.
fn maps() -> impl Strategy<Value = (Field, FlowAxis, Boundary)> {
    let axes = prop_oneof![Just(FlowAxis::X), Just(FlowAxis::Y)];
    let boundaries = proptest::sample::select(Boundary::ALL);
    (1_usize..8, 1_usize..8, axes, boundaries).prop_flat_map(|(columns, rows, axis, boundary)| {
        let values = proptest::collection::vec(0..6, columns * rows);
        values.prop_map(move |values| {
            let values = values.into_iter().map(f64::from).collect();
            (Field::new([columns, rows], 1.0, values).unwrap(), axis, boundary)
        })
    })
}

/// Cells of the last layer that a flood from the first one reaches, with coordinates along the axis and
/// across it that are written out here anew.
fn flood(gap: &Field, axis: FlowAxis, boundary: Boundary, holds: &dyn Fn(f64) -> bool) -> bool {
    let (columns, rows) = (gap.columns().cast_signed(), gap.rows().cast_signed());
    let [repeats_x, repeats_y] = boundary.repeats();
    let is_x = axis == FlowAxis::X;
    let at = |x: isize, y: isize| {
        let x = if repeats_x && !is_x { x.rem_euclid(columns) } else { x };
        let y = if repeats_y && is_x { y.rem_euclid(rows) } else { y };
        let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
        (inside && holds(gap.at(x as usize, y as usize))).then_some((x, y))
    };
    let starts = if is_x {
        (0..rows).map(|y| (0, y)).collect()
    } else {
        (0..columns).map(|x| (x, 0)).collect::<Vec<_>>()
    };
    let mut waiting: Vec<(isize, isize)> = starts.into_iter().filter_map(|(x, y)| at(x, y)).collect();
    let mut seen: std::collections::BTreeSet<(isize, isize)> = waiting.iter().copied().collect();
    while let Some((x, y)) = waiting.pop() {
        if (is_x && x == columns - 1) || (!is_x && y == rows - 1) {
            return true;
        }
        for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            waiting.extend(at(x + dx, y + dy).filter(|&cell| seen.insert(cell)));
        }
    }
    false
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn brute_force_finds_the_same_and_exactly_one_of_both_closes(
        (gap, axis, boundary) in maps(), g_min in -1.0..6.0,
    ) {
        let found = percolation(&gap, g_min, axis, boundary).unwrap();
        prop_assert_eq!(found.spans, flood(&gap, axis, boundary, &|g| g > g_min));
        prop_assert_eq!(found.contact_spans, flood(&gap, axis, boundary, &|g| g <= g_min));
        prop_assert_eq!(found.contact_blocks, !found.spans);
        let Constriction { column, row, gap: narrowest } = found.constriction;
        prop_assert!(gap.at(column, row).to_bits() == narrowest.to_bits());
        // The largest gap with this property, and the flow has to pass this cell or one as narrow.
        prop_assert!(flood(&gap, axis, boundary, &|g| g >= narrowest));
        prop_assert!(!flood(&gap, axis, boundary, &|g| g > narrowest));
    }

    #[test]
    fn without_the_constriction_and_cells_as_narrow_there_is_no_way((gap, axis, boundary) in maps()) {
        // Gaps that are all different: one cell alone closes the widest way.
        let mut distinct = gap.clone();
        for (i, g) in distinct.values_mut().iter_mut().enumerate() {
            *g += 1e-3 * i as f64;
        }
        let Constriction { column, row, gap: narrowest } =
            percolation(&distinct, 0.0, axis, boundary).unwrap().constriction;
        let closed = |g: f64| g >= narrowest && g.to_bits() != distinct.at(column, row).to_bits();
        prop_assert!(!flood(&distinct, axis, boundary, &closed));
    }
}

/// A number in [0, 1) for a cell (SplitMix64).
fn uniform(seed: u64) -> f64 {
    let mut z = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn critical_gaps_of_independent_cells_have_the_threshold_of_site_percolation() {
    // The critical constriction of uniform gaps is where the share 1 - g of open cells is the threshold,
    // 0.592746 (Jacobsen, J. Phys. A 48, 454003 (2015)). On L cells a side it scatters as L^(-3/4): here by
    // about 0.008 for one map. The mean of 40 maps lies within 0.005 of it in practice, which is four of its
    // standard deviations.
    const THRESHOLD: f64 = 0.592_746;
    const MARGIN: f64 = 0.005;
    let cells = 256;
    let open = (0..40_u64).map(|map| {
        let values = (0..cells * cells).map(|cell| uniform((map << 32) + cell as u64 + 1)).collect();
        let gap = Field::new(cells, 1.0, values).unwrap();
        1.0 - percolation(&gap, 0.5, FlowAxis::Y, Boundary::Free).unwrap().constriction.gap
    });
    let mean = open.sum::<f64>() / 40.0;
    assert!((mean - THRESHOLD).abs() < MARGIN, "{mean}");
}

#[test]
fn infinite_gaps_are_open_and_numbers_are_needed() {
    let gap = |values: &[f64]| Field::new([values.len(), 1], Size::from(1.0), values.to_vec()).unwrap();
    let found =
        percolation(&gap(&[f64::INFINITY, 2.0, f64::INFINITY]), 0.0, FlowAxis::X, Boundary::Free).unwrap();
    assert_eq!(found.constriction, Constriction { column: 1, row: 0, gap: 2.0 });
    let all = percolation(&gap(&[f64::INFINITY; 3]), 0.0, FlowAxis::X, Boundary::Free).unwrap();
    assert!(all.spans && all.constriction.gap.is_infinite());
    let error = percolation(&gap(&[1.0, f64::NAN]), 0.0, FlowAxis::X, Boundary::Free).unwrap_err();
    assert_eq!(error.to_string(), "gap[0, 1] = NaN: expected a number; infinite at undefined points");
    assert!(percolation(&gap(&[1.0]), f64::NAN, FlowAxis::X, Boundary::Free).is_err());
}

#[test]
fn contact_at_corners_closes_a_ring() {
    // Contact in two rows, now in one and now in the other, winds round the map along x and touches at
    // corners alone.
    let gap =
        Field::new(4, 1.0, (0..16).map(|cell| f64::from(![0, 5, 2, 7].contains(&cell))).collect()).unwrap();
    for boundary in Boundary::ALL {
        let found = percolation(&gap, 0.0, FlowAxis::Y, *boundary).unwrap();
        assert!(found.contact_blocks && !found.spans && !found.contact_spans);
    }
    // Without the last cell the ring has a gap at the edge of the map.
    let mut open = gap.clone();
    open.values_mut()[7] = 1.0;
    let found = percolation(&open, 0.0, FlowAxis::Y, Boundary::PeriodicAlongX).unwrap();
    assert!(found.spans && !found.contact_blocks);
}
