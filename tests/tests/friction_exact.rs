//! Friction cell by cell compared with closed forms: punches in full stick, the stick radius of Cattaneo and
//! Mindlin, Spence's contacts with full coupling.

use bem3d::Bem3d;
use contact_model::{
    Body, ContactModel, ContactState, Coupling, Effects, Friction, HeightMap, Load, Outputs, Pair, Scene,
    Step, Surface, Tangential,
};
use std::f64::consts::PI;
use std::sync::Arc;

fn alike(poisson: f64) -> Pair {
    let body = Body::Elastic { young: 2.0, poisson };
    Pair { first: body, second: body }
}

fn on_rigid(poisson: f64) -> Pair {
    Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson } }
}

/// `E* sum nu/(2 G)`.
fn compliance(pair: &Pair) -> f64 {
    tests::stability::compliance(pair).unwrap()
}

/// A flat punch of an elliptic face in the middle of a square of side 1, on cells of `1/cells`.
fn ellipse(cells: usize, [a, b]: [f64; 2]) -> Surface {
    let at = |i: usize| (i as f64 + 0.5) / cells as f64 - 0.5;
    let inside = |x: usize, y: usize| (at(x) / a).powi(2) + (at(y) / b).powi(2) < 1.0;
    let map = HeightMap::from_fn(cells, 1.0, |x, y| if inside(x, y) { 0.0 } else { -1.0 });
    Surface::Heights(Arc::new(map.unwrap()))
}

/// `k_x, k_y, k_z` of an elliptic punch with the semi-axes a, b in full stick.
///
/// The traction `Q/(2 pi a b) (1 - x^2/a^2 - y^2/b^2)^(-1/2)` moves the whole face by one displacement, as the
/// pressure of the same form does (Mindlin, J. Appl. Mech. 16, 259 (1949)). In the middle it is, along a ray of the length
/// `R = a b/(b^2 cos^2 + a^2 sin^2)^(1/2)`,
/// `Q/(2 pi a b) 1/(pi E*) int h (int_0^R (1 - r^2/R^2)^(-1/2) dr) dtheta = Q/(4 pi E*) int h R/(a b) dtheta`
/// with `h = 1 + c cos^2`, `1 + c sin^2` and 1.
fn of_an_ellipse([a, b]: [f64; 2], c: f64, contact_modulus: f64) -> [f64; 3] {
    let rays = 4000;
    let mean = |h: &dyn Fn(f64, f64) -> f64| {
        // The rule of trapezia is exact to rounding for a periodic function.
        let at = |i: u32| {
            let (sin, cos) = (2.0 * PI * f64::from(i) / f64::from(rays)).sin_cos();
            h(cos, sin) / (b * cos).hypot(a * sin)
        };
        (0..rays).map(at).sum::<f64>() / f64::from(rays)
    };
    let k = |h: &dyn Fn(f64, f64) -> f64| 2.0 * contact_modulus / mean(h);
    [k(&|cos, _| 1.0 + c * cos * cos), k(&|_, sin| 1.0 + c * sin * sin), k(&|_, _| 1.0)]
}

