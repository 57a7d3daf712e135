//! The boundary-element model as an implementation of the common trait.

mod adhesive;
mod adhesive_stiffness;
mod certificate;
mod contact;
mod coupled;
mod increment;
mod load;
mod mean_gap;
mod medium;
mod memory;
mod options;
mod path_memory;
#[cfg(test)]
mod plastic_adhesion;
mod prepared;
mod profile;
mod sliding;
mod solve_memory;
mod state;
mod viscous;

pub use adhesive::UNRESOLVED_RANGE;
pub use options::{BYTES_PER_CELL, Bem3d, Method};
pub use solve_memory::solve_bytes;

use crate::parts::Recorder;
use crate::tuning::Tuning;
use contact::PreparedBem3d;
use contact_model::{
    Abilities, Adhesion, AdhesionLaw, Boundary, ContactModel, Directions, Effect, Effects, Error, Friction,
    LoadKind, NotCombined, Output, Paths, PreparedContact, RequiredMemory, Result, Scene, Source, Stop,
    SurfaceKind, never,
};
use options::NAME;

impl ContactModel for Bem3d {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "A. E. H. Love, Phil. Trans. R. Soc. A 228, 377 (1929)",
                what: "displacement under uniform pressure on a rectangle",
            },
            Source {
                citation: "R. Pohrt, V. L. Popov, A. E. Filippov, Phys. Rev. E 86, 026710 (2012)",
                what: "problem, surfaces, normalisation (Eqs. 2-10)",
            },
        ]
    }

    fn sources_of(&self, effects: &Effects) -> Vec<Source> {
        const CERRUTI: Source = Source {
            citation: "K. L. Johnson, Contact Mechanics (1985)",
            what: "displacement under a tangential force (Cerruti; Eq. 3.75)",
        };
        const KALKER: Source = Source {
            citation: "J. J. Kalker, Three-Dimensional Elastic Bodies in Rolling Contact (1990)",
            what: "conditions of stick and slip",
        };
        const JKR: Source = Source {
            citation: "K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. A 324, 301 (1971)",
            what: "adhesion of short range",
        };
        const MAUGIS: Source = Source {
            citation: "D. Maugis, J. Colloid Interface Sci. 150, 243 (1992)",
            what: "adhesion of finite range by Dugdale's law",
        };
        const LAYER: Source = Source {
            citation: "T. C. O'Sullivan, R. B. King, J. Tribol. 110, 235 (1988)",
            what: "displacements of a layer on a half-space",
        };
        let mut sources = match effects.adhesion {
            Adhesion::ShortRange { .. } => vec![JKR],
            Adhesion::FiniteRange { law: AdhesionLaw::Dugdale, .. } => vec![MAUGIS],
            _ => Vec::new(),
        };
        if effects.friction != Friction::Off {
            sources.extend([CERRUTI, KALKER]);
        }
        if effects.layer.is_some() {
            sources.push(LAYER);
        }
        sources
    }

    fn abilities(&self) -> Abilities {
        const SURFACES: &[SurfaceKind] = &[
            SurfaceKind::SelfAffine,
            SurfaceKind::Heights,
            SurfaceKind::Profile,
            SurfaceKind::Sphere,
            SurfaceKind::Cone,
            SurfaceKind::PowerLaw,
            SurfaceKind::FlatCircle,
            SurfaceKind::Flat,
            SurfaceKind::Sine,
        ];
        Abilities {
            surfaces: SURFACES,
            boundaries: Boundary::ALL,
            effects: &[
                Effect::Hardness,
                Effect::ShortRangeAdhesion,
                Effect::ExponentialAdhesion,
                Effect::DugdaleAdhesion,
                Effect::Friction,
                Effect::ShearStrength,
                Effect::TractionLimit,
                Effect::FullCoupling,
                Effect::Layer,
                Effect::KelvinVoigt,
                Effect::Maxwell,
                Effect::StandardSolid,
                Effect::PronySeries,
            ],
            not_combined: NOT_COMBINED,
            loads: LoadKind::ALL,
            paths: Paths::Remembered,
            directions: Directions::Plane,
            outputs: Output::ALL,
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.prepare_until(scene, seed, &never)
    }

    fn prepare_until(&self, scene: &Scene, seed: u64, stop: Stop<'_>) -> Result<Box<dyn PreparedContact>> {
        Ok(Box::new(self.prepared(scene, seed, (&Tuning::DEFAULT, &Recorder::default()), stop)?))
    }

    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        Some(self.memory(scene))
    }
}

