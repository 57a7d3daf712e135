"""Writes what follows from the tables of the library: the classes of `_formulas.py`, the properties in `_core.pyi`.

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


def properties():
    """The line of each property of a state, by its name: those of the table that are nothing else."""
    return {
        quantity["name"]: f"    @property\n    def {quantity['name']}(self) -> {quantity['type']}: ...\n"
        for quantity in fc.quantities()
        if isinstance(vars(_core.ContactState)[quantity["name"]], property)
    }


def stub(text):
    """A stub with these properties in place of those that it has."""
    return re.sub(
        f"({BEGIN}[^\n]*\n).*?({END})", lambda m: m[1] + "".join(properties().values()) + m[2], text, flags=re.S
    )


if __name__ == "__main__":
    (PACKAGE / "_formulas.py").write_text(formulas())
    path = PACKAGE / "_core.pyi"
    path.write_text(stub(path.read_text()))
