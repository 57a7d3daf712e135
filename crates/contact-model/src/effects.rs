//! Effects beyond linear elastic normal contact: what each is, and which are on.

use crate::error::{Error, Result, non_negative, positive};
use crate::pair::Pair;
use crate::rheology::{PronySeries, Relaxing, Rheology};

/// Bodies whose second Dundurs constant is smaller than this are taken as alike: their moduli were rounded.
const SAME_BODIES: f64 = 1e-12;

/// Effects beyond linear elastic normal contact with free boundaries. Each is off unless a scene names it; a
/// model that cannot treat an effect refuses the scene.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effects {
    /// Boundary condition outside of the rectangle.
    pub boundary: Boundary,
    /// Largest pressure that the bodies carry. A single load is solved from the virgin surface; along a path
    /// the indentation stays from step to step ([`crate::PreparedContact::advance_until`]).
    pub hardness: Hardness,
    /// Attraction between the surfaces.
    pub adhesion: Adhesion,
    /// Friction under tangential load.
    pub friction: Friction,
    /// Time dependence of the material.
    pub rheology: Rheology,
    /// A layer on the surface of one body.
    pub layer: Option<Layer>,
}

impl Effects {
    /// Checks the parameters of the effects that are on.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] with the first value that makes no sense.
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
        if let Friction::Slip { law, .. } = self.friction {
            law.validate()?;
        }
        if let Some(layer) = self.layer {
            layer.validate()?;
        }
        self.rheology.validate()
    }

    /// The effects that are on. The boundary ([`Effects::boundary`]) does not count as one. A shear strength and a
    /// limit, which Coulomb's law does not have, count beside friction.
    ///
    /// ```
    /// use contact_model::{Adhesion, Effect, Effects};
    /// let effects = Effects { adhesion: Adhesion::ShortRange { work: 0.1 }, ..Effects::default() };
    /// assert_eq!(effects.named().collect::<Vec<_>>(), [Effect::ShortRangeAdhesion]);
    /// ```
    pub fn named(&self) -> impl Iterator<Item = Effect> + use<> {
        // All fields, so that a new effect is not forgotten.
        let Self { boundary: _, hardness, adhesion, friction, rheology, layer } = self;
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
        // Before friction itself, so that a model without any friction names the law that the scene has.
        let law = friction.law();
        let strength = law.filter(|law| law.shear_strength > 0.0).map(|_| Effect::ShearStrength);
        let limit = law.filter(|law| law.limit.is_some()).map(|_| Effect::TractionLimit);
        let friction = match friction {
            Friction::Off => None,
            Friction::Slip { coupling: Some(Coupling::Full), .. } => Some(Effect::FullCoupling),
            // A shear strength without a coefficient is named alone.
            Friction::Slip { law, .. } if law.coefficient <= 0.0 && strength.is_some() => None,
            Friction::Slip { .. } => Some(Effect::Friction),
        };
        let rheology = match rheology {
            Rheology::Elastic => None,
            Rheology::KelvinVoigt { .. } => Some(Effect::KelvinVoigt),
            Rheology::Maxwell { .. } => Some(Effect::Maxwell),
            Rheology::StandardSolid { .. } => Some(Effect::StandardSolid),
            Rheology::Prony(_) => Some(Effect::PronySeries),
        };
        let layer = layer.map(|_| Effect::Layer);
        [hardness, adhesion, strength, limit, friction, rheology, layer].into_iter().flatten()
    }
}

macro_rules! effects {
    ($($(#[doc = $doc:literal])+ $variant:ident $key:literal $words:literal { $field:ident: $example:expr },)+) => {
        /// A kind of effect, without its numbers: models list the kinds that they can treat.
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

            /// This effect alone, with numbers that suit a side and an E* of about 1 and heights of about
            /// 0.01: for trials of models. Its kind is the first one that [`Effects::named`] gives.
            pub fn example(self) -> Effects {
                match self {
                    $(Self::$variant => Effects { $field: $example, ..Effects::default() },)+
                }
            }

            /// The effect in words, for refusals and tables.
            pub fn words(self) -> &'static str {
                match self {
                    $(Self::$variant => $words,)+
                }
            }
        }
    };
}

