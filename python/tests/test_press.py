"""One call: a map that is pressed."""

import csv
import os
import pickle
import re
import subprocess
import warnings

import numpy as np
import pytest

import fractal_contact as fc

ROUGH = fc.Surface.self_affine(hurst=0.8, size=1.0, rms_height=0.01).height_map(64, seed=1)
HEIGHTS = np.array(ROUGH)
STEEL = fc.Body(fc.si("210 GPa"), 0.3)


def test_numbers_and_fields_of_each_load():
    pressed = fc.press(HEIGHTS, 1.0, 2.0, mean_pressure=[1e-3, 1e-2], detrend="none")
    outputs = ["area", "stiffness", "pressure", "gap"]
    contact = fc.Bem3d().prepare(fc.Scene(ROUGH, 2.0, outputs=outputs))
    for i, state in enumerate(contact.sweep(mean_pressure=[1e-3, 1e-2])):
        for name in ("force", "approach", "area", "stiffness"):
            assert getattr(pressed, name)[i] == getattr(state, name), name
        assert np.array_equal(pressed.pressure[i], state.pressure) and np.array_equal(pressed.gap[i], state.gap)
    assert np.allclose(pressed.mean_pressure, [1e-3, 1e-2], rtol=1e-12) and np.isnan(pressed.mean_gap).all()
    # The area of cells twice as large differs by about this share.
    assert ((pressed.area_error > 0.01) & (pressed.area_error < 1)).all() and (pressed.stiffness_error > 0).all()
    assert pressed.size == (1.0, 1.0) and pressed.files == []


def test_the_report_needs_no_other_file(tmp_path):
    pressed = fc.press(HEIGHTS, 1.0, 1.0, force=1e-3)
    path = pressed.report(tmp_path / "report.html")
    text = path.read_text()
    assert text == pressed.html.decode() and text.startswith("<!") and "area" in text
    assert not re.search(r'(src|href)="(?!data:|#|https?:)', text)
    html = pressed._repr_html_()
    assert "+-" in html and html.count("<figure") == 2 and pressed.notes[0] in html.replace("&quot;", '"')
    assert "area" in repr(pressed) and "note: " in repr(pressed)
    assert pickle.loads(pickle.dumps(pressed)) == pressed
    assert pressed != fc.press(HEIGHTS, 1.0, 1.0, force=2e-3)


def test_units():
    of_numbers = fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3)
    assert 'units = "none"' in of_numbers.scene
    in_units = fc.press(1e6 * HEIGHTS, "1 mm", "1 GPa", unit="nm", mean_pressure="1 MPa")
    also = fc.press(1e6 * HEIGHTS, 1e-3, 1e9, unit="nm", mean_pressure=1e6)
    assert np.array_equal(in_units.area, also.area) and "units" not in in_units.scene
    assert "mean_pressure [MPa]" in in_units.summary
    assert in_units.area == pytest.approx(1e-6 * of_numbers.area, rel=1e-9)
    assert fc.press(HEIGHTS, cell=1 / 64, contact_modulus=1.0, mean_pressure=1e-3).area == of_numbers.area
    assert fc.press(ROUGH, contact_modulus=1.0, mean_pressure=1e-3).area == of_numbers.area
    by_bodies = fc.press(
        1e6 * HEIGHTS, "1 mm", unit="nm", bodies=({"young": "210 GPa", "poisson": 0.3}, STEEL), mean_pressure="1 MPa"
    )
    modulus = fc.si("210 GPa") / (2 * (1 - 0.3**2))
    same = fc.press(1e6 * HEIGHTS, "1 mm", modulus, unit="nm", mean_pressure="1 MPa")
    assert by_bodies.approach == pytest.approx(same.approach, rel=1e-9)


def test_effects_boundaries_and_loads():
    periodic = fc.press(HEIGHTS, 1.0, 1.0, mean_gap=[0.02, 0.01], effects={"boundary": "periodic"})
    assert np.allclose(periodic.mean_gap, [0.02, 0.01], rtol=1e-6) and np.isnan(periodic.approach).all()
    soft = fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3, effects=fc.Effects(hardness=0.05))
    assert soft.results["plastic_area"][0] > 0 and soft.pressure[0].max() <= 0.05 * (1 + 1e-6)
    ball = fc.press(np.zeros((65, 65)), 1.0, 1.0, approach=0.01, ball=1.0)
    assert ball.force[0] == pytest.approx(4 / 3 * 0.01**1.5, rel=0.02)
    effects = {"friction": 0.3}
    rubs = fc.press(HEIGHTS, 1.0, bodies=(fc.Body(1.0, 0.3),) * 2, force=1e-3, tangential_force=1e-4, effects=effects)
    assert len(rubs.force) == 9 and rubs.results["tangential_force"][-1] == pytest.approx(1e-4)
    assert set(np.unique(rubs.fields["stick_slip"][-1])) <= {0, 1, 2} and "gap" not in rubs.fields


