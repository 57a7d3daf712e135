//! Properties that follow from Coulomb's law and mechanics for any surface on any path, and invalid values.

use bem3d::Bem3d;
use contact_model::{
    Body, Boundary, ContactModel, ContactState, Coupling, Error, Friction, HeightMap, Load, Outputs, Pair,
    PreparedContact, Scene, Step, Tangential,
};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};
use tests::stability::{Dragged, PlainShear, compliance};
use tests::{hard_map, rough_map, scene};

const TOLERANCE: f64 = 1e-10;
/// Energies and displacements of two solves at [`TOLERANCE`], which bounds the energy.
const SAME: f64 = 1e-7;
/// The error of tractions is the square root of that of the energy.
const TRACTION: f64 = 1e-4;
/// Sums over a few hundred cells.
const ROUNDING: f64 = 1e-11;

fn config(cases: u32) -> ProptestConfig {
    let file = "tests/friction_properties.regressions";
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..ProptestConfig::with_cases(cases)
    }
}

/// A surface, its bodies and their friction.
#[derive(Debug, Clone)]
struct SlidingScene {
    map: HeightMap,
    poisson: f64,
    coefficient: f64,
    /// Normal force of the first steps, in cell forces: from one cell to full contact.
    force: f64,
}

prop_compose! {
    fn any_contact()(
        kind in 0_u8..9, cells in 2_usize..13, seed in 0_u64..1000, noise in prop::collection::vec(0.0_f64..1.0, 200),
        poisson in prop_oneof![Just(0.0), Just(0.5), 0.0_f64..0.5], coefficient in -2.0_f64..1.0, exponent in -4.0_f64..1.0,
    ) -> SlidingScene {
        let map = match kind {
            7 | 8 if cells > 2 => rough_map(if kind == 7 { 2.2 } else { 2.8 }, cells, seed).unwrap(),
            _ => hard_map(kind, cells, &noise).unwrap(),
        };
        let rms = surface_gen::rms_height(map.heights());
        let unit = if rms > 0.0 { rms } else { 1.0 };
        SlidingScene { map, poisson, coefficient: 10_f64.powf(coefficient), force: 10_f64.powf(exponent) * unit }
    }
}

/// The end of a step: normal force over that of the first one, share of mu F or of a displacement, its angle, whether
/// it is a force.
type Leg = (f64, f64, f64, bool);

fn any_leg() -> impl Strategy<Value = Leg> {
    (prop_oneof![Just(1.0), 0.2_f64..3.0], 0.0_f64..0.98, 0.0_f64..7.0, any::<bool>())
}

impl SlidingScene {
    fn pair(&self) -> Pair {
        let body = Body::Elastic { young: 2.0 * (1.0 - self.poisson * self.poisson), poisson: self.poisson };
        Pair { first: body, second: body }
    }

    fn prepare(&self) -> Box<dyn PreparedContact> {
        self.prepare_to(TOLERANCE)
    }

    fn prepare_to(&self, tolerance: f64) -> Box<dyn PreparedContact> {
        let mut scene = Scene { pair: Some(self.pair()), ..scene(self.map.clone()) };
        scene.effects.friction = Friction::coulomb(self.coefficient);
        scene.outputs = Outputs { pressure: true, traction: true, slip: true, ..Outputs::default() };
        Bem3d { tolerance, ..Bem3d::default() }.prepare(&scene, 0).unwrap()
    }

    fn sum(&self) -> PlainShear {
        PlainShear::of(&self.map, compliance(&self.pair()).unwrap())
    }

    /// A displacement at which most of a contact slips: mu F over the stiffness of the rectangle, and of one cell.
    fn reach(&self) -> f64 {
        self.coefficient * self.force / self.map.dx().max(self.map.dy())
    }

