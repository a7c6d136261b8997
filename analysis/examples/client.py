#!/usr/bin/env python3
"""A client of a haptic board: firmware/PROTOCOL.md in Python's standard library.

    client.py PORT status | get | describe | arm | disarm | align
    client.py PORT set NAME=VALUE [NAME=VALUE ...]
    client.py PORT stream TICKS EVERY

PORT is unix:PATH, tcp://HOST:PORT, or a serial port such as /dev/ttyACM0 (that one needs pyserial).
Answers are JSON, one object a line. Exit status: 0 done, 1 refused, 2 anything else.
"""

import json
import random
import socket
import struct
import sys
import time
import zlib

PROTOCOL = 10
BAUD = 460800

RESETS = ["unknown", "power-on", "brown-out", "pin", "software", "independent-watchdog",
          "window-watchdog", "low-power", "option-bytes"]
STATES = ["disarmed", "fading-in", "running", "fading-out", "settling", "faulted", "aligning"]
LIMITS = ["none", "torque", "converter", "angle", "not-a-number", "ramp", "heat", "energy"]
FAULTS = {1: "missed-tick", 2: "encoder-jump", 3: "not-a-number", 5: "link-lost",
          6: "watchdog", 7: "panic", 8: "hard-fault", 9: "late-tick", 10: "clock-lost",
          11: "flash-ecc", 12: "ram-parity", 13: "non-maskable", 14: "over-current",
          15: "over-voltage", 16: "under-voltage", 17: "over-temperature", 18: "current-offset",
          19: "current-not-following", 20: "saturated-duty", 21: "index-mismatch",
          22: "current-interrupt-late", 23: "not-aligned", 24: "alignment-not-needed",
          25: "alignment-blocked", 26: "alignment-pole-pairs", 27: "alignment-not-returned",
          28: "alignment-uneven", 29: "thermistor", 30: "comparator", 31: "index-offset",
          32: "encoder-reading"}
# The parameters that can be changed, by their numbers on the wire.
PARAMETERS = {5: "coupling.stiffness", 6: "stiffness", 7: "damping", 8: "filter", 10: "face",
              11: "residual", 15: "torque_limit", 23: "torque", 24: "count", 25: "centre",
              28: "mode", 36: "drag"}

# Messages to the board and to the host, by number.
HELLO, GET, STATUS, SET, ARM, DISARM, STREAM, DESCRIBE, ALIGN = range(9)
TO_HOST = ["welcome", "board", "running", "status", "answer", "remembered", "telemetry",
           "described"]

# The fields of the messages in order. A field more in the protocol is a line more here.
DISCARDED = [("broken", "u"), ("too_long", "u"), ("checksum", "u"), ("unknown", "u")]
FAULT = [("code", "u"), ("first", "u"), ("second", "u")]
POWER = [("current", "i"), ("reference", "i"), ("voltage", "u"), ("temperature", "i"),
         ("index", ("option", [("counts", "u"), ("is_reversed", "bool")]))]
STEP = ("enum", [("change", []), ("certificate", []), ("servo", [])])
REFUSAL = ("enum", [("busy", []), ("disarming", []), ("fault", [("fault", FAULT)]),
                    ("set", [("step", STEP)]),
                    ("not-aligning", [("fault", ("option", FAULT))])])
CANCELLER = [("residual", "f64"), ("delay", "u")]
DRAG = [("damping", "f64"), ("delay", "u")]
DAMPER = [("damping", "f64"), ("filter", ("option", "f64"))]
SIDE = ("enum", [("centred", []), ("displaced", [("position", "f64")]),
                 ("face", [("position", "f64")])])
WALL = [("stiffness", "f64"), ("damper", ("option", DAMPER)), ("side", SIDE), ("delay", "u")]
STATED = ("enum", [("bounded", [("delay", "u"), ("index", "f64"), ("gain", "f64")])])
OUTLINE = [("knots", "u"), ("rise", "i"), ("fall", "i"), ("wraps", "bool"), ("sum", "i"),
           ("is_odd", "bool")]
