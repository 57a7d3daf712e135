//! What theories assume of a given map, measured on it and said in the plan.

use crate::scenes::read::{Diagnostic, Numerics, SceneFile, number, spike};
use analytic::greenwood_williamson::Summits;
use contact_model::Boundary;
use std::f64::consts::TAU;
use surface_gen::{MapEdges, MapStatistics, SelfAffineFit};

/// Rms slopes of two directions differ by more than chance does below this ratio: on isotropic maps of 128 x
/// 128 and 240 x 60 cells it was above 0.95.
const ISOTROPIC: f64 = 0.6;
/// Heights of self-affine maps, which have a few long waves, are Gaussian within these.
const SKEWNESS: f64 = 0.5;
const KURTOSIS: f64 = 1.0;
/// Share of the longest waves in the variance of heights from which the map is a sample of one.
const LONGEST: f64 = 0.5;
/// Share of a plane in the variance of heights from which a tilt explains edges, long waves and directions: that of
/// a plane that rises across the map by the rms height of the rest. The variance of a plane is a twelfth of the
/// square of its rise.
const TILTED: f64 = 1.0 / 13.0;

/// Whether a map is tilted. The waves of a periodic map, whose opposite edges match, have a plane as well, which is
/// no tilt.
pub(crate) fn is_tilted(edges: &MapEdges) -> bool {
    !edges.match_each_other() && edges.tilt > TILTED
}

/// The map of a scene, as theories see it.
pub(crate) struct Assumptions {
    /// Of the defined points, so that a hole or a tilt, which leave no statistics, hide no edge.
    edges: MapEdges,
    statistics: Option<MapStatistics>,
    fit: Option<SelfAffineFit>,
}

impl Assumptions {
    /// Measured where a theory is to answer for a map; `None` elsewhere. Cost of some transforms of the map.
    pub fn measured(scene: &SceneFile) -> Option<Self> {
        let map = scene.surface.given_map()?;
        let periodic = scene.effects.boundary == Boundary::Periodic;
        if !periodic && !scene.models.iter().any(Numerics::is_statistical) {
            return None;
        }
        let fits = scene.models.iter().any(|m| m.name() == "power_law");
        let fit = if fits { SelfAffineFit::new(map).ok() } else { None };
        Some(Self { edges: MapEdges::new(map).ok()?, statistics: MapStatistics::new(map).ok(), fit })
    }

    /// What a theory takes from the map, to be said with its accuracy; nothing for other models.
    pub fn taken(&self, numerics: &Numerics) -> String {
        let Self { statistics: Some(map), fit, .. } = self else { return String::new() };
        let how = if map.windowed { "spectrum under Hann's window" } else { "spectral derivative" };
        let taken = match numerics {
            Numerics::Persson(_) => format!("rms slope {} ({how})", number(map.rms_slope())),
            Numerics::GreenwoodWilliamson(_) => {
                let Summits { density, radius, scatter, .. } = Summits::of_map(map);
                let count = density * map.length * map.length;
                let [count, radius, scatter] = [count, radius, scatter].map(number);
                format!("{count} summits of radius {radius}, scatter {scatter} ({how}; m4 is that of the shortest waves)")
            }
            Numerics::Formula(record) if record.name() == "power_law" => fit.map_or_else(String::new, |SelfAffineFit { hurst, fitted, .. }| {
                let [long, short] = fitted.map(|q| number(TAU / q));
                format!("D_f = {:.3}, fitted to waves of length {long} to {short}", 3.0 - hurst)
            }),
            Numerics::Mdr1d(_) => {
                "spectrum pi q C_2D of its own, whatever its shape (the comparison is that of self-affine surfaces)".into()
            }
            _ => return String::new(),
        };
        format!("; of this map: {taken}")
    }

    /// What the map lacks of what theories assume, with remedies.
    pub fn notes(&self, scene: &SceneFile) -> Vec<Diagnostic> {
        let Self { edges, statistics, .. } = self;
        let mut notes = Vec::new();
        let mut note = |holds: bool, of: &dyn Fn(&Numerics) -> bool, message: String, help: &str| {
            let concerned = |i: &usize| of(&scene.models[*i]);
            let named: Vec<usize> = (0..scene.models.len()).filter(concerned).collect();
            if let (false, Some(&first)) = (holds, named.first()) {
                let names: Vec<&str> = named.iter().map(|&i| scene.models[i].name()).collect();
                let note = Diagnostic::note(format!("{}: {message}", names.join(", "))).with_help(help);
                notes.push(scene.at_model(first, note));
            }
        };
        let spiked = scene.surface.given_map().is_some_and(|map| spike(map).is_some());
        let statistical = |m: &Numerics| matches!(m, Numerics::Persson(_) | Numerics::GreenwoodWilliamson(_));
        let periodic = scene.effects.boundary == Boundary::Periodic;
        let concerned = |m: &Numerics| m.is_statistical() || (periodic && m.boundary_elements().is_some());
        // One cause is said once; a point that stands out is said of the map itself.
        let (matching, tilted) = (edges.match_each_other(), is_tilted(edges));
        let message = format!(
            "the map is tilted: {:.0} % of the variance of heights is a plane, which makes opposite edges differ by {:.1} times the largest step inside",
            100.0 * edges.tilt,
            edges.edge_step
        );
        let help = "Subtract it (`detrend = \"plane\"`) if it is a tilt of the measurement. Theories take it for waves as long as the map.";
        note(!tilted, &concerned, message, help);
        let message = format!(
            "opposite edges of the map differ by {:.1} times the largest step inside: it is no period of a surface",
            edges.edge_step
        );
        let help = if scene.effects.boundary == Boundary::Periodic {
            "`bem3d` solves the map with this step, and theories take it as a piece of an infinite surface. Use free boundaries, or loads at which the step is not in contact."
        } else {
            "Waves as long as the map are known least. Use a larger map, and `detrend = \"plane\"` if it is tilted."
        };
        note(tilted || matching, &concerned, message, help);
        // A map without statistics is refused by the theories that would take them.
        let Some(map) = statistics else { return notes };
        let message = format!(
            "the map is anisotropic: the rms slope along one direction is {:.2} of that along another, and the theory has one spectrum for all",
            map.isotropy
        );
        let help = "The theory takes the mean over directions. Compare it with `bem3d`, which solves the map as it is.";
        note(tilted || map.isotropy >= ISOTROPIC, &Numerics::is_statistical, message, help);
        let message = format!(
            "heights are not Gaussian (skewness {:.2}, kurtosis {:.2} instead of 0 and 3), and the theory knows the spectrum alone",
            map.skewness, map.kurtosis
        );
        let help = "At light loads the highest summits decide. Compare the theory with `bem3d` there, and fill spikes of the measurement.";
        let gaussian = map.skewness.abs() <= SKEWNESS && (map.kurtosis - 3.0).abs() <= KURTOSIS;
        note(spiked || gaussian, &Numerics::is_statistical, message, help);
        let message = format!(
            "{:.0} % of the variance of heights is in the longest waves: mean gap and stiffness of one map scatter around the theory's",
            100.0 * map.longest_waves
        );
        let help = "The theory assumes many long waves. Use a map that is several times larger, or trust the area alone.";
        note(tilted || map.longest_waves <= LONGEST, &statistical, message, help);
        notes
    }
}
