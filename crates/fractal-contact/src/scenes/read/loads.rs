//! The prescribed loads: independent loads, or a path.

use crate::scenes::read::key::Context;
use crate::scenes::read::path::{AskedStep, MOST, PathPiece, zero_if_rounded};
use crate::scenes::read::{Diagnostic, Entry, Places, PrescribedLoad, ReadResult, System, printed};
use contact_model::{Load, NormalLoad, Normalisation, Step};
use surface_io::{Dimension, Quantity};

/// Loads, solved one by one in this order.
#[derive(Debug, Clone, PartialEq)]
pub struct LoadList {
    /// The quantity that is prescribed.
    pub kind: PrescribedLoad,
    /// The numbers, in SI or the scene's own units.
    pub values: Vec<f64>,
}

impl LoadList {
    /// The load of a number for a surface with this normalisation.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for a normalised force of a surface without rms height.
    pub fn load(&self, value: f64, normalisation: &Normalisation) -> contact_model::Result<Load> {
        Ok(match self.kind {
            PrescribedLoad::Force => Load::force(value),
            PrescribedLoad::ForceBar => Load::force(normalisation.force(value)?),
            PrescribedLoad::MeanPressure => Load::force(value * normalisation.length * normalisation.length),
            PrescribedLoad::Approach => Load::approach(value),
            PrescribedLoad::MeanGap => Load::mean_gap(value),
        })
    }
}

/// The states that the models compute.
#[derive(Debug, Clone, PartialEq)]
pub enum LoadRequest {
    /// States under loads.
    Loads(LoadList),
    /// States along a path.
    Path(Vec<PathPiece>),
}

impl LoadRequest {
    /// Number of states.
    pub fn count(&self) -> usize {
        match self {
            Self::Loads(loads) => loads.values.len(),
            Self::Path(pieces) => pieces.iter().map(|piece| piece.states).sum(),
        }
    }

    /// The number that the load of a state prescribes; `None` along a path.
    pub(crate) fn prescribed(&self, state: usize) -> Option<f64> {
        match self {
            Self::Loads(loads) => loads.values.get(state).copied(),
            Self::Path(_) => None,
        }
    }

    /// The ends of the pieces of a path; none of loads one by one.
    pub(crate) fn ends(&self) -> impl Iterator<Item = &Step> {
        self.pieces().iter().map(|piece| &piece.end)
    }

    /// The pieces of a path; none of loads one by one.
    pub(crate) fn pieces(&self) -> &[PathPiece] {
        match self {
            Self::Loads(_) => &[],
            Self::Path(pieces) => pieces,
        }
    }

    /// Whether tangential loads along x, and along y, are prescribed.
    pub(crate) fn shears(&self) -> [bool; 2] {
        [0, 1].map(|along| self.ends().any(|step| step.load.tangential.components()[along].abs() > 0.0))
    }

    /// Whether a piece of a path begins at the mean gap that the state before it has.
    pub(crate) fn begins_at_mean_gap(&self) -> bool {
        let Self::Path(pieces) = self else { return false };
        let is_gap = |piece: &PathPiece| matches!(piece.end.load.normal, NormalLoad::MeanGap(_));
        pieces
            .iter()
            .zip(pieces.iter().skip(1))
            .any(|(before, piece)| piece.states > 1 && is_gap(piece) && !is_gap(before))
    }

    /// Whether an approach or a mean gap may be prescribed, so that the force is a result with an error.
    pub(crate) fn prescribes_distance(&self) -> bool {
        match self {
            Self::Loads(loads) => matches!(loads.kind, PrescribedLoad::Approach | PrescribedLoad::MeanGap),
            Self::Path(_) => self
                .ends()
                .any(|step| matches!(step.load.normal, NormalLoad::Approach(_) | NormalLoad::MeanGap(_))),
        }
    }
}

/// Loads or a path as a question has them.
#[derive(Debug, Clone, PartialEq)]
pub enum AskedLoads {
    /// Loads, solved one by one.
    Loads(LoadList),
    /// The steps of a path, each with the quantities that it names.
    Path(Vec<AskedStep>),
}

