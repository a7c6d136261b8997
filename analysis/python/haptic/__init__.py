"""Haptic scenes in Python: passivity certificate, simulation, stability map, and boards that run.

:func:`connect` returns a board behind a port, :func:`simulated_board` starts a board without hardware. Every
other function takes a scene in one of three forms, and none changes it:

- a dictionary of the shape of a scene file, whose numbers and lists may be NumPy's;
- the path of a scene file, TOML or JSON, as a string or a ``pathlib.Path``;
- the text of such a file. A string is a text if it has more than one line or begins with ``{``.

All numbers are in SI units and rad. The computation is that of the program ``haptic``: the same code, and the
same bits. What has no answer raises :class:`SceneError`, which names the key, its value and its bound.
"""

import json
import warnings
from collections.abc import Iterable, Mapping
from typing import Any, Literal, TypedDict

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import SceneError
from ._scene import Scene, plain, source
from .board import (
    LIMITS,
    STATES,
    Board,
    Parameters,
    SimulatedBoard,
    Streamed,
    Telemetry,
    connect,
    simulated_board,
)
from .errors import (
    BoardError,
    ConnectError,
    LinkLostError,
    ParameterError,
    RefusedError,
    StreamError,
    VersionError,
)

__all__ = [
    "LIMITS",
    "METHODS",
    "REGIONS",
    "STATES",
    "TICK_STATUSES",
    "Board",
    "BoardError",
    "ConnectError",
    "LinkLostError",
    "Motion",
    "ParameterError",
    "Parameters",
    "RefusedError",
    "Scene",
    "SceneError",
    "SimulatedBoard",
    "StreamError",
    "Streamed",
    "Telemetry",
    "VersionError",
    "certify",
    "certify_many",
    "connect",
    "index",
    "load",
    "response",
    "simulate",
    "simulated_board",
    "stability",
    "stability_map",
]

METHODS: tuple[str, ...] = tuple(_native.METHODS)
"""Methods of integration, for ``method``."""

REGIONS: tuple[str, ...] = tuple(_native.REGIONS)
"""Regions of a stability map, from the worst to the best; the place of each is its code."""

TICK_STATUSES: tuple[str, ...] = tuple(_native.TICK_STATUSES)
"""Words of ``limit`` in a motion: why a tick's torque was limited, or that the tick was missed."""


class Motion(TypedDict, total=False):
    """A simulated motion, a value a sample."""

    time: NDArray[np.float64]
    """Time in s."""
    position: NDArray[np.float64]
    """Position of the encoder's mass in rad."""
    velocity: NDArray[np.float64]
    """Its velocity in rad/s."""
    torque: NDArray[np.float64]
    """Coupling torque F in N m; the motor applies -F."""
    limit: NDArray[np.str_]
    """Why that torque was limited, one of TICK_STATUSES; ``none`` where it was not."""
    left_out: str
    """What of the scene's latency is not simulated; only where something is left out."""


def load(scene: Scene) -> dict[str, Any]:
    """Read a scene file, or its text, as a dictionary to change. Its keys and values are not checked."""
    if isinstance(scene, Mapping):
        return _object(json.dumps(plain(scene, "")))
    return _object(_native.load(source(scene)))


def certify(scene: Scene, *, format: str = "f64") -> dict[str, Any]:
    """Certify a scene: is it safe in every passive hand, and by how much?

    Returns the object of ``haptic certify --json``; ``verdict`` is certified, rejected or undecided,
    ``margin`` the damping in N m s/rad that the device may lose, None where it is not known. ``format`` is
    the number format that rounds the servo's coefficients: f64 (not rounded), f32, or 32-bit fixed point such
    as i8f24.
    """
    return _object(_native.certify(source(scene), format))


def certify_many(scenes: Iterable[Scene], *, format: str = "f64") -> list[dict[str, Any]]:
    """Certify many scenes on every core, in their order.

    A scene that cannot be read does not end the others: its result is ``{"error": sentences}``.
    """
    results: list[dict[str, Any] | None] = []
    sources = []
    for scene in scenes:
        try:
            sources.append(source(scene))
            results.append(None)
        except SceneError as error:
            results.append({"error": str(error)})
    answers = iter(_native.certify_many(sources, format))
    return [_object(next(answers)) if result is None else result for result in results]


