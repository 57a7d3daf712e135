"""Surfaces and scenes from files, statistics."""

import copy
import os
import pickle
import re
import subprocess
import threading
import tomllib
from pathlib import Path

import numpy as np
import pytest

import fractal_contact as fc

ROOT = Path(__file__).resolve().parents[2]

SCENE = """# How stiff?
[scene]
models = ["bem3d"]
force_bar = [0.01, 0.1, 1.0]
contact_modulus = "100 GPa"

[scene.surface]
kind = "self_affine"
side = "1 mm"
fractal_dimension = 2.4
rms_height = "1 um"

[outputs]
stiffness = true
pressure = ["npy"]

[models.bem3d]
cells = 65

[sampling]
seed = 3
"""


def test_a_measured_map():
    file = ROOT / "data/measured/uncd-afm.001"
    if not file.exists():
        pytest.skip("outside of the repository")
    found = fc.read_surface(file, channel=0, detrend="plane", tip_radius="26 nm")
    assert found.heights.shape == (512, 512) and found.heights.size == (1e-7, 1e-7)
    assert found.metadata["unit"] == "m" and "Nanoscope" in found.metadata["text"]
    assert found.reliable_from == pytest.approx(3.4e-8, rel=0.01) and any("plane" in step for step in found.steps)
    known = fc.statistics.parameters(found.heights)
    assert known["Sq"] == pytest.approx(4.687922e-9, rel=1e-6) and known["Str"] is None
    assert fc.channels(file)[0]["shape"] == (512, 512)
    with pytest.raises(ValueError, match="detrend"):
        fc.read_surface(file, channel=0, detrend="pane")


def test_files_that_are_no_surfaces(tmp_path):
    (tmp_path / "empty.npy").write_bytes(b"")
    (tmp_path / "noise.npy").write_bytes(os.urandom(1000))
    (tmp_path / "half.npy").write_bytes(b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'")
    for path in [*tmp_path.iterdir(), tmp_path]:
        with pytest.raises(fc.ReadError, match=path.name):
            fc.read_surface(path, unit="nm", size="1 um")


def test_what_the_system_refuses_is_an_error_of_the_system(tmp_path):
    rough = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(8, seed=1)
    for refused in (
        lambda path: fc.read_surface(path),
        lambda path: fc.channels(path),
        lambda path: fc.run_scene(path, tmp_path / "out"),
        lambda path: fc.SceneFile.read(path),
        lambda path: fc.write_surface(path / "map.npy", rough),
    ):
        with pytest.raises(FileNotFoundError, match="No such file") as caught:
            refused(tmp_path / "absent")
        assert isinstance(caught.value, OSError) and "absent" in caught.value.filename
    # A map that a scene names is a mistake in the scene, with its line.
    text = SCENE.split("[scene.surface]")[0] + '[scene.surface]\nkind = "file"\npath = "absent.npy"\n'
    with pytest.raises(fc.SceneError, match="absent"):
        fc.Scene.from_toml(text, directory=tmp_path)


@pytest.mark.parametrize("ending", ["npy", "txt", "xyz", "h5", "x3p", "gwy", "nc"])
def test_maps_go_to_files_and_back(tmp_path, ending):
    rough = fc.Surface.self_affine(hurst=0.8, size=(2e-3, 1e-3), rms_height=1e-6).height_map((32, 16), seed=1)
    file = tmp_path / f"rough.{ending}"
    fc.write_surface(file, rough)
    told = {"unit": "m", "size": "2 mm x 1 mm"} if ending == "npy" else {}
    again = fc.read_surface(file, **told).heights
    assert again.shape == (16, 32)
    assert np.allclose(again.heights, rough.heights, rtol=0, atol=1e-12)


def test_options_are_those_of_scenes(tmp_path):
    rough = fc.Surface.self_affine(hurst=0.8, size=(2e-3, 1e-3), rms_height=1e-6).height_map((32, 16), seed=1)
    file = tmp_path / "rough.npy"
    fc.write_surface(file, rough)
    texts = fc.read_surface(file, unit="m", size="2 mm x 1 mm", crop="2,4,8,16").heights
    part = {"row": 2, "column": 4, "rows": 8, "columns": 16}
    assert fc.read_surface(file, unit="m", size=["2 mm", "1 mm"], crop=part).heights.equals(texts)
    assert texts.shape == (8, 16) and np.array_equal(texts.heights, rough.heights[2:10, 4:20])
    square = fc.read_surface(file, unit="m", size="2 mm x 1 mm", crop={"row": 2, "column": 4, "cells": 8})
    assert square.heights.shape == (8, 8)
    for wrong in ({"row": 2, "column": 4}, {"row": 2, "colum": 4}):
        with pytest.raises(TypeError, match="crop"):
            fc.read_surface(file, unit="m", size="2 mm x 1 mm", crop=wrong)


def test_the_density_is_that_of_its_docstring():
    # A wave of amplitude a along x: its variance a^2/2 is that of two waves of both signs, each a^2/4.
    a, m, columns = 0.3, 5, 64
    x = (np.arange(columns) + 0.5) * 2.0 / columns
    heights = np.tile(a * np.cos(2 * np.pi * m * x / 2.0), (32, 1))
    wave = fc.HeightMap(heights, size=(2.0, 1.0))
    profile = fc.statistics.power_spectrum(wave, "x", periodic=True)
    assert profile["wavenumber"][m - 1] == pytest.approx(2 * np.pi * m / 2.0)
    assert profile["density"][m - 1] == pytest.approx(2.0 / (2 * np.pi) * a**2 / 4)
    assert 2 * profile["density"].sum() * np.pi == pytest.approx(a**2 / 2)
    # Of a map: the square of the transform, times the area over (2 pi)^2, in the mean over a ring.
    rough = fc.Surface.self_affine(hurst=0.8, size=(2.0, 1.0), rms_height=0.01).height_map((64, 32), seed=1)
    square = np.abs(np.fft.fft2(rough.heights) / rough.heights.size) ** 2 * 2.0 / (2 * np.pi) ** 2
    assert square[1:].sum() + square[0, 1:].sum() == pytest.approx(rough.heights.var() * 2.0 / (2 * np.pi) ** 2)
    found = fc.statistics.power_spectrum(rough, periodic=True, per_decade=1000.0)
    assert found["wavenumber"][0] == pytest.approx(np.pi) and found["density"][0] == pytest.approx(square[0, 1])


def test_statistics_with_bands():
    rough = fc.surface_gen.self_affine_map(
        fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01, roll_off_wavelength=0.2), 128, 1
    )
    spectrum = fc.statistics.power_spectrum(rough, periodic=True)
    assert np.all(spectrum["low"] < spectrum["density"]) and np.all(spectrum["density"] < spectrum["high"])
    differences = fc.statistics.height_difference(rough, periodic=True)
    assert np.all(differences["low"] < differences["half_square"])
    free = fc.statistics.height_difference(rough)
    assert np.all(free["low"] < free["half_square"]) and np.isnan(fc.statistics.slope(rough)["low"][-1])
    for curve in (fc.statistics.slope(rough), fc.statistics.curvature(rough, "y")):
        assert curve["low"][0] < curve["rms"][0] < curve["high"][0]
    fit = fc.statistics.fit_spectrum(rough, periodic=True)
    assert fit["hurst"][1] < 0.8 < fit["hurst"][2] and fit["goodness"] > 0.01
    with pytest.raises(ValueError, match="direction"):
        fc.statistics.power_spectrum(rough, "z")


