//! Paths of friction that are checked by the reference implementation.

use crate::stability::ledger::{Ledger, known, largest, pressure};
use crate::stability::maps::scene;
use crate::stability::plain::{PlainSum, relaxed_by};
use crate::stability::press::{TOLERANCE, tight};
use crate::stability::shear::{Dragged, PlainShear, compliance};
use bem3d::Bem3d;
use contact_model::{
    Body, Boundary, ContactModel, ContactState, Field, Friction, HeightMap, Load, Outputs, Pair,
    PreparedContact, Result, Scene, Status, Step, StickSlip, Tangential, TangentialState,
};

/// The coefficient of friction of most cases.
pub(crate) const MU: f64 = 0.4;
/// Tolerance where tractions and forces are compared that are not prescribed: the square of their error is of
/// the order of the gap, which has to be smaller accordingly.
pub(crate) const TIGHTER: f64 = 1e-13;
/// Rounding of sums over a few hundred cells and of the conversion into the solver's units and back.
pub(crate) const ROUNDING: f64 = 1e-12;
/// Differences between plain sums and a transform, and the error of the kernel of images.
const SUMS: f64 = 1e-9;
/// Largest residual of the reference implementation as a multiple of the tolerance, as its sums round
/// differently.
const WITNESS: f64 = 2.0;

/// Two bodies with the same Poisson's ratio and the modulus `E* = 1`.
pub(crate) fn alike(poisson: f64) -> Pair {
    let body = Body::Elastic { young: 2.0 * (1.0 - poisson * poisson), poisson };
    Pair { first: body, second: body }
}

/// A scene of friction with all outputs that the reference implementation checks.
pub(crate) fn rubbed(map: &HeightMap, pair: Pair, coefficient: f64) -> Scene {
    let mut scene = Scene { pair: Some(pair), ..scene(map.clone()) };
    scene.effects.friction = Friction::coulomb(coefficient);
    scene.outputs = Outputs {
        pressure: true,
        traction: true,
        slip: true,
        stick_slip: true,
        stick_area: true,
        ..Outputs::default()
    };
    scene
}

/// The end of the step before.
struct Before {
    /// Tractions times areas, of the cells in contact.
    forces: Vec<(usize, [f64; 2])>,
    displacement: [f64; 2],
    slip: Vec<[f64; 2]>,
    dissipated: f64,
}

impl Before {
    fn nothing(map: &HeightMap) -> Self {
        let slip = vec![[0.0; 2]; map.heights().len()];
        Self { forces: Vec::new(), displacement: [0.0; 2], slip, dissipated: 0.0 }
    }
}

/// A step that is checked.
struct WitnessedStep<'a> {
    load: Tangential,
    found: TangentialState,
    /// Pressures.
    p: &'a [f64],
    /// Tractions.
    q: Vec<[f64; 2]>,
    /// Slip since each cell touched.
    s: Vec<[f64; 2]>,
    /// Largest tangential force.
    friction: f64,
    /// Tractions times areas, of the cells in contact.
    forces: Vec<(usize, [f64; 2])>,
}

impl<'a> WitnessedStep<'a> {
    fn new(slide: &Slide<'_>, load: Tangential, state: &'a ContactState) -> Result<Self> {
        let (found, p) = (tangential(state)?, pressure(state)?);
        let (q, s) = (vectors(state, VectorField::Traction)?, vectors(state, VectorField::Slip)?);
        let area = slide.map.dx() * slide.map.dy();
        let friction = slide.coefficient * p.iter().sum::<f64>() * area;
        let forces = q.iter().map(|q| q.map(|q| q * area)).enumerate().filter(|&(i, _)| p[i] > 0.0).collect();
        Ok(Self { load, found, p, q, s, friction, forces })
    }
}

/// The slip of a step by plain sums.
struct StepSlip {
    /// Of the cells in contact.
    cells: Vec<[f64; 2]>,
    /// The longest displacement, of the bodies or of a point, before the step or after it.
    displacement: f64,
    /// The longest slip before the step.
    before: f64,
    /// Slip where nothing is displaced but by rounding.
    rounding: f64,
}

/// The distance of two vectors.
fn off(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// A contact on its path, whose steps are checked.
pub(crate) struct Slide<'a> {
    map: &'a HeightMap,
    coefficient: f64,
    tolerance: f64,
    /// The error of the duality gap due to the kernel of images; 0 with free boundaries.
    images: f64,
    sum: PlainShear,
    contact: Box<dyn PreparedContact>,
    before: Before,
}

