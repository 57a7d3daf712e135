"""How the leakage of one constriction vanishes: ``python constriction.py [CELLS ...]``.

The surface is the sum of a cosine along x and one along y, one period of each. Just below the closing pressure p_c the
fluid passes one saddle. Dapp and Mueser (EPL 109, 44001 (2015)) found that the flow then falls as (p_c - p)^3.45, for
elastic contact without adhesion. Printed are the closing pressure, the contact fraction there, and the exponent between
neighbouring pressures.
"""

import sys

import numpy as np

import fractal_contact as fc

HALVINGS = 22
SHARES = [0.3, 0.2, 0.14, 0.1, 0.07, 0.05, 0.035, 0.025, 0.018, 0.0125, 0.009, 0.006, 0.004, 0.003, 0.002]


class Saddle:
    def __init__(self, cells):
        cosine = np.cos(2 * np.pi * (np.arange(cells) + 0.5) / cells)
        heights = fc.HeightMap(0.01 * (cosine[:, None] + cosine[None, :]), size=1.0)
        outputs, effects = ["gap", "pressure", "area"], {"boundary": "periodic"}
        scene = fc.Scene(heights, contact_modulus=1.0, outputs=outputs, effects=effects)
        self.contact = fc.Bem3d(tolerance=1e-7).prepare(scene)
        self.cell = 1.0 / cells

    def gap(self, pressure):
        state = self.contact.solve(force=pressure)
        return np.where(state.pressure > 0, 0.0, np.maximum(state.gap, 0.0)), state.area

    def is_open(self, pressure):
        return fc.percolation(self.gap(pressure)[0], self.cell, boundary="periodic").spans

    def flow(self, pressure):
        leak = fc.leakage(self.gap(pressure)[0], self.cell, boundary="periodic")
        return 0.5 * (leak.lower + leak.upper)


def main():
    for cells in [int(word) for word in sys.argv[1:]] or [128, 256, 512, 1024]:
        saddle = Saddle(cells)
        low, high = 0.01, 0.06
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if saddle.is_open(middle) else (low, middle)
        fractions = [saddle.gap(pressure)[1] for pressure in (low, high)]
        print(f"{cells} cells: closed at {high:.6f} E*, contact fraction {fractions[0]:.4f} to {fractions[1]:.4f}")
        flows = [saddle.flow(low * (1 - share)) for share in SHARES]
        for i in range(1, len(SHARES)):
            exponent = np.log(flows[i] / flows[i - 1]) / np.log(SHARES[i] / SHARES[i - 1])
            print(f"  1 - p/p_c {SHARES[i]:.4f}: flow {flows[i]:.3e}, exponent {exponent:.3f}", flush=True)


if __name__ == "__main__":
    main()