impl Bem3d {
    /// As [`ContactModel::prepare`], with other constants than the shipped ones, or with the time of the
    /// parts recorded.
    pub(crate) fn prepare_with(
        &self,
        scene: &Scene,
        seed: u64,
        tuning: &Tuning,
        recorder: &Recorder,
    ) -> Result<Box<dyn PreparedContact>> {
        Ok(Box::new(self.prepared(scene, seed, (tuning, recorder), &never)?))
    }

    /// A surface ready for single loads and for paths.
    fn prepared(
        &self,
        scene: &Scene,
        seed: u64,
        (tuning, recorder): (&Tuning, &Recorder),
        stop: Stop<'_>,
    ) -> Result<PreparedBem3d> {
        self.abilities().refuse(NAME, scene)?;
        profile::check(scene)?;
        medium::check_line(scene)?;
        medium::check_layer(scene)?;
        medium::check_kernel(scene, self.periodic_kernel)?;
        viscous::check_rheology(scene)?;
        if !(self.tolerance > 0.0 && self.tolerance < 1.0) {
            return Err(Error::domain("tolerance", self.tolerance, "a number in (0, 1)"));
        }
        if !(self.time_tolerance > 0.0 && self.time_tolerance <= 1.0) {
            return Err(Error::domain("time_tolerance", self.time_tolerance, "a number in (0, 1]"));
        }
        let map = self.heights_until(scene, seed, stop)?;
        PreparedBem3d::new(self, scene, &map, (tuning, recorder))
    }
}

const ADHESION: &[Effect] =
    &[Effect::ShortRangeAdhesion, Effect::ExponentialAdhesion, Effect::DugdaleAdhesion];

const RHEOLOGY: &[Effect] =
    &[Effect::KelvinVoigt, Effect::Maxwell, Effect::StandardSolid, Effect::PronySeries];

/// Effects that the solvers do not combine.
const NOT_COMBINED: &[NotCombined] = &[
    NotCombined {
        effects: [&[Effect::Hardness], &[Effect::ShortRangeAdhesion]],
        reason: "at the edge of a contact the tractions of this limit have no bound; give the adhesion a range",
    },
    NotCombined {
        effects: [
            &[Effect::ShortRangeAdhesion],
            &[Effect::Friction, Effect::TractionLimit, Effect::FullCoupling],
        ],
        reason: "at the edge of a contact the pressure of this limit grows without end as cells become smaller, and \
                 with it what a coefficient holds; give the adhesion a range, or friction a shear strength alone",
    },
    NotCombined {
        effects: [ADHESION, &[Effect::FullCoupling]],
        reason: "not solved, as the tractions would displace the surfaces that attract each other",
    },
    NotCombined {
        effects: [&[Effect::ShearStrength], &[Effect::FullCoupling]],
        reason: "a cell that touches with a vanishing pressure carries the whole shear strength, which may open it \
                 again, so that there need not be any state",
    },
    NotCombined {
        effects: [&[Effect::Hardness], &[Effect::FullCoupling]],
        reason: "not solved, as the tractions would displace the surface that flows",
    },
    NotCombined {
        effects: [&[Effect::Layer], ADHESION],
        reason: "a layer on a stiffer base bulges beside a load, so that the equilibria of an attraction are not ordered \
                 and none of them is distinguished",
    },
    NotCombined {
        effects: [
            &[Effect::Layer],
            &[Effect::Friction, Effect::ShearStrength, Effect::TractionLimit, Effect::FullCoupling],
        ],
        reason: "how tangential tractions displace a layer is not known here",
    },
    NotCombined {
        effects: [RHEOLOGY, &[Effect::ShortRangeAdhesion]],
        reason: "at an edge that opens or closes with a speed the work of adhesion depends on the range of the attraction, which \
                 this limit does not have; give the adhesion a range",
    },
    NotCombined {
        effects: [RHEOLOGY, &[Effect::FullCoupling]],
        reason: "not solved, as the tractions would displace the surface whose heights have a history",
    },
];