impl Effect {
    /// The examples of this effect and of another one together; `None` where both are settings of one key that
    /// exclude each other.
    ///
    /// ```
    /// use contact_model::Effect;
    /// assert!(Effect::Hardness.with(Effect::Friction).is_some());
    /// assert!(Effect::Maxwell.with(Effect::KelvinVoigt).is_none());
    /// ```
    pub fn with(self, other: Self) -> Option<Effects> {
        let (mut both, next) = (self.example(), other.example());
        // All fields, so that a new effect is not forgotten.
        let Effects { boundary: _, hardness, adhesion, friction, rheology, layer } = next;
        match (other.key(), self.key() == other.key()) {
            ("hardness", false) => both.hardness = hardness,
            ("adhesion", false) => both.adhesion = adhesion,
            ("friction", false) => both.friction = friction,
            ("rheology", false) => both.rheology = rheology,
            ("layer", false) => both.layer = layer,
            ("friction", true) => both.friction = both.friction.joined(friction),
            _ => return None,
        }
        let both_on = |effect| both.named().any(|named| named == effect);
        (both_on(self) && both_on(other)).then_some(both)
    }
}

// Each with its key in `[effects]`, its words, and an example.
effects! {
    /// [`Hardness::Limit`].
    Hardness "hardness" "a hardness"
        { hardness: Hardness::Limit { pressure: 0.05 } },
    /// [`Adhesion::ShortRange`].
    ShortRangeAdhesion "adhesion" "adhesion of short range"
        { adhesion: Adhesion::ShortRange { work: 1e-4 } },
    /// [`Adhesion::FiniteRange`] with [`AdhesionLaw::Exponential`].
    ExponentialAdhesion "adhesion" "adhesion by the exponential law"
        { adhesion: Adhesion::FiniteRange { work: 1e-4, range: 0.02, law: AdhesionLaw::Exponential } },
    /// [`Adhesion::FiniteRange`] with [`AdhesionLaw::Dugdale`].
    DugdaleAdhesion "adhesion" "adhesion by Dugdale's law"
        { adhesion: Adhesion::FiniteRange { work: 1e-4, range: 0.02, law: AdhesionLaw::Dugdale } },
    /// [`Friction::Slip`] with a coefficient, normal and tangential problems independent of each other.
    Friction "friction" "friction"
        { friction: Friction::coulomb(0.3) },
    /// [`FrictionLaw::shear_strength`].
    ShearStrength "friction" "friction with a shear strength"
        { friction: Friction::tresca(0.02) },
    /// [`FrictionLaw::limit`].
    TractionLimit "friction" "friction with a limit of the traction"
        { friction: Friction::of(FrictionLaw { limit: Some(0.02), ..FrictionLaw::coulomb(0.3) }) },
    /// [`Friction::Slip`] with [`Coupling::Full`].
    FullCoupling "friction" "friction with full coupling of normal and tangential tractions"
        { friction: Friction::coulomb(0.3).with_coupling(Some(Coupling::Full)) },
    /// [`Rheology::KelvinVoigt`].
    KelvinVoigt "rheology" "the rheology of Kelvin and Voigt"
        { rheology: Rheology::KelvinVoigt { viscosity: 1.0 } },
    /// [`Rheology::Maxwell`].
    Maxwell "rheology" "the rheology of Maxwell"
        { rheology: Rheology::Maxwell { viscosity: 1.0 } },
    /// [`Rheology::StandardSolid`].
    StandardSolid "rheology" "the rheology of a standard solid"
        { rheology: Rheology::StandardSolid { arm: Relaxing { weight: 1.0, time: 1.0 } } },
    /// [`Rheology::Prony`].
    PronySeries "rheology" "the rheology of a Prony series"
        { rheology: Rheology::Prony(PronySeries::new(&[Relaxing { weight: 1.0, time: 1.0 }]).unwrap_or_default()) },
    /// [`Layer`].
    Layer "layer" "a layer on a base"
        { layer: Some(Layer { thickness: 0.1, young: 2.0, poisson: 0.0, base: LayerBase::Rigid }) },
}

