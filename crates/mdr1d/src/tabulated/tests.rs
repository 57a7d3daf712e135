use super::*;
use crate::axisymmetric::Profile;
use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::Surface;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;

/// Sums of some products; the ramps' corners are good to this.
const ROUNDING: f64 = 1e-8;

fn power(exponent: f64) -> Profile {
    Profile::new(&Surface::PowerLaw { coefficient: 0.5, exponent, size: 1.0.into() }).unwrap().unwrap()
}

fn node(profile: Profile, approach: f64) -> Node {
    let contact = profile.at_approach(approach);
    Node { approach, force: contact.force, radius: contact.radius, slack: 1e-12 }
}

/// Logarithmic nodes over three decades up to 0.05.
fn sampled(profile: Profile, per_decade: i32) -> Arc<Tabulated> {
    let nodes: Vec<Node> = (-3 * per_decade..=0)
        .map(|i| node(profile, 0.05 * 10.0_f64.powf(f64::from(i) / f64::from(per_decade))))
        .collect();
    Arc::new(Tabulated::new(&nodes).unwrap())
}

#[test]
fn bodies_come_back_with_third_and_fourth_order() {
    for exponent in [0.6, 1.0, 2.0, 3.5] {
        let exact = power(exponent);
        let errors = |per_decade: i32| {
            let table = sampled(exact, per_decade);
            let mut worst = [0.0_f64; 2];
            for i in 1..400 {
                let d = 0.05 * f64::from(i) / 400.0;
                let there = exact.at_approach(d);
                worst[0] = worst[0].max((table.half_width(d) / there.radius - 1.0).abs());
                worst[1] = worst[1].max((table.force(d) / there.force - 1.0).abs());
            }
            worst
        };
        let (coarse, fine) = (errors(8), errors(32));
        if exponent.to_bits() == 1.0_f64.to_bits() {
            assert!(fine.iter().all(|error| *error < 1e-12), "a cone is a straight line");
            continue;
        }
        // Measured: 4^3 and 4^4, less where the worst place moves between the nodes.
        assert!(coarse[0] / fine[0] > 40.0 && coarse[1] / fine[1] > 150.0, "{exponent} {coarse:?} {fine:?}");
        assert!(
            coarse[1] < 2.0 * sampled(exact, 8).uncertainty(0.05),
            "the uncertainty is of the size of the error or above it"
        );
    }
}

#[test]
fn depth_inverts_half_width() {
    let table = sampled(power(1.7), 9);
    for i in 1..=50 {
        let d = 0.05 * f64::from(i) / 50.0;
        assert_relative_eq!(table.depth(-table.half_width(d)).unwrap(), d, max_relative = ROUNDING);
    }
    assert!(table.depth(2.0).is_none());
    assert_abs_diff_eq!(table.depth(0.0).unwrap(), 0.0);
    assert_abs_diff_eq!(table.half_width(-1.0), 0.0);
    assert_eq!(table.nodes(), 28);
}

#[test]
fn a_flat_face_is_a_flat_face() {
    let punch = Profile::new(&Surface::FlatCircle { radius: 0.2, size: 1.0.into() }).unwrap().unwrap();
    let table = sampled(punch, 4);
    assert_relative_eq!(table.half_width(1e-9), 0.2, max_relative = ROUNDING);
    assert_abs_diff_eq!(table.depth(0.1).unwrap(), 0.0);
    // All springs at gamma = 0.
    assert_relative_eq!(table.integral([0.0, 0.02], [3.0, 1.0, 0.0]), 0.6, max_relative = ROUNDING);
    assert_abs_diff_eq!(table.integral([0.001, 0.02], [3.0, 1.0, 0.0]), 0.0);
}

