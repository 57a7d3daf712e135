"""The effects. Written by python/generate.py from the keys of `[effects]`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from . import _core
from ._plain import frozen, named
from .typing import Adhesion, Boundary, EffectsDict, Friction, Hardness, Layer, Rheology


@dataclass(frozen=True)
class Effects:
    """Effects beyond linear elastic normal contact with free boundaries.

    Each is off unless it is named; a model that cannot treat an effect refuses the scene. The value of an effect is the
    same as in a scene: a mapping with these keys, of plain numbers in consistent units.

    Parameters
    ----------
    boundary : optional
        "free", "periodic", { x: "periodic", y: "free" } or { x: "free", y: "periodic" }
        What lies outside of the rectangle. Not named: an unloaded half-space outside the rectangle.
    hardness : optional
        { pressure }, or the pressure alone
        Largest pressure that the bodies carry (perfect plasticity): the indentation stays along a path. Not named:
        elastic at any pressure.
    adhesion : optional
        { work }, or the work alone; { work, range, law } with the law "exponential" or "dugdale"
        Attraction with this work of adhesion (energy per area): of short range (JKR), or across open gaps with a
        range (a length), by the exponential law if none is named. Not named: no attraction.
    friction : optional
        { coefficient, shear_strength, limit, coupling } with the coupling "none" or "full", or the coefficient
        alone
        Friction under a tangential load: the traction is at most the shear strength (a pressure) plus the
        coefficient times the pressure, and at most the limit (a pressure). The coefficient alone is Coulomb's law,
        the shear strength alone is Tresca's. Where the bodies differ, normal and tangential tractions act on each
        other: the coupling is neglected, or both are solved together. Not named: no tangential load.
    rheology : optional
        { kind: "kelvin_voigt" or "maxwell", viscosity }, { kind: "standard_solid", weight, time }, { kind: "prony",
        weights, times }
        Time dependence of the material. Not named: elastic.
    layer : optional
        { thickness, young, poisson, base } with the base { young, poisson }, "rigid" or "slipping"
        An elastic layer, such as a coating, that is bonded to an elastic base or to a rigid one, or slips on a
        rigid one. The body that presses on it is rigid, or the one of `bodies`. Not named: the bodies are
        homogeneous.

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.Effects(adhesion={"work": 0.05, "range": 1e-9, "law": "dugdale"}).adhesion["law"]
    'dugdale'
    >>> fc.Effects.of({"hardnes": 1.0})
    Traceback (most recent call last):
    TypeError: no effect is called 'hardnes': did you mean hardness?
    >>> fc.Effects(hardness=-1.0)  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    DomainError: effects.hardness = -1: expected a number > 0
    """

    boundary: Boundary | None = None
    hardness: Hardness | None = None
    adhesion: Adhesion | None = None
    friction: Friction | None = None
    rheology: Rheology | None = None
    layer: Layer | None = None

    def __post_init__(self) -> None:
        # Copies that do not change: a change of the caller's mapping is none of the effect.
        for name, value in self._values().items():
            object.__setattr__(self, name, frozen(value))
        # Mistakes are told where they are made.
        _core.check_effects(self._values())

    @classmethod
    def of(cls, effects: Effects | EffectsDict | Mapping[str, Any]) -> Effects:
        """Effects from a mapping of these names.

        Parameters
        ----------
        effects : Effects or mapping
            Effects, which are returned as they are, or a mapping with the parameters above as keys.

        Returns
        -------
        Effects
        """
        known = [one.name for one in fields(cls)]
        return effects if isinstance(effects, Effects) else cls(**named(effects, "effect", known))

    def _values(self) -> dict[str, Any]:
        """The effects as the compiled part takes them."""
        return {one.name: getattr(self, one.name) for one in fields(self)}
