"""What the package `haptic` answers against what the program `haptic` prints.

    agree.py PROGRAM TEST
"""

import json
import math
import pathlib
import random
import subprocess
import sys
import warnings

import haptic
import numpy as np

PROGRAM = sys.argv[1]

WALL = {
    "name": "wall",
    "device": {"inertia": 2.2e-5, "damping": 0.022},
    "servo": {"period": 0.001},
    "coupling": {"stiffness": 44.0},
    "environment": {"type": "damper-wall", "stiffness": 20.0, "damping": 0.005, "delay": 1},
}
MOTION = {
    "simulation": {"samples": 9000, "torque_sine": {"amplitude": 1.5, "omega": 60.0}},
    "human": {"inertia": 1e-4, "damping": 0.02, "stiffness": 4.0},
    "limits": {"torque": 0.5},
}


def program(*arguments, text="", status=(0,)):
    """What the program prints for a text on its standard input."""
    run = subprocess.run([PROGRAM, *arguments], input=text, capture_output=True, text=True)
    assert run.returncode in status, run
    return run.stdout if run.returncode < 2 else run.stderr


def equal(one, other):
    """To the last bit, the order of keys included."""
    assert json.dumps(one) == json.dumps(other), f"{one}\n{other}"


def random_scene(chance):
    """A scene of any verdict, and now and then a scene that cannot be read."""
    kind = chance.choice(["damper-wall", "damper-wall", "delayed-spring", "free-mode", "free-mode-wall"])
    stiffness, damping = chance.uniform(0, 60), chance.uniform(-0.005, 0.02)
    environment = {"type": kind}
    if kind != "free-mode":
        environment |= {"stiffness": stiffness, "delay": chance.randrange(4)}
    if kind in ("damper-wall", "free-mode-wall"):
        environment |= {"damping": damping, "one_sided": chance.random() < 0.3}
    if kind in ("free-mode", "free-mode-wall"):
        environment["residual"] = chance.uniform(0.0, 0.01)
    scene = {
        "name": f"scene {chance.randrange(1000)} ä",
        "device": {"inertia": 10 ** chance.uniform(-5, -3), "damping": chance.uniform(0.005, 0.05)},
        "servo": {"period": chance.choice([1e-3, 5e-4, chance.uniform(1e-4, 2e-3)])},
        "environment": environment,
    }
    if chance.random() < 0.7:
        scene["coupling"] = {"stiffness": 2 * scene["device"]["damping"] / scene["servo"]["period"]}
    if chance.random() < 0.3:
        scene["limits"] = {"torque": chance.uniform(0.1, 2.0)}
    if chance.random() < 0.1:
        scene["device"]["damping"] *= -1
    return scene


def certify():
    chance = random.Random(20)
    scenes = [random_scene(chance) for _ in range(200)]
    lines = "".join(json.dumps(scene) + "\n" for scene in scenes)
    printed = [json.loads(line) for line in program("certify", "--batch", "-", text=lines).splitlines()]
    answers = haptic.certify_many(scenes)
    verdicts = {answer.get("verdict", "error") for answer in printed}
    assert verdicts >= {"certified", "rejected", "error"}, verdicts
    for scene, answer, expected in zip(scenes, answers, printed, strict=True):
        if "error" in expected:
            # The program names the place in the line, which a dictionary has not.
            places = [line.split(": ", 1)[1] for line in expected["error"].splitlines()]
            assert answer["error"].splitlines() == places, (answer, expected)
            continue
        equal(answer, expected)
        equal(haptic.certify(scene), expected)
    for text_or_path in forms():
        equal(haptic.certify(text_or_path), haptic.certify(WALL))
    fixed = json.loads(program("certify", "--json", "--format", "i8f24", "-", text=json.dumps(WALL)))
    equal(haptic.certify(WALL, format="i8f24"), fixed)


