//! Periodic boundaries: bem3d compared with Westergaard, with Johnson, Greenwood and Higginson, with the free
//! square, and with itself.

use analytic::{Westergaard, westergaard};
use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{
    Boundary, ContactModel, Error, HeightMap, Load, Outputs, PreparedContact, Scene, SelfAffine, Surface,
};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

const AMPLITUDE: f64 = 0.01;

/// Largest relative error of k times the number of cells along a side. Half a cell too much or too little at
/// both edges changes k of a contact of the width c by `pi cot(pi c/2)/ln(1/r)` over the cells a side: 4.6,
/// 4.0 and 7.0 for r = 0.05, 0.3 and 0.8.
const FIRST_ORDER: f64 = 6.0;
/// Grids of the convergence study.
const CELLS: [usize; 4] = [32, 64, 128, 256];

fn periodic(surface: Surface) -> Scene {
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.boundary = Boundary::Periodic;
    (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
    scene
}

fn model(cells: usize, tolerance: f64) -> Bem3d {
    Bem3d { cells, tolerance, ..Bem3d::default() }
}

fn wave() -> Scene {
    periodic(Surface::Sine { amplitude: AMPLITUDE, wavelength: 1.0, size: 1.0.into() })
}

/// `D cos(2 pi x) cos(2 pi y)` on the unit square.
fn product(cells: usize) -> Scene {
    let cosine = |i: usize| (2.0 * PI * (i as f64 + 0.5) / cells as f64).cos();
    let heights = (0..cells * cells).map(|i| AMPLITUDE * cosine(i % cells) * cosine(i / cells)).collect();
    periodic(Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights).unwrap())))
}

fn rough(roll_off: Option<f64>) -> Surface {
    Surface::SelfAffine(SelfAffine { roll_off, ..SelfAffine::new(2.2, 1.0, 1.0).unwrap() })
}

#[test]
fn westergaard_with_an_order_of_convergence() {
    for ratio in [0.05, 0.3, 0.8] {
        let load = Load::force(ratio * PI * AMPLITUDE);
        let mut theory = Westergaard.prepare(&wave(), 0).unwrap();
        let exact =
            (theory.solve(load).unwrap().stiffness.unwrap(), theory.solve(load).unwrap().mean_gap.unwrap());
        let errors: Vec<(f64, f64)> = CELLS
            .map(|cells| {
                let mut contact = model(cells, 1e-9).prepare(&wave(), 0).unwrap();
                let state = contact.solve(load).unwrap();
                assert!(state.approach.is_none());
                let gap = contact.solve(load).unwrap().mean_gap.unwrap();
                ((state.stiffness.unwrap() / exact.0 - 1.0).abs(), (gap - exact.1).abs() / AMPLITUDE)
            })
            .into();
        // Both edges of contact fall anywhere within a cell: first order in k, with scatter. The gap is an
        // integral: second order.
        for (cells, (k, _)) in CELLS.iter().zip(&errors) {
            assert!(k * *cells as f64 <= FIRST_ORDER, "{ratio} {errors:?}");
        }
        assert!(errors[3].1 < errors[0].1 / 30.0, "{ratio} {errors:?}");
    }
}

#[test]
fn johnson_greenwood_higginson() {
    let full = westergaard::product_full_pressure(1.0, AMPLITUDE, 1.0).unwrap();
    // Full contact from p* on, not below.
    let cells = 192;
    let mut contact = model(cells, 1e-9).prepare(&product(cells), 0).unwrap();
    let area = |r: f64, contact: &mut Box<dyn PreparedContact>| {
        contact.solve(Load::force(r * full)).unwrap().area.unwrap()
    };
    assert_relative_eq!(area(1.001, &mut contact), 1.0, max_relative = 1e-12);
    assert!(contact.solve(Load::force(1.001 * full)).unwrap().stiffness.is_none());
    assert!(contact.solve(Load::force(1.001 * full)).unwrap().mean_gap.unwrap() < 1e-12);
    let open = 1.0 - area(0.99, &mut contact);
    assert_relative_eq!(open, westergaard::product_open_fraction(0.99).unwrap(), max_relative = 0.25);
    // Small contacts: Hertz on each crest, up to their mutual displacement of order r^(1/3).
    let r = 1e-3;
    let cells = 256;
    let state = model(cells, 1e-8).prepare(&product(cells), 0).unwrap().solve(Load::force(r * full)).unwrap();
    let stiffness = westergaard::product_small_stiffness(r).unwrap();
    assert_relative_eq!(state.stiffness.unwrap(), stiffness, max_relative = 0.15);
}

