//! A scene that names a model of one's own: a thin elastic layer as a Winkler foundation, beside a
//! half-space.
//!
//! `cargo run -p fractal-contact --example own_model -- DIRECTORY`
//!
//! Prints approach, force and stiffness of both: F = pi R (E*/t) d^2 on the layer, Hertz's force on the
//! half-space.

use fractal_contact::scenes::{Options, Plan, Registry, Result, SceneFile, run};
use fractal_contact::{
    Abilities, ContactModel, ContactState, Error, Load, NormalLoad, Normalisation, Output, Outputs,
    PreparedContact, Scene, SolveReport, Source, Stop, SurfaceKind, never,
};
use runs::{CsvFile, Silent};
use std::path::{Path, PathBuf};

const NAME: &str = "winkler";

/// A layer of this thickness on a rigid base: springs of E*/thickness per area, one under each of the cells.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Winkler {
    pub(crate) thickness: f64,
    pub(crate) cells: usize,
}

impl ContactModel for Winkler {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source { citation: "K. L. Johnson, Contact Mechanics, Cambridge (1985)", what: "Sec. 4.3" }]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[SurfaceKind::SelfAffine, SurfaceKind::Heights, SurfaceKind::Sphere],
            outputs: &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area],
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> fractal_contact::Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let map = surface_gen::height_map(&scene.surface, self.cells, seed)?;
        let highest = map.highest();
        let mut depths: Vec<f64> = map.defined().map(|h| highest - h).collect();
        depths.sort_by(f64::total_cmp);
        let normalisation =
            Normalisation { contact_modulus: scene.contact_modulus, length: map.length(), height: None };
        let (foundation, cell) = (scene.contact_modulus / self.thickness, map.dx() * map.dy());
        Ok(Box::new(SpringBed { depths, foundation, cell, normalisation, outputs: scene.outputs }))
    }
}

/// The undeformed gaps in ascending order, pressure per indentation, area of a cell.
struct SpringBed {
    depths: Vec<f64>,
    foundation: f64,
    cell: f64,
    normalisation: Normalisation,
    outputs: Outputs,
}

impl PreparedContact for SpringBed {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, _stop: Stop<'_>) -> fractal_contact::Result<ContactState> {
        let NormalLoad::Approach(approach) = load.validated()?.without_tangential(NAME)? else {
            return Err(Error::unsupported(NAME, format!("the load {load:?}")));
        };
        let touching = &self.depths[..self.depths.partition_point(|z| *z < approach)];
        let (outputs, area) = (&self.outputs, self.cell * touching.len() as f64);
        let force = self.foundation * self.cell * touching.iter().map(|z| approach - z).sum::<f64>();
        ContactState::new(force, SolveReport::exact("independent springs"))
            .with_approach(approach)
            .with_elastic_stiffness(outputs.needs_stiffness().then_some(self.foundation * area))
            .with_area(outputs.area.then_some(area))
            .completed(outputs, self.normalisation.contact_modulus)
    }
}

/// A ball on a layer and on a half-space of the same modulus.
pub(crate) const SCENE: &str = r#"
[scene]
models = ["bem3d", "winkler"]
contact_modulus = "100 MPa"
approach = ["2 um", "8 um"]

[scene.body]
kind = "sphere"
radius = "1 mm"
side = "0.4 mm"

[models.bem3d]
cells = 129

[outputs]
stiffness = true
"#;

/// Answers the scene into a folder and gives the table.
pub(crate) fn answer(out: &Path, layer: Winkler) -> Result<CsvFile> {
    // Another version for every change of the results: what is stored is found by it.
    let version = format!("1: {:?} m, {} cells", layer.thickness, layer.cells);
    let registry = Registry::new().with(layer, version)?;
    let scene = SceneFile::parse_with("layer.toml".as_ref(), SCENE.into(), &registry)?;
    let options = Options { out: out.into(), threads: 1, fresh: false };
    let outcome = run(&scene, &Plan::new(&scene)?, &options, &Silent, &never)?;
    Ok(CsvFile::read(&outcome.files[0])?)
}

fn main() -> Result<()> {
    let out = std::env::args().nth(1).map_or_else(std::env::temp_dir, PathBuf::from).join("own-model");
    let table = answer(&out, Winkler { thickness: 0.1e-3, cells: 513 })?;
    let column = |name: &str| table.numbers(name);
    let (models, approach) = (table.texts("model")?, column("approach")?);
    let (force, stiffness) = (column("force")?, column("stiffness")?);
    println!("{:>8} {:>9} {:>10} {:>10}", "model", "d in um", "F in mN", "k in N/mm");
    for (i, model) in models.iter().enumerate() {
        let [d, f, k] = [&approach, &force, &stiffness].map(|values| values[i].unwrap_or(0.0));
        println!("{model:>8} {:>9.3} {:>10.3} {:>10.3}", d * 1e6, f * 1e3, k * 1e-3);
    }
    Ok(())
}
