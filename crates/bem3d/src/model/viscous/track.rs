//! One history of a viscoelastic surface: what each cell and each effect remembers of it.

use super::step_law::{StepLaw, TractionHistory, carried};
use crate::active_set::LastState;
use crate::friction::{SlipMemory, TangentialControl};
use crate::geometry::Grid;
use crate::law::total;
use crate::model::adhesive::Last;
use crate::model::load::{ScaledLoad, ScaledNormal};
use crate::model::memory::Indented;
use crate::model::prepared::PreparedSurface;
use crate::model::sliding::SurfaceFriction;
use contact_model::RelaxationSpectrum;
use serde::{Deserialize, Serialize};

/// One history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct ViscousTrack {
    pub pressures: TractionHistory,
    /// With friction.
    pub slid: Option<SlipHistory>,
    /// With adhesion, whose tractions are the true ones.
    pub adhesive: Option<Last>,
    /// The last contact without adhesion, whose pressures are the true ones.
    pub last: Option<LastState>,
    /// The indentation by a hardness.
    pub indented: Option<Indented>,
    pub reached: TrackEnd,
}

/// What friction remembers of a history.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct SlipHistory {
    pub tractions: TractionHistory,
    /// Slip and displacement at the end of the last step, without tractions and what follows from them.
    slipped: SlipMemory,
    /// Energy that friction has dissipated, in the units of the modulus E*.
    dissipated: f64,
}

/// The load at which a track has arrived, in the units of a surface with the modulus E*.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TrackEnd {
    pub force: f64,
    /// Sum of P: the force with which an elastic body would be displaced as much.
    pub elastic_force: f64,
    pub approach: f64,
    pub mean_gap: f64,
    pub tangential_force: [f64; 2],
    pub tangential_displacement: [f64; 2],
    /// Number of cells in contact.
    pub cells: usize,
}

impl ViscousTrack {
    /// Before any load, at the first touch.
    pub fn new(surface: &PreparedSurface, spectrum: &RelaxationSpectrum) -> Self {
        let mean_gap = surface.mean - surface.problem.candidates.range().first;
        let arms = spectrum.arms.len();
        Self {
            pressures: TractionHistory::new(arms),
            slid: surface.sliding.as_ref().map(|_| SlipHistory {
                tractions: TractionHistory::new(arms),
                slipped: SlipMemory::default(),
                dissipated: 0.0,
            }),
            adhesive: None,
            last: None,
            indented: None,
            reached: TrackEnd { mean_gap, ..TrackEnd::default() },
        }
    }

    /// Whether its cells and numbers are those of a surface and a material.
    pub fn fits(&self, grid: Grid, arms: usize) -> bool {
        let TrackEnd { force, elastic_force, approach, mean_gap, .. } = self.reached;
        let TrackEnd { tangential_force, tangential_displacement, .. } = self.reached;
        self.pressures.fits(grid, arms, 1)
            && self.slid.as_ref().is_none_or(|slid| slid.fits(grid, arms))
            && self.adhesive.as_ref().is_none_or(|last| last.fits(grid))
            && self.last.as_ref().is_none_or(|last| last.fits(grid))
            && self.indented.as_ref().is_none_or(|indented| indented.fits(grid))
            && [force, elastic_force, approach, mean_gap].into_iter().all(f64::is_finite)
            && tangential_force.into_iter().chain(tangential_displacement).all(f64::is_finite)
    }
}