PROFILE = [("table", [("outline", OUTLINE)]),
           ("torque", "f64"), ("count", "f64"), ("centre", "f64"),
           ("ends", ("option", [("from", "f64"), ("to", "f64"), ("stiffness", "f64")])),
           ("damping", ("option", "f64")), ("delay", "u"),
           ("snap", ("option", [("pitches", "f64"), ("offset", "f64"), ("share", "f64"),
                                ("snap", "f64")])),
           ("modes", ("option", [("mode", "f64"), ("count", "u")]))]
TIME_RANGE = [("least", "f64"), ("most", "f64")]
SCENE = [
    ("device", [("inertia", "f64"), ("damping", "f64"), ("passivity", ("option", "f64"))]),
    ("timing", [("period", "f64"), ("worst_period", ("option", "f64"))]),
    ("coupling", ("enum", [("rigid", []), ("spring", [("stiffness", "f64")]), ("matched", [])])),
    ("environment", ("enum", [("parts", [("canceller", ("option", CANCELLER)),
                                         ("wall", ("option", WALL)),
                                         ("profile", ("option", PROFILE)),
                                         ("drag", ("option", DRAG))]),
                              ("stated", [("model", STATED)])])),
    ("latency", [("output_delay", TIME_RANGE), ("output_jitter", "f64"),
                 ("count_jitter", "f64"), ("actuator_lag", TIME_RANGE),
                 ("sensor_lag", TIME_RANGE), ("actuator_response", TIME_RANGE),
                 ("actuator_updates", "u")]),
    ("torque_limit", ("option", "f64")),
]
FIELDS = {
    "welcome": [("protocol", "u"), ("program", "text")],
    "board": [("period", "f64"), ("timer_counts", "u"), ("counts_per_turn", "f64"),
              ("full_scale_torque", "f64"), ("energy_step", "f64"),
              ("longest_gap", "f64")],
    "running": [("sets", "u"), ("margin", ("option", "f64")),
                ("values", ("list", [("parameter", "u"), ("value", "f64")]))],
    "status": [
        ("state", "u"),
        ("fault", ("option", FAULT)),
        ("link_lost", "bool"),
        ("tick", "u"),
        ("count", "i"),
        ("sets", "u"),
        ("missed", "u"),
        ("worst_slack", "u"),
        ("energy", "i"),
        ("worst_deficit", "i"),
        ("dropped", "u"),
        ("thinned", "u"),
        ("discarded", DISCARDED),
        ("stack_left", ("option", "u")),
        ("reset", "u"),
        ("low_brown_out", "bool"),
        ("power", ("option", POWER)),
    ],
    "remembered": [("fault", FAULT), ("tick", "u"), ("count", "i")],
    "telemetry": [("ticks", ("list", [("later", "u"), ("moved", "i"), ("code", "u"),
                                      ("limit", "u"), ("state", "u"), ("slack", "u")]))],
    "described": [
        ("scene", SCENE),
        ("transducers", [("counts_per_turn", "f64"), ("counter", ("enum", [("32", []), ("16", [])])),
                         ("full_scale_torque", "f64"), ("largest_speed", "f64")]),
        ("rendering", [("fade", "f64"), ("injection", ("option", "f64")),
                       ("returned", ("option", "f64"))]),
        ("format", ("enum", [("f32", []), ("f64", []), ("fixed", [("fraction_bits", "u")]),
                             ("truncated", [("fraction_bits", "u")])])),
        ("timing", ("enum", [("simultaneous", []), ("latched", []),
                             ("at_phase", [("nanoseconds", "u")])])),
    ],
}


class Refused(Exception):
    """The board's reason, as `REFUSAL` has it."""

    def __str__(self):
        reason = self.args[0]
        if reason["type"] == "set":
            return f"refused by its {reason['step']['type']}; `haptic tune` says why"
        if reason["type"] == "fault":
            return f"refused: {named(reason['fault'])['name']} is still there"
        return f"refused: {reason['type']}"


def varint(number):
    out = bytearray()
    while number > 0x7F:
        out.append(number & 0x7F | 0x80)
        number >>= 7
    out.append(number)
    return bytes(out)


def frame(message):
    """Checksum behind, COBS around, a zero on either side."""
    checked = message + struct.pack("<I", zlib.crc32(message))
    out = bytearray([0])
    for piece in checked.split(b"\0"):
        while len(piece) >= 254:
            out += b"\xff" + piece[:254]
            piece = piece[254:]
        out.append(len(piece) + 1)
        out += piece
    return bytes(out + b"\0")


