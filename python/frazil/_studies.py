"""Studies: many runs with the functions of the commands; results are a folder with tables, figures and a page."""

from __future__ import annotations

import functools
import html
import json
import os
from pathlib import Path
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _native
from ._run import HasRecord, Scene
from ._table import Figures, HasTables, Table, Tables

_Folder = Union[str, "os.PathLike[str]", None]


class _Folders(HasTables):
    """Results that are in a folder: tables, each also as an attribute with the name of its file, and figures."""

    def __init__(self, kind: str, verdict: str, folder: "os.PathLike[str]") -> None:
        self._kind = kind
        #: ``done``; ``check_failed`` if results are complete but fail a check; ``broken`` if some are missing.
        self.verdict = verdict
        #: Folder with all that was written.
        self.folder = Path(folder)

    @functools.cached_property
    def tables(self) -> Tables:
        """The tables of the whole; those of single runs are in separate folders."""
        return _tables(self.folder, "si")

    @functools.cached_property
    def figures(self) -> Figures:
        """The figures as SVG, by their paths in the folder without extensions."""
        files = sorted(self.folder.rglob("*.svg"))
        named = {file.relative_to(self.folder).with_suffix("").as_posix(): file for file in files}
        return Figures({name: file.read_text(encoding="utf-8") for name, file in named.items()})

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self._kind}: {self.verdict}, in {self.folder}>"


class Study(_Folders):
    """A study: its folder, its page and its tables, each also as an attribute with the name of its file."""

    @property
    def report(self) -> Path:
        """The page, for a browser."""
        return self.folder / "report.html"

    def _repr_html_(self) -> str:
        page = html.escape(self.report.as_posix())
        tables = html.escape(", ".join(self.tables))
        return f'<p>{html.escape(repr(self))}</p><p>page: <a href="{page}">{page}</a>; tables: {tables}</p>'


class Cheapest(Study):
    """The fastest runs with an error: a study that prints its answer."""

    def __init__(self, verdict: str, folder: "os.PathLike[str]", answer: str) -> None:
        super().__init__("runs", verdict, folder)
        #: What the command prints: the methods in order of run time.
        self.answer = answer

    def __str__(self) -> str:
        return self.answer


