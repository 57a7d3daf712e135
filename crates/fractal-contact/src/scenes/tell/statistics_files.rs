//! The statistics of a map as files: tables as CSV, and pictures of the spectrum, of height differences and of
//! slopes.

use crate::scenes::read::Result;
use crate::scenes::tell::files::{Receive, send};
use crate::scenes::tell::{Bands, FILES, LEVEL, MapStatisticsTables, columns};
use contact_model::{Table, Value};
use plots::{Chart, Curve};
use runs::{Header, csv_bytes};
use std::f64::consts::TAU;
use surface_statistics::{Interval, SpectrumFit, Wavelength};

const LOWER_END: &str =
    "lower end of its 95 % band of Gaussian heights; empty beyond half the side of a free map";

/// The ends of a band in a table.
fn limits(bands: &[Option<[f64; 2]>], index: usize) -> [Value; 2] {
    let limits = bands.get(index).copied().flatten();
    [limits.map(|[low, _]| low).into(), limits.map(|[_, high]| high).into()]
}

/// A band in a picture.
fn shaded(x: &[f64], bands: &[Option<[f64; 2]>]) -> Vec<(f64, f64, f64)> {
    x.iter().zip(bands).filter_map(|(&x, band)| band.map(|[low, high]| (x, low, high))).collect()
}

/// The description of a band, where there is one.
fn shade_words(curves: &[Curve]) -> &'static str {
    let shaded = curves.iter().any(|curve| curve.band.len() > 1);
    if shaded { "; shaded: where 95 % of Gaussian surfaces are" } else { "" }
}

/// The fitted spectrum over its range, between the power laws with both ends of the interval of the exponent.
/// All of them meet in the middle of the power law, which is known best.
fn fitted_line(fit: &SpectrumFit) -> Curve {
    const POINTS: usize = 100;
    let Interval { value, low, high } = fit.hurst;
    let [first, last] = fit.fitted;
    let wavenumber = |found: &Wavelength, none: f64| match found {
        Wavelength::Interval(interval) => TAU / interval.value,
        _ => none,
    };
    let roll_off = wavenumber(&fit.roll_off, 0.0);
    let end = last.min(wavenumber(&fit.cut_off, f64::INFINITY));
    // The density is that at the middle of all of the range.
    let reference = (first * last).sqrt();
    let law = |q: f64, from: f64, hurst: f64| (q / from).powf(-2.0 * (hurst + 1.0));
    let middle = (first.max(roll_off) * end).sqrt();
    let of_middle = fit.density * law(middle, reference, value);
    let density =
        |q: f64, hurst: f64| of_middle * law(q.max(roll_off), middle, hurst) + fit.noise.unwrap_or(0.0);
    let along = (0..POINTS).map(|i| first * (end / first).powf(i as f64 / (POINTS - 1) as f64));
    let along: Vec<f64> = along.collect();
    let band = along.iter().map(|&q| {
        let [a, b] = [low, high].map(|hurst| density(q, hurst));
        (q, a.min(b), a.max(b))
    });
    Curve {
        label: format!("fit, $H$ = {value:.2}, shaded {low:.2} to {high:.2}"),
        band: band.collect(),
        points: along.iter().map(|&q| (q, density(q, value))).collect(),
        ..Curve::default()
    }
}

fn points(x: &[f64], y: &[f64]) -> Vec<(f64, f64)> {
    x.iter().copied().zip(y.iter().copied()).collect()
}

impl MapStatisticsTables {
    /// Makes the tables, and pictures of spectra and height differences.
    ///
    /// # Errors
    /// Pictures that cannot be encoded, and those of `receive`.
    pub(crate) fn files(&self, header: &Header, name: &str, receive: &mut Receive<'_>) -> Result<()> {
        let tables =
            [self.parameter_table()?, self.spectrum_table()?, self.difference_table()?, self.scale_table()?];
        for (file, table) in FILES.iter().zip(tables) {
            receive(file, csv_bytes(&table, header))?;
        }
        self.charts(name).into_iter().try_for_each(|(file, chart)| send(chart.files(file)?, receive))
    }