/// An elastic layer that one of the bodies bears, such as a coating, or that lies on a rigid base.
///
/// [`crate::Scene::contact_modulus`] is then E* of the layer's material and of the body that presses on it, both as
/// half-spaces: `1/E* = (1 - nu^2)/E` of the layer, and the same of the other body where it is not rigid.
///
/// ```
/// use contact_model::{Layer, LayerBase};
/// let base = LayerBase::HalfSpace { young: 210e9, poisson: 0.3 };
/// let coating = Layer { thickness: 2e-6, young: 400e9, poisson: 0.2, base };
/// assert!((coating.modulus() - 400e9 / 0.96).abs() < 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// Its thickness > 0 (a length).
    pub thickness: f64,
    /// Its Young's modulus > 0 (force per length squared).
    pub young: f64,
    /// Its Poisson's ratio, in [0, 1/2].
    pub poisson: f64,
    /// The base below it.
    pub base: LayerBase,
}

/// The base below a layer.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum LayerBase {
    /// An elastic half-space that the layer is bonded to.
    HalfSpace {
        /// Its Young's modulus > 0.
        young: f64,
        /// Its Poisson's ratio, in [0, 1/2].
        poisson: f64,
    },
    /// A rigid base that the layer is bonded to.
    Rigid,
    /// A rigid base on which the layer slips without friction.
    Slipping,
}

impl Layer {
    /// `E/(1 - nu^2)` of its material.
    pub fn modulus(&self) -> f64 {
        self.young / (1.0 - self.poisson * self.poisson)
    }

    /// How much thinner a whole layer becomes per mean pressure on it, `h (1 + nu)(1 - 2 nu)/(E (1 - nu))`: under
    /// the periodic copies of a map it cannot spread sideways, bonded to a rigid base or slipping on it. `None` on a
    /// half-space, whose surface falls without limit.
    ///
    /// ```
    /// use contact_model::{Layer, LayerBase};
    /// let layer = Layer { thickness: 2.0, young: 1.0, poisson: 0.0, base: LayerBase::Slipping };
    /// assert_eq!(layer.whole_compression(), Some(2.0));
    /// assert_eq!(Layer { poisson: 0.5, ..layer }.whole_compression(), Some(0.0));
    /// ```
    pub fn whole_compression(&self) -> Option<f64> {
        let &Self { thickness, young, poisson, base } = self;
        let oedometric = young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        (!matches!(base, LayerBase::HalfSpace { .. })).then(|| thickness / oedometric)
    }

    /// The shear modulus of its material over that of the base: 0 on a rigid base.
    pub fn shear_ratio(&self) -> f64 {
        match self.base {
            LayerBase::HalfSpace { young, poisson } => {
                (self.young / young) * ((1.0 + poisson) / (1.0 + self.poisson))
            }
            LayerBase::Rigid | LayerBase::Slipping => 0.0,
        }
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first that makes no sense.
    pub fn validate(&self) -> Result<()> {
        let material = |name: [&'static str; 2], young, poisson| {
            positive(name[0], young)?;
            if (0.0..=0.5).contains(&poisson) {
                return Ok(());
            }
            Err(Error::domain(name[1], poisson, "a number in [0, 1/2]"))
        };
        positive("thickness of the layer", self.thickness)?;
        material(["Young's modulus of the layer", "Poisson's ratio of the layer"], self.young, self.poisson)?;
        if let LayerBase::HalfSpace { young, poisson } = self.base {
            material(["Young's modulus of the base", "Poisson's ratio of the base"], young, poisson)?;
        }
        let ratio = self.shear_ratio();
        if matches!(self.base, LayerBase::HalfSpace { .. }) && !SHEAR_RATIOS.contains(&ratio) {
            let expected = "a number in [1e-6, 1e6]: take a rigid base, or a body without a layer";
            return Err(Error::domain("shear modulus of the layer over that of the base", ratio, expected));
        }
        Ok(())
    }
}

/// Ratios of the shear moduli of a layer and its base in which both are seen.
const SHEAR_RATIOS: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

/// Boundary condition outside of the rectangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum Boundary {
    /// An unloaded half-space: the edges are the physical edges of the indenter (the paper's case).
    #[default]
    Free,
    /// Periodic copies of the rectangle.
    Periodic,
    /// Copies along x alone, and an unloaded half-space beyond the edges along y: a contact that goes on along a line.
    PeriodicAlongX,
    /// Copies along y alone, and an unloaded half-space beyond the edges along x.
    PeriodicAlongY,
}