    fn step(&self, (normal, share, angle, is_force): Leg) -> Step {
        let force = self.force * normal;
        let (sin, cos) = angle.sin_cos();
        let tangential = if is_force {
            Tangential::Force([cos, sin].map(|e| e * share * self.coefficient * force))
        } else {
            Tangential::Displacement([cos, sin].map(|e| e * share * 2.0 * self.reach()))
        };
        Step::new(0.0, Load::force(force).with_tangential(tangential))
    }
}

/// Forces on cells: tractions and friction's limits times areas.
struct Sheared {
    forces: Vec<(usize, [f64; 2])>,
    limits: Vec<f64>,
    displacement: [f64; 2],
    force: [f64; 2],
    dissipated: f64,
    slip: Vec<[f64; 2]>,
}

impl Sheared {
    fn of(drawn: &SlidingScene, state: &ContactState) -> Self {
        let fields = state.fields.as_ref().unwrap();
        let area = drawn.map.dx() * drawn.map.dy();
        let (p, [x, y]) = (fields.pressure.as_ref().unwrap().values(), fields.traction.as_ref().unwrap());
        let [sx, sy] = fields.slip.as_ref().unwrap();
        let cells: Vec<usize> = (0..p.len()).filter(|&i| p[i] > 0.0).collect();
        let t = state.tangential.unwrap();
        Self {
            forces: cells.iter().map(|&i| (i, [x.values()[i] * area, y.values()[i] * area])).collect(),
            limits: cells.iter().map(|&i| drawn.coefficient * p[i] * area).collect(),
            displacement: t.displacement,
            force: t.force,
            dissipated: t.dissipated,
            slip: sx.values().iter().zip(sy.values()).map(|(&x, &y)| [x, y]).collect(),
        }
    }

    fn nothing(drawn: &SlidingScene) -> Self {
        let slip = vec![[0.0; 2]; drawn.map.heights().len()];
        Self {
            forces: vec![],
            limits: vec![],
            displacement: [0.0; 2],
            force: [0.0; 2],
            dissipated: 0.0,
            slip,
        }
    }

