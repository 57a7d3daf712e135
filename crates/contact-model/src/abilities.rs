//! Abilities of models, as data: refusals, help and tables of models follow from them.

use crate::effects::{Boundary, Effect};
use crate::error::{Error, Result};
use crate::load::{Directions, NormalLoad};
use crate::quantities::Output;
use crate::scene::{Scene, Surface};

/// A kind of surface, without its numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SurfaceKind {
    /// [`Surface::SelfAffine`].
    SelfAffine,
    /// [`Surface::Heights`].
    Heights,
    /// [`Surface::Profile`].
    Profile,
    /// [`Surface::Line`].
    Line,
    /// [`Surface::Sphere`].
    Sphere,
    /// [`Surface::Cone`].
    Cone,
    /// [`Surface::PowerLaw`].
    PowerLaw,
    /// [`Surface::FlatCircle`].
    FlatCircle,
    /// [`Surface::Flat`].
    Flat,
    /// [`Surface::Sine`].
    Sine,
}

impl SurfaceKind {
    /// All of them.
    pub const ALL: &'static [Self] = &[
        Self::SelfAffine,
        Self::Heights,
        Self::Profile,
        Self::Line,
        Self::Sphere,
        Self::Cone,
        Self::PowerLaw,
        Self::FlatCircle,
        Self::Flat,
        Self::Sine,
    ];

    /// The kind of a surface.
    pub fn of(surface: &Surface) -> Self {
        match surface {
            Surface::SelfAffine(_) => Self::SelfAffine,
            Surface::Heights(_) => Self::Heights,
            Surface::Profile(_) => Self::Profile,
            Surface::Line { .. } => Self::Line,
            Surface::Sphere { .. } => Self::Sphere,
            Surface::Cone { .. } => Self::Cone,
            Surface::PowerLaw { .. } => Self::PowerLaw,
            Surface::FlatCircle { .. } => Self::FlatCircle,
            Surface::Flat { .. } => Self::Flat,
            Surface::Sine { .. } => Self::Sine,
        }
    }

    /// Its name in scenes and in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::SelfAffine => "self_affine",
            Self::Heights => "height map",
            Self::Profile => "profile",
            Self::Line => "line",
            Self::Sphere => "sphere",
            Self::Cone => "cone",
            Self::PowerLaw => "power_law",
            Self::FlatCircle => "flat_circle",
            Self::Flat => "flat",
            Self::Sine => "sine",
        }
    }
}

/// A kind of load, without its number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LoadKind {
    /// [`NormalLoad::Force`].
    Force,
    /// [`NormalLoad::Approach`].
    Approach,
    /// [`NormalLoad::MeanGap`].
    MeanGap,
}

impl LoadKind {
    /// All of them.
    pub const ALL: &'static [Self] = &[Self::Force, Self::Approach, Self::MeanGap];

    /// The kind of a load.
    pub fn of(load: NormalLoad) -> Self {
        match load {
            NormalLoad::Force(_) => Self::Force,
            NormalLoad::Approach(_) => Self::Approach,
            NormalLoad::MeanGap(_) => Self::MeanGap,
        }
    }

    /// Its name in scenes and in Python.
    pub fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::Approach => "approach",
            Self::MeanGap => "mean_gap",
        }
    }
}

/// How a model treats a path of loads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Paths {
    /// The path has no influence: each step is solved for its own load.
    Forgotten,
    /// The path is remembered where an effect depends on it; a single load is reached from no contact.
    Remembered,
    /// The model needs a path: its subject is time or the tangential load, and single loads have no answer.
    Needed,
}

/// Effects that a model treats each by itself, but not together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::exhaustive_structs)] // A model writes all of it.
pub struct NotCombined {
    /// None of the first group goes with any of the second one.
    pub effects: [&'static [Effect]; 2],
    /// Why not: a reason of physics, or that it is not solved.
    pub reason: &'static str,
}

impl NotCombined {
    /// Whether it excludes these two together, in either order.
    pub fn excludes(&self, one: Effect, other: Effect) -> bool {
        let [first, second] = self.effects;
        first.contains(&one) && second.contains(&other) || first.contains(&other) && second.contains(&one)
    }
}

/// The abilities of a model. [`Abilities::refuse`] refuses a scene that requests more, before anything is
/// planned.
///
/// These conditions are necessary, not sufficient: a model itself refuses, in `prepare`, what depends on
/// numbers, or on a surface together with something else.
///
/// ```
/// use contact_model::{Abilities, Boundary, Effect, LoadKind, Output, Paths, Scene, Surface, SurfaceKind};
/// let abilities = Abilities {
///     surfaces: &[SurfaceKind::Sphere],
///     outputs: &[Output::Stiffness, Output::Area],
///     ..Abilities::ELASTIC
/// };
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// assert!(abilities.refuse("mine", &scene).is_ok());
/// scene.outputs.pressure = true;
/// let refused = abilities.refuse("mine", &scene).unwrap_err().to_string();
/// assert_eq!(refused, "the model mine does not support the output `pressure`");
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(clippy::exhaustive_structs)] // A model writes all of it, or begins with `ELASTIC`.
pub struct Abilities {
    /// Kinds of surface that the model accepts.
    pub surfaces: &'static [SurfaceKind],
    /// Boundaries that it can treat.
    pub boundaries: &'static [Boundary],
    /// Effects that it can treat.
    pub effects: &'static [Effect],
    /// Pairs of them that it does not combine.
    pub not_combined: &'static [NotCombined],
    /// Whether a scene must have at least one of these effects.
    pub needs_effect: bool,
    /// Loads that may be prescribed.
    pub loads: &'static [LoadKind],
    /// How it treats a path of loads.
    pub paths: Paths,
    /// Directions of tangential loads, where friction is among the effects.
    pub directions: Directions,
    /// Outputs that it can compute.
    pub outputs: &'static [Output],
}

