//! The result of a solve, and its evidence.

use crate::fields::{Field, Fields};
use crate::interface_state::InterfaceState;
use crate::patches::Patches;
use crate::work::Work;
use std::fmt;

/// One contact state. A quantity is `None` where the model does not claim it or where it was not requested.
///
/// A model makes it with [`ContactState::new`] and adds the quantities that it computes:
///
/// ```
/// use contact_model::{ContactState, SolveReport};
/// let state = ContactState::new(1.0, SolveReport::exact("closed form")).with_approach(0.5).with_area(2.0);
/// assert_eq!((state.approach, state.area, state.stiffness), (Some(0.5), Some(2.0), None));
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactState {
    /// Time at the end of the step that led to this state, for states along a path.
    pub time: Option<f64>,
    /// Normal force F; negative where adhesion holds against a pull.
    pub force: f64,
    /// Approach d from first touch; `None` with periodic boundaries.
    pub approach: Option<f64>,
    /// Mean gap, on request: the distance between the mean plane of the defined heights and that of the
    /// deformed half-space. Without undefined points it is the mean of the gap field; with them it may be
    /// negative. `None` also where a theory has none (without load).
    pub mean_gap: Option<f64>,
    /// Stiffness k = dF/dd along the branch of the states, with periodic boundaries -dF/d(mean gap): the
    /// slope of the force as the load continues in the direction of its last change (a first load counts as
    /// growing). Cells at the hardness flow, and the fronts of an adhesive contact advance or recede. At a
    /// kink, such as an old load that a plastic path reaches again, the slope in the other direction differs.
    pub stiffness: Option<f64>,
    /// Stiffness at fixed contact area: all cells in contact stay bonded, those at the hardness and at a
    /// front included. The conductance follows from it. Without hardness and adhesion it equals the
    /// stiffness.
    pub stiffness_fixed_area: Option<f64>,
    /// Real contact area.
    pub area: Option<f64>,
    /// Conductance through the contact ([`crate::Conductance`]).
    pub conductance: Option<f64>,
    /// Connected contact areas.
    pub patches: Option<Patches>,
    /// Approach and stiffness with the compression of the whole layer, for periodic contacts of a rigid body with an
    /// elastic layer on a rigid base.
    #[cfg_attr(feature = "serde", serde(default))]
    pub whole_layer: Option<WholeLayer>,
    /// The plastic part, for contacts with a hardness.
    pub plastic: Option<PlasticState>,
    /// The adhesive part, for contacts with adhesion that are solved cell by cell.
    pub adhesive: Option<AdhesiveState>,
    /// The viscoelastic part, for histories that are solved in steps of time.
    pub viscoelastic: Option<ViscoelasticState>,
    /// The largest pull of the path so far, where a path is followed ([`crate::LargestPull`]) and a load of
    /// it pulled.
    pub pull_off: Option<PullOff>,
    /// How well the cells resolve the contact, where the model has cells.
    pub resolution: Option<ContactResolution>,
    /// Contact radius of a round contact; for an equivalent profile the radius of the round contact of the
    /// same stiffness, `k/(2 E*)`.
    pub contact_radius: Option<f64>,
    /// The tangential part, for contacts with friction.
    pub tangential: Option<TangentialState>,
    /// Leakage, paths and the stress below the surface, where a scene requests them. Models leave it empty.
    #[cfg_attr(feature = "serde", serde(default))]
    pub interface: InterfaceState,
    /// The requested fields; they are not stored with the state.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub fields: Option<Fields>,
    /// How it was reached and how far it can be trusted.
    pub report: SolveReport,
}

impl ContactState {
    /// A state with a force and no other quantity.
    pub fn new(force: f64, report: SolveReport) -> Self {
        Self {
            time: None,
            force,
            approach: None,
            mean_gap: None,
            stiffness: None,
            stiffness_fixed_area: None,
            area: None,
            conductance: None,
            patches: None,
            whole_layer: None,
            plastic: None,
            adhesive: None,
            viscoelastic: None,
            pull_off: None,
            resolution: None,
            contact_radius: None,
            tangential: None,
            interface: InterfaceState::default(),
            fields: None,
            report,
        }
    }

    /// With the time at the end of a step of a path.
    #[must_use]
    pub fn with_time(self, time: f64) -> Self {
        Self { time: Some(time), ..self }
    }

