//! Checks that every closed form passes (tests only).

use approx::{assert_abs_diff_eq, assert_relative_eq};
use contact_model::{
    Conductance, ContactModel, ContactState, Load, Nondimensionalisation, NormalLoad, Result, Scene, Surface,
};

/// Digits to which the reference values are printed.
pub(crate) const PRINTED: f64 = 1e-10;
/// A root and a handful of products.
pub(crate) const ROUNDING: f64 = 1e-14;

/// One state, with the stiffness at fixed contact area, and the area where the model has one.
pub(crate) fn pressed(model: &dyn ContactModel, scene: &Scene, load: Load) -> Result<ContactState> {
    let mut scene = scene.clone();
    scene.outputs.stiffness_fixed_area = true;
    scene.outputs.area = !matches!(scene.surface, Surface::SelfAffine(_));
    model.prepare(&scene, 0)?.solve(load)
}

/// Round trip, k = dF/dd by differences, convexity, k that does not decrease, F proportional to E*, no load.
pub(crate) fn check_curve(model: &dyn ContactModel, scene: &Scene, d: f64) {
    let at = |load| pressed(model, scene, load).unwrap();
    let here = at(Load::approach(d));
    // Round trip: two inverse powers of exponents down to 0.1.
    let back = at(Load::force(here.force));
    assert_relative_eq!(back.approach.unwrap(), d, max_relative = 1e-13);
    assert_relative_eq!(back.stiffness.unwrap(), here.stiffness.unwrap(), max_relative = 1e-12);
    // Central difference: its error is e^2 times the third logarithmic derivative, at most 1e3 for the
    // steepest power 11.
    let e = 1e-5;
    let (low, high) = (at(Load::approach(d * (1.0 - e))), at(Load::approach(d * (1.0 + e))));
    assert_relative_eq!(
        (high.force - low.force) / (2.0 * e * d),
        here.stiffness.unwrap(),
        max_relative = 1e-7
    );
    assert!(2.0 * here.force <= (low.force + high.force) * (1.0 + ROUNDING));
    assert!(low.stiffness.unwrap() <= high.stiffness.unwrap());
    assert_eq!(here.stiffness, here.stiffness_fixed_area);
    let stiffer = Scene { contact_modulus: 2.0 * scene.contact_modulus, ..scene.clone() };
    let doubled = pressed(model, &stiffer, Load::approach(d)).unwrap();
    assert_relative_eq!(doubled.force, 2.0 * here.force, max_relative = ROUNDING);
    assert_relative_eq!(doubled.stiffness.unwrap(), 2.0 * here.stiffness.unwrap(), max_relative = ROUNDING);
    for zero in [at(Load::force(0.0)), at(Load::approach(0.0))] {
        assert!(zero.force <= 0.0 && zero.approach.unwrap() <= 0.0 && zero.stiffness.unwrap() <= 0.0);
        assert!(zero.area.is_none_or(|a| a <= 0.0));
    }
}

/// Of an adhesive sphere: dF/dd of a state is that of its neighbours under loads of the same kind, by central
/// differences; at fixed contact area it is 2 E* a, from which the conductance follows.
pub(crate) fn check_slope(model: &dyn ContactModel, scene: &Scene, load: Load) {
    /// Relative step of the load; its square times third derivatives that grow towards a fold is the error of
    /// a difference.
    const STEP: f64 = 1e-5;
    const DIFFERENCES: f64 = 1e-6;
    let mut scene = scene.clone();
    scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 3.0 };
    let here = pressed(model, &scene, load).unwrap();
    let [low, high] = [1.0 - STEP, 1.0 + STEP].map(|by| {
        let load = match load.normal {
            NormalLoad::Force(force) => Load::force(by * force),
            NormalLoad::Approach(approach) => Load::approach(by * approach),
            other => panic!("{other:?}"),
        };
        pressed(model, &scene, load).unwrap()
    });
    let slope = (high.force - low.force) / (high.approach.unwrap() - low.approach.unwrap());
    let held = 2.0 * scene.contact_modulus * (here.area.unwrap() / std::f64::consts::PI).sqrt();
    assert_abs_diff_eq!(here.stiffness.unwrap(), slope, epsilon = DIFFERENCES * slope.abs().max(held));
    assert_relative_eq!(here.stiffness_fixed_area.unwrap(), held, max_relative = ROUNDING);
    let conductance = scene.outputs.conductance.of(held, scene.contact_modulus).unwrap().unwrap();
    assert_relative_eq!(here.conductance.unwrap(), conductance, max_relative = ROUNDING);
}

