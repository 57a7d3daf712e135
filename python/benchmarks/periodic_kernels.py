"""How many cells of a periodic map are in contact, by kernels of cells and by kernels of waves.

python benchmarks/periodic_kernels.py [CELLS]. The package takes cells under constant pressure; others take the waves of
the grid, each with its continuous displacement 2/(E* q). The latter are solved here in numpy by the solver of
tests/test_periodic_map.py, to 1e-9 of the rms height. A line for each load, then the range of the differences.
"""

import sys
from pathlib import Path

import numpy as np

import fractal_contact as fc

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests"))
from test_periodic_map import pressures, waves

HURST = (0.8, 0.4)
#: Roll-off wavelength and shortest wavelength, over the side; None is the side, or two cells.
SPECTRA = ((None, None), (1 / 4, None), (1 / 4, 1 / 32))
SEEDS = (1, 2)
#: Mean pressure over E* times the rms gradient: about half of the contact fraction.
LOADS = (0.025, 0.05, 0.15)


def main(cells):
    differences = []
    for hurst in HURST:
        for roll_off, shortest in SPECTRA:
            surface = fc.Surface.self_affine(
                size=1.0, rms_height=0.01, hurst=hurst, roll_off_wavelength=roll_off, shortest_wavelength=shortest
            )
            for seed in SEEDS:
                map_ = surface.height_map(cells, seed)
                gradient = fc.statistics.parameters(map_, periodic=True)["rms_gradient"]
                scene = fc.Scene(map_, 1.0, effects={"boundary": "periodic"}, outputs=["area"])
                contact = fc.Bem3d(tolerance=1e-8).prepare(scene)
                heights = map_.heights - map_.mean()
                for load in LOADS:
                    state = contact.solve(mean_pressure=load * gradient)
                    of_waves = int((pressures(heights, load * gradient, waves(cells)) > 0).sum())
                    more = of_waves / state.contact_cells - 1
                    differences.append(more)
                    counts = f"cells {state.contact_cells}, waves {of_waves}, {100 * more:+.2f} %"
                    spectrum = f"hurst {hurst} roll-off {roll_off} shortest {shortest} seed {seed}"
                    print(f"{spectrum}: fraction {state.contact_fraction:.3f}, {counts}")
    low, middle, high = 100 * np.quantile(differences, [0, 0.5, 1])
    print(f"{len(differences)} states: by waves {low:+.2f} to {high:+.2f} % more cells, median {middle:+.2f} %")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 256)
