//! The physics of a scene: the surface, the material, the effects and the requested outputs.

use crate::cells::Size;
use crate::effects::{Boundary, Coupling, Effects, Friction, Hardness, Layer};
use crate::error::{Error, Result, positive};
use crate::height_map::HeightMap;
use crate::line::Line;
use crate::pair::Pair;
use crate::quantities::Outputs;
use std::sync::Arc;

/// Largest relative difference of the modulus from E* of the pair: it may have been rounded on its way
/// through a file.
const SAME_MODULUS: f64 = 1e-9;

/// Everything physical about one contact problem. Numerics are a model's own options; chance is the seed.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// The surface in contact.
    pub surface: Surface,
    /// Contact modulus E* of the pair, `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2`.
    pub contact_modulus: f64,
    /// Both bodies, where E* alone is not sufficient (friction); their E* is `contact_modulus`.
    pub pair: Option<Pair>,
    /// Effects beyond linear elastic normal contact with free boundaries; all off by default.
    pub effects: Effects,
    /// What is computed besides force and approach; [`Scene::new`] asks for the stiffness alone.
    pub outputs: Outputs,
}

impl Scene {
    /// A scene with no effects that asks for the stiffness.
    pub fn new(surface: Surface, contact_modulus: f64) -> Self {
        let outputs = Outputs { stiffness: true, ..Outputs::default() };
        Self { surface, contact_modulus, pair: None, effects: Effects::default(), outputs }
    }

    /// A scene with both bodies named: its modulus is their E*.
    ///
    /// # Errors
    /// As [`Pair::contact_modulus`].
    ///
    /// ```
    /// use contact_model::{Body, Pair, Scene, Surface};
    /// let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.5 } };
    /// assert_eq!(Scene::of_pair(Surface::Sphere { radius: 1.0, size: 1.0.into() }, pair)?.contact_modulus, 4.0);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn of_pair(surface: Surface, pair: Pair) -> Result<Self> {
        Ok(Self { pair: Some(pair), ..Self::new(surface, pair.contact_modulus()?) })
    }

    /// How normal and tangential tractions act on each other; `None` where they do not (the second Dundurs
    /// constant of the bodies is 0) and without friction. For models that can neglect it and that can solve
    /// both together.
    ///
    /// # Errors
    /// As [`Friction::coupling_of`]; [`Error::Unsupported`] in the name of the model where there is friction
    /// and the bodies are not named.
    ///
    /// ```
    /// use contact_model::{Body, Coupling, Friction, Pair, Scene, Surface};
    /// let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.0, poisson: 0.25 } };
    /// let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 1.0.into() }, pair)?;
    /// scene.effects.friction = Friction::coulomb(0.3);
    /// assert!(scene.coupling("mine").is_err());
    /// scene.effects.friction = Friction::coulomb(0.3).with_coupling(Some(Coupling::Full));
    /// assert_eq!(scene.coupling("mine")?, Some(Coupling::Full));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn coupling(&self, model: &'static str) -> Result<Option<Coupling>> {
        match (self.effects.friction, &self.pair) {
            (Friction::Off, _) => Ok(None),
            (friction, Some(pair)) => friction.coupling_of(pair),
            (_, None) => {
                let what = "a scene without both bodies: friction needs their shear moduli";
                Err(Error::unsupported(model, what))
            }
        }
    }

    /// Whether the body that presses on this layer of the scene is rigid: E* is then that of the layer alone.
    pub fn is_pressed_by_a_rigid_body(&self, layer: &Layer) -> bool {
        (self.contact_modulus / layer.modulus() - 1.0).abs() <= SAME_MODULUS
    }

    /// Checks the numbers that every model relies on: modulus, bodies, effects, outputs and the surface's own
    /// parameters.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense, or a modulus that is not E* of the pair.
    pub fn validate(&self) -> Result<()> {
        positive("contact_modulus", self.contact_modulus)?;
        if let Some(pair) = &self.pair {
            let expected = pair.contact_modulus()?;
            if (self.contact_modulus / expected - 1.0).abs() > SAME_MODULUS {
                return Err(Error::domain(
                    "contact_modulus",
                    self.contact_modulus,
                    format!("{expected}, E* of the pair"),
                ));
            }
        }
        self.effects.validate()?;
        if let Some(layer) = self.effects.layer
            && self.contact_modulus > layer.modulus() * (1.0 + SAME_MODULUS)
        {
            let expected = format!("at most {}, that of the layer under a rigid body", layer.modulus());
            return Err(Error::domain("contact_modulus", self.contact_modulus, expected));
        }
        self.outputs.conductance.resistivity()?;
        if self.outputs.mean_gap && self.effects.boundary != Boundary::Periodic {
            let what = "a mean gap: its states have an approach";
            return Err(Error::unsupported("of free boundaries", what));
        }
        if self.outputs.plastic_depth && self.effects.hardness == Hardness::Off {
            let what = "a field of the plastic indentation (it needs a hardness)";
            return Err(Error::unsupported("of elastic contact", what));
        }
        if self.effects.friction == Friction::Off
            && let Some(output) = Outputs::OF_FRICTION.iter().find(|output| self.outputs.asks(**output))
        {
            let what = format!("the output `{}` (it needs friction)", output.name());
            return Err(Error::unsupported("of frictionless contact", what));
        }
        self.surface.validate()
    }
}

