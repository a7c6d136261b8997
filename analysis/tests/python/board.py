"""A board behind a port, from Python.

    board.py TEST
"""

import math
import pathlib
import re
import socket
import struct
import sys
import threading
import time
import warnings
import zlib

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
        refuses(haptic.StreamError, "to 1000 Hz", lambda: board.stream(abs, math.nan))
        refuses(haptic.StreamError, "wall takes no torque from a host", lambda: board.stream(abs, 100))
        for wrong in ["fast", None, True]:
            refuses(haptic.ParameterError, "it must be a number", lambda: board.stream(abs, wrong))
        for wrong in [math.nan, -1]:
            refuses(haptic.ParameterError, "number of seconds", lambda: board.stream(abs, 100, duration=wrong))
    seen = []

    def spring(position, velocity, time):
        seen.append((position, velocity, time))
        return -0.5 * position

    def fails(position, velocity, time):
        raise ZeroDivisionError("of the function")

    with HostBoard() as hosted, haptic.connect(hosted.port) as board:
        board.stream(spring, rate=50.0, duration=0.01)
        assert [round(time, 9) for _, _, time in seen] == [round(0.001 * tick, 9) for tick in range(10)]
        assert np.allclose([position for position, _, _ in seen], 0.1 * np.arange(1, 11))
        hosted.wait_for(12)
        assert np.allclose(hosted.torques, [0.0, *(-0.05 * np.arange(1, 11)), 0.0], atol=1e-6), hosted.torques
        for function, kind, words in [
            (lambda *_: math.nan, haptic.StreamError, "the function returned a torque of NaN N m at "),
            (lambda *_: None, haptic.StreamError, "the function returned None at "),
            (lambda *_: board.status(), haptic.StreamError, "a stream runs on this connection"),
            (lambda *_: board.close(), haptic.StreamError, "a stream runs on this connection"),
            (fails, ZeroDivisionError, "of the function"),
            (lambda: 0.0, TypeError, "takes 0 positional arguments"),
        ]:
            hosted.torques.clear()
            try:
                board.stream(function, 50.0)
            except Exception as error:
                assert type(error) is kind and words in str(error), (words, repr(error))
            else:
                raise AssertionError(f"no error: {words}")
            hosted.wait_for(2)
            assert hosted.torques == [0.0, 0.0]
        hosted.close()
        refuses(haptic.LinkLostError, "is lost: ", lambda: board.stream(spring, 1000.0))


def pushes():
    """A stream to a simulated board moves the device in its hand; a torque that is not finite ends it."""
    host = {"energy": 0.05, "power": 0.5, "damping": 0.004, "torque": 0.5, "timeout": 0.05}
    scene = {**SCENE, "environment": {**SCENE["environment"], "stiffness": 1.0}, "host": host}
    sides = {1: [], -1: []}

    def square(position, velocity, time):
        side = 1 if time % 0.2 < 0.1 else -1
        if 0.05 < time % 0.1:
            sides[side].append(position)
        return 0.3 * side

    def warned(torque):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            streamed = board.stream(lambda *_: torque, rate=200.0, duration=0.2)
        return [str(warning.message) for warning in told], streamed

    with haptic.simulated_board(scene) as simulated, haptic.connect(simulated.port) as board:
        (idle,), streamed = warned(0.2)
        assert idle.startswith("the board is disarmed at 0 s of the stream and gives none of its torques"), idle
        # A slow machine may call it again for the torque of zero with which a stream begins.
        refused = streamed["limit"] == "ramp"
        assert refused[-1] and np.allclose(streamed["refused"], np.where(refused, 0.2, 0.0), atol=1e-3), streamed
        board.arm()
        while board.status()["state"] != "running":
            time.sleep(0.01)
        board.stream(square, rate=200.0, duration=4.0)
        # The hand's spring of 6 N m/rad, that of the wall, and 0.3 N m to both sides.
        moved = np.mean(sides[1]) - np.mean(sides[-1])
        assert len(sides[1]) > 100 and 0.05 < moved < 0.11, (len(sides[1]), moved)
        refuses(haptic.StreamError, "returned a torque of NaN", lambda: board.stream(lambda *_: math.nan, 100))
        assert warned(-0.5)[0] == []
        (above,), streamed = warned(-0.8)
        assert above.startswith("the function returned a torque of -0.8 N m at 0 s; the board gives at most the 0.5 N m")
        clipped = streamed["limit"] == "torque"
        assert clipped.any() and np.allclose(streamed["refused"][clipped], -0.3, atol=2e-3), streamed
        pumped = board.stream(lambda _, velocity, time: math.copysign(0.5, velocity), 200, duration=1.0)
        assert len({len(column) for column in pumped.values()}) == 1 and set(pumped["state"]) == {"running"}
        limited = pumped["limit"] == "energy"
        assert limited.any() and (np.abs(pumped["refused"][limited]) > 0.0).all(), pumped
        assert 0.0 <= pumped["energy"].min() < 0.04 and np.abs(pumped["torque"]).max() < 0.501, pumped
        refuses(haptic.RefusedError, "share of damping", lambda: board.parameters.update(stiffness=10, damping=0.01))
        assert board.status()["state"] == "running"
        board.disarm()
    greedy = {**scene, "host": {**host, "damping": 0.03}}
    try:
        haptic.simulated_board(greedy)
    except haptic.SceneError as error:
        assert "share of damping is 0.03 N m s/rad" in str(error), error
    else:
        raise AssertionError("it was not refused")


