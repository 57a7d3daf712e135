"""What pickles are made of again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._core import Certificate, ContactState, HeightMap, Normalisation, SceneFile
from .typing import Undefined


def height_map(
    values: NDArray[np.float64],
    size: tuple[float, float],
    undefined: Undefined,
    axes: str | None = None,
    filled: NDArray[np.bool_] | None = None,
) -> HeightMap:
    """A map."""
    return HeightMap._with_origin(HeightMap(values, size, undefined=undefined), axes, filled)


def state(kept: bytes, fields: list[NDArray[np.float64] | None]) -> ContactState:
    """A state and its fields."""
    return ContactState._of_bytes(kept, fields)


def certificate(kept: bytes) -> Certificate:
    """A certificate."""
    return Certificate._of_bytes(kept)


def normalisation(kept: bytes) -> Normalisation:
    """A normalisation."""
    return Normalisation._of_bytes(kept)


def scene_file(text: str, path: Any) -> SceneFile:
    """A scene file; the files that it names are read where they were."""
    path = Path(path)
    return SceneFile.from_toml(text, directory=path.parent, name=path.stem)
