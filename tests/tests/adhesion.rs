//! Adhesion: two independent codes for the sphere.

#![allow(clippy::unwrap_used)] // Helpers of tests; clippy.toml allows it in the tests themselves.

use analytic::Jkr;
use approx::assert_relative_eq;
use contact_model::{Adhesion, ContactModel, ContactState, Load, Scene, Surface};
use mdr1d::Mdr1d;

/// Both are closed or iterated to rounding; a tenth away from a fold a root loses one digit.
const EXACT: f64 = 1e-12;

fn press(model: &dyn ContactModel, work: f64, load: Load) -> ContactState {
    let mut scene = Scene::new(Surface::Sphere { radius: 1.3, side: 2.0 }, 0.7);
    scene.effects.adhesion = Adhesion::ShortRange { work };
    scene.outputs.area = true;
    model.prepare(&scene, 0).unwrap().solve(load).unwrap()
}

#[test]
fn mdr_is_jkr_for_a_sphere() {
    for work in [0.0, 1e-12, 1e-6, 1e-3, 1e-2] {
        let pull_off = 1.5 * std::f64::consts::PI * work * 1.3;
        for force in [-0.9 * pull_off, 0.0, 0.1 * pull_off, 1e-6, 0.05] {
            let (one, other) =
                (press(&Jkr, work, Load::Force(force)), press(&Mdr1d::default(), work, Load::Force(force)));
            assert_relative_eq!(one.area.unwrap(), other.area.unwrap(), max_relative = EXACT);
            assert_relative_eq!(one.stiffness.unwrap(), other.stiffness.unwrap(), max_relative = EXACT);
            let d = one.approach.unwrap();
            assert_relative_eq!(
                d,
                other.approach.unwrap(),
                max_relative = EXACT,
                epsilon = EXACT * one.area.unwrap()
            );
            let (one, other) =
                (press(&Jkr, work, Load::Approach(d)), press(&Mdr1d::default(), work, Load::Approach(d)));
            assert_relative_eq!(one.force, other.force, max_relative = EXACT, epsilon = EXACT * pull_off);
        }
    }
}
