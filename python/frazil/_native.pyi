import os
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Tuple, Union

_Path = Union[str, "os.PathLike[str]"]
_Column = Tuple[str, str, Any]
_Studied = Tuple[str, "os.PathLike[str]"]

__version__: str

class SceneError(ValueError): ...
class RunError(RuntimeError): ...

class Run:
    def record(self) -> str: ...
    def folder(self) -> Optional["os.PathLike[str]"]: ...
    def tables(self) -> List[Tuple[str, List[_Column]]]: ...
    def figures(self) -> List[Tuple[str, str]]: ...
    def maps(self) -> List[Dict[str, Any]]: ...

def run(
    scene: Any,
    method: Optional[str],
    set: Optional[Mapping[str, Any]],
    seed: int,
    threads: Optional[int],
    error: Optional[float],
    measure: Optional[str],
    budget_s: float,
    out: Optional[_Path],
    tell: Optional[Callable[[float, float, int, float], None]],
) -> Run: ...
def compare(
    scenes: Sequence[Any],
    methods: Sequence[str],
    levels: int,
    budget_s: Optional[float],
    repeats: Optional[int],
    seeds: Optional[int],
    threads: int,
    set: Optional[Mapping[str, Any]],
    out: Optional[_Path],
    quiet: bool,
) -> _Studied: ...
def cheapest(
    scene: Any,
    error: float,
    methods: Sequence[str],
    measure: Optional[str],
    set: Optional[Mapping[str, Any]],
    threads: int,
    budget_s: float,
    out: Optional[_Path],
    quiet: bool,
) -> Tuple[str, "os.PathLike[str]", str]: ...
def ensemble(
    scene: Any,
    method: Optional[str],
    seeds: int,
    seed: int,
    set: Optional[Mapping[str, Any]],
    threads: Optional[int],
    out: Optional[_Path],
    quiet: bool,
) -> _Studied: ...
def stability(
    scenes: Sequence[Any],
    methods: Sequence[str],
    axes: Sequence[str],
    grid: int,
    values: int,
    seeds: int,
    coarsen: int,
    time_limit_s: float,
    threads: Optional[int],
    set: Optional[Mapping[str, Any]],
    out: Optional[_Path],
    quiet: bool,
) -> _Studied: ...
def sweep(
    scene: Any,
    vary: Mapping[str, Sequence[Any]],
    methods: Sequence[str],
    seed: int,
    threads: Optional[int],
    set: Optional[Mapping[str, Any]],
    out: Optional[_Path],
    quiet: bool,
) -> _Studied: ...
def layout(
    study: Any,
    method: Optional[str],
    set: Optional[Mapping[str, Any]],
    threads: Optional[int],
    error: Optional[float],
    out: Optional[_Path],
    quiet: bool,
) -> _Studied: ...
def check(
    scene: Any, methods: Sequence[str], set: Optional[Mapping[str, Any]], threads: Optional[int]
) -> List[Dict[str, Any]]: ...
def read(scene: Any) -> Dict[str, Any]: ...
def listed() -> List[Tuple[str, str, str, str]]: ...
def columns(path: _Path) -> List[_Column]: ...
def command(arguments: Sequence[str]) -> int: ...
