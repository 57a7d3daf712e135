"""A rough viscoelastic contact under a held pressure, beside Tamaas: ``python viscoelastic.py [PRESSURE]``.

The map and the material are those of an example of Tamaas' Maxwell solver: 256 x 256 cells, 50 relaxation times over
ten decades. Tamaas takes 300 fixed steps of implicit Euler. Here the same 300 states have steps whose error is
measured, with three contacts for each; and ten states over the same time, with as many steps as their error asks for.
One thread each. Needs tamaas.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import sys
import time
from pathlib import Path

import numpy as np
import tamaas

import fractal_contact as fc

CELLS, STEPS, END = 256, 300, 50.0
MAP = Path(__file__).resolve().parents[2] / "data/peers/surface_maxwell_N256.npy"
WEIGHTS, TIMES = [3.0] * 50, np.logspace(-1, 9, 50).tolist()


def theirs(heights, pressure):
    tamaas.set_log_level(tamaas.LogLevel.error)
    model = tamaas.ModelFactory.createModel(tamaas.model_type.basic_2d, [1.0, 1.0], [CELLS, CELLS])
    model.E, model.nu = 3.0, 0.5
    solver = tamaas.MaxwellViscoelastic(
        model, heights, 1e-6, time_step=END / STEPS, shear_moduli=WEIGHTS, characteristic_times=TIMES
    )
    begin = time.process_time()
    for _ in range(STEPS):
        solver.solve(pressure)
    return time.process_time() - begin, int((model.traction > 0).sum())


def ours(heights, pressure, states):
    fc.set_threads(1)
    rheology = {"kind": "prony", "weights": WEIGHTS, "times": TIMES}
    scene = fc.Scene(
        fc.HeightMap(heights, size=1.0),
        contact_modulus=4.0,
        outputs=["area"],
        effects={"boundary": "periodic", "rheology": rheology},
    )
    contact = fc.Bem3d(periodic_kernel="waves").prepare(scene)
    begin = time.process_time()
    found = [contact.advance(time=END * k / states, force=pressure) for k in range(states + 1)]
    seconds = time.process_time() - begin
    return (
        seconds,
        found[-1].contact_cells,
        sum(state.time_steps for state in found),
        max(state.area_time_error for state in found),
    )


def main():
    pressure = float(sys.argv[1]) if len(sys.argv) > 1 else 16.0
    heights = np.load(MAP).astype(float)
    seconds, cells = theirs(heights, pressure)
    print(f"Tamaas, {STEPS} fixed steps: {seconds:.1f} s, {cells} cells in contact at the end")
    for states in (STEPS, 10):
        of_us, cells, steps, error = ours(heights, pressure, states)
        print(
            f"here, {states} states, {steps} steps: {of_us:.1f} s, {cells} cells; largest error of the area by steps "
            f"{error:.1e}; Tamaas {seconds / of_us:.1f} times as long"
        )


if __name__ == "__main__":
    main()