    /// With an approach; `None` removes it.
    #[must_use]
    pub fn with_approach(self, approach: impl Into<Option<f64>>) -> Self {
        Self { approach: approach.into(), ..self }
    }

    /// With a mean gap.
    #[must_use]
    pub fn with_mean_gap(self, mean_gap: impl Into<Option<f64>>) -> Self {
        Self { mean_gap: mean_gap.into(), ..self }
    }

    /// With a stiffness.
    #[must_use]
    pub fn with_stiffness(self, stiffness: impl Into<Option<f64>>) -> Self {
        Self { stiffness: stiffness.into(), ..self }
    }

    /// With a stiffness at fixed contact area.
    #[must_use]
    pub fn with_stiffness_fixed_area(self, stiffness: impl Into<Option<f64>>) -> Self {
        Self { stiffness_fixed_area: stiffness.into(), ..self }
    }

    /// With the stiffness of an elastic contact, which is the same along the branch and at fixed contact
    /// area: a small change of the contact area changes the force only in second order.
    #[must_use]
    pub fn with_elastic_stiffness(self, stiffness: impl Into<Option<f64>>) -> Self {
        let stiffness = stiffness.into();
        Self { stiffness, stiffness_fixed_area: stiffness, ..self }
    }

    /// With a real contact area.
    #[must_use]
    pub fn with_area(self, area: impl Into<Option<f64>>) -> Self {
        Self { area: area.into(), ..self }
    }

    /// With connected contact areas.
    #[must_use]
    pub fn with_patches(self, patches: impl Into<Option<Patches>>) -> Self {
        Self { patches: patches.into(), ..self }
    }

    /// With the approach to a whole layer.
    #[must_use]
    pub fn with_whole_layer(self, whole_layer: impl Into<Option<WholeLayer>>) -> Self {
        Self { whole_layer: whole_layer.into(), ..self }
    }

    /// With a plastic part.
    #[must_use]
    pub fn with_plastic(self, plastic: impl Into<Option<PlasticState>>) -> Self {
        Self { plastic: plastic.into(), ..self }
    }

    /// With an adhesive part.
    #[must_use]
    pub fn with_adhesive(self, adhesive: impl Into<Option<AdhesiveState>>) -> Self {
        Self { adhesive: adhesive.into(), ..self }
    }

    /// With a viscoelastic part.
    #[must_use]
    pub fn with_viscoelastic(self, viscoelastic: impl Into<Option<ViscoelasticState>>) -> Self {
        Self { viscoelastic: viscoelastic.into(), ..self }
    }

    /// With the resolution of the contact by its cells.
    #[must_use]
    pub fn with_resolution(self, resolution: impl Into<Option<ContactResolution>>) -> Self {
        Self { resolution: resolution.into(), ..self }
    }

    /// With a contact radius.
    #[must_use]
    pub fn with_contact_radius(self, radius: impl Into<Option<f64>>) -> Self {
        Self { contact_radius: radius.into(), ..self }
    }

    /// With a tangential part.
    #[must_use]
    pub fn with_tangential(self, tangential: impl Into<Option<TangentialState>>) -> Self {
        Self { tangential: tangential.into(), ..self }
    }

    /// With leakage, paths and the stress below the surface.
    #[must_use]
    pub fn with_interface(self, interface: InterfaceState) -> Self {
        Self { interface, ..self }
    }

    /// Pressure, if requested.
    pub fn pressure(&self) -> Option<&Field> {
        self.fields.as_ref()?.pressure.as_ref()
    }

    /// Displacement of the elastic surface, if requested.
    pub fn displacement(&self) -> Option<&Field> {
        self.fields.as_ref()?.displacement.as_ref()
    }

    /// Gap, if requested; infinite at undefined points.
    pub fn gap(&self) -> Option<&Field> {
        self.fields.as_ref()?.gap.as_ref()
    }

    /// With fields.
    #[must_use]
    pub fn with_fields(self, fields: impl Into<Option<Fields>>) -> Self {
        Self { fields: fields.into(), ..self }
    }
}

