use super::*;
use contact_model::SelfAffine;
use surface_gen::self_affine_map;

/// A fit to one surface of 256 cells a side scatters by less; measured over the seeds below.
const SCATTER: f64 = 0.05;

#[test]
fn the_fractal_dimension_of_generated_surfaces_comes_back() {
    for dimension in [2.1, 2.3, 2.5, 2.7] {
        for seed in 0..3 {
            let surface = SelfAffine::new(dimension, 2e-3, 1e-6).unwrap();
            let map = self_affine_map(&surface, 256, seed).unwrap();
            let found = describe(&map).fractal_dimension().unwrap();
            assert!((found - dimension).abs() < SCATTER, "{dimension} {seed}: {found}");
        }
    }
}

#[test]
fn a_part_of_a_surface_is_not_periodic_and_keeps_its_dimension() {
    let map = self_affine_map(&SelfAffine::new(2.2, 1.0, 1.0).unwrap(), 512, 1).unwrap();
    let part = (0..256 * 256).map(|i| map.heights()[(i / 256) * 512 + i % 256]).collect();
    let part = HeightMap::new(256, 0.5, part).unwrap();
    let found = describe(&part);
    assert!((found.fractal_dimension().unwrap() - 2.2).abs() < SCATTER, "{found}");
    // Without the window the jump between the edges flattens the spectrum.
    let raw =
        hurst_from_spectrum(&radial_spectrum(&part).unwrap(), found.fitted[0], found.fitted[1]).unwrap();
    assert!((3.0 - raw - 2.2).abs() > SCATTER);
    // The window keeps the level of the spectrum: the same waves have the same density in the part and in the
    // whole, within the scatter of rings of a few hundred waves.
    let level = |d: &Description, q: f64| {
        let inside: Vec<f64> =
            d.spectrum.iter().filter(|p| p.0 > q && p.0 < 2.0 * q).map(|p| p.1.ln()).collect();
        inside.iter().sum::<f64>() / inside.len() as f64
    };
    let q = 32.0 * TAU;
    assert!((level(&found, q) - level(&describe(&map), q)).abs() < 0.3);
}

#[test]
fn small_and_flat_maps_have_no_dimension() {
    for map in [HeightMap::new(1, 1.0, vec![3.0]), HeightMap::new(64, 1.0, vec![3.0; 4096])] {
        let found = describe(&map.unwrap());
        assert_eq!(found.hurst, Err(Absent::NoHeight));
        assert!(found.rms_height <= 0.0 && found.rms_slope <= 0.0);
        assert!(found.to_string().contains("fractal dimension  not determined: all heights are equal"));
    }
}

#[test]
fn extreme_reliefs_stay_finite() {
    for unit in [1e-300, 1e300] {
        let heights = (0..64 * 64).map(|i| unit * f64::from((i * 37) % 101) / 101.0).collect();
        let found = describe(&HeightMap::new(64, 1.0, heights).unwrap());
        assert!(found.rms_height.is_finite() && found.rms_slope.is_finite());
    }
}

#[test]
fn rectangles_keep_their_dimension() {
    let map = self_affine_map(&SelfAffine::new(2.2, 1.0, 1.0).unwrap(), 512, 1).unwrap();
    let part = map.cropped(0..512, 100..300).unwrap();
    let found = describe(&part);
    assert_eq!((found.cells, found.size), (part.cells(), part.size()));
    assert!((found.fractal_dimension().unwrap() - 2.2).abs() < 2.0 * SCATTER, "{found}");
    // Two columns in one: cells of 2 x 1.
    let means = part.heights().chunks_exact(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let oblong = describe(&HeightMap::new([256, 200], part.size(), means).unwrap());
    assert!((oblong.fractal_dimension().unwrap() - 2.2).abs() < 2.0 * SCATTER, "{oblong}");
    let shown = oblong.to_string();
    assert!(
        shown.contains("cells              256 x 200")
            && shown.contains("cell               0.00390625 x 0.001953125"),
        "{shown}"
    );
    let strip = map.cropped(0..512, 0..20).unwrap();
    assert_eq!(describe(&strip).hurst, Err(Absent::FewWaves));
}

#[test]
fn undefined_points_have_no_spectrum() {
    let heights = vec![1.0, f64::NAN, 3.0, 5.0, f64::NAN, 3.0];
    let found = describe(&HeightMap::with_undefined([3, 2], [3.0, 1.0], heights).unwrap());
    assert_eq!((found.undefined, found.range), (2, [1.0, 5.0]));
    // Pairs of defined points: 1 to 5 and 3 to 3 along y over half a unit, none along x.
    assert!((found.rms_slope - 32.0_f64.sqrt()).abs() < 1e-14, "{found}");
    // Heights 1, 3, 5, 3 about their mean 3.
    assert!((found.rms_height - 2.0_f64.sqrt()).abs() < 1e-15);
    assert!(found.spectrum.is_empty() && found.hurst == Err(Absent::Undefined));
    assert!(found.to_string().contains("undefined points   2 of 6"), "{found}");
}
