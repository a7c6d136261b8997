# %% [markdown]
# # The walls of a device
#
# Which walls of every stiffness and damping can this device render? Each `# %%` begins a cell: open this file
# as a notebook in VS Code, Spyder or Jupyter (with jupytext), or run it: `python map.py map.png`.

# %%
import sys

import haptic
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import BoundaryNorm, ListedColormap

# %% A wall, one sample late, at 1 kHz: the numbers are in SI units.
scene = {
    "name": "delayed wall",
    "device": {"inertia": 2.2e-5, "damping": 0.022},
    "servo": {"period": 0.001},
    "coupling": {"stiffness": 44.0},
    "environment": {"type": "damper-wall", "stiffness": 20.0, "damping": 0.005, "delay": 1},
    "human": {"inertia": 1e-4, "damping": 0.02, "stiffness": 4.0},
    "simulation": {"samples": 250, "position": 0.01},
}
wall = scene["environment"]
verdict = haptic.certify(scene)
low, high = haptic.index(scene)
print(verdict["message"])
print(f"index: {low:.9g} to {high:.9g} N m s/rad; device: {verdict['delta']:.9g} N m s/rad")

# %% Each pixel is a wall: 240 times 180 verdicts.
stiffness = np.linspace(0.2, 60, 240)
damping = np.linspace(-0.015, 0.025, 180)
regions = haptic.stability_map(scene, stiffness, damping)
certified = regions >= haptic.REGIONS.index("certified-exact")
print(f"certified: {certified.mean():.1%} of {certified.size} walls")

# %% Let go in the hand: the scene's wall, and a rejected wall. Alone it comes to rest; this hand, which is
# passive, makes it oscillate.
stiffer = scene | {"environment": wall | {"stiffness": 35.0}}
alone = {key: value for key, value in stiffer.items() if key != "human"}
for name, each in [("alone", alone), ("in the hand", stiffer)]:
    print(f"35 N m/rad {name}: {haptic.stability(each)['verdict']}")
motions = {
    f"{each['environment']['stiffness']:g} N m/rad, {haptic.certify(each)['verdict']}": haptic.simulate(each)
    for each in (stiffer, scene)
}

# %%
names = {
    "wrong": "certified, yet unstable",
    "unstable": "unstable without a hand",
    "rejected": "rejected: some hand makes it oscillate",
    "undecided": "undecided",
    "certified-exact": "certified by the exact rule",
    "certified-paper": "certified by both rules",
}
colours = ListedColormap(["#000000", "#d7d7d7", "#f2c6a0", "#fff3b0", "#8fc1e3", "#3f7fb5"])
figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
edges = np.arange(len(haptic.REGIONS) + 1) - 0.5
shades = {"cmap": colours, "norm": BoundaryNorm(edges, colours.N), "rasterized": True}
left.pcolormesh(stiffness, damping, regions, **shades)
for code in np.unique(regions):
    left.plot([], [], "s", markersize=9, color=colours(code), label=names[haptic.REGIONS[code]])
left.plot(wall["stiffness"], wall["damping"], "k+", markersize=12, label="the scene")
left.plot(35.0, wall["damping"], "kx", markersize=9, label="the stiffer wall")
left.set(xlabel="stiffness (N m/rad)", ylabel="damping (N m s/rad)", title="Walls of this device")
figure.legend(*left.get_legend_handles_labels(), loc="outside lower left", ncols=3, frameon=False)
for label, motion in motions.items():
    right.plot(1e3 * motion["time"], 1e3 * motion["position"], label=label)
right.set(xlabel="time (ms)", ylabel="position (mrad)", title="Let go in a hand")
right.legend(frameon=False)

# %%
picture = sys.argv[1] if len(sys.argv) > 1 else "map.png"
figure.savefig(picture, dpi=120)
