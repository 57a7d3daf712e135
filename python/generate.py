"""Writes what follows from the tables of the library: `_formulas.py`, `_effects.py`, the properties in `_core.pyi`.

``python generate.py`` with the package installed whose tables they are to have.
"""

import re
import textwrap
from pathlib import Path

import fractal_contact as fc
from fractal_contact import _core

PACKAGE = Path(__file__).resolve().parent / "python/fractal_contact"
BEGIN, END = "    # The numbers and words of the table of quantities", "    # The end of the table."


def formulas():
    """A class for each model without options."""
    models = [model for model in fc.models() if not model["has_options"]]
    exported = "".join(f'    "{name}",\n' for name in sorted(model["class"] for model in models))
    parts = [
        '"""The models without options. Written by python/generate.py from the table of models."""\n\n'
        f"from ._models import Formula\n\n__all__ = [\n{exported}]\n"
    ]
    for model in models:
        about = f"{model['about']}\n\nAccuracy: {model['accuracy']}."
        lines = [
            line
            for paragraph in about.split("\n\n")
            for line in [*textwrap.wrap(paragraph, 106, break_long_words=False), ""]
        ]
        doc = "\n".join(f"    {line}" if line else "" for line in lines[:-1])
        parts.append(
            f'class {model["class"]}(Formula):\n    """{doc.lstrip()}\n    """\n\n    _name = "{model["name"]}"\n'
        )
    return "\n\n".join(parts)


EFFECTS = '''"""The effects. Written by python/generate.py from the keys of `[effects]`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from . import _core

EffectValue = float | str | Mapping[str, Any] | None


@dataclass(frozen=True)
class Effects:
    """Effects beyond linear elastic normal contact with free boundaries.

    Off unless named; a model that lacks one refuses it. Each takes what it takes in a scene: a mapping with these
    keys, of plain numbers in consistent units.

    Parameters
    ----------
{parameters}

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.Effects(adhesion={{"work": 0.05, "range": 1e-9, "law": "dugdale"}}).adhesion["law"]
    'dugdale'
    >>> fc.Effects(hardness=-1.0)  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    DomainError: effects.hardness = -1: expected a number > 0
    """

{fields}

    def __post_init__(self) -> None:
        # Copies: a change of the caller's mapping is none of the effect.
        for name, value in self._values().items():
            if isinstance(value, Mapping):
                object.__setattr__(self, name, dict(value))
        # Mistakes are told where they are made.
        _core.check_effects(self._values())

    def _values(self) -> dict[str, Any]:
        """The effects as the compiled part takes them."""
        return {{one.name: getattr(self, one.name) for one in fields(self)}}
'''


def effects():
    """The class of effects."""
    keys = _core.effect_keys()

    def parameter(key):
        takes = re.sub(r"(\w+) = ", r"\1: ", key["takes"].replace("`", ""))
        about = f"{key['about']} Not named: {key['off']}."
        lines = [*textwrap.wrap(takes, 108), *textwrap.wrap(about, 108)]
        return "\n".join([f"    {key['name']} : optional", *(f"        {line}" for line in lines)])

    return EFFECTS.format(
        parameters="\n".join(map(parameter, keys)),
        fields="\n".join(f"    {key['name']}: EffectValue = None" for key in keys),
    )


def properties():
    """The line of each property of a state, by its name: those of the tables that are nothing else."""
    arrays = [{**one, "type": "NDArray[np.float64] | None"} for one in _core.fields()]
    return {
        one["name"]: f"    @property\n    def {one['name']}(self) -> {one['type']}: ...\n"
        for one in [*fc.quantities(), *arrays]
        if isinstance(vars(_core.ContactState)[one["name"]], property)
    }


def stub(text):
    """A stub with these properties in place of those that it has."""
    return re.sub(
        f"({BEGIN}[^\n]*\n).*?({END})", lambda m: m[1] + "".join(properties().values()) + m[2], text, flags=re.S
    )


if __name__ == "__main__":
    (PACKAGE / "_formulas.py").write_text(formulas())
    (PACKAGE / "_effects.py").write_text(effects())
    path = PACKAGE / "_core.pyi"
    path.write_text(stub(path.read_text()))