impl<'a> Slide<'a> {
    /// Before the first step.
    pub(crate) fn new(map: &'a HeightMap, pair: Pair, coefficient: f64) -> Result<Self> {
        Self::of(map, &rubbed(map, pair, coefficient), coefficient)
    }

    /// The same with periodic boundaries.
    pub(crate) fn periodic(map: &'a HeightMap, pair: Pair, coefficient: f64) -> Result<Self> {
        let mut scene = rubbed(map, pair, coefficient);
        scene.effects.boundary = Boundary::Periodic;
        Self::of(map, &scene, coefficient)
    }

    /// The contact of a scene with at least the outputs of [`rubbed`].
    pub(crate) fn of(map: &'a HeightMap, scene: &Scene, coefficient: f64) -> Result<Self> {
        Self::to(TOLERANCE, map, scene, coefficient)
    }

    /// The same with a given tolerance.
    pub(crate) fn to(tolerance: f64, map: &'a HeightMap, scene: &Scene, coefficient: f64) -> Result<Self> {
        let constant = scene.pair.as_ref().map_or(Ok(0.0), compliance)?;
        let sum = match scene.effects.boundary {
            Boundary::Periodic => PlainShear::periodic(map, constant),
            _ => PlainShear::of(map, constant),
        };
        let contact = Bem3d { tolerance, ..tight() }.prepare(scene, 0)?;
        let before = Before::nothing(map);
        let images = if scene.effects.boundary == Boundary::Periodic { SUMS } else { 0.0 };
        Ok(Self { map, coefficient, tolerance, images, sum, contact, before })
    }

    /// The kernel of the reference implementation.
    pub(crate) fn sum(&self) -> &PlainShear {
        &self.sum
    }

    /// Forgets the path.
    pub(crate) fn restart(&mut self) {
        self.contact.restart();
        self.before = Before::nothing(self.map);
    }

    /// One step, without a check.
    pub(crate) fn attempt(&mut self, normal: Load, tangential: Tangential) -> Result<ContactState> {
        self.contact.advance(Step::new(0.0, normal.with_tangential(tangential)))
    }

    /// One step to a force, with the check.
    pub(crate) fn force(
        &mut self,
        ledger: &mut Ledger,
        normal: Load,
        force: [f64; 2],
    ) -> Result<ContactState> {
        self.step(ledger, normal, Tangential::Force(force))
    }

    /// One step to a displacement, with the check.
    pub(crate) fn displace(
        &mut self,
        ledger: &mut Ledger,
        normal: Load,
        displacement: [f64; 2],
    ) -> Result<ContactState> {
        self.step(ledger, normal, Tangential::Displacement(displacement))
    }

    fn step(&mut self, ledger: &mut Ledger, normal: Load, tangential: Tangential) -> Result<ContactState> {
        let state = self.attempt(normal, tangential)?;
        self.witness(ledger, tangential, &state)?;
        Ok(state)
    }

    /// Checks Coulomb's conditions, the forces, the slip and the energy of a step by plain sums.
    fn witness(&mut self, ledger: &mut Ledger, load: Tangential, state: &ContactState) -> Result<()> {
        let report = &state.report;
        ledger.must(report.status == Status::Converged && report.certificate.meets(self.tolerance), || {
            format!("{load:?}: {:?}, {}", report.status, report.certificate)
        });
        let step = WitnessedStep::new(self, load, state)?;
        self.tractions(ledger, &step)?;
        let slip = self.slip_of(&step);
        self.slips(ledger, &step, &slip);
        self.energies(ledger, &step, &slip);
        self.classes(ledger, load, state)?;
        let WitnessedStep { found, forces, s, .. } = step;
        self.before =
            Before { forces, displacement: found.displacement, slip: s, dissipated: found.dissipated };
        Ok(())
    }

    /// Checks tractions by the limit of friction, and forces by the sums of tractions.
    fn tractions(&self, ledger: &mut Ledger, step: &WitnessedStep<'_>) -> Result<()> {
        let WitnessedStep { load, found, p, q, friction, forces, .. } = step;
        ledger.must(
            p.iter().zip(q).all(|(p, q)| q[0].hypot(q[1]) <= self.coefficient * p * (1.0 + ROUNDING)),
            || format!("{load:?}: tractions beyond friction"),
        );
        let total = forces.iter().fold([0.0; 2], |[x, y], (_, f)| [x + f[0], y + f[1]]);
        // A force within a billionth of the largest one is that of a billionth less.
        let held = off(total, found.force);
        ledger.must(held <= (self.tolerance + ROUNDING) * friction, || {
            format!("{load:?}: forces {:?}, sum of tractions {total:?}", found.force)
        });
        let asked = match load {
            Tangential::Force(force) => off(*force, found.force),
            _ => off(load.components(), found.displacement),
        };
        ledger.must(asked <= 0.0, || format!("{load:?}: {found:?}"));
        ledger.near("sliding force", known("sliding force", found.sliding_force)?, *friction);
        Ok(())
    }

