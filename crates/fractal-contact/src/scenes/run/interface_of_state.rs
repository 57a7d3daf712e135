//! Reads off the interface of a state what the scene requests: leakage, percolation, stress below the surface.

use crate::scenes::read::{RequestedLeakage, RequestedStress, SceneFile};
use contact_model::{
    Boundary, ContactState, Effect, Error, Field, Fields, InterfaceState, LargestStress, LeakageState,
    NormalLoad, PathState, Result, Stop,
};
use interface::stress::{StressedBody, SubsurfaceStress, SurfaceLoad, largest_von_mises};
use interface::{FlowAxis, FlowBounds, FlowOptions, gap_error, leakage_until, open_gap, percolation};

/// Relative width of the bounds of flows whose difference is an error.
const ERROR_TOLERANCE: f64 = 1e-6;

/// The state with what is read off its interface. Its fields have to be there.
///
/// # Errors
/// Those of the crate `interface`; [`Error::Stopped`].
pub(crate) fn with_interface(
    scene: &SceneFile,
    prescribed: NormalLoad,
    mut state: ContactState,
    stop: Stop<'_>,
) -> Result<ContactState> {
    let requested = &scene.requested.interface;
    if requested.outputs().is_empty() {
        return Ok(state);
    }
    let boundary = scene.effects.boundary;
    let gap_error = if requested.needs_gap() && is_elastic_half_space(scene) {
        gap_error(&state, prescribed)?
    } else {
        None
    };
    let gap = requested.needs_gap().then(|| open_gap(&state)).transpose()?;
    let of_leakage = requested.leakage.zip(gap.as_ref());
    let of_paths = gap.as_ref().filter(|_| requested.percolation);
    let flow = of_leakage.map(|(of, gap)| Flow::new(gap, gap_error, of, boundary, stop)).transpose()?;
    let of_stress = requested.stress_below.as_ref();
    let stressed = of_stress.map(|of| stress(scene, &state, of, stop)).transpose()?;
    let read_off = InterfaceState {
        leakage: flow.as_ref().map(|flow| flow.numbers),
        percolation: of_paths.map(|gap| paths(gap, boundary)).transpose()?,
        stress: stressed.as_ref().map(|(largest, _)| *largest),
        gap_error,
    };
    let mut fields = state.fields.take().unwrap_or_default();
    if let Some(flow) = flow {
        (fields.fluid_pressure, fields.flux) = (Some(flow.pressure), Some(flow.flux));
    }
    fields.von_mises = stressed.and_then(|(_, field)| field);
    Ok(state.with_interface(read_off).with_fields(fields))
}

/// Whether the bound of the error of the gap holds: without what changes the kernel, the heights or the law of a
/// cell in normal contact.
fn is_elastic_half_space(scene: &SceneFile) -> bool {
    scene.effects.named().all(|effect| effect.key() == "friction" && effect != Effect::FullCoupling)
}

/// The flow of a fluid through a gap.
struct Flow {
    numbers: LeakageState,
    /// Pressure above that at the last edge.
    pressure: Field,
    /// Flow per width.
    flux: [Field; 2],
}

impl Flow {
    fn new(
        gap: &Field,
        gap_error: Option<f64>,
        of: RequestedLeakage,
        boundary: Boundary,
        stop: Stop<'_>,
    ) -> Result<Self> {
        let RequestedLeakage { viscosity, pressure_drop, along } = of;
        let found = leakage_until(gap, along, boundary, FlowOptions::default(), stop)?;
        let flow = found.flow_rate(pressure_drop, viscosity)?;
        let FlowBounds { lower, upper } = flow.continuum.unwrap_or(flow.network);
        // What is small in the error needs few digits.
        let options = FlowOptions { tolerance: ERROR_TOLERANCE, continuum: false };
        let shifted = |by: f64| -> Result<f64> {
            let mut gap = gap.clone();
            for g in gap.values_mut() {
                *g = (*g + by).max(0.0);
            }
            Ok(leakage_until(&gap, along, boundary, options, stop)?.network.middle())
        };
        let total = found.network.middle();
        let contact_error = match gap_error.filter(|_| total > 0.0) {
            Some(error) => Some(0.5 * (shifted(error)? - shifted(-error)?) / total),
            None => None,
        };
        let numbers = LeakageState {
            flow: flow.network.middle(),
            contact_error,
            error: 0.5 * flow.network.relative_width(),
            continuum: [lower, upper],
            flow_factor: found.flow_factor.map(FlowBounds::middle),
        };
        let scaled = |mut field: Field, factor: f64| {
            for value in field.values_mut() {
                *value *= factor;
            }
            field
        };
        let pressure = scaled(found.flow.potential, pressure_drop);
        let flux = found.flow.flux.map(|flux| scaled(flux, pressure_drop / (12.0 * viscosity)));
        Ok(Self { numbers, pressure, flux })
    }
}

fn paths(gap: &Field, boundary: Boundary) -> Result<[PathState; 2]> {
    let along = |axis| -> Result<PathState> {
        let found = percolation(gap, 0.0, axis, boundary)?;
        let cell = found.constriction;
        Ok(PathState {
            open: found.spans,
            contact: found.contact_spans,
            constriction: cell.gap,
            centre: (cell.gap > 0.0)
                .then_some([(cell.column as f64 + 0.5) * gap.dx(), (cell.row as f64 + 0.5) * gap.dy()]),
        })
    };
    Ok([along(FlowAxis::X)?, along(FlowAxis::Y)?])
}

/// The largest stress and, where it is requested, the stress at its depth.
fn stress(
    scene: &SceneFile,
    state: &ContactState,
    of: &RequestedStress,
    stop: Stop<'_>,
) -> Result<(LargestStress, Option<Field>)> {
    let (body, poisson) = of
        .of_body(scene.pair, scene.effects.friction)
        .map_err(|wrong| Error::unsupported("the stress below the surface", wrong.to_string()))?;
    let none = Fields::default();
    let load = SurfaceLoad::of_state(state.fields.as_ref().unwrap_or(&none), body)?;
    let body = StressedBody { boundary: scene.effects.boundary, ..StressedBody::new(poisson) };
    let found = largest_von_mises(&load, body, &of.depths, stop)?;
    let factor = of.yield_stress.map(|stress| found.factor_until_yield(stress)).transpose()?;
    let field = if scene.requested.von_mises.is_empty() {
        None
    } else {
        Some(SubsurfaceStress::new(&load, body)?.at_depth(found.depth, stop)?.von_mises()?)
    };
    let largest = LargestStress {
        von_mises: found.value,
        depth: found.depth,
        centre: found.centre,
        factor_until_yield: factor.flatten(),
    };
    Ok((largest, field))
}