def unframe(encoded):
    """The message between two zeros; None where it is none."""
    checked = bytearray()
    while encoded:
        length, encoded = encoded[0], encoded[1:]
        if len(encoded) < length - 1:
            return None
        checked += encoded[: length - 1]
        encoded = encoded[length - 1 :]
        if length < 255 and encoded:
            checked.append(0)
    message, checksum = bytes(checked[:-4]), bytes(checked[-4:])
    return message if message and checksum == struct.pack("<I", zlib.crc32(message)) else None


class Reader:
    """Takes values from a message, the first byte first."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, count):
        piece = self.data[self.at : self.at + count]
        if len(piece) < count:
            raise ValueError("the message ends too early: another version of the protocol?")
        self.at += count
        return piece

    def value(self, kind):
        if isinstance(kind, list):
            return {name: self.value(of) for name, of in kind}
        if isinstance(kind, tuple):
            what, of = kind
            if what == "option":
                return self.value(of) if self.value("bool") else None
            if what == "enum":
                name, fields = of[self.value("u")]
                return {"type": name} | self.value(fields)
            return [self.value(of) for _ in range(self.value("u"))]
        if kind == "f64":
            return struct.unpack("<d", self.take(8))[0]
        if kind == "bool":
            return self.take(1) != b"\0"
        if kind == "text":
            return self.take(self.value("u")).decode()
        number = shift = 0
        while True:
            byte = self.take(1)[0]
            number |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                break
        return number if kind == "u" else (number >> 1) ^ -(number & 1)


def decode(message):
    """Name and content of a message to the host."""
    reader = Reader(message)
    name = TO_HOST[reader.value("u")]
    if name == "answer":
        content = {"id": reader.value("u"), "refused": None}
        if reader.value("u"):
            content["refused"] = reader.value(REFUSAL)
    else:
        content = reader.value(FIELDS[name])
    if reader.at != len(message):
        raise ValueError(f"{name} has bytes left over: another version of the protocol?")
    return name, content


class Board:
    """A board that has said who it is."""

    def __init__(self, port):
        self.read, self.write = connect(port)
        self.received = b""
        # An answer to an earlier client's request is not taken for ours.
        self.id = random.randrange(1 << 16)
        self.remembered = None
        welcome = self.ask([HELLO], "welcome")
        if welcome["protocol"] != PROTOCOL:
            raise ValueError(f"the board speaks version {welcome['protocol']}, not {PROTOCOL}")
        self.program = welcome["program"]
        # What was `remembered` comes in between, and `receive` keeps it.
        self.facts = self.receive("board", time.monotonic() + 3)

    def receive(self, wanted, until, matches=lambda content: True):
        """The next message of this name before the time is up; None without one."""
        while True:
            while b"\0" in self.received:
                encoded, self.received = self.received.split(b"\0", 1)
                message = unframe(encoded)
                if message is None:
                    continue
                name, content = decode(message)
                if name == "remembered":
                    self.remembered = content
                if name == wanted and matches(content):
                    return content
            if time.monotonic() >= until:
                return None
            self.received += self.read()

    def ask(self, message, wanted, again=0.25, end=3.0, matches=lambda content: True):
        """Asks until there is an answer: bytes get lost on a line."""
        over = time.monotonic() + end
        while time.monotonic() < over:
            self.write(frame(bytes(message)))
            content = self.receive(wanted, min(time.monotonic() + again, over), matches)
            if content is not None:
                return content
        raise TimeoutError(f"no answer within {end} s")

    def request(self, kind, payload=b""):
        """Waits until it is done; the board certifies and fades in the meantime."""
        self.id = (self.id + 1) % (1 << 16)
        message = bytes([kind]) + varint(self.id) + payload
        mine = lambda content: content["id"] == self.id
        answer = self.ask(message, "answer", again=2.0, end=10.0, matches=mine)
        if answer["refused"] is not None:
            raise Refused(answer["refused"])

    def status(self):
        status = self.ask([STATUS], "status")
        status["state"] = STATES[status["state"]]
        status["reset"] = RESETS[status["reset"]]
        return status | {"fault": named(status["fault"])}

    def running(self):
        running = self.ask([GET], "running")
        values = {PARAMETERS[pair["parameter"]]: pair["value"] for pair in running["values"]}
        return running | {"values": values}

    def description(self):
        return self.ask([DESCRIBE], "described")

    def set(self, changes):
        numbers = {name: number for number, name in PARAMETERS.items()}
        pairs = [bytes([numbers[name]]) + struct.pack("<d", value) for name, value in changes]
        self.request(SET, varint(len(pairs)) + b"".join(pairs))

    def stream(self, ticks, every):
        """So many ticks with angle in rad and the motor's torque in N m."""
        self.write(frame(bytes([STREAM, 1]) + varint(every)))
        scale = self.facts["full_scale_torque"] / 1791
        turn = 6.283185307179586 / self.facts["counts_per_turn"]
        while ticks > 0:
            batch = self.receive("telemetry", time.monotonic() + 3)
            if batch is None:
                raise TimeoutError("the stream has ended")
            tick = count = 0
            for one in batch["ticks"][:ticks]:
                tick = (tick + one["later"]) % (1 << 32)
                count = (count + one["moved"] + (1 << 31)) % (1 << 32) - (1 << 31)
                yield {"tick": tick, "angle": count * turn, "torque": (one["code"] - 2048) * scale,
                       "limit": LIMITS[one["limit"]], "state": STATES[one["state"]],
                       "slack": one["slack"]}
            ticks -= len(batch["ticks"])
        self.write(frame(bytes([STREAM, 0])))


