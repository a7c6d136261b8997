"""Verdicts and a motion of `haptic bench` by packages of Python.

Reads a line of JSON that describes the work. Answers `about PACKAGE` with its version and method, `seconds
PACKAGE` with the time of all work, and `values PACKAGE` with the results: 1 for passive, 0 for not passive, nan
for neither; or positions, velocities and torques. The answer for a missing package begins with `unavailable: `.
"""

import json
import sys
import time
from importlib.metadata import version

WORK = json.loads(sys.stdin.readline())
PERIOD, DELTA = WORK["period"], WORK["delta"]


def companion_roots():
    """The index is the least real part at the zeros of its derivative over the cosine, and at the ends."""
    import numpy as np
    from numpy.polynomial import chebyshev as ch

    def cosines(a, b, shift):
        """Cosine series of the real part of `z^shift a(z) conj(b(z))` on the circle."""
        powers = np.arange(len(a) - 1, -len(b), -1) + shift
        series = np.zeros(np.abs(powers).max() + 1)
        np.add.at(series, np.abs(powers), np.convolve(a, b[::-1]))
        return series

    def verdict(numerator, denominator, delay):
        # z/(z - 1) is (1 - z)/(2 - 2 cos) on the circle.
        p = PERIOD * cosines(np.convolve(numerator, [-1.0, 1.0]), denominator, -delay)
        p = ch.chebdiv(p, [2.0, -2.0])[0]
        r = cosines(denominator, denominator, 0)
        slope = ch.chebsub(ch.chebmul(ch.chebder(p), r), ch.chebmul(p, ch.chebder(r)))
        slope = ch.chebtrim(slope, 1e-14 * np.abs(slope).max())
        found = ch.chebroots(slope) if len(slope) > 1 else np.zeros(0)
        found = found.real[np.abs(found.imag) < 1e-6]
        cosine = np.concatenate([found[np.abs(found) < 1.0], [-1.0, 1.0]])
        return passive(-np.min(ch.chebval(cosine, p) / ch.chebval(cosine, r)))

    scenes = [(np.array(n), np.array(d), delay) for n, d, delay in WORK["environments"]]
    return each(verdict, scenes)


def bounded_real():
    """Passive if the Cayley transform of `1 + L/delta` has a norm below 1: SLICOT's AB13DD."""
    import numpy as np
    from slycot import ab13dd

    def system(a, b, c, d):
        c, d = c / DELTA, d / DELTA + 1.0
        k = 1.0 / (1.0 + d[0, 0])
        return a - k * b @ c, b * k, 2.0 * k * c, np.array([[1.0 - 2.0 * k]])

    def verdict(a, b, c, d):
        n = len(a)
        norm, _ = ab13dd("D", "I", "N", "D", n, 1, 1, a, np.eye(n), b, c, d)
        return float(norm < 1.0) if np.isfinite(norm) else float("nan")

    systems = [system(*one) for one in state_spaces()]
    return each(verdict, systems)


def matrix_inequality():
    """The index as the solution of a linear matrix inequality."""
    import control
    import cvxopt  # noqa: F401  control reports its absence late

    systems = [(control.ss(*one, PERIOD),) for one in state_spaces()]
    return each(lambda system: passive(-control.get_input_ff_index(system)), systems)


def passive(alpha):
    return float("nan") if alpha != alpha else float(alpha < DELTA)


def each(verdict, systems):
    """The verdicts; none where a package gives up."""

    def attempt(system):
        try:
            return verdict(*system)
        except (ArithmeticError, RuntimeError, ValueError):
            return float("nan")

    return lambda: [attempt(system) for system in systems]


def state_spaces():
    """`L` without its integrator, whose real part is constant, in companion form."""
    import numpy as np

    for numerator, denominator, delay in WORK["environments"]:
        numerator = np.concatenate([np.zeros(delay), numerator])
        denominator = np.concatenate([denominator, np.zeros(delay)])
        if len(denominator) == 1:
            # One state at least: a pole at zero that cancels.
            numerator, denominator = np.append(numerator, 0.0), np.append(denominator, 0.0)
        at_one = numerator.sum() / denominator.sum()
        quotient, _ = np.polydiv(numerator - at_one * denominator, [1.0, -1.0])
        proper = np.zeros(len(denominator))
        proper[len(denominator) - 1 - len(quotient) : -1] = PERIOD * quotient
        n = len(denominator) - 1
        a = np.eye(n, k=-1)
        a[0] = -denominator[1:]
        c = proper[1:] - proper[0] * denominator[1:]
        yield a, np.eye(n, 1), c.reshape(1, n), np.array([[proper[0] + 0.5 * PERIOD * at_one]])


def dlsim():
    """The motion of steps.rs, sample by sample."""
    import numpy as np
    from scipy.signal import dlsim, dlti

    slide, decay, to_position, to_velocity, stiffness, compliance, start = WORK["motion"]
    a = [
        [1.0, slide, -to_position],
        [0.0, decay, -to_velocity],
        [stiffness, 0.0, -stiffness * compliance],
    ]
    loop = dlti(a, np.zeros((3, 1)), np.eye(3), np.zeros((3, 1)), dt=PERIOD)
    still = np.zeros((WORK["steps"], 1))
    return lambda: dlsim(loop, still, x0=[start, 0.0, 0.0])[1].T.ravel()


PEERS = {
    "numpy": (companion_roots, ["numpy"], "companion matrix"),
    "slycot": (bounded_real, ["slycot"], "AB13DD"),
    "python-control": (matrix_inequality, ["control", "cvxopt"], "get_input_ff_index"),
    "scipy": (dlsim, ["scipy"], "signal.dlsim"),
}
prepared = {}


def answer(request, name):
    prepare, packages, method = PEERS[name]
    if name not in prepared:
        prepared[name] = prepare()
    work = prepared[name]
    if request == "about":
        return ", ".join(f"{package} {version(package)}" for package in packages) + ", " + method
    # The second run counts, so that the caches are filled.
    work()
    begin = time.perf_counter()
    results = work()
    seconds = time.perf_counter() - begin
    return repr(seconds) if request == "seconds" else " ".join(repr(float(one)) for one in results)


for line in sys.stdin:
    try:
        print(answer(*line.split()), flush=True)
    except ImportError as error:
        print(f"unavailable: {error}", flush=True)