#[test]
fn a_small_contact_feels_its_images_as_points() {
    // 1/k = 1/k_free + 4 zeta(1/2) beta(1/2) / (pi E* L): the images of a force act on it as points on their
    // background.
    let flat = |cells: usize, wide: usize| {
        let mut heights = vec![-1.0; cells * cells];
        for i in 0..wide * wide {
            heights[(i / wide + 3) * cells + i % wide + 5] = 0.0;
        }
        Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights).unwrap()))
    };
    let mut misses = Vec::new();
    for cells in [64, 128] {
        let force = Load::force(1e-3);
        let alone =
            model(cells, 1e-10).prepare(&Scene::new(flat(cells, 4), 1.0), 0).unwrap().solve(force).unwrap();
        let images = model(cells, 1e-10).prepare(&periodic(flat(cells, 4)), 0).unwrap().solve(force).unwrap();
        let change = images.stiffness.unwrap().recip() - alone.stiffness.unwrap().recip();
        misses.push((change * PI / -3.900_264_9 - 1.0).abs());
    }
    assert!(misses[0] < 2e-3 && misses[1] < 0.3 * misses[0], "{misses:?}");
}

#[test]
fn moving_the_square_changes_nothing() {
    let cells = 40;
    let map = surface_gen::height_map(&rough(None), cells, 3).unwrap();
    let shifted = |dx: usize, dy: usize| {
        let at = |i: usize| (i / cells + dy) % cells * cells + (i % cells + dx) % cells;
        let heights = (0..cells * cells).map(|i| map.heights()[at(i)]).collect();
        periodic(Surface::Heights(Arc::new(HeightMap::new(cells, 1.0, heights).unwrap())))
    };
    for force in [0.01, 1.0, 20.0] {
        let solve = |scene: &Scene| {
            let mut contact = model(cells, 1e-10).prepare(scene, 0).unwrap();
            let state = contact.solve(Load::force(force)).unwrap();
            (
                state.stiffness.unwrap(),
                state.area.unwrap(),
                contact.solve(Load::force(force)).unwrap().mean_gap.unwrap(),
            )
        };
        let (here, there) = (solve(&shifted(0, 0)), solve(&shifted(17, 29)));
        assert_relative_eq!(here.0, there.0, max_relative = 1e-8);
        assert_relative_eq!(here.1, there.1, max_relative = 1e-12);
        assert_relative_eq!(here.2, there.2, max_relative = 1e-8);
    }
}

#[test]
fn stiffness_is_the_slope_of_the_mean_gap_in_every_way_of_solving() {
    // Odd, prime, even and good grid sizes; factors, lists and arrays.
    for (cells, force) in [(31, 0.2), (45, 3.0), (64, 30.0), (90, 50.0)] {
        let scene = periodic(rough(Some(4.0 * PI)));
        let mut values = Vec::new();
        for method in [Method::Auto, Method::Iterative, Method::SingleLevel] {
            let mut contact = Bem3d { method, ..model(cells, 1e-10) }.prepare(&scene, 1).unwrap();
            let state = contact.solve(Load::force(force)).unwrap();
            let k = state.stiffness.unwrap();
            let step = 1e-6 * force;
            let gap = |f: f64, contact: &mut Box<dyn PreparedContact>| {
                contact.solve(Load::force(f)).unwrap().mean_gap.unwrap()
            };
            let (above, below) = (gap(force + step, &mut contact), gap(force - step, &mut contact));
            assert_relative_eq!(2.0 * step / (below - above), k, max_relative = 2e-3);
            values.push((k, gap(force, &mut contact), state.area.unwrap()));
        }
        for value in &values[1..] {
            assert_relative_eq!(value.0, values[0].0, max_relative = 1e-9);
            assert_relative_eq!(value.1, values[0].1, max_relative = 1e-6);
            assert_relative_eq!(value.2, values[0].2, max_relative = 1e-12);
        }
    }
}

#[test]
fn a_mean_gap_is_a_load() {
    let scene = periodic(rough(None));
    let bare = Scene { outputs: Outputs::default(), ..scene.clone() };
    for force in [0.01, 0.5, 5.0] {
        let mut contact = model(48, 1e-9).prepare(&scene, 2).unwrap();
        let gap = contact.solve(Load::force(force)).unwrap().mean_gap.unwrap();
        for scene in [&scene, &bare] {
            let mut again = model(48, 1e-9).prepare(scene, 2).unwrap();
            let state = again.solve(Load::mean_gap(gap)).unwrap();
            assert_relative_eq!(state.force, force, max_relative = 1e-6);
            assert_eq!(state.mean_gap.is_some(), scene.outputs.mean_gap);
            // Within the tolerance, in rms heights.
            assert!(state.mean_gap.is_none_or(|found| (found - gap).abs() <= 1e-9));
        }
    }
}

