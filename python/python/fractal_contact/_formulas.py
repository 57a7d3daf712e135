"""The models without options. Written by python/generate.py from the table of models."""

from ._models import Formula

__all__ = [
    "AdhesiveWave",
    "CattaneoMindlin",
    "FlatPunch",
    "Hertz",
    "Jkr",
    "MaugisDugdale",
    "PartialSlip",
    "PowerLaw",
    "PowerLawBody",
    "Viscoelastic",
    "Westergaard",
]


class Hertz(Formula):
    """Hertz's contact of a sphere.

    Accuracy: exact, to about 1e-13.
    """

    _name = "hertz"


class PowerLawBody(Formula):
    """Bodies of revolution r^n (Sneddon, Galin).

    Accuracy: exact, to about 1e-13.
    """

    _name = "power_law_body"


class FlatPunch(Formula):
    """Flat circular punch, or flat square.

    Accuracy: exact for the circle; the square's constant to 1e-6.
    """

    _name = "flat_punch"


class Jkr(Formula):
    """Short-range adhesion of a sphere (Johnson, Kendall, Roberts).

    Accuracy: exact, to about 1e-13.
    """

    _name = "jkr"


class MaugisDugdale(Formula):
    """A sphere with Dugdale's law of adhesion, between JKR and DMT, in closed form (Maugis).

    Accuracy: exact, to about 1e-13.
    """

    _name = "maugis_dugdale"


class PowerLaw(Formula):
    """The power law of the paper for self-affine surfaces.

    Accuracy: a fit: within the scatter of surfaces, 8 to 28 % at F_bar = 0.086.
    """

    _name = "power_law"


class Westergaard(Formula):
    """Periodic contact of a wave.

    Accuracy: exact, to about 1e-13.
    """

    _name = "westergaard"


class AdhesiveWave(Formula):
    """Short-range adhesion of a periodic wave in closed form (Johnson).

    Accuracy: exact, to about 1e-13.
    """

    _name = "adhesive_wave"


class CattaneoMindlin(Formula):
    """Partial slip of a sphere in closed form.

    Accuracy: exact within Cattaneo's and Mindlin's assumptions (no coupling, slip along the load).
    """

    _name = "cattaneo_mindlin"


class PartialSlip(Formula):
    """Partial slip of round bodies by reduction to one dimension.

    Accuracy: exact within Cattaneo's and Mindlin's assumptions (no coupling, slip along the load).
    """

    _name = "mdr1d_partial_slip"


class Viscoelastic(Formula):
    """Viscoelastic contact of round bodies by reduction to one dimension.

    Accuracy: exact while the contact grows, which is checked; 1e-12.
    """

    _name = "mdr1d_viscoelastic"
