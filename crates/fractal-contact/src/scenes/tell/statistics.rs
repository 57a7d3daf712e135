//! Statistics of a map as tables and pictures: `statistics.csv`, `spectrum.csv`, `height-difference.csv`,
//! `scale-dependence.csv`.

use crate::scenes::plan::solved_map;
use crate::scenes::read::{Result, SceneFile, System, multiple, short};
use contact_model::units::{ascii, number, rounded};
use contact_model::{Boundary, HeightMap, never};
use std::f64::consts::TAU;
use std::sync::Arc;
use surface_statistics::{
    Bins, Derivatives, DifferenceBands, DifferenceMap, FeatureParameters, FilledPoints, FunctionalParameters,
    HeightDifference, HeightParameters, HybridParameters, Interval, PowerSpectrum, ReliableWavelengths,
    ScaleDependence, SpatialParameters, SpectrumFit, Taper, Wavelength, texture_direction,
};

/// Bins in a decade of wavenumbers and of distances.
const PER_DECADE: f64 = 10.0;
/// Confidence level of the bands.
pub(crate) const LEVEL: f64 = 0.95;
/// Probability of a worse fit below which intervals are meaningless.
const DOUBTFUL: f64 = 0.01;
/// Names of the files.
pub(crate) const FILES: [&str; 10] = [
    "statistics.csv",
    "spectrum.csv",
    "height-difference.csv",
    "scale-dependence.csv",
    "spectrum.svg",
    "spectrum.png",
    "height-difference.svg",
    "height-difference.png",
    "slope.svg",
    "slope.png",
];

/// One number.
pub(crate) struct Parameter {
    pub symbol: &'static str,
    pub value: Option<f64>,
    /// Ends of the 95 % interval; one of them for a bound.
    pub ends: [Option<f64>; 2],
    /// Power of the length in its unit; `None` for an angle.
    pub power: Option<i32>,
    pub meaning: &'static str,
}

/// Limits over each distance, where they are known.
pub(crate) type Bands = Vec<Option<[f64; 2]>>;

/// Slope and curvature along one axis.
pub(crate) struct SlopeAndCurvature {
    pub axis: &'static str,
    pub slope: (ScaleDependence, Bands),
    pub curvature: (ScaleDependence, Bands),
}

/// The statistics of a map, and the reasons why some are not known.
pub(crate) struct MapStatisticsTables {
    pub system: System,
    /// Whether they are of a profile.
    pub profile: bool,
    pub parameters: Vec<Parameter>,
    pub spectra: Vec<(&'static str, PowerSpectrum)>,
    /// The self-affine spectrum that is fitted to the radial one.
    pub fit: Option<SpectrumFit>,
    pub differences: Option<(HeightDifference, Bands)>,
    pub scales: Vec<SlopeAndCurvature>,
    /// Shortest and longest wavelength that can be trusted.
    pub reliable: Option<[f64; 2]>,
    /// Reasons why a part is missing.
    pub notes: Vec<String>,
    /// Changes of the map that a part needed.
    pub remarks: Vec<String>,
}

/// A map that is measured, and what is known of it.
#[derive(Clone, Copy)]
pub struct MeasuredMap<'a> {
    /// The map.
    pub map: &'a HeightMap,
    /// Its points that were filled, where some were.
    pub filled: Option<&'a FilledPoints>,
    /// Whether it is a profile, which is measured along its row.
    pub profile: bool,
    /// Whether it is a tile of an endless surface.
    pub boundary: Boundary,
    /// The distance from which on the tip of the instrument resolves heights.
    pub instrument: Option<f64>,
}

impl MapStatisticsTables {
    /// Measures a map: a periodic surface without a window, any other one with Hann's window on its deviation
    /// from the mean. Spectra are those of the filled map, and the fit ends at wavelengths
    /// at which filled points matter.
    pub fn new(measured: MeasuredMap<'_>, system: System) -> Self {
        let MeasuredMap { map, filled, profile, boundary, instrument } = measured;
        let mut found = Self {
            system,
            profile,
            parameters: Vec::new(),
            spectra: Vec::new(),
            fit: None,
            differences: None,
            scales: Vec::new(),
            reliable: None,
            notes: Vec::new(),
            remarks: Vec::new(),
        };
        if profile {
            found.measure_profile(map, boundary, instrument);
            return found;
        }
        found.heights(map);
        found.full_contact(map, boundary);
        // Of a map that was filled before, and of one whose undefined points are filled for this.
        let points = filled.cloned().unwrap_or_else(|| FilledPoints::new(map));
        let whole = found.known("filled map", surface_io::filled(map));
        let whole = whole.as_ref().unwrap_or(map);
        found.spectra(whole, boundary);
        found.fit(whole, boundary, instrument, &points);
        found.tell_filled(&points);
        found.distances(map, boundary);
        found
    }

