//! Agreement with CONTACT, the program of E. A. H. Vollebregt and J. J. Kalker, on its own examples: every
//! number to the last digit that it prints. Numbers and their source are in data/peers.

use crate::committed::{number, rows};
use bem3d::Bem3d;
use contact_model::{
    Body, ContactModel, ContactState, Coupling, Field, Friction, HeightMap, Load, Outputs, Pair,
    PreparedContact, Scene, Step, StickSlip, Surface, Tangential,
};

/// CONTACT stops at relative changes of 1e-4 to 1e-7; this is well below the digits that it prints.
const TOLERANCE: f64 = 1e-9;
/// Energies are printed in J; forces are in N and lengths in mm.
const JOULES: f64 = 1e-3;

/// A paraboloid with the heights `-curvature (x^2 + y^2)` at the centres of the cells of a grid as CONTACT
/// defines it: numbers of cells, left lower corner, and side of a cell.
fn paraboloid(curvature: f64, cells: [usize; 2], corner: [f64; 2], side: f64) -> HeightMap {
    let size = cells.map(|n| n as f64 * side);
    let at = |i: usize, corner: f64| corner + (i as f64 + 0.5) * side;
    HeightMap::from_fn(cells, size, |ix, iy| {
        -curvature * (at(ix, corner[0]).powi(2) + at(iy, corner[1]).powi(2))
    })
    .unwrap()
}

/// A body by its shear modulus and Poisson's ratio.
fn body(shear: f64, poisson: f64) -> Body {
    Body::Elastic { young: 2.0 * shear * (1.0 + poisson), poisson }
}

fn prepared(map: HeightMap, pair: Pair, friction: Friction) -> Box<dyn PreparedContact> {
    let mut scene = Scene::of_pair(Surface::Heights(map.into()), pair).unwrap();
    scene.effects.friction = friction;
    let fields = Outputs { pressure: true, displacement: true, gap: true, ..Outputs::default() };
    scene.outputs = match scene.effects.friction {
        Friction::Off => fields,
        _ => Outputs { traction: true, slip: true, stick_slip: true, ..fields },
    };
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }.prepare(&scene, 0).unwrap()
}

/// Whether a number is the printed one, to half a unit of its last digit.
fn printed(found: f64, text: &str) -> bool {
    printed_with_error(found, text, 0.0)
}