#[test]
fn fields_obey_the_contact_conditions_everywhere() {
    let mut scene = periodic(rough(None));
    scene.outputs = Outputs { pressure: true, gap: true, displacement: true, ..scene.outputs };
    let mut contact = model(36, 1e-9).prepare(&scene, 5).unwrap();
    let load = Load::force(0.7);
    let fields = contact.solve(load).unwrap().fields.unwrap();
    let [p, gap, u] = [fields.pressure, fields.gap, fields.displacement].map(|f| f.unwrap().into_values());
    assert!(gap.iter().all(|&g| g > -1e-8), "no cell penetrates, near or far");
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    assert_relative_eq!(mean(&p), 0.7, max_relative = 1e-9);
    assert!(mean(&u).abs() < 1e-12, "displacements are counted from their mean");
    assert_relative_eq!(mean(&gap), contact.solve(load).unwrap().mean_gap.unwrap(), max_relative = 1e-9);
}

/// As in closed form (`analytic::Westergaard`): the state has no force, and the requested gap.
#[test]
fn a_mean_gap_beyond_first_touch_is_a_state_apart() {
    /// Rounding of the conversion of a gap into the units of the surface and back.
    const ROUNDING: f64 = 1e-13;
    let mut scene = periodic(rough(None));
    scene.outputs.gap = true;
    let mut contact = model(16, 1e-8).prepare(&scene, 0).unwrap();
    let first = contact.solve(Load::force(0.0)).unwrap().mean_gap.unwrap();
    for beyond in [1.0, 1.5, 1e3, 1e150] {
        let state = contact.solve(Load::mean_gap(beyond * first)).unwrap();
        assert_eq!((state.force, state.area, state.stiffness), (0.0, Some(0.0), Some(0.0)), "{beyond}");
        assert!(state.approach.is_none());
        assert_relative_eq!(state.mean_gap.unwrap(), beyond * first, max_relative = ROUNDING);
        let gap = state.gap().unwrap().values();
        let mean = gap.iter().map(|g| g / gap.len() as f64).sum::<f64>();
        assert_relative_eq!(mean, beyond * first, max_relative = ROUNDING);
        let least = gap.iter().copied().fold(f64::INFINITY, f64::min);
        assert_relative_eq!(least, (beyond - 1.0) * first, epsilon = ROUNDING * beyond * first);
    }
    assert!(contact.solve(Load::mean_gap(0.99 * first)).unwrap().force > 0.0);
}

#[test]
fn loads_that_a_periodic_square_takes_and_refuses() {
    let mut contact = model(16, 1e-8).prepare(&periodic(rough(None)), 0).unwrap();
    assert!(matches!(contact.solve(Load::approach(0.1)), Err(Error::Unsupported { .. })));
    assert!(matches!(contact.solve(Load::mean_gap(0.0)), Err(Error::Domain { .. })));
    let first = contact.solve(Load::force(0.0)).unwrap().mean_gap.unwrap();
    assert!(first > 1.0, "the mean depth below the highest point, in rms heights: {first}");
    let mut free = Scene::new(rough(None), 1.0);
    assert_eq!(model(16, 1e-8).prepare(&free, 0).unwrap().solve(Load::force(1.0)).unwrap().mean_gap, None);
    free.outputs.mean_gap = true;
    assert!(matches!(model(16, 1e-8).prepare(&free, 0), Err(Error::Unsupported { .. })));
    free.outputs.mean_gap = false;
    let mut free = model(16, 1e-8).prepare(&free, 0).unwrap();
    assert!(matches!(free.solve(Load::mean_gap(1.0)), Err(Error::Unsupported { .. })));
    // Flat: full contact at once, and no stiffness to speak of.
    let flat = periodic(Surface::Flat { size: 1.0.into() });
    for cells in [1, 2, 7] {
        let state = model(cells, 1e-8).prepare(&flat, 0).unwrap().solve(Load::force(1.0)).unwrap();
        assert!(state.stiffness.is_none() && state.report.certificate.stiffness_error.is_none());
        assert_relative_eq!(state.area.unwrap(), 1.0, max_relative = 1e-14);
    }
}

/// The area of the cells in contact of a resolved surface is too large by an error of first order, most of
/// which the correction for the boundary removes.
#[test]
fn the_corrected_area_converges_faster() {
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    surface.roll_off = Some(TAU / 0.5);
    surface.short_cutoff = Some(TAU * 16.0);
    let areas = |cells, force| {
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.effects.boundary = Boundary::Periodic;
        scene.outputs.area = true;
        let model = Bem3d { cells, tolerance: 1e-6, ..Bem3d::default() };
        let state = model.prepare(&scene, 3).unwrap().solve(Load::force(force)).unwrap();
        (state.area.unwrap(), state.resolution.unwrap().corrected_area.unwrap())
    };
    for force in [0.01, 0.03] {
        let (counted, corrected) = areas(64, force);
        let limit = 2.0 * areas(256, force).0 - areas(128, force).0;
        let (counted, corrected) = (counted / limit - 1.0, corrected / limit - 1.0);
        println!("counted {counted:+.3}, corrected {corrected:+.3}");
        assert!(corrected.abs() < 0.7 * counted, "{counted}, {corrected}");
    }
}
