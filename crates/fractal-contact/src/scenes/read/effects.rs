//! `[effects]`: an effect is off unless the scene names it.

use crate::scenes::read::{Diagnostic, Entries, Entry, ReadResult, System, amount, number, printed};
use contact_model::{
    Adhesion, AdhesionLaw, Boundary, Coupling, Effects, Friction, FrictionLaw, Hardness, Layer, LayerBase,
    PronySeries, Relaxing, Rheology,
};
use surface_io::Dimension;

/// A key of `[effects]`. Scenes, Python, the plan and the book take its description from here.
#[derive(Debug)]
#[non_exhaustive]
pub struct EffectKey {
    /// The key.
    pub name: &'static str,
    /// The values that it takes in a scene.
    pub takes: &'static str,
    /// A description in a sentence or two.
    pub about: &'static str,
    /// The behaviour where it is not named.
    pub off: &'static str,
    pub(crate) read: fn(&Entry<'_>, System, &mut Effects) -> ReadResult<()>,
    /// Its value as TOML; `None` where it is off.
    pub(crate) print: fn(&Effects, System) -> Option<String>,
    /// Its numbers, where it is on.
    words: fn(&Effects, System) -> Option<String>,
}

/// Every key of `[effects]`.
pub static EFFECT_KEYS: &[EffectKey] = &[
    EffectKey {
        name: "boundary",
        takes: "`\"free\"`, `\"periodic\"`, `{ x = \"periodic\", y = \"free\" }` or `{ x = \"free\", y = \"periodic\" }`",
        about: "What lies outside of the rectangle.",
        off: "an unloaded half-space outside the rectangle",
        read: |entry, _, effects| read_boundary(entry).map(|boundary| effects.boundary = boundary),
        print: |effects, _| {
            let words = effects.boundary.repeats().map(|repeats| if repeats { "periodic" } else { "free" });
            let [x, y] = words.map(printed::text);
            Some(if x == y { x } else { format!("{{ x = {x}, y = {y} }}") })
        },
        words: |effects, _| {
            let copies = match effects.boundary.repeats() {
                [false, false] => return None,
                [true, true] => "periodic copies of the rectangle",
                [true, false] => "periodic copies of the rectangle along x",
                [false, true] => "periodic copies of the rectangle along y",
            };
            Some(copies.into())
        },
    },
    EffectKey {
        name: "hardness",
        takes: "`{ pressure }`, or the pressure alone",
        about: "Largest pressure that the bodies carry (perfect plasticity): the indentation stays along a path.",
        off: "elastic at any pressure",
        read: |entry, system, effects| {
            let table = entry.table_or("pressure")?;
            let pressure = table.require("pressure", "\"2 GPa\"")?.positive(Dimension::PRESSURE, system)?;
            effects.hardness = Hardness::Limit { pressure };
            table.finish()
        },
        print: |effects, system| match effects.hardness {
            Hardness::Limit { pressure } => {
                Some(format!("{{ pressure = {} }}", printed::quantity(pressure, Dimension::PRESSURE, system)))
            }
            _ => None,
        },
        words: |effects, system| match effects.hardness {
            Hardness::Limit { pressure } => {
                Some(format!("no pressure above {}", amount(pressure, system.shown("Pa"))))
            }
            _ => None,
        },
    },
    EffectKey {
        name: "adhesion",
        takes: "`{ work }`, or the work alone; `{ work, range, law }` with the `law` `\"exponential\"` or `\"dugdale\"`",
        about: "Attraction with this work of adhesion (energy per area): of short range (JKR), or across open gaps \
                with a range (a length), by the exponential law if none is named.",
        off: "no attraction",
        read: |entry, system, effects| {
            read_adhesion(&entry.table_or("work")?, system).map(|adhesion| effects.adhesion = adhesion)
        },
        print: |effects, system| {
            let work = |work| printed::quantity(work, Dimension::ENERGY_PER_AREA, system);
            match effects.adhesion {
                Adhesion::ShortRange { work: of } => Some(format!("{{ work = {} }}", work(of))),
                Adhesion::FiniteRange { work: of, range, law } => {
                    let range = printed::quantity(range, Dimension::LENGTH, system);
                    let word =
                        LAWS.iter().find(|(_, known)| *known == law).map_or("exponential", |(word, _)| word);
                    Some(format!("{{ work = {}, range = {range}, law = {} }}", work(of), printed::text(word)))
                }
                _ => None,
            }
        },
        words: |effects, system| match effects.adhesion {
            Adhesion::Off => None,
            Adhesion::ShortRange { work } => {
                Some(format!("short range, work {}", amount(work, system.shown("J/m^2"))))
            }
            Adhesion::FiniteRange { work, range, law } => {
                let law = if law == AdhesionLaw::Dugdale { "Dugdale" } else { "exponential" };
                Some({
                    let (work, range) =
                        (amount(work, system.shown("J/m^2")), amount(range, system.shown("m")));
                    format!("{law}, work {work}, range {range}")
                })
            }
            other => Some(format!("{other:?}")),
        },
    },
    EffectKey {
        name: "friction",
        takes: "`{ coefficient, shear_strength, limit, coupling }` with the `coupling` `\"none\"` or `\"full\"`, or the coefficient alone",
        about: "Friction under a tangential load: the traction is at most the shear strength (a pressure) plus the coefficient times the \
                pressure, and at most the limit (a pressure). The coefficient alone is Coulomb's law, the shear strength alone is Tresca's. \
                Where the bodies differ, normal and tangential tractions act on each other: the coupling is neglected, or both are \
                solved together.",
        off: "no tangential load",
        read: |entry, system, effects| {
            read_friction(&entry.table_or("coefficient")?, system).map(|friction| effects.friction = friction)
        },
        print: |effects, system| print_friction(effects.friction, system),
        words: |effects, system| friction_words(effects.friction, system),
    },
    EffectKey {
        name: "rheology",
        takes: "`{ kind = \"kelvin_voigt\" or \"maxwell\", viscosity }`, \
                `{ kind = \"standard_solid\", weight, time }`, `{ kind = \"prony\", weights, times }`",
        about: "Time dependence of the material.",
        off: "elastic",
        read: |entry, system, effects| {
            read_rheology(entry, system).map(|rheology| effects.rheology = rheology)
        },
        print: |effects, system| print_rheology(&effects.rheology, system),
        words: |effects, system| {
            (effects.rheology != Rheology::Elastic).then(|| rheology_words(&effects.rheology, system))
        },
    },
    EffectKey {
        name: "layer",
        takes: "`{ thickness, young, poisson, base }` with the `base` `{ young, poisson }`, `\"rigid\"` or `\"slipping\"`",
        about: "An elastic layer, such as a coating, that is bonded to an elastic base or to a rigid one, or slips on a rigid one. The \
                body that presses on it is rigid, or the one of `bodies`.",
        off: "the bodies are homogeneous",
        read: |entry, system, effects| read_layer(entry, system).map(|layer| effects.layer = Some(layer)),
        print: |effects, system| effects.layer.map(|layer| print_layer(&layer, system)),
        words: |effects, system| effects.layer.map(|layer| layer_words(&layer, system)),
    },
];

const COUPLINGS: [(&str, Coupling); 2] = [("none", Coupling::Neglected), ("full", Coupling::Full)];
const LAWS: [(&str, AdhesionLaw); 2] =
    [("exponential", AdhesionLaw::Exponential), ("dugdale", AdhesionLaw::Dugdale)];

/// An effect of a scene and why it is on or off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectLine {
    /// Its key in `[effects]`.
    pub name: &'static str,
    /// Whether it is simulated.
    pub on: bool,
    /// Its parameters, or why it is off.
    pub reason: String,
}

