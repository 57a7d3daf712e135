//! What was meant by a name that is no key: other words for keys, and questions that this program does not answer,
//! with what comes nearest to them. Scenes and flags are told by the same table.

/// Words that stand for a key, or for something that is not computed.
struct OtherWords {
    /// Small letters, with `_` between words.
    words: &'static [&'static str],
    /// The table of the key and its name; empty where nothing is computed.
    table: &'static str,
    key: &'static str,
    /// How it is written in a scene, or what there is instead.
    scene: &'static str,
    /// How it is written as a flag of `press`; empty where there is none, and the scene decides.
    flag: &'static str,
}

const fn key(
    (table, key): (&'static str, &'static str),
    words: &'static [&'static str],
    scene: &'static str,
    flag: &'static str,
) -> OtherWords {
    OtherWords { words, table, key, scene, flag }
}

/// What is not computed, and what comes nearest.
const fn nothing(words: &'static [&'static str], instead: &'static str) -> OtherWords {
    OtherWords { words, table: "", key: "", scene: instead, flag: "" }
}

const BODIES: &str = "Young's modulus and Poisson's ratio of both bodies are `bodies = [{ young = \"210 GPa\", poisson = 0.3 }, \
                      { young = \"70 GPa\", poisson = 0.33 }]` in [scene]";
const BODIES_FLAG: &str =
    "Young's modulus and Poisson's ratio of both bodies are `--bodies '210 GPa 0.3, 70 GPa 0.33'`";
const BALL: &str = "a ball is a table of its own: [scene.body] with `kind = \"sphere\"`, `radius = \"10 mm\"` and, without a map, `side = \"1 mm\"`, \
     the side of the square around the contact";
const BALL_FLAG: &str = "a ball under the map is `--ball '10 mm'`, its radius";
const MAP: &str =
    "a measured map is a table of its own: [scene.surface] with `kind = \"file\"` and `path = \"map.sur\"`";
const MAP_FLAG: &str = "the file of the map stands without a flag: `fractal-contact press map.sur`";
const RESISTANCE: &str = "a contact resistance is the inverse of the conductance: `conductance = { kind = \"electrical\", resistivities = [\"1.7e-8 \
                          Ohm m\", \"1.7e-8 Ohm m\"] }`, or thermal with `conductivities`, in [outputs]";