    fn distances(&mut self, map: &HeightMap, boundary: Boundary) {
        let bands = self.known("bands over distances", DifferenceBands::new(map, boundary));
        let limits = |of: &dyn Fn(&DifferenceBands) -> contact_model::Result<Bands>| -> Bands {
            bands.as_ref().and_then(|bands| of(bands).ok()).unwrap_or_default()
        };
        let differences = DifferenceMap::new(map, boundary);
        let radial = Bins::of_distances(map, PER_DECADE).and_then(|bins| differences.radial(&bins));
        if let Some(found) = self.known("height differences", radial) {
            let limits = limits(&|bands| bands.of_differences(&found, LEVEL));
            self.differences = Some((found, limits));
        }
        let slopes = [ScaleDependence::slope_along_x, ScaleDependence::slope_along_y];
        let curvatures = [ScaleDependence::curvature_along_x, ScaleDependence::curvature_along_y];
        for (i, axis) in ["x", "y"].into_iter().enumerate() {
            let slope = self.known("slope by scale", slopes[i](map, boundary));
            let curvature = self.known("curvature by scale", curvatures[i](map, boundary));
            if let Some((slope, curvature)) = slope.zip(curvature) {
                let of_slope = limits(&|bands| bands.of_slopes(&slope, i, LEVEL));
                let of_curvature = limits(&|bands| bands.of_curvatures(&curvature, i, LEVEL));
                let (slope, curvature) = ((slope, of_slope), (curvature, of_curvature));
                self.scales.push(SlopeAndCurvature { axis, slope, curvature });
            }
        }
    }

    /// Sq, Pq of a profile.
    pub fn rms_height(&self) -> Option<f64> {
        self.parameters.iter().find(|p| matches!(p.symbol, "Sq" | "Pq"))?.value
    }

    pub(super) fn known<T>(&mut self, what: &str, found: contact_model::Result<T>) -> Option<T> {
        found.map_err(|reason| self.notes.push(format!("{what}: {reason}"))).ok()
    }

    pub(super) fn push(
        &mut self,
        symbol: &'static str,
        value: Option<f64>,
        power: i32,
        meaning: &'static str,
    ) {
        self.parameters.push(Parameter { symbol, value, ends: [None; 2], power: Some(power), meaning });
    }

    fn heights(&mut self, map: &HeightMap) {
        if let Some(h) = self.known("height parameters", HeightParameters::new(map)) {
            for (symbol, value, power, meaning) in [
                ("Sa", h.sa, 1, "mean absolute height"),
                ("Sq", h.sq, 1, "rms height"),
                ("Ssk", h.ssk, 0, "skewness of the heights"),
                ("Sku", h.sku, 0, "kurtosis of the heights; 3 for Gaussian ones"),
                ("Sp", h.sp, 1, "highest point above the mean"),
                ("Sv", h.sv, 1, "lowest point below the mean"),
                ("Sz", h.sz, 1, "Sp + Sv"),
            ] {
                self.push(symbol, Some(value), power, meaning);
            }
        }
        if let Some(h) = self.known("hybrid parameters", HybridParameters::new(map)) {
            self.push("Sdq", Some(h.sdq), 0, "rms gradient");
            self.push("Sdr", Some(h.sdr), 0, "surface in excess of its projection, over the projection");
        }
        if let Some(f) = self.known("functional parameters", FunctionalParameters::new(map)) {
            for (symbol, value, meaning) in [
                ("Sk", f.sk, "core height: the straight line of the material ratio curve falls by it"),
                ("Spk", f.spk, "reduced height of the peaks above the core"),
                ("Svk", f.svk, "reduced depth of the valleys below it"),
            ] {
                self.push(symbol, Some(value), 1, meaning);
            }
        }
        if let Some(s) = self.known("spatial parameters", SpatialParameters::new(map)) {
            self.push("Sal", s.sal, 1, "shortest distance at which the autocorrelation has fallen to 0.2");
            self.push("Str", s.str, 0, "that over the longest one: 1 for an isotropic surface");
        }
        if let Some(std) = self.known("texture direction", texture_direction(map)) {
            let meaning = "direction of the waves that have most of the variance, from x towards y; the lay is perpendicular to it";
            let (value, ends) = (Some(std), [None; 2]);
            self.parameters.push(Parameter { symbol: "Std", value, ends, power: None, meaning });
        }
        if let Some(f) = self.known("feature parameters", FeatureParameters::new(map)) {
            self.push("Spd", Some(f.spd), -2, "density of hills that are higher than 5 % of Sz");
            self.push("Spc", f.spc, -1, "mean curvature of their peaks");
            if f.filled > 0 {
                self.remarks.push(format!(
                    "Spd and Spc: {} undefined points in patches of at most 16 were given the mean height of their neighbours",
                    f.filled
                ));
            }
        }
        if let Some(d) = self.known("derivatives", Derivatives::new(map, Boundary::Free)) {
            self.push("rms gradient", Some(d.rms_gradient), 0, "from differences of neighbouring cells");
            self.push("rms curvature", Some(d.rms_curvature), -1, "half the Laplacian, likewise");
        }
        if let Some(statistics) = self.known("Nayak's parameter", surface_gen::MapStatistics::new(map)) {
            let nayak = surface_statistics::nayak_parameter(&statistics);
            let meaning = "Nayak's parameter m0 m4/m2^2, at least 1.5: the wider the spectrum, the larger";
            self.push("alpha", Some(nayak).filter(|a| a.is_finite()), 0, meaning);
        }
    }

