"""One contact in several threads, and Ctrl-C at awkward moments: each in a process that may not hang."""

import os
import signal
import subprocess
import sys
import time

import pytest

# Seconds; the slowest takes a fraction of it on two cores.
LONG = 300.0

BEGIN = """
import os, signal, sys, threading, time
import numpy as np
import fractal_contact as fc

signal.signal(signal.SIGINT, signal.default_int_handler)
# Also where there is one processor: threads of the pool wait for each other.
fc.set_threads(4)

def rough(cells, hurst=0.6):
    return fc.Surface.self_affine(hurst=hurst, size=1.0, rms_height=0.01).height_map(cells, seed=1)

def in_threads(count, work):
    failed = []
    def guarded(number):
        try:
            work(number)
        except BaseException as error:
            failed.append(error)
    threads = [threading.Thread(target=guarded, args=(number,)) for number in range(count)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed, failed
"""


def run(code):
    """What a process prints; one that hangs or fails is a failed test."""
    told = subprocess.run([sys.executable, "-c", BEGIN + code], capture_output=True, text=True, timeout=LONG)
    assert told.returncode == 0, told.stderr
    return told.stdout


def test_two_thousand_solves_of_one_contact():
    # The large map is shared among the threads of the pool, the small one is not.
    run("""
for cells, solves in ((17, 1700), (257, 300)):
    forces = [0.005, 0.02, 0.05, 0.1]
    scene = fc.Scene(rough(cells), contact_modulus=1.0)
    expected = [fc.Bem3d(tolerance=1e-8).prepare(scene).solve(force=force) for force in forces]
    contact = fc.Bem3d(tolerance=1e-8).prepare(scene)

    def work(number):
        for i in range(solves // 4):
            which = (number + i) % 4
            state = contact.solve(force=forces[which])
            # In units of the rms height, 0.01; each meets its tolerance, whatever was solved before.
            assert abs(state.approach - expected[which].approach) < 1e-6 * 0.01, (state, expected[which])
            assert abs(state.stiffness / expected[which].stiffness - 1.0) < 1e-6, (state, expected[which])

    in_threads(4, work)
""")


def test_steps_of_one_path():
    run("""
for cells, steps in ((17, 600), (257, 400)):
    scene = fc.Scene(rough(cells), contact_modulus=1.0, effects={"hardness": 0.1}, outputs=["area"])
    path = fc.Bem3d(tolerance=1e-8).prepare(scene)
    # Below the first load all is elastic, so that the order of the steps does not matter.
    first = path.advance(force=0.02)
    assert first.plastic_volume > 0.0
    forces = [0.005, 0.01, 0.015, 0.02]
    expected = [path.advance(force=force) for force in forces]

    def work(number):
        for i in range(steps // 4):
            which = (number + i) % 4
            state = path.advance(force=forces[which])
            assert abs(state.approach - expected[which].approach) < 1e-4 * 0.01, (state, expected[which])

    in_threads(4, work)
    assert abs(path.last.plastic_volume / first.plastic_volume - 1.0) < 1e-4
""")


