"""What there is to run, and what a run would do."""

from __future__ import annotations

from typing import Any, Dict, List, Mapping, NamedTuple, Optional

from . import _native
from ._run import Scene


class SceneInfo(NamedTuple):
    """A bundled scene or study."""

    name: str
    """What functions and commands take."""
    title: str
    """What it is."""
    source: str
    """Where its parameters come from."""


class MethodInfo(NamedTuple):
    """A method."""

    name: str
    """What functions and commands take."""
    title: str
    """What it is."""
    stochastic: bool
    """Whether its results depend on a seed."""


class Plan(NamedTuple):
    """What a run would do."""

    method: str
    """The method."""
    particles: int
    """Particles."""
    pairs: int
    """Pairs that one evaluation visits."""
    memory_bytes: int
    """Memory to the end of the run (bytes)."""
    step_s: float
    """The step that will be made (s), before it is shortened to land on outputs."""
    step_bound_s: float
    """The bound of the explicit step (s)."""
    step_limit: str
    """What sets the bound."""
    steps: Optional[int]
    """Number of steps, where the first ones tell."""
    wall_s: Optional[float]
    """Time that the run will take on this machine (s), from a trial of its first steps, where that tells."""
    text: str
    """The same in words, as the command prints it."""

    def __str__(self) -> str:
        return f"{self.method}\n{self.text}"


def scenes(kind: str = "scene") -> List[SceneInfo]:
    """The bundled scenes; with ``kind = "extreme"`` those at the ends of what methods bear, with ``"study"`` the studies of
    layouts."""
    if kind not in ("scene", "extreme", "study"):
        raise ValueError(f'kind: found {kind!r}, must be "scene", "extreme" or "study"')
    return [SceneInfo(name, title, source) for own, name, title, source in _native.listed() if own == kind]


def methods() -> List[MethodInfo]:
    """All methods."""
    rows = _native.listed()
    return [MethodInfo(name, title, noise == "stochastic") for own, name, title, noise in rows if own == "method"]


def read(scene: Scene) -> Dict[str, Any]:
    """What a scene or a study says, as a dictionary: a beginning for one of your own. What it means is not looked at.

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
    """Checks a scene, and plans and tries its run for some milliseconds under a method, or under all that it has settings for.

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
