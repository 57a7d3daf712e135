//! Checks of the documents: pages and tables that are generated from the tables of quantities and of models
//! and from the sources, and rules for the others. With `UPDATE_DOCUMENTS=1` the generated parts are written
//! anew.

mod constants;
mod crates;
mod names;
mod phrases;
mod readmes;
mod sources;

use crate::abilities::told;
use contact_model::quantities::{Average, Compared, QUANTITIES, Role, StateQuantity};
use contact_model::{Effect, Output};
use fractal_contact::models::{MODELS, ModelRecord, abilities};
use fractal_contact::scenes::{EFFECT_KEYS, EffectKey, SceneKey, scene_keys};
use std::collections::BTreeSet;
use std::path::PathBuf;

const BEGIN: &str = "<!-- generated: ";
const END: &str = "<!-- end of what is generated -->";

/// The symbol of a quantity without commands of TeX.
fn symbol(quantity: &StateQuantity) -> String {
    let mut symbol = quantity.symbol.replace("\\rm", "");
    while let Some(at) = symbol.find("\\bar{") {
        let end = symbol[at..].find('}').map_or(symbol.len(), |end| at + end);
        symbol = format!("{}{}_bar{}", &symbol[..at], &symbol[at + 5..end], &symbol[end + 1..]);
    }
    symbol.replace(['{', '}', '\\'], "")
}