class Member(HasRecord):
    """A member of an ensemble: its seed, its record and its tables, each also as an attribute."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.seed = seed
        self.folder = folder

    @functools.cached_property
    def record(self) -> Dict[str, Any]:  # type: ignore[override]
        """The record of its run, as in ``record.json``."""
        return _json(self.folder / "record.json")

    @functools.cached_property
    def tables(self) -> Tables:
        """The tables of its run."""
        return _tables(self.folder, self.record["units"])

    def __repr__(self) -> str:
        return f"<Member with seed {self.seed}, in {self.folder}>"


class Ensemble(_Folders):
    """A run with several seeds: its record, tables of means with their intervals, and its members."""

    @functools.cached_property
    def record(self) -> Dict[str, Any]:
        """What is known of all members together, as in ``ensemble.json``."""
        return _json(self.folder / "ensemble.json")

    @property
    def errors(self) -> Dict[str, Any]:
        """Each error over the members: ``mean`` with its 95 % ``interval``, ``sd``, ``rms``, and ``of_mean``, that of the mean
        of their series."""
        return dict(self.record["errors"])

    @functools.cached_property
    def members(self) -> List[Member]:
        """The members, in order of their seeds."""
        return [Member(seed, self.folder / f"seed-{seed}") for seed in self.record["seeds"]]

    @functools.cached_property
    def tables(self) -> Tables:
        """Means over the members with their 95 % intervals."""
        return _tables(self.folder, self.record["units"])

    def _repr_html_(self) -> str:
        rows = "".join(
            f"<tr><th>{html.escape(name)}</th><td>{error['mean']:.3g}</td><td>{error.get('sd', 0.0):.2g}</td></tr>"
            for name, error in self.errors.items()
            if name.endswith("_rel")
        )
        heads = "<tr><th></th><th>mean</th><th>standard deviation</th></tr>"
        figure = next(iter(self.figures.values()), "")
        return f"<table><caption>{html.escape(repr(self))}</caption>{heads}{rows}</table>{figure}"


def _tables(folder: Path, units: str) -> Tables:
    files = sorted(folder.glob("*.csv"))
    return Tables({file.stem: Table(file.stem, _native.columns(file), units) for file in files})


def _json(file: Path) -> Dict[str, Any]:
    found: Dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
    return found


def _many(given: Any) -> List[Any]:
    """One or several of something."""
    if given is None:
        return []
    if isinstance(given, (str, os.PathLike, Mapping)):
        return [given]
    return list(given)


def _study(kind: str, made: Tuple[str, "os.PathLike[str]"]) -> Study:
    return Study(kind, *made)


def compare(
    scenes: Union[Scene, Sequence[Scene]],
    *,
    methods: Union[str, Sequence[str], None] = None,
    levels: int = 4,
    budget_s: Optional[float] = None,
    repeats: Optional[int] = None,
    seeds: Optional[int] = None,
    threads: int = 1,
    set: Optional[Mapping[str, Any]] = None,
    out: _Folder = None,
    progress: bool = False,
) -> Study:
    """Compares methods on the same scenes: error against run time (``frazil compare``).

    Args:
        scenes: one scene or several: paths, names of bundled ones, dictionaries (named after their titles).
        methods: by default all methods of a scene.
        levels: number of spacings, each half the one before, 1 to 8.
        budget_s: wall time for one scene (s), 45 by default. Runs that do not fit are left out and listed.
        repeats: timed repetitions of each run; by default seven for short ones and fewer for long ones.
        seeds: seeds of each stochastic run; by default ten, or at least five if time is short.
        threads: threads of each run.
        set: keys that override those of every scene.
        out: folder for the results; by default ``out/compare``. Runs that it holds already are not made again.
        progress: whether to tell on standard error what is being run.

    Raises:
        SceneError, RunError, KeyboardInterrupt: as of `run`; the same call goes on where one was interrupted.
    """
    made = _native.compare(
        _many(scenes), _many(methods), levels, budget_s, repeats, seeds, threads, set, out, not progress
    )
    return _study("compare", made)


def cheapest(
    scene: Scene,
    error: float,
    *,
    methods: Union[str, Sequence[str], None] = None,
    measure: Optional[str] = None,
    set: Optional[Mapping[str, Any]] = None,
    threads: int = 1,
    budget_s: float = 120.0,
    out: _Folder = None,
    progress: bool = False,
) -> Cheapest:
    """Finds the fastest run of each method with an error (``frazil cheapest``): forecast, and checked by a run.

    Args:
        scene: a path, the name of a bundled scene, or a dictionary.
        error: the relative error, as ``0.01``.
        methods: by default all methods of the scene.
        measure: quantity of the error: ``front``, ``closure``, ``volume`` (frozen), ``temperature``, ``saturation`` or
            ``concentration``; by default the first that the scene has.
        set: keys that override those of the scene in all runs.
        threads: threads of each run.
        budget_s: wall time for all runs of one method (s).
        out: folder for the results; by default ``out/cheapest/SCENE``. Runs that it holds already are not made again.
        progress: whether to tell on standard error what is being run.

    The result has one table, ``cheapest``, with a row for each run; its ``verdict`` is ``check_failed`` if no method reaches the error.
    """
    return Cheapest(
        *_native.cheapest(scene, error, _many(methods), measure, set, threads, budget_s, out, not progress)
    )


def ensemble(
    scene: Scene,
    method: Optional[str] = None,
    *,
    seeds: int = 10,
    seed: int = 1,
    set: Optional[Mapping[str, Any]] = None,
    threads: Optional[int] = None,
    out: _Folder = None,
    progress: bool = False,
) -> Ensemble:
    """Runs a scene with several seeds (``frazil run --seeds``): means with confidence intervals, bias and scatter apart.

    Args:
        scene: a path, the name of a bundled scene, or a dictionary.
        method: by default the first method of the scene. It must have noise, or particles that are placed at random.
        seeds: number of members, 1 to 1000.
        seed: seed of the first member; those of the others follow it.
        set: keys that override those of the scene in all members.
        threads: concurrent members, each on one thread; by default one for each core.
        out: folder for the results; by default ``out/SCENE/METHOD``. Members that it holds already are not run again.
        progress: whether to tell on standard error how far it is, and print the summary of the command.

    Raises:
        SceneError, RunError, KeyboardInterrupt: as of `run`; the same call goes on where one was interrupted.
    """
    made = _native.ensemble(scene, method, seeds, seed, set, threads, out, not progress)
    return Ensemble("of a run", *made)


def sweep(
    scene: Scene,
    vary: Mapping[str, Sequence[Any]],
    *,
    methods: Union[str, Sequence[str], None] = None,
    seed: int = 1,
    threads: Optional[int] = None,
    set: Optional[Mapping[str, Any]] = None,
    out: _Folder = None,
    progress: bool = False,
) -> Study:
    """Runs a scene at all combinations of values of some of its keys (``frazil sweep``).

    Args:
        scene: a path, the name of a bundled scene, or a dictionary.
        vary: keys with their values, as ``{"initial.temperature_c": [1, 2, 3]}``; the first key is the horizontal axis of the
            figures.
        methods: by default the first method of the scene.
        seed: seed of noise and of uneven placement.
        threads: concurrent runs; by default one for each core.
        set: keys that override those of the scene in all runs.
        out: folder for the results; by default ``out/sweep/SCENE``. Runs that it holds already are not made again.
        progress: whether to tell on standard error what is being run.

    The result has one table, ``sweep``, with a row for each run: its values, its outcome, its results and its errors.
    """
    made = _native.sweep(scene, vary, _many(methods), seed, threads, set, out, not progress)
    return _study("sweep", made)


def stability(
    scenes: Union[Scene, Sequence[Scene]],
    *,
    methods: Union[str, Sequence[str], None] = None,
    axes: Union[str, Sequence[str], None] = None,
    grid: int = 13,
    values: int = 5,
    seeds: int = 10,
    coarsen: int = 2,
    time_limit_s: float = 60.0,
    threads: Optional[int] = None,
    set: Optional[Mapping[str, Any]] = None,
    out: _Folder = None,
    progress: bool = False,
) -> Study:
    """Maps the outcome of runs over the time step and one parameter (``frazil stability``).

    Args:
        scenes: one scene or several, as in `compare`.
        methods: by default all methods of a scene.
        axes: parameters of the maps: ``stefan``, ``conductivity``, ``capacity``, ``reach``, ``disorder``, ``noise``, ``rkl2``;
            of unsaturated water ``spacing``, ``saturation``, ``alpha``, ``n``, ``contrast``; or ``own``, the scene as it is. By
            default all applicable ones except ``own``.
        grid: steps of a map, from a quarter of the bound to four times it, 2 to 200.
        values: columns of a map, an odd number.
        seeds: seeds of a noisy cell near a boundary.
        coarsen: largest spacing over the scene's own, 1 to 16.
        time_limit_s: wall time of one run (s); a cell that needs more has timed out.
        threads: columns side by side; by default one for each core.
        set: keys that override those of every scene.
        out: folder for the results; by default ``out/stability``.
        progress: whether to tell on standard error what is being run.
    """
    made = _native.stability(
        _many(scenes), _many(methods), _many(axes), grid, values, seeds, coarsen, time_limit_s, threads, set, out,
        not progress,
    )  # fmt: skip
    return _study("stability", made)


def layout(
    study: Scene,
    method: Optional[str] = None,
    *,
    set: Optional[Mapping[str, Any]] = None,
    threads: Optional[int] = None,
    error: Optional[float] = None,
    out: _Folder = None,
    progress: bool = False,
) -> Study:
    """Compares layouts of freeze pipes (``frazil layout``).

    Args:
        study: a path, the name of a bundled study, or a dictionary, whose ``scene`` may be one too.
        method: by default that of the study, or the first method of its scene; ``all`` for all of them.
        set: overrides keys of the scene for all layouts.
        threads: concurrent layouts; by default one for each core.
        error: relative error of the day of closure and of the thickness at the end, for which the spacing is chosen; by
            default the spacing is the scene's.
        out: folder for the results; by default ``out/STUDY``. Layouts that it holds already are not run again.
        progress: whether to tell on standard error what is being run.
    """
    return _study("layout", _native.layout(study, method, set, threads, error, out, not progress))
