//! Input that makes no sense, and numbers at the ends of their range.

use super::*;
use contact_model::Result;

fn message<T: std::fmt::Debug>(result: Result<T>) -> String {
    result.unwrap_err().to_string()
}

fn uniform(value: f64) -> SurfaceLoad {
    SurfaceLoad::new(Field::new([4, 3], [4.0, 3.0], vec![value; 12]).unwrap()).unwrap()
}

#[test]
fn depths_and_points_outside_of_the_body() {
    let (load, body) = (uniform(1.0), StressedBody::new(0.3));
    for depth in [f64::NAN, f64::INFINITY, -1e-9] {
        let at = |depths: &[f64]| message(stress_at_depths(&load, body, depths, &never));
        assert!(at(&[0.0, depth]).starts_with("depths[1] = "), "{}", at(&[0.0, depth]));
        assert!(largest_von_mises(&load, body, &[depth], &never).is_err());
        assert!(stress_section(&load, body, SectionLine::Row(0), &[depth], &never).is_err());
        let points = |z: f64| message(stress_at_points(&load, body, &[[0.0, 0.0, z]], &never));
        assert!(points(depth).starts_with("points[0].z = "));
    }
    assert!(
        message(stress_at_depths(&load, body, &[1e80], &never)).ends_with("at most 1e60 sides of a cell")
    );
    let x = stress_at_points(&load, body, &[[0.0; 3], [f64::NAN, 0.0, 0.0]], &never);
    assert_eq!(message(x), "points[1].x = NaN: expected a finite number");
    assert!(stress_at_points(&load, body, &[[1e80, 0.0, 0.0]], &never).is_err());
    assert!(stress_at_depths(&load, body, &[], &never).unwrap().is_empty());
    assert!(stress_at_points(&load, body, &[], &never).unwrap().is_empty());
    let none = message(largest_von_mises(&load, body, &[], &never));
    assert_eq!(none, "depths has 0 values: expected at least one depth");
    assert!(
        message(stress_section(&load, body, SectionLine::Column(4), &[], &never)).starts_with("column = 4")
    );
    // As far as coordinates may be.
    let far = stress_at_points(&load, body, &[[1e60, 0.0, 0.0], [0.0, 0.0, 1e60]], &never).unwrap();
    assert!(far.as_flattened().iter().all(|value| value.is_finite()));
    assert!(stress_at_depths(&load, body, &[1e59], &never).is_ok());
}

#[test]
fn bodies_and_loads_that_make_no_sense() {
    for nu in [-0.1, 0.501, f64::NAN, f64::INFINITY] {
        let body = StressedBody::new(nu);
        assert!(message(stress_at_depths(&uniform(1.0), body, &[0.0], &never)).starts_with("poisson = "));
        assert!(
            message(stress_at_points(&uniform(1.0), body, &[[0.0; 3]], &never)).starts_with("poisson = ")
        );
    }
    let field = |value: f64| Field::new([2, 2], 1.0, vec![0.0, 0.0, value, 0.0]).unwrap();
    for value in [f64::NAN, f64::INFINITY] {
        assert!(message(SurfaceLoad::new(field(value))).starts_with("pressure[1, 0] = "));
        let load = SurfaceLoad::with_traction(field(1.0), [field(1.0), field(value)]);
        assert!(message(load).starts_with("traction along y[1, 0] = "));
    }
    let other = Field::new([2, 3], 1.0, vec![0.0; 6]).unwrap();
    let load = SurfaceLoad::with_traction(field(1.0), [field(1.0), other]);
    assert_eq!(
        message(load),
        "traction along y has 6 values: expected 2 rows x 2 columns, those of the pressure"
    );
    let larger = Field::new([2, 2], 2.0, vec![0.0; 4]).unwrap();
    let load = SurfaceLoad::with_traction(field(1.0), [larger, field(1.0)]);
    assert_eq!(message(load), "side along x of the traction along x = 2: expected 1, that of the pressure");
    for &boundary in &Boundary::ALL[1..] {
        let body = StressedBody { boundary, ..StressedBody::new(0.3) };
        assert!(matches!(stress_at_points(&uniform(1.0), body, &[], &never), Err(Error::Unsupported { .. })));
    }
}

