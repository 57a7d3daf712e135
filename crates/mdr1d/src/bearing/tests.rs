use super::*;
use approx::assert_relative_eq;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Rounding of compensated sums of positive terms, and of partial sums of 64 in each lane.
const ROUNDING: f64 = 1e-14;

/// The reference implementation: sums over all elements, force inverted by bisection.
struct BearingReference {
    depths: Vec<f64>,
    element: f64,
}

impl BearingReference {
    fn new(line: &Line) -> Self {
        let depths = line.heights().iter().map(|h| line.highest() - h).collect();
        Self { depths, element: line.element() }
    }

    fn sum(&self, d: f64) -> f64 {
        let mut sum = Sum::from(0.0);
        self.depths.iter().filter(|&&z| z < d).for_each(|&z| sum.add(d - z));
        sum.value()
    }

    fn force(&self, d: f64, contact_modulus: f64) -> f64 {
        contact_modulus * self.element * self.sum(d)
    }

    fn elements(&self, d: f64) -> usize {
        self.depths.iter().filter(|&&z| z < d).count()
    }

    fn approach(&self, force: f64, contact_modulus: f64) -> f64 {
        let sum = force / (contact_modulus * self.element);
        let (mut low, mut high) = (0.0, sum.max(f64::MIN_POSITIVE));
        for _ in 0..2000 {
            let middle = low + (high - low) / 2.0;
            if middle <= low || middle >= high {
                break;
            }
            if self.sum(middle) < sum { low = middle } else { high = middle }
        }
        high
    }
}

fn line(heights: Vec<f64>) -> Line {
    let length = 0.25 * heights.len() as f64;
    Line::new(length, heights).unwrap()
}

/// A crooked line with more than one bin: waves plus a multiplicative congruence.
fn long_line(elements: usize) -> Line {
    let heights = (0..elements).map(|i| {
        let noise = (i.wrapping_mul(2_654_435_761) % 1_000_003) as f64 / 1_000_003.0;
        (i as f64 * 7e-4).sin() + 0.3 * noise
    });
    line(heights.collect())
}

#[test]
fn three_springs_by_hand() {
    let line = Line::new(3.0, vec![-1.0, 5.0, 2.0]).unwrap(); // z = 6, 0, 3
    let mut bearing = Bearing::new(&line);
    for (d, force, elements) in [(0.0, 0.0, 0), (3.0, 3.0, 1), (4.0, 5.0, 2), (6.0, 9.0, 2), (7.0, 12.0, 3)] {
        for load in [NormalLoad::Approach(d), NormalLoad::Force(force)] {
            let s = bearing.press(load, 1.0).unwrap();
            assert_relative_eq!(s.force, force);
            assert_relative_eq!(s.approach, d);
            assert_eq!(s.elements, elements, "{load:?}");
            assert_relative_eq!(s.stiffness, elements as f64);
        }
    }
}

#[test]
fn flat_lines_and_ties() {
    let mut flat = Bearing::new(&Line::new(2.0, vec![3.0; 5000]).unwrap());
    let s = flat.press(NormalLoad::Force(0.5), 10.0).unwrap();
    assert_relative_eq!(s.approach, 0.5 / 20.0, max_relative = ROUNDING);
    assert_relative_eq!(s.stiffness, 20.0, max_relative = ROUNDING);
    assert_eq!(flat.press(NormalLoad::Force(0.0), 10.0).unwrap().elements, 0);
    // One pit, a million times deeper: everything else crowds into one bin.
    let mut heights = vec![1.0; 5000];
    heights[17] = -1e6;
    heights[18] = 0.5;
    let line = Line::new(1.0, heights).unwrap();
    let (mut bearing, reference) = (Bearing::new(&line), BearingReference::new(&line));
    for d in [0.1, 0.5, 0.6, 1e5, 1e6 + 1.0, 1e6 + 2.0] {
        let s = bearing.press(NormalLoad::Approach(d), 1.0).unwrap();
        assert_relative_eq!(s.force, reference.force(d, 1.0), max_relative = ROUNDING);
        assert_eq!(s.elements, reference.elements(d));
        let back = bearing.press(NormalLoad::Force(s.force), 1.0).unwrap();
        assert_relative_eq!(back.approach, d, max_relative = ROUNDING);
    }
}

#[test]
fn a_long_line_equals_the_sums() {
    let line = long_line(40_000);
    let (mut bearing, reference) = (Bearing::new(&line), BearingReference::new(&line));
    assert!(bearing.bins.len() > 50);
    let height = line.highest() - range(line.heights()).0;
    for i in 0..60 {
        let d = height * 1.3 * 10_f64.powf(-f64::from(i) / 10.0);
        let s = bearing.press(NormalLoad::Approach(d), 3.0).unwrap();
        assert_relative_eq!(s.force, reference.force(d, 3.0), max_relative = ROUNDING);
        assert_eq!(s.elements, reference.elements(d));
        let by_force = bearing.press(NormalLoad::Force(s.force), 3.0).unwrap();
        assert_relative_eq!(by_force.approach, reference.approach(s.force, 3.0), max_relative = ROUNDING);
        assert_eq!(by_force.elements, s.elements);
    }
}