    /// The slip of the step: the displacement of the bodies less that of the surface.
    fn slip_of(&self, step: &WitnessedStep<'_>) -> StepSlip {
        let Before { forces: q_before, displacement: delta_before, slip: s_before, .. } = &self.before;
        let (u, u_before) = (self.sum.displacement(&step.forces), self.sum.displacement(q_before));
        let delta = step.found.displacement;
        let slip = |i: usize| [0, 1].map(|k| (delta[k] - u[i][k]) - (delta_before[k] - u_before[i][k]));
        let [own, _, _] = self.sum.between(0, 0);
        StepSlip {
            cells: step.forces.iter().map(|&(i, _)| slip(i)).collect(),
            displacement: longest(&u)
                .max(longest(&u_before))
                .max(off(delta, *delta_before))
                .max(delta[0].hypot(delta[1])),
            before: longest(s_before),
            rounding: ROUNDING * step.friction * own,
        }
    }

    /// Checks the slip of every cell.
    fn slips(&self, ledger: &mut Ledger, step: &WitnessedStep<'_>, slip: &StepSlip) {
        let WitnessedStep { load, p, q, s, forces, .. } = step;
        let Before { forces: q_before, slip: s_before, .. } = &self.before;
        for (&(i, _), &w) in forces.iter().zip(&slip.cells) {
            // Since it touched: a cell that was not in contact before begins anew.
            let touched = q_before.iter().any(|(j, _)| *j == i);
            let expected = if touched { [0, 1].map(|k| s_before[i][k] + w[k]) } else { w };
            let far = off(s[i], expected);
            ledger.must(far <= SUMS * slip.displacement.max(slip.before) + slip.rounding, || {
                format!(
                    "{load:?}: cell {i} slipped {:?}, expected {expected:?} of {}",
                    s[i], slip.displacement
                )
            });
        }
        ledger.must((0..p.len()).all(|i| p[i] > 0.0 || longest(&[s[i], q[i]]) <= 0.0), || {
            format!("{load:?}: an open cell slips or carries")
        });
    }

    /// Checks the dissipated energy, and the duality gap: by how much it is less than the limit of friction would
    /// dissipate on the same slip.
    fn energies(&self, ledger: &mut Ledger, step: &WitnessedStep<'_>, slip: &StepSlip) {
        let WitnessedStep { load, found, p, friction, forces, .. } = step;
        let area = self.map.dx() * self.map.dy();
        let (mut gap, mut dissipated) = (0.0, 0.0);
        for (&(i, f), w) in forces.iter().zip(&slip.cells) {
            gap += (self.coefficient * p[i] * area * w[0].hypot(w[1]) - f[0] * w[0] - f[1] * w[1]).max(0.0);
            dissipated += f[0] * w[0] + f[1] * w[1];
        }
        let (lost, rounding) = (self.before.dissipated, slip.rounding * friction);
        let scale = friction * slip.displacement;
        let change = (found.dissipated - lost - dissipated).abs();
        ledger.must(change <= SUMS * scale.max(lost.abs()) + rounding, || {
            format!("{load:?}: dissipated {} after {lost}, sum {dissipated}", found.dissipated)
        });
        // The gap of the solver is told over the larger of delta and of the largest reference, which is not above
        // twice the longest displacement here.
        let allowed = 2.0 * WITNESS * self.tolerance * scale.max(friction * slip.before)
            + rounding
            + self.images * scale;
        ledger.must(gap <= allowed, || format!("{load:?}: duality gap {} by plain sums", gap / scale));
        ledger.enter((gap - rounding).max(0.0) / scale.max(f64::MIN_POSITIVE));
    }