/// F and k follow E* and the unit of length to both ends of f64.
pub(crate) fn scale_invariant(
    model: &dyn ContactModel,
    surface: impl Fn(f64) -> Surface,
    d: f64,
    tolerance: f64,
) {
    let one = pressed(model, &Scene::new(surface(1.0), 1.0), Load::approach(d)).unwrap();
    for (contact_modulus, length) in [(1e150, 1e-150), (1e-150, 1e150), (1e11, 1e-3)] {
        let scene = Scene::new(surface(length), contact_modulus);
        let s = pressed(model, &scene, Load::approach(d * length)).unwrap();
        let nondimensional = Nondimensionalisation::new(contact_modulus, length, length).unwrap();
        assert_relative_eq!(s.force, nondimensional.force(one.force).unwrap(), max_relative = tolerance);
        let k = nondimensional.stiffness(one.stiffness.unwrap()).unwrap();
        assert_relative_eq!(s.stiffness.unwrap(), k, max_relative = tolerance);
    }
}

/// Of a periodic contact at a mean pressure on a square of side 1: both loads agree, k = -dF/d(mean gap) by
/// differences, F proportional to E*, gap and area monotone, nothing without load. `tolerance`: relative, of
/// the round trip.
pub(crate) fn check_periodic(model: &dyn ContactModel, scene: &Scene, pressure: f64, tolerance: f64) {
    let mut scene = scene.clone();
    scene.outputs.mean_gap = true;
    let mut contact = model.prepare(&scene, 0).unwrap();
    let here = contact.solve(Load::force(pressure)).unwrap();
    assert!(here.approach.is_none());
    let mut gap = |p: f64| contact.solve(Load::force(p)).unwrap().mean_gap.unwrap();
    // Central difference: its error is e^2 times third derivatives in ln p, a few thousand at most.
    let e = 1e-5;
    let (middle, wide, narrow) = (gap(pressure), gap(pressure * (1.0 - e)), gap(pressure * (1.0 + e)));
    assert!(wide >= middle && middle >= narrow);
    let slope = 2.0 * e * pressure / (wide - narrow);
    // Rounding of the gaps is divided by their difference.
    let rounding = 4.0 * f64::EPSILON * middle / (wide - narrow);
    assert_relative_eq!(slope, here.stiffness.unwrap(), max_relative = 1e-6 + rounding);
    if rounding < 1e-3 {
        // The load has the digits that the gap leaves it.
        let back = contact.solve(Load::mean_gap(middle)).unwrap();
        assert_relative_eq!(back.force, pressure, max_relative = tolerance + e * rounding);
    }
    let more = contact.solve(Load::force(1.001 * pressure));
    assert!(more.is_err() || more.unwrap().area.unwrap() >= here.area.unwrap());
    let stiffer = Scene { contact_modulus: 2.0 * scene.contact_modulus, ..scene.clone() };
    let doubled = model.prepare(&stiffer, 0).unwrap().solve(Load::force(2.0 * pressure)).unwrap();
    assert_relative_eq!(doubled.area.unwrap(), here.area.unwrap(), max_relative = ROUNDING);
    assert_relative_eq!(doubled.stiffness.unwrap(), 2.0 * here.stiffness.unwrap(), max_relative = ROUNDING);
    let zero = contact.solve(Load::force(0.0)).unwrap();
    assert!(zero.force <= 0.0 && zero.stiffness.unwrap() <= 0.0 && zero.area.unwrap() <= 0.0);
}