/// The models that report a quantity for some state; each model is tried.
fn claimed_by(quantity: &StateQuantity, told: &[BTreeSet<&'static str>]) -> String {
    let claims = MODELS.iter().zip(told).filter(|(_, told)| told.contains(quantity.name));
    let names: Vec<&str> = claims.map(|(record, _)| record.name()).collect();
    if names.len() == MODELS.len() { "all".into() } else { names.join(", ") }
}

fn row(cells: &[&str]) -> String {
    format!("| {} |\n", cells.iter().map(|cell| cell.replace('|', "\\|")).collect::<Vec<_>>().join(" | "))
}

fn table(heads: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = row(heads) + &"|---".repeat(heads.len()) + "|\n";
    for cells in rows {
        text += &row(&cells.iter().map(String::as_str).collect::<Vec<_>>());
    }
    text
}

/// Rows of the glossary.
fn glossary() -> String {
    let told = QUANTITIES.iter().filter(|quantity| !matches!(quantity.role, Role::Work));
    let cells = |quantity: &StateQuantity| {
        let name = format!("`{}`", quantity.name);
        vec![name, symbol(quantity), quantity.unit.words().into(), quantity.meaning.into()]
    };
    table(&["quantity", "symbol", "unit", "meaning"], told.map(cells))
}

fn quantities_page() -> String {
    let average = |quantity: &StateQuantity| match quantity.average {
        Average::Mean => "mean, standard error, deviation",
        Average::Same => "the same on all",
        Average::No => "",
    };
    let compared = |quantity: &StateQuantity| match quantity.compared {
        Compared::Yes => "yes",
        Compared::Periodic => "periodic, resolved waves",
        Compared::No => "",
    };
    let told: Vec<BTreeSet<&str>> = MODELS.iter().map(|record| told(record.model)).collect();
    let rows = |wanted: &dyn Fn(Role) -> bool| {
        let cells = |quantity: &StateQuantity| {
            vec![
                format!("`{}`", quantity.name),
                symbol(quantity),
                quantity.unit.words().to_owned(),
                quantity.meaning.to_owned(),
                quantity.asked_by.words(),
                claimed_by(quantity, &told),
                average(quantity).to_owned(),
                compared(quantity).to_owned(),
            ]
        };
        let heads =
            ["column", "symbol", "unit", "meaning", "requested by", "models", "over surfaces", "grid error"];
        table(&heads, QUANTITIES.iter().filter(|quantity| wanted(quantity.role)).map(cells))
    };
    let mut sources = String::new();
    for quantity in QUANTITIES.iter().filter(|quantity| !quantity.source.is_empty()) {
        sources.push_str(&["- `", quantity.name, "`: ", quantity.source, "\n"].concat());
    }
    format!(
        "# Quantities of a state\n\n\
         What does a column of `results.csv` mean, in which unit is it, and which models report it? The tables of this\n\
         page list every quantity of a contact state. They are made from the table of the program itself\n\
         (`contact_model::quantities`), and the column `models` was found by trying each model.\n\n\
         Units are SI. In a scene with `units = \"none\"` the numbers are in the units of the scene.\n\n\
         Each row of `results.csv` begins with `model`, `surface` and `state`, under loads also with `prescribed`, and\n\
         ends with `note`. In `ensemble.csv` a column has the mean over the surfaces. The columns that end in `_se` have\n\
         the standard error of this mean, and those that end in `_sd` the standard deviation of one surface. With\n\
         `grid_error = true` a quantity whose discretisation error is estimated also has the columns `_grid_error` and\n\
         `_grid_order`.\n\n\
         ## Answers\n\n{}\n## Residuals\n\nThese numbers are small where the equations were solved well ([certificates](certificates.md)):\n\n{}\n\
         ## How it was found, and what it cost\n\n{}\n## Sources\n\n{sources}",
        rows(&|role| matches!(role, Role::Answer | Role::Normalised | Role::OfPath)),
        rows(&|role| matches!(role, Role::Residual(_))),
        rows(&|role| matches!(role, Role::Work)),
    )
}

fn models_page() -> String {
    let cells = |record: &ModelRecord| {
        let mut cells = vec![format!("`{}`", record.name())];
        cells.extend(abilities(record.model).into_iter().map(|(_, words)| words.join(", ")));
        cells
    };
    let about = |record: &ModelRecord| {
        vec![format!("`{}`", record.name()), record.about.to_owned(), record.accuracy.to_owned()]
    };
    format!(
        "# What each model can do\n\n\
         Which surfaces, boundaries, effects, loads and outputs does each model take? The first table has one row for\n\
         each model. Each model declares these abilities as data (`ContactModel::abilities`), and in Python they are\n\
         `model.supports`. A scene that needs more is refused before anything is computed. The error names the models\n\
         that can answer it.\n\n\
         [Which effects go together](#which-effects-go-together) stands below.\n\n{}\n## Which effects go together\n\n\
         Effects that a model takes one by one need not go together. These tables have the models that take more than\n\
         one. A number stands where a scene with both is refused, and the list below the table has the reason. A dash\n\
         stands where both are settings of one key, of which a scene has one. The boundary goes with every effect.\n\
         `Abilities::not_combined` of each model holds the same as data, and in Python it is `combinations()`.\n\n{}\
         ## What they are\n\n{}",
        table(
            &["model", "surfaces", "boundaries", "effects", "needs", "loads", "paths", "outputs"],
            MODELS.iter().map(cells)
        ),
        MODELS.iter().filter_map(combinations).collect::<String>(),
        table(&["model", "what it is", "what to expect of its numbers"], MODELS.iter().map(about)),
    )
}

/// Which effects of a model go together; `None` for a model with a single key of effects.
fn combinations(record: &ModelRecord) -> Option<String> {
    let abilities = record.model.abilities();
    let effects: Vec<Effect> =
        Effect::ALL.iter().copied().filter(|effect| abilities.effects.contains(effect)).collect();
    if effects.iter().all(|effect| effect.key() == effects[0].key()) {
        return None;
    }
    let mut reasons: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for (i, one) in effects.iter().enumerate() {
        let mut row = vec![one.words().to_owned()];
        for (j, other) in effects.iter().enumerate() {
            row.push(if i == j {
                String::new()
            } else if let Some(reason) = abilities.reason_against(*one, *other) {
                if !reasons.contains(&reason) {
                    reasons.push(reason);
                }
                (1 + reasons.iter().position(|known| *known == reason).unwrap()).to_string()
            } else if one.with(*other).is_none() {
                "-".to_owned()
            } else {
                "yes".to_owned()
            });
        }
        rows.push(row);
    }
    let heads: Vec<&str> = [""].into_iter().chain(effects.iter().map(|effect| effect.words())).collect();
    let listed: Vec<String> =
        reasons.iter().enumerate().map(|(i, why)| format!("{}. {why}\n", i + 1)).collect();
    Some(format!("### `{}`\n\n{}\n{}\n", record.name(), table(&heads, rows), listed.concat()))
}

/// The keys of `[effects]` of a scene.
fn effects() -> String {
    let cells = |key: &EffectKey| {
        vec![format!("`{}`", key.name), key.takes.to_owned(), key.about.to_owned(), key.off.to_owned()]
    };
    table(&["key", "takes", "what it is", "where it is not named"], EFFECT_KEYS.iter().map(cells))
}

/// A row for each key of a table of a scene.
fn key_rows(keys: &[SceneKey]) -> String {
    let cells = |key: &SceneKey| {
        let others: Vec<String> = key.instead_of.iter().map(|other| format!("`{other}`")).collect();
        let default = match (key.default, others.join(" or ")) {
            ("", others) if others.is_empty() => "it has to be given".to_owned(),
            ("", others) => format!("{others} is given"),
            (default, _) => default.to_owned(),
        };
        vec![format!("`{}`", key.name), key.takes.to_owned(), key.about.to_owned(), default]
    };
    table(&["key", "takes", "what it is", "where it is not given"], keys.iter().map(cells))
}

/// The keys of all tables except `[effects]` and `[outputs]`, with one table of the page for each table of a
/// scene.
fn keys_of_scenes() -> String {
    let part = |part: &[SceneKey]| {
        let title = match (part[0].table, part[0].kind) {
            ("scene.path", _) => "`[[scene.path]]`".to_owned(),
            (table, "") => format!("`[{table}]`"),
            (table, kind) => format!("`[{table}]`, `{kind}`"),
        };
        let more = match part[0].table {
            "scene.second_surface" => {
                "It takes the keys of a file too: it is the surface of the second body, [added to the first](bodies.md#two-rough-bodies).\n\n"
            }
            _ => "",
        };
        format!("### {title}\n\n{more}{}\n", key_rows(part))
    };
    let shown: Vec<SceneKey> = scene_keys().into_iter().filter(|key| key.table != "outputs").collect();
    shown.chunk_by(|a, b| (a.table, a.kind) == (b.table, b.kind)).map(part).collect()
}

/// The keys of `[outputs]` that the program itself computes.
fn own_outputs() -> String {
    let shown: Vec<SceneKey> = scene_keys().into_iter().filter(|key| key.table == "outputs").collect();
    key_rows(&shown)
}

/// The keys of `[outputs]` that models compute.
fn outputs() -> String {
    let cells = |output: &Output| {
        let takes = match output {
            Output::Conductance => {
                "`{ kind = \"electrical\", resistivities }` or `{ kind = \"thermal\", conductivities }`, two values each"
            }
            field if field.is_field() => "formats",
            _ => "true",
        };
        vec![format!("`{}`", output.name()), takes.to_owned(), output.sentence().to_owned()]
    };
    table(&["key", "takes", "what it is"], Output::ALL.iter().map(cells))
}

/// A line without its formulas: code between two dollar signs.
fn without_formulas(line: &str) -> String {
    let parts: Vec<&str> = line.split('`').collect();
    let formula = |i: usize| {
        i % 2 == 1
            && parts[i - 1].ends_with('$')
            && parts.get(i + 1).is_some_and(|after| after.starts_with('$'))
    };
    // The part after a formula goes on where the one before it ends.
    let shown = parts.iter().enumerate().filter(|(i, _)| !formula(*i));
    shown.flat_map(|(i, part)| [if i == 0 || formula(i - 1) { "" } else { "`" }, *part]).collect()
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The text with this part inserted between its marks.
fn with_part(text: &str, name: &str, part: &str) -> String {
    let begin = format!("{BEGIN}{name} -->\n");
    let (before, rest) = text.split_once(&begin).unwrap_or_else(|| panic!("no mark {begin:?}"));
    let (_, after) = rest.split_once(END).unwrap_or_else(|| panic!("no end after {begin:?}"));
    format!("{before}{begin}{part}{END}{after}")
}

#[test]
fn formulas_are_left_out_of_lines() {
    assert_eq!(without_formulas("a $`x_1 y`$ b `c` d $`z`$"), "a $$ b `c` d $$");
    assert_eq!(without_formulas("`$` `a` $ `b"), "`$` `a` $ `b");
}

#[test]
fn documents_follow_from_the_tables() {
    let update = std::env::var_os("UPDATE_DOCUMENTS").is_some();
    let parts = |file: &str, parts: &[(&str, String)]| {
        let text = std::fs::read_to_string(root().join(file)).unwrap();
        let expected = parts.iter().fold(text.clone(), |text, (name, part)| with_part(&text, name, part));
        (file.to_owned(), expected, text)
    };
    let page = |file: &str, page: String| {
        let text = std::fs::read_to_string(root().join(file)).unwrap_or_default();
        (file.to_owned(), page, text)
    };
    let documents = [
        parts("GLOSSARY.md", &[("quantities", glossary())]),
        parts(
            "book/src/scene-file.md",
            &[
                ("scene keys", keys_of_scenes()),
                ("effects", effects()),
                ("outputs", outputs()),
                ("own outputs", own_outputs()),
            ],
        ),
        page("book/src/quantities.md", quantities_page()),
        page("book/src/models.md", models_page()),
        page("book/src/modules.md", crates::modules_page()),
        parts(
            "book/src/tuning.md",
            &[
                ("tuning", constants::tuning()),
                ("layout", constants::layout()),
                ("others", constants::others()),
            ],
        ),
        parts("ARCHITECTURE.md", &[("crates", crates::crates())]),
    ];
    let packages = sources::packages();
    let front = packages.iter().map(|p| page(&format!("{}/README.md", p.folder), readmes::readme(p)));
    let documents = documents.into_iter().chain(front);
    for (file, expected, found) in documents {
        if update {
            std::fs::write(root().join(&file), &expected).unwrap();
        } else {
            assert!(
                expected == found,
                "{file} is not what the tables say: run `UPDATE_DOCUMENTS=1 cargo test -p tests --test physics documents`"
            );
        }
    }
}