#[test]
fn no_load_has_no_stress() {
    for &boundary in Boundary::ALL {
        let body = StressedBody { boundary, ..StressedBody::new(0.3) };
        let largest = largest_von_mises(&uniform(0.0), body, &[0.0, 1.0], &never).unwrap();
        assert!(largest.value <= 0.0 && largest.stress.iter().all(|component| component.abs() <= 0.0));
        assert_eq!(largest.factor_until_yield(1.0).unwrap(), None);
        assert!(largest.factor_until_yield(0.0).is_err() && largest.factor_until_yield(f64::NAN).is_err());
    }
    let points = stress_at_points(&uniform(0.0), StressedBody::new(0.3), &[[1.0; 3]], &never).unwrap();
    assert_eq!(points, [[0.0; 6]]);
}

#[test]
fn any_unit_gives_the_same_stress() {
    let load = |pressure: f64, length: f64| {
        let scaled = |field: &Field| {
            let values = field.values().iter().map(|value| value * pressure).collect();
            Field::new([6, 5], [3.0 * length, 2.0 * length], values).unwrap()
        };
        changed(&full_load([6, 5], [3.0, 2.0], 3), |_, field| scaled(field))
    };
    for &boundary in Boundary::ALL {
        let body = StressedBody { boundary, ..StressedBody::new(0.3) };
        let expected = at_depth(&load(1.0, 1.0), body, 0.1);
        for pressure in [1e-300, 1e300] {
            for length in [1e-300, 1e300] {
                let found = at_depth(&load(pressure, length), body, 0.1 * length);
                let found: Vec<[f64; 6]> =
                    found.into_iter().map(|stress| stress.map(|s| s / pressure)).collect();
                assert!(relative_difference(&expected, &found) < 10.0 * TRANSFORM, "{boundary:?}");
            }
        }
    }
    // Beside a jump of the traction the stress is larger than the traction, and here than any number.
    let values = (0..1024).map(|i| if i % 32 < 16 { 1.7e308 } else { -1.7e308 }).collect();
    let none = || Field::new(32, 32.0, vec![0.0; 1024]).unwrap();
    let load = SurfaceLoad::with_traction(none(), [Field::new(32, 32.0, values).unwrap(), none()]).unwrap();
    let error = message(stress_at_depths(&load, StressedBody::new(0.3), &[1e-3], &never));
    assert!(error.contains("choose other units"), "{error}");
    assert!(stress_at_points(&load, StressedBody::new(0.3), &[[16.0, 16.0, 1e-9]], &never).is_err());
}

#[test]
fn long_work_stops() {
    let load = uniform(1.0);
    for &boundary in Boundary::ALL {
        let body = StressedBody { boundary, ..StressedBody::new(0.3) };
        for answers in [0, 1, 2, 5] {
            let asked = std::cell::Cell::new(0);
            let stop = || {
                asked.set(asked.get() + 1);
                asked.get() > answers
            };
            let result = stress_at_depths(&load, body, &[0.1; 100], &stop);
            assert!(matches!(result, Err(Error::Stopped { best: None })), "{boundary:?} {answers}");
            assert!(asked.get() <= answers + 2);
        }
    }
    let result = stress_at_points(&load, StressedBody::new(0.3), &[[0.0; 3]; 4], &|| true);
    assert!(matches!(result, Err(Error::Stopped { best: None })));
}

#[test]
fn what_no_machine_has_is_refused() {
    let load = uniform(1.0);
    // A section of 1e14 stresses.
    let depths = std::iter::repeat_n(0.1, 3).collect::<Vec<_>>();
    assert!(stress_section(&load, StressedBody::new(0.3), SectionLine::Row(0), &depths, &never).is_ok());
    // Copies of cells that are 1e4 as long as wide need free rows for 5.6 periods beside them.
    let long = Field::new([40_000, 1], [4e8, 1.0], vec![1.0; 40_000]).unwrap();
    let load = SurfaceLoad::new(long).unwrap();
    let body = StressedBody { boundary: Boundary::PeriodicAlongX, ..StressedBody::new(0.3) };
    let error = message(stress_at_depths(&load, body, &[0.1], &never));
    assert!(error.starts_with("the stress below a map of 40000 columns x 1 rows"), "{error}");
}
