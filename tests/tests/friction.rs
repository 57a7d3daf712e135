//! Friction: springs against the closed form of the sphere.

#![allow(clippy::unwrap_used)] // Helpers of tests; clippy.toml allows it in the tests themselves.

use analytic::CattaneoMindlin;
use approx::assert_relative_eq;
use contact_model::{Body, Friction, HistoryModel, Load, Pair, Scene, Step, Surface, Tangential};
use mdr1d::PartialSlip;

/// A root of each, and energies that are small differences near the first turn.
const EXACT: f64 = 1e-9;

#[test]
fn springs_are_cattaneo_and_mindlin_and_deresiewicz() {
    let steel = Body::Elastic { young: 210.0, poisson: 0.3 };
    let rubber = Body::Elastic { young: 0.01, poisson: 0.5 };
    for pair in [
        Pair { first: steel, second: steel },
        Pair { first: Body::Rigid, second: rubber },
        Pair { first: steel, second: rubber },
    ] {
        let mut scene = Scene::of_pair(Surface::Sphere { radius: 2.0, side: 3.0 }, pair).unwrap();
        scene.effects.friction = Friction::Coulomb { coefficient: 0.35 };
        let models: [&dyn HistoryModel; 2] = [&CattaneoMindlin, &PartialSlip];
        let [mut closed, mut springs] = models.map(|model| model.prepare(&scene, 0).unwrap());
        let normal = Load::Approach(0.01);
        let limit = 0.35 * closed.advance(Step::normal(0.0, normal)).unwrap().normal.force;
        springs.advance(Step::normal(0.0, normal)).unwrap();
        // Turns inside turns, loops that close, gross slip and back.
        let shares = [0.5, 0.8, -0.2, 0.3, -0.1, 0.9, -0.9, 0.0, 0.95, -1.0, 0.4, 1.0, 0.0];
        for (i, share) in shares.into_iter().enumerate() {
            let step = Step { time: i as f64, normal, tangential: Tangential::Force(share * limit) };
            let [one, other] = [&mut closed, &mut springs].map(|history| history.advance(step).unwrap());
            assert_relative_eq!(
                one.contact_radius.unwrap(),
                other.contact_radius.unwrap(),
                max_relative = 1e-13
            );
            let (one, other) = (one.tangential.unwrap(), other.tangential.unwrap());
            let reach = 0.75 * limit / (scene.modulus * 0.1);
            assert_relative_eq!(
                one.displacement,
                other.displacement,
                max_relative = EXACT,
                epsilon = EXACT * reach
            );
            assert_relative_eq!(
                one.dissipated,
                other.dissipated,
                max_relative = EXACT,
                epsilon = EXACT * limit * reach
            );
            if share.abs() < 1.0 {
                assert_relative_eq!(
                    one.stick_radius.unwrap(),
                    other.stick_radius.unwrap(),
                    max_relative = 1e-6
                );
            }
        }
    }
}
