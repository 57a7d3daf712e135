//! Physics: what is pressed, which effects count, what is asked.

use crate::cells::Size;
use crate::error::{Error, Result, non_negative, positive};
use crate::height_map::HeightMap;
use crate::line::Line;
use crate::pair::Pair;
use crate::quantities::Outputs;
use crate::rheology::Rheology;
use std::sync::Arc;

/// How far the modulus may be from E* of the pair: it may have been rounded on its way through a file.
const SAME_MODULUS: f64 = 1e-9;

/// Everything physical about one question. Numerics are a model's own options, chance is the seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// What carries the relief.
    pub surface: Surface,
    /// Effective modulus E* of the pair, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
    pub modulus: f64,
    /// Both bodies, where E* does not say enough (friction); their E* is `modulus`.
    pub pair: Option<Pair>,
    /// Effects beyond linear elastic normal contact with free boundaries; all off by default.
    pub effects: Effects,
    /// What is computed besides force and approach; [`Scene::new`] asks for the stiffness alone.
    pub outputs: Outputs,
}

impl Scene {
    /// A scene with no effects that asks for the stiffness.
    pub fn new(surface: Surface, modulus: f64) -> Self {
        let outputs = Outputs { stiffness: true, ..Outputs::default() };
        Self { surface, modulus, pair: None, effects: Effects::default(), outputs }
    }

    /// A scene with both bodies named: its modulus is their E*.
    ///
    /// # Errors
    /// As [`Pair::modulus`].
    ///
    /// ```
    /// use contact_model::{Body, Pair, Scene, Surface};
    /// let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.5 } };
    /// assert_eq!(Scene::of_pair(Surface::Sphere { radius: 1.0, size: 1.0.into() }, pair)?.modulus, 4.0);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn of_pair(surface: Surface, pair: Pair) -> Result<Self> {
        Ok(Self { pair: Some(pair), ..Self::new(surface, pair.modulus()?) })
    }

    /// Checks the numbers that every model relies on: modulus, bodies, effects, outputs and the surface's own
    /// parameters.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense, or a modulus that is not E* of the pair.
    pub fn validate(&self) -> Result<()> {
        positive("modulus", self.modulus)?;
        if let Some(pair) = &self.pair {
            let expected = pair.modulus()?;
            if (self.modulus / expected - 1.0).abs() > SAME_MODULUS {
                return Err(Error::domain("modulus", self.modulus, format!("{expected}, E* of the pair")));
            }
        }
        self.effects.validate()?;
        self.outputs.conductance.resistivity()?;
        if self.outputs.mean_gap && self.effects.boundary != Boundary::Periodic {
            let what = "a mean gap: its states have an approach";
            return Err(Error::unsupported("of free boundaries", what));
        }
        if self.outputs.plastic_depth && self.effects.hardness == Hardness::Off {
            let what = "a field of the plastic indentation (it needs a hardness)";
            return Err(Error::unsupported("of elastic contact", what));
        }
        self.surface.validate()
    }
}

