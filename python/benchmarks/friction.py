"""Partial slip of one rough map with ASPHER and here: seconds, verified residuals, and how far the answers differ.

python benchmarks/friction.py [CELLS]; ASPHER is skipped where it is not installed. Free boundaries, E* = 1, bodies
that are alike with nu = 0.3, mu = 0.4, one thread each. The normal force comes first, then half of the sliding force
in one increment, and the time has both.

Both programs have the same influence coefficients, those of square cells under constant tractions. From the tractions
of each, with these coefficients computed here:

- ``gap``: ``sum (mu p |w| - q . w)`` over ``sum mu p |delta|``, where w is the displacement delta of the bodies less
  the elastic displacement u, and delta is the mean of u over the cells that stick. It is 0 for an exact state, and
  >= 0 for all tractions within the limit of friction;
- ``beyond``: the largest traction beyond the limit of friction, over the largest limit.
"""

import importlib.util
import os
import sys
import time

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

import numpy as np

import fractal_contact as fc

POISSON, FRICTION, SHARE = 0.3, 0.4, 0.5
#: Forces over E* times rms height times side.
FORCES = [0.1, 1.0]
TOLERANCE = 1e-8


def ours(h, force):
    body = fc.Body(2 * (1 - POISSON**2), POISSON)
    scene = fc.Scene(
        fc.HeightMap(h, size=1.0),
        bodies=(body, body),
        outputs=["pressure", "traction"],
        effects={"friction": FRICTION},
    )
    contact = fc.Bem3d(tolerance=TOLERANCE).prepare(scene)
    contact.advance(force=force)
    state = contact.advance(force=force, tangential_force=(SHARE * FRICTION * force, 0.0))
    return np.array(state.pressure), np.array(state.traction)


def aspher(h, force):
    import aspher

    n = len(h)
    solver = aspher.FrictionSolver(
        grid_size=n, domain_size=1.0, E_star=1.0, nu=POISSON, model=aspher.CoulombFriction(FRICTION)
    )
    solver.set_gap(np.ascontiguousarray(h.max() - h).ravel())
    solver.step(p_bar=force)
    result = solver.step(q_bar=(SHARE * FRICTION * force, 0.0), dt=1.0)
    q = np.array([np.asarray(result.qx), np.asarray(result.qy)]).reshape(2, n, n)
    return np.asarray(solver.pressure).reshape(n, n), q


PROGRAMS = {"fractal_contact": ours, "aspher": aspher}


class Coefficients:
    """Tangential displacements under tangential tractions on n x n cells of a square of side 1 (Love, Cerruti)."""

    def __init__(self, n):
        """Integrates 1/r, x^2/r^3, y^2/r^3 and x y/r^3 over the cells, for all differences of indices."""
        self.n = n
        at = np.fft.fftfreq(2 * n, 1 / (2 * n)) / n
        [x, y] = np.meshgrid(at, at)

        def cell(corner):
            half = 0.5 / n
            return sum(s * t * corner(x + s * half, y + t * half) for s in (-1, 1) for t in (-1, 1))

        across = cell(lambda x, y: x * np.arcsinh(y / np.abs(x)))
        along = cell(lambda x, y: y * np.arcsinh(x / np.abs(y)))
        both = cell(lambda x, y: -np.hypot(x, y))
        c = POISSON / (1 - POISSON)
        self.xx, self.yy, self.xy = (
            np.fft.rfft2(of / np.pi) for of in (across + along + c * along, across + along + c * across, c * both)
        )

    def displacements(self, q):
        n = self.n
        [x, y] = np.fft.rfft2(q, (2 * n, 2 * n))
        u = np.array([self.xx * x + self.xy * y, self.xy * x + self.yy * y])
        return np.fft.irfft2(u, (2 * n, 2 * n))[:, :n, :n]


def residuals(p, q, coefficients):
    """The gap, how far tractions are beyond the limit, and the displacement of the bodies."""
    contact = p > 0
    u = coefficients.displacements(q)[:, contact]
    q, limit = q[:, contact], FRICTION * p[contact]
    size = np.hypot(*q)
    stick = size < (1 - 1e-6) * limit
    delta = u[:, stick].mean(axis=1)
    w = delta[:, None] - u
    gap = ((limit * np.hypot(*w)).sum() - (q * w).sum()) / (limit.sum() * np.hypot(*delta))
    return gap, (size - limit).max() / limit.max(), delta[0], stick.sum(), contact.sum()


def compare(n: int) -> None:
    """Prints a line for each program and force, and what the programs differ in."""
    fc.set_threads(1)
    rough = fc.Surface.self_affine(fractal_dimension=2.4, size=1.0, rms_height=1.0)
    h = np.array(fc.surface_gen.self_affine_map(rough, n, fc.surface_gen.surface_seed(1, 0)))
    h /= h.std()
    coefficients = Coefficients(n)
    print(f"{n} x {n} cells, nu {POISSON}, mu {FRICTION}, {SHARE} of the sliding force in one increment")
    for force in FORCES:
        found = {}
        for name, solve in PROGRAMS.items():
            if importlib.util.find_spec(name) is None:
                print(f"{name} not installed: skipped")
                continue
            start = time.perf_counter()
            p, q = solve(h, force)
            seconds = time.perf_counter() - start
            gap, beyond, delta, stick, contact = residuals(p, q, coefficients)
            found[name] = seconds, delta, p, q
            print(
                f"force {force:g} {name:16} {seconds:8.3f} s  gap {gap:.1e}  beyond {beyond:.1e}  "
                f"displacement {delta:.8f}  sticks {stick} of {contact}",
                flush=True,
            )
        if len(found) == 2:
            (mine, delta, p, q), (theirs, other_delta, other_p, other_q) = found.values()
            tractions = np.hypot(*(q - other_q)).max() / (FRICTION * p.max())
            pressures = np.abs(p - other_p).max() / p.max()
            print(
                f"force {force:g} times {theirs / mine:.0f}; largest differences: pressure {pressures:.1e} of the "
                f"largest, traction {tractions:.1e} of the largest limit, displacement {other_delta / delta - 1:.1e}",
                flush=True,
            )


if __name__ == "__main__":
    compare(int(sys.argv[1]) if len(sys.argv) > 1 else 128)