def test_contacts_and_ensembles_in_threads():
    run("""
contacts = [fc.Bem3d().prepare(fc.Scene(rough(257), contact_modulus=1.0)) for _ in range(2)]
surface = fc.Surface.self_affine(hurst=0.6, size=1.0, rms_height=0.01)

def work(number):
    if number < 4:
        for i in range(20):
            contacts[i % 2].solve(force=0.01 * (1 + i % 3))
    else:
        scene = fc.Scene(surface, contact_modulus=1.0)
        states = fc.ensemble(fc.Bem3d(cells=129), scene, seed=1, surfaces=8, force=[0.1])
        assert len(states) == 8

in_threads(6, work)
""")


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_ctrl_c_while_another_thread_solves():
    run("""
contact = fc.Bem3d(tolerance=1e-12).prepare(fc.Scene(rough(1025, 0.3), contact_modulus=1.0))
begun = threading.Event()

def other():
    begun.set()
    for _ in range(3):
        contact.solve(force=5.0)

thread = threading.Thread(target=other)
thread.start()
begun.wait()
time.sleep(0.1)
threading.Timer(0.2, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    while True:
        contact.solve(force=5.0)
except KeyboardInterrupt:
    pass
else:
    raise AssertionError("not interrupted")
thread.join()
# Who gave up waiting is in nobody's way.
assert contact.solve(force=0.5).certificate.meets(1e-12)
""")


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
def test_a_handler_cannot_use_the_contact_that_its_thread_solves():
    run("""
contact = fc.Bem3d(tolerance=1e-12).prepare(fc.Scene(rough(1025, 0.3), contact_modulus=1.0))
signal.signal(signal.SIGALRM, lambda *_: contact.solve(force=0.01))
signal.setitimer(signal.ITIMER_REAL, 0.1)
try:
    for force in np.geomspace(1e-2, 10.0, 2000):
        contact.solve(force=force)
except RuntimeError as error:
    assert "already solving" in str(error), error
else:
    raise AssertionError("no error")
""")


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("pause", [0.02, 0.05, 0.1])
def test_many_ctrl_c_at_the_first_field(pause):
    # The first finds a solve; others come while what it had reached becomes arrays.
    code = """
contact = fc.Bem3d(tolerance=1e-10).prepare(fc.Scene(rough(513, 0.3), contact_modulus=1.0, outputs=["pressure", "gap"]))
print("ready", flush=True)
while True:
    contact.solve(force=5.0)
"""
    process = subprocess.Popen(
        [sys.executable, "-c", BEGIN + code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout.readline() == "ready\n"
    time.sleep(pause)
    for _ in range(60):
        if process.poll() is not None:
            break
        process.send_signal(signal.SIGINT)
        time.sleep(0.002)
    _, told = process.communicate(timeout=LONG)
    assert "KeyboardInterrupt" in told and "panic" not in told.lower(), told


@pytest.mark.skipif(os.name != "posix", reason="signals of POSIX")
@pytest.mark.parametrize("effect", ["hardness", "friction", "short range", "exponential"])
def test_a_path_that_ctrl_c_stops_goes_on_to_the_same_states(effect):
    run(
        f"effect = {effect!r}"
        + """
body = fc.Body(young=0.75, poisson=0.5)
law = {"work": 4e-5, "range": 3e-3, "law": "exponential"}
forces, approaches = [1e-3, 4e-3, 8e-3, 2e-3, 6e-3], [0.004, 0.012, 0.02, 0.008, 0.0]
effects, outputs, cells, key, loads = {
    "hardness": ({"hardness": 0.05}, ["stiffness", "plastic_depth"], 513, "force", forces),
    "friction": ({"friction": 0.4}, ["stiffness", "tangential_stiffness"], 129, "force", forces),
    "short range": ({"adhesion": {"work": 4e-5}}, ["stiffness"], 97, "approach", approaches),
    "exponential": ({"adhesion": law}, ["stiffness"], 257, "approach", approaches),
}[effect]
scene = fc.Scene(rough(cells), bodies=(None, body), effects=effects, outputs=outputs)

def steps():
    for i, load in enumerate(loads):
        step = {key: load, "time": float(i)}
        if effect == "friction":
            step["tangential_force"] = 1e-4 * [0.0, 1.0, 2.0, -1.0, 1.0][i]
        yield step

whole = fc.Bem3d().prepare(scene)
begun = time.monotonic()
expected = [whole.advance(**step) for step in steps()]
lasts = time.monotonic() - begun
random = np.random.default_rng(1)
stops = trial = 0
# How many trials it takes depends on the machine: a signal is looked for every 50 ms, and a step that is done before
# then is not stopped.
while stops < 6 and trial < 100 or stops == 0 and trial < 1000:
    trial += 1
    path = fc.Bem3d().prepare(scene)
    for step, wanted in zip(steps(), expected):
        signal.signal(signal.SIGALRM, signal.default_int_handler)
        signal.setitimer(signal.ITIMER_REAL, random.uniform(1e-3, lasts / 3.0))
        try:
            state = path.advance(**step)
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        except KeyboardInterrupt:
            # It may come just after the step, of which `last` tells.
            state = path.last
            if state is None or state.time < step["time"]:
                stops += 1
                state = path.advance(**step)
        assert state.to_dict() == wanted.to_dict(), (trial, step, state, wanted)
assert stops > 0
"""
    )