def test_maps_are_prepared():
    x, y = np.meshgrid(np.arange(64), np.arange(64))
    tilted = HEIGHTS + 1e-3 * x - 2e-3 * y
    level = fc.press(tilted, 1.0, 1.0, mean_pressure=1e-3)
    assert level.area == fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3).area
    assert level.area > fc.press(tilted, 1.0, 1.0, mean_pressure=1e-3, detrend="none").area
    holes = np.ma.masked_greater(HEIGHTS, 0.5 * HEIGHTS.max())
    without = fc.press(holes, 1.0, 1.0, mean_pressure=1e-3)
    assert np.isnan(without.gap[0][holes.mask]).all() and not without.pressure[0][holes.mask].any()
    filled = np.where(holes.mask, np.nan, HEIGHTS)
    # Remedies have the words of this package, of each kind of note that these states have.
    notes = [note for one in (level, without, fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=0.02)) for note in one.notes]
    assert any("undefined points" in note for note in notes) and any("edge of the rectangle" in note for note in notes)
    assert not [note for note in notes if "[effects]" in note or ' = "' in note]
    assert np.isfinite(fc.press(filled, 1.0, 1.0, mean_pressure=1e-3, fill="neighbours").gap[0]).all()
    with pytest.raises(fc.DomainError, match="is NaN"):
        fc.press(filled, 1.0, 1.0, mean_pressure=1e-3)
    assert fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3, cells=32).pressure[0].shape == (32, 32)
    options = {"undefined": None, "fill": None, "crop": None}
    assert fc.press(holes, 1.0, 1.0, mean_pressure=1e-3, **options).area == without.area
    finer = fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-2, keys={"models.bem3d.tolerance": 1e-10})
    assert finer.results["duality_gap"][0] < 1e-10
    assert fc.press(HEIGHTS, 1.0, 1.0, force=1e-3, outputs=["displacement"]).fields["displacement"][0].shape == (64, 64)


def test_a_named_array_is_turned():
    xarray = pytest.importorskip("xarray")
    oblong = HEIGHTS[:32]
    given = xarray.DataArray(oblong.T, dims=("x", "y"))
    one, other = (fc.press(array, (1.0, 0.5), 1.0, force=1e-3) for array in (given, oblong))
    assert np.array_equal(one.pressure[0], other.pressure[0])


@pytest.mark.parametrize(
    ("options", "error", "words"),
    [
        ({}, TypeError, "exactly one of mean_pressure, force"),
        ({"force": 1.0, "mean_pressure": 1.0}, TypeError, "exactly one of mean_pressure, force"),
        ({"force": []}, ValueError, "force has no value"),
        ({"force": -1.0}, ValueError, "-1"),
        ({"force": np.nan}, fc.DomainError, "force = NaN: expected a finite number"),
        ({"force": "1 MPa", "unit": "nm"}, ValueError, "1 MPa"),
        ({"force": ["1 N", 2.0], "unit": "nm"}, ValueError, "unit"),
        ({"force": 1.0, "size": "1 MPa", "unit": "nm"}, ValueError, "1 MPa"),
        ({"force": 1.0, "contact_modulus": "1 m", "unit": "nm"}, ValueError, "1 m"),
        ({"force": 1.0, "effects": {"hardness": "1 m"}, "unit": "nm"}, ValueError, "1 m"),
        ({"force": "much"}, (TypeError, ValueError), "much"),
        ({"force": 1.0, "size": None}, TypeError, "size, which is that of the whole map"),
        ({"force": 1.0, "cell": 1.0}, TypeError, "size, which is that of the whole map"),
        ({"force": 1.0, "contact_modulus": None}, TypeError, "give contact_modulus"),
        ({"force": 1.0, "contact_modulus": -1.0}, fc.DomainError, "contact_modulus = -1"),
        ({"force": 1.0, "size": "1 mm"}, TypeError, "unit= is missing"),
        ({"force": 1.0, "effects": {"friction": 0.3}}, TypeError, "bodies= is missing"),
        ({"force": 1.0, "tangential_force": 1.0}, TypeError, "need each other"),
        ({"force": 1.0, "effects": {"hardnes": 1.0}}, ValueError, "did you mean `effects.hardness`"),
        ({"force": 1.0, "effects": {"hardness": -1.0}}, fc.DomainError, "hardness = -1"),
        ({"force": 1.0, "outputs": ["aera"]}, ValueError, "did you mean `outputs.area`"),
        ({"force": 1.0, "outputs": "area"}, TypeError, "expected a list of names"),
        ({"force": 1.0, "outlier": 8}, TypeError, r"argument 'outlier'\. Did you mean 'outliers'\?$"),
        ({"mean_presure": 1.0}, TypeError, r"^press\(\) got .* 'mean_presure'\. Did you mean 'mean_pressure'\?$"),
        ({"mean_gap": 1.0}, fc.SceneError, "the scene of this call"),
    ],
)
def test_what_is_missing_or_wrong(options, error, words):
    with pytest.raises(error, match=words):
        fc.press(HEIGHTS, **{"size": 1.0, "contact_modulus": 1.0, **options})