/// The tangential part of a state. Pairs are components along x (columns of a map) and along y (rows).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TangentialState {
    /// Tangential force Q, the integral of the tangential traction q on the first body ([`crate::Tangential`]).
    pub force: [f64; 2],
    /// Tangential displacement delta of the second body relative to the first, far from the contact (with
    /// periodic boundaries that of their mean planes).
    pub displacement: [f64; 2],
    /// Largest tangential force under this normal force, at which the whole contact slips: the sum of the largest
    /// tractions of its cells ([`crate::FrictionLaw`]), `mu F` by Coulomb's law.
    pub sliding_force: Option<f64>,
    /// Area of the contact that sticks, where its traction is below the limit of friction; `None` if not
    /// requested.
    pub stick_area: Option<f64>,
    /// Area of the contact that slips, where its traction is at the limit of friction; `None` if not
    /// requested.
    pub slip_area: Option<f64>,
    /// Tangential stiffness `stiffness[i][j] = dQ_i/ddelta_j` along the branch of the states: the pressures
    /// are fixed, cells that stick continue to stick and cells that slip continue to slip. The matrix is
    /// symmetric. `None` if not requested, and for a periodic surface that sticks as a whole, which no force
    /// can displace.
    pub stiffness: Option<[[f64; 2]; 2]>,
    /// The tangential stiffness with the whole contact sticking, which is the slope just after a reversal of
    /// the load; `None` if not requested.
    pub stiffness_stuck: Option<[[f64; 2]; 2]>,
    /// Radius inside which the traction is below the limit of friction, for round contacts (for an equivalent
    /// profile in the sense of its contact radius): the contact radius without any slip, 0 in full slip.
    pub stick_radius: Option<f64>,
    /// Energy that friction has dissipated since the first step, >= 0.
    pub dissipated: f64,
}

impl TangentialState {
    /// A state without slip so far, with no other quantity.
    pub fn new(force: [f64; 2], displacement: [f64; 2]) -> Self {
        Self {
            force,
            displacement,
            sliding_force: None,
            stick_area: None,
            slip_area: None,
            stiffness: None,
            stiffness_stuck: None,
            stick_radius: None,
            dissipated: 0.0,
        }
    }

    /// With the largest tangential force.
    #[must_use]
    pub fn with_sliding_force(self, force: impl Into<Option<f64>>) -> Self {
        Self { sliding_force: force.into(), ..self }
    }

    /// With the areas that stick and that slip.
    #[must_use]
    pub fn with_areas(self, stick: impl Into<Option<f64>>, slip: impl Into<Option<f64>>) -> Self {
        Self { stick_area: stick.into(), slip_area: slip.into(), ..self }
    }

    /// With a tangential stiffness along the branch.
    #[must_use]
    pub fn with_stiffness(self, stiffness: impl Into<Option<[[f64; 2]; 2]>>) -> Self {
        Self { stiffness: stiffness.into(), ..self }
    }

    /// With a tangential stiffness of the sticking contact.
    #[must_use]
    pub fn with_stiffness_stuck(self, stiffness: impl Into<Option<[[f64; 2]; 2]>>) -> Self {
        Self { stiffness_stuck: stiffness.into(), ..self }
    }

    /// With a stick radius.
    #[must_use]
    pub fn with_stick_radius(self, radius: impl Into<Option<f64>>) -> Self {
        Self { stick_radius: radius.into(), ..self }
    }

    /// With the energy that friction has dissipated since the first step.
    #[must_use]
    pub fn with_dissipated(self, dissipated: f64) -> Self {
        Self { dissipated, ..self }
    }
}

/// How a rigid body and an elastic layer on a rigid base approach each other as wholes, with periodic boundaries: by
/// the fall of the mean gap since first touch, and by the compression of the whole layer under the mean pressure
/// ([`crate::Layer::whole_compression`]), which the mean gap does not contain.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WholeLayer {
    /// Approach of the rigid body and the base from first touch.
    pub approach: f64,
    /// The slope of the force over this approach, `1/(1/k + c/A0)` with the stiffness k, the compression c per mean
    /// pressure and the area A0 of the map; `None` if no stiffness is requested, and without any compliance.
    pub stiffness: Option<f64>,
}

/// The plastic part of a state, in a contact with a hardness p_s ([`crate::Hardness`]).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PlasticState {
    /// Area under the pressure p_s.
    pub area: f64,
    /// Volume of the plastic indentation, since the virgin surface.
    pub volume: f64,
    /// Energy dissipated in it, `p_s volume`: plastic flow happens at the pressure p_s only.
    pub dissipated: f64,
}