impl Boundary {
    /// All of them.
    pub const ALL: &'static [Self] =
        &[Self::Free, Self::Periodic, Self::PeriodicAlongX, Self::PeriodicAlongY];

    /// Whether the map repeats itself along x, and along y.
    pub fn repeats(self) -> [bool; 2] {
        match self {
            Self::Free => [false, false],
            Self::Periodic => [true, true],
            Self::PeriodicAlongX => [true, false],
            Self::PeriodicAlongY => [false, true],
        }
    }

    /// Its name in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Free => "free boundaries",
            Self::Periodic => "periodic boundaries",
            Self::PeriodicAlongX => "boundaries that are periodic along x alone",
            Self::PeriodicAlongY => "boundaries that are periodic along y alone",
        }
    }
}

/// Largest pressure that the bodies carry: where it is reached, the softer one is indented without a further
/// rise of the pressure (perfect plasticity, `0 <= p <= p_s`).
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
    /// Short-range adhesion (JKR) with this work of adhesion (energy per area): the limit of a vanishing
    /// range, in which nothing attracts across a gap and the tension at the edge of a contact has no bound.
    ShortRange {
        /// Work of adhesion Delta gamma.
        work: f64,
    },
    /// Attraction across an open gap g.
    FiniteRange {
        /// Work of adhesion Delta gamma: the integral of the traction over all gaps.
        work: f64,
        /// Range g0: the traction is about `work/range` below it.
        range: f64,
        /// How the traction falls with the gap.
        law: AdhesionLaw,
    },
}

/// Law by which the attractive traction of [`Adhesion::FiniteRange`] falls with the gap g.
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
    /// Stick and slip: the tangential traction of a cell in contact is at most what its law allows at its
    /// pressure, and where the cell slips it is that, in the direction of the slip.
    Slip {
        /// Largest traction of a cell.
        law: FrictionLaw,
        /// How normal and tangential tractions act on each other; `None` leaves it open. It matters for
        /// bodies whose second Dundurs constant ([`crate::Pair::coupling`]) is not 0: a model that can do
        /// either then refuses `None` ([`crate::Scene::coupling`]), and one that always neglects the coupling
        /// accepts it.
        coupling: Option<Coupling>,
    },
}

/// The largest tangential traction of a cell in contact with the pressure p:
/// `min(limit, shear_strength + coefficient p)`.
///
/// A coefficient alone is Coulomb's law, a shear strength alone is Tresca's. With both, the junctions have a
/// strength of their own which a pressure raises; the limit is the shear strength of the softer body, below
/// whose surface the slip takes place once it is reached.
///
/// ```
/// use contact_model::FrictionLaw;
/// let law = FrictionLaw { coefficient: 0.5, shear_strength: 1.0, limit: Some(2.0) };
/// assert_eq!([0.0, 1.0, 10.0].map(|pressure| law.largest_traction(pressure)), [1.0, 1.5, 2.0]);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::exhaustive_structs)] // A scene writes all of it.
pub struct FrictionLaw {
    /// Coefficient of friction mu.
    pub coefficient: f64,
    /// Traction that slip needs without any pressure, in the unit of pressures.
    pub shear_strength: f64,
    /// Largest traction at any pressure, in the unit of pressures; `None` without.
    pub limit: Option<f64>,
}

