//! Leakage, percolation and the stress below the surface of a state, as far as the scene requests them.

use crate::scenes::read::{Numerics, RequestedFilm, RequestedLeakage, RequestedStress, SceneFile};
use bem3d::{Film, PeriodicKernel, film_conductance_until};
use contact_model::{
    Boundary, ContactState, Effect, Error, Field, Fields, FilmState, InterfaceState, LargestStress,
    LeakageState, NormalLoad, PathState, Result, Stop,
};
use interface::stress::{
    PeriodicLoad, SectionLine, StressedBody, SubsurfaceStress, SurfaceLoad, largest_von_mises,
    stress_at_depths, stress_section, von_mises,
};
use interface::{
    FlowAxis, FlowBounds, FlowOptions, conductance_until, gap_error, leakage_until, open_gap, percolation,
};

/// Relative width of the bounds of the conductance with a film.
const FILM_TOLERANCE: f64 = 1e-8;

/// Relative width of the bounds of flows whose difference is an error.
const ERROR_TOLERANCE: f64 = 1e-6;

/// The state with its leakage, its paths and its stress below the surface. It has to have its fields.
///
/// # Errors
/// Those of the crate `interface`; [`Error::Stopped`].
pub(crate) fn with_interface(
    scene: &SceneFile,
    numerics: &Numerics,
    prescribed: NormalLoad,
    mut state: ContactState,
    stop: Stop<'_>,
) -> Result<ContactState> {
    let requested = &scene.requested.interface;
    if requested.outputs().is_empty() {
        return Ok(state);
    }
    let boundary = scene.effects.boundary;
    let gap_error = if requested.needs_gap() && is_elastic_half_space(scene, numerics) {
        gap_error(&state, prescribed)?
    } else {
        None
    };
    let gap = requested.needs_gap().then(|| open_gap(&state)).transpose()?;
    let of_leakage = requested.leakage.zip(gap.as_ref());
    let of_paths = gap.as_ref().filter(|_| requested.percolation);
    let flow = of_leakage.map(|(of, gap)| Flow::new(gap, gap_error, of, boundary, stop)).transpose()?;
    let of_stress = requested.stress_below.as_ref();
    let stressed = of_stress.map(|of| stress(scene, numerics, (&state, of), stop)).transpose()?;
    let read_off = InterfaceState {
        leakage: flow.as_ref().map(|flow| flow.numbers),
        percolation: of_paths.map(|gap| paths(gap, boundary)).transpose()?,
        stress: stressed.as_ref().map(|(largest, _)| *largest),
        film: match requested.film.zip(gap.as_ref()) {
            // Full contact of a periodic map has no resistance, and so no conductance.
            Some((_, gap)) if boundary == Boundary::Periodic && gap.values().iter().all(|g| *g <= 0.0) => {
                None
            }
            Some((of, gap)) => Some(film_of(scene, numerics, (gap, of), stop)?),
            None => None,
        },
        gap_error,
    };
    let mut fields = state.fields.take().unwrap_or_default();
    if let Some(flow) = flow {
        (fields.fluid_pressure, fields.flux) = (Some(flow.pressure), Some(flow.flux));
    }
    if let Some((_, below)) = stressed {
        (fields.von_mises, fields.stress_section) = (below.at_largest, below.section);
        fields.stress_volume = below.volume;
    }
    Ok(state.with_interface(read_off).with_fields(fields))
}

/// Whether the bound of the error of the gap holds: with the kernel of pressures that are uniform on cells, and
/// without an effect that changes the kernel, the heights or the law of a cell in normal contact.
fn is_elastic_half_space(scene: &SceneFile, numerics: &Numerics) -> bool {
    is_of_cells(numerics)
        && scene.effects.named().all(|effect| effect.key() == "friction" && effect != Effect::FullCoupling)
}

