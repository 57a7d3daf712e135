"""Maps as arrays, and pictures of maps and states."""

import base64
import io
import re

import numpy as np
import pytest

import fractal_contact as fc


def rough(cells=(16, 8), seed=1):
    return fc.Surface.self_affine(hurst=0.6, size=(2.0, 1.0), rms_height=0.01).height_map(cells, seed)


HOLES = fc.HeightMap([[1.0, np.nan], [3.0, 4.0]], size=1.0, undefined="no_contact")


def test_a_map_is_an_array():
    a = rough()
    assert len(a) == 8 and a.shape == (8, 16)
    for array in (np.asarray(a), np.array(a), np.asarray(a, dtype=np.float64)):
        assert np.array_equal(array, a.heights)
    copy = np.array(a)
    copy[0, 0] = 5.0
    assert a.heights[0, 0] != 5.0
    assert np.asarray(a, dtype=np.float32).dtype == np.float32 and np.abs(a).max() == np.abs(a.heights).max()
    with pytest.raises(ValueError, match="read-only"):
        a.heights[0, 0] = 5.0
    with pytest.raises(ValueError, match="copied"):
        a.__array__(copy=False)


def test_numbers_and_arrays_are_added_and_multiplied():
    a, h = rough(), np.array(rough())
    row = np.arange(16.0) * np.ones((8, 1))
    for found, expected in (
        (2 * a, 2 * h),
        (a * np.float64(2), 2 * h),
        (np.float64(2) * a, 2 * h),
        (a / 4, h / 4),
        (-a, -h),
        (+a, h),
        (a + 1, h + 1),
        (1 - a, 1 - h),
        (a - row, h - row),
        (row - a, row - h),
        (row + a, h + row),
        (row * a, h * row),
        (a - a.heights.mean(), h - h.mean()),
    ):
        assert isinstance(found, fc.HeightMap) and found.size == a.size
        assert np.array_equal(found.heights, expected)
    holes = 2 * HOLES - 1
    assert holes.undefined == 1 and np.array_equal(np.array(holes), [[1.0, np.nan], [5.0, 7.0]], equal_nan=True)
    for wrong in (True, "2", 1j, None, [True], np.ma.masked_array([[1.0]], [[True]])):
        with pytest.raises(TypeError):
            a * wrong
    with pytest.raises(TypeError):
        a * a
    with pytest.raises(TypeError):
        2 / a
    with pytest.raises(fc.ShapeError, match="shape"):
        a + np.zeros((3, 3))
    for wrong in (np.nan, np.full(a.shape, np.nan)):
        with pytest.raises(fc.DomainError, match="finite"):
            a + wrong
    with pytest.raises(fc.DomainError, match="inf"):
        a / 0.0


def test_where_the_cells_are():
    a = rough()
    assert a.extent == (0.0, 2.0, 0.0, 1.0) and a.cell == (0.125, 0.125)
    assert np.allclose(a.x, 0.125 * (np.arange(16) + 0.5), rtol=0, atol=1e-15)
    assert np.allclose(a.y, 0.125 * (np.arange(8) + 0.5), rtol=0, atol=1e-15)


def test_maps_are_drawn_and_given_to_xarray():
    xarray = pytest.importorskip("xarray")
    a = rough()
    found = a.to_xarray()
    assert isinstance(found, xarray.DataArray) and found.dims == ("y", "x") and found.name == "height"
    assert np.array_equal(found.values, a.heights) and np.array_equal(found.x, a.x)
    assert found.sel(x=0.19, y=0.06, method="nearest") == a.heights[0, 1]


def test_maps_are_drawn():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    from matplotlib import pyplot

    a = rough()
    figure, axes = pyplot.subplots()
    image = a.plot(axes, cmap="grey")
    assert image.get_extent() == list(a.extent) and image.origin == "lower" and len(figure.axes) == 2
    assert axes.get_aspect() == 1.0 and image.get_cmap().name == "grey"
    pyplot.close(figure)


def pictures(html):
    """Width and height on the screen of each picture."""
    assert all(base64.b64decode(png).startswith(b"\x89PNG") for png in re.findall(r"base64,([^\"]*)", html))
    return [(float(w), float(h)) for w, h in re.findall(r"width:(\d+)px;height:(\d+)px", html)]


def test_pictures_have_the_shape_of_the_rectangle_and_a_scale():
    # Cells that are no squares: 16 x 16 of them on 2 x 1.
    for map_ in (rough(), rough((16, 16)), HOLES, fc.HeightMap(np.zeros((3, 2000)), size=(1.0, 3.0))):
        html = map_._repr_html_()
        (wide, high), (_, bar) = pictures(html)
        assert wide / high == pytest.approx(map_.size[0] / map_.size[1], rel=0.02) and bar == high
        known = map_.heights[np.isfinite(map_.heights)]
        assert f"<span>{known.max():.4g}</span>" in html and f"<span>{known.min():.4g}</span>" in html
        assert f"{map_.size[0]:.4g} x {map_.size[1]:.4g}" in html


def test_pictures_of_large_maps_keep_shares_and_say_so():
    image = pytest.importorskip("matplotlib.image")
    for columns, rows in ((400, 200), (1300, 650)):
        # A quarter of the cells is high, in squares of one cell, and one cell is higher than all others.
        heights = np.zeros((rows, columns))
        heights[::2, ::2] = 1.0
        heights[100, 101] = 2.0
        html = fc.HeightMap(heights, size=(columns, rows))._repr_html_()
        png = base64.b64decode(re.search(r"base64,([^\"]*)", html).group(1))
        pixels = image.imread(io.BytesIO(png))[..., :3]
        assert pixels.shape[1] == min(columns, 512) and ("one of about" in html) == (columns > 512)
        # Half of the scale.
        high = np.abs(pixels - np.array([33, 145, 140]) / 255).max(axis=2) < 0.02
        assert high.mean() == pytest.approx(0.25, abs=1e-3 if columns > 512 else 0)
        assert "<span>2</span>" in html and (pixels[..., 0] > 0.95).sum() >= 1


def test_states_show_what_they_have():
    scene = fc.Scene(rough(), contact_modulus=1.0, outputs=["stiffness", "pressure", "gap"])
    state = fc.Bem3d().prepare(scene).solve(force=1e-4)
    html = state._repr_html_()
    assert len(pictures(html)) == 4 and "pressure" in html and "duality_gap" in html
    assert all(note.split(":")[0] in html for note in state.notes)
    plain = fc.Hertz().prepare(fc.Scene(fc.Surface.sphere(radius=1.0, size=1.0), contact_modulus=1.0)).solve(force=1e-4)
    assert pictures(plain._repr_html_()) == [] and "approach" in plain._repr_html_()
    body = fc.Body(1.0, 0.3)
    friction = fc.Scene(rough((32, 16)), bodies=(body, body), effects={"friction": 0.3}, outputs=["traction"])
    path = fc.Bem3d().prepare(friction)
    path.advance(force=0.01)
    assert "magnitude of traction" in path.advance(force=0.01, tangential_force=1e-3)._repr_html_()


def test_fields_are_read_only():
    scene = fc.Scene(rough(), contact_modulus=1.0, outputs=["pressure", "contact_patches"])
    state = fc.Bem3d().prepare(scene).solve(force=0.01)
    for array in (state.pressure, state.pressure.base, state.patches, state.to_dict(fields=True)["pressure"]):
        assert not array.flags.writeable
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