UNITS = {"": 1.0, "%": 0.01, "kPa": 1e3, "MPa": 1e6, "N": 1.0, "mN": 1e-3, "pm": 1e-12, "nm": 1e-9, "um": 1e-6}
UNITS |= {"N/um": 1e6, "N/mm": 1e3, "um^2": 1e-12, "mm^2": 1e-6, "mm^3": 1e-9, "um^3": 1e-18, "m^2": 1.0, "m^3": 1.0}
UNITS |= {"J": 1.0, "nJ": 1e-9, "uJ": 1e-6, "pJ": 1e-12, "fJ": 1e-15}


@pytest.mark.parametrize(
    ("loads", "effects"),
    [
        ({"mean_pressure": ["1 kPa", "20 kPa"]}, {"boundary": "periodic"}),
        ({"force": "50 mN"}, {"hardness": "0.3 MPa"}),
        ({"approach": ["20 nm", "50 nm"]}, {}),
    ],
)
def test_every_line_of_the_table_is_an_attribute(loads, effects):
    pressed = fc.press(HEIGHTS, "1 mm", "1 GPa", unit="um", effects=effects, **loads)
    lines = [line for line in pressed.summary.splitlines()[1:] if not line.startswith(("  The number", "    "))]
    assert len(lines) > 9
    errors = 0
    for line in lines:
        name, unit, rest = re.fullmatch(r"  (\w+)(?: \[(.*?)\])? +(\S.*)", line).groups()
        for i, cell in enumerate(re.split(r"\s{2,}", rest)):
            value, _, error = cell.partition(" +- ")
            value = float(value) * UNITS[unit or ""]
            # As the table rounds: a number to its error, or to four digits.
            error = float(error) * UNITS[unit or ""] if error else 1e-3 * abs(value)
            assert getattr(pressed, name)[i] == pytest.approx(value, abs=0.6 * error), line
            if "+-" in cell:
                errors += 1
                known = pressed.error(name)[i] * abs(getattr(pressed, name)[i])
                assert known == pytest.approx(error, rel=0.3), line
    assert errors > 3
    assert np.isnan(pressed.error("largest_patch")).all()
    with pytest.raises(ValueError, match="no quantity is called 'aera': did you mean 'area'"):
        pressed.error("aera")


def test_a_path_has_its_columns_too():
    effects = {"friction": 0.3}
    rubs = fc.press(HEIGHTS, 1.0, bodies=(fc.Body(1.0, 0.3),) * 2, force=1e-3, tangential_force=1e-4, effects=effects)
    for name in ("tangential_force", "tangential_displacement", "stick_area", "slip_area", "dissipated"):
        assert np.isfinite(getattr(rubs, name)).all() and len(getattr(rubs, name)) == 9
    assert np.isnan(rubs.energy).all() and rubs.branch.tolist() == [""] * 9