    /// The energy of full contact, which a map that is not periodic does not have.
    fn full_contact(&mut self, map: &HeightMap, boundary: Boundary) {
        if boundary == Boundary::Periodic
            && let Some(energy) = self.known("energy of full contact", surface_gen::full_contact_energy(map))
        {
            let meaning =
                "elastic energy per area that presses the periodic map flat, over E*: the sum of |q| |H|^2/4";
            self.push("full contact energy", Some(energy), 1, meaning);
        }
    }

    fn spectra(&mut self, map: &HeightMap, boundary: Boundary) {
        let taper = if boundary == Boundary::Periodic { Taper::None } else { Taper::Hann };
        let radial =
            Bins::of_wavenumbers(map, PER_DECADE).and_then(|bins| PowerSpectrum::radial(map, taper, &bins));
        let of = [
            ("radial", radial),
            ("x", PowerSpectrum::along_x(map, taper)),
            ("y", PowerSpectrum::along_y(map, taper)),
        ];
        for (direction, spectrum) in of {
            if let Some(spectrum) = self.known("spectrum", spectrum) {
                self.spectra.push((direction, spectrum));
            }
        }
        self.notes.dedup();
    }

    /// Tells that points were filled, and what this means for spectra and their fit.
    fn tell_filled(&mut self, filled: &FilledPoints) {
        let undefined = filled.count();
        if undefined == 0 {
            return;
        }
        let share = number(rounded(100.0 * undefined as f64 / filled.of_all() as f64, 2));
        let end = self.fit.as_ref().map(|fit| TAU / fit.fitted[1]).map(|shortest| {
            let (unit, factor) = multiple(self.unit(1), shortest);
            let unit = if unit == "scene" { String::new() } else { format!(" {}", ascii(&unit)) };
            format!(". The fit takes into account which waves are missing there, and ends at a wavelength of {}{unit}", short(factor * shortest))
        });
        self.remarks.push(format!(
            "spectra and H are those of the whole map, whose {undefined} undefined points ({share} %) have heights between those of \
             their neighbours{}",
            end.unwrap_or_default()
        ));
    }

