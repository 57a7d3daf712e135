//! `[effects]`: each off unless named.

use crate::scenes::read::entries::{Entries, Entry, Read, System};
use crate::scenes::read::human_readable::number;
use contact_model::{
    Adhesion, AdhesionLaw, Boundary, Effects, Friction, Hardness, PronySeries, Relaxing, Rheology,
};
use surface_io::Dimension;

/// An effect of a scene and why it is on or off.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct EffectLine {
    /// Its key in `[effects]`.
    pub name: &'static str,
    /// Whether it is simulated.
    pub on: bool,
    /// With which numbers, or why not.
    pub reason: String,
}

/// All effects of a scene, on or off.
pub fn effect_lines(effects: &Effects) -> Vec<EffectLine> {
    let line = |name, on: bool, value: String, off: &str| EffectLine {
        name,
        on,
        reason: if on { value } else { format!("not named: {off}") },
    };
    // All fields, so that a new effect is not forgotten.
    let Effects { boundary, hardness, adhesion, friction, rheology } = effects;
    let boundary = *boundary == Boundary::Periodic;
    let adhesion = match *adhesion {
        Adhesion::Off => None,
        Adhesion::ShortRange { work } => Some(format!("short range, work {} per area", number(work))),
        Adhesion::FiniteRange { work, range, law } => {
            let law = if law == AdhesionLaw::Dugdale { "Dugdale" } else { "exponential" };
            Some(format!("{law}, work {} per area, range {}", number(work), number(range)))
        }
        other => Some(format!("{other:?}")),
    };
    let hardness = match *hardness {
        Hardness::Limit { pressure } => Some(format!("no pressure above {}", number(pressure))),
        _ => None,
    };
    let (coefficient, friction) = match *friction {
        Friction::Coulomb { coefficient } => (coefficient, true),
        _ => (0.0, false),
    };
    let elastic = *rheology == Rheology::Elastic;
    vec![
        line(
            "boundary",
            boundary,
            "periodic copies of the rectangle".into(),
            "an unloaded half-space outside the rectangle",
        ),
        line("hardness", hardness.is_some(), hardness.unwrap_or_default(), "elastic at any pressure"),
        line("adhesion", adhesion.is_some(), adhesion.unwrap_or_default(), "no attraction"),
        line("friction", friction, format!("Coulomb, coefficient {coefficient}"), "no tangential load"),
        line("rheology", !elastic, rheology_words(rheology), "elastic"),
    ]
}

fn rheology_words(rheology: &Rheology) -> String {
    let arms = |arms: &[Relaxing]| {
        let list: Vec<String> =
            arms.iter().map(|a| format!("weight {} time {}", number(a.weight), number(a.time))).collect();
        list.join(", ")
    };
    match rheology {
        Rheology::KelvinVoigt { viscosity } => format!("Kelvin-Voigt, viscosity {}", number(*viscosity)),
        Rheology::Maxwell { viscosity } => format!("Maxwell, viscosity {}", number(*viscosity)),
        Rheology::StandardSolid { arm } => format!("standard solid, {}", arms(&[*arm])),
        Rheology::Prony(series) => format!("Prony series, {}", arms(series.arms())),
        other => format!("{other:?}"),
    }
}

/// Reads `[effects]`.
pub(crate) fn read_effects(table: Option<Entries<'_>>, system: System) -> Read<Effects> {
    let mut effects = Effects::default();
    let Some(table) = table else { return Ok(effects) };
    if let Some(entry) = table.find("boundary") {
        effects.boundary = entry.choice(&[("free", Boundary::Free), ("periodic", Boundary::Periodic)])?;
    }
    if let Some(entry) = table.find("hardness") {
        let inner = entry.table()?;
        let pressure = inner.require("pressure", "\"2 GPa\"")?.positive(Dimension::PRESSURE, system)?;
        inner.finish()?;
        effects.hardness = Hardness::Limit { pressure };
    }
    if let Some(entry) = table.find("adhesion") {
        let inner = entry.table()?;
        let work = inner.require("work", "\"50 mJ/m^2\"")?.positive(Dimension::ENERGY_PER_AREA, system)?;
        let words = [("exponential", AdhesionLaw::Exponential), ("dugdale", AdhesionLaw::Dugdale)];
        let law = inner.find("law").map(|e| Ok((e.choice(&words)?, e))).transpose()?;
        effects.adhesion = match (inner.find("range"), law) {
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
        inner.finish()?;
    }
    if let Some(entry) = table.find("friction") {
        let inner = entry.table()?;
        let coefficient = inner.require("coefficient", "0.3")?.positive_number()?;
        inner.finish()?;
        effects.friction = Friction::Coulomb { coefficient };
    }
    if let Some(entry) = table.find("rheology") {
        effects.rheology = read_rheology(&entry, system)?;
    }
    table.finish()?;
    Ok(effects)
}

#[derive(Clone, Copy)]
enum RheologyKind {
    KelvinVoigt,
    Maxwell,
    StandardSolid,
    Prony,
}

fn read_rheology(entry: &Entry<'_>, system: System) -> Read<Rheology> {
    let table = entry.table()?;
    let words = [
        ("kelvin_voigt", RheologyKind::KelvinVoigt),
        ("maxwell", RheologyKind::Maxwell),
        ("standard_solid", RheologyKind::StandardSolid),
        ("prony", RheologyKind::Prony),
    ];
    let kind = table.require("kind", "\"standard_solid\"")?.choice(&words)?;
    let viscosity = || table.require("viscosity", "\"1 MPa s\"")?.positive(Dimension::VISCOSITY, system);
    let arm = |weight: &Entry<'_>, time: &Entry<'_>| -> Read<Relaxing> {
        Ok(Relaxing { weight: weight.positive_number()?, time: time.positive(Dimension::TIME, system)? })
    };
    let rheology = match kind {
        RheologyKind::KelvinVoigt => Rheology::KelvinVoigt { viscosity: viscosity()? },
        RheologyKind::Maxwell => Rheology::Maxwell { viscosity: viscosity()? },
        RheologyKind::StandardSolid => Rheology::StandardSolid {
            arm: arm(&table.require("weight", "1.0")?, &table.require("time", "\"1 s\"")?)?,
        },
        RheologyKind::Prony => {
            let (weights, times) =
                (table.require("weights", "[1.0, 0.5]")?, table.require("times", "[\"1 s\", \"10 s\"]")?);
            let (w, t) = (weights.list(), times.list());
            if w.len() != t.len() {
                return Err(times
                    .diagnostic(format!("{} weights and {} times", w.len(), t.len()))
                    .with_help("one relaxation time for each weight"));
            }
            let arms = w.iter().zip(&t).map(|(w, t)| arm(w, t)).collect::<Read<Vec<_>>>()?;
            Rheology::Prony(PronySeries::new(&arms).map_err(|e| weights.diagnostic(e.to_string()))?)
        }
    };
    table.finish()?;
    Ok(rheology)
}