/// Errors of `k_x/k_z` and `k_y/k_z`, and of `k_x` and `k_y`, of an elliptic face.
fn errors(cells: usize, axes: [f64; 2], pair: Pair) -> [f64; 4] {
    let mut scene = Scene::of_pair(ellipse(cells, axes), pair).unwrap();
    scene.effects.friction = Friction::coulomb(1e3);
    scene.outputs = Outputs { stiffness: true, tangential_stiffness_stuck: true, ..Outputs::default() };
    let mut contact = Bem3d { tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
    let state = contact.advance(Step::new(0.0, Load::force(1e-3))).unwrap();
    let normal = state.stiffness.unwrap();
    let k = state.tangential.unwrap().stiffness_stuck.unwrap();
    assert!(k[0][1].abs() < 1e-7 * k[0][0], "{k:?}");
    let [x, y, z] = of_an_ellipse(axes, compliance(&pair), scene.contact_modulus);
    [k[0][0] / normal * z / x - 1.0, k[1][1] / normal * z / y - 1.0, k[0][0] / x - 1.0, k[1][1] / y - 1.0]
}

/// `-dln e/dlnN` by least squares.
fn order(points: &[(usize, f64)]) -> f64 {
    let logs: Vec<(f64, f64)> = points.iter().map(|&(n, e)| ((n as f64).ln(), e.abs().ln())).collect();
    let count = logs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    -mean(&|p| (p.0 - x) * (p.1 - y)) / mean(&|p| (p.0 - x).powi(2))
}

/// A disc of the stiffness `8 G a/(2 - nu)`. k depends on the number of cells in the disc, which is not
/// monotonic in the grid; relative to the normal stiffness of the same cells the error is smooth and of first
/// order.
#[test]
fn the_stiffness_of_a_sticking_disc_converges_with_first_order() {
    for pair in [alike(0.3), on_rigid(0.5)] {
        let [x, _, z] = of_an_ellipse([0.4, 0.4], compliance(&pair), 1.0);
        let ratio = pair.shear_modulus().unwrap() / pair.contact_modulus().unwrap();
        assert!((x / z / ratio - 1.0).abs() < 1e-12, "{x} {z}");
        let grids = [16, 23, 32, 45, 64, 91, 128, 181];
        let found = grids.map(|cells| (cells, errors(cells, [0.4, 0.4], pair)));
        let orders = [0, 2].map(|k| order(&found.map(|(cells, e)| (cells, e[k]))));
        println!("orders {orders:?}, {:?}", found.last());
        assert!((orders[0] - 1.05).abs() < 0.15 && orders[1] > 0.7, "{orders:?}");
        // To no cell size, by the first order of the last two whose ratio is 2.
        let (coarse, fine) = (found[4].1[0], found[6].1[0]);
        let limit = 2.0 * fine - coarse;
        assert!(limit.abs() < 0.25 * coarse.abs() && coarse.abs() < 4e-4, "{limit} of {coarse}");
        assert!(found[7].1[2].abs() < 0.002, "{found:?}");
    }
}

#[test]
fn an_ellipse_that_sticks_has_its_two_stiffnesses() {
    for pair in [alike(0.3), on_rigid(0.5)] {
        for cells in [16, 32, 64, 128, 181] {
            let [x, y, kx, ky] = errors(cells, [0.45, 0.15], pair);
            // First order, with steps along the edge that do not repeat.
            let cell = 1.0 / cells as f64;
            assert!(x.abs().max(y.abs()) < 0.16 * cell, "{cells}: {x} {y}");
            assert!(kx.abs().max(ky.abs()) < cell, "{cells}: {kx} {ky}");
        }
    }
}

/// `c/a = (1 - Q/(mu F))^(1/3)` without Poisson's ratio, to a third of a cell.
#[test]
fn the_radius_that_sticks_is_cattaneos() {
    let force = 1e-3;
    for cells in [32, 64, 128, 256] {
        let sphere = Surface::Sphere { radius: 1.0, size: 0.25.into() };
        let mut scene = Scene::of_pair(sphere, alike(0.0)).unwrap();
        scene.effects.friction = Friction::coulomb(0.3);
        scene.outputs = Outputs { area: true, stick_area: true, ..Outputs::default() };
        let a = (0.75 * force / scene.contact_modulus).cbrt();
        let mut contact = Bem3d { cells, tolerance: 1e-8, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
        for share in [0.25, 0.5, 0.75, 0.9] {
            let tangential = Tangential::force_along_x(share * 0.3 * force);
            let state =
                contact.advance(Step::new(0.0, Load::force(force).with_tangential(tangential))).unwrap();
            let found = state.tangential.unwrap();
            let (stick, slip) = (found.stick_area.unwrap(), found.slip_area.unwrap());
            assert!(((stick + slip) / state.area.unwrap() - 1.0).abs() < 1e-12);
            let off = (stick / PI).sqrt() / a - (1.0_f64 - share).cbrt();
            assert!(off.abs() < 0.35 * 0.25 / cells as f64 / a, "{cells} {share}: {off}");
        }
    }
}

fn coupled(surface: Surface, pair: Pair, mu: f64) -> Scene {
    let mut scene = Scene::of_pair(surface, pair).unwrap();
    scene.effects.friction = Friction::coulomb(mu).with_coupling(Some(Coupling::Full));
    scene.outputs = Outputs { area: true, stick_area: true, ..Outputs::default() };
    scene
}

fn punch() -> Surface {
    Surface::FlatCircle { radius: 0.4, size: 1.0.into() }
}

/// The contact is loaded by a normal load alone, without a tangential displacement.
fn pressed(normal: Load) -> Step {
    Step::new(0.0, normal.with_tangential(Tangential::Displacement([0.0; 2])))
}

/// Radius of stick over that of contact, by areas.
fn stick_share(state: &ContactState) -> f64 {
    (state.tangential.unwrap().stick_area.unwrap() / state.area.unwrap()).sqrt()
}

/// A flat punch that does not slip carries `(1 - nu) ln(3 - 4 nu)/(1 - 2 nu)` times the force of one without
/// friction (Mossakovskii; D. A. Spence, Proc. R. Soc. A 305, 55 (1968)): first order, as the traction at its
/// edge.
#[test]
fn a_punch_without_slip_is_spences() {
    for nu in [0.0_f64, 0.2, 0.3, 0.4] {
        let exact = (1.0 - nu) * (3.0 - 4.0 * nu).ln() / (1.0 - 2.0 * nu);
        let found = [32, 64, 128].map(|cells| {
            let scene = coupled(punch(), on_rigid(nu), 1e3);
            let model = Bem3d { cells, tolerance: 1e-7, ..Bem3d::default() };
            let load = Load::approach(1e-3);
            let mut smooth = scene.clone();
            (smooth.effects, smooth.outputs) = (Effects::default(), Outputs::default());
            let without = model.prepare(&smooth, 0).unwrap().solve(load).unwrap().force;
            let state = model.prepare(&scene, 0).unwrap().advance(pressed(load)).unwrap();
            assert!(stick_share(&state) >= 1.0);
            state.force / without / exact - 1.0
        });
        println!("{nu}: {found:?}");
        let limit = 2.0 * found[2] - found[1];
        assert!(found[2].abs() < 7e-4 && found[2].abs() < 0.8 * found[0].abs(), "{found:?}");
        assert!(limit.abs() < 0.25 * found[1].abs(), "{limit} of {found:?}");
    }
}

/// `K'(k)`, the complete elliptic integral of the complementary modulus, by the arithmetic and geometric mean.
fn elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, k);
    for _ in 0..8 {
        (a, b) = (f64::midpoint(a, b), (a * b).sqrt());
    }
    0.5 * PI / a
}