#[test]
fn contacts_that_shrink_are_refused() {
    let nodes = |k: [f64; 2], f: [f64; 2], slack: f64| {
        [0, 1].map(|i| Node { approach: (i + 1) as f64, force: f[i], radius: k[i], slack })
    };
    assert!(Tabulated::new(&nodes([0.1, 0.2], [0.1, 0.4], 1e-9)).is_ok());
    // k falls; the chord is steeper, flatter than both.
    for (k, f) in [([0.2, 0.19], [0.2, 0.59]), ([0.1, 0.2], [0.1, 0.51]), ([0.1, 0.2], [0.1, 0.29])] {
        let error = Tabulated::new(&nodes(k, f, 1e-9)).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("grows"));
        assert!(Tabulated::new(&nodes(k, f, 0.1)).is_ok(), "what the states themselves may be off");
    }
}

/// Convex forces: stiffnesses that never fall, chords anywhere between them.
fn convex() -> impl Strategy<Value = Vec<Node>> {
    proptest::collection::vec((0.1..2.0_f64, 0.0..0.3_f64, 0.0..=1.0_f64), 2..12).prop_map(|steps| {
        let mut nodes: Vec<Node> = Vec::new();
        let (mut d, mut force, mut radius) = (0.0, 0.0, 0.0);
        for (i, (width, rise, share)) in steps.into_iter().enumerate() {
            // The first chord must not be that of no contact at all.
            let share = if i == 0 { 0.1 + 0.9 * share } else { share };
            let rise = if i == 0 { rise + 0.01 } else { rise };
            d += width;
            force += 2.0 * width * (radius + share * rise);
            radius += rise;
            nodes.push(Node { approach: d, force, radius, slack: 1e-12 });
        }
        nodes
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, rng_seed: RngSeed::Fixed(17), ..ProptestConfig::default() })]

    /// Through every state, and never falling between them.
    #[test]
    fn any_convex_force_is_met(nodes in convex()) {
        let table = Tabulated::new(&nodes).unwrap();
        for node in &nodes {
            assert_relative_eq!(table.half_width(node.approach), node.radius, max_relative = ROUNDING);
            assert_relative_eq!(table.force(node.approach), node.force, max_relative = ROUNDING);
        }
        let deepest = nodes.last().unwrap().approach;
        let (mut x, mut f) = (0.0, 0.0);
        for i in 0..=1000 {
            let d = deepest * f64::from(i) / 1000.0;
            let (next, force) = (table.half_width(d), table.force(d));
            prop_assert!(next >= x * (1.0 - 1e-12) && force >= f);
            (x, f) = (next, force);
        }
    }

    /// Integrals beside sums over many springs, in one segment and in two.
    #[test]
    fn integrals_beside_sums(
        nodes in convex(), a in 0.0..1.0_f64, b in 0.0..1.0_f64, values in proptest::array::uniform3(-1.0..1.0_f64)
    ) {
        let table = Arc::new(Tabulated::new(&nodes).unwrap());
        let deepest = nodes.last().unwrap().approach;
        let (low, high) = (deepest * a.min(b), deepest * a.max(b));
        let [first, middle, last] = values;
        let curve = 2.0 * (first - 2.0 * middle + last);
        let q = |gamma: f64| {
            let s = (gamma - low) / (high - low);
            first + s * (last - first - curve + s * curve)
        };
        let count = 4000;
        let mut sum = if low <= 0.0 { first * table.half_width(f64::MIN_POSITIVE) } else { 0.0 };
        for i in 0..count {
            let edge = |i: i32| low + (high - low) * f64::from(i) / f64::from(count);
            let x = [edge(i), edge(i + 1)].map(|gamma| table.half_width(gamma));
            sum += q(0.5 * (edge(i) + edge(i + 1))) * (x[1] - x[0]);
        }
        let whole = table.integral([low, high], values);
        // Steep ramps fall between the sum's points: first order.
        prop_assert!((whole - sum).abs() < 2e-3 * table.half_width(deepest), "{} {}", whole, sum);
        let cut = 0.3 * low + 0.7 * high;
        let halves = |[from, to]: [f64; 2]| table.integral([from, to], [from, 0.5 * (from + to), to].map(q));
        assert_relative_eq!(
            halves([low, cut]) + halves([cut, high]), whole, max_relative = 1e-9, epsilon = 1e-9
        );
    }
}
