//! A number with its estimated error, as tables show it.

use crate::scenes::run::StateRecord;
use crate::scenes::tell::columns;
use contact_model::Value;
use contact_model::quantities::StateQuantity;
use contact_model::units::{rounded, short};

/// What stands between a number and its error. Terminals and fonts without it are still in use: there it is
/// `+-`.
pub(crate) const PLUS_MINUS: &str = "±";
/// What the numbers behind it are where grids are compared, and where they are not.
pub(crate) const OF_GRID: &str = "The number behind ± is the estimated error of the grid and of the solver. Without ± \
                                 no error is estimated, or it does not change the digits shown.";
pub(crate) const OF_GRID_UNCONFIRMED: &str = "The number behind ± is the error of the grid and of the solver. It is estimated, not confirmed by a finer grid. Without ± no \
     error is estimated, or it does not change the digits shown.";
pub(crate) const OF_SOLVER: &str = "The number behind ± is the estimated error of the solver on these cells, steps of time included. It does not \
                                   contain the error of the grid, which `grid_error = true` in [outputs] estimates for loads that do not form a path.";

/// Quantities whose relative error on the cells that were solved is another quantity.
const SOLVER_ERRORS: [(&str, &str); 22] = [
    ("force", "force_error"),
    ("stiffness", "stiffness_error"),
    ("tangential_stiffness", "tangential_stiffness_error"),
    ("tangential_stiffness_y", "tangential_stiffness_error"),
    ("tangential_stiffness_stuck", "tangential_stiffness_error"),
    ("tangential_stiffness_stuck_y", "tangential_stiffness_error"),
    ("force", "force_time_error"),
    ("approach", "approach_time_error"),
    ("mean_gap", "mean_gap_time_error"),
    ("tangential_force", "tangential_force_time_error"),
    ("tangential_force_y", "tangential_force_time_error"),
    ("tangential_displacement", "tangential_displacement_time_error"),
    ("tangential_displacement_y", "tangential_displacement_time_error"),
    ("area", "area_time_error"),
    ("contact_fraction", "area_time_error"),
    ("leakage", "leakage_error"),
    ("leakage", "leakage_contact_error"),
    // A number of the gap is all that lies between them.
    ("flow_factor", "leakage_error"),
    ("flow_factor", "leakage_contact_error"),
    ("film_conductance", "film_conductance_error"),
    ("film_conductance_per_area", "film_conductance_error"),
    ("film_conductance_along", "film_conductance_along_error"),
];

/// The estimated relative error of a quantity of a state: that of the grid and that of the solver, as far as
/// they are known.
pub(crate) fn relative_error(record: &StateRecord, quantity: &StateQuantity) -> Option<f64> {
    // The contact fraction is the area over a constant.
    let compared = if quantity.name == "contact_fraction" { "area" } else { quantity.name };
    let of_grid =
        record.solved().and_then(|solved| solved.grid.as_ref()?.of(compared)).map(|found| found.error);
    let of_solver =
        SOLVER_ERRORS.iter().filter(|(name, _)| *name == quantity.name).filter_map(|(_, error)| {
            match columns::value(record, StateQuantity::named(error)?) {
                Value::Number(error) => Some(error),
                _ => None,
            }
        });
    let of_solver = of_solver.reduce(|sum, error| sum + error);
    match (of_grid, of_solver) {
        (None, None) => None,
        (of_grid, of_solver) => Some(of_grid.unwrap_or(0.0) + of_solver.unwrap_or(0.0)),
    }
}

/// A number with its error: of the error two digits where it begins with 1 or 2, else one, and of the number
/// those up to the same decimal place. An error that changes none of four digits is left out.
pub(crate) fn with_error(value: f64, error: f64) -> String {
    /// Numbers in these limits have no power of ten.
    const PLAIN: std::ops::Range<f64> = 1e-2..1e5;
    let power = |size: f64| if size > 0.0 { size.log10().floor() as i32 } else { i32::MIN };
    let size = power(value.abs());
    if !(value.is_finite() && error.is_finite() && error > 0.0)
        || size > i32::MIN && error < 0.5 * 10f64.powi(size - 3)
    {
        return short(value);
    }
    let rough = rounded(error, 2);
    let two = rough < 3.0 * 10f64.powi(power(rough));
    let error = rounded(error, if two { 2 } else { 1 });
    let place = power(error) - i32::from(two);
    // Of a number below its error one digit stays.
    let of_value = if size > i32::MIN { place.min(size) } else { place };
    let largest = value.abs().max(error);
    let shift = if PLAIN.contains(&largest) { 0 } else { power(largest) };
    let text = |number: f64, place: i32| {
        let decimals = (shift - place).max(0) as usize;
        let number =
            if place > shift { (number / 10f64.powi(place)).round() * 10f64.powi(place) } else { number };
        format!("{:.decimals$}", number / 10f64.powi(shift))
    };
    let both = format!("{} {PLUS_MINUS} {}", text(value, of_value), text(error, place));
    if shift == 0 { both } else { format!("({both})e{shift}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::quantities::{QUANTITIES, QuantityUnit, Role};

    #[test]
    fn a_number_and_its_error_end_at_the_same_place() {
        for (value, error, text) in [
            (170.2, 5.1, "170 ± 5"),
            (170.2, 0.96, "170 ± 1"),
            (170.2, 29.6, "170 ± 30"),
            (1234.0, 250.0, "1230 ± 250"),
            (0.123_456, 0.001_23, "0.1235 ± 0.0012"),
            (2.5, 2.325, "2.5 ± 2.3"),
            (-2.0, 0.138, "-2.00 ± 0.14"),
            (2.6, 340.0, "3 ± 300"),
            (0.0, 0.25, "0.00 ± 0.25"),
            // Smaller than the digits that are shown, unknown, or no number.
            (3.3, 4e-4, "3.300"),
            (3.3, 0.0, "3.300"),
            (3.3, f64::NAN, "3.300"),
            (4e-4, 1.2e-5, "(4.00 ± 0.12)e-4"),
            (1.7e-9, 5e-8, "(0.2 ± 5)e-8"),
            (2.51e7, 4.4e5, "(2.51 ± 0.04)e7"),
        ] {
            assert_eq!(with_error(value, error), text);
        }
    }

    #[test]
    fn errors_of_the_solver_are_relative_ones_of_quantities() {
        for (name, error) in SOLVER_ERRORS {
            let [of, error] = [name, error].map(|name| StateQuantity::named(name).unwrap());
            assert!(of.role == Role::Answer && error.unit == QuantityUnit::One, "{name}");
            assert!(error.meaning.contains("relative error"), "{}", error.meaning);
        }
        let residuals = QUANTITIES.iter();
        for residual in residuals.filter(|quantity| quantity.meaning.contains("relative error")) {
            assert!(SOLVER_ERRORS.iter().any(|(_, error)| *error == residual.name), "{}", residual.name);
        }
    }
}
