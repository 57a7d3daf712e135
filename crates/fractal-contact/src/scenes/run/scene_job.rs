//! A model on a surface as a job, and its result as text.

use crate::scenes::plan::{FORMAT, ModelOnSurface, calibration};
use crate::scenes::read::{Error, Result, SceneFile, cells};
use crate::scenes::run::solve::SceneInFolder;
use crate::scenes::run::{Folder, KeepResult, Keeper, ModelResult, SharedLines, field_pictures};
use contact_model::Stop;
use runs::{Checkpoint, Job, JobList, Progress, ResultKind, Silent, StatesInHand, Store, fnv1a_128};
use std::path::Path;
use std::sync::Arc;
use web_time::Instant;

/// A model of a scene on one of its surfaces under all loads, or along the whole path. It is solved, stored and
/// given to a shard as a whole.
#[derive(Debug, Clone)]
pub struct SceneJob {
    pub(crate) unit: ModelOnSurface,
    pub(crate) scene: Arc<SceneFile>,
    /// The plan of the lines of the scene, which its jobs share.
    pub(crate) lines: Arc<SharedLines>,
    /// Number of its scene, where several scenes share the directory.
    pub(crate) among: Option<usize>,
    /// Folder of the results.
    pub(crate) folder: Folder,
    /// Whether it draws pictures of its fields at the end; a job that does not is complete when it is done
    /// again by one that does.
    pub(crate) draws: bool,
}

impl Job for SceneJob {
    type Output = ModelResult;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("scene", FORMAT);

    fn key(&self) -> String {
        self.unit.key(&self.scene)
    }

    fn name(&self) -> String {
        let name = format!("{}, surface {}", self.unit.numerics(&self.scene).name(), self.unit.surface);
        match (self.among, self.scene.path.file_name()) {
            (Some(_), Some(scene)) => format!("{}: {name}", scene.to_string_lossy()),
            _ => name,
        }
    }

    fn cost(&self) -> u64 {
        self.unit.cost(&self.scene) + self.cost_of_pictures()
    }

    fn memory(&self) -> f64 {
        calibration::memory(&self.scene, self.unit.numerics(&self.scene))
    }

    fn stored_bytes(&self) -> u64 {
        self.unit.stored_bytes(&self.scene)
    }

    fn is_stored(&self) -> bool {
        self.unit.numerics(&self.scene).is_stored()
    }

    /// Keeps nothing, so that an interruption loses its states.
    fn solve(&self, stop: Stop<'_>) -> Result<ModelResult> {
        self.go_on(ModelResult::default(), None, &Silent, stop)
    }

    fn resume(
        &self,
        stored: Option<ModelResult>,
        store: &dyn Fn(&ModelResult) -> runs::Result<()>,
        progress: &dyn Progress,
        stop: Stop<'_>,
    ) -> Result<ModelResult> {
        let mut begun = stored.unwrap_or_default();
        field_pictures::keep_whole_states(&mut begun, &self.folder);
        self.go_on(begun, self.is_stored().then_some(store), progress, stop)
    }

    /// A result counts as absent where a state or a file is missing or changed.
    fn is_whole(&self, result: &ModelResult) -> bool {
        result.complete && result.states.iter().all(|state| state.is_whole(&self.folder))
    }
}

impl SceneJob {
    /// A job that draws its pictures and shares no lines with others.
    pub(crate) fn new(scene: Arc<SceneFile>, unit: ModelOnSurface, folder: Folder) -> Self {
        Self { unit, scene, lines: Arc::default(), among: None, folder, draws: true }
    }

    /// The relative cost of drawing its pictures.
    fn cost_of_pictures(&self) -> u64 {
        if self.draws { self.unit.cost_of_pictures(&self.scene) } else { 0 }
    }

    /// Solves the states that `begun` lacks.
    pub(crate) fn go_on(
        &self,
        mut begun: ModelResult,
        store: Option<&KeepResult<'_>>,
        progress: &dyn Progress,
        stop: Stop<'_>,
    ) -> Result<ModelResult> {
        begun.kept = begun.states.len();
        let (model, surface) = (self.unit.numerics(&self.scene).name(), self.unit.surface);
        let key = self.stored_key();
        // Other scenes may have left theirs in the directory, also those of another command.
        let scene = match self.among {
            Some(_) => format!("{:08x}-", fnv1a_128(key.as_bytes()) >> 96),
            None => String::new(),
        };
        let checkpoint = |directory| Checkpoint::new(directory, &format!("{scene}{model}-{surface}"), &key);
        let checkpoint = self.folder.directory().map(checkpoint);
        let states = [begun.kept, self.scene.request.count()];
        let pictures = if self.draws { self.unit.pictures(&self.scene) } else { 0 };
        let told = StatesInHand::new((self.name(), self.cost()), states, progress, stop)
            .with_pictures(pictures, self.cost_of_pictures());
        let mut keeper = Keeper::new(store, checkpoint, progress, self.name(), &told);
        let of = SceneInFolder { scene: &self.scene, lines: &self.lines, folder: &self.folder };
        let mut result = self.unit.solve(of, begun, &mut keeper, &told)?;
        let (is_solved, mut drawn) = (result.complete, Vec::new());
        if self.draws {
            let start = Instant::now();
            let (scene, folder) = (&*self.scene, &self.folder);
            let cells = cells(scene, self.unit.numerics(scene));
            let pictures = field_pictures::FieldPictures { scene, model, surface, cells, folder };
            drawn = field_pictures::draw(pictures, &mut result, &|| told.drew())?;
            result.seconds += start.elapsed().as_secs_f64();
        } else {
            result.complete = false;
        }
        if is_solved {
            told.finished();
        }
        keeper.finish(&result, !drawn.is_empty())?;
        for file in drawn {
            self.folder.remove(&file);
        }
        Ok(result)
    }