impl PlasticState {
    /// The plastic part with this area under the hardness p_s and this volume of the indentation.
    pub fn new(area: f64, volume: f64, hardness: f64) -> Self {
        Self { area, volume, dissipated: hardness * volume }
    }
}

/// The adhesive part of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AdhesiveState {
    /// Branch on which the state lies.
    pub branch: Branch,
    /// Elastic energy less the work done by the attraction: 0 for bodies far apart. `None` of a viscoelastic body,
    /// whose arms hold energies of their own.
    pub energy: Option<f64>,
    /// Stability of the state, dimensionless; > 0 at a minimum of the energy, of a viscoelastic body at one of the
    /// step of time that led to the state.
    ///
    /// It is the smallest curvature of the energy, divided by the curvature without adhesion. With Dugdale's
    /// law, states are stable between the jumps of single cells; there it is the smallest difference between
    /// the gap of a cell and the range, divided by the range.
    #[cfg_attr(feature = "serde", serde(with = "known_or_infinite"))]
    pub stability: f64,
}

impl AdhesiveState {
    /// A state on this branch.
    pub fn new(branch: Branch, energy: impl Into<Option<f64>>, stability: f64) -> Self {
        Self { branch, energy: energy.into(), stability }
    }
}

/// The viscoelastic part of a state, in a history that is solved in steps of time: what the steps cost in accuracy.
///
/// The errors are differences from the same history in steps twice as long, relative to the larger of both. They are errors of the steps alone, beside
/// those of the cells and of the solver.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ViscoelasticState {
    /// Relative error of the force; 0 where it is prescribed.
    pub force_time_error: f64,
    /// Relative error of the approach, with periodic boundaries of the mean gap; 0 where it is prescribed.
    pub distance_time_error: f64,
    /// Relative error of the number of cells in contact.
    pub area_time_error: f64,
    /// Relative errors of the tangential force and of the tangential displacement; 0 for the one that is prescribed,
    /// `None` without friction.
    pub tangential_time_errors: Option<[f64; 2]>,
    /// Number of steps of time since the state before; 0 for a load in no time.
    pub time_steps: usize,
    /// Work of the normal load since the first step: what the body holds, and what has been dissipated in it. With
    /// periodic boundaries the load works along the fall of the mean gap. `None` where displacements have no zero, in
    /// contacts that go on along a line, and with adhesion, whose attraction works too.
    pub work: Option<f64>,
}

impl ViscoelasticState {
    /// The part of a state after this number of steps, with the errors of force, distance and area.
    pub fn new(
        [force_time_error, distance_time_error, area_time_error]: [f64; 3],
        time_steps: usize,
    ) -> Self {
        Self {
            force_time_error,
            distance_time_error,
            area_time_error,
            tangential_time_errors: None,
            time_steps,
            work: None,
        }
    }

    /// With the errors of the tangential force and of the tangential displacement.
    #[must_use]
    pub fn with_tangential_errors(self, errors: impl Into<Option<[f64; 2]>>) -> Self {
        Self { tangential_time_errors: errors.into(), ..self }
    }

    /// With the work of the load.
    #[must_use]
    pub fn with_work(self, work: impl Into<Option<f64>>) -> Self {
        Self { work: work.into(), ..self }
    }
}

/// The largest pull along a path ([`crate::LargestPull`]).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PullOff {
    /// The largest pull P > 0 over the loads of the path: the most negative normal force, with a positive
    /// sign. At most the pull-off force.
    pub force: f64,
    /// The pull-off force is at most `force + error`. `None` where no load of the path is beyond it.
    pub error: Option<f64>,
    /// Approach at the largest pull; `None` with periodic boundaries.
    pub approach: Option<f64>,
    /// Mean gap at the largest pull, if requested.
    pub mean_gap: Option<f64>,
}

/// Branch of a path with adhesion: between snap-in and pull-off states of both branches are stable.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Branch {
    /// The bodies have approached each other since the contact area last shrank.
    Approach,
    /// The bodies were drawn apart.
    Withdrawal,
}

impl Branch {
    /// The word used in CSV files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Approach => "approach",
            Self::Withdrawal => "withdrawal",
        }
    }
}