#[test]
fn bins_change_nothing() {
    // All in one bin is the full sort: its knots are the reference.
    let line = long_line(5_000);
    let mut binned = Bearing::new(&line);
    let mut depths: Vec<f64> = binned.depths.clone();
    depths.sort_unstable_by(f64::total_cmp);
    let mut full = Bearing { element: line.element(), bins: bins(&depths, &[depths.len()]), depths };
    for force in [1e-9, 1e-6, 1e-3, 0.1, 1.0, 30.0, 1e3] {
        let a = binned.press(NormalLoad::Force(force), 1.0).unwrap();
        let b = full.press(NormalLoad::Force(force), 1.0).unwrap();
        assert_relative_eq!(a.approach, b.approach, max_relative = ROUNDING);
        assert_eq!(a.elements, b.elements);
    }
}

/// A ramp that falls by 1/8 from one element to the next: heights and sums of them are exact.
fn ramp(elements: usize) -> Line {
    line((0..elements).map(|i| 700.0 - i as f64 / 8.0).collect())
}

#[test]
fn bins_share_a_ramp_evenly() {
    // Work, not time: a load sorts one bin, and none holds more than its share whatever the offset, the
    // height and the remainder.
    for (bins, rest) in [(8, 3), (5, 300), (1, 7)] {
        let elements = bins * ELEMENTS_PER_BIN + rest;
        let bearing = Bearing::new(&ramp(elements));
        assert_eq!(bearing.elements(), elements);
        assert_eq!(bearing.bins.len(), bins);
        let largest = bearing.bins.iter().map(|bin| bin.end - bin.start).max().unwrap();
        assert!(largest <= elements / bins + 2, "{largest} of {elements} elements in one of {bins} bins");
    }
}

#[test]
fn a_kink_between_two_bins_is_one_state_by_force_and_by_approach() {
    // With z_i = i/8 and dx = 1/4, S(z_i) = i (i + 1)/16: element i touches at d = z_i without force,
    // wherever its bin begins.
    let mut bearing = Bearing::new(&ramp(4 * ELEMENTS_PER_BIN));
    let firsts: Vec<usize> = bearing.bins.iter().map(|bin| bin.start).collect();
    assert_eq!(firsts.len(), 4);
    for &i in &firsts {
        let (d, force) = (i as f64 / 8.0, (i * (i + 1)) as f64 / 64.0);
        let expected = Support { force, approach: d, stiffness: 0.25 * i as f64, elements: i };
        assert_eq!(bearing.press(NormalLoad::Approach(d), 1.0).unwrap(), expected);
        assert_eq!(bearing.press(NormalLoad::Force(force), 1.0).unwrap(), expected);
    }
}

#[test]
fn earlier_loads_change_no_bit() {
    let line = long_line(20_000);
    let mut used = Bearing::new(&line);
    let loads: Vec<NormalLoad> =
        (0..30).map(|i| NormalLoad::Force(1e4 * 10_f64.powf(-f64::from(i) / 4.0))).collect();
    let forward: Vec<Support> = loads.iter().map(|&l| used.press(l, 1.0).unwrap()).collect();
    for (&load, first) in loads.iter().zip(&forward).rev() {
        assert_eq!(&used.press(load, 1.0).unwrap(), first);
        assert_eq!(&Bearing::new(&line).press(load, 1.0).unwrap(), first);
    }
}

#[test]
fn a_rebuilt_bearing_is_a_new_one() {
    let mut used = Bearing::new(&long_line(20_000));
    for elements in [3_000, 1, 30_000, 20_000] {
        let line = long_line(elements);
        used.press(NormalLoad::Force(1.0), 1.0).unwrap();
        used.rebuild(&line);
        for force in [1e-6, 1e-2, 1e2, 1e5] {
            let load = NormalLoad::Force(force);
            assert_eq!(used.press(load, 1.0).unwrap(), Bearing::new(&line).press(load, 1.0).unwrap());
        }
    }
}