def test_an_exponent_takes_holes_into_account(tmp_path):
    # The rims of the holes make waves beyond the cut-off, which a fit that does not know of them takes for the surface.
    waves = {"roll_off_wavelength": 0.25, "shortest_wavelength": 0.04}
    rough = fc.Surface.self_affine(hurst=0.8, size=2.0, rms_height=0.01, **waves).height_map(400, 3)
    rough = rough.cropped((0, 160), (0, 200))
    y, x = np.mgrid[:160, :200]
    holes = np.hypot(x % 48 - 24, y % 48 - 24) < 6.5
    np.savetxt(tmp_path / "map.txt", np.where(holes, np.nan, rough.heights))
    options = {"unit": "none", "size": "1 x 0.8"}
    filled = fc.read_surface(tmp_path / "map.txt", fill="neighbours", **options).heights
    kept = fc.read_surface(tmp_path / "map.txt", undefined="no_contact", **options).heights
    masked = fc.HeightMap(np.ma.array(rough.heights, mask=holes), size=(1.0, 0.8))
    assert np.array_equal(filled.filled, holes) and filled.undefined == 0
    assert kept.filled is None and masked.filled is None and rough.filled is None
    whole = fc.statistics.fit_spectrum(rough)
    assert whole["notes"] == [] and whole["filled"] == 0
    for given in (filled, kept, masked):
        fit = fc.statistics.fit_spectrum(given)
        value, low, high = fit["hurst"]
        assert low < 0.8 < high and abs(value - whole["hurst"][0]) < 0.1 and fit["goodness"] > 0.01
        assert fit["filled"] == holes.sum() and len(fit["notes"]) == 1
        assert f"{holes.sum()} of {holes.size} points have heights between" in fit["notes"][0]
    # What follows from the map keeps it, and so do copies.
    copies = (copy.copy(filled), pickle.loads(pickle.dumps(filled)))
    for made in (*copies, 2 * filled - 1, filled + rough, -filled, filled * np.array(rough)):
        assert np.array_equal(made.filled, holes)
    assert np.array_equal(filled.transposed().filled, holes.T)
    assert np.array_equal(filled.mirrored().filled, holes[:, ::-1])
    assert np.array_equal(filled.rotated().transposed().filled, filled.rotated().filled.T)
    assert np.array_equal(filled.cropped((10, 60), (20, 90)).filled, holes[10:60, 20:90])
    assert filled.cropped((0, 5), (0, 5)).filled is None
    # Where it is not known, the fit says that its exponent means nothing.
    unknown = fc.statistics.fit_spectrum(fc.HeightMap(np.array(filled), size=filled.size))
    assert unknown["goodness"] < 0.01 and unknown["hurst"][0] > 3
    (note,) = unknown["notes"]
    assert "have no meaning" in note and 'undefined="no_contact"' in note


