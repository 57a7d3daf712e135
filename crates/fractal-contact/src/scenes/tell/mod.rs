//! Presentation of the states: tables, pictures, the report and the manifest.

pub(crate) mod columns;
pub(crate) mod cycles;
pub(crate) mod distributions;
pub(crate) mod ensemble;
pub(crate) mod files;
pub(crate) mod info;
pub(crate) mod law;
pub(crate) mod manifest;
pub(crate) mod page;
pub(crate) mod pictures;
pub(crate) mod profile_statistics;
pub(crate) mod report;
pub(crate) mod result_folder;
pub(crate) mod smooth_ball;
pub(crate) mod state_table;
pub(crate) mod stated_error;
pub(crate) mod statistics;
pub(crate) mod statistics_files;
pub(crate) mod summary;
pub(crate) mod surface_report;
pub(crate) mod thresholds;

pub(crate) use ensemble::Mean;
pub(crate) use report::Report;
pub(crate) use result_folder::ResultFolder;
pub(crate) use state_table::StateTable;
pub(crate) use statistics::{Bands, FILES, LEVEL, MapStatisticsTables, Parameter, SlopeAndCurvature};
pub(crate) use surface_report::SurfaceReport;

#[cfg(test)]
mod tests {
    use super::{columns, ensemble, pictures, report, summary};
    use crate::scenes::read::{FilmMaterial, RequestedFilm, RequestedLeakage, RequestedStress};
    use crate::scenes::{LoadList, LoadRequest, Numerics, PrescribedLoad, SceneFile, SceneSurface};
    use contact_model::quantities::{AskedBy, Average, QUANTITIES, Role};
    use contact_model::{
        Adhesion, Boundary, Conductance, Effect, Friction, Hardness, InterfaceOutput, Layer, LayerBase, Load,
        Output, Outputs, Rheology, SelfAffine, Step, Surface, Tangential,
    };
    use interface::FlowAxis;

    /// A scene that requests this, and as little else as possible.
    fn asking(asked: AskedBy) -> SceneFile {
        let mut scene = asking_nothing();
        ask(&mut scene, asked);
        scene
    }