/// All effects of a scene, on or off.
pub fn effect_lines(effects: &Effects, system: System) -> Vec<EffectLine> {
    let line = |key: &EffectKey| {
        let words = (key.words)(effects, system);
        // A boundary is always there, whether it is named or not.
        let off = if key.name == "boundary" { "free" } else { "not named" };
        let reason = || format!("{off}: {}", key.off);
        EffectLine { name: key.name, on: words.is_some(), reason: words.unwrap_or_else(reason) }
    };
    EFFECT_KEYS.iter().map(line).collect()
}

/// Reads `[effects]`.
pub(crate) fn read_effects(table: Option<Entries<'_>>, system: System) -> ReadResult<Effects> {
    let mut effects = Effects::default();
    let Some(table) = table else { return Ok(effects) };
    for key in EFFECT_KEYS {
        if let Some(entry) = table.find(key.name) {
            (key.read)(&entry, system, &mut effects)?;
        }
    }
    table.finish()?;
    Ok(effects)
}

/// Effects from the text of `[effects]` without its heading, with plain numbers in consistent units.
///
/// # Errors
/// What is wrong, as in a scene.
///
/// ```
/// use fractal_contact::Hardness;
/// let effects = fractal_contact::scenes::parse_effects("hardness = 0.1")?;
/// assert_eq!(effects.hardness, Hardness::Limit { pressure: 0.1 });
/// # Ok::<(), fractal_contact::scenes::Diagnostic>(())
/// ```
pub fn parse_effects(text: &str) -> Result<Effects, Diagnostic> {
    Entries::of_text("effects", text, |table| read_effects(Some(table), System::None))
}