/// Reads one load, a list or a range.
pub(crate) fn read_loads(
    kind: PrescribedLoad,
    entry: &Entry<'_>,
    context: Context<'_>,
) -> ReadResult<AskedLoads> {
    let (key, dimension, ..) = kind.record();
    let number = |item: &Entry<'_>| match dimension {
        Dimension::NONE => item.number(),
        dimension => item.quantity(dimension, context.system),
    };
    let values = if entry.is_table() {
        let range = entry.table()?;
        let from = range.require("from", "...")?;
        let to = range.require("to", "...")?;
        let count = range.require("count", "9")?;
        let mut even = false;
        range.set(&mut even, "spacing", |e| e.choice(&[("log", false), ("linear", true)]))?;
        range.finish()?;
        let number_of = count.count(2)?;
        if number_of > MOST {
            return Err(count
                .diagnostic(format!("{number_of} loads: expected at most {MOST}"))
                .with_help("ask for fewer"));
        }
        let (low, high) = (number(&from)?, number(&to)?);
        if !even && (low <= 0.0 || high <= 0.0) {
            return Err(from
                .diagnostic(format!(
                    "a logarithmic range of `{key}` from {} to {} meets zero",
                    from.shown(),
                    to.shown()
                ))
                .with_help("both ends > 0, or `spacing = \"linear\"`"));
        }
        between(low, high, number_of as usize, even)
    } else if let Some(words) = entry.as_word().filter(|words| words.contains(',')) {
        let quantity = |part: &str| {
            Quantity::parse_as(part.trim(), dimension).map_err(|reason| of_list(entry, words, &reason))
        };
        words.split(',').map(quantity).collect::<ReadResult<Vec<f64>>>()?
    } else {
        entry.list().iter().map(number).collect::<ReadResult<Vec<f64>>>()?
    };
    if values.is_empty() {
        return Err(entry
            .diagnostic(format!("`{key}` is an empty list"))
            .with_help("name at least one load"));
    }
    Ok(AskedLoads::Loads(LoadList { kind, values }))
}

/// The mistake of a list in one text, which may be a decimal comma.
fn of_list(entry: &Entry<'_>, words: &str, reason: &surface_io::QuantityError) -> Diagnostic {
    let point = words.replacen(',', ".", 1);
    let of_decimals = words.matches(',').count() == 1 && point.parse::<Quantity>().is_ok();
    let message = format!("`{}` = {words}: {reason}", entry.path());
    entry.diagnostic(message).with_help(if of_decimals {
        format!("a comma is between two values; write a decimal point: {point}")
    } else {
        "each value has its unit, such as \"1 MPa, 10 MPa\"".to_owned()
    })
}

/// The loads as TOML, where they are of this kind.
pub(crate) fn print_loads(loads: &AskedLoads, kind: PrescribedLoad, system: System) -> Option<String> {
    let AskedLoads::Loads(loads) = loads else { return None };
    let dimension = kind.record().1;
    let number = |value: &f64| match dimension {
        Dimension::NONE => printed::number(*value),
        dimension => printed::quantity(*value, dimension, system),
    };
    (loads.kind == kind).then(|| printed::list(&loads.values.iter().map(number).collect::<Vec<_>>()))
}

/// Checks that no load pulls, where nothing holds against a pull; `pulls` allows it (adhesion).
pub(crate) fn check_signs(loads: &LoadList, system: System, pulls: bool, places: &Places) -> ReadResult<()> {
    let signed = pulls && loads.kind != PrescribedLoad::MeanGap;
    let wrong = loads.values.iter().position(|value| !(*value >= 0.0 || signed));
    let Some(wrong) = wrong else { return Ok(()) };
    let (key, dimension, ..) = loads.kind.record();
    let value = match dimension {
        Dimension::NONE => printed::number(loads.values[wrong]),
        dimension => printed::quantity(loads.values[wrong], dimension, system),
    };
    let help = match loads.kind {
        PrescribedLoad::MeanGap => "a mean gap is a distance >= 0",
        _ => "a load that presses is positive; only adhesion (`adhesion` in [effects]) holds against a pull",
    };
    let path = format!("scene.{key}");
    let item = places.value(&format!("{path}.{wrong}")).or_else(|| places.value(&path));
    let message = format!("the load `{key}` = {} is negative", value.trim_matches('"'));
    Err(Diagnostic::new(message).at(item).with_help(help))
}

/// `count` >= 2 numbers with both ends exactly as given.
fn between(low: f64, high: f64, count: usize, even: bool) -> Vec<f64> {
    let last = count - 1;
    let at = |i: usize| {
        let t = i as f64 / last as f64;
        match i {
            0 => low,
            i if i == last => high,
            _ if even => {
                zero_if_rounded((low * (last - i) as f64 + high * i as f64) / last as f64, [low, high])
            }
            _ => (low.ln() + (high.ln() - low.ln()) * t).exp(),
        }
    };
    (0..count).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_their_ends_exactly() {
        let values = between(1e-6, 20.0, 5, false);
        assert_eq!((values[0], values[4]), (1e-6, 20.0));
        approx::assert_relative_eq!(values[1] / values[0], 2e7_f64.powf(0.25), max_relative = 1e-12);
        assert_eq!(between(1.0, -1.0, 3, true), [1.0, 0.0, -1.0]);
        // (0.3 - 3 x 0.1)/4 is -1.4e-17 in double precision.
        assert_eq!(between(0.3, -0.1, 5, true)[3].to_bits(), 0);
    }
}
