"""Freezing problems solved with peridynamics, SPH, eDPD and a local baseline.

    >>> import frazil
    >>> run = frazil.run("stefan-water", "pd")
    >>> run.front["time_s"], run.front["front_m"]
    >>> run.errors["front_rms_rel"]

`run` makes one run, `ensemble` the same with several seeds; `compare`, `cheapest`, `sweep`, `stability` and
`layout` make studies; `check` says what a run would do; `scenes` and `methods` say what there is. Numbers
are in SI units, temperatures in degrees Celsius, unless a scene has others; the names of columns end in their units.
"""

from ._listed import MethodInfo, Plan, SceneInfo, check, methods, read, scenes
from ._native import RunError, SceneError, __version__
from ._run import Map, Progress, Run, run
from ._studies import Cheapest, Ensemble, Member, Study, cheapest, compare, ensemble, layout, stability, sweep
from ._table import Figure, Figures, Table, Tables

__all__ = [
    "Cheapest",
    "Ensemble",
    "Figure",
    "Figures",
    "Map",
    "Member",
    "MethodInfo",
    "Plan",
    "Progress",
    "Run",
    "RunError",
    "SceneError",
    "SceneInfo",
    "Study",
    "Table",
    "Tables",
    "__version__",
    "cheapest",
    "check",
    "compare",
    "ensemble",
    "layout",
    "methods",
    "read",
    "run",
    "scenes",
    "stability",
    "sweep",
]