const TABLE: &[OtherWords] = &[
    key(
        ("scene.bodies", "young"),
        &[
            "young",
            "youngs",
            "e",
            "e1",
            "e2",
            "youngs_modulus",
            "young_modulus",
            "young_s_modulus",
            "e_modulus",
            "elastic_modulus",
            "elasticity",
            "material",
            "materials",
        ],
        BODIES,
        BODIES_FLAG,
    ),
    key(
        ("scene.bodies", "poisson"),
        &["poisson", "nu", "nu1", "nu2", "poissons_ratio", "poisson_ratio", "poisson_s_ratio"],
        BODIES,
        BODIES_FLAG,
    ),
    key(
        ("scene", "contact_modulus"),
        &[
            "e_star",
            "estar",
            "e*",
            "reduced_modulus",
            "effective_modulus",
            "modulous",
            "moduli",
            "composite_modulus",
        ],
        "E* of the pair is `contact_modulus = \"115 GPa\"` in [scene]; `bodies` has Young's moduli",
        "E* of the pair is `--contact-modulus '115 GPa'`; `--bodies` has Young's moduli",
    ),
    key(
        ("scene", "force"),
        &["load", "loads", "normal_load", "normal_force", "f", "fn", "f_n", "forces", "preload"],
        "a normal force is `force = \"1 N\"` in [scene], and a pressure over the area of the map `mean_pressure`",
        "a normal force is `--force '1 N'`, and a pressure over the area of the map `--pressure '1 MPa'`",
    ),
    key(
        ("scene", "mean_pressure"),
        &["pressure", "nominal_pressure", "normal_pressure", "pressures", "p", "stress"],
        "a load by its pressure over the nominal area is `mean_pressure = \"1 MPa\"` in [scene]; `pressure` in [outputs] is the field",
        "a load by its pressure over the area of the map is `--pressure '1 MPa'`",
    ),
    key(
        ("scene", "approach"),
        &["indentation", "displacement", "depth", "indentation_depth", "delta"],
        "a load by its distance is `approach = \"10 nm\"` in [scene], counted from first touch",
        "a load by its distance is `--approach '10 nm'`, counted from first touch",
    ),
    key(
        ("scene.path", "tangential_force"),
        &["tangential_force", "shear_force", "lateral_force", "tangential_load", "friction_force", "q"],
        "a tangential load belongs into a step of a path: move `force` from [scene] into a first [[scene.path]], and write \
         `tangential_force` into a second one; [effects] has the `friction` that holds it",
        "a tangential force is `--tangential-force '0.1 N'`, with `--friction 0.3` that holds it",
    ),
    key(
        ("scene.path", "states"),
        &["steps", "increments", "substeps"],
        "the number of states of a step is `states = 8` in its [[scene.path]]",
        "",
    ),
    key(
        ("scene.body", "radius"),
        &["ball", "sphere", "indenter", "punch", "radius", "diameter"],
        BALL,
        BALL_FLAG,
    ),
    key(("scene.surface", "path"), &["map", "file", "filename", "topography", "heights_file"], MAP, MAP_FLAG),
    key(
        ("scene.surface", "rms_height"),
        &["rms", "roughness", "sq", "rq", "rms_roughness"],
        "the rms height of a random surface is `rms_height = \"1 um\"` in [scene.surface] with `kind = \"self_affine\"`",
        "`press` takes a measured map, whose roughness is in its heights; `fractal-contact surface` makes a random one",
    ),
    key(
        ("effects", "friction"),
        &["friction", "friction_coefficient", "coefficient_of_friction", "mu", "cof"],
        "friction is an effect: `friction = { coefficient = 0.3 }` in [effects]. It acts along a path: move `force` from [scene] into a \
         first [[scene.path]], and write `tangential_force` into a second one",
        "a coefficient of friction is `--friction 0.3`, with `--tangential-force '0.1 N'`",
    ),
    key(
        ("effects", "hardness"),
        &["yield", "yield_stress", "yield_strength", "plasticity", "plastic", "hv"],
        "plastic flow is `hardness = \"2 GPa\"` in [effects], the largest pressure that the softer body bears; about 3 times its yield stress",
        "plastic flow is `--hardness '2 GPa'`, the largest pressure that the softer body bears; about 3 times its yield stress",
    ),
    key(
        ("effects", "adhesion"),
        &["adhesion", "jkr", "dmt", "work_of_adhesion", "surface_energy", "gamma"],
        "adhesion is an effect: `adhesion = { work = \"50 mJ/m^2\" }` in [effects]",
        "adhesion is `--set 'effects.adhesion={ work = \"50 mJ/m^2\" }'`",
    ),
    key(
        ("effects", "rheology"),
        &["viscosity", "viscoelasticity", "viscoelastic", "creep", "relaxation", "prony"],
        "a viscoelastic body is `rheology` in [effects], for the models bem3d, mdr1d_viscoelastic and equivalent",
        "viscoelastic bodies need a scene: `rheology` in [effects], for the models bem3d, mdr1d_viscoelastic and equivalent",
    ),
    key(
        ("effects", "boundary"),
        &["boundary", "periodic", "boundaries", "boundary_conditions", "pbc"],
        "`boundary = \"periodic\"` or `\"free\"` belongs into [effects]",
        "`--boundary periodic` or `--boundary free`",
    ),
    key(
        ("outputs", "conductance"),
        &[
            "contact_resistance",
            "resistance",
            "thermal_resistance",
            "electrical_resistance",
            "thermal_conductance",
            "electrical_conductance",
            "contact_conductance",
            "heat_transfer",
        ],
        RESISTANCE,
        "",
    ),
    key(
        ("outputs", "area"),
        &["contact_area", "real_area", "true_area", "area_fraction", "contact_fraction"],
        "the real contact area and its share of the map are `area = true` in [outputs]",
        "`press` always tells the real contact area",
    ),
    key(
        ("models", "cells"),
        &["grid", "resolution", "mesh", "nx", "ny"],
        "the number of cells a side is `cells = 512` in the table of the model, [models.bem3d]",
        "the number of cells a side is `--cells 512`",
    ),
    key(
        ("sampling", "surfaces"),
        &["random_seed", "realisations", "realizations", "samples"],
        "random surfaces have `seed = 1` and `surfaces = 20` in [sampling]",
        "",
    ),
    key(
        ("outputs", "leakage"),
        &["leakage", "leak", "flow", "permeability", "seal"],
        "the leakage is requested by `leakage = { viscosity = \"1 mPa s\", pressure_drop = \"1 bar\", along = \"x\" }` in [outputs]",
        "the leakage is requested by `--set 'outputs.leakage={ viscosity = \"1 mPa s\", pressure_drop = \"1 bar\", along = \"x\" }'`",
    ),
    key(
        ("outputs", "percolation"),
        &["percolation", "percolates", "threshold", "constriction"],
        "paths through the gap, and their narrowest place, are requested by `percolation = true` in [outputs]",
        "paths through the gap are requested by `--set outputs.percolation=true`",
    ),
    nothing(
        &["lubrication", "lubricant", "oil", "fluid", "viscosity_of_oil", "film_thickness"],
        "no lubrication is computed, a fluid does not lift the bodies: `leakage` in [outputs] is its flow through the gap of the dry contact",
    ),
    nothing(
        &["wear", "archard", "wear_coefficient", "wear_rate"],
        "no wear is computed: with friction, `slip = [\"npy\"]` in [outputs] and the column `dissipated` are what a law of wear takes",
    ),
    nothing(
        &["temperature", "heat", "flash_temperature", "thermal"],
        "no temperature is computed: `conductance = { kind = \"thermal\", conductivities = [...] }` in [outputs] is the thermal conductance, and \
         the column `dissipated` the energy that friction takes",
    ),
    key(
        ("effects", "layer"),
        &["coating", "layer", "layers", "thickness", "substrate", "film_on_substrate"],
        "a coating, or a layer of finite thickness, is `layer = { thickness = \"2 um\", young = \"400 GPa\", poisson = 0.2, base = { young = \"210 GPa\", poisson = 0.3 } }` in [effects]",
        "a coating, or a layer of finite thickness, is `layer` in [effects] of a scene",
    ),
    key(
        ("outputs", "stress_below"),
        &["stress_below", "subsurface", "von_mises", "subsurface_stress", "mises"],
        "the largest stress below the surface is requested by `stress_below = { depths = [\"1 um\", \"2 um\", \"5 um\"] }` in [outputs]",
        "the largest stress below the surface is requested by `--set 'outputs.stress_below={ depths = [\"1 um\", \"2 um\", \"5 um\"] }'`",
    ),
    nothing(
        &["velocity", "speed", "sliding_speed", "frequency"],
        "bodies move slowly here: a path has `time` with a `rheology`, and friction does not depend on the speed",
    ),
];

