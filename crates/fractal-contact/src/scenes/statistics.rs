//! Statistics of a map as tables and pictures: `statistics.csv`, `spectrum.csv`, `height-difference.csv`, `scale-dependence.csv`.

use crate::scenes::entries::System;
use crate::scenes::error::Result;
use crate::scenes::grid_comparison::solved_map;
use crate::scenes::scene_file::SceneFile;
use crate::scenes::scene_surface::SceneSurface;
use crate::scenes::summary::short;
use analysis::{Column, Table, Value};
use contact_model::{Boundary, HeightMap, Surface};
use plots::{Chart, Curve};
use runs::{Header, write_csv};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use surface_statistics::{
    Bins, Derivatives, DifferenceMap, FeatureParameters, HeightDifference, HeightParameters,
    HybridParameters, Interval, PowerSpectrum, ReliableWavelengths, ScaleDependence, SpatialParameters,
    SpectrumFit, Taper, Wavelength, texture_direction,
};

/// Bins in a decade of wavenumbers and of distances.
const PER_DECADE: f64 = 10.0;
/// Of the bands.
const LEVEL: f64 = 0.95;
/// The files.
pub(crate) const FILES: [&str; 8] = [
    "statistics.csv",
    "spectrum.csv",
    "height-difference.csv",
    "scale-dependence.csv",
    "spectrum.svg",
    "spectrum.png",
    "height-difference.svg",
    "height-difference.png",
];

/// One number.
struct Parameter {
    symbol: &'static str,
    value: Option<f64>,
    /// Ends of the 95 % interval; one of them for a bound.
    ends: [Option<f64>; 2],
    /// Power of the length in its unit; `None` for an angle.
    power: Option<i32>,
    meaning: &'static str,
}

