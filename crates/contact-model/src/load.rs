//! The load of one solve, normal and tangential.

use crate::error::{Error, Result, non_negative};
use std::fmt;

/// The load that is prescribed in one solve or at the end of a step.
///
/// ```
/// use contact_model::{Load, NormalLoad, Tangential};
/// let load = Load::force(2.0).with_tangential(Tangential::force_along_x(0.5));
/// assert_eq!(load.normal, NormalLoad::Force(2.0));
/// assert!(Load::force(2.0).tangential.is_zero());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Load {
    /// The normal part.
    pub normal: NormalLoad,
    /// The tangential part; a tangential force of 0 without friction.
    pub tangential: Tangential,
}

impl Load {
    /// A normal force alone.
    pub fn force(force: f64) -> Self {
        NormalLoad::Force(force).into()
    }

    /// An approach alone.
    pub fn approach(approach: f64) -> Self {
        NormalLoad::Approach(approach).into()
    }

    /// A mean gap alone, for periodic boundaries.
    pub fn mean_gap(gap: f64) -> Self {
        NormalLoad::MeanGap(gap).into()
    }

    /// The same normal load with this tangential one.
    #[must_use]
    pub fn with_tangential(self, tangential: Tangential) -> Self {
        Self { tangential, ..self }
    }

    /// The load itself where its normal part is finite and not negative, and its tangential part finite.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value otherwise.
    pub fn validated(self) -> Result<Self> {
        self.normal.validated()?;
        self.tangential.validated()?;
        Ok(self)
    }

    /// As [`Load::validated`], for models with adhesion, which can pull.
    ///
    /// # Errors
    /// As [`Load::validated`], with [`NormalLoad::validated_with_adhesion`].
    pub fn validated_with_adhesion(self) -> Result<Self> {
        self.normal.validated_with_adhesion()?;
        self.tangential.validated()?;
        Ok(self)
    }

    /// The normal part, for a model or a scene without friction.
    ///
    /// # Errors
    /// [`Error::Unsupported`] naming the model, unless the tangential part is 0.
    pub fn without_tangential(self, model: &'static str) -> Result<NormalLoad> {
        self.tangential.validated()?;
        if self.tangential.is_zero() {
            Ok(self.normal)
        } else {
            Err(Error::unsupported(model, "a tangential load"))
        }
    }
}

impl From<NormalLoad> for Load {
    fn from(normal: NormalLoad) -> Self {
        Self { normal, tangential: Tangential::default() }
    }
}

/// The normal part of a load: the normal force, the approach or the mean gap, never two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum NormalLoad {
    /// Normal force F >= 0; with adhesion it may be negative (a pull).
    Force(f64),
    /// Approach d >= 0, from first touch of the highest point; with adhesion it may be negative (the bodies
    /// are drawn apart and a neck joins them).
    Approach(f64),
    /// Mean gap >= 0 over the rectangle, for periodic boundaries, where no approach is defined.
    MeanGap(f64),
}

impl NormalLoad {
    /// The load itself where it is finite and not negative.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value otherwise.
    pub fn validated(self) -> Result<Self> {
        match self {
            Self::Force(f) => non_negative("force", f)?,
            Self::Approach(d) => non_negative("approach", d)?,
            Self::MeanGap(g) => non_negative("mean_gap", g)?,
        };
        Ok(self)
    }

    /// The load itself where it is finite, of either sign: for models with adhesion, which can pull.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value otherwise, or for a negative mean gap.
    ///
    /// ```
    /// use contact_model::NormalLoad;
    /// assert!(NormalLoad::Force(-1.0).validated_with_adhesion().is_ok());
    /// assert!(NormalLoad::Force(f64::NAN).validated_with_adhesion().is_err());
    /// ```
    pub fn validated_with_adhesion(self) -> Result<Self> {
        let (name, value) = match self {
            Self::Force(f) => ("force", f),
            Self::Approach(d) => ("approach", d),
            Self::MeanGap(_) => return self.validated(),
        };
        if value.is_finite() { Ok(self) } else { Err(Error::domain(name, value, "a finite number")) }
    }