/// What carries the relief. Axisymmetric bodies sit in the middle of the rectangle, apex up.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// A random self-affine surface, drawn from the seed.
    SelfAffine(SelfAffine),
    /// A given map.
    Heights(Arc<HeightMap>),
    /// A given profile: a map of one row that stands for a body uniform along y (plane strain). A force on it is that on the side of
    /// its row along y.
    Profile(Arc<HeightMap>),
    /// A given line (for one-dimensional models), standing for a rectangle.
    Line {
        /// The line.
        line: Arc<Line>,
        /// Sides of the rectangle that it stands for.
        size: Size,
    },
    /// Paraboloid `z = r^2 / (2 R)`: Hertz's sphere.
    Sphere {
        /// Radius of curvature R.
        radius: f64,
        /// Sides of the rectangle.
        size: Size,
    },
    /// Cone `z = slope r`.
    Cone {
        /// Slope.
        slope: f64,
        /// Sides of the rectangle.
        size: Size,
    },
    /// Power-law body `z = coefficient r^exponent`.
    PowerLaw {
        /// Coefficient c (length^(1 - exponent)).
        coefficient: f64,
        /// Exponent n > 0.
        exponent: f64,
        /// Sides of the rectangle.
        size: Size,
    },
    /// A flat circular punch of the given radius; outside it nothing can touch.
    FlatCircle {
        /// Radius a of the face.
        radius: f64,
        /// Sides of the rectangle.
        size: Size,
    },
    /// A flat rectangle: all of it touches at once.
    Flat {
        /// Sides of the rectangle.
        size: Size,
    },
    /// `h = amplitude cos(2 pi x / wavelength)`, waves along x.
    Sine {
        /// Amplitude (half the trough-to-crest height).
        amplitude: f64,
        /// Wavelength.
        wavelength: f64,
        /// Sides of the rectangle.
        size: Size,
    },
}

impl Surface {
    /// Sides of the nominal contact area.
    pub fn size(&self) -> Size {
        match self {
            Self::SelfAffine(s) => s.size,
            Self::Heights(m) | Self::Profile(m) => m.size(),
            Self::Line { size, .. }
            | Self::Sphere { size, .. }
            | Self::Cone { size, .. }
            | Self::PowerLaw { size, .. }
            | Self::FlatCircle { size, .. }
            | Self::Flat { size }
            | Self::Sine { size, .. } => *size,
        }
    }

    /// Short name for messages.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::SelfAffine(_) => "a self-affine surface",
            Self::Heights(_) => "a height map",
            Self::Profile(_) => "a profile (a body uniform along y)",
            Self::Line { .. } => "a line",
            Self::Sphere { .. } => "a sphere",
            Self::Cone { .. } => "a cone",
            Self::PowerLaw { .. } => "a power-law body",
            Self::FlatCircle { .. } => "a flat circular punch",
            Self::Flat { size } if size.is_square() => "a flat square",
            Self::Flat { .. } => "a flat rectangle",
            Self::Sine { .. } => "a sinusoidal surface",
        }
    }

    /// Checks the surface's own parameters.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense.
    pub fn validate(&self) -> Result<()> {
        self.size().validate()?;
        match *self {
            Self::SelfAffine(ref s) => s.validate()?,
            Self::Sphere { radius, .. } | Self::FlatCircle { radius, .. } => {
                positive("radius", radius)?;
            }
            Self::Cone { slope, .. } => {
                positive("slope", slope)?;
            }
            Self::PowerLaw { coefficient, exponent, .. } => {
                positive("coefficient", coefficient)?;
                positive("exponent", exponent)?;
            }
            Self::Sine { amplitude, wavelength, .. } => {
                positive("amplitude", amplitude)?;
                positive("wavelength", wavelength)?;
            }
            Self::Profile(ref map) if map.rows() != 1 => {
                return Err(Error::domain("rows of a profile", map.rows() as f64, "1"));
            }
            Self::Heights(_) | Self::Profile(_) | Self::Line { .. } | Self::Flat { .. } => {}
        }
        Ok(())
    }
}

/// A self-affine surface: `C_2D(q) ~ q^(-2 (H + 1))` from the longest wave to the grid's shortest (Eqs. 3,
/// 4).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfAffine {
    /// Sides of the rectangle; a line that stands for it has the length [`line_length`] of `sqrt(Lx Ly)`.
    pub size: Size,
    /// Hurst exponent in [0, 1]; the fractal dimension is `3 - hurst`.
    pub hurst: f64,
    /// What fixes the vertical scale.
    pub amplitude: Amplitude,
    /// Roll-off wavenumber q_r: below it the spectrum is the constant `C(q_r)`. `None`: no roll-off (the
    /// paper's case).
    pub roll_off: Option<f64>,
    /// Largest wavenumber. `None`: the grid's shortest isotropic wave, `|q| <= pi / max(dx, dy)`.
    pub short_cutoff: Option<f64>,
}

