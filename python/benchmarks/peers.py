"""The same map and loads with other programs: lines of code, seconds, verified residual, stiffness.

python benchmarks/peers.py [CELLS]; what is not installed is skipped. Free boundaries, E* = 1, one thread each. The
residual is the duality gap over force times rms height with the exact influence coefficients of square cells (Love
1929), the same for all.
"""

import importlib.util
import inspect
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

import fractal_contact as fc

FORCES = np.geomspace(1e-4, 0.1, 5)
TOLERANCE = 1e-8


def fractal_contact(h):
    scene = fc.Scene(fc.HeightMap(h, size=1.0), contact_modulus=1.0, outputs=["stiffness", "pressure"])
    contact = fc.Bem3d(tolerance=TOLERANCE).prepare(scene)
    for state in contact.sweep(force=FORCES):
        yield state.pressure, state.stiffness


def tamaas(h):
    import tamaas as tm

    model = tm.ModelFactory.createModel(tm.model_type.basic_2d, [1.0, 1.0], list(h.shape))
    model.E, model.nu = 1.0, 0.0
    tm.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tm.PolonskyKeerRey(model, h, TOLERANCE)
    solver.setIntegralOperator("dcfft")
    solver.max_iter = 20_000
    for force in FORCES:
        solver.solve(force)
        yield np.array(model.traction).reshape(h.shape), None


def contact_mechanics(h):
    from ContactMechanics import FreeFFTElasticHalfSpace
    from ContactMechanics.Systems import NonSmoothContactSystem
    from SurfaceTopography import Topography

    halfspace = FreeFFTElasticHalfSpace(h.shape, 1.0, (1.0, 1.0), fft="serial")
    system = NonSmoothContactSystem(halfspace, Topography(h, (1.0, 1.0)))
    for force in FORCES:
        result = system.minimize_proxy(external_force=force, maxiter=20_000, pentol=TOLERANCE * h.std())
        yield np.asarray(result.jac) * h.size, None


def aspher(h):
    import aspher

    gap = np.ascontiguousarray(-h).ravel()
    for force in FORCES:
        result = aspher.solve_nested(
            grid_size=len(h), gap=gap, p_nominal=force, tol=TOLERANCE, coarsest=64, q=6, backend="fft"
        )
        yield np.asarray(result.pressure).reshape(h.shape), None


PROGRAMS = {
    "fractal_contact": fractal_contact,
    "tamaas": tamaas,
    "ContactMechanics": contact_mechanics,
    "aspher": aspher,
}


def coefficients(n):
    """Displacement of each cell under unit pressure on the first one, for all differences of indices."""
    half = 0.5 / n
    x = np.fft.fftfreq(2 * n, 1 / (2 * n)) / n
    [x, y] = np.meshgrid(x, x)

    def corner(x, y):
        return x * np.arcsinh(y / np.abs(x)) + y * np.arcsinh(x / np.abs(y))

    of = sum(s * t * corner(x + s * half, y + t * half) for s in (-1, 1) for t in (-1, 1))
    return np.fft.rfft2(of / np.pi)


def residual(p, h, kernel):
    n = len(h)
    u = np.fft.irfft2(np.fft.rfft2(p, kernel_shape(n)) * kernel, kernel_shape(n))[:n, :n]
    gap = u - h
    return float((p * (gap - gap.min())).sum() / p.sum() / h.std())


def kernel_shape(n):
    return (2 * n, 2 * n)


def compare(n: int) -> None:
    """Prints a line for each program that is installed."""
    fc.set_threads(1)
    rough = fc.Surface.self_affine(fractal_dimension=2.2, size=1.0, rms_height=0.01)
    h = np.array(fc.surface_gen.self_affine_map(rough, n, fc.surface_gen.surface_seed(1, 0)))
    kernel = coefficients(n)
    print(f"{n} x {n} cells, forces {FORCES.round(5).tolist()}, tolerance {TOLERANCE:g}")
    for name, solve in PROGRAMS.items():
        if importlib.util.find_spec(name) is None:
            print(f"{name:18} not installed: skipped")
            continue
        lines = len([line for line in inspect.getsource(solve).splitlines() if line.strip()])
        states = solve(h)
        start = time.perf_counter()
        found = list(states)
        seconds = time.perf_counter() - start
        worst = max(residual(p, h, kernel) for p, _ in found)
        stiffness = found[2][1]
        told = "none" if stiffness is None else f"{stiffness:.8f}"
        areas = [int((p > 0).sum()) for p, _ in found]
        print(f"{name:18} {lines:2} lines {seconds:8.2f} s  residual {worst:.1e}  k {told}  contact cells {areas}")


if __name__ == "__main__":
    compare(int(sys.argv[1]) if len(sys.argv) > 1 else 256)