def test_generators_are_those_of_rust():
    surface = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01, roll_off_wavelength=0.2)
    plain = fc.surface_gen.self_affine_map(surface, 64, 3)
    assert plain.equals(surface.height_map(64, 3))
    assert np.abs(fc.surface_gen.twin(plain, 3).heights - plain.heights).max() < 1e-13
    kept = fc.surface_gen.twin(plain, 4, keep_heights=True)
    centred = plain.heights - plain.heights.mean()
    assert np.allclose(np.sort(kept.heights.ravel()), np.sort(centred.ravel()), rtol=0, atol=1e-12)
    lay = fc.surface_gen.self_affine_map(surface, 128, 3, anisotropy=4.0, lay=30.0)
    assert abs(fc.statistics.parameters(lay)["Std"] - 120.0) < 20.0
    skewed = fc.surface_gen.self_affine_map(surface, 64, 3, weibull=1.5)
    assert fc.statistics.parameters(skewed)["Ssk"] == pytest.approx(1.07, abs=0.03)


def test_a_scene_of_tables_is_that_of_its_text(tmp_path):
    tables = tomllib.loads(SCENE)
    read, asked = fc.Scene.from_toml(SCENE), fc.Scene.from_dict(tables)
    first, second = (fc.run_scene(scene, tmp_path / name) for scene, name in ((read, "read"), (asked, "asked")))
    assert (first.results["stiffness"] == second.results["stiffness"]).all()
    # Its text is that of a scene.
    assert fc.Scene.from_toml(asked.text).text == asked.text
    coarse = read.replaced(
        {"models.bem3d.cells": 33, "effects.hardness": {"pressure": "2 GPa"}, "scene.force_bar": [0.1]}
    )
    assert "cells = 33" in coarse.text and 'pressure = "2 GPa"' in coarse.text and "force_bar = 0.1" in coarse.text
    assert read.replaced({}).text == asked.text
    for wrong, message in [
        ({"models.bem3d.cells": 0}, "models.bem3d.cells` = 0"),
        ({"models.bem3d.cell": 3}, "there is no key `models.bem3d.cell`"),
        ({"scene.approach": "1 nm"}, "`force_bar` and `approach` are both given"),
        ({"effects.hardness": 3}, "has no unit"),
    ]:
        with pytest.raises(fc.Error, match=re.escape(message)):
            read.replaced(wrong)
    with pytest.raises(fc.Error, match="nothing is pressed"):
        fc.Scene.from_dict({**tables, "scene": {"models": ["bem3d"], "contact_modulus": "1 GPa"}})


def test_scenes_are_run_as_by_the_program(tmp_path):
    file = fc.Scene.from_toml(SCENE)
    assert file.models == ["bem3d"] and "stiffness" in file.plan()
    told = []
    outcome = fc.run_scene(file, tmp_path / "python", progress=lambda *n: told.append(n))
    assert outcome.states == 3 and outcome.failed == 0 and told
    assert (tmp_path / "python/report.html") in outcome.files
    assert outcome.results["model"].tolist() == ["bem3d"] * 3
    assert outcome.results["state"].dtype == np.int64 and outcome.results["state"].tolist() == [0, 1, 2]
    assert outcome.results["contact_cells"].dtype == np.int64 and outcome.results["force"].dtype == np.float64
    assert np.all(outcome.results["stiffness"] > 0)
    again = fc.run_scene(file, tmp_path / "python")
    assert again.kept == 3
    # The same physics by hand: the same bits.
    scene = fc.Scene(
        fc.Surface.self_affine(fractal_dimension=2.4, size=1e-3, rms_height=1e-6),
        contact_modulus=100e9,
        outputs=["stiffness"],
    )
    contact = fc.Bem3d(cells=65).prepare(scene, seed=fc.surface_gen.surface_seed(3, 0))
    forces = [contact.normalisation.force(force_bar) for force_bar in (0.01, 0.1, 1.0)]
    found = [state.stiffness for state in contact.sweep(force=forces)]
    assert found == outcome.results["stiffness"].tolist()
    program = os.environ.get("FRACTAL_CONTACT_PROGRAM")
    if program is None:
        print("not compared with the program: FRACTAL_CONTACT_PROGRAM is not set")
        return
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    subprocess.run([program, "run", path, "--out", tmp_path / "program"], check=True, capture_output=True)
    rows = [
        [line for line in (tmp_path / of / "results.csv").read_text().splitlines() if not line.startswith("#")]
        for of in ("python", "program")
    ]
    assert rows[0] == rows[1]
    for name in ("pressure-bem3d-0-000.npy", "pressure-bem3d-0-002.npy"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "program" / name).read_bytes()