#[cfg(test)]
mod tests {
    use super::prepared::PreparedSurface;
    use super::*;
    use contact_model::{Load, Outputs, SelfAffine, Surface};
    use std::sync::Arc;

    /// A rising path of one surface with and without the stiffness.
    #[test]
    fn a_path_without_stiffness_is_the_same_path() {
        let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
        let scene = Scene::new(surface, 1.0);
        let bare = Scene { outputs: Outputs::default(), ..scene.clone() };
        let model = Bem3d { cells: 40, tolerance: 1e-9, method: Method::Iterative, ..Bem3d::default() };
        let (mut with, mut without) = (model.prepare(&scene, 1).unwrap(), model.prepare(&bare, 1).unwrap());
        for force in [0.01, 0.1, 0.5, 2.0, 10.0, 1.0] {
            let (a, b) =
                (with.solve(Load::force(force)).unwrap(), without.solve(Load::force(force)).unwrap());
            approx::assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), max_relative = 1e-7);
            assert!(a.stiffness.is_some() && b.stiffness.is_none());
            assert!(b.report.applications < a.report.applications, "what is not asked for costs nothing");
        }
    }

    #[test]
    fn loads_that_no_number_holds_are_refused() {
        // In the units of the surface one is infinite, the other zero.
        for (contact_modulus, force) in [(1e-200, 1e200), (1e200, 1e-200)] {
            let surface = SelfAffine::new(2.4, 1.0, 1.0).map(Surface::SelfAffine).unwrap();
            let model = Bem3d { cells: 8, ..Bem3d::default() };
            let solved =
                model.prepare(&Scene::new(surface, contact_modulus), 1).unwrap().solve(Load::force(force));
            assert!(matches!(solved, Err(Error::Domain { .. })), "{solved:?}");
        }
    }

    #[test]
    fn the_error_of_k_is_magnified_as_k_is() {
        use crate::response::NormalStiffness;
        use contact_model::HeightMap;
        let map = HeightMap::from_fn(8, 1.0, |ix, iy| (ix * iy) as f64).unwrap();
        let tangent = |value| NormalStiffness {
            value: [value],
            solve_error: 0.01,
            set_error: 0.02,
            ..NormalStiffness::nothing()
        };
        let mut scene = Scene::new(Surface::Heights(Arc::new(map.clone())), 1.0);
        let numerics = (&Tuning::DEFAULT, &Recorder::default());
        let free = PreparedSurface::of_map(Bem3d::default(), &scene, &map, numerics).unwrap();
        approx::assert_relative_eq!(free.stiffness_error(&tangent(3.0)), 0.03);
        scene.effects.boundary = Boundary::Periodic;
        let periodic = PreparedSurface::of_map(Bem3d::default(), &scene, &map, numerics).unwrap();
        // k = k'/(1 - c k') is four times k' where c k' = 3/4, and so is its relative error.
        let value = 0.75 / periodic.problem.operators.table().shift();
        approx::assert_relative_eq!(periodic.stiffness_error(&tangent(value)), 0.12, max_relative = 1e-12);
    }

    /// `g = u + z - d` in the units of the surface, whose rms height is not 1; without load the gap is z.
    #[test]
    fn fields_are_in_the_units_of_the_surface() {
        use contact_model::HeightMap;
        let map =
            HeightMap::from_fn(9, 1.0, |ix, iy| 0.03 * ((ix * ix) as f64).sin() + 0.02 * (iy as f64).cos());
        let map = Arc::new(map.unwrap());
        let mut scene = Scene::new(Surface::Heights(Arc::clone(&map)), 1.0);
        (scene.outputs.gap, scene.outputs.displacement) = (true, true);
        let mut contact = Bem3d { tolerance: 1e-9, ..Bem3d::default() }.prepare(&scene, 0).unwrap();
        let mut gaps = |force| {
            let state = contact.solve(Load::force(force)).unwrap();
            let (u, g) = (state.displacement().unwrap().values(), state.gap().unwrap().values());
            let gap = |(h, u): (&f64, &f64)| u + map.highest() - h - state.approach.unwrap();
            for (found, expected) in g.iter().zip(map.heights().iter().zip(u).map(gap)) {
                approx::assert_abs_diff_eq!(*found, expected, epsilon = 1e-12);
            }
            u.iter().copied().fold(0.0, f64::max)
        };
        let largest = gaps(0.02);
        assert!(largest > 0.01 && largest < 0.1, "{largest}");
        approx::assert_abs_diff_eq!(gaps(0.0), 0.0);
    }

    #[test]
    fn required_memory_follows_the_contact() {
        let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
        let model = Bem3d { cells: 256, rows: Some(128), ..Bem3d::default() };
        let cells = 256.0 * 128.0;
        let least = ContactModel::least_memory(&model, &scene).unwrap();
        approx::assert_relative_eq!(least.bytes, BYTES_PER_CELL * cells);
        assert_eq!(least.what, "a contact of 256 columns x 128 rows");
        let fields = Scene { outputs: Outputs { gap: true, ..scene.outputs }, ..scene.clone() };
        let more = ContactModel::least_memory(&model, &fields).unwrap().bytes - least.bytes;
        approx::assert_relative_eq!(more, 8.0 * cells);
        let contact = model.prepare(&scene, 0).unwrap();
        let bytes = |load| contact.required_memory(load).unwrap().bytes;
        let of_share = |outputs: &Outputs, share| {
            let cells = contact_model::Cells { columns: 256, rows: 128 };
            solve_bytes(&scene.effects, outputs, cells, share)
        };
        // The bearing area: r^2 < 2 R d, up to the cells at its edge.
        let area = std::f64::consts::PI * 2.0 * 0.005;
        let wanted = of_share(&scene.outputs, area) + solve_memory::factor_bytes(None, area);
        approx::assert_relative_eq!(bytes(Load::approach(0.005)), wanted, max_relative = 0.05);
        let least = of_share(&scene.outputs, 0.0);
        assert!(bytes(Load::force(1e-9)) >= least && bytes(Load::force(1e-9)) < 1.1 * least);
        let dense = of_share(&scene.outputs, 1.0);
        approx::assert_relative_eq!(bytes(Load::force(1.0)), dense);
        let flat = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        let all = model.prepare(&flat, 0).unwrap().required_memory(Load::force(1e-6)).unwrap();
        approx::assert_relative_eq!(all.bytes, dense);
        // Fields need room under a light load, and none beside contact everywhere.
        assert!(of_share(&fields.outputs, 0.0) > 9.0 * least);
        approx::assert_relative_eq!(of_share(&fields.outputs, 1.0), dense);
    }

    #[test]
    fn a_field_counts_as_work() {
        let scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        let with = Scene { outputs: Outputs { gap: true, ..scene.outputs }, ..scene.clone() };
        let model = Bem3d { cells: 8, ..Bem3d::default() };
        let work =
            |scene| model.prepare(scene, 0).unwrap().solve(Load::force(1.0)).unwrap().report.applications;
        assert_eq!(work(&with), work(&scene) + 1);
    }
}