class HostBoard(threading.Thread):
    """A board that takes torques, by PROTOCOL.md: it moves by a count, 0.1 rad, in each tick that takes one."""

    def __init__(self):
        super().__init__(daemon=True)
        self.server = socket.create_server(("127.0.0.1", 0))
        self.port = f"tcp://127.0.0.1:{self.server.getsockname()[1]}"
        self.torques = []
        self.ticks = 0

    def __enter__(self):
        self.start()
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self.is_over = True
        self.join()

    is_over = False

    def run(self):
        line, _ = self.server.accept()
        line.settimeout(0.01)
        received = b""
        while not self.is_over:
            try:
                received += line.recv(4096)
            except TimeoutError:
                continue
            *frames, received = received.split(b"\0")
            for encoded in filter(None, frames):
                line.sendall(b"".join(map(framed, self.answers(unframed(encoded)))))
        line.close()
        self.server.close()

    def answers(self, message):
        if message == bytes([0]):
            return [
                bytes([0]) + varint(protocol()) + b"\x06hosted",
                bytes([8, 0]) + struct.pack("<5d", 0.05, 0.5, 0.004, 0.5, 0.05),
                bytes([1]) + struct.pack("<d", 1e-3) + varint(1000) + struct.pack("<4d", 20 * math.pi, 2, 1e-6, 0),
            ]
        if message[:2] != bytes([9, 0]):
            return []
        # The command's number is as many bytes as say that another follows, and one.
        end = next(at for at in range(2, 5) if message[at] < 0x80) + 1
        self.torques.append(struct.unpack_from("<f", message, end)[0])
        self.ticks += 1
        state = varint(self.ticks) + varint(2 * self.ticks) + struct.pack("<4f", 100.0, 0.04, 0.0, 0.0)
        return [bytes([8, 1]) + message[2:end] + state + bytes([0, 2, 0])]

    def wait_for(self, torques):
        end = time.monotonic() + 10
        while len(self.torques) < torques and time.monotonic() < end:
            time.sleep(0.001)


def protocol():
    """The version of the protocol, from its document."""
    document = pathlib.Path(__file__).parents[3] / "firmware/PROTOCOL.md"
    return int(re.search(r"\| `PROTOCOL` \| (\d+) \|", document.read_text())[1])


def varint(number):
    encoded = []
    while number > 0x7F:
        encoded.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*encoded, number])


def framed(message):
    """A message that is shorter than a block of 254 bytes."""
    pieces = (message + struct.pack("<I", zlib.crc32(message))).split(b"\0")
    return b"\0" + b"".join(bytes([len(piece) + 1]) + piece for piece in pieces) + b"\0"


def unframed(encoded):
    pieces = []
    while encoded:
        pieces.append(encoded[1 : encoded[0]])
        encoded = encoded[encoded[0] :]
    checked = b"\0".join(pieces)
    assert struct.unpack("<I", checked[-4:])[0] == zlib.crc32(checked[:-4])
    return checked[:-4]


{test.__name__: test for test in (tunes, records, is_no_board, is_lost, streams, pushes)}[sys.argv[1]]()