fn read_adhesion(table: &Entries<'_>, system: System) -> ReadResult<Adhesion> {
    let work = table.require("work", "\"50 mJ/m^2\"")?.not_negative(Dimension::ENERGY_PER_AREA, system)?;
    let law = table.find("law").map(|e| Ok((e.choice(&LAWS)?, e))).transpose()?;
    let adhesion = match (table.find("range"), law) {
        (None, None) => Adhesion::ShortRange { work },
        (Some(range), law) => {
            let range = range.positive(Dimension::LENGTH, system)?;
            let law = law.map_or(AdhesionLaw::Exponential, |(law, _)| law);
            Adhesion::FiniteRange { work, range, law }
        }
        (None, Some((_, entry))) => {
            return Err(entry
                .diagnostic_at_key(
                    "`law` says how the attraction falls with the gap, and no `range` is given",
                )
                .with_help("add `range = \"1 nm\"`, or remove `law` for short-range adhesion (JKR)"));
        }
    };
    table.known_only()?;
    Ok(adhesion)
}

fn read_friction(table: &Entries<'_>, system: System) -> ReadResult<Friction> {
    let coefficient = table.optional("coefficient", Entry::not_negative_number)?;
    let shear_strength =
        table.optional("shear_strength", |entry| entry.not_negative(Dimension::PRESSURE, system))?;
    let limit = table.find("limit").map(|e| Ok((e.positive(Dimension::PRESSURE, system)?, e))).transpose()?;
    let coupling = table.optional("coupling", |entry| entry.choice(&COUPLINGS))?;
    let limit = match (coefficient, shear_strength, limit) {
        (None, None, Some((_, entry))) => {
            return Err(entry
                .diagnostic_at_key("`limit` caps a law of friction, and the law itself is not given")
                .with_help(
                    "add `coefficient = 0.3`, `shear_strength = \"10 MPa\"` or both; a traction that is the same at \
                     any pressure is a `shear_strength` alone",
                ));
        }
        // Named as what is missing.
        (None, None, None) => table.require("coefficient", "0.3").map(|_| None)?,
        (_, _, limit) => limit.map(|(limit, _)| limit),
    };
    table.known_only()?;
    let law = FrictionLaw {
        coefficient: coefficient.unwrap_or(0.0),
        shear_strength: shear_strength.unwrap_or(0.0),
        limit,
    };
    Ok(Friction::Slip { law, coupling })
}

fn print_friction(friction: Friction, system: System) -> Option<String> {
    let Friction::Slip { law: FrictionLaw { coefficient, shear_strength, limit }, coupling } = friction
    else {
        return None;
    };
    let pressure = |value| printed::quantity(value, Dimension::PRESSURE, system);
    let word = coupling.and_then(|coupling| COUPLINGS.iter().find(|(_, known)| *known == coupling));
    let keys = [
        (coefficient > 0.0 || shear_strength <= 0.0).then(|| ("coefficient", printed::number(coefficient))),
        (shear_strength > 0.0).then(|| ("shear_strength", pressure(shear_strength))),
        limit.map(|limit| ("limit", pressure(limit))),
        word.map(|(word, _)| ("coupling", printed::text(word))),
    ];
    let keys: Vec<String> =
        keys.into_iter().flatten().map(|(key, value)| format!("{key} = {value}")).collect();
    Some(format!("{{ {} }}", keys.join(", ")))
}

fn friction_words(friction: Friction, system: System) -> Option<String> {
    let Friction::Slip { law: FrictionLaw { coefficient, shear_strength, limit }, coupling } = friction
    else {
        return None;
    };
    let pressure = |value| amount(value, system.shown("Pa"));
    let law = if shear_strength <= 0.0 {
        format!("Coulomb, coefficient {coefficient}")
    } else if coefficient <= 0.0 {
        format!("Tresca, shear strength {}", pressure(shear_strength))
    } else {
        format!("shear strength {}, coefficient {coefficient}", pressure(shear_strength))
    };
    let limit = limit.map_or_else(String::new, |limit| format!(", traction at most {}", pressure(limit)));
    let coupling = match coupling {
        Some(Coupling::Full) => ", normal and tangential tractions solved together",
        Some(_) => ", coupling of normal and tangential tractions neglected",
        None => "",
    };
    Some(format!("{law}{limit}{coupling}"))
}

