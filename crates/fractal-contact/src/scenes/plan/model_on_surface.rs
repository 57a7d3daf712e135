//! One model and one surface: what is solved, stored and divided as a whole.

use crate::scenes::plan::calibration;
use crate::scenes::read::{FieldFormat, HEIGHTS, Numerics, STRESS_VOLUME, SceneFile, cells};
use contact_model::{Cells, Scene};

/// Number of the format of stored states. Raise it with anything that changes a state: the numbers of a model or of
/// `surface-gen`, or what is stored of a state. `bem3d` has a number of its own, which enters the keys too.
pub const FORMAT: u32 = 17;

/// Time of a picture, whatever it shows. Like [`MILLISECONDS_OF_CELL`] it was measured once, on one scene: `press` of
/// a map of 640 x 480 cells under three loads, with pictures and without.
pub(crate) const MILLISECONDS_OF_PICTURE: f64 = 40.0;
/// Time of each of the cells that a picture shows, which are read and reduced to pixels.
const MILLISECONDS_OF_CELL: f64 = 8e-5;

/// One model and one surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModelOnSurface {
    /// Which of the scene's models.
    pub model: usize,
    /// Number of the surface.
    pub surface: usize,
}

impl ModelOnSurface {
    pub fn numerics<'a>(&self, scene: &'a SceneFile) -> &'a Numerics {
        &scene.models[self.model]
    }

    /// Everything that decides its numbers.
    pub fn key(&self, scene: &SceneFile) -> String {
        let surface = scene.surface.key();
        // Its budget and its memory decide the grid alone, which is part of the model.
        let accuracy = scene.accuracy.map(|requested| requested.target.share);
        let SceneFile { contact_modulus, hardness, pair, effects, request, requested, system, .. } = scene;
        format!(
            "format {FORMAT} {}\nversion {}\nmodel {:?}\nsurface {surface}\ncontact_modulus {contact_modulus:?}\nhardness {hardness:?}\naccuracy {accuracy:?}\npair {pair:?}\neffects {effects:?}\n\
             request {request:?}\noutputs {requested:?} {system:?}\nnumber {}\nseed {}\n",
            bem3d::FORMAT,
            env!("CARGO_PKG_VERSION"),
            self.numerics(scene),
            self.surface,
            scene.seed(self.surface),
        )
    }

    /// Predicted processor milliseconds: they order the work, divide it into shards, move the progress bar and
    /// choose the grid for an accuracy. A guess from the sizes alone, within a factor of ten; those of one
    /// model, which are what is divided, have the same.
    pub fn cost(&self, scene: &SceneFile) -> u64 {
        calibration::milliseconds_of_sizes(scene, self.numerics(scene))
    }

    /// Number of the pictures of its fields.
    pub(crate) fn pictures(&self, scene: &SceneFile) -> usize {
        if self.numerics(scene).boundary_elements().is_none() {
            return 0;
        }
        let drawn = scene.requested.fields().filter(|(_, formats)| formats.contains(&FieldFormat::Png));
        // The heights are those of the first state.
        let states = |name| if name == HEIGHTS.name { 1 } else { scene.request.count() };
        let of_field = |name| (0..states(name)).filter(|state| scene.requested.draws(name, *state)).count();
        drawn.map(|(field, _)| of_field(field.name)).sum()
    }

    /// Milliseconds that drawing them takes, by their number and by the cells, which are read and reduced to pixels.
    pub(crate) fn cost_of_pictures(&self, scene: &SceneFile) -> u64 {
        let Cells { columns: x, rows: y } = cells(scene, self.numerics(scene));
        (self.pictures(scene) as f64 * (MILLISECONDS_OF_PICTURE + MILLISECONDS_OF_CELL * x as f64 * y as f64))
            as u64
    }

    /// Bytes of its states and of the fields that are asked for.
    pub fn stored_bytes(&self, scene: &SceneFile) -> u64 {
        let states = scene.request.count() as u64;
        let layers = |name| match &scene.requested.interface.stress_below {
            Some(stress) if name == STRESS_VOLUME.name => stress.layers().0,
            _ => 1,
        };
        let files = scene.requested.fields();
        let fields: usize =
            files.map(|(field, formats)| formats.len() * field.components * layers(field.name)).sum();
        let Cells { columns: x, rows: y } = cells(scene, self.numerics(scene));
        1000 + states * (1000 + 8 * x as u64 * y as u64 * fields as u64)
    }

    /// Errors where this model cannot answer the scene, found out on a small grid; what that grid refuses for
    /// its own sake is asked of the full one.
    pub fn probe(&self, scene: &SceneFile) -> contact_model::Result<()> {
        let numerics = self.numerics(scene);
        match probe(scene, &numerics.probe(scene.surface.size())) {
            Ok(()) => Ok(()),
            Err(error @ contact_model::Error::Unsupported { .. }) => Err(error),
            Err(_) => probe(scene, numerics),
        }
    }
}

/// Whether a model takes a scene.
pub(crate) fn probe(scene: &SceneFile, numerics: &Numerics) -> contact_model::Result<()> {
    let seed = scene.seed(0);
    let physics: Scene = scene.scene(numerics, seed)?;
    numerics.model().prepare(&physics, seed).map(|_| ())
}