    fn asking_nothing() -> SceneFile {
        let rough = Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 0.01).unwrap());
        let loads = LoadRequest::Loads(LoadList { kind: PrescribedLoad::Approach, values: vec![0.1, 0.2] });
        let models = vec![Numerics::named("bem3d").unwrap()];
        let mut scene = SceneFile::new(models, SceneSurface::Plain(rough), 1.0, loads);
        scene.sampling.surfaces = 2;
        scene.requested.grid_error = true;
        scene
    }

    fn ask(scene: &mut SceneFile, asked: AskedBy) {
        let (effects, outputs) = (&mut scene.effects, &mut scene.requested.outputs);
        match asked {
            AskedBy::Output(Output::Conductance) | AskedBy::AnyStiffness => {
                outputs.conductance = Conductance::Electrical { first: 1.0, second: 1.0 };
            }
            AskedBy::Output(output) => {
                outputs.ask(output, true);
                if Outputs::OF_FRICTION.contains(&output) {
                    effects.friction = Friction::coulomb(0.3);
                }
                if output == Output::MeanGap {
                    effects.boundary = Boundary::Periodic;
                    scene.request = LoadRequest::Loads(LoadList {
                        kind: PrescribedLoad::MeanPressure,
                        values: vec![0.1, 0.2],
                    });
                }
            }
            AskedBy::AnyTangentialStiffness => {
                outputs.tangential_stiffness_stuck = true;
                effects.friction = Friction::coulomb(0.3);
            }
            AskedBy::FrictionInPlane => {
                effects.friction = Friction::coulomb(0.3);
                let tangential = Tangential::Force([0.1, 0.1]);
                let step = Step::new(0.0, Load::force(1.0).with_tangential(tangential));
                scene.request = LoadRequest::Path(vec![step.into(); 2]);
            }
            AskedBy::Interface(InterfaceOutput::Leakage) => {
                let along = FlowAxis::X;
                let leakage = RequestedLeakage { viscosity: 1.0, pressure_drop: 1.0, along };
                scene.requested.interface.leakage = Some(leakage);
            }
            AskedBy::Interface(InterfaceOutput::Film | InterfaceOutput::FilmAlong) => {
                let along = Some(FlowAxis::X);
                scene.requested.interface.film =
                    Some(RequestedFilm { material: FilmMaterial::Resistivity(1.0), along });
            }
            AskedBy::Interface(InterfaceOutput::Percolation | InterfaceOutput::Gap) => {
                scene.requested.interface.percolation = true;
            }
            AskedBy::Interface(InterfaceOutput::StressBelow | InterfaceOutput::YieldStress) => {
                let stress = RequestedStress {
                    depths: vec![1.0],
                    yield_stress: Some(1.0),
                    body: None,
                    section: None,
                    layers: None,
                };
                scene.requested.interface.stress_below = Some(stress);
            }
            AskedBy::Effect("hardness") => effects.hardness = Hardness::Limit { pressure: 1.0 },
            AskedBy::Effect("adhesion") => effects.adhesion = Adhesion::ShortRange { work: 1.0 },
            AskedBy::Effect("friction") => effects.friction = Friction::coulomb(0.3),
            AskedBy::Effect("rheology") => effects.rheology = Rheology::Maxwell { viscosity: 1.0 },
            AskedBy::Effect(key) => assert!(Effect::ALL.iter().any(|effect| effect.key() == key), "{key}"),
            AskedBy::Path => {
                scene.request = LoadRequest::Path(vec![Step::new(0.0, Load::force(1.0)).into(); 2]);
            }
            AskedBy::All(each) => each.iter().for_each(|asked| ask(scene, *asked)),
            AskedBy::PeriodicBoundary => {
                effects.boundary = Boundary::Periodic;
                scene.request = periodic_load();
            }
            AskedBy::WholeLayer => {
                let layer = Layer { thickness: 1.0, young: 1.0, poisson: 0.3, base: LayerBase::Rigid };
                (effects.layer, effects.boundary) = (Some(layer), Boundary::Periodic);
                scene.request = periodic_load();
            }
            AskedBy::Always | AskedBy::RoughSurface | AskedBy::FreeBoundary | AskedBy::PrescribedDistance => {
            }
        }
    }

    /// A load of a periodic contact, which has no approach.
    fn periodic_load() -> LoadRequest {
        LoadRequest::Loads(LoadList { kind: PrescribedLoad::Force, values: vec![1.0] })
    }

    /// Every quantity that a scene requests is in its CSV, in the tables of the console and of the report, in
    /// the means and in the curves.
    #[test]
    fn every_requested_quantity_is_in_all_tables_and_pictures() {
        for quantity in QUANTITIES {
            let (name, scene) = (quantity.name, asking(quantity.asked_by));
            assert!(columns::asked(&scene).any(|asked| asked.name == name), "{name} is not asked for");
            let csv = columns::columns(&scene);
            assert!(csv.iter().any(|column| column.name == name), "{name} is not in results.csv");
            let shown = summary::names(&scene).any(|shown| shown == name);
            let answer = matches!(quantity.role, Role::Answer | Role::OfPath);
            assert_eq!(shown, answer, "{name} in the tables of console and report");
            let means = ensemble::table(&scene, String::new(), &[]).unwrap();
            let averaged = means.columns().iter().any(|column| column.name == name);
            assert_eq!(averaged, quantity.average != Average::No, "{name} in ensemble.csv");
            let drawn = pictures::curve_files(&scene).contains(&format!("curve-{name}.svg"));
            // What is prescribed, or stands along the other axis, is not drawn over itself.
            assert!(drawn == quantity.drawn || ["approach", "force"].contains(&name), "{name} as a curve");
            let proven = report::residuals(&scene).any(|residual| residual.name == name);
            assert_eq!(
                proven,
                matches!(quantity.role, Role::Residual(_)),
                "{name} among the certificates of the report"
            );
        }
    }
}
