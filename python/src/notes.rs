//! Notes on states in the words of Python.

use fractal_contact::scenes::Warning;
use pyo3::prelude::*;

/// What may be wrong with a state, a colon, and what to do about it.
pub fn note(warning: Warning) -> String {
    format!("{}: {}", warning.label(), advice(warning))
}

/// Notes on the states of a scene, with remedies in the words of Python.
#[pyfunction]
pub fn notes_of_python(notes: Vec<String>) -> Vec<String> {
    let told = |note: String| {
        let note = note.replace(Warning::EDGE_WITHOUT_TILT, EDGE_WITHOUT_TILT);
        Warning::ALL.iter().fold(note, |note, warning| note.replace(warning.advice(), advice(*warning)))
    };
    notes.into_iter().map(told).collect()
}

/// [`Warning::EDGE_WITHOUT_TILT`] in the words of Python.
const EDGE_WITHOUT_TILT: &str = "With a free boundary the edge then decides the answer too. Use a larger map or a smaller load, or write \
                                 `effects={\"boundary\": \"periodic\"}` if the surface is a part of a larger one.";

/// The remedy. Where it names a key of a scene, it has the keyword of Python instead.
fn advice(warning: Warning) -> &'static str {
    match warning {
        Warning::OneCell => {
            "If it is a spike of the measurement, remove it (`outliers=8` in fc.read_surface or fc.press, or `missing=HEIGHT` with its \
             height as in the file). Otherwise use smaller cells."
        }
        Warning::Edge => {
            "With a free boundary the edge then decides the answer too. Use a larger map or a smaller load, subtract a tilt \
             (`detrend=\"plane\"` in fc.read_surface or fc.press), or write `effects={\"boundary\": \"periodic\"}` if the surface is a part of a \
             larger one."
        }
        Warning::Yield => {
            "The bodies flow there, but this solution is elastic: the true area is larger and the true pressure is smaller. Write \
             `effects={\"hardness\": PRESSURE}`, which limits the pressure."
        }
        Warning::Coupling => {
            "These bodies differ in their compressibility, so the tractions act on each other (the second Dundurs constant is not 0). \
             Write `\"coupling\": \"full\"` in the friction, which solves both together."
        }
        Warning::Rim => {
            "Where the surface goes on below undefined points, these cells carry too much, and the area is too small. Compare with \
             `fill=\"neighbours\"` of fc.read_surface or fc.press in the place of `undefined`, which gives these points heights."
        }
        Warning::FewCells
        | Warning::Area
        | Warning::Accuracy
        | Warning::Stiffness
        | Warning::Lift
        | Warning::Depths => warning.advice(),
    }
}
