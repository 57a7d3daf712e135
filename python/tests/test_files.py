"""Surfaces and scenes from files, statistics."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import fractal_contact as fc

ROOT = Path(__file__).resolve().parents[2]

SCENE = """# How stiff?
[scene]
models = ["bem3d"]
force_bar = [0.01, 0.1, 1.0]
modulus = "100 GPa"

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
    with pytest.raises(TypeError, match='no option is called "chanel"'):
        fc.read_surface(file, chanel=0)
    with pytest.raises(ValueError, match="detrend"):
        fc.read_surface(file, channel=0, detrend="pane")


def test_files_that_are_no_surfaces(tmp_path):
    (tmp_path / "empty.npy").write_bytes(b"")
    (tmp_path / "noise.npy").write_bytes(os.urandom(1000))
    (tmp_path / "half.npy").write_bytes(b"\x93NUMPY\x01\x00v\x00{'descr': '<f8'")
    for path in [*tmp_path.iterdir(), tmp_path, tmp_path / "absent.npy"]:
        with pytest.raises(fc.ReadError, match=path.name):
            fc.read_surface(path, unit="nm", size="1 um")


@pytest.mark.parametrize("ending", ["npy", "txt", "xyz", "h5", "x3p", "gwy", "nc"])
def test_maps_go_to_files_and_back(tmp_path, ending):
    rough = fc.Surface.self_affine(hurst=0.8, size=(2e-3, 1e-3), rms_height=1e-6).height_map((32, 16), seed=1)
    file = tmp_path / f"rough.{ending}"
    fc.write_surface(file, rough)
    told = {"unit": "m", "size": "2 mm x 1 mm"} if ending == "npy" else {}
    again = fc.read_surface(file, **told).heights
    assert again.shape == (16, 32)
    assert np.allclose(again.heights, rough.heights, rtol=0, atol=1e-12)


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


def test_generators_are_those_of_rust():
    surface = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01, roll_off_wavelength=0.2)
    plain = fc.surface_gen.self_affine_map(surface, 64, 3)
    assert plain == surface.height_map(64, 3)
    assert np.abs(fc.surface_gen.twin(plain, 3).heights - plain.heights).max() < 1e-13
    kept = fc.surface_gen.twin(plain, 4, keep_heights=True)
    centred = plain.heights - plain.heights.mean()
    assert np.allclose(np.sort(kept.heights.ravel()), np.sort(centred.ravel()), rtol=0, atol=1e-12)
    lay = fc.surface_gen.self_affine_map(surface, 128, 3, anisotropy=4.0, lay=30.0)
    assert abs(fc.statistics.parameters(lay)["Std"] - 120.0) < 20.0
    skewed = fc.surface_gen.self_affine_map(surface, 64, 3, weibull=1.5)
    assert fc.statistics.parameters(skewed)["Ssk"] == pytest.approx(1.07, abs=0.03)


def test_scenes_are_run_as_by_the_program(tmp_path):
    file = fc.Scene.from_toml(SCENE)
    assert file.models == ["bem3d"] and "stiffness" in file.plan()
    told = []
    outcome = fc.run_scene(file, tmp_path / "python", progress=lambda *n: told.append(n))
    assert outcome.states == 3 and outcome.failed == 0 and told
    assert (tmp_path / "python/report.html") in outcome.files
    assert outcome.results["model"].tolist() == ["bem3d"] * 3
    assert np.all(outcome.results["stiffness"] > 0)
    again = fc.run_scene(file, tmp_path / "python")
    assert again.kept == 3
    # The same physics by hand: the same bits.
    scene = fc.Scene(
        fc.Surface.self_affine(fractal_dimension=2.4, size=1e-3, rms_height=1e-6), modulus=100e9, outputs=["stiffness"]
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


def test_mistakes_in_scenes_show_their_place(tmp_path):
    with pytest.raises(fc.SceneError, match=r"fractal_dimension = 3\.4(.|\n)*\^\^\^"):
        fc.Scene.from_toml(SCENE.replace("2.4", "3.4"))
    with pytest.raises(fc.Error, match=r"absent\.toml"):
        fc.run_scene(tmp_path / "absent.toml", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_sweep_has_the_bits_of_rust():
    program = os.environ.get("FRACTAL_CONTACT_SWEEP")
    if program is None:
        pytest.skip("FRACTAL_CONTACT_SWEEP, the path of the example sweep_bits, is not set")
    told = subprocess.run([program], check=True, capture_output=True, text=True).stdout.splitlines()
    rough = fc.Surface.self_affine(fractal_dimension=2.4, size=1.0, rms_height=0.01)
    heights = fc.surface_gen.self_affine_map(rough, 129, fc.surface_gen.surface_seed(7, 3))
    contact = fc.Bem3d(tolerance=1e-8).prepare(fc.Scene(heights, modulus=1.0, outputs=["stiffness", "pressure"]))
    assert len(told) == 20
    for i, line in enumerate(told):
        expected = [np.uint64(int(bits, 16)).view(np.float64) for bits in line.split()]
        state = contact.solve(force=1e-4 * 1.5**i)
        # As Rust adds: one after the other.
        total = 0.0
        for value in state.pressure.ravel().tolist():
            total += value
        assert [state.force, state.approach, state.stiffness, total] == expected, i
