//! The binding of fractal-contact for a page in a browser.
//!
//! The page runs it in a worker, so that it stays responsive while a contact is solved. A question is a list of keys of a
//! scene with their texts, such as `scene.bodies` and `rigid, 210 GPa 0.3`, in any order: the form of the page, the
//! fragment of its address and this crate have no other words for it. Answers are JSON, HTML as the report of the
//! program has it, and the bytes of files.

#![allow(unsafe_code)] // What `wasm_bindgen` generates; there is none by hand.

mod form;
mod question;
mod solved;

use fractal_contact::scenes::{AskedFile, Error, Plan, describe_file, required_memory, run_in_memory};
use question::{Given, Mistake, OpenedFile};
use serde_json::json;
use solved::Solved;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// Receives the progress of a solve as JSON.
    #[wasm_bindgen(js_name = tellProgress)]
    fn tell_progress(progress: &str);
    /// Receives a state that is solved as HTML.
    #[wasm_bindgen(js_name = tellState)]
    fn tell_state(state: &str);
    /// Receives the message of a panic, after which the worker has to be replaced.
    #[wasm_bindgen(js_name = tellPanic)]
    fn tell_panic(message: &str);
}

/// Passes the message of a panic to the page.
#[wasm_bindgen(start)]
pub fn start() {
    std::panic::set_hook(Box::new(|panic| tell_panic(&panic.to_string())));
}

/// The form of the page as JSON, made from the table of keys and the abilities of the models.
#[wasm_bindgen]
pub fn form() -> String {
    form::form().to_string()
}

/// The file that is open, and what is asked of it.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Session {
    file: Option<OpenedFile>,
}

#[wasm_bindgen]
impl Session {
    /// A session without a file.
    #[wasm_bindgen(constructor)]
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes the bytes of a file.
    pub fn open(&mut self, name: &str, bytes: Vec<u8>) {
        self.file = Some(OpenedFile { name: name.to_owned(), bytes: bytes.into() });
    }

    /// Describes the surface of a question as JSON: `{"channels", "missing": [{"key", "example", "why", "instead"}],
    /// "page", "error"}`. `page` has the map, its statistics and its spectrum as HTML.
    pub fn surface(&self, keys: &str) -> String {
        answer(|| {
            let given = Given::parse(keys)?;
            let drawn;
            let file = match (given.is_file(), &self.file) {
                (true, Some(file)) => file,
                (true, None) => return Err(Mistake::new("no file is open")),
                (false, _) => {
                    drawn = question::drawn_surface(&given)?;
                    &drawn
                }
            };
            let asked = if given.is_file() { given.file(file)? } else { AskedFile::default() };
            let value = |key: &str| given.value(&format!("scene.surface.{key}")).map(str::to_owned);
            let described = describe_file(&file.name, &file.bytes, &asked, &value)?;
            let missing = described.missing.iter().map(|missing| {
                json!({ "key": missing.key, "example": missing.example, "why": missing.why, "instead": missing.instead })
            });
            let (page, error) = match described.map {
                Ok(page) => (Some(page), None),
                Err(error) => (None, Some(error)),
            };
            Ok(json!({
                "channels": serde_json::from_str::<serde_json::Value>(&described.channels).unwrap_or_default(),
                "missing": missing.collect::<Vec<_>>(),
                "page": page,
                "error": error,
            }))
        })
    }

    /// Reads and plans a question, as JSON: `{"scene", "plan", "notes", "memory", "grids"}`. `scene` is the text of the
    /// scene that gives the same numbers with the program, `memory` the bytes that the largest model needs.
    pub fn plan(&self, keys: &str) -> String {
        answer(|| {
            let scene = Given::parse(keys)?.scene(self.file.as_ref())?;
            let plan = Plan::new(&scene)?;
            Ok(json!({
                "scene": scene.text,
                "plan": plan.to_string(),
                "notes": scene.notes.iter().chain(&plan.notes).map(ToString::to_string).collect::<Vec<_>>(),
                "memory": required_memory(&scene),
                "grids": plan.models.iter().map(|model| model.grid.clone()).collect::<Vec<_>>(),
            }))
        })
    }

    /// Solves a question. Progress and states are told while it is under way.
    pub fn solve(&self, keys: &str) -> Solved {
        let solve = || -> Result<_, Mistake> {
            let scene = Given::parse(keys)?.scene(self.file.as_ref())?;
            let told = solved::Told::default();
            let scene = scene.with_grid_in_memory(&told, &contact_model::never)?;
            let plan = Plan::new(&scene)?;
            let run = run_in_memory(&scene, &plan, &told, &contact_model::never, &tell_state)?;
            Ok((scene, run))
        };
        Solved::new(solve())
    }
}

/// An answer as JSON: what `find` finds, or `{"mistake": {"message", "help", "key"}}`.
fn answer(find: impl FnOnce() -> Result<serde_json::Value, Mistake>) -> String {
    find().unwrap_or_else(|mistake| json!({ "mistake": mistake })).to_string()
}

impl From<Error> for Mistake {
    fn from(error: Error) -> Self {
        match error {
            Error::Scene(diagnostic) => Self::of(&diagnostic),
            other => Self::new(other.to_string()),
        }
    }
}
