"""What Python adds: to a solve of 512 x 512 cells, in pairs of runs in Rust and in Python, to formulas, to its start.

cargo build --release --example solve_times, then python benchmarks/overhead.py PATH/TO/solve_times [PAIRS]
"""

import statistics
import subprocess
import sys
import time

import fractal_contact as fc


def main() -> None:
    pairs = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    rough = fc.Surface.self_affine(fractal_dimension=2.2, size=1.0, rms_height=0.01)
    heights = fc.surface_gen.self_affine_map(rough, 512, fc.surface_gen.surface_seed(1, 0))
    scene = fc.Scene(heights, contact_modulus=1.0)
    with subprocess.Popen([sys.argv[1]], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as rust:
        assert rust.stdin is not None and rust.stdout is not None
        ratios = []
        for pair in range(pairs + 1):
            rust.stdin.write("\n")
            rust.stdin.flush()
            seconds, stiffness = map(float, rust.stdout.readline().split())
            start = time.perf_counter()
            state = fc.Bem3d(tolerance=1e-8).prepare(scene).solve(force=0.01)
            mine = time.perf_counter() - start
            assert state.stiffness == stiffness, "the same bits"
            if pair > 0:  # The first pair warms both up.
                ratios.append(mine / seconds)
                print(f"Rust {seconds:.4f} s, Python {mine:.4f} s, ratio {ratios[-1]:.4f}")
        rust.stdin.close()
    quarters = statistics.quantiles(ratios)
    print(
        f"median ratio {statistics.median(ratios):.4f}, quartiles {quarters[0]:.4f} to {quarters[2]:.4f}, {pairs} pairs"
    )
    ball = fc.Hertz().prepare(fc.Scene(fc.Surface.sphere(radius=1.0, size=2.0), contact_modulus=1.0))
    start = time.perf_counter()
    for _ in range(10_000):
        ball.solve(force=0.1)
    print(f"10 000 solves by Hertz's formula {time.perf_counter() - start:.4f} s")
    code = "import numpy, time; t = time.perf_counter(); import fractal_contact; print(time.perf_counter() - t)"
    told = [float(subprocess.check_output([sys.executable, "-c", code])) for _ in range(5)]
    print(f"importing, beyond numpy {statistics.median(told):.4f} s, median of 5")


if __name__ == "__main__":
    main()