def named(fault):
    return fault and fault | {"name": FAULTS.get(fault["code"], "unknown")}


def connect(port):
    """What reads bytes, waiting 50 ms at most, and what writes them."""
    if port.startswith(("unix:", "tcp://")):
        if port.startswith("unix:"):
            line = socket.socket(socket.AF_UNIX)
            line.connect(port.removeprefix("unix:"))
        else:
            host, number = port.removeprefix("tcp://").rsplit(":", 1)
            line = socket.create_connection((host, int(number)))
        line.settimeout(0.05)

        def read():
            try:
                received = line.recv(4096)
            except TimeoutError:
                return b""
            if not received:
                raise ConnectionError("the board has gone")
            return received

        return read, line.sendall
    import serial  # pip install pyserial

    line = serial.Serial(port, BAUD, timeout=0.05)
    return lambda: line.read(max(1, line.in_waiting)), line.write


def change(pair):
    """The name and the value of NAME=VALUE."""
    name, equals, value = pair.partition("=")
    if not equals:
        raise ValueError(f"`{pair}` is not NAME=VALUE")
    if name not in PARAMETERS.values():
        raise ValueError(f"there is no parameter `{name}`; there are "
                         + ", ".join(PARAMETERS.values()))
    try:
        return name, float(value)
    except ValueError:
        raise ValueError(f"`{value}` is not a number for {name}") from None


def main(arguments):
    if not arguments or {"-h", "--help"} & set(arguments):
        print(__doc__, file=sys.stdout if arguments else sys.stderr)
        return 0 if arguments else 2
    try:
        if len(arguments) < 2:
            raise ValueError("a command must follow the port")
        port, command, *rest = arguments
        if command == "stream" and len(rest) != 2:
            raise ValueError("stream takes two numbers: TICKS and EVERY")
        if command == "set" and not rest:
            raise ValueError("set takes a NAME=VALUE or more")
        changes = [change(pair) for pair in rest] if command == "set" else []
        board = Board(port)
        if command == "set":
            board.set(changes)
        elif command in ("arm", "disarm", "align"):
            board.request({"arm": ARM, "disarm": DISARM, "align": ALIGN}[command])
        elif command == "stream":
            for tick in board.stream(int(rest[0]), int(rest[1])):
                print(json.dumps(tick))
            return 0
        elif command == "describe":
            print(json.dumps({"program": board.program, **board.description()}))
            return 0
        elif command not in ("status", "get"):
            raise ValueError(f"there is no command {command}")
        answer = board.running() if command in ("get", "set") else board.status()
        print(json.dumps({"program": board.program, **answer}))
        return 0
    except Refused as refusal:
        print(refusal, file=sys.stderr)
        return 1
    except (ValueError, KeyError, IndexError, OSError) as error:
        print(error, __doc__, sep="\n\n", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