/// c/a without normal displacements under tractions, by bisection of
/// `a/(2 c) ln((a + c)/(a - c)) = mu/beta K'(c/a)`.
///
/// Radial tractions q of a punch make `u_r = (2/(pi r)) int_0^r t^2 S/(r^2 - t^2)^(1/2) dt` with
/// `S = int_t^a q/(s^2 - t^2)^(1/2) ds` (units of E*/2), the pressure `P/(a^2 - r^2)^(1/2)` makes
/// `beta P (a - (a^2 - r^2)^(1/2))/r`. Both are equal below c: `S = beta P/(2 t) ln((a + t)/(a - t))`; in slip, `q = mu p`,
/// `S = mu P K'(t/a)/a`. S is continuous at c.
fn goodman(mu_over_beta: f64) -> f64 {
    let (mut low, mut high) = (1e-9_f64, 1.0 - 1e-12);
    for _ in 0..100 {
        let c = f64::midpoint(low, high);
        let rest = ((1.0 + c) / (1.0 - c)).ln() / (2.0 * c) - mu_over_beta * elliptic(c);
        *(if rest > 0.0 { &mut high } else { &mut low }) = c;
    }
    low
}

/// In partial slip c/a depends on mu and Poisson's ratio alone. The normal displacements under tractions are
/// neglected above: the difference is of second order in beta, and does not vanish at beta = 1/2.
#[test]
fn a_punch_that_slips_at_its_edge_tends_to_goodmans_radius() {
    let (share, cells) = (0.6, 96);
    let exact = goodman(share);
    for nu in [0.0, 0.3, 0.4, 0.45] {
        let pair = on_rigid(nu);
        let beta = pair.coupling().unwrap().abs();
        let model = Bem3d { cells, tolerance: 1e-7, ..Bem3d::default() };
        let found = [1e-3, 0.1].map(|force| {
            let mut contact = model.prepare(&coupled(punch(), pair, share * beta), 0).unwrap();
            stick_share(&contact.advance(pressed(Load::force(force))).unwrap())
        });
        println!("nu {nu}: {found:?}, {exact}");
        assert!((found[0] - found[1]).abs() < 1e-12, "{found:?}");
        let off = exact - found[0];
        assert!(off.abs() < 0.6 * beta * beta + 0.3 / cells as f64, "{nu}: {off}");
        assert!(nu > 0.0 || off > 0.1, "{off}");
    }
}