/// What fixes the vertical scale of a self-affine surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amplitude {
    /// The rms height of the sampled surface, exactly, at any resolution (the paper's choice: F_bar is
    /// counted in it).
    RmsHeight(f64),
    /// The constant `C_2D(q_0)` at `q_0 = 2 pi / L`, `L = sqrt(Lx Ly)` (length^4): finer grids add waves and
    /// leave the long ones alone. In one dimension `C_1D = pi q C_2D` (Eq. 17).
    Spectrum(f64),
}

impl SelfAffine {
    /// The paper's surface: no roll-off, spectrum to the grid's end, prescribed rms height.
    /// `fractal_dimension` = 3 - H.
    ///
    /// # Errors
    /// [`Error::Domain`] for a fractal dimension outside [2, 3] or a side or height that is not positive.
    pub fn new(fractal_dimension: f64, size: impl Into<Size>, rms_height: f64) -> Result<Self> {
        if !(2.0..=3.0).contains(&fractal_dimension) {
            return Err(Error::domain("fractal_dimension", fractal_dimension, "a number in [2, 3]"));
        }
        let amplitude = Amplitude::RmsHeight(rms_height);
        let hurst = 3.0 - fractal_dimension;
        let surface = Self { size: size.into(), hurst, amplitude, roll_off: None, short_cutoff: None };
        surface.validate()?;
        Ok(surface)
    }

    /// `D_f = 3 - H`.
    pub fn fractal_dimension(&self) -> f64 {
        3.0 - self.hurst
    }

    /// Checks every parameter.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense.
    pub fn validate(&self) -> Result<()> {
        self.size.validate()?;
        if !(0.0..=1.0).contains(&self.hurst) {
            return Err(Error::domain("hurst", self.hurst, "a number in [0, 1]"));
        }
        match self.amplitude {
            Amplitude::RmsHeight(h) => positive("rms_height", h)?,
            Amplitude::Spectrum(c) => positive("spectrum constant", c)?,
        };
        for (name, q) in [("roll_off", self.roll_off), ("short_cutoff", self.short_cutoff)] {
            if let Some(q) = q {
                positive(name, q)?;
            }
        }
        if let (Some(low), Some(high)) = (self.roll_off, self.short_cutoff)
            && low > high
        {
            return Err(Error::domain("roll_off", low, format!("at most the short cut-off {high}")));
        }
        Ok(())
    }
}

/// Length of the line that stands for a square of side L: `L_1D = (2 / sqrt(pi)) L` (Eq. 18).
///
/// ```
/// assert!((contact_model::line_length(1.0) - 1.128379167).abs() < 1e-9);
/// ```
pub fn line_length(side: f64) -> f64 {
    side * std::f64::consts::FRAC_2_SQRT_PI
}

/// Effects beyond linear elastic normal contact with free boundaries. Off unless named; a model that lacks
/// one refuses it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effects {
    /// What lies outside the square.
    pub boundary: Boundary,
    /// Largest pressure that the bodies carry. A load is solved from the virgin surface; the indentation of a path stays from step to
    /// step ([`crate::PreparedContact::advance_until`]).
    pub hardness: Hardness,
    /// Attraction between the surfaces.
    pub adhesion: Adhesion,
    /// Friction under tangential load.
    pub friction: Friction,
    /// Time dependence of the material.
    pub rheology: Rheology,
}

impl Effects {
    /// Checks the parameters of the effects that are on.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense.
    pub fn validate(&self) -> Result<()> {
        if let Hardness::Limit { pressure } = self.hardness {
            positive("hardness", pressure)?;
        }
        match self.adhesion {
            Adhesion::Off => {}
            Adhesion::ShortRange { work } => {
                non_negative("work of adhesion", work)?;
            }
            Adhesion::FiniteRange { work, range, .. } => {
                non_negative("work of adhesion", work)?;
                positive("range of adhesion", range)?;
            }
        }
        if let Friction::Coulomb { coefficient } = self.friction {
            non_negative("coefficient of friction", coefficient)?;
        }
        self.rheology.validate()
    }

