"""A board behind a port, from Python.

    board.py TEST
"""

import math
import socket
import sys
import threading

import haptic
import numpy as np

SCENE = {
    "name": "wall",
    "device": {"inertia": 2.2e-5, "damping": 0.022},
    "servo": {"period": 0.001},
    "coupling": {"stiffness": 44.0},
    "environment": {"type": "damper-wall", "stiffness": 20.0, "damping": 0.005, "delay": 1},
    "limits": {"torque": 1.0},
}


def refuses(kind, words, call):
    """The call raises an error of this kind, whose sentence has these words."""
    try:
        answer = call()
    except haptic.BoardError as error:
        assert type(error) is kind and words in str(error), (kind, words, repr(error))
        return
    raise AssertionError(f"no error: {words}: {answer}")


def tunes():
    with haptic.simulated_board(SCENE) as simulated, haptic.connect(simulated.port) as board:
        assert (board.program, board.period) == ("wall", 0.001)
        assert board.status()["state"] == "disarmed"
        parameters = board.parameters
        assert parameters["stiffness"] == 20.0 and "damping" in parameters and "drag" not in parameters
        parameters["stiffness"] = np.float64(12.5)
        parameters.update(stiffness=15, damping=0.004)
        assert (parameters["stiffness"], parameters["damping"]) == (15.0, 0.004)
        assert len(parameters) == len(list(parameters)) and board.status()["sets"] == 2
        refuses(haptic.RefusedError, "stiffness=40: rejected: ", lambda: parameters.update(stiffness=40))
        refuses(haptic.RefusedError, "it would pass with stiffness <= ", lambda: parameters.update(stiffness=40))
        for words, call in [
            ("there is no parameter `stifness` on this board; its parameters are ", lambda: parameters["stifness"]),
            ("there is no parameter `drag` on this board; ", lambda: parameters.update(drag=1)),
            ("`damping` = NaN is out of bounds; it must be a finite", lambda: parameters.update(damping=math.nan)),
            ("`damping` = 'soft' is a str; it must be a number", lambda: parameters.update(damping="soft")),
            ("`damping` is a part of the board's program", lambda: parameters.pop("damping")),
        ]:
            refuses(haptic.ParameterError, words, call)
        assert (parameters["stiffness"], parameters["damping"]) == (15.0, 0.004)
        board.arm()
        assert board.status()["state"] in ("fading-in", "running")
        board.disarm()
        assert board.status()["state"] == "disarmed"


def records():
    with haptic.simulated_board(SCENE) as simulated, haptic.connect(simulated.port) as board:
        board.arm()
        motion = board.telemetry(1.0, every=2)
        assert motion["tick"].size > 100 and set(np.diff(motion["tick"])) == {2}
        assert np.allclose(motion["time"], 0.001 * motion["tick"])
        assert motion["position"].dtype == motion["torque"].dtype == np.float64
        assert np.abs(motion["torque"]).max() <= 1.0
        assert set(motion["state"]) <= {"fading-in", "running"} and set(motion["limit"]) <= set(haptic.LIMITS)
        refuses(haptic.ParameterError, "`every` = 0 is out of bounds", lambda: board.telemetry(1.0, every=0))
        refuses(haptic.ParameterError, "`seconds` = -1 is out of bounds", lambda: board.telemetry(-1))


def is_no_board():
    refuses(haptic.ConnectError, "cannot open unix:/nowhere/board: ", lambda: haptic.connect("unix:/nowhere/board"))
    refuses(haptic.ConnectError, "the port is empty", lambda: haptic.connect(""))
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        refuses(haptic.ConnectError, f"no board answers on {port}", lambda: haptic.connect(port))
    rejected = {**SCENE, "environment": {**SCENE["environment"], "stiffness": 4000.0}}
    try:
        haptic.simulated_board(rejected)
    except haptic.SceneError as error:
        assert "wall: refused by its certificate: " in str(error), error
    else:
        raise AssertionError("it was not refused")


def is_lost():
    with haptic.simulated_board(SCENE) as simulated, haptic.connect(simulated.port) as board:
        refuses(haptic.ConnectError, "is in use by another program", lambda: haptic.connect(simulated.port))
        threading.Timer(0.3, simulated.close).start()
        refuses(haptic.LinkLostError, "is lost: ", lambda: board.telemetry(20.0))
        refuses(haptic.LinkLostError, "is lost: ", board.status)
    refuses(haptic.LinkLostError, "the connection to the board is closed: connect again", board.arm)


def streams():
    with haptic.simulated_board(SCENE) as simulated, haptic.connect(simulated.port) as board:
        refuses(haptic.StreamError, "the rate of a stream is 0 Hz; ", lambda: board.stream(abs, 0))
        refuses(haptic.StreamError, "at most 1000 Hz", lambda: board.stream(abs, math.nan))
        refuses(haptic.StreamError, "wall takes no torque from a host", lambda: board.stream(abs, 100))


{test.__name__: test for test in (tunes, records, is_no_board, is_lost, streams)}[sys.argv[1]]()