/// The same for a number of a relative error, which the rounding to the printed digits may have amplified.
fn printed_with_error(found: f64, text: &str, error: f64) -> bool {
    let (mantissa, exponent) = text.split_once('E').unwrap_or((text, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let unit = 10_f64.powi(exponent.parse::<i32>().unwrap() - i32::try_from(digits).unwrap());
    (found - text.parse::<f64>().unwrap()).abs() <= 0.5 * unit + error * found.abs()
}

fn assert_printed(name: &str, found: f64, text: &str) {
    assert!(printed(found, text), "{name}: {found:e}, and CONTACT prints {text}");
}

fn largest(field: &Field) -> f64 {
    field.values().iter().copied().fold(0.0, f64::max)
}

/// Numbers of cells that are in contact, stick, and slip.
fn counts(state: &ContactState) -> [usize; 3] {
    let classes = state.fields.as_ref().unwrap().stick_slip.as_ref().unwrap().values();
    let [stick, slip] = [StickSlip::Stick, StickSlip::Slip]
        .map(|class| classes.iter().filter(|&&value| (value - class.value()).abs() < 0.5).count());
    [state.report.contact_cells.unwrap(), stick, slip]
}

/// Cattaneo's problem on equal bodies, cell by cell (examples/cattaneo, second case): the normal force, then a
/// tangential one of 7/8 of the sliding force in one increment.
#[test]
fn cattaneos_sphere_cell_by_cell() {
    let (force, mu, side) = (9.1954, 0.4, 0.13333);
    let ball = paraboloid(0.01, [19, 19], [-1.26667; 2], side);
    let polyethylene = body(200.0, 0.42);
    let pair = Pair { first: polyethylene, second: polyethylene };
    let mut contact = prepared(ball, pair, Friction::coulomb(mu));
    let pressed = contact.advance(Step::new(0.0, Load::force(force))).unwrap();
    assert_printed("elastic energy, pressed", energy(&pressed), "7.350E-05");
    let tangential = Tangential::force_along_x(-0.875 * mu * force);
    let state = contact.advance(Step::new(0.0, Load::force(force).with_tangential(tangential))).unwrap();

    assert_eq!(counts(&state), [177, 45, 132]);
    assert_printed("approach", state.approach.unwrap(), "1.998E-02");
    assert_printed("largest pressure", largest(state.pressure().unwrap()), "4.393");
    let found = state.tangential.unwrap();
    assert_printed("shift along x", -found.displacement[0], "8.155E-03");
    assert_printed("shift along y", found.displacement[1], "0.000");
    assert_printed("elastic energy", energy(&state), "8.525E-05");
    assert_printed("work of friction", found.dissipated * JOULES, "2.750E-06");

    let fields = state.fields.as_ref().unwrap();
    let pressure = fields.pressure.as_ref().unwrap();
    let polar = |[x, y]: [&Field; 2], at: [usize; 2]| {
        let [x, y] = [x, y].map(|field| field.at(at[0], at[1]));
        (x.hypot(y), y.atan2(x).to_degrees())
    };
    let [traction, slip] = [&fields.traction, &fields.slip].map(|pair| pair.as_ref().unwrap().each_ref());
    let cells = rows("data/peers/contact-cattaneo.csv");
    assert_eq!(cells.len(), 177);
    for row in &cells {
        // CONTACT counts columns and rows from 1.
        let at = ["column", "row"].map(|name| row[name].parse::<usize>().unwrap() - 1);
        assert_printed("pressure", pressure.at(at[0], at[1]), &row["pressure"]);
        let (size, angle) = polar(traction, at);
        assert_printed("traction", size, &row["traction"]);
        assert_angle("angle of the traction", angle, &row["traction_angle"]);
        let (size, angle) = polar(slip, at);
        assert_printed("slip", size, &row["slip"]);
        let class = fields.stick_slip.as_ref().unwrap().at(at[0], at[1]);
        if number(row, "slip") > 0.0 {
            // CONTACT's slip has the opposite sign.
            assert_angle("angle of the slip", angle, &row["traction_angle"]);
            assert!(class >= StickSlip::Slip.value(), "{row:?}");
        } else {
            assert!(class <= StickSlip::Stick.value(), "{row:?}");
        }
    }
}

fn assert_angle(name: &str, found: f64, text: &str) {
    let turned = [-360.0, 0.0, 360.0].into_iter().any(|turn| printed(found + turn, text));
    assert!(turned, "{name}: {found}, and CONTACT prints {text}");
}

/// Elastic energy of a contact whose cells have slipped from nothing in one increment, in J: half of the forces
/// times their displacements.
fn energy(state: &ContactState) -> f64 {
    let fields = state.fields.as_ref().unwrap();
    let [pressure, displacement] =
        [&fields.pressure, &fields.displacement].map(|field| field.as_ref().unwrap());
    let products = |a: &Field, b: &dyn Fn(usize) -> f64| -> f64 {
        a.values().iter().enumerate().map(|(i, value)| value * b(i)).sum()
    };
    let mut sum = products(pressure, &|i| displacement.values()[i]);
    let delta = state.tangential.unwrap().displacement;
    let [traction, slip] = [&fields.traction, &fields.slip].map(|pair| pair.as_ref().unwrap());
    for axis in 0..2 {
        sum += products(&traction[axis], &|i| delta[axis] - slip[axis].values()[i]);
    }
    0.5 * sum * pressure.dx() * pressure.dy() * JOULES
}

/// The contact from which CONTACT begins to roll (examples/catt_to_cart, cases 1, 115, and 58 on more columns). In
/// its other 168 cases the ball moves over the tractions that it leaves, which nothing here models.
#[test]
fn the_sphere_before_it_rolls() {
    let (force, mu) = (0.4705, 0.4013);
    let alike = body(1.0, 0.28);
    for columns in [34, 90] {
        let ball = paraboloid(0.002_963, [columns, 33], [-4.125; 2], 0.25);
        let mut contact = prepared(ball, Pair { first: alike, second: alike }, Friction::coulomb(mu));
        let tangential = Tangential::force_along_x(-0.657 * mu * force);
        let state = contact.advance(Step::new(0.0, Load::force(force).with_tangential(tangential))).unwrap();
        assert_eq!(counts(&state), [621, 305, 316]);
        assert_printed("approach", state.approach.unwrap(), "7.258E-02");
        assert_printed("largest pressure", largest(state.pressure().unwrap()), "1.834E-02");
        let found = state.tangential.unwrap();
        assert_printed("tangential force", found.force[0], "-0.1240");
        assert_printed("shift along x", -found.displacement[0], "1.774E-02");
        assert_printed("elastic energy", energy(&state), "1.470E-05");
        assert_printed("work of friction", found.dissipated * JOULES, "1.261E-07");
    }
}

/// Spence's compression, with full coupling in 35 increments (examples/spence35).
#[test]
fn spences_compression_in_35_increments() {
    let map = paraboloid(0.004_116, [45, 45], [-4.4999; 2], 0.2);
    // The second body is 200 000 times as stiff, which CONTACT calls rigid.
    let pair = Pair { first: body(0.5, 0.0), second: body(1e5, 0.0) };
    let friction = Friction::coulomb(0.2986).with_coupling(Some(Coupling::Full));
    let mut contact = prepared(map.clone(), pair, friction);
    let increments = rows("data/peers/contact-spence.csv");
    assert_eq!(increments.len(), 35);
    let (mut dissipated, mut last) = (0.0, None);
    for row in &increments {
        let force = number(row, "force");
        let tangential = Tangential::Displacement([0.0; 2]);
        let state = contact.advance(Step::new(0.0, Load::force(force).with_tangential(tangential))).unwrap();
        assert_printed("approach", state.approach.unwrap(), &row["approach"]);
        assert_printed("largest pressure", largest(state.pressure().unwrap()), &row["largest_pressure"]);
        let found = state.tangential.unwrap();
        assert_printed("work of friction", (found.dissipated - dissipated) * JOULES, &row["friction_work"]);
        dissipated = found.dissipated;
        if !row["contact_cells"].is_empty() {
            let stated = ["contact_cells", "stick_cells", "slip_cells"];
            assert_eq!(
                counts(&state).map(|n| n.to_string()),
                stated.map(|name| row[name].clone()),
                "under {force}"
            );
        }
        last = Some(state);
    }
    let state = last.unwrap();
    assert_eq!(counts(&state), [921, 225, 696]);
    // The displacement is that of both bodies, and the gap is made of it, approach and height; CONTACT prints the
    // displacement of the first, with an accuracy of 1e-6.
    let of_the_first = 1.0 / (1.0 + 0.5 / 1e5);
    let (gap, displacement) = (state.gap().unwrap(), state.displacement().unwrap());
    let profile = rows("data/peers/contact-spence-displacement.csv");
    assert_eq!(profile.len(), map.columns());
    for (ix, row) in profile.iter().enumerate() {
        let height = map.heights()[22 * map.columns() + ix];
        let found = of_the_first * displacement.at(ix, 22);
        assert!(printed_with_error(found, &row["displacement"], 1e-6), "displacement: {found}, {row:?}");
        let moved = state.approach.unwrap() + height - map.highest() + gap.at(ix, 22);
        assert!((displacement.at(ix, 22) - moved).abs() < 1e-9 * moved, "{moved}");
    }

    // Without friction and on a rigid body, by an independent program.
    let pair = Pair { second: Body::Rigid, ..pair };
    let smooth = prepared(map, pair, Friction::Off).solve(Load::force(0.470_508)).unwrap();
    assert_eq!(smooth.report.contact_cells, Some(973));
    assert_printed("approach", smooth.approach.unwrap(), "0.1008115");
    assert_printed("largest pressure", largest(smooth.pressure().unwrap()), "0.0183430");
}