def forms():
    """The wall in every other form that there is of a scene."""
    text = json.dumps(WALL)
    path = pathlib.Path("wall.json")
    path.write_text(text)
    toml = 'name = "wall"\n' + "".join(
        f"{table}.{key} = {json.dumps(value)}\n"
        for table, keys in WALL.items()
        if table != "name"
        for key, value in keys.items()
    )
    of_numpy = {**WALL, "device": {key: np.float64(value) for key, value in WALL["device"].items()}}
    of_numpy["environment"] = {**WALL["environment"], "delay": np.int32(1), "stiffness": np.array(20.0)}
    return [text, path, str(path), toml, haptic.load(path), haptic.load(toml), of_numpy]


def simulate():
    for method in haptic.METHODS:
        scene = WALL | MOTION
        arguments = ["--method", method, "--substeps", "3"]
        printed = json.loads(program("simulate", "--json", *arguments, "-", text=json.dumps(scene)))
        motion = haptic.simulate(scene, method=method, substeps=3)
        for name in ("position", "velocity", "torque"):
            assert motion[name].dtype == np.float64 and motion[name].flags.writeable
            assert np.array_equal(motion[name], printed[name]), (method, name)
        assert motion["limit"].tolist() == printed["limit"] and "torque" in printed["limit"]
        assert np.allclose(motion["time"], 0.001 * np.arange(9000), rtol=1e-12)
        judged = program("stability", "--json", *arguments, "-", text=json.dumps(scene), status=(0, 1))
        equal(haptic.stability(scene, method=method, substeps=3), json.loads(judged))
    # An array of torques, and a motion that only a loop without a limit has.
    torque = 0.1 * np.sin(np.arange(500))
    driven = WALL | {"simulation": {"samples": 500, "torque": torque}}
    as_list = WALL | {"simulation": {"samples": 500, "torque": torque.tolist()}}
    printed = json.loads(program("simulate", "--json", "-", text=json.dumps(as_list)))
    assert np.array_equal(haptic.simulate(driven)["position"], printed["position"])
    unstable = WALL | {"simulation": {"samples": 100_000, "position": 0.01}}
    unstable["environment"] = WALL["environment"] | {"stiffness": 2000.0}
    command = [PROGRAM, "simulate", "--json", "-"]
    run = subprocess.run(command, input=json.dumps(unstable), capture_output=True, text=True)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        motion = haptic.simulate(unstable)
    assert 0 < motion["position"].size < 100_000
    assert np.array_equal(motion["position"], json.loads(run.stdout)["position"])
    assert [warning.category for warning in caught] == [RuntimeWarning]
    assert str(caught[0].message) in " ".join(run.stderr.split()), run.stderr


def index():
    """The enclosure against the smallest real part on a grid, by a formula of its own."""
    theta = np.linspace(1e-4, math.pi, 4001)
    for stiffness, damping, delay, coupling in [(20, 0.005, 1, 44), (50, 0.01, 3, 30), (5, -0.01, 2, 60)]:
        wall = {"type": "damper-wall", "stiffness": stiffness, "damping": damping, "delay": delay}
        scene = WALL | {"environment": wall, "coupling": {"stiffness": coupling}}
        z = np.exp(1j * theta)
        by_formula = z**-delay * (stiffness + damping * (z - 1) / (0.001 * z))
        found = haptic.response(scene, theta)
        assert np.allclose(found, by_formula, rtol=1e-12), np.abs(found - by_formula).max()
        velocity = haptic.response(scene, theta, from_velocity=True)
        assert np.allclose(velocity, 0.001 * z / (z - 1) * by_formula, rtol=1e-9)
        low, high = haptic.index(scene)
        on_grid = -velocity.real.min()
        assert low <= high and on_grid <= high + 1e-12 and abs(on_grid - low) < 1e-6, (low, high, on_grid)
        verdict = haptic.certify(scene)
        assert verdict["alpha"] == {"lo": low, "hi": high}
        low, high = haptic.index(scene, coupled=True)
        assert verdict["alpha_coupled"] == {"lo": low, "hi": high}
        # Behind the standard coupling of this device, 2 delta / T = 44 N m/rad, both are the same.
        assert (verdict["alpha_coupled"] == verdict["alpha"]) == (coupling == 44)
        controller = haptic.response(scene, theta.reshape(-1, 1), of="controller")
        assert np.allclose(controller[:, 0], by_formula / (1 + by_formula / coupling), rtol=1e-9)


