"""Writes what follows from the library: `_formulas.py`, `_effects.py`, `_columns.py`, properties and docstrings in
`_core.pyi`.

``python generate.py`` with the package installed whose tables they are to have; ``python generate.py notebooks`` runs
the notebooks and keeps what they give (nbclient, ipykernel).
"""

import ast
import inspect
import re
import sys
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


COLUMNS = '''"""The columns of a table of states. Written by python/generate.py from the table of quantities."""

from typing import Any

import numpy as np
from numpy.typing import NDArray


class Columns:
    """A property for each quantity that a table of states may show, in its order."""

    results: dict[str, NDArray[Any]]

    def _column(self, name: str) -> NDArray[np.float64]:
        known = self.results.get(name)
        count = len(self.results["state"])
        return np.full(count, np.nan) if known is None else np.asarray(known, dtype=np.float64)

    def _words(self, name: str) -> NDArray[np.str_]:
        known = self.results.get(name)
        count = len(self.results["state"])
        return np.full(count, "") if known is None else np.asarray(known, dtype=np.str_)
'''


def columns():
    """A property for each quantity that the printed table of a run may have."""
    parts = [COLUMNS]
    for one in fc.quantities():
        if one["role"] not in ("answer", "of_path"):
            continue
        words = one["unit"] == "-"
        kind, column = ("np.str_", "_words") if words else ("np.float64", "_column")
        unit = "" if words else ", a pure number" if one["unit"] == "1" else f" in {one['unit']} for SI units"
        about = (
            f"numpy.ndarray: {one['words']}{unit}, shape (states,); {'empty' if words else 'NaN'} where there is none."
        )
        lines = textwrap.wrap(f'"""{about}"""', 112, break_long_words=False)
        doc = "\n        ".join(lines)
        parts.append(
            f"    @property\n    def {one['name']}(self) -> NDArray[{kind}]:\n"
            f"        {doc}\n        return self.{column}({one['name']!r})\n".replace("'", '"')
        )
    return "\n".join(parts)


EFFECTS = '''"""The effects. Written by python/generate.py from the keys of `[effects]`."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from . import _core
from ._plain import frozen, named
from .typing import {types}


@dataclass(frozen=True)
class Effects:
    """Effects beyond linear elastic normal contact with free boundaries.

    Each is off unless it is named; a model that cannot treat an effect refuses the scene. The value of an effect is the
    same as in a scene: a mapping with these keys, of plain numbers in consistent units.

    Parameters
    ----------
{parameters}

    Examples
    --------
    >>> import fractal_contact as fc
    >>> fc.Effects(adhesion={{"work": 0.05, "range": 1e-9, "law": "dugdale"}}).adhesion["law"]
    'dugdale'
    >>> fc.Effects.of({{"hardnes": 1.0}})
    Traceback (most recent call last):
    TypeError: no effect is called 'hardnes': did you mean hardness?
    >>> fc.Effects(hardness=-1.0)  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    DomainError: effects.hardness = -1: expected a number > 0
    """

{fields}

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
        fields="\n".join(f"    {key['name']}: {key['name'].capitalize()} | None = None" for key in keys),
        types=", ".join(sorted([*(key["name"].capitalize() for key in keys), "EffectsDict"])),
    )


def properties():
    """The line of each property of a state, by its name: those of the tables that are nothing else."""
    arrays = [{**one, "type": "NDArray[np.float64] | None"} for one in _core.fields()]
    return {
        one["name"]: f"    @property\n    def {one['name']}(self) -> {one['type']}: ...\n"
        for one in [*fc.quantities(), *arrays]
        if isinstance(vars(_core.ContactState)[one["name"]], property)
    }


def documented(text):
    """A stub with the docstrings of the compiled module in place of those that it has."""
    lines = text.splitlines()
    for node, doc in reversed(list(definitions(ast.parse(text).body, _core))):
        body, indent = node.body[0], " " * (node.col_offset + 4)
        # A docstring, or the three dots in its place, behind the head or below it.
        stands = isinstance(body, ast.Expr)
        first = body.lineno - 1 if stands else node.lineno
        last = body.end_lineno if stands else first
        head = lines[first][: body.col_offset].rstrip() if stands else ""
        if doc is None:
            if stands and not head:
                lines[first:last] = [f"{indent}..."] if len(node.body) == 1 else []
            continue
        told = [piece for line in f'"""{doc}'.split("\n") for piece in wrapped(line, indent)]
        told = [*told, f'{indent}"""'] if len(told) > 1 else [f'{told[0]}"""']
        if node.col_offset == 0 and isinstance(node, ast.FunctionDef) and lines[last : last + 1] > [""]:
            told.append("")
        lines[first:last] = [head, *told] if head else told
    return "\n".join(lines) + "\n"


def wrapped(line, indent):
    """A line of a docstring in lines that are not too long."""
    hanging = indent + " " * (len(line) - len(line.lstrip()))
    return textwrap.wrap(line, 117, initial_indent=hanging, subsequent_indent=hanging, break_long_words=False) or [""]


def definitions(body, owner):
    """Each class and function of a stub and its docstring, in their order."""
    for node in body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            value = getattr(owner, node.name)
            yield node, None if node.name.startswith("_") else inspect.getdoc(value)
            if isinstance(node, ast.ClassDef):
                yield from definitions(node.body, value)


def stub(text):
    """A stub with these properties in place of those that it has, and with docstrings."""
    return documented(
        re.sub(f"({BEGIN}[^\n]*\n).*?({END})", lambda m: m[1] + "".join(properties().values()) + m[2], text, flags=re.S)
    )


def run_notebooks():
    """Keeps each notebook with its outputs, without the times at which they came."""
    import nbclient
    import nbformat

    for path in sorted((Path(__file__).resolve().parent / "notebooks").glob("*.ipynb")):
        book = nbformat.read(path, as_version=4)
        where = {"metadata": {"path": str(path.parent)}}
        nbclient.NotebookClient(
            book, timeout=600, record_timing=False, coalesce_streams=True, resources=where
        ).execute()
        book.metadata.language_info = {"name": "python"}
        nbformat.write(book, path)


if __name__ == "__main__" and sys.argv[1:] == ["notebooks"]:
    run_notebooks()
elif __name__ == "__main__":
    (PACKAGE / "_formulas.py").write_text(formulas())
    (PACKAGE / "_effects.py").write_text(effects())
    (PACKAGE / "_columns.py").write_text(columns())
    path = PACKAGE / "_core.pyi"
    path.write_text(stub(path.read_text()))
