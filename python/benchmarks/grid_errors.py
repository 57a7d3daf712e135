"""How often the estimated error of the grid holds for leakage and stress: ``python grid_errors.py``.

Rough periodic surfaces with H = 0.8 are solved on 64, 128 and 256 cells a side, from which the error on 256 cells is
estimated as `grid_error` does it, and on 1024, which stand for the truth. Their shortest waves are 16 or 4 cells of the
grid of 256 long, or those of each grid.
"""

import numpy as np

import fractal_contact as fc

CELLS, TRUTH, SURFACES = 256, 1024, 8
PRESSURES = [0.01, 0.03, 0.06]
DEPTHS = [0.004, 0.008, 0.016, 0.032, 0.064]
SHORTEST = [16 / CELLS, 4 / CELLS, None]
NAMES = ["leakage", "flow factor", "largest stress", "stiffness"]


def estimate(fine, half, quarter):
    """The relative error of the grid, from three grids."""
    last, before = half - fine, quarter - half
    fall = min(max(last / before, 0.5), 0.75) if last * before > 0 else 0.5
    return 1.5 * max(abs(last), 0.5 * abs(before)) * fall / (1 - fall) / abs(fine)


def numbers(shortest, seed, cells):
    """The numbers of a surface on a grid, under each pressure."""
    surface = fc.Surface.self_affine(
        size=1.0, rms_height=0.01, hurst=0.8, roll_off_wavelength=0.25, shortest_wavelength=shortest
    )
    scene = fc.Scene(
        surface, contact_modulus=1.0, outputs=["gap", "pressure", "stiffness"], effects={"boundary": "periodic"}
    )
    contact = fc.Bem3d(cells=cells).prepare(scene, seed=seed)
    for pressure in PRESSURES:
        state = contact.solve(force=pressure)
        gap = np.where(state.pressure > 0, 0.0, np.maximum(state.gap, 0.0))
        leak = fc.leakage(gap, 1.0 / cells, boundary="periodic", continuum=False)
        stress = fc.largest_von_mises(
            state.pressure, cell=1.0 / cells, depths=DEPTHS, poisson=0.3, boundary="periodic"
        ).value
        flow = 0.5 * (leak.lower + leak.upper)
        yield flow, flow / gap.mean() ** 3, stress, state.stiffness


def main():
    inside = np.zeros(len(NAMES), dtype=int)
    count = 0
    for shortest in SHORTEST:
        for seed in range(SURFACES):
            quarter, half, fine, truth = (
                np.array(list(numbers(shortest, seed, cells))) for cells in (CELLS // 4, CELLS // 2, CELLS, TRUTH)
            )
            for load in range(len(PRESSURES)):
                count += 1
                for i in range(len(NAMES)):
                    error = abs(fine[load, i] - truth[load, i]) / abs(fine[load, i])
                    inside[i] += error <= estimate(fine[load, i], half[load, i], quarter[load, i])
    for name, number in zip(NAMES, inside, strict=True):
        print(f"{name}: {number} of {count} true errors are at most the estimate")


if __name__ == "__main__":
    main()