    /// The error for this load where it is below `smallest`, the smallest load of its kind that an adhesive
    /// contact can bear.
    pub fn pull_off(self, smallest: f64) -> Error {
        let (name, value) = match self {
            Self::Force(force) => ("force (the contact pulls off under a prescribed force)", force),
            Self::Approach(approach) => {
                ("approach (the contact pulls off under a prescribed approach)", approach)
            }
            Self::MeanGap(gap) => ("mean gap (the contact pulls off under a prescribed mean gap)", gap),
        };
        Error::OutOfRange { name: name.into(), value, min: smallest, max: f64::INFINITY }
    }
}

impl fmt::Display for NormalLoad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, value) = match self {
            Self::Force(force) => ("a force", force),
            Self::Approach(approach) => ("an approach", approach),
            Self::MeanGap(gap) => ("a mean gap", gap),
        };
        write!(f, "{what} of {value}")
    }
}

/// The tangential load: its components along x (columns of a map) and along y (rows). Signed: the second body
/// is moved over the first ([`crate::Pair`]). Which one is which matters to full coupling alone
/// ([`crate::Coupling`]).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Tangential {
    /// Tangential force that the second body exerts on the first, at most the sliding force in size (mu F by
    /// Coulomb's law). At it the whole contact slides, and its displacement is the least at which it does; a model may give that to a relative 1e-6.
    Force([f64; 2]),
    /// Tangential displacement of the second body relative to the first, far from the contact.
    Displacement([f64; 2]),
}

impl Tangential {
    /// A force along x alone.
    pub fn force_along_x(force: f64) -> Self {
        Self::Force([force, 0.0])
    }

    /// A displacement along x alone.
    pub fn displacement_along_x(displacement: f64) -> Self {
        Self::Displacement([displacement, 0.0])
    }

    /// Both components, whichever quantity is prescribed.
    pub fn components(self) -> [f64; 2] {
        match self {
            Self::Force(components) | Self::Displacement(components) => components,
        }
    }

    /// Whether nothing is prescribed but zeros.
    pub fn is_zero(self) -> bool {
        self.components().iter().all(|component| component.abs() <= 0.0)
    }

    /// The load itself where both components are finite.
    ///
    /// # Errors
    /// [`Error::Domain`] with the component otherwise.
    pub fn validated(self) -> Result<Self> {
        for (component, along) in self.components().into_iter().zip(["x", "y"]) {
            if !component.is_finite() {
                let name = format!("{} along {along}", self.words());
                return Err(Error::domain(name, component, "a finite number"));
            }
        }
        Ok(self)
    }

    /// Refuses a component along y, for models that work along x alone.
    ///
    /// # Errors
    /// [`Error::Unsupported`] naming the model and the component, unless that is 0.
    ///
    /// ```
    /// use contact_model::Tangential;
    /// assert!(Tangential::Force([3.0, 0.0]).refuse_y("mine").is_ok());
    /// let refused = Tangential::Displacement([3.0, 4.0]).refuse_y("mine").unwrap_err().to_string();
    /// assert_eq!(
    ///     refused,
    ///     "the model mine does not support a tangential displacement along y (4): it takes the component along x alone"
    /// );
    /// ```
    pub fn refuse_y(self, model: &'static str) -> Result<()> {
        let [_, y] = self.components();
        if y.abs() <= 0.0 {
            return Ok(());
        }
        let what = format!("a {} along y ({y}): it takes the component along x alone", self.words());
        Err(Error::unsupported(model, what))
    }

    /// The name of the prescribed quantity.
    fn words(self) -> &'static str {
        match self {
            Self::Force(_) => "tangential force",
            Self::Displacement(_) => "tangential displacement",
        }
    }
}

impl fmt::Display for Tangential {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.components();
        write!(f, "a {} of ({x}, {y})", self.words())
    }
}

impl Default for Tangential {
    /// No tangential force.
    fn default() -> Self {
        Self::Force([0.0; 2])
    }
}

/// Directions of the tangential loads that a model answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Directions {
    /// Along x alone, to and fro.
    AlongX,
    /// Any direction of the plane, which may change along the path.
    Plane,
}
