"""One run of a scene with one method."""

from __future__ import annotations

import functools
import html
import json
import os
import sys
import warnings
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Union

import numpy as np

from . import _native
from ._table import Figures, HasTables, Table, Tables

#: A scene: a path, the name of a bundled one, or a dictionary with the content of a scene file.
Scene = Union[str, "os.PathLike[str]", Mapping[str, Any]]


class Progress(NamedTuple):
    """Progress of a run."""

    time_s: float
    """Simulated time (s)."""
    duration_s: float
    """End of the run (s)."""
    steps: int
    """Steps made."""
    elapsed_s: float
    """Wall time since the first step (s)."""


class Map(NamedTuple):
    """Fields of a plane at one time: arrays with rows in order of increasing y, ``nan`` outside the body."""

    time_s: float
    x_m: np.ndarray
    y_m: np.ndarray
    temperature_c: np.ndarray
    frozen_fraction: np.ndarray
    temperature_ref_c: Optional[np.ndarray]
    concentration: Optional[np.ndarray]


class HasRecord(HasTables):
    """Base class of what one run left: its record and its tables."""

    record: Dict[str, Any]

    @property
    def outcome(self) -> str:
        """How it ended: ``ok``, ``oscillating``, ``energy_drift``, ``phase_skipped`` or ``diverged``."""
        return str(self.record["outcome"])

    @property
    def errors(self) -> Dict[str, Any]:
        """Errors against the reference, relative; a measure that does not apply is absent."""
        return dict(self.record["errors"])

    @property
    def state_hash(self) -> str:
        """Hash of the final state, equal to that of the command."""
        return str(self.record["state_hash"])


class Run(HasRecord):
    """A run: its record, its tables and its figures.

    Each table is an attribute, with the name of the file that the command writes: ``front``, ``profiles``,
    ``probes``, ``budget``, ``wall``, ``gaps``, ...; ``tables`` contains those of this run.
    """

    front: Table
    profiles: Table
    probes: Table
    budget: Table
    wall: Table
    gaps: Table

    def __init__(self, native: "_native.Run") -> None:
        self._native = native
        #: The record, as in ``record.json``.
        self.record: Dict[str, Any] = json.loads(native.record())
        folder = native.folder()
        #: The folder with the results, if one was asked for.
        self.folder: Optional[Path] = None if folder is None else Path(folder)

    @functools.cached_property
    def tables(self) -> Tables:
        """All tables of the run."""
        units = self.record["units"]
        return Tables({name: Table(name, columns, units) for name, columns in self._native.tables()})

    @functools.cached_property
    def figures(self) -> Figures:
        """All figures of the run as SVG, drawn on first use."""
        return Figures(dict(self._native.figures()))

    @functools.cached_property
    def maps(self) -> List[Map]:
        """Fields at the times of profiles; none on a line."""
        return [_map(fields) for fields in self._native.maps()]

    def __repr__(self) -> str:
        record = self.record
        return f"<Run of {record['scene']} under {record['method']}: {self.outcome}, {record['steps']} steps>"

    def _repr_html_(self) -> str:
        record = self.record
        lines = [
            ("outcome", self.outcome + (f": {record['cause']}" if record.get("cause") else "")),
            *((name.replace("_rel", ""), f"{100 * value:.3g} %") for name, value in _percents(self.errors)),
            ("particles", str(record["particles"])),
            ("steps", str(record["steps"])),
            ("time of the steps", f"{record['solve_wall_s']:.3g} s"),
        ]
        rows = "".join(f"<tr><th>{html.escape(name)}</th><td>{html.escape(value)}</td></tr>" for name, value in lines)
        title = html.escape(f"{record['title']}: {record['method']}")
        figure = next(iter(self.figures.values()), "")
        return f"<table><caption>{title}</caption><tbody>{rows}</tbody></table>{figure}"


def _percents(errors: Mapping[str, Any]) -> List[Any]:
    return [(name, value) for name, value in errors.items() if name.endswith("_rel")]


def _map(fields: Dict[str, Any]) -> Map:
    rows, columns = fields["shape"]
    x, y = fields["first_m"]

    def field(name: str) -> Any:
        values = fields.get(name)
        return None if values is None else np.frombuffer(values, dtype="f8").reshape(rows, columns).copy()

    return Map(
        time_s=fields["time_s"],
        x_m=x + fields["spacing_m"] * np.arange(columns),
        y_m=y + fields["spacing_m"] * np.arange(rows),
        temperature_c=field("temperature_c"),
        frozen_fraction=field("frozen_fraction"),
        temperature_ref_c=field("temperature_ref_c"),
        concentration=field("concentration"),
    )


def run(
    scene: Scene,
    method: Optional[str] = None,
    *,
    set: Optional[Mapping[str, Any]] = None,
    seed: int = 1,
    threads: Optional[int] = None,
    error: Optional[float] = None,
    measure: Optional[str] = None,
    budget_s: float = 120.0,
    out: Union[str, "os.PathLike[str]", None] = None,
    progress: Union[bool, Callable[[Progress], None], None] = None,
) -> Run:
    """Runs a scene with one method.

    Args:
        scene: a path, the name of a bundled scene, or a dictionary with the content of a scene file.
        method: ``local``, ``pd``, ``sph`` or ``edpd``; by default the first method of the scene.
        set: keys that override the scene's, as ``{"method.pd.spacing_m": 0.001}``.
        seed: seed of noise and of uneven placement.
        threads: threads; by default one for each core. The result does not depend on it.
        error: chooses the spacing with this promised relative error, as ``0.01``, from coarse runs; ``record["estimated_error"]``
            then has the promised error and its parts. An error that cannot be promised is refused.
        measure: quantity of the error: ``front``, ``closure``, ``volume`` (frozen), ``temperature``, ``saturation`` or
            ``concentration``; by default the first that the scene has.
        budget_s: wall time (s) for the coarse runs that determine the spacing.
        out: folder for the results, as the command writes them; by default nothing is written.
        progress: ``True`` for a line on standard error, or what is called with a `Progress` some times a second and at
            the end. What it raises stops the run.

    Raises:
        SceneError: where the scene cannot be read, or has no such method.
        RunError: where the run is refused, or results cannot be written.
        KeyboardInterrupt: on Ctrl-C. With ``out``, the folder then has the results so far and a checkpoint, from which
            the command goes on (``frazil run --resume``).
    """
    line = _Line() if progress is True else None
    tell = progress if callable(progress) else line
    told = None if tell is None else lambda *standing: tell(Progress(*standing))
    try:
        made = Run(_native.run(scene, method, set, seed, threads, error, measure, budget_s, out, told))
        if tell is not None:
            record = made.record
            duration = float(made.budget["time_s"][-1]) if "budget" in made.tables else 0.0
            tell(Progress(duration, duration, record["steps"], record["solve_wall_s"]))
    finally:
        if line is not None:
            line.end()
    for remark in made.record.get("remarks", []):
        warnings.warn(f"{made.record['scene']}: {remark}", stacklevel=2)
    return made


class _Line:
    """A progress line on standard error."""

    def __init__(self) -> None:
        self._written = False

    def __call__(self, at: Progress) -> None:
        share = 100.0 * at.time_s / at.duration_s if at.duration_s > 0.0 else 100.0
        print(f"\r{share:3.0f} %  {at.steps} steps, {at.elapsed_s:.1f} s   ", end="", file=sys.stderr, flush=True)
        self._written = True

    def end(self) -> None:
        if self._written:
            print(file=sys.stderr)