def test_files(tmp_path):
    with pytest.raises(FileNotFoundError):
        fc.press(tmp_path / "absent.x3p", contact_modulus="1 GPa", force="1 N")
    fc.write_surface(tmp_path / "map.x3p", ROUGH.scaled(1e-3, 1e-3))
    by_path = fc.press(tmp_path / "map.x3p", contact_modulus="1 GPa", force="1 mN")
    by_map = fc.press(fc.read_surface(tmp_path / "map.x3p"), contact_modulus="1 GPa", force="1 mN")
    assert by_path.area == by_map.area and by_path.approach == by_map.approach
    kept = fc.press(tmp_path / "map.x3p", contact_modulus="1 GPa", force="1 mN", out=tmp_path / "out")
    assert {"report.html", "results.csv"} <= {file.name for file in kept.files} and all(f.exists() for f in kept.files)
    assert (tmp_path / "out" / "scene.toml").read_text().endswith(kept.scene)
    # Its own folder may be used again; what another has written stays.
    again = fc.press(ROUGH.scaled(1e-3, 1e-3), contact_modulus="1 GPa", force="1 mN", out=tmp_path / "out")
    assert again.area == by_map.area
    for name in ("scene.toml", "heights.npy"):
        folder = tmp_path / name.split(".")[0]
        folder.mkdir()
        (folder / name).write_text("of another")
        with pytest.raises(FileExistsError, match="not written by press"):
            fc.press(ROUGH, contact_modulus=1.0, force=1e-3, out=folder)
        assert (folder / name).read_text() == "of another" and len(list(folder.iterdir())) == 1
    with pytest.raises(TypeError, match="leave size= out"):
        fc.press(ROUGH, 1.0, 1.0, force=1.0)


def test_loads_that_fail_are_warned_of():
    with pytest.warns(RuntimeWarning, match="1 of 2 loads failed"):
        failed = fc.press(
            HEIGHTS, 1.0, 1.0, mean_pressure=[1e-3, 0.2], effects={"boundary": "periodic", "hardness": 0.1}
        )
    assert np.isnan(failed.area[1]) and failed.area[0] > 0 and failed.pressure[1] is None
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3)


@pytest.mark.skipif("FRACTAL_CONTACT_PROGRAM" not in os.environ, reason="the program is not built")
def test_numbers_are_those_of_the_program(tmp_path):
    # Runs as `.ci/python` does. The file of an array has neither unit nor size.
    np.save(tmp_path / "map.npy", 1e6 * HEIGHTS)
    program = os.environ["FRACTAL_CONTACT_PROGRAM"]
    command = ["press", "map.npy", "--unit", "nm", "--size", "1 mm", "--contact-modulus", "115 GPa"]
    ran = subprocess.run(
        [program, *command, "--pressure", "1 MPa,10 MPa", "--hardness", "5 GPa", "--out", "out"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert ran.returncode == 0, ran.stderr
    pressures = ["1 MPa", "10 MPa"]
    effects = {"hardness": "5 GPa"}
    pressed = fc.press(1e6 * HEIGHTS, "1 mm", "115 GPa", unit="nm", mean_pressure=pressures, effects=effects)
    lines = [line for line in (tmp_path / "out/results.csv").read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    assert list(rows[0]) == list(pressed.results)
    for name, column in pressed.results.items():
        for value, row in zip(column, rows, strict=True):
            assert (
                (float(row[name] or "nan") == value or np.isnan(value))
                if column.dtype.kind in "fi"
                else row[name] == value
            )
    assert ran.stdout.split("\n\n")[0].strip() in pressed.summary or pressed.summary.strip() in ran.stdout


def test_a_misspelt_unit_is_told():
    for text, told in [("1 Mpa", "is it mPa or MPa"), ("1,5 MPa", "decimal comma")]:
        with pytest.raises(ValueError, match=told):
            fc.press(HEIGHTS, "1 mm", "115 GPa", unit="nm", mean_pressure=text)


def test_equal_calls_are_equal_and_their_page_has_the_name_of_the_map():
    one, other = (fc.press(HEIGHTS, 1.0, 1.0, mean_pressure=1e-3) for _ in range(2))
    assert one == other
    assert b"<title>map" in one.html


def test_a_map_without_room_is_refused_before_it_is_copied():
    huge = np.broadcast_to(0.0, (2**17, 2**17))
    with pytest.raises(fc.OutOfMemory, match="the contact of a map of 131072 columns x 131072 rows"):
        fc.press(huge, 1.0, 1.0, mean_pressure=1e-3)