def stability_map():
    """Against the numbers of the program's own map, cell by cell."""
    pathlib.Path("wall.json").write_text(json.dumps(WALL))
    program("chart", "map", "wall.json", "--points", "1600", "-o", "map.csv")
    rows = [line.split(",") for line in pathlib.Path("map.csv").read_text().splitlines()[1:]]
    stiffness = [float(row[0]) for row in rows[:40]]
    damping = [float(row[1]) for row in rows[::40]]
    codes = haptic.stability_map(WALL, stiffness, damping)
    assert codes.shape == (40, 40) and codes.dtype == np.uint8
    words = np.array(haptic.REGIONS)[codes].ravel().tolist()
    assert words == [row[2] for row in rows] and len(set(words)) >= 3, set(words)
    assert haptic.stability_map(WALL, [], [0.0]).shape == (1, 0)


def refusals():
    """Each sentence has the key, the value and the bound."""
    text = json.dumps(WALL)
    wrong = text.replace('"period": 0.001', '"period": 0')
    printed = program("certify", "-", text=wrong, status=(2,))
    sentence = "`servo.period` = 0 is out of bounds; it must be "
    assert sentence in " ".join(printed.split()), printed
    device = WALL["device"]
    for call, words in [
        (lambda: haptic.certify(wrong), "scene:1:"),
        (lambda: haptic.certify(wrong), sentence),
        (lambda: haptic.certify(WALL | {"servo": {"period": 0}}), sentence),
        (lambda: haptic.certify(WALL | {"device": device | {"weight": 1}}), "`device.weight` is not a key"),
        (lambda: haptic.certify(WALL | {"device": device | {"damping": math.nan}}),
         "`device.damping` = nan is out of bounds; it must be a finite number"),
        (lambda: haptic.certify(WALL | {"device": {1, 2}}), "`device` is a set; it must be"),
        (lambda: haptic.certify({}), "the file is empty"),
        (lambda: haptic.certify("nowhere.toml"), "nowhere.toml: the file cannot be read: "),
        (lambda: haptic.certify(""), "the name of the file is empty"),
        (lambda: haptic.certify("-"), "./-: the file cannot be read: "),
        (lambda: haptic.certify(7), "the scene is a int; it must be a dictionary, a path or a text"),
        (lambda: haptic.certify(WALL, format="i9f24"), '`format` = "i9f24" is out of bounds; it must be'),
        (lambda: haptic.simulate(WALL), "wall: a simulation needs a [simulation] table"),
        (lambda: haptic.simulate(WALL, method="magic"),
         '`method` = "magic" is out of bounds; it must be one of exact,'),
        (lambda: haptic.simulate(WALL, substeps=0),
         "`substeps` = 0 is out of bounds; it must be a whole number from 1"),
        (lambda: haptic.stability(WALL, substeps=1_000_001), "`substeps` = 1000001 is out of bounds"),
        (lambda: haptic.response(WALL, 1.0, of="hand"), '`of` = "hand" is out of bounds; it must be one of'),
        (lambda: haptic.response(WALL, [1.0, math.inf]),
         "`theta[1]` = inf is out of bounds; it must be a finite"),
        (lambda: haptic.stability_map(WALL, [1.0, math.nan], 0.0), "`stiffness[1]` = NaN is out of bounds"),
        (lambda: haptic.stability_map(WALL, [[1.0]], 0.0), "`stiffness` has 2 dimensions; it must have one"),
        (lambda: haptic.stability_map(WALL | {"environment": {"type": "free-mode", "residual": 0.001}}, 1, 0),
         "wall: a map shows stiffness and damping of a wall"),
    ]:
        try:
            answer = call()
        except haptic.SceneError as error:
            assert isinstance(error, ValueError) and words in str(error), (words, str(error))
        else:
            raise AssertionError(f"no refusal: {words}: {answer}")


{test.__name__: test for test in (certify, simulate, index, stability_map, refusals)}[sys.argv[2]]()