/// The surface in contact. Axisymmetric bodies are at the centre of the rectangle, apex up.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// A random self-affine surface, drawn from the seed.
    SelfAffine(SelfAffine),
    /// A given map.
    Heights(Arc<HeightMap>),
    /// A given profile: a map of one row that stands for a body uniform along y (plane strain). A force is
    /// the force on the width of that row along y.
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
    /// The rms height of the sampled surface, exactly, at any resolution (the paper's choice, since F_bar
    /// contains it).
    RmsHeight(f64),
    /// The constant `C_2D(q_0)` at `q_0 = 2 pi / L`, `L = sqrt(Lx Ly)` (length^4): finer grids add waves and
    /// do not change the long ones. In one dimension `C_1D = pi q C_2D` (Eq. 17).
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Adhesion, AdhesionLaw, Effect, Friction, FrictionLaw};
    use crate::pair::Body;
    use crate::rheology::Rheology;

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
        scene.contact_modulus = f64::NAN;
        assert!(scene.validate().is_err());
    }

    #[test]
    fn an_example_is_its_effect_alone() {
        for &effect in Effect::ALL {
            let example = effect.example();
            assert!(example.validate().is_ok(), "{effect:?}: {example:?}");
            let named: Vec<Effect> = example.named().collect();
            assert_eq!(named[0], effect);
            // Beside a law of friction there is friction.
            assert!(named.iter().all(|other| other.key() == effect.key()), "{effect:?}: {example:?}");
        }
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
            Effects { friction: Friction::coulomb(f64::INFINITY), ..Effects::default() },
            Effects { friction: Friction::tresca(-1.0), ..Effects::default() },
            Effects { friction: Friction::tresca(f64::NAN), ..Effects::default() },
            Effects {
                friction: Friction::of(FrictionLaw { limit: Some(0.0), ..FrictionLaw::coulomb(0.3) }),
                ..Effects::default()
            },
            Effects {
                friction: Friction::of(FrictionLaw {
                    limit: Some(f64::INFINITY),
                    ..FrictionLaw::tresca(1.0)
                }),
                ..Effects::default()
            },
            Effects { rheology: Rheology::KelvinVoigt { viscosity: 0.0 }, ..Effects::default() },
        ] {
            scene.effects = effects;
            assert!(matches!(scene.validate(), Err(Error::Domain { .. })));
        }
        let second = Body::Elastic { young: 2.0, poisson: 0.0 };
        let mut scene =
            Scene::of_pair(Surface::Flat { size: 1.0.into() }, Pair { first: Body::Rigid, second }).unwrap();
        assert!(scene.validate().is_ok());
        scene.contact_modulus = 2.1;
        let text = scene.validate().unwrap_err().to_string();
        assert_eq!(text, "contact_modulus = 2.1: expected 2, E* of the pair");
    }

    #[test]
    fn outputs_of_friction_need_it() {
        for &output in Outputs::OF_FRICTION {
            let mut scene = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
            scene.outputs.ask(output, true);
            let text = scene.validate().unwrap_err().to_string();
            assert!(text.contains("frictionless") && text.contains(output.name()), "{text}");
            scene.effects.friction = Friction::coulomb(0.0);
            assert!(scene.validate().is_ok());
        }
    }

    #[test]
    fn bodies_that_couple_are_asked_how() {
        let elastic = |poisson| Body::Elastic { young: 1.0, poisson };
        let scene = |first, second, friction| {
            let flat = Surface::Flat { size: 1.0.into() };
            let mut scene = Scene::of_pair(flat, Pair { first, second }).unwrap();
            scene.effects.friction = friction;
            scene
        };
        let [off, silent, neglected, full] = [
            Friction::Off,
            Friction::coulomb(0.3),
            Friction::coulomb(0.3).with_coupling(Some(Coupling::Neglected)),
            Friction::coulomb(0.3).with_coupling(Some(Coupling::Full)),
        ];
        // Bodies that are alike, and a rigid one on an incompressible one, do not couple.
        for (first, second) in [(elastic(0.3), elastic(0.3)), (Body::Rigid, elastic(0.5))] {
            for friction in [off, silent, neglected, full] {
                assert_eq!(scene(first, second, friction).coupling("a model"), Ok(None));
            }
        }
        let rigid = |friction| scene(Body::Rigid, elastic(0.0), friction).coupling("a model");
        assert_eq!(rigid(off), Ok(None));
        assert_eq!(rigid(neglected), Ok(Some(Coupling::Neglected)));
        assert_eq!(rigid(full), Ok(Some(Coupling::Full)));
        let text = rigid(silent).unwrap_err().to_string();
        assert!(text.starts_with("second Dundurs constant of the bodies = -0.5: expected 0"), "{text}");
        let mut nameless = scene(Body::Rigid, elastic(0.0), full);
        nameless.pair = None;
        assert!(matches!(nameless.coupling("a model"), Err(Error::Unsupported { .. })));
    }
}
