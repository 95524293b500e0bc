"""Listing of scenes and methods, and checks of scenes."""

from __future__ import annotations

from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from . import _native
from ._run import Scene


class SceneInfo(NamedTuple):
    """A bundled scene or study."""

    name: str
    """Name in functions and commands."""
    title: str
    """Title."""
    source: str
    """Source of its parameters."""


class MethodInfo(NamedTuple):
    """A method."""

    name: str
    """Name in functions and commands."""
    title: str
    """Title."""
    stochastic: bool
    """Whether its results depend on a seed."""


class Plan(NamedTuple):
    """Plan of a run."""

    method: str
    """The method."""
    particles: int
    """Particles."""
    pairs: int
    """Pairs per evaluation."""
    memory_bytes: int
    """Memory to the end of the run (bytes)."""
    step_s: float
    """Time step (s), before it is shortened to land on outputs."""
    step_bound_s: float
    """Step bound (s)."""
    step_limit: str
    """Cause of the step bound."""
    steps: Optional[int]
    """Number of steps, if known from the first ones."""
    wall_s: Optional[float]
    """Run time on this machine (s), from a trial of its first steps, if known."""
    text: str
    """The text that the command prints."""

    def __str__(self) -> str:
        return f"{self.method}\n{self.text}"


def scenes(kind: str = "scene") -> List[SceneInfo]:
    """The bundled scenes; with ``kind = "extreme"`` those at the limits of the methods, with ``"study"`` the studies of
    layouts."""
    if kind not in ("scene", "extreme", "study"):
        raise ValueError(f'kind: found {kind!r}, must be "scene", "extreme" or "study"')
    return [SceneInfo(name, title, source) for own, name, title, source in _native.listed() if own == kind]


def methods() -> List[MethodInfo]:
    """All methods."""
    rows = _native.listed()
    return [MethodInfo(name, title, noise == "stochastic") for own, name, title, noise in rows if own == "method"]


def read(scene: Scene) -> Dict[str, Any]:
    """Returns a scene or a study as a dictionary, for example as a start for your own. Its content is not checked.

    Raises:
        SceneError: where there is no such file, or it is no TOML.
    """
    return _native.read(scene)


def check(
    scene: Scene,
    method: Optional[str] = None,
    *,
    set: Optional[Mapping[str, Any]] = None,
    threads: Optional[int] = None,
) -> Dict[str, Plan]:
    """Checks a scene, plans its run and times the first steps, with one method or with all methods of the scene.

    Args:
        scene, method, set, threads: as of `run`.

    Returns:
        What a run would do, by the name of the method.

    Raises:
        SceneError: where the scene cannot be read, or has no such method.
        RunError: where a run is refused.
    """
    planned = _native.check(scene, [] if method is None else [method], set, threads)
    return {plan["method"]: Plan(**plan) for plan in planned}