    /// Fits the spectrum of a map, some points of which may have been filled.
    fn fit(&mut self, map: &HeightMap, boundary: Boundary, instrument: Option<f64>, filled: &FilledPoints) {
        // The stencil spans twice the distance of the tip.
        let instrument = instrument.map(|distance| 2.0 * distance);
        // The limits are known even where no wavelength lies between them.
        let longest = map.size().x.min(map.size().y) * if boundary == Boundary::Free { 0.5 } else { 1.0 };
        self.reliable = instrument.map(|shortest| [shortest, longest]);
        let Some(reliable) = self.known("wavelengths", ReliableWavelengths::new(map, boundary, instrument))
        else {
            return;
        };
        self.reliable = Some([reliable.shortest, reliable.longest]);
        self.push("shortest", Some(reliable.shortest), 1, "wavelength down to which the map can be trusted");
        self.push("longest", Some(reliable.longest), 1, "wavelength up to which it can");
        let fit = SpectrumFit::of_filled(map, filled, &reliable.fit_options(boundary));
        let Some(fit) = self.known("fit of a self-affine spectrum", fit) else {
            return;
        };
        if fit.goodness < DOUBTFUL && (fit.hurst.low > 1.0 || fit.hurst.high < 0.0) {
            self.notes.push(format!(
                "fit of a self-affine spectrum: the spectrum falls as q^-{}, that of a self-affine surface as q^-4 to \
                 q^-2. Points that were filled change short waves; a map with `crop` = \"defined\" has none of them",
                number(rounded(2.0 * (fit.hurst.value + 1.0), 2))
            ));
            return;
        }
        self.fit = Some(fit);
        let of = |interval: &Interval| (Some(interval.value), [Some(interval.low), Some(interval.high)]);
        let wavelength = |found: &Wavelength| match found {
            Wavelength::Interval(interval) => of(interval),
            Wavelength::AtLeast(bound) => (None, [Some(*bound), None]),
            Wavelength::AtMost(bound) => (None, [None, Some(*bound)]),
            _ => (None, [None; 2]),
        };
        for (symbol, (value, ends), power, meaning) in [
            ("H", of(&fit.hurst), 0, "Hurst exponent of the fitted spectrum"),
            ("roll-off", wavelength(&fit.roll_off), 1, "longest wavelength of its power law"),
            ("cut-off", wavelength(&fit.cut_off), 1, "its shortest wavelength"),
        ] {
            self.parameters.push(Parameter { symbol, value, ends, power: Some(power), meaning });
        }
        self.push(
            "goodness",
            Some(fit.goodness),
            0,
            "probability of a worse fit of a Gaussian surface; below 0.01 the intervals say nothing",
        );
    }

    pub fn unit(&self, power: i32) -> &'static str {
        self.system.unit(match power {
            0 => "1",
            1 => "m",
            2 => "m^2",
            -1 => "1/m",
            _ => "1/m^2",
        })
    }

    /// The statistics of the first surface of a scene, as it is solved.
    ///
    /// # Errors
    /// A surface that cannot be drawn.
    pub fn of_scene(scene: &SceneFile) -> Result<Self> {
        let of_file = scene.surface.given_map().map(Arc::clone);
        let with_cells = scene.models.iter().find(|model| model.boundary_elements().is_some());
        let drawn = with_cells.map(|model| solved_map(scene, model, scene.seed(0), &never)).transpose();
        let Some(map) = drawn.map_err(runs::Error::model("statistics"))?.or(of_file) else {
            let refused = contact_model::Error::unsupported(
                "statistics",
                "a surface that no model here solves on cells",
            );
            return Err(runs::Error::model("statistics")(refused).into());
        };
        let profile = scene.surface.is_profile();
        let (boundary, instrument) = (scene.effects.boundary, scene.reliable_from);
        // A model with a grid of its own has other points.
        let filled = scene.filled.as_ref().filter(|filled| filled.of_all() == map.heights().len());
        let measured = MeasuredMap { map: &map, filled, profile, boundary, instrument };
        Ok(Self::new(measured, scene.system))
    }

    /// The parameters as texts: symbol, value, interval and meaning. Value and interval have the same
    /// multiple of the unit.
    pub fn rows(&self) -> impl Iterator<Item = [String; 4]> {
        self.parameters.iter().map(|p| {
            let size = p.value.or(p.ends[0]).or(p.ends[1]).unwrap_or_default();
            let (unit, factor) = match p.power {
                None => ("degrees".to_owned(), 1.0),
                Some(power) => multiple(self.unit(power), size),
            };
            let unit = if ["1", "scene"].contains(&&*unit) { String::new() } else { format!(" {unit}") };
            let digits = |v: f64| short(factor * v);
            let known = |v: f64| format!("{}{unit}", digits(v));
            let (value, interval) = match (p.value, p.ends) {
                (Some(v), [Some(low), Some(high)]) => {
                    (known(v), format!("{} to {}", digits(low), digits(high)))
                }
                (Some(v), _) => (known(v), String::new()),
                (None, [Some(low), None]) => (format!("at least {}", known(low)), String::new()),
                (None, [None, Some(high)]) => (format!("at most {}", known(high)), String::new()),
                (None, _) => ("not found".to_owned(), String::new()),
            };
            [p.symbol.to_owned(), value, interval, p.meaning.to_owned()]
        })
    }

    /// The parameters as aligned lines, followed by those that are missing.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for [symbol, value, interval, meaning] in self.rows() {
            let value = if interval.is_empty() { value } else { format!("{value} ({interval})") };
            text += &format!("{symbol:14} {:36} {meaning}\n", ascii(&value));
        }
        for note in &self.notes {
            text += &format!("not known      {note}\n");
        }
        for remark in &self.remarks {
            text += &format!("note           {remark}\n");
        }
        text
    }
}