fn rheology_words(rheology: &Rheology, system: System) -> String {
    let pascal_seconds = |viscosity: f64| amount(viscosity, system.shown("Pa s"));
    let time = |time: f64| amount(time, system.shown("s"));
    let arms = |arms: &[Relaxing]| {
        let list: Vec<String> =
            arms.iter().map(|a| format!("weight {} time {}", number(a.weight), time(a.time))).collect();
        list.join(", ")
    };
    match rheology {
        Rheology::KelvinVoigt { viscosity } => {
            format!("Kelvin-Voigt, viscosity {}", pascal_seconds(*viscosity))
        }
        Rheology::Maxwell { viscosity } => format!("Maxwell, viscosity {}", pascal_seconds(*viscosity)),
        Rheology::StandardSolid { arm } => format!("standard solid, {}", arms(&[*arm])),
        Rheology::Prony(series) => format!("Prony series, {}", arms(series.arms())),
        other => format!("{other:?}"),
    }
}

fn print_rheology(rheology: &Rheology, system: System) -> Option<String> {
    let viscosity = |value| printed::quantity(value, Dimension::VISCOSITY, system);
    let time = |arm: &Relaxing| printed::quantity(arm.time, Dimension::TIME, system);
    let list = |values: Vec<String>| format!("[{}]", values.join(", "));
    Some(match rheology {
        Rheology::KelvinVoigt { viscosity: of } => {
            format!("{{ kind = \"kelvin_voigt\", viscosity = {} }}", viscosity(*of))
        }
        Rheology::Maxwell { viscosity: of } => {
            format!("{{ kind = \"maxwell\", viscosity = {} }}", viscosity(*of))
        }
        Rheology::StandardSolid { arm } => {
            let weight = printed::number(arm.weight);
            format!("{{ kind = \"standard_solid\", weight = {weight}, time = {} }}", time(arm))
        }
        Rheology::Prony(series) => {
            let weights = series.arms().iter().map(|arm| printed::number(arm.weight)).collect();
            let times = series.arms().iter().map(time).collect();
            format!("{{ kind = \"prony\", weights = {}, times = {} }}", list(weights), list(times))
        }
        _ => return None,
    })
}

/// What lies outside of the rectangle, in both directions or in each.
fn read_boundary(entry: &Entry<'_>) -> ReadResult<Boundary> {
    let words = [("free", false), ("periodic", true)];
    if !entry.is_table() {
        return entry.choice(&words).map(|repeats| if repeats { Boundary::Periodic } else { Boundary::Free });
    }
    let table = entry.table()?;
    let x = table.require("x", "\"periodic\"")?.choice(&words)?;
    let y = table.require("y", "\"free\"")?.choice(&words)?;
    table.finish()?;
    Ok(match (x, y) {
        (false, false) => Boundary::Free,
        (true, true) => Boundary::Periodic,
        (true, false) => Boundary::PeriodicAlongX,
        (false, true) => Boundary::PeriodicAlongY,
    })
}