impl FrictionLaw {
    /// Coulomb's law: in proportion to the pressure.
    pub fn coulomb(coefficient: f64) -> Self {
        Self { coefficient, shear_strength: 0.0, limit: None }
    }

    /// Tresca's law: the same at any pressure.
    pub fn tresca(shear_strength: f64) -> Self {
        Self { coefficient: 0.0, shear_strength, limit: None }
    }

    /// The largest traction of a cell in contact with this pressure.
    pub fn largest_traction(&self, pressure: f64) -> f64 {
        let traction = self.shear_strength + self.coefficient * pressure;
        self.limit.map_or(traction, |limit| traction.min(limit))
    }

    /// Checks the numbers.
    ///
    /// # Errors
    /// [`Error::Domain`] for a coefficient or a shear strength that is negative or not finite, and for a limit
    /// that is not positive and finite.
    pub fn validate(&self) -> Result<()> {
        non_negative("coefficient of friction", self.coefficient)?;
        non_negative("shear strength of friction", self.shear_strength)?;
        self.limit.map_or(Ok(()), |limit| positive("limit of friction", limit).map(|_| ()))
    }
}

impl Friction {
    /// Coulomb's law with this coefficient; the coupling is left open.
    pub fn coulomb(coefficient: f64) -> Self {
        Self::of(FrictionLaw::coulomb(coefficient))
    }

    /// Tresca's law with this shear strength; the coupling is left open.
    pub fn tresca(shear_strength: f64) -> Self {
        Self::of(FrictionLaw::tresca(shear_strength))
    }

    /// A law; the coupling is left open.
    pub fn of(law: FrictionLaw) -> Self {
        Self::Slip { law, coupling: None }
    }

    /// The same law with another coupling.
    #[must_use]
    pub fn with_coupling(self, coupling: Option<Coupling>) -> Self {
        match self {
            Self::Off => Self::Off,
            Self::Slip { law, .. } => Self::Slip { law, coupling },
        }
    }

    /// What either of two has: the larger coefficient and shear strength, the smaller limit, the full coupling.
    fn joined(self, other: Self) -> Self {
        let (Self::Slip { law, coupling }, Self::Slip { law: next, coupling: also }) = (self, other) else {
            return if self == Self::Off { other } else { self };
        };
        let law = FrictionLaw {
            coefficient: law.coefficient.max(next.coefficient),
            shear_strength: law.shear_strength.max(next.shear_strength),
            limit: law.limit.into_iter().chain(next.limit).reduce(f64::min),
        };
        Self::Slip { law, coupling: coupling.or(also) }
    }

    /// Its law; `None` without friction.
    pub fn law(self) -> Option<FrictionLaw> {
        match self {
            Self::Off => None,
            Self::Slip { law, .. } => Some(law),
        }
    }

    /// How normal and tangential tractions of these bodies act on each other; `None` where they do not (the
    /// second Dundurs constant is 0) and without friction.
    ///
    /// # Errors
    /// [`Error::Domain`] with that constant where it is not 0 and the friction leaves the coupling open; as
    /// [`Pair::coupling`].
    pub fn coupling_of(self, pair: &Pair) -> Result<Option<Coupling>> {
        let Self::Slip { coupling, .. } = self else { return Ok(None) };
        let beta = pair.coupling()?;
        match coupling {
            _ if beta.abs() <= SAME_BODIES => Ok(None),
            None => Err(Error::domain(
                "second Dundurs constant of the bodies",
                beta,
                "0, or friction that says its coupling, none or full",
            )),
            stated => Ok(stated),
        }
    }
}

/// How normal and tangential tractions act on each other, for bodies whose second Dundurs constant beta
/// ([`crate::Pair::coupling`]) is not 0. The terms are of the order of beta
/// times the ratio of tractions to pressures, which is mu for Coulomb's law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Coupling {
    /// The coupling is neglected: the normal displacements due to tangential tractions and the tangential
    /// displacements due to pressures are left out.
    Neglected,
    /// Both problems are solved together.
    Full,
}
