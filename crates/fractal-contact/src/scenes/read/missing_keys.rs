//! The keys that the file of a map needs because it does not say the same itself.

use surface_io::Metadata;

/// A key of `[scene.surface]` that is missing.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct MissingKey {
    /// Its name.
    pub key: &'static str,
    /// An example of its value.
    pub example: &'static str,
    /// The meaning of the key, and the reason why this map needs it.
    pub why: String,
    /// A key that can be given in its place, and what that says.
    pub instead: Option<(&'static str, &'static str)>,
}

/// The keys that a map needs and that neither its file says nor `given`, which returns the value of a key: the unit
/// of its heights, the size of its cells, and what its undefined points are.
pub fn missing_keys(map: &Metadata, given: &dyn Fn(&str) -> Option<String>) -> Vec<MissingKey> {
    let has = |key: &str| given(key).is_some();
    let mut missing = Vec::new();
    let mut add = |key, example, why, instead| missing.push(MissingKey { key, example, why, instead });
    if map.unit.is_none() && !has("unit") && !has("height_scale") {
        let why = format!("unit of the heights, which this file ({}) does not hold", map.format);
        add("unit", "nm", why, None);
    }
    if map.size.is_none() && !has("size") && !has("cell") {
        let why = format!("side of one of the {} x {} cells of the map", map.columns, map.rows);
        add("cell", "0.5 um", why, Some(("size", "side of the whole map")));
    }
    let cropped = given("crop").is_some_and(|crop| crop == "defined");
    if map.undefined > 0 && !has("undefined") && !has("fill") && !cropped {
        let why = format!("{} points have no height: with no_contact they cannot touch", map.undefined);
        add("undefined", "no_contact", why, Some(("fill", "gives them a height, as `neighbours` does")));
    }
    missing
}