/// How the parameters of a rheology are read.
type ReadRheology = fn(&Entries<'_>, System) -> ReadResult<Rheology>;

const RHEOLOGIES: [(&str, ReadRheology); 4] = [
    ("kelvin_voigt", |table, system| Ok(Rheology::KelvinVoigt { viscosity: viscosity(table, system)? })),
    ("maxwell", |table, system| Ok(Rheology::Maxwell { viscosity: viscosity(table, system)? })),
    ("standard_solid", |table, system| {
        let (weight, time) = (table.require("weight", "1.0")?, table.require("time", "\"1 s\"")?);
        Ok(Rheology::StandardSolid { arm: relaxing(&weight, &time, system)? })
    }),
    ("prony", |table, system| {
        let (weights, times) =
            (table.require("weights", "[1.0, 0.5]")?, table.require("times", "[\"1 s\", \"10 s\"]")?);
        let (w, t) = (weights.list(), times.list());
        if w.len() != t.len() {
            return Err(times
                .diagnostic(format!("{} weights and {} times", w.len(), t.len()))
                .with_help("one relaxation time for each weight"));
        }
        let arms = w.iter().zip(&t).map(|(w, t)| relaxing(w, t, system)).collect::<ReadResult<Vec<_>>>()?;
        PronySeries::new(&arms).map(Rheology::Prony).map_err(|e| weights.diagnostic(e.to_string()))
    }),
];

fn viscosity(table: &Entries<'_>, system: System) -> ReadResult<f64> {
    table.require("viscosity", "\"1 MPa s\"")?.positive(Dimension::VISCOSITY, system)
}

fn relaxing(weight: &Entry<'_>, time: &Entry<'_>, system: System) -> ReadResult<Relaxing> {
    Ok(Relaxing { weight: weight.positive_number()?, time: time.positive(Dimension::TIME, system)? })
}

fn read_rheology(entry: &Entry<'_>, system: System) -> ReadResult<Rheology> {
    let table = entry.table()?;
    let read = table.require("kind", "\"standard_solid\"")?.choice(&RHEOLOGIES)?;
    let rheology = read(&table, system)?;
    table.finish()?;
    Ok(rheology)
}

const RIGID_BASES: [(&str, LayerBase); 2] = [("rigid", LayerBase::Rigid), ("slipping", LayerBase::Slipping)];

fn read_layer(entry: &Entry<'_>, system: System) -> ReadResult<Layer> {
    let table = entry.table()?;
    let thickness = table.require("thickness", "\"2 um\"")?.positive(Dimension::LENGTH, system)?;
    let (young, poisson) = read_material(&table, system)?;
    let of = table.require("base", "\"rigid\"")?;
    let base = if of.is_text() {
        of.choice(&RIGID_BASES)?
    } else {
        let base = of.table()?;
        let (young, poisson) = read_material(&base, system)?;
        base.finish()?;
        LayerBase::HalfSpace { young, poisson }
    };
    table.finish()?;
    let layer = Layer { thickness, young, poisson, base };
    layer.validate().map_err(|error| entry.diagnostic(error.to_string()))?;
    Ok(layer)
}

/// Young's modulus and Poisson's ratio.
fn read_material(table: &Entries<'_>, system: System) -> ReadResult<(f64, f64)> {
    let young = table.require("young", "\"70 GPa\"")?.positive(Dimension::PRESSURE, system)?;
    let ratio = table.require("poisson", "0.3")?;
    let poisson = ratio.number()?;
    if (0.0..=0.5).contains(&poisson) {
        return Ok((young, poisson));
    }
    Err(ratio
        .diagnostic(format!("`poisson` = {poisson}: expected a number in [0, 0.5]"))
        .with_help("0.5 is incompressible"))
}

fn print_layer(layer: &Layer, system: System) -> String {
    let material = |young: f64, poisson: f64| {
        let young = printed::quantity(young, Dimension::PRESSURE, system);
        format!("young = {young}, poisson = {}", printed::number(poisson))
    };
    let base = match layer.base {
        LayerBase::HalfSpace { young, poisson } => format!("{{ {} }}", material(young, poisson)),
        rigid => {
            let word = RIGID_BASES.iter().find(|(_, base)| *base == rigid).map_or("rigid", |(word, _)| word);
            printed::text(word)
        }
    };
    let thickness = printed::quantity(layer.thickness, Dimension::LENGTH, system);
    format!("{{ thickness = {thickness}, {}, base = {base} }}", material(layer.young, layer.poisson))
}

fn layer_words(layer: &Layer, system: System) -> String {
    let material = |young: f64, poisson: f64| {
        format!("E = {}, nu = {}", amount(young, system.shown("Pa")), number(poisson))
    };
    let base = match layer.base {
        LayerBase::HalfSpace { young, poisson } => {
            format!("bonded to a half-space of {}", material(young, poisson))
        }
        LayerBase::Slipping => "slipping on a rigid base".to_owned(),
        _ => "bonded to a rigid base".to_owned(),
    };
    let thickness = amount(layer.thickness, system.shown("m"));
    format!("{thickness} of {}, {base}", material(layer.young, layer.poisson))
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Effect;

    /// Each effect of the library has its key here, and is reported where it is on.
    #[test]
    fn every_effect_has_its_key() {
        for effect in Effect::ALL {
            let on = effect_lines(&effect.example(), System::None).into_iter().filter(|line| line.on);
            assert_eq!(on.map(|line| line.name).collect::<Vec<_>>(), [effect.key()], "{effect:?}");
        }
        for key in EFFECT_KEYS.iter().filter(|key| key.name != "boundary") {
            assert!(Effect::ALL.iter().any(|effect| effect.key() == key.name), "{key:?}");
        }
        let text = "boundary = \"periodic\"\nhardness = 2\nadhesion = 0.5\nfriction = { coefficient = 0.1 }\n\
                    rheology = { kind = \"maxwell\", viscosity = 3 }\n\
                    layer = { thickness = 0.1, young = 2, poisson = 0.3, base = { young = 1, poisson = 0.5 } }";
        let effects = parse_effects(text).unwrap();
        assert!(effect_lines(&effects, System::None).iter().all(|line| line.on));
        assert_eq!(effects.adhesion, Adhesion::ShortRange { work: 0.5 });
        assert!(effect_lines(&Effects::default(), System::None).iter().all(|line| !line.on));
    }

    #[test]
    fn mistakes_are_of_a_kind() {
        for text in ["hardness = \"1 GPa\"", "adhesion = {}", "friction = true", "boundary = 3"] {
            assert!(parse_effects(text).is_err_and(|d| d.is_type() && d.domain().is_none()), "{text}");
        }
        for text in
            ["hardness = 0", "adhesion = -1", "adhesion = { work = 1, range = nan }", "friction = inf"]
        {
            assert!(parse_effects(text).is_err_and(|d| d.domain().is_some() && !d.is_type()), "{text}");
        }
        for (word, coupling) in [("none", Coupling::Neglected), ("full", Coupling::Full)] {
            let effects =
                parse_effects(&format!("friction = {{ coefficient = 0.1, coupling = \"{word}\" }}"));
            let expected = Friction::coulomb(0.1).with_coupling(Some(coupling));
            assert_eq!(effects.unwrap().friction, expected);
        }
        assert_eq!(parse_effects("friction = 0.1").unwrap().friction, Friction::coulomb(0.1));
        let law =
            |text: &str| parse_effects(&format!("friction = {{ {text} }}")).unwrap().friction.law().unwrap();
        assert_eq!(law("shear_strength = 2"), FrictionLaw::tresca(2.0));
        let all = FrictionLaw { coefficient: 0.3, shear_strength: 0.1, limit: Some(5.0) };
        assert_eq!(law("limit = 5, shear_strength = 0.1, coefficient = 0.3"), all);
        assert_eq!(
            law("coefficient = 0, limit = 5"),
            FrictionLaw { limit: Some(5.0), ..FrictionLaw::coulomb(0.0) }
        );
        let words = |text: &str| friction_words(parse_effects(text).unwrap().friction, System::None).unwrap();
        assert_eq!(words("friction = 0.3"), "Coulomb, coefficient 0.3");
        assert_eq!(words("friction = { shear_strength = 2 }"), "Tresca, shear strength 2");
        assert_eq!(
            words("friction = { coefficient = 0.3, shear_strength = 0.1, limit = 5, coupling = \"full\" }"),
            "shear strength 0.1, coefficient 0.3, traction at most 5, normal and tangential tractions solved together"
        );
    }

    /// Each mistake in a law of friction is named with what was expected.
    #[test]
    fn laws_of_friction_are_checked() {
        for (text, expected) in [
            ("{ limit = 5 }", "`limit` caps a law of friction, and the law itself is not given"),
            ("{ limit = 5, coupling = \"full\" }", "`limit` caps a law of friction"),
            ("{ coupling = \"full\" }", "`coefficient` is missing"),
            ("{ shear_strength = -1 }", "-1"),
            ("{ shear_strength = nan }", "nan"),
            ("{ shear_strength = inf }", "inf"),
            ("{ coefficient = -0.3, shear_strength = 1 }", "-0.3"),
            ("{ coefficient = 0.3, limit = 0 }", "0"),
            ("{ coefficient = 0.3, limit = -2 }", "-2"),
            ("{ coefficient = 0.3, limit = nan }", "nan"),
            ("{ coefficient = 0.3, limit = inf }", "inf"),
            ("{ coefficient = 0.3, strength = 1 }", "strength"),
        ] {
            let refused = parse_effects(&format!("friction = {text}")).unwrap_err();
            let (words, lower) = (refused.to_string(), refused.to_string().to_lowercase());
            assert!(lower.contains(expected), "{text}: {words}");
            println!("{words}");
        }
        for text in [
            "hardnes = 1",
            "adhesion = { work = 1, reach = 1 }",
            "boundary = \"round\"",
            "hardness",
            "friction = { coefficient = 1, coupling = \"half\" }",
        ] {
            assert!(parse_effects(text).is_err_and(|d| d.domain().is_none() && !d.is_type()), "{text}");
        }
    }
}