    /// The effects that are on; the boundary is none of them ([`Effects::boundary`]).
    ///
    /// ```
    /// use contact_model::{Adhesion, Effect, Effects};
    /// let effects = Effects { adhesion: Adhesion::ShortRange { work: 0.1 }, ..Effects::default() };
    /// assert_eq!(effects.named().collect::<Vec<_>>(), [Effect::ShortRangeAdhesion]);
    /// ```
    pub fn named(&self) -> impl Iterator<Item = Effect> + use<> {
        // All fields, so that a new effect is not forgotten.
        let Self { boundary: _, hardness, adhesion, friction, rheology } = self;
        let hardness = match hardness {
            Hardness::Off => None,
            Hardness::Limit { .. } => Some(Effect::Hardness),
        };
        let adhesion = match adhesion {
            Adhesion::Off => None,
            Adhesion::ShortRange { .. } => Some(Effect::ShortRangeAdhesion),
            Adhesion::FiniteRange { law: AdhesionLaw::Exponential, .. } => Some(Effect::ExponentialAdhesion),
            Adhesion::FiniteRange { law: AdhesionLaw::Dugdale, .. } => Some(Effect::DugdaleAdhesion),
        };
        let friction = match friction {
            Friction::Off => None,
            Friction::Coulomb { .. } => Some(Effect::Friction),
        };
        let rheology = match rheology {
            Rheology::Elastic => None,
            Rheology::KelvinVoigt { .. } => Some(Effect::KelvinVoigt),
            Rheology::Maxwell { .. } => Some(Effect::Maxwell),
            Rheology::StandardSolid { .. } => Some(Effect::StandardSolid),
            Rheology::Prony(_) => Some(Effect::PronySeries),
        };
        [hardness, adhesion, friction, rheology].into_iter().flatten()
    }
}

macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $variant:ident $key:literal $words:literal,)+) => {
        /// An effect that is on, without its numbers: what a model can or cannot do.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Effect {
            $($(#[doc = $doc])+ $variant,)+
        }

        impl Effect {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Its key in `[effects]` of a scene and in Python.
            pub fn key(self) -> &'static str {
                match self {
                    $(Self::$variant => $key,)+
                }
            }

            /// What it is, for refusals and tables.
            pub fn words(self) -> &'static str {
                match self {
                    $(Self::$variant => $words,)+
                }
            }
        }
    };
}

// Each with its key in `[effects]` and its words.
effects! {
    /// [`Hardness::Limit`].
    Hardness "hardness" "a hardness",
    /// [`Adhesion::ShortRange`].
    ShortRangeAdhesion "adhesion" "adhesion of short range",
    /// [`Adhesion::FiniteRange`] with [`AdhesionLaw::Exponential`].
    ExponentialAdhesion "adhesion" "adhesion by the exponential law",
    /// [`Adhesion::FiniteRange`] with [`AdhesionLaw::Dugdale`].
    DugdaleAdhesion "adhesion" "adhesion by Dugdale's law",
    /// [`Friction::Coulomb`].
    Friction "friction" "friction",
    /// [`Rheology::KelvinVoigt`].
    KelvinVoigt "rheology" "the rheology of Kelvin and Voigt",
    /// [`Rheology::Maxwell`].
    Maxwell "rheology" "the rheology of Maxwell",
    /// [`Rheology::StandardSolid`].
    StandardSolid "rheology" "the rheology of a standard solid",
    /// [`Rheology::Prony`].
    PronySeries "rheology" "the rheology of a Prony series",
}

