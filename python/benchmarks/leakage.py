"""Leakage through a rough gap, beside reynoldsflow: ``python leakage.py [CELLS ...]``.

The gap is that of reynoldsflow's own case ``rough-contact``: 36 % of the cells are closed. Both programs solve the same
network of cells, with two threads. Here the flow has a proven bound on each side, to a relative width of 1e-10, and the
continuum has bounds too; reynoldsflow stops at a residual of 1e-12. Needs reynoldsflow and SciPy.
"""

import sys
import time

import numpy as np
from reynoldsflow import transport
from scipy.ndimage import gaussian_filter

import fractal_contact as fc

RUNS = 3


def gap_of(cells):
    heights = np.random.default_rng(23349).standard_normal((cells, cells))
    heights = gaussian_filter(heights, cells / 48, mode=["reflect", "wrap"])
    heights -= heights.mean()
    heights /= heights.std()
    return np.clip(heights + 0.35, 0, None)


def ours(gap, cells):
    begin = time.perf_counter()
    found = fc.leakage(gap, cell=1.0 / cells, along="y", boundary="periodic")
    return time.perf_counter() - begin, found


def theirs(gap):
    begin = time.perf_counter()
    transport.solve_fluid_problem(gap)
    return time.perf_counter() - begin


def main():
    transport.set_verbosity("error")
    fc.set_threads(2)
    # The first call of a function compiles it.
    transport.solve_fluid_problem(gap_of(64))
    for cells in [int(word) for word in sys.argv[1:]] or [256, 512, 1024, 2048]:
        gap = gap_of(cells)
        for _ in range(RUNS):
            here, found = ours(gap, cells)
            there = theirs(gap)
            print(
                f"{cells} cells a side: {found.lower:.12g} to {found.upper:.12g} in {here:.2f} s; "
                f"reynoldsflow {there:.2f} s, {there / here:.1f} times as long"
            )


if __name__ == "__main__":
    main()
