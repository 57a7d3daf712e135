//! A model of one's own: an elastic layer that answers as a Winkler foundation, checked against its closed
//! form.
//!
//! `cargo run -p contact-model --example winkler`
//!
//! ```text
//!  approach        force  closed form          k       area
//!     0.005     0.003144     0.003142     1.2560   0.031400
//!      0.01     0.012570     0.012566     2.5110   0.062775
//!      0.02     0.050273     0.050265     5.0270   0.125675
//!      0.04     0.201078     0.201062    10.0490   0.251225
//! the model winkler does not support the load Force(1.0)
//! ```

use contact_model::{
    Abilities, ContactModel, ContactState, Error, HeightMap, Load, NormalLoad, Normalisation, Output,
    Outputs, PreparedContact, Result, Scene, Size, SolveReport, Source, Stop, Surface, SurfaceKind,
};
use std::f64::consts::PI;

/// A thin layer on a rigid base: independent springs of E*/thickness per area.
struct WinklerModel {
    thickness: f64,
}

impl ContactModel for WinklerModel {
    fn name(&self) -> &'static str {
        "winkler"
    }

    fn sources(&self) -> &'static [Source] {
        &[Source { citation: "K. L. Johnson, Contact Mechanics, Cambridge (1985)", what: "Sec. 4.3" }]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[SurfaceKind::Heights],
            outputs: &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area],
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(self.name(), scene)?;
        let Surface::Heights(map) = &scene.surface else {
            return Err(Error::unsupported(self.name(), scene.surface.kind()));
        };
        let highest = map.highest(); // a pass over the map: once, not for each cell
        let mut depths: Vec<f64> = map.defined().map(|h| highest - h).collect();
        depths.sort_by(f64::total_cmp);
        let (cell, contact_modulus) = (map.dx() * map.dy(), scene.contact_modulus);
        let normalisation = Normalisation { contact_modulus, length: map.length(), height: None };
        let spring = cell * contact_modulus / self.thickness;
        Ok(Box::new(WinklerLayer { depths, cell, spring, normalisation, outputs: scene.outputs }))
    }
}

/// The undeformed gaps in ascending order, and the spring under one cell.
struct WinklerLayer {
    depths: Vec<f64>,
    cell: f64,
    spring: f64,
    normalisation: Normalisation,
    outputs: Outputs,
}

impl PreparedContact for WinklerLayer {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, _stop: Stop<'_>) -> Result<ContactState> {
        let NormalLoad::Approach(approach) = load.validated()?.without_tangential("winkler")? else {
            return Err(Error::unsupported("winkler", format!("the load {load:?}")));
        };
        let touching = &self.depths[..self.depths.partition_point(|z| *z < approach)];
        let mut report = SolveReport::exact("independent springs");
        report.contact_cells = Some(touching.len());
        let count = touching.len() as f64;
        ContactState::new(self.spring * touching.iter().map(|z| approach - z).sum::<f64>(), report)
            .with_approach(approach)
            .with_elastic_stiffness(self.outputs.needs_stiffness().then_some(self.spring * count))
            .with_area(self.outputs.area.then_some(self.cell * count))
            .completed(&self.outputs, self.normalisation.contact_modulus)
    }
}

fn main() -> Result<()> {
    let (side, radius, thickness, contact_modulus) = (1.0, 1.0, 0.05, 2.0);
    let middle = |i: usize| ((i as f64 + 0.5) / 400.0 - 0.5) * side;
    let sphere = |ix, iy| -(middle(ix).powi(2) + middle(iy).powi(2)) / (2.0 * radius);
    let map = HeightMap::from_fn(400, Size::from(side), sphere)?;
    let mut scene = Scene::new(Surface::Heights(map.into()), contact_modulus);
    scene.outputs.area = true;
    let model: &dyn ContactModel = &WinklerModel { thickness };
    let mut contact = model.prepare(&scene, 0)?;
    println!("{:>9} {:>12} {:>12} {:>10} {:>10}", "approach", "force", "closed form", "k", "area");
    for approach in [0.005, 0.01, 0.02, 0.04] {
        let state = contact.solve(Load::approach(approach))?;
        let exact = PI * contact_modulus / thickness * radius * approach * approach;
        let (stiffness, area) = (state.stiffness.unwrap_or(0.0), state.area.unwrap_or(0.0));
        println!("{approach:>9} {:>12.6} {exact:>12.6} {stiffness:>10.4} {area:>10.6}", state.force);
        // The sum over cells differs from the integral by their share of the contact.
        assert!((state.force / exact - 1.0).abs() < 1e-3);
    }
    let refused = contact.solve(Load::force(1.0));
    println!("{}", refused.err().map_or_else(String::new, |e| e.to_string()));
    Ok(())
}