    fn parameter_table(&self) -> Result<Table> {
        let title = if self.profile { "Statistics of a profile" } else { "Statistics of a surface" };
        let columns = [
            ("quantity", "-", "symbol"),
            ("value", "of its row", "empty where there is only a bound, or nothing"),
            ("low", "of its row", "lower end of the 95 % interval, where there is one"),
            ("high", "of its row", "its upper end"),
            ("unit", "-", "of the row"),
            ("meaning", "-", "what it is"),
        ];
        let rows = self.parameters.iter().map(|p| {
            let unit = p.power.map_or("degrees", |power| self.unit(power));
            let [low, high] = p.ends.map(Value::from);
            [p.symbol.into(), p.value.into(), low, high, unit.into(), p.meaning.into()]
        });
        Ok(columns::table(title, columns, rows, "statistics")?)
    }

    fn spectrum_table(&self) -> Result<Table> {
        let columns = [
            (
                "direction",
                "-",
                "radial: averaged over rings, in length^4; x and y: of profiles, averaged, in length^3",
            ),
            ("wavenumber", self.unit(-1), "q = 2 pi/wavelength"),
            ("density", "of its row", "two-sided: its integral over all q is the variance of the heights"),
            ("low", "of its row", "lower end of the 95 % band of Gaussian heights"),
            ("high", "of its row", "its upper end"),
            ("degrees_of_freedom", "1", "of the mean"),
        ];
        let rows = self.spectra.iter().flat_map(|(direction, s)| {
            let bands = s.band(LEVEL).unwrap_or_default();
            s.wavenumber.iter().zip(&s.density).enumerate().map(move |(i, (&q, &density))| {
                let band = bands.get(i).map_or([None; 2], |band| band.map(Some));
                let [low, high] = band.map(|v| v.filter(|v| v.is_finite()).into());
                let freedom = s.degrees_of_freedom.get(i).copied();
                [(*direction).into(), q.into(), density.into(), low, high, freedom.into()]
            })
        });
        Ok(columns::table("Power spectral densities", columns, rows, "a spectrum")?)
    }

    fn difference_table(&self) -> Result<Table> {
        let square = self.unit(2);
        let columns = [
            ("distance", self.unit(1), "between two points, in any direction"),
            ("half_square", square, "<[h(x + r) - h(x)]^2>/2: the variance less the autocorrelation"),
            ("low", square, LOWER_END),
            ("high", square, "its upper end"),
            ("autocorrelation", "1", "1 - half_square/Sq^2"),
            ("slope", "1", "rms slope over that distance: sqrt(2 half_square)/distance"),
            ("pairs", "1", "of points"),
        ];
        let variance = self.rms_height().map(|rms| rms * rms).filter(|variance| *variance > 0.0);
        let rows = self.differences.iter().flat_map(|(d, bands)| {
            let values = d.distance.iter().zip(&d.half_square).zip(d.slope()).zip(&d.pairs);
            values.enumerate().map(move |(i, (((&r, &a), slope), &pairs))| {
                let [low, high] = limits(bands, i);
                let autocorrelation = variance.map(|variance| 1.0 - a / variance);
                [r.into(), a.into(), low, high, autocorrelation.into(), slope.into(), pairs.into()]
            })
        });
        Ok(columns::table("Height differences", columns, rows, "differences")?)
    }

    fn scale_table(&self) -> Result<Table> {
        let curvature = self.unit(-1);
        let columns = [
            ("axis", "-", "along which differences are taken"),
            ("distance", self.unit(1), "over which they are taken"),
            ("rms_slope", "1", "of first differences over that distance"),
            ("slope_low", "1", LOWER_END),
            ("slope_high", "1", "its upper end"),
            ("rms_curvature", curvature, "of second differences over it; empty where the map is too short"),
            ("curvature_low", curvature, "lower end of its 95 % band"),
            ("curvature_high", curvature, "its upper end"),
        ];
        let rows = self.scales.iter().flat_map(|of| {
            let ((slope, slope_bands), (curvature, curvature_bands)) = (&of.slope, &of.curvature);
            slope.distance.iter().zip(&slope.rms).enumerate().map(move |(i, (&distance, &rms))| {
                let [low, high] = limits(slope_bands, i);
                let at = curvature.distance.iter().position(|d| (d - distance).abs() <= 1e-9 * distance);
                let [curved_low, curved_high] = limits(curvature_bands, at.unwrap_or(usize::MAX));
                let curved = at.and_then(|at| curvature.rms.get(at)).copied().into();
                [of.axis.into(), distance.into(), rms.into(), low, high, curved, curved_low, curved_high]
            })
        });
        Ok(columns::table("Slope and curvature by scale", columns, rows, "scales")?)
    }

