"""A board behind a port: armed, tuned, watched, and driven by torques from here."""

import json
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from types import TracebackType
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

from . import _native
from ._scene import Scene, source
from .errors import ParameterError

STATES: tuple[str, ...] = tuple(_native.STATES)
"""Words of ``state`` in telemetry."""

LIMITS: tuple[str, ...] = tuple(_native.LIMITS)
"""Words of ``limit`` in telemetry: why a torque was limited."""


class Telemetry(TypedDict):
    """The ticks of a board, a value a tick."""

    tick: NDArray[np.int64]
    """Periods since the board's servo started."""
    time: NDArray[np.float64]
    """The same in s."""
    position: NDArray[np.float64]
    """Angle in rad."""
    torque: NDArray[np.float64]
    """Torque of the servo in N m; the motor applies its negative."""
    state: NDArray[np.str_]
    """State of the servo, one of STATES."""
    limit: NDArray[np.str_]
    """Why the torque was limited, one of LIMITS; ``none`` where it was not."""
    slack: NDArray[np.float64]
    """Time in s that was left of the period."""


class Streamed(TypedDict):
    """What became of the torques of a stream, a value for each call of its function."""

    time: NDArray[np.float64]
    """Time in s since the beginning."""
    position: NDArray[np.float64]
    """Angle in rad."""
    velocity: NDArray[np.float64]
    """Velocity in rad/s."""
    torque: NDArray[np.float64]
    """Torque in N m that the board gave of the call before; the first, of the torque before this stream."""
    refused: NDArray[np.float64]
    """Torque in N m that it did not give of that."""
    energy: NDArray[np.float64]
    """Energy in J that the budget had left."""
    limit: NDArray[np.str_]
    """Why it was refused, one of LIMITS: ``energy`` where the budget was spent, ``torque`` above ``host.torque``,
    ``ramp`` while the servo does not run."""
    state: NDArray[np.str_]
    """State of the servo, one of STATES: it gives none unless it runs."""


class Parameters(MutableMapping[str, float]):
    """The parameters that run on a board, by name, in SI units.

    Each look reads the board. Setting one waits until it runs; :meth:`update` changes several together, all or
    none. The board certifies a change first: :class:`RefusedError` has its reason and the bound. None can be
    deleted.
    """

    def __init__(self, connection: _native.Connection) -> None:
        self._connection = connection

    def __getitem__(self, name: str) -> float:
        values = dict(self._connection.parameters())
        if name not in values:
            names = ", ".join(values)
            raise ParameterError(f"there is no parameter `{name}` on this board; its parameters are {names}")
        return values[name]

    def __setitem__(self, name: str, value: float) -> None:
        self.update({name: value})

    def __delitem__(self, name: str) -> None:
        raise ParameterError(f"`{name}` is a part of the board's program and cannot be deleted")

    def __iter__(self) -> Iterator[str]:
        return (name for name, _ in self._connection.parameters())

    def __len__(self) -> int:
        return len(self._connection.parameters())

    def update(self, *changes: Mapping[str, float], **named: float) -> None:  # type: ignore[override]
        """Change parameters together, all or none, and wait until they run."""
        together = [(name, _number(name, value)) for name, value in dict(*changes, **named).items()]
        if together:
            self._connection.set(together)

    def __repr__(self) -> str:
        return repr(dict(self._connection.parameters()))