/// How well the cells resolve a contact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactResolution {
    /// Largest pressure of a cell: the mean over that cell, which grows as cells get smaller until they
    /// resolve the shortest wave. Of a formula without cells it is the largest pressure at a point. `None`
    /// where the contact is known and its pressures are not (a viscoelastic one by its equivalent elastic
    /// contact).
    pub largest_pressure: Option<f64>,
    /// Largest share of the force that a single cell carries, in [0, 1].
    pub largest_share: f64,
    /// Cells in contact at an edge of a free rectangle; 0 with periodic boundaries.
    pub edge_cells: usize,
    /// Cells in contact that share an edge with an undefined point of the surface. They carry what the undefined point
    /// would carry, so that their pressure is too large where the surface goes on.
    pub rim_cells: usize,
    /// Contact area with a correction for its boundary, if the area was requested.
    ///
    /// The area of the cells in contact exceeds that of a contact of smooth boundary by about `(pi - 1 + ln
    /// 2)/24` cells for each edge between a cell in contact and an open one (Yastrebov, Anciaux, Molinari,
    /// Tribol. Int. 114, 161 (2017), for square cells). The correction improves the area where patches are
    /// several cells wide. Where they are not, it shows how much the area depends on the cells.
    pub corrected_area: Option<f64>,
}

impl ContactResolution {
    /// `(pi - 1 + ln 2)/24`: the area, in cells, that each edge of the boundary adds to the area of the cells
    /// in contact.
    pub const AREA_PER_EDGE: f64 = (std::f64::consts::PI - 1.0 + std::f64::consts::LN_2) / 24.0;

    /// The resolution of a contact whose cells carry at most this pressure and this share of the force, of
    /// which `edge_cells` are at an edge of the rectangle.
    pub fn new(largest_pressure: f64, largest_share: f64, edge_cells: usize) -> Self {
        Self {
            largest_pressure: Some(largest_pressure),
            largest_share,
            edge_cells,
            rim_cells: 0,
            corrected_area: None,
        }
    }

    /// With the number of cells in contact that share an edge with an undefined point.
    #[must_use]
    pub fn with_rim(self, rim_cells: usize) -> Self {
        Self { rim_cells, ..self }
    }

    /// The largest pressure of a formula, which has no cells.
    pub fn of_formula(largest_pressure: f64) -> Self {
        Self::new(largest_pressure, 0.0, 0)
    }

    /// With the corrected area, >= 0, of a contact of `cells` cells whose boundary consists of `edges` edges
    /// of cells; each cell has the area `cell_area`.
    #[must_use]
    pub fn with_boundary(self, cells: usize, edges: usize, cell_area: f64) -> Self {
        let corrected = (cells as f64 - Self::AREA_PER_EDGE * edges as f64).max(0.0) * cell_area;
        Self { corrected_area: Some(corrected), ..self }
    }
}

/// The evidence that travels with every state.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SolveReport {
    /// How the solve ended.
    pub status: Status,
    /// The method that was used and why, in one short phrase (`closed form`, `fft 4096x4096, f64`, `dense
    /// 312`).
    pub strategy: String,
    /// Iterations of the linear solvers, all stages together (0 for direct and closed forms).
    pub iterations: usize,
    /// Applications of the influence matrix G on the fine grid, all precisions and the certificate together.
    pub applications: usize,
    /// Number of cells (elements) in contact, where the model has any.
    pub contact_cells: Option<usize>,
    /// Further counts of work.
    pub work: Work,
    /// How exactly the equations of the model itself are satisfied.
    pub certificate: Certificate,
}

impl SolveReport {
    /// Report of a solve that ended with this status; the other numbers are those of a formula.
    pub fn new(status: Status, strategy: impl Into<String>) -> Self {
        Self { status, ..Self::exact(strategy) }
    }

    /// Report of a model that evaluates a formula: there are no iterations and no errors but rounding.
    pub fn exact(strategy: impl Into<String>) -> Self {
        Self {
            status: Status::Converged,
            strategy: strategy.into(),
            iterations: 0,
            applications: 0,
            contact_cells: None,
            work: Work::default(),
            certificate: Certificate::default(),
        }
    }
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Status {
    /// All numbers of the certificate are within the requested tolerance.
    Converged,
    /// The limit on iterations was reached first.
    IterationLimit,
    /// No further progress at this precision: the tolerance is below what the arithmetic can reach.
    Stagnated,
    /// The caller stopped the solve. Such a state has no stiffness of any kind, nothing that follows from one,
    /// such as a conductance, and none of the errors that follow from one (`stiffness_error`, `quotient_error`,
    /// `force_error`, `tangential_stiffness_error`): they may have been unfinished.
    Stopped,
    /// The contact could not bear the prescribed pull: this is the last stable state before it.
    PulledOff,
}

impl Status {
    /// The word used in CSV files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::IterationLimit => "iteration_limit",
            Self::Stagnated => "stagnated",
            Self::Stopped => "stopped",
            Self::PulledOff => "pulled_off",
        }
    }
}

