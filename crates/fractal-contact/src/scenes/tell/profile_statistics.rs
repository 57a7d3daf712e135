//! Statistics of a profile: parameters of ISO 21920-2 instead of those of a surface.

use crate::scenes::tell::{MapStatisticsTables, Parameter, SlopeAndCurvature};
use contact_model::{Boundary, HeightMap};
use surface_statistics::{
    DifferenceMap, HeightParameters, PowerSpectrum, ProfileFit, ScaleDependence, Taper,
};

impl MapStatisticsTables {
    /// Measures one row: heights, spectrum, differences and slopes along x, Hurst exponent.
    pub(super) fn measure_profile(&mut self, map: &HeightMap, boundary: Boundary, instrument: Option<f64>) {
        self.remarks.push(
            "a profile: parameters are those of one line (ISO 21920-2), not areal ones; no filter was applied, so that they are of the primary \
             profile: Pa, Pq, ... are Ra, Rq, ... of a profile after a filter"
                .into(),
        );
        self.profile_heights(map, boundary);
        let taper = if boundary == Boundary::Periodic { Taper::None } else { Taper::Hann };
        if let Some(spectrum) = self.known("spectrum", PowerSpectrum::along_x(map, taper)) {
            self.spectra.push(("x", spectrum));
        }
        // The stencil spans twice the distance of the tip.
        let instrument = instrument.map(|distance| 2.0 * distance);
        if let Some(fit) = self.known("Hurst exponent", ProfileFit::new(map, boundary, instrument)) {
            let [shortest, longest] = fit.wavelengths;
            self.reliable = Some(fit.wavelengths);
            self.push("shortest", Some(shortest), 1, "wavelength from which the exponent was fitted");
            self.push("longest", Some(longest), 1, "wavelength up to which it was");
            let meaning = "Hurst exponent of the profile's own spectrum, C_1D ~ q^-(1 + 2H)";
            let ends = [Some(fit.hurst.low), Some(fit.hurst.high)];
            let value = Some(fit.hurst.value);
            self.parameters.push(Parameter { symbol: "H", value, ends, power: Some(0), meaning });
        }
        if let Some(found) = self.known("height differences", DifferenceMap::new(map, boundary).along_x()) {
            self.differences = Some((found, Vec::new()));
        }
        let slope = self.known("slope by scale", ScaleDependence::slope_along_x(map, boundary));
        let curvature = self.known("curvature by scale", ScaleDependence::curvature_along_x(map, boundary));
        if let Some((slope, curvature)) = slope.zip(curvature) {
            let (slope, curvature) = ((slope, Vec::new()), (curvature, Vec::new()));
            self.scales.push(SlopeAndCurvature { axis: "x", slope, curvature });
        }
    }

    fn profile_heights(&mut self, map: &HeightMap, boundary: Boundary) {
        if let Some(h) = self.known("height parameters", HeightParameters::new(map)) {
            for (symbol, value, power, meaning) in [
                ("Pa", h.sa, 1, "mean absolute height of the profile"),
                ("Pq", h.sq, 1, "rms height of the profile"),
                ("Psk", h.ssk, 0, "skewness of its heights"),
                ("Pku", h.sku, 0, "kurtosis of its heights; 3 for Gaussian ones"),
                ("Pp", h.sp, 1, "highest point above the mean"),
                ("Pv", h.sv, 1, "lowest point below the mean"),
                ("Pz", h.sz, 1, "Pp + Pv over the whole length, which is also the total height Pt"),
            ] {
                self.push(symbol, Some(value), power, meaning);
            }
        }
        let slope = self.known("rms slope", ScaleDependence::slope_along_x(map, boundary));
        let first = |found: &ScaleDependence| found.rms.first().copied();
        if let Some(slope) = slope {
            self.push("rms slope", first(&slope), 0, "from differences of neighbouring points");
        }
        let curvature = self.known("rms curvature", ScaleDependence::curvature_along_x(map, boundary));
        if let Some(curvature) = curvature {
            self.push(
                "rms curvature",
                first(&curvature),
                -1,
                "from second differences of neighbouring points",
            );
        }
    }
}
