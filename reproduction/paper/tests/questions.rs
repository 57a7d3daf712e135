//! The committed scenes of figures ask what the figures ask: their states have the same keys.

#![allow(clippy::unwrap_used)] // Helpers outside #[test] functions.

use fractal_contact::scenes::{SceneFile, jobs_of_scenes};
use paper::evaluation::{EnsembleModel, Preset, Request, Run, ensemble_jobs};
use runs::Job;
use std::path::Path;

#[test]
fn committed_scenes_ask_what_the_figures_ask() {
    let request = Request {
        preset: Preset::Quick,
        fractal_dimensions: Some(vec![2.4]),
        out: Some("never-made".into()),
        ..Request::default()
    };
    let run = Run::new(&request).unwrap();
    for (model, name) in
        [(EnsembleModel::Bem3d, "fig2-quick.toml"), (EnsembleModel::Mdr1d, "fig6-quick.toml")]
    {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/figures").join(name);
        let scene = SceneFile::parse(&path, std::fs::read_to_string(&path).unwrap()).unwrap();
        let of_scene: Vec<String> = jobs_of_scenes(&[scene], &run.out).iter().map(Job::stored_key).collect();
        // The jobs of the finest grid come first; coarser ones follow.
        let of_figure: Vec<String> = ensemble_jobs(&run, &[model]).unwrap()[..run.ensemble(model).1]
            .iter()
            .map(Job::stored_key)
            .collect();
        assert_eq!(of_scene, of_figure, "{name}");
    }
}