/// How exactly the contact conditions hold, measured with the exact operator in double precision.
///
/// All are relative and dimensionless; `s` is the measured rms height (the approach for a body without one).
/// A tolerance `t` is met when every one of them that it bounds is at most `t` ([`Certificate::meets`]).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Certificate {
    /// `sum p (g - min g) / (F s)`: the duality gap of the quadratic programme, in its Frank-Wolfe form. With
    /// a hardness p_s the minimum of `sum q g` over all `0 <= q <= p_s` of the same force takes the place of
    /// `F min g`.
    #[cfg_attr(feature = "serde", serde(with = "known_or_infinite"))]
    pub duality_gap: f64,
    /// `max(0, -min g) / s`. With a hardness, the minimum is over the cells below p_s, and the largest gap
    /// that remains under a cell at p_s counts too.
    #[cfg_attr(feature = "serde", serde(with = "known_or_infinite"))]
    pub penetration: f64,
    /// `sum p |g| / (F s)`; for cells at the hardness p_s only a positive gap counts.
    #[cfg_attr(feature = "serde", serde(with = "known_or_infinite"))]
    pub complementarity: f64,
    /// `|F - F_prescribed| / F_prescribed`; for a prescribed mean gap its error over s; 0 for a prescribed
    /// approach. With adhesion that is solved cell by cell it is over a thousandth of the force of the contact
    /// pressure where that is larger than F_prescribed: near 0 the force is what pressure and attraction, which
    /// cancel, leave.
    #[cfg_attr(feature = "serde", serde(with = "known_or_infinite"))]
    pub load_error: f64,
    /// Estimated relative error of the stiffness, and of that at fixed contact area where both are computed;
    /// `None` where none is, or where the stiffness is a difference quotient
    /// ([`Certificate::quotient_error`]).
    pub stiffness_error: Option<f64>,
    /// Estimated relative error of a stiffness that is a difference quotient along the branch. It depends on
    /// the cells and not on the tolerance, so it is no part of [`Certificate::worst`]. `None` where the
    /// stiffness is not such a quotient.
    pub quotient_error: Option<f64>,
    /// Relative error of the force where an approach or a mean gap was prescribed, estimated from above by
    /// the gaps that remain in the contact and the largest stiffness that it can have. `None` where the force
    /// itself was prescribed. The tolerance bounds the gaps and not this number, so it is no part of
    /// [`Certificate::worst`].
    pub force_error: Option<f64>,
    /// Largest difference between the attractive traction of a cell and that of the law of adhesion at its
    /// gap, over `work/range`; `None` without adhesion of finite range.
    pub equilibrium: Option<f64>,
    /// `sum (b |w| - w . q) / (B D)`, with the slip w of the last step, the largest traction b of a cell
    /// (`mu p` by Coulomb's law) and the sliding force B, the sum of b. D is the larger of
    /// `|delta - m|` and of the largest `|s - m|`, with the tangential displacement delta and the mean m,
    /// weighted by b, of the displacements s from which the slip of the cells counts: how far the
    /// contact has slid before is not in it. The sum is the duality gap of the convex programme of one step of
    /// friction. The error e of the tractions has `e'Ke`, twice its elastic energy, of at most this sum. 0 without
    /// displacement; `None` without friction, and for models that do not solve it cell by cell.
    pub tangential_duality_gap: Option<f64>,
    /// `|Q - Q_prescribed|` over the sliding force; 0 where the tangential displacement was prescribed, `None` as above.
    pub tangential_load_error: Option<f64>,
    /// Estimated relative error of the tangential stiffness, the larger one where both are computed; `None`
    /// where none is.
    pub tangential_stiffness_error: Option<f64>,
}