impl Abilities {
    /// Linear elastic normal contact with free boundaries, under a force or an approach, with the stiffness
    /// and what follows from it. The list of surfaces is empty: a model fills it in.
    pub const ELASTIC: Self = Self {
        surfaces: &[],
        boundaries: &[Boundary::Free],
        effects: &[],
        not_combined: &[],
        needs_effect: false,
        loads: &[LoadKind::Force, LoadKind::Approach],
        paths: Paths::Forgotten,
        directions: Directions::AlongX,
        outputs: &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance],
    };

    /// Checks that the model can do what a scene requests, and that the numbers of the scene make sense.
    ///
    /// # Errors
    /// [`Error::Unsupported`] naming the model and what it lacks; those of [`Scene::validate`].
    pub fn refuse(&self, model: &'static str, scene: &Scene) -> Result<()> {
        scene.validate()?;
        match self.lacks(scene).next() {
            Some(what) => Err(Error::unsupported(model, what)),
            None => Ok(()),
        }
    }

    /// Everything that a scene requests and that the model cannot do, in words.
    pub fn lacks(&self, scene: &Scene) -> impl Iterator<Item = String> + use<> {
        let mut lacks = Vec::new();
        let boundary = scene.effects.boundary;
        if !self.boundaries.contains(&boundary) {
            lacks.push(boundary.words().to_owned());
        }
        for effect in scene.effects.named().filter(|effect| !self.effects.contains(effect)) {
            lacks.push(effect.words().to_owned());
        }
        let named: Vec<Effect> =
            scene.effects.named().filter(|effect| self.effects.contains(effect)).collect();
        let pairs = named
            .iter()
            .enumerate()
            .flat_map(|(i, one)| named[i + 1..].iter().map(move |other| (one, other)));
        for (&one, &other) in pairs {
            if let Some(reason) = self.reason_against(one, other) {
                lacks.push(format!("{} together with {}: {reason}", one.words(), other.words()));
            }
        }
        if !self.surfaces.contains(&SurfaceKind::of(&scene.surface)) {
            lacks.push(scene.surface.kind().to_owned());
        }
        for output in scene.outputs.asked().filter(|output| !self.outputs.contains(output)) {
            lacks.push(format!("the output `{}`", output.name()));
        }
        if self.needs_effect && !scene.effects.named().any(|effect| self.effects.contains(&effect)) {
            let mut keys: Vec<&str> = self.effects.iter().map(|effect| effect.key()).collect();
            keys.dedup();
            lacks.push(format!("a contact without {}", keys.join(" or ")));
        }
        lacks.into_iter()
    }

    /// Every two effects of the model that a scene can have together, in the order of [`Effect::ALL`], and why the
    /// model does not combine them; `None` where it does.
    pub fn pairs(&self) -> impl Iterator<Item = (Effect, Effect, Option<&'static str>)> + use<> {
        let (effects, abilities) = (self.effects, *self);
        let known = move || Effect::ALL.iter().copied().filter(|effect| effects.contains(effect));
        let after = move |one: Effect| known().skip_while(move |other| *other != one).skip(1);
        known().flat_map(move |one| after(one).map(move |other| (one, other))).filter_map(
            move |(one, other)| one.with(other).map(|_| (one, other, abilities.reason_against(one, other))),
        )
    }

    /// Why the model does not combine these two of its effects; `None` where it does.
    pub fn reason_against(&self, one: Effect, other: Effect) -> Option<&'static str> {
        self.not_combined.iter().find(|pair| pair.excludes(one, other)).map(|pair| pair.reason)
    }

    /// Checks that the model accepts a load of this kind.
    ///
    /// # Errors
    /// [`Error::Unsupported`] naming the model and the load.
    pub fn refuse_load(&self, model: &'static str, load: NormalLoad) -> Result<()> {
        if self.loads.contains(&LoadKind::of(load)) {
            Ok(())
        } else {
            Err(Error::unsupported_load(model, load))
        }
    }
}