def test_an_accuracy_is_chosen_once_and_goes_on_after_a_stop(tmp_path):
    text = SCENE.replace("\n[models.bem3d]\ncells = 65\n", "").replace("[0.01, 0.1, 1.0]", "[0.5, 1.0]")
    asked = fc.Scene.from_toml(text.replace("[scene]\n", '[scene]\naccuracy = "60 %"\nmemory = "1 GB"\n'))
    whole = fc.run_scene(asked, tmp_path / "whole")
    # Both states of the grid are those of the pilot.
    assert (whole.states, whole.kept, whole.failed) == (2, 2, 0)
    field = np.load(tmp_path / "whole/pressure-bem3d-0-001.npy")
    assert field.shape == (257, 257) and max(whole.results["stiffness_grid_error"]) < 0.6
    # The first stop comes before anything is solved, the others on some grid of the pilot, or after it.
    for delay in [0.0, 0.05, 0.1, 0.2]:
        stop = threading.Event()
        timer = threading.Timer(delay, stop.set)
        if delay == 0.0:
            stop.set()
        timer.start()
        try:
            fc.run_scene(asked, tmp_path / "parts", stop=stop)
            assert delay > 0.0
        except fc.Stopped:
            pass
        timer.join()
    parts = fc.run_scene(asked, tmp_path / "parts")
    assert (tmp_path / "parts/results.csv").read_bytes() == (tmp_path / "whole/results.csv").read_bytes()
    assert parts.results["stiffness"].tolist() == whole.results["stiffness"].tolist()
    with pytest.raises(fc.SceneError, match="the `memory` is 10 MB"):
        fc.run_scene(
            fc.Scene.from_toml(text.replace("[scene]\n", '[scene]\naccuracy = "1e-4 %"\nmemory = "10 MB"\n')),
            tmp_path / "small",
        )


def test_mistakes_in_scenes_show_their_place(tmp_path):
    with pytest.raises(fc.SceneError, match=r"fractal_dimension = 3\.4(.|\n)*\^\^\^"):
        fc.Scene.from_toml(SCENE.replace("2.4", "3.4"))
    with pytest.raises(FileNotFoundError, match=r"absent\.toml"):
        fc.run_scene(tmp_path / "absent.toml", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_pictures_of_chosen_states(tmp_path):
    file = fc.Scene.from_toml(SCENE.replace('["npy"]', '["png"]'))
    outcome = fc.run_scene(file, tmp_path, drawn_states=np.array([2]))
    assert [path.name for path in outcome.files if path.suffix == ".png"] == ["pressure-bem3d-0-002.png"]
    assert outcome.states == 3
    with pytest.raises(ValueError, match=r"state 3 is to be drawn, but there are 3 states; .* from 0 to 2"):
        fc.run_scene(file, tmp_path, drawn_states=[0, 3])
    for wrong, error in ((2, TypeError), ("2", TypeError), ([1.5], TypeError), ([-1], fc.DomainError)):
        with pytest.raises(error, match="drawn_states"):
            fc.run_scene(file, tmp_path, drawn_states=wrong)


def test_a_sweep_has_the_bits_of_rust():
    program = os.environ.get("FRACTAL_CONTACT_SWEEP")
    if program is None:
        pytest.skip("FRACTAL_CONTACT_SWEEP, the path of the example sweep_bits, is not set")
    told = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    rough = fc.Surface.self_affine(fractal_dimension=2.4, size=1.0, rms_height=0.01)
    heights = fc.surface_gen.self_affine_map(rough, 129, fc.surface_gen.surface_seed(7, 3))
    contact = fc.Bem3d(tolerance=1e-8).prepare(
        fc.Scene(heights, contact_modulus=1.0, outputs=["stiffness", "pressure"])
    )
    assert len(told) == 20
    for i, line in enumerate(told):
        expected = [np.uint64(int(bits, 16)).view(np.float64) for bits in line.split()]
        state = contact.solve(force=1e-4 * 1.5**i)
        # As Rust adds: one after the other.
        total = 0.0
        for value in state.pressure.ravel().tolist():
            total += value
        assert [state.force, state.approach, state.stiffness, total] == expected, i
