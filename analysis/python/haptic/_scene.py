"""The forms of a scene."""

import json
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ._native import SceneError

Scene = Mapping[str, Any] | str | os.PathLike[str]
"""A scene: a dictionary, a path, or a text."""


def source(scene: Scene) -> tuple[str, str]:
    """Name the form of a scene, and give its text."""
    if isinstance(scene, Mapping):
        return "dictionary", json.dumps(plain(scene, ""))
    if isinstance(scene, os.PathLike):
        return "path", os.fspath(scene)
    if not isinstance(scene, str):
        kind = type(scene).__name__
        raise SceneError(f"the scene is a {kind}; it must be a dictionary, a path or a text")
    is_text = "\n" in scene or scene.lstrip().startswith("{")
    return "text" if is_text else "path", scene


def plain(value: Any, key: str) -> Any:
    """Turn NumPy's numbers and arrays into what JSON has."""
    if isinstance(value, Mapping):
        prefix = f"{key}." if key else ""
        return {str(name): plain(inner, f"{prefix}{name}") for name, inner in value.items()}
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [plain(inner, f"{key}[{place}]") for place, inner in enumerate(value)]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, float) and not math.isfinite(value):
        raise SceneError(f"`{key}` = {value} is out of bounds; it must be a finite number")
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    kind = type(value).__name__
    raise SceneError(f"`{key}` is a {kind}; it must be a number, a text, a list or a table")
