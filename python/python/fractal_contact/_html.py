"""States and maps in notebooks."""

from __future__ import annotations

import base64
import html
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._core import ContactState, HeightMap

if TYPE_CHECKING:
    from ._press import Pressed

# Largest sides of a picture on the screen.
WIDE, HIGH = 320, 400


def _image(
    values: NDArray[np.float64], low: float, high: float, size: tuple[float, float], alt: str
) -> tuple[str, str]:
    """The picture, and what it says of itself where it has fewer pixels than values."""
    png, reduction = _core.picture(values, low, high)
    data = base64.b64encode(png).decode("ascii")
    style = f"width:{size[0]:.0f}px;height:{size[1]:.0f}px;image-rendering:pixelated;display:block"
    image = f'<img alt="{html.escape(alt)}" style="{style}" src="data:image/png;base64,{data}">'
    return image, reduction


def picture(values: NDArray[np.float64], size: tuple[float, float], title: str) -> str:
    """Values of a rectangle in its shape, the first row at the bottom, with its sides and a colour bar."""
    known = values[np.isfinite(values)]
    low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
    across, up = size
    scale = min(WIDE / across, HIGH / up)
    wide, high_ = max(across * scale, 1.0), max(up * scale, 1.0)
    map_, reduction = _image(values, low, high, (wide, high_), f"{title}, the first row at the bottom")
    bar, _ = _image(np.linspace(low, high, 256)[:, None], low, high, (12, high_), "colour bar")
    small, sides = "font-size:85%", f"{across:.4g} x {up:.4g}"
    said = f"{sides}. {reduction}" if reduction else sides
    return (
        f'<figure style="display:inline-block;margin:0 1.5em 0.5em 0;vertical-align:top">'
        f"<figcaption>{html.escape(title)}</figcaption>"
        f'<div style="display:flex;gap:6px">{map_}{bar}'
        f'<div style="display:flex;flex-direction:column;justify-content:space-between;{small}">'
        f"<span>{high:.4g}</span><span>{low:.4g}</span></div></div>"
        f'<div style="{small}">{said}</div></figure>'
    )


def height_map(map_: HeightMap) -> str:
    """A map: what it is, and its picture."""
    return f"<div>{html.escape(repr(map_))}</div>{picture(map_.heights, map_.size, 'height')}"


def _field(values: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(values if values.ndim == 2 else np.hypot(*values), dtype=np.float64, order="C")


def _shown(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def state(state_: ContactState) -> str:
    """A state: its answers and residuals as a table, its notes, pictures of its fields."""
    known = state_.to_dict()
    rows = "".join(
        f'<tr><td style="text-align:left"><code>{one["name"]}</code></td><td>{html.escape(_shown(value))}</td>'
        f'<td style="text-align:left">{html.escape(one["words"])}</td></tr>'
        for one in _core.quantities()
        if one["role"] in ("answer", "of_path", "residual") and (value := known.get(one["name"])) is not None
    )
    notes = "".join(f"<li>{html.escape(note)}</li>" for note in state_.notes)
    fields = ((one, getattr(state_, one["name"])) for one in _core.fields())
    pictures = "".join(
        picture(_field(values), state_.size, one["name"] if values.ndim == 2 else f"magnitude of {one['name']}")
        for one, values in fields
        if values is not None
    )
    status = html.escape(state_.status.replace("_", " "))
    noted = f"<ul>{notes}</ul>" if notes else ""
    return f"<div>contact state, {status}</div><table>{rows}</table>{noted}<div>{pictures}</div>"


def pressed(pressed_: Pressed) -> str:
    """A map that was pressed: the table of its states, its notes, pictures of the fields of the last state."""
    notes = "".join(f"<li>{html.escape(note)}</li>" for note in pressed_.notes)
    last = ((name, fields[-1]) for name, fields in pressed_.fields.items())
    pictures = "".join(
        picture(_field(values), pressed_.size, f"{name}, last state") for name, values in last if values is not None
    )
    noted = f"<ul>{notes}</ul>" if notes else ""
    return f"<pre>{html.escape(pressed_.summary)}</pre>{noted}<div>{pictures}</div>"
