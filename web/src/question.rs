//! From the keys of the page to a question.

use contact_model::Surface;
use fractal_contact::scenes::{AskedFile, AskedSurface, Diagnostic, Numerics, Question, SceneFile};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use surface_io::Metric;

/// A file in memory.
#[derive(Debug)]
pub(crate) struct OpenedFile {
    pub name: String,
    pub bytes: Arc<[u8]>,
}

/// A mistake of the page's user.
#[derive(Debug, Serialize)]
pub(crate) struct Mistake {
    message: String,
    /// A remedy.
    help: Option<String>,
    /// The key in which it is, where it is known.
    key: Option<String>,
}

impl Mistake {
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, key: None }
    }

    pub fn of(diagnostic: &Diagnostic) -> Self {
        let help = diagnostic.help().map(str::to_owned);
        Self { help, ..Self::new(diagnostic.message()) }
    }
}

/// The keys that are given, with their texts.
#[derive(Debug)]
pub(crate) struct Given(Vec<(String, String)>);

impl Given {
    /// From JSON, `[["scene.models", "bem3d"], ...]`.
    pub fn parse(keys: &str) -> Result<Self, Mistake> {
        let keys = serde_json::from_str(keys);
        let mut keys: Vec<(String, String)> = keys.map_err(|error| Mistake::new(error.to_string()))?;
        // Units before lengths, a model before its options, the kind of a surface before its keys.
        let order = |key: &str| match key {
            "scene.units" => 0,
            "scene.models" => 1,
            "scene.surface.kind" | "scene.body.kind" => 2,
            _ => 3,
        };
        keys.sort_by_key(|(key, _)| order(key));
        Ok(Self(keys))
    }

    pub fn value(&self, key: &str) -> Option<&str> {
        self.0.iter().find(|(name, _)| name == key).map(|(_, text)| text.as_str())
    }

    /// Whether the surface is one of a file.
    pub fn is_file(&self) -> bool {
        self.value("scene.surface.kind") == Some("file")
    }

    /// Sets those keys that `of` selects.
    fn set(&self, question: &mut Question, of: impl Fn(&str) -> bool) -> Result<(), Mistake> {
        self.0.iter().filter(|(key, _)| of(key)).try_for_each(|(key, text)| {
            let set = question.set(key, text);
            set.map_err(|diagnostic| Mistake { key: Some(key.clone()), ..Mistake::of(&diagnostic) })
        })
    }

    /// What is asked of the file.
    pub fn file(&self, file: &OpenedFile) -> Result<AskedFile, Mistake> {
        let mut question = Question::default();
        self.set(&mut question, |key| key == "scene.units" || key.starts_with("scene.surface."))?;
        match question.surface {
            Some(AskedSurface::File(mut asked)) => {
                (asked.path, asked.content) = (Some(file.name.clone().into()), Some(Arc::clone(&file.bytes)));
                Ok(*asked)
            }
            _ => Err(Mistake::new("the surface is not one of a file")),
        }
    }

    /// The scene that is asked for. Without keys of `[outputs]` it has the usual outputs.
    pub fn scene(&self, file: Option<&OpenedFile>) -> Result<SceneFile, Mistake> {
        let mut question = Question::default();
        self.set(&mut question, |key| !key.starts_with("outputs."))?;
        let mut profile = false;
        if let Some(AskedSurface::File(asked)) = &mut question.surface {
            let file =
                file.ok_or_else(|| Mistake::new("no file is open: drop one above, or choose an example"))?;
            (asked.path, asked.content) = (Some(file.name.clone().into()), Some(Arc::clone(&file.bytes)));
            // A file that cannot be read is refused with the scene.
            let scan = surface_io::Scan::from_bytes(&file.name, &file.bytes, &asked.declared);
            profile = scan.is_ok_and(|scan| scan.metadata().profile);
        }
        if question.models.iter().any(|model| matches!(model, Numerics::Bem3d(_))) {
            question.request_usual_outputs(profile);
        }
        self.set(&mut question, |key| key.starts_with("outputs."))?;
        Ok(SceneFile::of(question, Path::new("scene.toml"))?)
    }
}

/// The random surface of a question as a file in memory.
pub(crate) fn drawn_surface(given: &Given) -> Result<OpenedFile, Mistake> {
    let scene = given.scene(None)?;
    let model = scene.models.first().ok_or_else(|| Mistake::new("no model is named"))?;
    let wrong = |error: contact_model::Error| Mistake::new(error.to_string());
    let seed = scene.seed(0);
    let surface = scene.surface.for_model(model, seed).map_err(wrong)?;
    let cells = model.boundary_elements().map_or([257, 257].into(), |elements| elements.grid(surface.size()));
    let map = match &surface {
        Surface::Heights(map) => Arc::clone(map),
        other => surface_gen::height_map(other, cells, seed).map_err(wrong)?,
    };
    let metric =
        if scene.system == fractal_contact::scenes::System::Si { Metric::Metres } else { Metric::Unitless };
    let bytes = surface_io::map_file("gwy", &map, metric).map_err(|error| Mistake::new(error.to_string()))?;
    Ok(OpenedFile { name: "surface.gwy".to_owned(), bytes: bytes.into() })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn given(keys: &[(&str, &str)]) -> Given {
        Given::parse(&serde_json::to_string(keys).unwrap()).unwrap()
    }

    #[test]
    fn keys_make_a_scene_in_any_order() {
        let keys = [
            ("effects.boundary", "periodic"),
            ("models.bem3d.cells", "32"),
            ("scene.surface.rms_height", "1 um"),
            ("scene.surface.hurst", "0.8"),
            ("scene.surface.side", "1 mm"),
            ("sampling.seed", "1"),
            ("scene.mean_pressure", "1 MPa, 2 MPa"),
            ("scene.bodies", "rigid, 210 GPa 0.3"),
            ("scene.surface.kind", "self_affine"),
            ("scene.models", "bem3d"),
        ];
        let scene = given(&keys).scene(None).unwrap();
        let mut reversed = keys;
        reversed.reverse();
        assert_eq!(scene.text, given(&reversed).scene(None).unwrap().text);
        assert!(scene.text.contains("mean_gap = true"), "{}", scene.text);
        assert_eq!(drawn_surface(&given(&keys)).unwrap().name, "surface.gwy");
    }

    #[test]
    fn a_mistake_names_its_key() {
        let mistake =
            given(&[("scene.models", "bem3d"), ("effects.hardness", "2 nm")]).scene(None).unwrap_err();
        assert_eq!(mistake.key.as_deref(), Some("effects.hardness"));
        assert!(mistake.message.contains("2 nm"), "{mistake:?}");
        let none =
            given(&[("scene.models", "bem3d"), ("scene.surface.kind", "file")]).scene(None).unwrap_err();
        assert!(none.message.contains("no file is open"), "{none:?}");
    }
}