#[test]
fn extreme_units() {
    let base = long_line(3000);
    let reference = Bearing::new(&base).press(NormalLoad::Approach(0.3), 1.0).unwrap();
    for (contact_modulus, horizontal, vertical) in
        [(1e150, 1e-150, 1e-150), (1e-150, 1e150, 1e150), (1e-150, 1e150, 1e-150), (1e150, 1e150, 1e-170)]
    {
        let heights = base.heights().iter().map(|h| h * vertical).collect();
        let line = Line::new(base.length() * horizontal, heights).unwrap();
        let mut bearing = Bearing::new(&line);
        let s = bearing.press(NormalLoad::Approach(0.3 * vertical), contact_modulus).unwrap();
        // Scaling by a power of ten rounds every height: a few units in the last place of the height, over d.
        let expected = Nondimensionalisation::new(contact_modulus, horizontal, vertical)
            .unwrap()
            .force(reference.force)
            .unwrap();
        assert_relative_eq!(s.force, expected, max_relative = 1e-13);
        assert_eq!(s.elements, reference.elements);
        let back = bearing.press(NormalLoad::Force(s.force), contact_modulus).unwrap();
        assert_relative_eq!(back.approach, s.approach, max_relative = ROUNDING);
    }
    let mut bearing = Bearing::new(&line(vec![1e200, 0.0]));
    assert!(matches!(bearing.press(NormalLoad::Approach(1e200), 1e150), Err(Error::Domain { .. })));
    assert!(matches!(bearing.press(NormalLoad::Force(1e300), 1e-300), Err(Error::Domain { .. })));
    assert!(matches!(bearing.press(NormalLoad::Force(1e-300), 1e300), Err(Error::Domain { .. })));
    assert!(bearing.press(NormalLoad::Force(-1.0), 1.0).is_err());
    assert!(bearing.press(NormalLoad::Approach(f64::NAN), 1.0).is_err());
    assert!(bearing.press(NormalLoad::Force(1.0), 0.0).is_err());
}

/// Heights on a grid of 1/8, so that ties, kinks and offsets by integers are exact.
fn grid_heights() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((-64_i32..64).prop_map(|i| f64::from(i) / 8.0), 1..200)
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(64) })]

    #[test]
    fn equals_the_sums(heights in prop::collection::vec(-1.0_f64..1.0, 1..300), d in 1e-6_f64..3.0) {
        let line = line(heights);
        let (mut bearing, reference) = (Bearing::new(&line), BearingReference::new(&line));
        let s = bearing.press(NormalLoad::Approach(d), 2.0).unwrap();
        assert_relative_eq!(s.force, reference.force(d, 2.0), max_relative = ROUNDING);
        prop_assert_eq!(s.elements, reference.elements(d));
        let back = bearing.press(NormalLoad::Force(s.force), 2.0).unwrap();
        assert_relative_eq!(back.approach, reference.approach(s.force, 2.0), max_relative = ROUNDING);
        assert_relative_eq!(back.approach, d, max_relative = ROUNDING);
    }

    #[test]
    fn kinks_belong_to_the_set_that_carries(heights in grid_heights(), i in 0_usize..200) {
        // At d = z_i exactly, by approach and by force alike, the elements at z_i are not in contact.
        let line = line(heights);
        let reference = BearingReference::new(&line);
        let d = reference.depths[i % reference.depths.len()];
        let mut bearing = Bearing::new(&line);
        let by_approach = bearing.press(NormalLoad::Approach(d), 1.0).unwrap();
        let by_force = bearing.press(NormalLoad::Force(reference.force(d, 1.0)), 1.0).unwrap();
        prop_assert_eq!(by_approach.elements, reference.elements(d));
        prop_assert_eq!(by_force, by_approach);
    }

    #[test]
    fn offset_and_order_change_no_bit(heights in grid_heights(), offset in -1000_i32..1000, force in 1e-3_f64..1e3) {
        let mut moved: Vec<f64> = heights.iter().map(|h| h + f64::from(offset)).collect();
        moved.reverse();
        let middle = moved.len() / 2;
        moved.rotate_left(middle);
        let a = Bearing::new(&line(heights)).press(NormalLoad::Force(force), 1.0).unwrap();
        let b = Bearing::new(&line(moved)).press(NormalLoad::Force(force), 1.0).unwrap();
        prop_assert_eq!(a, b);
    }

    #[test]
    fn a_line_twice_carries_twice(heights in grid_heights(), d in 0.0_f64..20.0) {
        let twice: Vec<f64> = heights.iter().chain(&heights).copied().collect();
        let a = Bearing::new(&line(heights)).press(NormalLoad::Approach(d), 1.0).unwrap();
        let b = Bearing::new(&line(twice)).press(NormalLoad::Approach(d), 1.0).unwrap();
        assert_relative_eq!(b.force, 2.0 * a.force, max_relative = ROUNDING);
        prop_assert_eq!(b.elements, 2 * a.elements);
    }

    #[test]
    fn convex_and_its_slope_is_k(heights in prop::collection::vec(-1.0_f64..1.0, 1..300), d in 0.01_f64..3.0) {
        // F(d +- e) lie on or above the tangent, and on it where no element touches in between.
        let mut bearing = Bearing::new(&line(heights));
        let mut at = |d| bearing.press(NormalLoad::Approach(d), 1.0).unwrap();
        let (below, here, above) = (at(d * 0.99), at(d), at(d * 1.01));
        prop_assert!(below.stiffness <= here.stiffness && here.stiffness <= above.stiffness);
        let slack = ROUNDING * above.force;
        let upper = (above.force - here.force) / (0.01 * d);
        let lower = (here.force - below.force) / (0.01 * d);
        let slack = slack / (0.01 * d);
        prop_assert!(lower <= here.stiffness + slack && here.stiffness <= upper + slack);
        prop_assert!(below.stiffness <= lower + slack && upper <= above.stiffness + slack);
    }
}
