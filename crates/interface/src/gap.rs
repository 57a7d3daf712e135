//! The gap of a state, and how far it is from that of the exact solution on the same cells.

use contact_model::{ContactState, Error, Field, NormalLoad, Result};

/// The gap of a state, 0 in contact.
///
/// In cells in contact the solver leaves a small gap of either sign. Contact is therefore where a cell bears a
/// pressure, and where its gap is not larger than the largest one of these cells. Percolation and leakage take this
/// gap.
///
/// Cost: O(N) for N cells.
///
/// # Errors
/// [`Error::Shape`] for a state without the fields of the gap and of the pressure, which have to be requested of the
/// model.
///
/// ```
/// use contact_model::{ContactState, Field, Fields, SolveReport};
/// let mut fields = Fields::default();
/// fields.pressure = Some(Field::new([3, 1], [3.0, 1.0], vec![2.0, 0.0, 1.0])?);
/// fields.gap = Some(Field::new([3, 1], [3.0, 1.0], vec![1e-17, 0.5, -2e-17])?);
/// let state = ContactState::new(3.0, SolveReport::exact("by hand")).with_fields(fields);
/// assert_eq!(interface::open_gap(&state)?.values(), [0.0, 0.5, 0.0]);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn open_gap(state: &ContactState) -> Result<Field> {
    let (gap, pressure) = gap_and_pressure(state)?;
    let cells = || gap.values().iter().zip(pressure.values());
    let left = cells().filter(|(_, p)| **p > 0.0).fold(0.0_f64, |largest, (g, _)| largest.max(g.abs()));
    let open = |(&g, &p): (&f64, &f64)| if p > 0.0 || g <= left { 0.0 } else { g };
    Field::new(gap.cells(), gap.size(), cells().map(open).collect())
}

/// How far the gap of any cell is at most from that of the exact solution on the same cells, under the normal force
/// or the approach of the state. It holds for elastic half-spaces without adhesion and without plastic flow; `None`
/// where a mean gap is prescribed, which bounds no single gap.
///
/// A cell that bears a pressure has to have no gap, and no other cell a negative one. What a state leaves of this
/// is at most v. The pressures of the state are then the exact ones of heights that differ from the given ones by v
/// at most. Displacements of a half-space grow with each height, and by no more than the largest change of all
/// heights, where the inverse of its kernel has no positive entry beside its diagonal and no negative sum of a row:
/// it was so on every set of cells that was tried. So the displacements, and with them the gaps, are those of the exact solution to v:
///
/// * with a prescribed approach, and under a force with periodic boundaries, the error is at most v;
/// * under a force with free boundaries the approach has an error of at most v, and the gap one of at most 3 v.
///
/// Cost: O(N) for N cells.
///
/// # Errors
/// As [`open_gap`].
pub fn gap_error(state: &ContactState, prescribed: NormalLoad) -> Result<Option<f64>> {
    let (gap, pressure) = gap_and_pressure(state)?;
    let cells = gap.values().iter().zip(pressure.values());
    let left = cells.map(|(&g, &p)| if p > 0.0 { g.abs() } else { (-g).max(0.0) }).fold(0.0, f64::max);
    Ok(match prescribed {
        NormalLoad::Approach(_) => Some(left),
        NormalLoad::Force(_) if state.approach.is_none() => Some(left),
        NormalLoad::Force(_) => Some(3.0 * left),
        _ => None,
    })
}

fn gap_and_pressure(state: &ContactState) -> Result<(&Field, &Field)> {
    let missing = |field: &'static str| {
        let expected = format!("those of a map: request the output {field}").into();
        Error::Shape { name: field.into(), found: 0, expected }
    };
    let gap = state.gap().ok_or_else(|| missing("gap"))?;
    Ok((gap, state.pressure().ok_or_else(|| missing("pressure"))?))
}
