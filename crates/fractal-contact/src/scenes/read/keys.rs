//! The keys of a scene and their meaning, as the book prints them. The keys of `[effects]` and the outputs
//! that models answer have tables of their own.

/// Keys of a table that are described together.
#[derive(Debug)]
#[non_exhaustive]
pub struct SceneKeys {
    /// The table, as `scene.surface`.
    pub table: &'static str,
    /// Where these keys belong to one kind of the table, the line that selects it, as `kind = "file"`;
    /// otherwise empty.
    pub kind: &'static str,
    /// The keys in groups; at most one key of a group may be given.
    pub groups: &'static [&'static [&'static str]],
    /// A description in Markdown; it names the keys of tables that are their values.
    pub about: &'static str,
    /// The default; empty where the keys are required.
    pub default: &'static str,
}

impl SceneKeys {
    /// The keys, in Markdown.
    pub fn words(&self) -> String {
        let group =
            |keys: &&[&str]| keys.iter().map(|key| format!("`{key}`")).collect::<Vec<_>>().join(" or ");
        self.groups.iter().map(group).collect::<Vec<_>>().join(", ")
    }
}

const fn keys(
    table: &'static str,
    groups: &'static [&'static [&'static str]],
    about: &'static str,
    default: &'static str,
) -> SceneKeys {
    SceneKeys { table, kind: "", groups, about, default }
}

const fn random(
    groups: &'static [&'static [&'static str]],
    about: &'static str,
    default: &'static str,
) -> SceneKeys {
    SceneKeys { table: "scene.surface", kind: "kind = \"self_affine\"", groups, about, default }
}

const fn file(
    groups: &'static [&'static [&'static str]],
    about: &'static str,
    default: &'static str,
) -> SceneKeys {
    SceneKeys { table: "scene.surface", kind: "kind = \"file\"", groups, about, default }
}

/// Every key of a scene but those of [`crate::scenes::EFFECT_KEYS`] and [`contact_model::Output::ALL`].
pub static SCENE_KEYS: &[SceneKeys] = &[
    keys("scene", &[&["units"]], "`\"si\"` or `\"none\"`", "`\"si\"`"),
    keys("scene", &[&["models"]], "names, in the order of the results", ""),
    keys(
        "scene",
        &[&["contact_modulus", "bodies"]],
        "E* of the pair; or two of `\"rigid\"`, `{ young, poisson }` (friction needs them)",
        "",
    ),
    keys(
        "scene",
        &[&["force", "force_bar", "mean_pressure", "approach", "mean_gap"]],
        "a number, a list or `{ from, to, count, spacing }`; `spacing` is `\"log\"` or `\"linear\"`",
        "logarithmic",
    ),
    keys(
        "scene",
        &[&["hardness"]],
        "pressure above which a state has a note; the contact stays elastic",
        "E*/10",
    ),
    keys(
        "scene",
        &[&["accuracy"]],
        "share (`\"1 %\"` or 0.01) that the error of the grid may have, instead of `cells` and `tolerance`; or \
         `\"best\"`: as small as `budget` and `memory` allow",
        "",
    ),
    keys(
        "scene",
        &[&["budget"]],
        "time that `accuracy` may take, as predicted from the sizes for one thread of a [reference \
         machine](scene-results.md#the-grid-for-an-accuracy); it chooses the same grid on every machine",
        "`\"10 min\"`",
    ),
    keys(
        "scene",
        &[&["memory"]],
        "memory of one surface that `accuracy` may take, in MB, GB or TB; a machine that has less than the grid \
         needs refuses",
        "`\"4 GB\"`",
    ),
    keys("scene.path", &[&["time"]], "end of a straight piece of the path", "that of the step before"),
    keys(
        "scene.path",
        &[&["force", "mean_pressure", "approach", "mean_gap"]],
        "normal load there",
        "that of the step before",
    ),
    keys(
        "scene.path",
        &[&["tangential_force", "tangential_displacement"]],
        "one value along x, or a pair along x and y; a force of [at most mu F](friction.md#one-step-is-one-increment)",
        "that of the step before",
    ),
    keys(
        "scene.path",
        &[&["states"]],
        "number of equal parts of the piece, each with a state at its end; a quantity prescribed anew begins at its value in the state reached",
        "1",
    ),
    random(
        &[&["kind"], &["side", "size"], &["fractal_dimension", "hurst"], &["rms_height"]],
        "a random surface",
        "",
    ),
    random(
        &[&["roll_off_wavelength"], &["shortest_wavelength"]],
        "constant spectrum above, none below",
        "none, the grid's",
    ),
    random(
        &[&["anisotropy"], &["lay"]],
        "ratio of wavelengths along the lay and [across](surfaces.md#anisotropic); direction of the lay in degrees \
         from x towards y",
        "isotropic, 0",
    ),
    random(
        &[&["weibull"]],
        "shape of [Weibull's law](surfaces.md#skewed) of the heights; not with `accuracy`",
        "nearly Gaussian",
    ),
    file(
        &[&["kind"], &["path"]],
        "a map: [formats](measured.md#formats); the path counts from the scene's folder",
        "",
    ),
    file(
        &[&["channel"]],
        "number (from 0) or name of the map, where a file has several",
        "the only one of heights",
    ),
    file(
        &[
            &["format"],
            &["unit"],
            &["lateral_unit"],
            &["size", "cell"],
            &["decimal"],
            &["missing"],
            &["skip_lines"],
        ],
        "how to read the file, where it does not say so itself; `missing` is a number, which may be `inf`",
        "",
    ),
    file(
        &[&["axes"]],
        "`\"xy\"` or `\"yx\"`: what the two indices of an array are (HDF5, MATLAB, NetCDF without names)",
        "the convention of the format, with a note",
    ),
    file(
        &[&["border"]],
        "`\"axes\"` or `\"heights\"`: what the first line and the first column of a matrix are, where they may be \
         coordinates",
        "an error",
    ),
    file(&[&["height_scale"]], "height of one count, for a file of counts", ""),
    file(
        &[&["undefined", "fill"]],
        "points without a height (NaN, `missing`): `undefined = \"no_contact\"` keeps them, and they cannot \
         touch; `fill` gives them one: `\"neighbours\"`, `\"plane\"` or a height",
        "an error",
    ),
    file(
        &[&["crop"]],
        "`\"centre\"` (the largest square), `\"defined\"` (the largest rectangle without undefined points) or \
         `{ row, column, rows, columns }`; `cells` for as many rows as columns",
        "nothing",
    ),
    file(
        &[&["align_lines"]],
        "`\"median_difference\"` or `\"median\"`: scan lines (rows) are shifted to a common height, \
         [errors of scanning](preprocessing.md#errors-of-scanning)",
        "none",
    ),
    file(
        &[&["scars"]],
        "streaks along x that deviate by more than this number of robust standard deviations of the differences \
         between rows become undefined",
        "none",
    ),
    file(
        &[&["outliers"]],
        "heights farther from the median of their neighbours than this number of robust standard deviations become \
         undefined",
        "none",
    ),
    file(
        &[&["tip_radius"]],
        "radius of the tip of the instrument; the distance from which on heights are reliable is reported",
        "",
    ),
    file(
        &[&["detrend"]],
        "of least squares: `\"none\"`, `\"mean\"`, `\"plane\"`, `\"quadric\"`, `\"sphere\"`, `\"cylinder\"`",
        "none",
    ),
    file(
        &[&["filter_across"]],
        "cut-off wavelength of a Gaussian low-pass filter across the scan lines (along y), between four cells and \
         the side",
        "none",
    ),
    file(
        &[&["cells"], &["rows"]],
        "columns and rows after averaging over larger cells; one alone keeps the shape of the cells",
        "those of the file",
    ),
    file(
        &[&["mirror"], &["rotate"]],
        "`\"x\"` or `\"y\"` reversed; then turned by 0, 90, 180 or 270 degrees from x to y",
        "",
    ),
    file(
        &[&["window"]],
        "`\"hann\"`, for periodic boundaries: deviations from the mean are tapered towards the edges and divided \
         by the rms of the taper",
        "",
    ),
    file(
        &[&["twin"]],
        "`\"waves\"` or `\"rings\"`: a random surface with the spectrum of the map, [a twin](surfaces.md#twin)",
        "the map itself",
    ),
    file(&[&["keep_heights"]], "whether a twin has the distribution of the map's heights", "false"),
    keys(
        "scene.second_surface",
        &[],
        "keys of a file: the surface of the second body, [added to the first](bodies.md#two-rough-bodies)",
        "",
    ),
    keys(
        "scene.second_surface",
        &[&["facing"]],
        "axis that is reversed when the surface is turned over to face the first: `\"x\"`, `\"y\"` or \
         `\"none\"`",
        "`\"x\"`",
    ),
    keys(
        "scene.second_surface",
        &[&["offset"]],
        "displacement of its centre from that of the first surface, `[x, y]`",
        "0",
    ),
    keys(
        "scene.body",
        &[&["kind"]],
        "a body added to the surface, or alone: `sphere` (`radius`), `cone` (`slope`), `power_law` (`exponent`, \
         `depth` at `radius`), `flat_circle` (`radius`), `flat` (also `flat_square`), `sine` (`amplitude`, \
         `wavelength`)",
        "",
    ),
    keys("scene.body", &[&["side", "size"]], "sides of the rectangle; not together with a surface", ""),
    keys("models.bem3d", &[&["cells"], &["rows"]], "columns and rows", "257, nearly square cells"),
    keys(
        "models.bem3d",
        &[&["tolerance"], &["max_outer_iterations"]],
        "tolerance and largest number of outer iterations of the solver",
        "1e-6, 200",
    ),
    keys("models.bem3d", &[&["method"]], "`\"auto\"`, `\"iterative\"`, `\"single_level\"`", "`\"auto\"`"),
    keys("models.mdr1d", &[&["elements"]], "number of elements of a rough line", "65536"),
    keys(
        "models.equivalent",
        &[&["per_decade"], &["decades"]],
        "the table of k(d); and the keys of `bem3d`",
        "16, 3",
    ),
    keys("models.persson", &[&["gamma"]], "elastic energy over that of full contact", "0.45"),
    keys(
        "models.greenwood_williamson",
        &[&["heights"]],
        "`\"gaussian\"` or `\"exponential\"`",
        "`\"gaussian\"`",
    ),
    keys(
        "sampling",
        &[&["seed"]],
        "required for random surfaces, and for `mdr1d` on a file, which draws random lines; surface i has the seed \
         of surface i of the figures",
        "",
    ),
    keys("sampling", &[&["surfaces"]], "number of surfaces", "1"),
    keys(
        "outputs",
        &[&["drawn_states"]],
        "numbers of the loads or steps (from 0) whose fields are drawn, in files and in the report: `[3, 9]`",
        "all",
    ),
    keys(
        "outputs",
        &[&["heights"]],
        "formats of the map as `bem3d` solved it, after crop, fill and detrend",
        "none",
    ),
    keys("outputs", &[&["curves"]], "true: curves over the load as SVG and PNG", "false"),
    keys(
        "outputs",
        &[&["distributions"]],
        "of `\"pressure\"`, `\"gap\"`, `\"patches\"` (areas of connected contacts): CSV and picture",
        "none",
    ),
    keys(
        "outputs",
        &[&["grid_error"]],
        "true: `bem3d` compares each state with cells twice and four times as large",
        "false",
    ),
    keys(
        "outputs",
        &[&["statistics"]],
        "true: parameters of ISO 25178, spectra, height differences, fit of the surface: \
         [tables and pictures](surfaces.md)",
        "false",
    ),
];

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::scenes::{EFFECT_KEYS, SceneFile};
    use contact_model::Output;
    use std::cell::RefCell;
    use std::collections::BTreeSet;

    thread_local! {
        /// Tables and keys that were read.
        static ASKED: RefCell<BTreeSet<(String, &'static str)>> = const { RefCell::new(BTreeSet::new()) };
    }

    pub(crate) fn record(table: &str, key: &'static str) {
        ASKED.with_borrow_mut(|asked| asked.insert((table.to_owned(), key)));
    }

    /// Names of older versions, which are read and not recommended.
    const OLDER: [&str; 3] = ["modulus", "chance", "width"];

    fn of(table: &str) -> impl Iterator<Item = &'static SceneKeys> {
        SCENE_KEYS.iter().filter(move |keys| keys.table == table)
    }

    fn has(keys: &SceneKeys, key: &str) -> bool {
        keys.groups.iter().any(|group| group.contains(&key))
    }

    fn is_declared(table: &str, key: &str) -> bool {
        let below = if table.is_empty() { key.to_owned() } else { format!("{table}.{key}") };
        let is_table =
            SCENE_KEYS.iter().any(|keys| keys.table == below || keys.table.starts_with(&format!("{below}.")));
        // What is said of a key names the keys of its value.
        let (parent, own) = table.rsplit_once('.').unwrap_or(("", table));
        let parent = if parent == "scene.second_surface" { "scene.surface" } else { parent };
        let of_value = of(parent).any(|keys| has(keys, own) && keys.about.contains(key));
        let kind = of(table).any(|keys| keys.about.contains(&format!("`{key}`")));
        let of_file = table == "scene.second_surface" && of("scene.surface").any(|keys| has(keys, key));
        let of_bem3d = table == "models.equivalent" && of("models.bem3d").any(|keys| has(keys, key));
        let effect = EFFECT_KEYS.iter().any(|effect| {
            table == "effects" && effect.name == key
                || table == format!("effects.{}", effect.name) && effect.takes.contains(key)
        });
        let output = Output::ALL.iter().any(|output| table == "outputs" && output.name() == key);
        let conductance =
            table == "outputs.conductance" && ["kind", "resistivities", "conductivities"].contains(&key);
        // Each model has a table, which may have no key.
        let others = table == "models" || below == "effects" || OLDER.contains(&key);
        of(table).any(|keys| has(keys, key))
            || [is_table, of_value, kind, of_file, of_bem3d, effect, output, conductance, others]
                .contains(&true)
    }

    /// Every key that is read from the scenes of the repository is declared, and every declared key is read.
    #[test]
    fn what_is_read_is_what_is_declared() {
        ASKED.with_borrow_mut(BTreeSet::clear);
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes");
        for folder in [folder.clone(), folder.join("bad")] {
            for entry in std::fs::read_dir(&folder).unwrap() {
                let path = entry.unwrap().path();
                if path.extension().is_some_and(|extension| extension == "toml") {
                    // Those in `bad` fail, each after some keys.
                    let _ = SceneFile::read(&path);
                }
            }
        }
        // Tables that no scene of the repository has.
        let theories = "[scene]\nunits = \"none\"\nmodels = [\"persson\", \"greenwood_williamson\"]\ncontact_modulus = 1\n\
                        [models.persson]\n[models.greenwood_williamson]\n";
        let _ = SceneFile::parse(std::path::Path::new("theories.toml"), theories.into());
        let asked = ASKED.with_borrow(Clone::clone);
        let unknown: Vec<_> = asked.iter().filter(|(table, key)| !is_declared(table, key)).collect();
        assert!(unknown.is_empty(), "read but not in SCENE_KEYS: {unknown:?}");
        let known = |table: &str, key: &str| asked.iter().any(|(t, k)| t == table && *k == key);
        let never: Vec<_> = SCENE_KEYS
            .iter()
            .flat_map(|keys| keys.groups.iter().copied().flatten().map(|key| (keys.table, *key)))
            .filter(|(table, key)| !known(table, key))
            .collect();
        assert!(never.is_empty(), "in SCENE_KEYS, but no scene is asked for them: {never:?}");
    }
}