/// Where to read more about what is not computed.
const NOT_HERE: &str = "\"What is not here\" in the book names programs that have it";

fn plain(name: &str) -> String {
    name.trim_start_matches('-').to_lowercase().replace(['-', ' ', '.'], "_")
}

/// Returns advice for a name that is not a key of `table`, which is `scene`, `scene.bodies` or another one: how the
/// key that the name stands for is written, or what there is instead of it. A name that [`TABLE`] lacks has none.
pub(crate) fn meant(table: &str, name: &str) -> Option<String> {
    let word = plain(name);
    let of = TABLE.iter().find(|of| of.words.contains(&&*word))?;
    Some(match of {
        OtherWords { table: "", scene, .. } => format!("{scene}; {NOT_HERE}"),
        // The name of an output or an effect says too little.
        of if of.table == table && of.key != word && !["outputs", "effects"].contains(&table) => {
            format!("write `{}` for `{name}`", of.key)
        }
        of => of.scene.to_owned(),
    })
}

/// Returns advice for a flag that `press` does not have: the flag that it stands for, or what there is instead of
/// it. A name that [`TABLE`] lacks has none.
pub(crate) fn meant_by_flag(flag: &str) -> Option<String> {
    let word = plain(flag);
    let of = TABLE.iter().find(|of| of.words.contains(&&*word))?;
    Some(match of {
        OtherWords { table: "", scene, .. } => format!("{scene}; {NOT_HERE}"),
        OtherWords { flag: "", scene, .. } => {
            format!("{scene}; `--set TABLE.KEY=VALUE` sets a key for which there is no flag")
        }
        of => of.flag.to_owned(),
    })
}

/// Whether a name is another word for a key of this table.
pub(crate) fn stands_for(table: &str, key: &str, name: &str) -> bool {
    let word = plain(name);
    TABLE.iter().any(|of| of.table == table && of.key == key && of.words.contains(&&*word))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::read::outputs::OUTPUT_KEYS;
    use contact_model::{Effect, Output};

    #[test]
    fn a_word_stands_in_one_place() {
        let mut words: Vec<&str> = TABLE.iter().flat_map(|of| of.words).copied().collect();
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), count);
    }

    /// A hint that outlives its limitation would deny what a key does.
    #[test]
    fn nothing_that_is_an_output_or_an_effect_is_denied() {
        let outputs = OUTPUT_KEYS.keys.iter().map(|key| key.name).chain(Output::ALL.iter().map(|o| o.name()));
        let effects = Effect::ALL.iter().map(|effect| effect.key());
        for name in outputs.chain(effects) {
            let denied = TABLE.iter().find(|of| of.table.is_empty() && of.words.contains(&name));
            assert!(denied.is_none(), "{name}: {}", denied.map_or("", |of| of.scene));
        }
    }

    #[test]
    fn other_words_are_told() {
        assert_eq!(meant("scene.bodies", "E").unwrap(), "write `young` for `E`");
        assert!(meant("scene", "young").unwrap().contains("`bodies = [{ young = "));
        assert!(meant("outputs", "leak").unwrap().starts_with("the leakage is requested by `leakage = {"));
        assert!(meant("scene", "nonsense").is_none());
        assert!(meant_by_flag("--load").unwrap().contains("`--force '1 N'`"));
    }
}