/// c/a does not depend on the profile, nor on the load (D. A. Spence, J. Elasticity 5, 297 (1975)): a punch
/// in one step, a cone and a sphere in many steps, because the slip reference of a cell is set when it comes
/// into contact. First order in the step.
#[test]
fn the_radius_that_sticks_depends_on_neither_profile_nor_load() {
    let (pair, mu) = (on_rigid(0.3), 0.15);
    let model = Bem3d { cells: 64, tolerance: 1e-6, ..Bem3d::default() };
    let mut contact = model.prepare(&coupled(punch(), pair, mu), 0).unwrap();
    let flat = stick_share(&contact.advance(pressed(Load::force(1e-3))).unwrap());
    let contact_modulus = pair.contact_modulus().unwrap();
    // The force at a radius of 0.4, and its power of the radius.
    let cone = (Surface::Cone { slope: 0.1, size: 1.0.into() }, 0.05 * PI * contact_modulus * 0.16, 2.0);
    let sphere =
        (Surface::Sphere { radius: 1.0, size: 1.0.into() }, 4.0 / 3.0 * contact_modulus * 0.064, 3.0);
    for (surface, most, power) in [cone, sphere] {
        let scene = coupled(surface, pair, mu);
        let off = [8_u32, 32].map(|steps| {
            let mut contact = model.prepare(&scene, 0).unwrap();
            let shares = (1..=steps).map(|i| {
                let radius = f64::from(i) / f64::from(steps);
                let state = contact.advance(pressed(Load::force(most * radius.powf(power)))).unwrap();
                stick_share(&state)
            });
            // The last quarter, of radii from 19 cells on.
            let last = shares.skip(steps as usize * 3 / 4);
            last.fold(0.0, |worst: f64, share| worst.max((share - flat).abs()))
        });
        println!("{power}: {off:?} of {flat}");
        assert!(off[1] < 0.014 && off[1] < 0.5 * off[0], "{off:?} of {flat}");
    }
}

/// Around a closed loop of approach and displacement the work of both loads equals the energy that friction
/// dissipates; no loop gains energy. The error of the trapezoidal rule is of first order in the step, as that
/// of the increments.
#[test]
fn a_coupled_loop_never_gains_energy() {
    let corners = [[1.0, 0.0, 0.0], [1.5, 0.3, 0.0], [1.2, 0.3, 0.3], [0.8, -0.2, 0.0], [1.0, 0.0, 0.0]];
    for nu in [0.0, 0.3] {
        let map = tests::stability::rough_map(2.3, 16, 3).unwrap();
        let mut scene = coupled(Surface::Heights(Arc::new(map)), on_rigid(nu), 0.4);
        scene.outputs = Outputs::default();
        let excess = [4_u32, 12, 36].map(|steps| {
            let mut contact = Bem3d { tolerance: 1e-9, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
            let mut at = |[d, x, y]: [f64; 3]| {
                let tangential = Tangential::Displacement([x, y]);
                let state =
                    contact.advance(Step::new(0.0, Load::approach(d).with_tangential(tangential))).unwrap();
                let found = state.tangential.unwrap();
                ([state.force, found.force[0], found.force[1]], found.dissipated)
            };
            let (mut before, mut lost) = at(corners[0]);
            let mut works = Vec::new();
            for _ in 0..2 {
                let (mut work, begin) = (0.0, lost);
                for ends in corners.windows(2) {
                    let step: [f64; 3] =
                        std::array::from_fn(|k| (ends[1][k] - ends[0][k]) / f64::from(steps));
                    for i in 1..=steps {
                        let (forces, dissipated) =
                            at(std::array::from_fn(|k| ends[0][k] + f64::from(i) * step[k]));
                        work += (0..3).map(|k| 0.5 * (forces[k] + before[k]) * step[k]).sum::<f64>();
                        // But for the gap that the tolerance leaves, of displacements below 1.
                        assert!(dissipated >= lost - 1e-9 * 0.4 * forces[0], "{dissipated} after {lost}");
                        (before, lost) = (forces, dissipated);
                    }
                }
                assert!(work > 0.0, "{work}");
                works.push(work / (lost - begin) - 1.0);
            }
            works[1]
        });
        println!("nu {nu}: {excess:?}");
        assert!(excess[2] > 0.0 && excess[2] < 0.015, "{excess:?}");
        assert!(excess[2] < 0.5 * excess[1] && excess[1] < 0.6 * excess[0], "{excess:?}");
    }
}
