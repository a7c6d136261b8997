"""A board from Python: tuned, armed, recorded.

    board.py [PORT]

PORT is a serial port such as /dev/ttyACM0, tcp://HOST:PORT or unix:PATH. Without it, a simulated board in this
process is the board, with a hand that pushes into its wall.
"""

import contextlib
import sys

import haptic

SCENE = {
    "name": "delayed wall",
    "device": {"inertia": 2.2e-5, "damping": 0.022},
    "servo": {"period": 0.001},
    "coupling": {"stiffness": 44.0},
    "environment": {"type": "damper-wall", "stiffness": 20.0, "damping": 0.005, "delay": 1},
    "limits": {"torque": 1.0},
}

with contextlib.ExitStack() as stack:
    port = sys.argv[1] if sys.argv[1:] else stack.enter_context(haptic.simulated_board(SCENE)).port
    board = stack.enter_context(haptic.connect(port))
    print(f"{board.program}: {dict(board.parameters)}")

    # Each change is certified on the board before it runs; a refusal changes nothing.
    board.parameters["stiffness"] = 12.5
    try:
        board.parameters.update(stiffness=40.0, damping=0.005)
    except haptic.RefusedError as refusal:
        print(f"refused: {refusal}")
    print(f"stiffness {board.parameters['stiffness']} N m/rad")

    board.arm()
    try:
        motion = board.telemetry(seconds=2.0)
    finally:
        board.disarm()
    print(f"largest angle {motion['position'].max():.2f} rad, torque {abs(motion['torque']).max():.1f} N m")
    print(f"{board.status()['state']}, missed ticks: {board.status()['missed']}")