def simulate(scene: Scene, *, method: str = "exact", substeps: int = 1) -> Motion:
    """Simulate a scene sample by sample, certified or not, as its table ``simulation`` says.

    ``method`` integrates the device over ``substeps`` steps in each tick; the servo is computed tick by tick
    in every method. A motion that grows beyond the range of numbers ends before it does, with a
    RuntimeWarning.
    """
    found = _native.simulate(source(scene), method, substeps)
    if found["overflow"] is not None:
        warnings.warn(found["overflow"], RuntimeWarning, stacklevel=2)
    position = np.frombuffer(found["position"])
    motion: Motion = {
        "time": np.arange(position.size) * found["period"],
        "position": position,
        "velocity": np.frombuffer(found["velocity"]),
        "torque": np.frombuffer(found["torque"]),
        "limit": np.array(TICK_STATUSES)[np.frombuffer(found["limit"], np.uint8)],
    }
    if found["left_out"] is not None:
        motion["left_out"] = found["left_out"]
    return motion


def stability(scene: Scene, *, method: str = "exact", substeps: int = 1) -> dict[str, Any]:
    """Judge whether a small motion dies away on this device in the hand of the table ``human``.

    Returns the object of ``haptic stability --json``: ``verdict`` (stable, unstable, marginal, undecided),
    ``spectral_radius`` with ``spectral_radius_enclosure``, and ``critical_stiffness`` and both ends
    ``stable_stiffness`` of the stable range in N m/rad, None where there is none. This is about one hand; the
    certificate is about all passive hands.
    """
    return _object(_native.stability(source(scene), method, substeps))


def index(scene: Scene, *, coupled: bool = False, format: str = "f64") -> tuple[float, float] | None:
    """Enclose the passivity index of an environment: the damping in N m s/rad that it needs from the device.

    The index is between the two numbers, proved. It is that of the environment alone (``alpha``); with
    ``coupled`` that of E', behind what the coupling has beyond the standard one (``alpha_coupled``). None if
    there is none.
    """
    return _native.index(source(scene), coupled, format)


def response(
    scene: Scene,
    theta: ArrayLike,
    *,
    of: Literal["environment", "controller", "equivalent"] = "environment",
    from_velocity: bool = False,
    format: str = "f64",
) -> NDArray[np.complex128]:
    """Compute a transfer function at angles ``theta`` (rad) of the unit circle; pi is the Nyquist frequency.

    ``of`` is the environment E alone, the total ``controller`` C behind its coupling, or the ``equivalent``
    E' that the certificate judges: torque over angle, in N m/rad. With ``from_velocity`` it is torque over
    backward-difference velocity, in N m s/rad, whose smallest real part is minus the index. On a pole the
    value is infinite or not a number.
    """
    angles = np.asarray(theta, dtype=np.float64)
    parts = _native.response(source(scene), angles.tobytes(), of, from_velocity, format)
    return np.frombuffer(parts, np.complex128).reshape(angles.shape)


def stability_map(scene: Scene, stiffness: ArrayLike, damping: ArrayLike) -> NDArray[np.uint8]:
    """Judge walls that differ from the scene's in stiffness (N m/rad) and damping (N m s/rad), on every core.

    Returns an array with a row for each damping and a column for each stiffness. Its values are codes: the
    place of the region in REGIONS. The scene's environment is a delayed-spring, a damper-wall or a
    free-mode-wall.
    """
    columns, rows = (np.atleast_1d(np.asarray(axis, np.float64)) for axis in (stiffness, damping))
    for name, axis in (("stiffness", columns), ("damping", rows)):
        if axis.ndim != 1:
            raise SceneError(f"`{name}` has {axis.ndim} dimensions; it must have one")
    codes = _native.stability_map(source(scene), columns.tobytes(), rows.tobytes())
    return np.frombuffer(codes, np.uint8).reshape(rows.size, columns.size)


def _object(text: str) -> dict[str, Any]:
    """Read an answer."""
    answer: dict[str, Any] = json.loads(text)
    return answer