    /// Checks stick and slip by the field of classes, by its areas, and by tractions below the limit of
    /// friction.
    fn classes(&self, ledger: &mut Ledger, load: Tangential, state: &ContactState) -> Result<()> {
        let (found, p) = (tangential(state)?, pressure(state)?);
        let classes = state.fields.as_ref().and_then(|fields| fields.stick_slip.as_ref());
        let classes = known("stick_slip", classes.map(Field::values))?;
        let q = vectors(state, VectorField::Traction)?;
        let count = |class: StickSlip| classes.iter().filter(|c| (*c - class.value()).abs() < 0.5).count();
        let area = self.map.dx() * self.map.dy();
        let areas = [found.stick_area, found.slip_area].map(|area| area.unwrap_or(f64::NAN));
        let counted = [count(StickSlip::Stick), count(StickSlip::Slip)].map(|count| count as f64 * area);
        let touching = p.iter().filter(|p| **p > 0.0).count();
        let near =
            areas.iter().zip(counted).all(|(a, b)| (a - b).abs() <= ROUNDING * area * classes.len() as f64);
        ledger.must(near && count(StickSlip::Open) + touching == classes.len(), || {
            format!("{load:?}: areas {areas:?}, {counted:?} by cells")
        });
        // Cells that slip carry what friction holds.
        let most = largest(p);
        let less = (0..p.len()).filter(|&i| {
            let slips = (classes[i] - StickSlip::Slip.value()).abs() < 0.5;
            slips && self.coefficient * (p[i] - 1e-4 * most) > q[i][0].hypot(q[i][1])
        });
        let less = less.count();
        ledger.must(less == 0, || format!("{load:?}: {less} cells slip below what friction holds"));
        Ok(())
    }
}

/// The tangential part of a state.
///
/// # Errors
/// [`contact_model::Error::Shape`] where it has none.
pub(crate) fn tangential(state: &ContactState) -> Result<TangentialState> {
    known("tangential", state.tangential)
}

/// A field of two components.
#[derive(Debug, Clone, Copy)]
pub(crate) enum VectorField {
    /// Tangential tractions.
    Traction,
    /// Slip since each cell touched.
    Slip,
}

/// The vectors of a field.
///
/// # Errors
/// [`contact_model::Error::Shape`] where it is missing.
pub(crate) fn vectors(state: &ContactState, of: VectorField) -> Result<Vec<[f64; 2]>> {
    let fields = known("fields", state.fields.as_ref())?;
    let [x, y] = match of {
        VectorField::Traction => known("traction", fields.traction.as_ref())?,
        VectorField::Slip => known("slip", fields.slip.as_ref())?,
    };
    Ok(x.values().iter().zip(y.values()).map(|(&x, &y)| [x, y]).collect())
}

/// The longest of some vectors.
pub(crate) fn longest(v: &[[f64; 2]]) -> f64 {
    v.iter().fold(0.0, |longest, [x, y]| x.hypot(*y).max(longest))
}

/// Records the deviation of each vector from the exact one, over `largest`.
pub(crate) fn compare(ledger: &mut Ledger, found: &[[f64; 2]], exact: &[[f64; 2]], largest: f64) {
    found.iter().zip(exact).for_each(|(a, b)| ledger.enter((a[0] - b[0]).hypot(a[1] - b[1]) / largest));
}

/// Follows approaches and displacements and compares with relaxation of both problems: forces, energies, and
/// a tenth of the deviation of the tractions over the largest one.
pub(crate) fn against_dragging(
    ledger: &mut Ledger,
    map: &HeightMap,
    slide: &mut Slide<'_>,
    mu: f64,
    path: &[(f64, [f64; 2])],
) -> Result<()> {
    let (normal, shear) = (PlainSum::of(map), slide.sum().clone());
    let mut dragged = Dragged::new(&shear);
    let area = map.dx() * map.dy();
    for &(d, delta) in path {
        let pressed = relaxed_by(&normal, map, d);
        let limits: Vec<(usize, f64)> =
            pressed.contact.iter().copied().zip(pressed.forces.iter().map(|f| mu * f)).collect();
        dragged.advance(&limits, delta);
        let state = slide.displace(ledger, Load::approach(d), delta)?;
        let found = tangential(&state)?;
        let most = mu * pressed.force;
        ledger.near("normal force", state.force, pressed.force);
        compare(ledger, &[found.force], &[dragged.force()], most);
        let q: Vec<[f64; 2]> =
            vectors(&state, VectorField::Traction)?.iter().map(|q| q.map(|q| 0.1 * q * area)).collect();
        let exact: Vec<[f64; 2]> = dragged.forces.iter().map(|f| f.map(|f| 0.1 * f)).collect();
        compare(ledger, &q, &exact, limits.iter().fold(0.0, |most, (_, b)| b.max(most)));
        ledger.enter((found.dissipated - dragged.dissipated).abs() / (most * longest(&[delta])));
    }
    Ok(())
}
