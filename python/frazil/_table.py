"""Tables: columns by name as NumPy arrays, with their units."""

from __future__ import annotations

import html
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Tuple

import numpy as np

if TYPE_CHECKING:
    import pandas

# Ends of names of columns, longest first, and the units that they stand for.
_ENDS = {
    "_j_per_m3_k": "J/(m3 K)",
    "_w_per_m_k": "W/(m K)",
    "_mm_per_day": "mm/d",
    "_m3_per_s": "m3/s",
    "_m2_per_s": "m2/s",
    "_j_per_m3": "J/m3",
    "_w_per_m2": "W/m2",
    "_m_per_day": "m/d",
    "_w_per_m": "W/m",
    "_m_per_s": "m/s",
    "_mj_per_m3": "MJ/m3",
    "_mj_per_m": "MJ/m",
    "_fraction": "1",
    "_percent": "%",
    "_share": "1",
    "_bytes": "B",
    "_days": "d",
    "_rel": "1",
    "_deg": "deg",
    "_kwh": "kWh",
    "_mwh": "MWh",
    "_day": "d",
    "_mpa": "MPa",
    "_pa": "Pa",
    "_kw": "kW",
    "_m2": "m2",
    "_m3": "m3",
    "_s": "s",
    "_h": "h",
    "_m": "m",
    "_c": "degC",
    "_k": "K",
    "_j": "J",
    "_w": "W",
}


def unit_of(name: str) -> str:
    """The unit at the end of a column name, ``""`` if there is none."""
    for end, unit in _ENDS.items():
        # A column may be called by its unit alone, as `day`.
        if f"_{name}".endswith(end):
            return unit
    return ""


class Table(Mapping[str, np.ndarray]):
    """A table: NumPy arrays by the names of its columns, all of one length.

    Numbers are floats, ``nan`` where a cell is empty; counts are integers, flags booleans, and texts objects.
    ``units`` has the unit of each column, ``""`` for none and for texts. In a scene without units
    (``units = "dpd"`` or ``"dimensionless"``), that word is used for all columns.
    """

    def __init__(self, name: str, columns: List[Tuple[str, str, Any]], units: str = "si") -> None:
        self.name = name
        self.units: Dict[str, str] = {}
        self._columns: Dict[str, np.ndarray] = {}
        for column, kind, values in columns:
            unit = unit_of(column)
            if kind == "O":
                array = np.empty(len(values), dtype=object)
                array[:] = values
                unit = ""
            else:
                array = np.frombuffer(values, dtype=kind).copy()
                # What is measured is a float, also where all of it happens to be whole.
                if unit and kind == "i8":
                    array = array.astype("f8")
            self.units[column] = unit if units == "si" or unit in ("", "1", "%") else units
            self._columns[column] = array

    @property
    def rows(self) -> int:
        """Number of rows."""
        return next((len(column) for column in self._columns.values()), 0)

    def __getitem__(self, column: str) -> np.ndarray:
        try:
            return self._columns[column]
        except KeyError:
            raise KeyError(f"{column!r}: the columns of {self.name!r} are {', '.join(self._columns)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._columns)

    def __len__(self) -> int:
        return len(self._columns)

    def to_frame(self) -> "pandas.DataFrame":
        """The table as a DataFrame of pandas; its ``attrs["units"]`` are the units.

        Raises:
            ImportError: where pandas is not installed, with how to install it.
        """
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_frame needs pandas: pip install pandas, or pip install 'frazil[pandas]'") from error
        frame = pandas.DataFrame(dict(self._columns))
        frame.attrs["units"] = dict(self.units)
        return frame

    def __repr__(self) -> str:
        return f"<Table {self.name}: {self.rows} rows of {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        heads = "".join(
            f"<th>{html.escape(name)}{f' ({html.escape(unit)})' if unit else ''}</th>"
            for name, unit in self.units.items()
        )
        shown = min(self.rows, 10)
        lines = [
            "<tr>" + "".join(f"<td>{_cell(column[k])}</td>" for column in self._columns.values()) + "</tr>"
            for k in range(shown)
        ]
        more = f"<p>{self.rows - shown} more rows</p>" if self.rows > shown else ""
        return f"<table><thead><tr>{heads}</tr></thead><tbody>{''.join(lines)}</tbody></table>{more}"


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else html.escape(str(value))


class Tables(Mapping[str, Table]):
    """Tables by name, each also as an attribute."""

    def __init__(self, tables: Dict[str, Table]) -> None:
        self._tables = tables

    def __getitem__(self, name: str) -> Table:
        try:
            return self._tables[name]
        except KeyError:
            raise KeyError(self._missing(name)) from None

    def __getattr__(self, name: str) -> Table:
        if name.startswith("_"):
            raise AttributeError(name)
        try:
            return self._tables[name]
        except KeyError:
            raise AttributeError(self._missing(name)) from None

    def _missing(self, name: str) -> str:
        return f"no table {name!r}: there are {', '.join(self._tables) or 'none'}"

    def __iter__(self) -> Iterator[str]:
        return iter(self._tables)

    def __len__(self) -> int:
        return len(self._tables)

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self._tables]

    def __repr__(self) -> str:
        return f"<Tables {', '.join(self._tables)}>"


class HasTables:
    """Base class with tables, each also as an attribute."""

    tables: Tables

    def __getattr__(self, name: str) -> Table:
        if name.startswith("_"):
            raise AttributeError(name)
        return self.tables.__getattr__(name)

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self.tables]


class Figure(str):
    """A figure: SVG text, displayed in notebooks."""

    def _repr_svg_(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return str(self)


class Figures(Mapping[str, Figure]):
    """Figures by name; notebooks display the first."""

    def __init__(self, figures: Dict[str, str]) -> None:
        self._figures = {name: Figure(text) for name, text in figures.items()}

    def __getitem__(self, name: str) -> Figure:
        try:
            return self._figures[name]
        except KeyError:
            raise KeyError(f"no figure {name!r}: there are {', '.join(self._figures) or 'none'}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._figures)

    def __len__(self) -> int:
        return len(self._figures)

    def __repr__(self) -> str:
        return f"<Figures {', '.join(self._figures)}>"

    def _repr_html_(self) -> str:
        return next(iter(self._figures.values()), "")
