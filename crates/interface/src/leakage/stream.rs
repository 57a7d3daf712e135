//! The stream function of a flow between opposite edges.

use crate::axis::FlowAxis;
use contact_model::{Boundary, Cells, Field};

/// A function whose levels are the lines along which the fluid flows. Between two of them flows the difference of their
/// levels, so that levels at equal distances crowd where the flow is fast.
///
/// Its points lie between the cells across the flow and at their middles along it.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamFunction {
    /// Columns and rows of its points.
    pub points: Cells,
    /// Place (x, y) of its first point.
    pub origin: [f64; 2],
    /// Steps between points along x and along y.
    pub step: [f64; 2],
    /// Values, row-major: 0 at the first point, and larger by the whole flow at the other side of the map.
    pub values: Vec<f64>,
}

/// The stream function of a flux through cells, along x and along y per unit of width, as [`crate::SheetFlow::flux`] has
/// it.
///
/// Across the axis it is the sum of the flux, exactly. Along the axis no cell adds to it at an impermeable side; where the
/// map repeats across the axis, the flow over its edge is the mean of what all rows say. Cost O(N).
///
/// ```
/// use contact_model::{Boundary, Field};
/// use interface::{FlowAxis, conductance, stream_function};
/// let strips = Field::new(2, 1.0, vec![1.0, 1.0, 3.0, 3.0])?;
/// let flow = conductance(&strips, FlowAxis::X, Boundary::Free)?;
/// let stream = stream_function(&flow.flux, FlowAxis::X, Boundary::Free);
/// // A quarter of the flow passes the lower strip.
/// assert!((stream.values[2] / stream.values[4] - 0.25).abs() < 1e-9);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn stream_function(flux: &[Field; 2], along: FlowAxis, boundary: Boundary) -> StreamFunction {
    let Cells { columns, rows } = flux[0].cells();
    let (dx, dy) = (flux[0].dx(), flux[0].dy());
    let [repeats_x, repeats_y] = boundary.repeats();
    // Layers follow each other along the flow.
    let (layers, across, [step_along, step_across], repeats) = match along {
        FlowAxis::X => (columns, rows, [dx, dy], repeats_y),
        FlowAxis::Y => (rows, columns, [dy, dx], repeats_x),
    };
    let (flux_along, flux_across) = match along {
        FlowAxis::X => (&flux[0], &flux[1]),
        FlowAxis::Y => (&flux[1], &flux[0]),
    };
    let at = |field: &Field, layer: usize, place: usize| match along {
        FlowAxis::X => field.at(layer, place),
        FlowAxis::Y => field.at(place, layer),
    };
    // The flow past the first places of a layer.
    let past = |layer: usize| {
        let mut sum = 0.0;
        let mut values = vec![0.0];
        values.extend((0..across).map(|place| {
            sum += step_across * at(flux_along, layer, place);
            sum
        }));
        values
    };
    let mut of_layers: Vec<Vec<f64>> = Vec::with_capacity(layers);
    for layer in 0..layers {
        let mut values = past(layer);
        if let (true, Some(before)) = (repeats, of_layers.last()) {
            let rise = |place: usize| {
                let below = if place > 0 { place - 1 } else { across - 1 };
                let sides = [(layer - 1, below), (layer - 1, place), (layer, below), (layer, place)];
                let mean = 0.25 * sides.iter().map(|&(l, p)| at(flux_across, l, p)).sum::<f64>();
                before[place] - values[place] - step_along * mean
            };
            let offset = (0..across).map(rise).sum::<f64>() / across as f64;
            for value in &mut values {
                *value += offset;
            }
        }
        of_layers.push(values);
    }
    let (points, origin) = match along {
        FlowAxis::X => (Cells { columns, rows: rows + 1 }, [0.5 * dx, 0.0]),
        FlowAxis::Y => (Cells { columns: columns + 1, rows }, [0.0, 0.5 * dy]),
    };
    let values = match along {
        FlowAxis::X => {
            (0..=across).flat_map(|place| of_layers.iter().map(move |values| values[place])).collect()
        }
        FlowAxis::Y => of_layers.concat(),
    };
    StreamFunction { points, origin, step: [dx, dy], values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{FlowOptions, conductance_until};
    use contact_model::never;

    /// A diagonal strip of good conductors leads the flow over the edge where the map repeats: the slope of the function
    /// is the flux in both directions, and both sides differ by the whole flow.
    #[test]
    fn its_slopes_are_the_flux() {
        let n = 24;
        for boundary in [Boundary::Free, Boundary::Periodic] {
            for along in [FlowAxis::X, FlowAxis::Y] {
                let k = |i: usize| {
                    let (x, y) = (i % n, i / n);
                    if (x + n - y) % n < 6 { 1.0 } else { 0.1 }
                };
                let map = Field::new(n, [1.0, 2.0], (0..n * n).map(k).collect()).unwrap();
                let flow = conductance_until(&map, along, boundary, FlowOptions::default(), &never).unwrap();
                let stream = stream_function(&flow.flux, along, boundary);
                let value = |x: usize, y: usize| stream.values[y * stream.points.columns + x];
                let total = flow.network.middle();
                let largest = flow.flux.iter().flat_map(Field::values).fold(0.0_f64, |m, v| m.max(v.abs()));
                for i in 0..n {
                    let (low, high) = match along {
                        FlowAxis::X => (value(i, 0), value(i, n)),
                        FlowAxis::Y => (value(0, i), value(n, i)),
                    };
                    assert!((high - low - total).abs() < 1e-8 * total, "{boundary:?} {along:?}");
                }
                // Along the flow the slope is the other component, up to its change from cell to cell.
                let mut error = 0.0;
                for i in 1..n {
                    for j in 1..n {
                        let (slope, flux) = match along {
                            FlowAxis::X => (
                                (value(i, j) - value(i - 1, j)) / stream.step[0],
                                -[(i - 1, j - 1), (i - 1, j), (i, j - 1), (i, j)]
                                    .map(|(x, y)| flow.flux[1].at(x, y))
                                    .iter()
                                    .sum::<f64>()
                                    / 4.0,
                            ),
                            FlowAxis::Y => (
                                (value(j, i) - value(j, i - 1)) / stream.step[1],
                                -[(j - 1, i - 1), (j - 1, i), (j, i - 1), (j, i)]
                                    .map(|(x, y)| flow.flux[0].at(x, y))
                                    .iter()
                                    .sum::<f64>()
                                    / 4.0,
                            ),
                        };
                        error += (slope - flux).abs();
                    }
                }
                let mean = error / ((n - 1) * (n - 1)) as f64;
                assert!(mean < 0.05 * largest, "{boundary:?} {along:?} {mean} {largest}");
            }
        }
    }
}
