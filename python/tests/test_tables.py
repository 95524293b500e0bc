"""Tables and figures."""

import builtins

import numpy as np
import pytest

import frazil


def test_columns_are_arrays_of_one_length(stefan):
    front = stefan.front
    assert list(front) == ["time_s", "front_m", "front_ref_m"]
    assert front.rows == 60
    for column in front.values():
        assert column.shape == (60,) and column.dtype == np.float64 and column.flags.writeable
    assert front["time_s"][-1] == 36000.0
    assert np.all(np.diff(front["front_m"]) > 0.0)
    error = front["front_m"][-1] / front["front_ref_m"][-1] - 1.0
    assert error == pytest.approx(stefan.errors["front_last_rel"])


def test_columns_have_units(stefan):
    assert stefan.front.units == {"time_s": "s", "front_m": "m", "front_ref_m": "m"}
    units = stefan.profiles.units
    assert units["temperature_c"] == "degC" and units["frozen_fraction"] == "1" and units["plane"] == ""
    assert stefan.budget.units["in_left_j"] == "J"
    assert frazil.run("stefan-unit", "pd").front.units["front_m"] == "dimensionless"


def test_numbers_are_those_of_the_files(tmp_path):
    run = frazil.run("stefan-water", "local", out=tmp_path)
    for name, table in run.tables.items():
        lines = (tmp_path / f"{name}.csv").read_text().splitlines()
        assert lines[0].split(",") == list(table)
        assert len(lines) == table.rows + 1
        first = [column[0] for column in table.values()]
        for cell, value in zip(lines[1].split(","), first):
            if isinstance(value, float):
                assert np.isnan(value) if cell == "" else float(cell) == value


def test_texts_stay_texts_and_nothing_is_not_a_number(stefan):
    profiles = stefan.profiles
    assert profiles["plane"].dtype == object and set(profiles["plane"]) == {"line"}
    assert np.isnan(profiles["y_m"]).all()


def test_a_ring_of_pipes_has_walls_gaps_and_maps():
    short = {"method.local.spacing_m": 0.16, "time.duration_days": 40, "time.outputs": 20, "time.profiles_days": [40]}
    run = frazil.run("frozen-wall-sand", "local", set=short)
    assert run.wall.rows == 20 and run.wall.units["heat_per_pipe_w_per_m"] == "W/m"
    gaps = run.gaps
    assert gaps["from"].dtype == object and "." in gaps["from"][0], "1.10 is another pipe than 1.1"
    assert gaps["gap"].dtype == np.int64
    (map,) = run.maps
    assert map.temperature_c.shape == (len(map.y_m), len(map.x_m)) == map.frozen_fraction.shape
    assert map.time_s == 40 * 86400.0 and np.nanmin(map.temperature_c) < 0.0


def test_what_a_run_does_not_have_is_told(stefan):
    with pytest.raises(AttributeError, match="no table 'gaps': there are front, profiles, budget"):
        stefan.gaps
    with pytest.raises(KeyError, match="the columns of 'front' are time_s"):
        stefan.front["radius_m"]
    assert "gaps" not in stefan.tables and "front" in dir(stefan)


def test_a_table_becomes_a_frame_of_pandas(stefan):
    pandas = pytest.importorskip("pandas")
    frame = stefan.front.to_frame()
    assert isinstance(frame, pandas.DataFrame) and frame.shape == (60, 3)
    assert frame.attrs["units"]["front_m"] == "m"
    assert (frame["front_m"].to_numpy() == stefan.front["front_m"]).all()


def test_without_pandas_it_is_told_how_to_install_it(stefan, monkeypatch):
    known = builtins.__import__

    def without(name, *rest):
        if name == "pandas":
            raise ImportError(name)
        return known(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(ImportError, match="pip install pandas"):
        stefan.front.to_frame()


def test_figures_are_shown_in_a_notebook(stefan):
    assert set(stefan.figures) == {"front", "profiles"}
    for figure in stefan.figures.values():
        assert figure.startswith("<svg") and figure.rstrip().endswith("</svg>")
        assert figure._repr_html_() == figure
    assert stefan.figures._repr_html_() == stefan.figures["front"]
    shown = stefan._repr_html_()
    assert "<table>" in shown and "front_rms" in shown and stefan.figures["front"] in shown
    assert "<td>600</td>" in stefan.front._repr_html_() and "50 more rows" in stefan.front._repr_html_()