impl SlipHistory {
    /// The start of an increment, in the units of a step with this law that leaves these tractions.
    ///
    /// A traction q at its end displaces as `q/M + H` in an elastic body. Slip is the change of the displacement
    /// under it, so that the increment is that of an elastic body which began with `P - H`.
    pub fn begin(&self, law: &StepLaw, left: &[f64], sliding: &mut SurfaceFriction) {
        let (cells, from) = (&self.tractions.cells, &self.slipped.cells);
        let zeros = vec![0.0; 2 * cells.len()];
        let known =
            |values: &[f64]| if from.is_empty() { zeros.clone() } else { carried(cells, from, values) };
        sliding.before = SlipMemory {
            cells: cells.clone(),
            traction: self.tractions.elastic.iter().zip(left).map(|(p, left)| p - left).collect(),
            displacement: self.slipped.displacement,
            offset: Vec::new(),
            slip: known(&self.slipped.slip),
            moved: known(&self.slipped.moved),
            pressure: vec![0.0; cells.len()],
        };
        sliding.dissipated = self.dissipated / law.modulus;
    }

    /// The history at the end of an increment.
    pub fn advanced(&self, law: &StepLaw, left: &[f64], sliding: &SurfaceFriction) -> Self {
        let end = &sliding.before;
        Self {
            tractions: self.tractions.advanced(law, left, &end.cells, &end.traction),
            slipped: SlipMemory {
                cells: end.cells.clone(),
                displacement: end.displacement,
                slip: end.slip.clone(),
                moved: end.moved.clone(),
                ..SlipMemory::default()
            },
            dissipated: law.modulus * sliding.dissipated,
        }
    }

    fn fits(&self, grid: Grid, arms: usize) -> bool {
        let SlipMemory { cells, displacement, slip, moved, .. } = &self.slipped;
        let sound = |values: &Vec<f64>| {
            values.len() == 2 * cells.len() && values.iter().all(|value| value.is_finite())
        };
        self.tractions.fits(grid, arms, 2)
            && cells.is_on(grid)
            && sound(slip)
            && sound(moved)
            && displacement.iter().all(|d| d.is_finite())
            && self.dissipated.is_finite()
    }
}

impl TrackEnd {
    /// With the tangential load at the end of an increment of a step with this modulus.
    pub fn with_slip(self, modulus: f64, sliding: Option<&SurfaceFriction>) -> Self {
        let Some(sliding) = sliding else { return self };
        Self {
            tangential_force: total(&sliding.before.traction).map(|force| modulus * force),
            tangential_displacement: sliding.before.displacement,
            ..self
        }
    }

    /// The load at a share of the way from here to another.
    pub fn towards(self, load: ScaledLoad, share: f64) -> ScaledLoad {
        let between = |from: f64, to: f64| if share >= 1.0 { to } else { from + share * (to - from) };
        let each = |from: [f64; 2], to: [f64; 2]| [between(from[0], to[0]), between(from[1], to[1])];
        let mut next = load;
        next.normal = match load.normal {
            ScaledNormal::Force(to) => ScaledNormal::Force(between(self.force, to)),
            ScaledNormal::Approach(to) => ScaledNormal::Approach(between(self.approach, to)),
            ScaledNormal::MeanGap(to) => ScaledNormal::MeanGap(between(self.mean_gap, to)),
        };
        next.tangential.control = match load.tangential.control {
            TangentialControl::Force(to) => TangentialControl::Force(each(self.tangential_force, to)),
            TangentialControl::Displacement(to) => {
                TangentialControl::Displacement(each(self.tangential_displacement, to))
            }
        };
        next
    }
}

impl LastState {
    /// The mean of two contacts, at the larger of both approaches.
    pub(super) fn halfway_to(&self, other: &Self) -> Self {
        let contact = self.contact.union(&other.contact);
        let mut p = contact.carry(&self.contact, &self.p);
        contact.add_carried(&other.contact, &other.p, &mut p);
        for p in &mut p {
            *p *= 0.5;
        }
        let (force, d) = (0.5 * (self.force + other.force), self.d.max(other.d));
        Self { contact, p, d, force, tangent: None }
    }

    /// The same contact of a body with another modulus.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            p: self.p.iter().map(|p| p * factor).collect(),
            force: self.force * factor,
            tangent: None,
            ..self.clone()
        }
    }
}