/// Whether pressures are uniform on cells, as those of boundary elements usually are.
fn is_of_cells(numerics: &Numerics) -> bool {
    matches!(numerics, Numerics::Bem3d(model) if model.periodic_kernel == PeriodicKernel::Cells)
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
        let shifted = |by: f64| -> Result<FlowBounds> {
            let mut gap = gap.clone();
            for g in gap.values_mut() {
                *g = (*g + by).max(0.0);
            }
            Ok(leakage_until(&gap, along, boundary, options, stop)?.network)
        };
        let total = found.network.middle();
        let contact_error = match gap_error.filter(|_| total > 0.0) {
            Some(error) => Some(0.5 * (shifted(error)?.upper - shifted(-error)?.lower) / total),
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

/// Conduction through the contact and a film in the gap, and along the film.
fn film_of(
    scene: &SceneFile,
    numerics: &Numerics,
    (gap, of): (&Field, RequestedFilm),
    stop: Stop<'_>,
) -> Result<FilmState> {
    let boundary = scene.effects.boundary;
    let Some(bodies) = scene.requested.outputs.conductance.resistivity()? else {
        return Err(Error::unsupported(numerics.name(), "a film without the conductance of the bodies"));
    };
    let resistivity = of.material.resistivity();
    let film = Film { resistivity, bodies };
    let found = film_conductance_until(gap, film, boundary, FILM_TOLERANCE, stop)?;
    let area = scene.surface.size().area();
    let per = if boundary == Boundary::Periodic { area } else { 1.0 };
    let along = of.along.map(|axis| -> Result<(f64, f64)> {
        let mut sheet = gap.clone();
        for conductivity in sheet.values_mut() {
            *conductivity /= resistivity;
        }
        let options = FlowOptions { continuum: false, ..FlowOptions::default() };
        let FlowBounds { lower, upper } = conductance_until(&sheet, axis, boundary, options, stop)?.network;
        Ok(middle_and_error(lower, upper))
    });
    let (through, error) = middle_and_error(found.lower, found.upper);
    Ok(FilmState { through: through / per, error, along: along.transpose()? })
}

/// The middle of two bounds, and half of their distance over it: 0 where nothing conducts.
fn middle_and_error(lower: f64, upper: f64) -> (f64, f64) {
    let middle = 0.5 * (lower + upper);
    (middle, if middle > 0.0 { 0.5 * (upper - lower) / middle } else { 0.0 })
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

/// Fields of the stress below the surface, those that are requested.
struct FieldsBelow {
    /// At the depth of the largest stress.
    at_largest: Option<Field>,
    /// In a vertical section through it.
    section: Option<Field>,
    /// All components, one after the other, each layer by layer.
    volume: Option<Vec<Field>>,
}

/// The largest stress, and the fields that are requested.
fn stress(
    scene: &SceneFile,
    numerics: &Numerics,
    (state, of): (&ContactState, &RequestedStress),
    stop: Stop<'_>,
) -> Result<(LargestStress, FieldsBelow)> {
    let (body, poisson) = of
        .of_body(scene.pair, scene.effects.friction)
        .map_err(|wrong| Error::unsupported(numerics.name(), wrong.to_string()))?;
    let none = Fields::default();
    let load = SurfaceLoad::of_state(state.fields.as_ref().unwrap_or(&none), body)?;
    let periodic = if is_of_cells(numerics) { PeriodicLoad::Cells } else { PeriodicLoad::Waves };
    let body = StressedBody { poisson, boundary: scene.effects.boundary, periodic };
    let found = largest_von_mises(&load, body, &of.depths, stop)?;
    let factor = of.yield_stress.map(|stress| found.factor_until_yield(stress)).transpose()?;
    let at_largest = if scene.requested.von_mises.is_empty() {
        None
    } else {
        Some(SubsurfaceStress::new(&load, body)?.at_depth(found.depth, stop)?.von_mises()?)
    };
    let section = if scene.requested.stress_section.is_empty() {
        None
    } else {
        let [dx, dy] = [load.pressure().dx(), load.pressure().dy()];
        let line = match of.section {
            Some(FlowAxis::Y) => SectionLine::Column((found.centre[0] / dx) as usize),
            _ => SectionLine::Row((found.centre[1] / dy) as usize),
        };
        let (cells, size) = of.section_grid(load.cells(), load.size());
        let step = size.y / cells.rows as f64;
        let depths: Vec<f64> = (0..cells.rows).map(|k| (k as f64 + 0.5) * step).collect();
        let stress = stress_section(&load, body, line, &depths, stop)?.stress;
        Some(Field::new(cells, size, stress.iter().map(von_mises).collect())?)
    };
    let volume = if scene.requested.stress_volume.is_empty() {
        None
    } else {
        let (count, thickness) = of.layers();
        let depths: Vec<f64> = (0..count).map(|k| (k as f64 + 0.5) * thickness).collect();
        let mut components = [const { Vec::new() }; 6];
        for layer in stress_at_depths(&load, body, &depths, stop)? {
            for (component, field) in components.iter_mut().zip(layer.into_components()) {
                component.push(field);
            }
        }
        Some(components.into_iter().flatten().collect())
    };
    let largest = LargestStress {
        von_mises: found.value,
        depth: found.depth,
        centre: found.centre,
        factor_until_yield: factor.flatten(),
    };
    Ok((largest, FieldsBelow { at_largest, section, volume }))
}
