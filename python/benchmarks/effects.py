"""Hardness and adhesion on the same periodic map as with Tamaas: seconds, verified residual, area, energy.

python benchmarks/effects.py [CELLS]; Tamaas is skipped where it is not installed. E* = 1, one thread each. Each
state is verified with the influence coefficients of its own program, ours piecewise constant pressure, theirs
Fourier's 2/|q|.

- hardness: ``sum p g - min sum q g`` over all 0 <= q <= p_s of the same force, over force times rms height;
- adhesion: the largest over all cells of min(g/range, q/(work/range)), q = net pressure + attraction of the gap g,
  where an exact state has either g = 0 or q = 0; and the potential of the gaps at this load, over force times rms
  height, by the influence coefficients of either program: first ours, then theirs.
"""

import importlib.util
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

import fractal_contact as fc

PRESSURE = 0.01
GRADIENT = 0.1
HARDNESS = 0.05
#: Tolerances of fractal-contact and of Tamaas.
TOLERANCES = [1e-4, 1e-6], [1e-4, 1e-6, 1e-8]
#: Aliases of a wave to each side.
ALIASES = 12


def surface(n):
    rough = fc.Surface.self_affine(fractal_dimension=2.2, size=1.0, rms_height=1.0, roll_off_wavelength=0.25)
    h = np.array(fc.surface_gen.self_affine_map(rough, n, fc.surface_gen.surface_seed(1, 0)))
    slopes = [(np.roll(h, 1, axis) - h) * n for axis in (0, 1)]
    return h * GRADIENT / np.sqrt(np.mean(slopes[0] ** 2 + slopes[1] ** 2))


def symbol(n, fourier):
    """Displacement over pressure of each wave: 2/|q|, or of cells of constant pressure the sum over its aliases."""
    waves = np.fft.fftfreq(n, 1 / n)[:, None], np.fft.rfftfreq(n, 1 / n)[None, :]
    aliases = [0] if fourier else range(-ALIASES, ALIASES + 1)
    total = np.zeros((n, n // 2 + 1))
    for i in aliases:
        for j in aliases:
            x, y = waves[0] + i * n, waves[1] + j * n
            q = 2 * np.pi * np.hypot(x, y)
            q[q == 0] = np.inf
            # Signs alternate with the alias: half of the last one stands for the rest of the series.
            share = 0.5 ** ((abs(i) == ALIASES) + (abs(j) == ALIASES))
            total += share * 2 / q * (1 if fourier else np.sinc(x / n) * np.sinc(y / n))
    return total


def ours(h, tolerance, effects):
    scene = fc.Scene(
        fc.HeightMap(h, size=1.0),
        contact_modulus=1.0,
        outputs=["pressure", "gap"],
        effects={"boundary": "periodic", **effects},
    )
    state = fc.Bem3d(tolerance=tolerance).prepare(scene).solve(force=PRESSURE)
    return np.array(state.pressure), np.array(state.gap)


def tamaas(h, tolerance, effects):
    import tamaas as tm

    tm.set_log_level(tm.LogLevel.warning)
    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(h.shape))
    model.E, model.nu = 1.0, 0.0
    adhesion = effects.get("adhesion")
    if adhesion is None:
        solver = tm.KatoSaturated(model, h, tolerance, effects["hardness"])
    else:
        solver = tm.PolonskyKeerRey(model, h, tolerance, tm.PolonskyKeerRey.gap, tm.PolonskyKeerRey.pressure)
        attraction = tm.ExponentialAdhesionFunctional(h)
        attraction.parameters = {"rho": adhesion["range"], "surface_energy": adhesion["work"]}
        solver.addFunctionalTerm(attraction)
    solver.max_iter = 20_000
    solver.dump_freq = 20_000
    solver.solve(PRESSURE)
    p = np.array(model.traction).reshape(h.shape)
    gap = np.fft.irfft2(symbol(len(h), True) * np.fft.rfft2(p), h.shape) - h
    if adhesion is None:
        gap -= gap[(p > 0) & (p < effects["hardness"])].mean()
    else:
        work, range_ = adhesion["work"], adhesion["range"]
        gap -= gap.min()
        # The cells in contact lie at gap 0 but for the error of the state: their mean, weighted by pressure.
        contact = np.maximum(p + work / range_ * np.exp(-gap / range_), 0) * (gap < range_)
        gap -= (contact * gap).sum() / contact.sum()
    return p, gap


def potential(gap, h, adhesion, displacement_over_pressure):
    """Elastic energy less the work of the attraction and of the load for these gaps, over force times rms height."""
    gap = np.maximum(gap, 0)
    u = np.fft.rfft2(gap + h) / h.size
    twice = np.full(u.shape, 2.0)
    twice[:, 0] = twice[:, -1] = 1
    u[0, 0], displacement_over_pressure[0, 0] = 0, 1
    elastic = 0.5 * (twice * np.abs(u) ** 2 / displacement_over_pressure).sum()
    attraction = adhesion["work"] * np.exp(-gap / adhesion["range"]).mean()
    return (elastic - attraction + PRESSURE * gap.mean()) / (PRESSURE * h.std())


def hardness_residual(p, gap, h, limit):
    full = round(p.sum() / limit - 0.5)
    lowest = np.sort(gap, axis=None)
    least = limit * lowest[:full].sum() + (p.sum() - limit * full) * lowest[full]
    return float(((p * gap).sum() - least) / p.sum() / h.std())


def adhesion_residual(p, gap, work, range_):
    contact = p + work / range_ * np.exp(-np.maximum(gap, 0) / range_)
    return float(np.abs(np.minimum(gap / range_, contact * range_ / work)).max())


def compare(n: int) -> None:
    """Prints a line for each effect, program and tolerance."""
    fc.set_threads(1)
    h = surface(n)
    print(f"{n} x {n} cells, mean pressure {PRESSURE} E*, rms gradient {GRADIENT}")
    work, range_ = 1.6e-3 / n, 0.2 / n
    adhesion = {"work": work, "range": range_, "law": "exponential"}
    symbols = [symbol(n, fourier) for fourier in (False, True)]
    for effect, effects in ("hardness", {"hardness": HARDNESS}), ("adhesion", {"adhesion": adhesion}):
        for name, solve, tolerances in zip(("fractal_contact", "tamaas"), (ours, tamaas), TOLERANCES, strict=True):
            if importlib.util.find_spec(name) is None:
                print(f"{name} not installed: skipped")
                continue
            for tolerance in tolerances:
                start = time.perf_counter()
                p, gap = solve(h, tolerance, effects)
                told = f"{effect} {name:16} tolerance {tolerance:g} {time.perf_counter() - start:8.2f} s"
                if effect == "hardness":
                    residual, area = hardness_residual(p, gap, h, HARDNESS), (p > 0).mean()
                    print(f"{told}  residual {residual:.1e}  area {area:.4f}", flush=True)
                else:
                    residual = adhesion_residual(p, gap, work, range_)
                    contact = p + work / range_ * np.exp(-np.maximum(gap, 0) / range_)
                    area = (contact > 1e-3 * work / range_).mean()
                    energies = "  ".join(f"{potential(gap, h, adhesion, of):.6f}" for of in symbols)
                    print(f"{told}  residual {residual:.1e}  area {area:.4f}  potential {energies}", flush=True)


if __name__ == "__main__":
    compare(int(sys.argv[1]) if len(sys.argv) > 1 else 256)