    /// The stored result of a job that a stopped run has not begun, or the states of its newest part. They
    /// belong to the tables of that run, and their fields are not to be removed.
    pub(crate) fn stored_so_far(&self, store: &Store) -> Option<ModelResult> {
        let key = self.stored_key();
        let stored = || store.texts(&key).filter_map(|text| Self::KIND.decode(&text));
        let mut found = stored().find(|result| self.is_whole(result)).or_else(|| stored().next())?;
        field_pictures::keep_whole_states(&mut found, &self.folder);
        found.complete &= found.states.len() == self.scene.request.count();
        found.kept = found.states.len();
        Some(found)
    }
}

/// Every model of a scene on every surface, in the order of the tables. A theory, which is the same for every
/// seed, has one surface.
pub(crate) fn units(scene: &SceneFile) -> Vec<ModelOnSurface> {
    let surfaces = |model: usize| 0..scene.surfaces_of(&scene.models[model]);
    (0..scene.models.len())
        .flat_map(|model| surfaces(model).map(move |surface| ModelOnSurface { model, surface }))
        .collect()
}

/// The same, as jobs that write their fields into a folder.
pub(crate) fn scene_jobs(scene: &SceneFile, folder: &Folder) -> Vec<SceneJob> {
    let scene = Arc::new(scene.clone());
    let lines = Arc::default();
    let of = |unit| SceneJob {
        lines: Arc::clone(&lines),
        ..SceneJob::new(Arc::clone(&scene), unit, folder.clone())
    };
    units(&scene).into_iter().map(of).collect()
}

/// The jobs of a scene whose results go to `out`: each model on each surface.
pub fn jobs(scene: &SceneFile, out: &Path) -> Box<dyn JobList> {
    Box::new(scene_jobs(scene, &out.into()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::plan::grid_comparison::GridErrors;
    use crate::scenes::read::distributed::Distributed;
    use crate::scenes::run::StoredFile;
    use crate::scenes::run::state_result::{Answer, AnsweredState, StateRecord};
    use crate::scenes::run::warnings::Warning;
    use contact_model::{Branch, ContactState, Normalisation, Patches, SolveReport, Status};

    #[test]
    fn results_come_back_bit_for_bit() {
        let mut report = SolveReport::new(Status::Stagnated, "fft");
        report.certificate.duality_gap = 1.0 / 3.0;
        report.certificate.penetration = f64::INFINITY;
        let adhesive = contact_model::AdhesiveState::new(Branch::Withdrawal, -0.1, f64::INFINITY);
        let state = ContactState::new(0.1 + 0.2, report)
            .with_time(5e-324)
            .with_patches(Patches::new(vec![1e-300, 0.1]))
            .with_adhesive(adhesive);
        let normalisation = Normalisation { contact_modulus: 1.0, length: 2.0, height: None };
        let grid = GridErrors {
            rms_slope: 0.1,
            errors: [("area".to_owned(), analysis::grid_error(1.0, 1.1, 1.3).unwrap())].into(),
        };
        let warnings = vec![Warning::Edge, Warning::Area];
        let solved = AnsweredState { state, normalisation, warnings, grid: Some(grid) };
        let mut first = StateRecord::new(0, Answer::State(Box::new(solved)));
        first.distributions.push((Distributed::Gap, vec![[0.0, 0.1, 1e-300], [0.1, 0.2, 3.0]]));
        first.files.push(StoredFile { name: "a b.npy".into(), bytes: 3, digest: u128::MAX - 7 });
        let second = StateRecord::new(2, Answer::Refused("too much\n".into()));
        let states = vec![first, second];
        let result = ModelResult { seconds: 0.25, states, kept: 2, ..ModelResult::default() };
        let kind = ResultKind::new("scene", FORMAT);
        let text = kind.encode(&result);
        assert_eq!(kind.decode(&text), Some(result));
        for cut in 0..text.len() {
            assert_eq!(kind.decode::<ModelResult>(&text[..cut]), None);
        }
        assert_eq!(kind.decode::<ModelResult>(&text.replace("0.25", "x")), None);
    }
}