class Board:
    """A connected board, which :func:`connect` returns. Its ``with`` block closes the connection at its end.

    Closing changes nothing on the board: an armed board stays armed.
    """

    def __init__(self, port: str) -> None:
        self._connection = _native.Connection(port)
        self.port = port
        """The port, as it was given."""
        self.program, self.period = self._connection.identity()
        """Name of the board's program, and the period of its servo in s."""

    def __enter__(self) -> "Board":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the connection."""
        self._connection.close()

    @property
    def parameters(self) -> Parameters:
        """The parameters that run, as a mapping: read, set, update."""
        return Parameters(self._connection)

    @parameters.setter
    def parameters(self, values: Mapping[str, float]) -> None:
        self.parameters.update(values)

    def status(self) -> dict[str, Any]:
        """Return the object of ``haptic tune --json``: state, fault, margin, energy, losses and more."""
        status: dict[str, Any] = json.loads(self._connection.status())
        return status

    def arm(self) -> None:
        """Switch the amplifier on; clears a fault. The torque fades in."""
        self._connection.arm()

    def disarm(self) -> None:
        """Fade the torque out and switch the amplifier off."""
        self._connection.disarm()

    def align(self) -> None:
        """Begin to align the brushless motor of a motor board, which turns the handle."""
        self._connection.align()

    def telemetry(self, seconds: float, *, every: int | None = None) -> Telemetry:
        """Record for some seconds: every n-th tick, by default as many as a serial line carries."""
        if every is not None and not 1 <= every < 2**32:
            raise ParameterError(f"`every` = {every} is out of bounds; it must be from 1 to {2**32 - 1}")
        found = self._connection.telemetry(_number("seconds", seconds), every or 0)
        return {
            "tick": np.frombuffer(found["tick"]).astype(np.int64),
            "time": np.frombuffer(found["time"]),
            "position": np.frombuffer(found["position"]),
            "torque": np.frombuffer(found["torque"]),
            "state": np.array(STATES)[np.frombuffer(found["state"], np.uint8)],
            "limit": np.array(LIMITS)[np.frombuffer(found["limit"], np.uint8)],
            "slack": np.frombuffer(found["slack"]),
        }

    def stream(
        self,
        function: Callable[[float, float, float], float],
        rate: float,
        *,
        duration: float = float("inf"),
        smooth: bool = True,
    ) -> Streamed:
        """Drive the motor with the torques that a function returns, ``rate`` times a second.

        ``function(position, velocity, time)`` gets rad, rad/s and s since the beginning, and returns a torque
        in N m, positive towards positive angles. The board adds it to the torque of its scene, within the
        energy budget of its program, and at most ``host.torque`` of it: a UserWarning tells the first torque above
        that, and a board that is not armed. With ``smooth`` it moves along a line from torque to torque.

        It ends after ``duration`` seconds, at an exception of the function, which is raised again, and at a
        torque that is not finite (:class:`StreamError`); the torque is then zero. If this program hangs, the
        board fades the torque out by itself. No other call of this connection is possible meanwhile.
        """
        rate, duration = _number("rate", rate), _number("duration", duration)
        if not duration >= 0.0:
            raise ParameterError(f"`duration` = {duration} is out of bounds; it must be a number of seconds from 0")
        found = self._connection.stream(function, rate, duration, smooth)
        return {
            "time": np.frombuffer(found["time"]),
            "position": np.frombuffer(found["position"]),
            "velocity": np.frombuffer(found["velocity"]),
            "torque": np.frombuffer(found["torque"]),
            "refused": np.frombuffer(found["refused"]),
            "energy": np.frombuffer(found["energy"]),
            "limit": np.array(LIMITS)[np.frombuffer(found["limit"], np.uint8)],
            "state": np.array(STATES)[np.frombuffer(found["state"], np.uint8)],
        }


class SimulatedBoard:
    """A simulated board at ``port``, which :func:`simulated_board` returns; it ends with its ``with`` block."""

    def __init__(self, scene: Scene) -> None:
        self._board = _native.Simulated(source(scene))
        self.port = self._board.port
        """The address for :func:`connect`, and for ``haptic scope --port``."""

    def __enter__(self) -> "SimulatedBoard":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End it: its port is then lost."""
        self._board.close()


def connect(port: str) -> Board:
    """Connect to a board: ``/dev/ttyACM0`` (``@BAUD``), ``COM3``, ``tcp://HOST:PORT`` or ``unix:PATH``.

    One program at a time can have a board. :class:`ConnectError` has the reason if there is no board.
    """
    return Board(port)


def simulated_board(scene: Scene) -> SimulatedBoard:
    """Start a board without hardware: the servo of this scene, its device, and a hand that moves it to and fro.

    A scene with the table ``host`` takes the torques of :meth:`Board.stream` within its budget.

    It runs in this process at the rate of a real board. A scene that does not certify or that no board renders
    raises :class:`SceneError`. Encoder and motor are those of the scene, or the defaults of a simulation.
    """
    return SimulatedBoard(scene)


def _number(name: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float, np.number)):
        raise ParameterError(f"`{name}` = {value!r} is a {type(value).__name__}; it must be a number")
    try:
        return float(value)
    except OverflowError:
        raise ParameterError(f"`{name}` is out of bounds; it must be a finite number") from None