/// What lies outside the square.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Boundary {
    /// An unloaded half-space: the edges are the physical edges of the indenter (the paper's case).
    #[default]
    Free,
    /// Periodic copies of the square.
    Periodic,
}

/// Largest pressure that the bodies carry: where it is reached, the softer one is indented without a further rise of the pressure
/// (perfect plasticity, `0 <= p <= p_s`).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Hardness {
    /// None: the contact stays elastic at any pressure.
    #[default]
    Off,
    /// A limit of the pressure.
    Limit {
        /// Hardness p_s.
        pressure: f64,
    },
}

/// Attraction between the surfaces.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Adhesion {
    /// None.
    #[default]
    Off,
    /// Short-range adhesion (JKR) with this work of adhesion (energy per area): the limit in which nothing attracts across a gap and the
    /// edges of a contact bear any tension.
    ShortRange {
        /// Work of adhesion Delta gamma.
        work: f64,
    },
    /// Attraction across an open gap g.
    FiniteRange {
        /// Work of adhesion Delta gamma: the integral of the traction over all gaps.
        work: f64,
        /// Range rho: the traction is about `work/range` below it.
        range: f64,
        /// How the traction falls with the gap.
        law: AdhesionLaw,
    },
}

/// How the attractive traction of [`Adhesion::FiniteRange`] falls with the gap g.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum AdhesionLaw {
    /// `work/range exp(-g/range)`.
    Exponential,
    /// `work/range` up to the range, none beyond (Dugdale, Maugis).
    Dugdale,
}

/// Friction under tangential load.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Friction {
    /// None.
    #[default]
    Off,
    /// Coulomb's law with this coefficient.
    Coulomb {
        /// Coefficient of friction.
        coefficient: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::Body;

    #[test]
    fn fractal_dimension_is_checked() {
        for df in [1.99, 3.01, f64::NAN, f64::INFINITY] {
            assert!(SelfAffine::new(df, 1.0, 1.0).is_err());
        }
        assert!(SelfAffine::new(2.4, 1.0, 0.0).is_err());
        assert!(SelfAffine::new(2.0, 1.0, 1.0).is_ok_and(|s| s.hurst >= 1.0));
    }

    #[test]
    fn effects_are_named() {
        let mut scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        assert_eq!(scene.effects.named().count(), 0);
        scene.effects.adhesion = Adhesion::ShortRange { work: 0.1 };
        let named: Vec<&str> = scene.effects.named().map(Effect::words).collect();
        assert_eq!(named, ["adhesion of short range"]);
        scene.modulus = f64::NAN;
        assert!(scene.validate().is_err());
    }

    #[test]
    fn effects_and_bodies_are_checked() {
        let mut scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        for effects in [
            Effects { adhesion: Adhesion::ShortRange { work: -0.1 }, ..Effects::default() },
            Effects { hardness: Hardness::Limit { pressure: 0.0 }, ..Effects::default() },
            Effects {
                adhesion: Adhesion::FiniteRange { work: 1.0, range: f64::NAN, law: AdhesionLaw::Dugdale },
                ..Effects::default()
            },
            Effects { friction: Friction::Coulomb { coefficient: f64::INFINITY }, ..Effects::default() },
            Effects { rheology: Rheology::KelvinVoigt { viscosity: 0.0 }, ..Effects::default() },
        ] {
            scene.effects = effects;
            assert!(matches!(scene.validate(), Err(Error::Domain { .. })));
        }
        let second = Body::Elastic { young: 2.0, poisson: 0.0 };
        let mut scene =
            Scene::of_pair(Surface::Flat { size: 1.0.into() }, Pair { first: Body::Rigid, second }).unwrap();
        assert!(scene.validate().is_ok());
        scene.modulus = 2.1;
        let text = scene.validate().unwrap_err().to_string();
        assert_eq!(text, "modulus = 2.1: expected 2, E* of the pair");
    }
}