/// A residual that is not finite is stored as absent and read as infinite.
#[cfg(feature = "serde")]
mod known_or_infinite {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[allow(clippy::trivially_copy_pass_by_ref)] // The form that serde asks for.
    pub fn serialize<S: Serializer>(number: &f64, to: S) -> Result<S::Ok, S::Error> {
        number.is_finite().then_some(number).serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        Option::deserialize(from).map(|known| known.unwrap_or(f64::INFINITY))
    }
}

impl Certificate {
    /// Whether every number of [`Certificate::worst`] is at most `tolerance` (NaN never is).
    pub fn meets(&self, tolerance: f64) -> bool {
        self.worst() <= tolerance
    }

    /// Estimated relative error of the stiffness, whether it is a difference quotient or not.
    /// [`Certificate::stiffness_error`] is that of the stiffness at fixed contact area where the stiffness is a
    /// quotient.
    pub fn error_of_stiffness(&self) -> Option<f64> {
        self.quotient_error.or(self.stiffness_error)
    }

    /// The largest of the numbers that the tolerance bounds; NaN if one of them is.
    pub fn worst(&self) -> f64 {
        [
            self.duality_gap,
            self.penetration,
            self.complementarity,
            self.load_error,
            self.stiffness_error.unwrap_or(0.0),
            self.equilibrium.unwrap_or(0.0),
            self.tangential_duality_gap.unwrap_or(0.0),
            self.tangential_load_error.unwrap_or(0.0),
            self.tangential_stiffness_error.unwrap_or(0.0),
        ]
        .into_iter()
        .fold(0.0, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) })
    }
}

impl fmt::Display for Certificate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "duality_gap {:.1e}, penetration {:.1e}, complementarity {:.1e}, load_error {:.1e}",
            self.duality_gap, self.penetration, self.complementarity, self.load_error
        )?;
        for (name, number) in [
            ("stiffness_error", self.stiffness_error),
            ("equilibrium", self.equilibrium),
            ("quotient_error", self.quotient_error),
            ("force_error", self.force_error),
            ("tangential_duality_gap", self.tangential_duality_gap),
            ("tangential_load_error", self.tangential_load_error),
            ("tangential_stiffness_error", self.tangential_stiffness_error),
        ] {
            if let Some(number) = number {
                write!(f, ", {name} {number:.1e}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantities::Outputs;

    #[test]
    fn completed_states_have_what_was_asked_for() {
        let state =
            ContactState::new(1.0, SolveReport::exact("test")).with_approach(1.0).with_elastic_stiffness(2.0);
        let conductance = crate::Conductance::Electrical { first: 1.0, second: 0.0 };
        let outputs = Outputs { conductance, ..Outputs::default() };
        let done = state.clone().completed(&outputs, 0.5).unwrap();
        assert_eq!((done.stiffness, done.conductance), (None, Some(8.0)));
        let done = state.clone().completed(&Outputs { stiffness: true, ..Outputs::default() }, 0.5).unwrap();
        assert_eq!((done.stiffness, done.stiffness_fixed_area, done.conductance), (Some(2.0), None, None));
        // The whole contact conducts, whatever of it is stiff.
        let outputs =
            Outputs { conductance, stiffness: true, stiffness_fixed_area: true, ..Outputs::default() };
        let done = state.with_stiffness(-1.0).completed(&outputs, 0.5).unwrap();
        assert_eq!((done.stiffness, done.stiffness_fixed_area), (Some(-1.0), Some(2.0)));
        assert_eq!(done.conductance, Some(8.0));
    }

    #[test]
    fn a_certificate_with_nan_meets_nothing() {
        let mut c = Certificate::default();
        assert!(c.meets(0.0));
        c.penetration = f64::NAN;
        assert!(!c.meets(1e300));
        c.penetration = 0.0;
        c.stiffness_error = Some(2e-3);
        assert!(!c.meets(1e-3) && c.meets(2e-3));
        for of_friction in [
            Certificate { tangential_duality_gap: Some(3e-3), ..c },
            Certificate { tangential_load_error: Some(3e-3), ..c },
            Certificate { tangential_stiffness_error: Some(3e-3), ..c },
        ] {
            assert!(!of_friction.meets(2e-3) && of_friction.meets(3e-3));
            assert!(
                of_friction.to_string().ends_with("error 2.0e-3, tangential_duality_gap 3.0e-3")
                    || of_friction.to_string().ends_with("_error 3.0e-3"),
                "{of_friction}"
            );
        }
    }
}