/// What a map is, and why some of it is not known.
pub(crate) struct MapStatisticsTables {
    system: System,
    parameters: Vec<Parameter>,
    spectra: Vec<(&'static str, PowerSpectrum)>,
    differences: Option<HeightDifference>,
    scales: Vec<(&'static str, ScaleDependence, ScaleDependence)>,
    /// Reasons why a part is missing.
    pub notes: Vec<String>,
}

impl MapStatisticsTables {
    /// Measures a map: of a periodic surface without a window, else under Hann's over its deviation from the mean.
    pub fn new(map: &HeightMap, boundary: Boundary, instrument: Option<f64>, system: System) -> Self {
        let mut found = Self {
            system,
            parameters: Vec::new(),
            spectra: Vec::new(),
            differences: None,
            scales: Vec::new(),
            notes: Vec::new(),
        };
        found.heights(map);
        found.spectra(map, boundary);
        found.fit(map, boundary, instrument);
        let differences = DifferenceMap::new(map, boundary);
        let radial = Bins::of_distances(map, PER_DECADE).and_then(|bins| differences.radial(&bins));
        found.differences = found.known("height differences", radial);
        let along = [
            (
                "x",
                ScaleDependence::slope_along_x(map, boundary),
                ScaleDependence::curvature_along_x(map, boundary),
            ),
            (
                "y",
                ScaleDependence::slope_along_y(map, boundary),
                ScaleDependence::curvature_along_y(map, boundary),
            ),
        ];
        for (axis, slope, curvature) in along {
            let slope = found.known("slope by scale", slope);
            if let Some((slope, curvature)) = slope.zip(found.known("curvature by scale", curvature)) {
                found.scales.push((axis, slope, curvature));
            }
        }
        found
    }

    fn known<T>(&mut self, what: &str, found: contact_model::Result<T>) -> Option<T> {
        found.map_err(|reason| self.notes.push(format!("{what}: {reason}"))).ok()
    }

    fn push(&mut self, symbol: &'static str, value: Option<f64>, power: i32, meaning: &'static str) {
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
        if let Some(s) = self.known("spatial parameters", SpatialParameters::new(map)) {
            self.push("Sal", s.sal, 1, "shortest distance at which the autocorrelation has fallen to 0.2");
            self.push("Str", s.str, 0, "that over the longest one: 1 for an isotropic surface");
        }
        if let Some(std) = self.known("texture direction", texture_direction(map)) {
            let meaning =
                "direction of the waves that have most of the variance, from x towards y; the lay is across";
            self.parameters.push(Parameter {
                symbol: "Std",
                value: Some(std),
                ends: [None; 2],
                power: None,
                meaning,
            });
        }
        if let Some(f) = self.known("feature parameters", FeatureParameters::new(map)) {
            self.push("Spd", Some(f.spd), -2, "density of hills that are higher than 5 % of Sz");
            self.push("Spc", f.spc, -1, "mean curvature of their peaks");
        }
        if let Some(d) = self.known("derivatives", Derivatives::new(map, Boundary::Free)) {
            self.push("rms gradient", Some(d.rms_gradient), 0, "from differences of neighbouring cells");
            self.push("rms curvature", Some(d.rms_curvature), -1, "half the Laplacian, likewise");
        }
        if let Some(statistics) = self.known("Nayak's parameter", surface_gen::MapStatistics::new(map)) {
            let nayak = surface_statistics::nayak_parameter(&statistics);
            self.push(
                "alpha",
                Some(nayak).filter(|a| a.is_finite()),
                0,
                "Nayak's parameter m0 m4/m2^2, at least 1.5: the wider the spectrum, the larger",
            );
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

    fn fit(&mut self, map: &HeightMap, boundary: Boundary, instrument: Option<f64>) {
        // Of the tip's distance the stencil has two.
        let instrument = instrument.map(|distance| 2.0 * distance);
        let Some(reliable) = self.known("wavelengths", ReliableWavelengths::new(map, boundary, instrument))
        else {
            return;
        };
        self.push("shortest", Some(reliable.shortest), 1, "wavelength down to which the map can be trusted");
        self.push("longest", Some(reliable.longest), 1, "wavelength up to which it can");
        let Some(fit) = self
            .known("fit of a self-affine spectrum", SpectrumFit::new(map, &reliable.fit_options(boundary)))
        else {
            return;
        };
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

    fn unit(&self, power: i32) -> &'static str {
        match (self.system, power) {
            (_, 0) => "1",
            (System::None, _) => "scene",
            (_, 1) => "m",
            (_, -1) => "1/m",
            (_, -2) => "1/m^2",
            (_, 3) => "m^3",
            _ => "m^4",
        }
    }

    /// Of the first surface of a scene, as it is solved.
    ///
    /// # Errors
    /// A surface that cannot be drawn.
    pub fn of_scene(scene: &SceneFile) -> Result<Self> {
        let of_file = match &scene.surface {
            SceneSurface::Plain(Surface::Heights(map)) => Some(Arc::clone(map)),
            _ => None,
        };
        let with_cells = scene.models.iter().find(|model| model.boundary_elements().is_some());
        let drawn = with_cells.map(|model| solved_map(scene, model, scene.seed(0))).transpose();
        let Some(map) = drawn.map_err(runs::Error::model("statistics"))?.or(of_file) else {
            let refused = contact_model::Error::unsupported(
                "statistics",
                "a surface that no model here solves on cells",
            );
            return Err(runs::Error::model("statistics")(refused).into());
        };
        Ok(Self::new(&map, scene.effects.boundary, scene.reliable_from, scene.system))
    }

    /// The parameters as aligned lines, what is missing below.
    pub fn text(&self) -> String {
        let mut text = String::new();
        for p in &self.parameters {
            let unit = p.power.map_or(" degrees".to_owned(), |power| match self.unit(power) {
                "1" | "scene" => String::new(),
                unit => format!(" {unit}"),
            });
            let value = match (p.value, p.ends) {
                (Some(v), [Some(low), Some(high)]) => {
                    format!("{}{unit} ({} to {})", short(v), short(low), short(high))
                }
                (Some(v), _) => format!("{}{unit}", short(v)),
                (None, [Some(low), None]) => format!("at least {}{unit}", short(low)),
                (None, [None, Some(high)]) => format!("at most {}{unit}", short(high)),
                (None, _) => "not found".to_owned(),
            };
            text += &format!("{:14} {value:36} {}\n", p.symbol, p.meaning);
        }
        for note in &self.notes {
            text += &format!("not known      {note}\n");
        }
        text
    }

    /// Writes the tables, and pictures of spectra and height differences.
    ///
    /// # Errors
    /// Files that cannot be written.
    pub fn write(&self, out: &Path, header: &Header, name: &str) -> Result<Vec<PathBuf>> {
        let tables =
            [self.parameter_table()?, self.spectrum_table()?, self.difference_table()?, self.scale_table()?];
        let mut files = Vec::new();
        for (file, table) in FILES.iter().zip(tables) {
            let path = out.join(file);
            write_csv(&path, &table, header)?;
            files.push(path);
        }
        for (file, chart) in self.charts(name) {
            files.extend(chart.save(out, file)?);
        }
        Ok(files)
    }

    fn parameter_table(&self) -> Result<Table> {
        let column = |name, unit, meaning| Column { name, unit, meaning };
        let columns = vec![
            column("quantity", "-", "symbol"),
            column("value", "of its row", "empty where there is only a bound, or nothing"),
            column("low", "of its row", "lower end of the 95 % interval, where there is one"),
            column("high", "of its row", "its upper end"),
            column("unit", "-", "of the row"),
            column("meaning", "-", "what it is"),
        ];
        let mut table = Table::new("Statistics of a surface", columns);
        for p in &self.parameters {
            let unit = p.power.map_or("degrees", |power| self.unit(power));
            let row = vec![
                p.symbol.into(),
                p.value.into(),
                p.ends[0].into(),
                p.ends[1].into(),
                unit.into(),
                p.meaning.into(),
            ];
            table.push(row).map_err(runs::Error::model("statistics"))?;
        }
        Ok(table)
    }

    fn spectrum_table(&self) -> Result<Table> {
        let column = |name, unit, meaning| Column { name, unit, meaning };
        let columns = vec![
            column(
                "direction",
                "-",
                "radial: averaged over rings, in length^4; x and y: of profiles, averaged, in length^3",
            ),
            column("wavenumber", self.unit(-1), "q = 2 pi/wavelength"),
            column(
                "density",
                "of its row",
                "two-sided: its integral over all q is the variance of the heights",
            ),
            column("low", "of its row", "lower end of the 95 % band of Gaussian heights"),
            column("high", "of its row", "its upper end"),
            column("degrees_of_freedom", "1", "of the mean"),
        ];
        let mut table = Table::new("Power spectral densities", columns);
        for (direction, s) in &self.spectra {
            let bands = s.band(LEVEL).unwrap_or_default();
            for (i, (&q, &density)) in s.wavenumber.iter().zip(&s.density).enumerate() {
                let [low, high] = bands
                    .get(i)
                    .map_or([None; 2], |band| band.map(Some))
                    .map(|v| v.filter(|v| v.is_finite()));
                let freedom = s.degrees_of_freedom.get(i).copied();
                let row: Vec<Value> = vec![
                    (*direction).into(),
                    q.into(),
                    density.into(),
                    low.into(),
                    high.into(),
                    freedom.into(),
                ];
                table.push(row).map_err(runs::Error::model("a spectrum"))?;
            }
        }
        Ok(table)
    }

    fn difference_table(&self) -> Result<Table> {
        let column = |name, unit, meaning| Column { name, unit, meaning };
        let square = if self.system == System::Si { "m^2" } else { "scene" };
        let columns = vec![
            column("distance", self.unit(1), "between two points, in any direction"),
            column("half_square", square, "<[h(x + r) - h(x)]^2>/2: the variance less the autocorrelation"),
            column("slope", "1", "rms slope over that distance: sqrt(2 half_square)/distance"),
            column("pairs", "1", "of points"),
        ];
        let mut table = Table::new("Height differences", columns);
        if let Some(d) = &self.differences {
            for (((&r, &a), slope), &pairs) in
                d.distance.iter().zip(&d.half_square).zip(d.slope()).zip(&d.pairs)
            {
                table
                    .push(vec![r.into(), a.into(), slope.into(), pairs.into()])
                    .map_err(runs::Error::model("differences"))?;
            }
        }
        Ok(table)
    }

    fn scale_table(&self) -> Result<Table> {
        let column = |name, unit, meaning| Column { name, unit, meaning };
        let columns = vec![
            column("axis", "-", "along which differences are taken"),
            column("distance", self.unit(1), "over which they are taken"),
            column("rms_slope", "1", "of first differences over that distance"),
            column(
                "rms_curvature",
                self.unit(-1),
                "of second differences over it; empty where the map is too short",
            ),
        ];
        let mut table = Table::new("Slope and curvature by scale", columns);
        for (axis, slope, curvature) in &self.scales {
            for (&distance, &rms) in slope.distance.iter().zip(&slope.rms) {
                let of = curvature.distance.iter().position(|d| (d - distance).abs() <= 1e-9 * distance);
                let curvature = of.and_then(|i| curvature.rms.get(i)).copied();
                table
                    .push(vec![(*axis).into(), distance.into(), rms.into(), curvature.into()])
                    .map_err(runs::Error::model("scales"))?;
            }
        }
        Ok(table)
    }

    /// The pictures, by the names of their files.
    pub fn charts(&self, name: &str) -> Vec<(&'static str, Chart)> {
        let si = |unit: &str| {
            if self.system == System::Si { format!(" ($\\rm{{{unit}}}$)") } else { String::new() }
        };
        let mut charts = Vec::new();
        let points = |x: &[f64], y: &[f64]| x.iter().copied().zip(y.iter().copied()).collect::<Vec<_>>();
        if let Some((_, s)) = self.spectra.iter().find(|(direction, _)| *direction == "radial") {
            let band = s.band(LEVEL).unwrap_or_default();
            let band = s.wavenumber.iter().zip(band).map(|(&q, [low, high])| (q, low, high)).collect();
            charts.push((
                "spectrum",
                Chart {
                    title: "Power spectral density".into(),
                    subtitle: format!(
                        "{name}: averaged over rings, two-sided; shaded: 95 % of Gaussian heights"
                    ),
                    x_label: format!("wavenumber $q${}", si("1/m")),
                    y_label: format!("$C_{{2D}}${}", si("m^4")),
                    curves: vec![Curve {
                        label: "map".into(),
                        points: points(&s.wavenumber, &s.density),
                        band,
                    }],
                    logarithmic: true,
                },
            ));
        }
        if let Some(d) = &self.differences {
            charts.push((
                "height-difference",
                Chart {
                    title: "Height differences".into(),
                    subtitle: format!("{name}: half the mean square over all directions"),
                    x_label: format!("distance $r${}", si("m")),
                    y_label: format!("$A${}", si("m^2")),
                    curves: vec![Curve {
                        label: "map".into(),
                        points: points(&d.distance, &d.half_square),
                        band: Vec::new(),
                    }],
                    logarithmic: true,
                },
            ));
        }
        charts
    }
}