    /// The pictures, by the names of their files.
    pub(crate) fn charts(&self, name: &str) -> Vec<(&'static str, Chart)> {
        let charts = [
            ("spectrum", self.spectrum_chart(name)),
            ("height-difference", self.difference_chart(name)),
            ("slope", self.slope_chart(name)),
        ];
        charts.into_iter().filter_map(|(file, chart)| Some((file, chart?))).collect()
    }

    fn spectrum_chart(&self, name: &str) -> Option<Chart> {
        let shown = if self.profile { "x" } else { "radial" };
        let (_, s) = self.spectra.iter().find(|(direction, _)| *direction == shown)?;
        let (averaged, symbol, unit) = if self.profile {
            ("of the profile", "$C_{1D}$", "m^3")
        } else {
            ("averaged over rings", "$C_{2D}$", "m^4")
        };
        let bands = s.band(LEVEL).unwrap_or_default();
        let band = s.wavenumber.iter().zip(bands).map(|(&q, [low, high])| (q, low, high)).collect();
        let [shortest, longest] = self.reliable.unwrap_or([0.0, f64::INFINITY]);
        let trusted = |q: f64| (shortest..=longest).contains(&(TAU / q));
        let (sure, unsure): (Vec<_>, Vec<_>) =
            points(&s.wavenumber, &s.density).into_iter().partition(|&(q, _)| trusted(q));
        let unsure_label = "waves not to be trusted";
        let label = if self.profile { "profile" } else { "map" };
        let mut curves = vec![Curve { label: label.into(), points: sure, band, ..Curve::default() }];
        if curves[0].points.is_empty() {
            curves[0].label = unsure_label.into();
            curves[0].points = unsure;
        } else if !unsure.is_empty() {
            curves.push(Curve { label: unsure_label.into(), points: unsure, ..Curve::default() });
        }
        let shaded = shade_words(&curves);
        curves.extend(self.fit.as_ref().filter(|_| !self.profile).map(fitted_line));
        Some(
            Chart {
                title: "Power spectral density".into(),
                subtitle: format!("{name}: {averaged}, two-sided{shaded}"),
                x_label: "wavenumber $q$".into(),
                y_label: symbol.into(),
                curves,
                logarithmic: true,
                ..Chart::default()
            }
            .in_units(["1/m", unit].map(|unit| self.system.shown(unit))),
        )
    }

    fn difference_chart(&self, name: &str) -> Option<Chart> {
        let (d, bands) = self.differences.as_ref()?;
        let curves = vec![Curve {
            label: if self.profile { "profile".into() } else { "map".into() },
            points: points(&d.distance, &d.half_square),
            band: shaded(&d.distance, bands),
            ..Curve::default()
        }];
        Some(
            Chart {
                title: "Height differences".into(),
                subtitle: if self.profile {
                    format!("{name}: half the mean square along the profile")
                } else {
                    format!("{name}: half the mean square over all directions{}", shade_words(&curves))
                },
                x_label: "distance $r$".into(),
                y_label: "$A$".into(),
                curves,
                logarithmic: true,
                ..Chart::default()
            }
            .in_units(["m", "m^2"].map(|unit| self.system.shown(unit))),
        )
    }

    fn slope_chart(&self, name: &str) -> Option<Chart> {
        let curve = |axis: &str, (slope, bands): &(surface_statistics::ScaleDependence, Bands)| Curve {
            label: format!("along {axis}"),
            points: points(&slope.distance, &slope.rms),
            band: shaded(&slope.distance, bands),
            ..Curve::default()
        };
        let curves: Vec<Curve> = self.scales.iter().map(|of| curve(of.axis, &of.slope)).collect();
        (!curves.is_empty()).then(|| {
            Chart {
                title: "Slope by scale".into(),
                subtitle: format!("{name}: rms of differences over a distance{}", shade_words(&curves)),
                x_label: "distance $r$".into(),
                y_label: "rms slope".into(),
                curves,
                logarithmic: true,
                ..Chart::default()
            }
            .in_units(["m", ""].map(|unit| self.system.shown(unit)))
        })
    }
}