    /// Twice the elastic energy of these forces and others: `q' K q`.
    fn product(&self, sum: &PlainShear, other: &Self) -> f64 {
        let u = sum.displacement(&other.forces);
        self.forces.iter().map(|&(i, f)| dot(f, u[i])).sum()
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

proptest! {
    #![proptest_config(config(32))]

    /// The work of the tangential force is stored or dissipated, to rounding; the dissipated energy never
    /// falls; and Coulomb's law holds cell by cell, in the fields.
    ///
    /// With the force at the end of a step `Q . d(delta) = D + dU + dq'K dq/2`: the last term is the excess
    /// of a step of any length over a path with the same end.
    #[test]
    fn work_is_stored_or_dissipated(drawn in any_contact(), legs in prop::collection::vec(any_leg(), 1..6)) {
        let (mut contact, sum) = (drawn.prepare(), drawn.sum());
        let mut before = Sheared::nothing(&drawn);
        let mut energy = 0.0;
        for leg in legs {
            let state = contact.advance(drawn.step(leg)).unwrap();
            let now = Sheared::of(&drawn, &state);
            let (square, mixed) = (now.product(&sum, &now), now.product(&sum, &before));
            let change = square - 2.0 * mixed + 2.0 * energy;
            let moved = [0, 1].map(|k| now.displacement[k] - before.displacement[k]);
            let work = dot(now.force, moved);
            let dissipated = now.dissipated - before.dissipated;
            let scale = square + 2.0 * energy + work.abs() + dissipated + now.dissipated * ROUNDING;
            let expected = dissipated + 0.5 * square - energy + 0.5 * change;
            prop_assert!((work - expected).abs() <= 1e-8 * scale, "{work} {expected} of {scale}");
            prop_assert!(dissipated >= -ROUNDING * scale, "friction gives {dissipated} back, of {scale}");
            // |q| <= mu p, and q . w = mu p |w|.
            let (u, u_before) = (sum.displacement(&now.forces), sum.displacement(&before.forces));
            let mut gap = 0.0;
            let mut longest = length(now.displacement).max(length(before.displacement));
            for (&(i, f), b) in now.forces.iter().zip(&now.limits) {
                prop_assert!(length(f) <= b * (1.0 + ROUNDING), "{f:?} beyond {b}");
                let w = [0, 1].map(|k| moved[k] - u[i][k] + u_before[i][k]);
                gap += (b * length(w) - dot(f, w)).max(0.0);
                longest = longest.max(length(u_before[i]));
                let touched = before.forces.iter().any(|(j, _)| *j == i);
                let slip = if touched { [0, 1].map(|k| before.slip[i][k] + w[k]) } else { w };
                let off = length([slip[0] - now.slip[i][0], slip[1] - now.slip[i][1]]);
                prop_assert!(off <= 1e-8 * longest.max(length(slip)), "slip {:?}, expected {slip:?}", now.slip[i]);
            }
            let friction: f64 = now.limits.iter().sum();
            prop_assert!(gap <= 5.0 * TOLERANCE * friction * longest, "{gap} of {}", friction * longest);
            (before, energy) = (now, 0.5 * square);
        }
    }

    /// The duality gap of a step bounds the whole square of the error of the tractions, `e' K e`, and not half of
    /// it: beside tractions to rounding under the same displacement and the same limits of friction.
    #[test]
    fn the_gap_bounds_the_square_of_the_error(drawn in any_contact(), leg in any_leg()) {
        let (mut contact, sum) = (drawn.prepare_to(0.03), drawn.sum());
        let state = contact.advance(drawn.step(leg)).unwrap();
        let mut now = Sheared::of(&drawn, &state);
        let u = sum.displacement(&now.forces);
        let slip = |i: usize| [0, 1].map(|k| now.displacement[k] - u[i][k]);
        let of_cell = |(&(i, f), b): (&(usize, [f64; 2]), &f64)| b * length(slip(i)) - dot(f, slip(i));
        let gap: f64 = now.forces.iter().zip(&now.limits).map(of_cell).sum();
        let mut exact = Dragged::new(&sum);
        let limits: Vec<(usize, f64)> =
            now.forces.iter().map(|(i, _)| *i).zip(now.limits.iter().copied()).collect();
        exact.advance(&limits, now.displacement);
        for (i, f) in &mut now.forces {
            *f = [0, 1].map(|k| f[k] - exact.forces[*i][k]);
        }
        let square = now.product(&sum, &now);
        let scale = now.limits.iter().sum::<f64>() * length(now.displacement);
        prop_assert!(square <= gap + ROUNDING * scale, "{square} beyond {gap}");
    }

    /// A closed loop of the force dissipates energy, since the elastic energy is the same at both ends. With
    /// a Poisson's ratio of 0 it ends in the state in which it began.
    #[test]
    fn loops_close_and_lose_energy(
        drawn in any_contact(), top in 0.05_f64..0.97, part in 0.0_f64..1.0, angle in 0.0_f64..7.0, steps in 1_u32..4,
    ) {
        let drawn = SlidingScene { poisson: 0.0, ..drawn };
        let mut contact = drawn.prepare();
        let bottom = top - 2.0 * part * top;
        let mut turns = Vec::new();
        let mut last = 0.0;
        for (from, to) in [(0.0, top), (top, bottom), (bottom, top), (top, bottom), (bottom, top)] {
            let mut at = None;
            for i in 1..=steps {
                let share = from + (to - from) * f64::from(i) / f64::from(steps);
                let state = contact.advance(drawn.step((1.0, share, angle, true))).unwrap();
                let found = state.tangential.unwrap();
                // Along the load, and nowhere else; where the force rises the displacement does.
                let (sin, cos) = angle.sin_cos();
                let along = dot(found.displacement, [cos, sin]);
                let across = dot(found.displacement, [-sin, cos]);
                let size = length(found.displacement).max(1e-3 * drawn.reach());
                prop_assert!(across.abs() <= SAME * size, "{:?}", found.displacement);
                prop_assert!((along - last) * (to - from) >= -SAME * size, "{last} {along}: {from} {to}");
                last = along;
                at = Some(found);
            }
            turns.push(at.unwrap());
        }
        let size = length(turns[0].displacement).max(1e-3 * drawn.reach());
        for (one, other) in [(0, 2), (1, 3), (2, 4)] {
            let off = length([0, 1].map(|k| turns[one].displacement[k] - turns[other].displacement[k]));
            prop_assert!(off <= SAME * size, "{one} {other}: {off} of {size}");
        }
        let [first, second] = [(0, 2), (2, 4)].map(|(a, b): (usize, usize)| turns[b].dissipated - turns[a].dissipated);
        let work = drawn.coefficient * drawn.force * size;
        prop_assert!(first >= -SAME * work && (first - second).abs() <= SAME * work, "{first} {second} of {work}");
    }

    /// Under the same pressures a step cannot lead against its force: `(Q_2 - Q_1) . (delta_2 - delta_1) >= 0`, from
    /// any state, as delta is the gradient of a convex function of Q.
    #[test]
    fn a_step_goes_along_with_its_force(drawn in any_contact(), legs in prop::collection::vec(any_leg(), 2..6)) {
        let mut contact = drawn.prepare();
        let mut before: Option<([f64; 2], [f64; 2])> = None;
        for (_, share, angle, is_force) in legs {
            let state = contact.advance(drawn.step((1.0, share, angle, is_force))).unwrap();
            let found = state.tangential.unwrap();
            if let Some((q, delta)) = before {
                let along = dot(
                    [found.force[0] - q[0], found.force[1] - q[1]],
                    [found.displacement[0] - delta[0], found.displacement[1] - delta[1]],
                );
                let size = drawn.coefficient * drawn.force * (length(delta) + length(found.displacement));
                prop_assert!(along >= -SAME * size, "{along} of {size}");
            }
            before = Some((found.force, found.displacement));
        }
    }

    /// All eight symmetries of the square: a turned map under turned loads has the turned tractions.
    #[test]
    fn turned_and_mirrored(
        drawn in any_contact(), turns in 0_u8..4, mirror in any::<bool>(), legs in prop::collection::vec(any_leg(), 1..4),
    ) {
        let n = drawn.map.columns();
        let turn_map = |of: &HeightMap| {
            let mut of = of.clone();
            for _ in 0..turns {
                of = of.rotated();
            }
            if mirror { of.mirrored() } else { of }
        };
        let turn = |mut v: [f64; 2]| {
            for _ in 0..turns {
                v = [-v[1], v[0]];
            }
            if mirror { [-v[0], v[1]] } else { v }
        };
        let place = |i: usize| {
            let (mut x, mut y) = (i % n, i / n);
            for _ in 0..turns {
                (x, y) = (n - 1 - y, x);
            }
            if mirror { y * n + n - 1 - x } else { y * n + x }
        };
        let turned = SlidingScene { map: turn_map(&drawn.map), ..drawn.clone() };
        let (mut here, mut there) = (drawn.prepare(), turned.prepare());
        for leg in legs {
            let step = drawn.step(leg);
            let tangential = match step.load.tangential {
                Tangential::Force(force) => Tangential::Force(turn(force)),
                other => Tangential::Displacement(turn(other.components())),
            };
            let one = here.advance(step).unwrap();
            let other = there.advance(Step { load: step.load.with_tangential(tangential), ..step }).unwrap();
            let (a, b) = (one.tangential.unwrap(), other.tangential.unwrap());
            let most = a.sliding_force.unwrap();
            let off = |a: [f64; 2], b: [f64; 2]| {
                let a = turn(a);
                length([a[0] - b[0], a[1] - b[1]])
            };
            prop_assert!(off(a.force, b.force) <= SAME * most, "{a:?} {b:?}");
            let size = length(a.displacement).max(1e-2 * drawn.reach());
            prop_assert!(off(a.displacement, b.displacement) <= 10.0 * SAME * size, "{a:?} {b:?}");
            prop_assert!((a.dissipated - b.dissipated).abs() <= 10.0 * SAME * (a.dissipated + most * size));
            let fields = [&one, &other].map(|state| state.fields.as_ref().unwrap().traction.clone().unwrap());
            let p = one.pressure().unwrap().values();
            let largest = drawn.coefficient * p.iter().fold(0.0, |most: f64, p| p.max(most));
            for i in 0..n * n {
                let at = |k: usize, i: usize| [fields[k][0].values()[i], fields[k][1].values()[i]];
                let off = off(at(0, i), at(1, place(i)));
                prop_assert!(off <= TRACTION * largest, "cell {i}: {off} of {largest}");
            }
        }
    }
}

fn hostile() -> (SlidingScene, Box<dyn PreparedContact>) {
    let drawn =
        SlidingScene { map: rough_map(2.3, 8, 1).unwrap(), poisson: 0.3, coefficient: 0.4, force: 0.3 };
    let contact = drawn.prepare();
    (drawn, contact)
}

fn advance(contact: &mut dyn PreparedContact, tangential: Tangential) -> Result<ContactState, Error> {
    contact.advance(Step::new(0.0, Load::force(0.3).with_tangential(tangential)))
}

/// Errors name the value, and the path continues as if the step had not been requested.
#[test]
fn invalid_tangential_loads_are_named() {
    let (_, mut contact) = hostile();
    let (_, mut beside) = hostile();
    let good = Tangential::Force([0.05, 0.02]);
    advance(&mut *contact, good).unwrap();
    advance(&mut *beside, good).unwrap();
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (load, name) in [
            (Tangential::Force([bad, 0.0]), "tangential force along x"),
            (Tangential::Force([0.0, bad]), "tangential force along y"),
            (Tangential::Displacement([bad, 1.0]), "tangential displacement along x"),
            (Tangential::Displacement([0.0, bad]), "tangential displacement along y"),
        ] {
            let refused = advance(&mut *contact, load).unwrap_err().to_string();
            assert_eq!(refused, format!("{name} = {bad}: expected a finite number"));
        }
    }
    for force in [0.2, 1.0, 1e150, 1e300, f64::MAX] {
        for load in [[force, 0.0], [0.0, -force], [force, force]] {
            let refused = advance(&mut *contact, Tangential::Force(load)).unwrap_err();
            let text = refused.to_string();
            match refused {
                Error::OutOfRange { max, .. } => assert!((max / 0.12 - 1.0).abs() < 1e-9, "{text}"),
                Error::Domain { .. } => assert!(force > 1e200 && text.contains("tangential force"), "{text}"),
                _ => panic!("{text}"),
            }
        }
    }
    for normal in [f64::NAN, -1.0, f64::INFINITY] {
        let step = Step::new(0.0, Load::force(normal).with_tangential(good));
        let refused = contact.advance(step).unwrap_err().to_string();
        assert!(refused.contains(&normal.to_string()), "{refused}");
    }
    // None of them moved anything.
    for load in [good, Tangential::Force([-0.05, 0.0])] {
        let [one, other] = [&mut contact, &mut beside]
            .map(|contact| advance(&mut **contact, load).unwrap().tangential.unwrap());
        assert!((one.dissipated - other.dissipated).abs() <= 1e-12, "{one:?} {other:?}");
        assert!((one.displacement[0] / other.displacement[0] - 1.0).abs() < 1e-9, "{one:?} {other:?}");
    }
}

/// Displacements of any size lead to gross slip in a state with finite numbers, or to an error that names
/// them.
#[test]
fn displacements_of_any_size_are_solved_or_named() {
    let mut held = 0;
    for size in [5e-324, 1e-310, 1e-200, 1e-30, 1e10, 1e30, 1e150, 1e200, 1e300, f64::MAX] {
        let (_, mut contact) = hostile();
        advance(&mut *contact, Tangential::Force([0.05, 0.0])).unwrap();
        match advance(&mut *contact, Tangential::Displacement([0.0, -size])) {
            Ok(state) => {
                held += 1;
                let t = state.tangential.unwrap();
                assert!(t.force.iter().all(|f| f.is_finite()) && t.dissipated.is_finite(), "{t:?}");
                assert!(length(t.force) <= 0.12 * (1.0 + 1e-12), "{size}: {t:?}");
                if size > 1e9 {
                    assert!((t.force[1] / -0.12 - 1.0).abs() < 1e-6, "{size}: {t:?}");
                    assert!((t.dissipated / (0.12 * size) - 1.0).abs() < 1e-6, "{size}: {t:?}");
                }
                let fields = state.fields.unwrap();
                let all = fields.traction.unwrap().into_iter().chain(fields.slip.unwrap());
                assert!(all.flat_map(|f| f.values().to_vec()).all(f64::is_finite), "{size}");
            }
            Err(error) => {
                let text = error.to_string();
                assert!(matches!(error, Error::Domain { .. }), "{size}: {text}");
                assert!(!(1e-200..=1e150).contains(&size), "{size}: {text}");
            }
        }
    }
    assert!(held >= 5, "{held}");
}

#[test]
fn invalid_coefficients_are_named() {
    let (drawn, _) = hostile();
    let mut scene = Scene { pair: Some(drawn.pair()), ..scene(drawn.map.clone()) };
    scene.outputs = Outputs { traction: true, ..Outputs::default() };
    for coupling in [None, Some(Coupling::Neglected), Some(Coupling::Full)] {
        for bad in [f64::NAN, f64::INFINITY, -1e-300, -0.3, f64::NEG_INFINITY] {
            scene.effects.friction = Friction::coulomb(bad).with_coupling(coupling);
            let refused = Bem3d::default().prepare(&scene, 0).err().unwrap().to_string();
            let value =
                refused.strip_prefix("coefficient of friction = ").and_then(|rest| rest.split(':').next());
            let value: f64 = value.unwrap_or_else(|| panic!("{refused}")).parse().unwrap();
            assert_eq!(value.to_bits() << 1, bad.to_bits() << 1, "{refused}");
            assert!(bad.is_nan() || (value < 0.0) == (bad < 0.0), "{refused}");
        }
        // Any other number is one, with periodic boundaries too.
        for coefficient in [0.0, 5e-324, 1e-300, 1e-9, 1e9, 1e200, 1e300, f64::MAX] {
            for boundary in [Boundary::Free, Boundary::Periodic] {
                scene.effects.boundary = boundary;
                scene.effects.friction = Friction::coulomb(coefficient).with_coupling(coupling);
                let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
                let mut contact = model.prepare(&scene, 0).unwrap();
                match advance(&mut *contact, Tangential::Displacement([1e-3, 0.0])) {
                    Ok(state) => {
                        let t = state.tangential.unwrap();
                        let finite = t.force.iter().all(|f| f.is_finite()) && t.dissipated >= 0.0;
                        assert!(finite && t.force[0] >= 0.0, "{coefficient} {boundary:?}: {t:?}");
                        // Where nothing slips the coefficient does not matter.
                        assert!(t.force[0] <= 0.3 * coefficient * (1.0 + 1e-9), "{coefficient}: {t:?}");
                    }
                    Err(error) => {
                        let text = error.to_string();
                        assert!(matches!(error, Error::Domain { .. }), "{coefficient} {boundary:?}: {text}");
                        assert!(!(1e-100..=1e100).contains(&coefficient), "{coefficient}: {text}");
                    }
                }
            }
        }
    }
}
