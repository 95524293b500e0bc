"""Studies, lists, checks, and the command."""

import numpy as np
import pytest

import frazil


def test_methods_are_compared(tmp_path):
    study = frazil.compare("stefan-unit", methods=["local", "pd"], levels=2, budget_s=2.0, out=tmp_path / "compared")
    assert study.verdict == "done" and study.folder == tmp_path / "compared"
    assert study.report.read_text().startswith("<!DOCTYPE html>")
    comparison = study.comparison
    assert set(comparison["method"]) == {"local", "pd"} and comparison.rows == 4
    assert comparison["particles"].dtype == np.int64 and comparison.units["total_wall_median_s"] == "s"
    assert {"comparison", "convergence", "equal_error", "equal_time"} <= set(study.tables)
    assert all(text.lstrip().startswith("<svg") for text in study.figures.values()) and study.figures
    assert "report.html" in study._repr_html_()


def test_a_dictionary_is_compared_under_its_title(scene, tmp_path):
    scene["title"] = "Ice, thin"
    scene["time"] = {"duration_h": 1, "outputs": 10}
    del scene["watch"]["front_from_h"]
    study = frazil.compare([scene], methods="local", levels=2, budget_s=1.0, out=tmp_path)
    assert set(study.comparison["scene"]) == {"ice-thin"}


def test_a_study_of_nothing_is_refused():
    with pytest.raises(frazil.SceneError, match="--methods fem: there are local, pd, sph, edpd"):
        frazil.compare("stefan-unit", methods="fem")
    with pytest.raises(frazil.SceneError, match="levels: found 9, must be from 1 to 8"):
        frazil.compare("stefan-unit", levels=9)
    with pytest.raises(frazil.SceneError, match="axes: found .*must be of stefan, "):
        frazil.stability("stefan-unit", axes="colour")


def test_a_scene_is_swept(tmp_path):
    vary = {"initial.temperature_c": [2, 8], "walls.left.temperature_c": np.array([-10.0, -20.0])}
    short = {"time.duration_h": 2, "time.profiles_h": [2], "watch.front_from_h": 1}
    study = frazil.sweep("stefan-water", vary, methods=["local", "pd"], set=short, out=tmp_path)
    assert study.verdict == "done" and study.report.exists()
    runs = study.sweep
    assert runs.rows == 8 and set(runs["outcome"]) == {"ok"}
    fronts = {
        (method, start, wall): front
        for method, start, wall, front in zip(
            runs["method"], runs["initial.temperature_c"], runs["walls.left.temperature_c"], runs["front_m"]
        )
    }
    for method in ("local", "pd"):
        assert fronts[method, 2, -20] > fronts[method, 8, -20] > fronts[method, 8, -10]
    # The run of the scene itself is the same.
    own = frazil.run("stefan-water", "pd", set=short)
    assert own.state_hash in set(runs["state_hash"])
    assert fronts["pd", 8, -20] == own.front["front_m"][-1]
    with pytest.raises(frazil.SceneError, match="must be a list of values"):
        frazil.sweep("stefan-water", {"initial.temperature_c": 2}, out=tmp_path)


def test_stability_is_mapped(tmp_path):
    study = frazil.stability("stefan-unit", methods="pd", axes="own", grid=5, values=1, out=tmp_path)
    assert study.verdict == "done" and study.report.exists()
    (over,) = study.boundaries["sharp_over_bound"]
    assert over >= 1.0, "the bound keeps what the sharp one would"
    cells = study.stability
    assert cells["step_over_bound"].max() == pytest.approx(4.0)
    assert set(cells["class"][cells["step_over_bound"] <= 1.0]) == {"exact"}


SHORT = {
    "time.duration_days": 30,
    "time.outputs": 30,
    "time.profiles_days": [30],
    "method.local.spacing_m": 0.16,
}


def test_layouts_stand_beside_each_other(tmp_path):
    study = {
        "title": "Warm and cold",
        "source": "none",
        "scene": "frozen-wall-sand",
        "set": SHORT,
        "layouts": [{"name": "cold"}, {"name": "warm", "set": {"pipes.1.temperature_c": -10}}],
    }
    made = frazil.layout(study, "local", out=tmp_path)
    assert made.report.exists() and made.verdict in ("done", "check_failed")
    layouts = made.layouts
    assert list(layouts["layout"])[:2] == ["cold", "warm"]
    cold, warm = layouts["load_w_per_m"][:2]
    assert cold > warm > 0.0
    assert layouts["weakest_from"].dtype == object


def test_a_bad_study_is_told_by_its_keys():
    study = {"title": "t", "source": "s", "scene": "frozen-wall-sand", "layouts": [{"name": "a", "st": {}}]}
    with pytest.raises(frazil.SceneError) as told:
        frazil.layout(study)
    assert "layouts.1.st: unknown key" in str(told.value) and "/tmp" not in str(told.value)


def test_a_check_tells_what_a_run_would_do(stefan):
    plans = frazil.check("stefan-water")
    assert list(plans) == ["local", "pd", "sph", "edpd"]
    plan = frazil.check("stefan-water", "pd", threads=1)["pd"]
    assert plan.particles == stefan.record["particles"] and plan.pairs == stefan.record["pairs"]
    # Steps by error are estimated, those of a bound counted.
    assert 0.5 < plan.steps / stefan.record["steps"] < 2.0
    euler = {"method.pd.integrator": "euler"}
    counted = frazil.check("stefan-water", "pd", set=euler, threads=1)["pd"]
    assert counted.steps == frazil.run("stefan-water", "pd", set=euler).record["steps"]
    assert 0.0 < plan.wall_s < 60.0 and plan.memory_bytes > 1000
    assert "step limit" in str(plan)
    with pytest.raises(frazil.SceneError):
        frazil.check("stefan-water", "fem")


def test_lists_name_what_there_is(command):
    scenes = {scene.name: scene for scene in frazil.scenes()}
    assert "stefan-water" in scenes and scenes["stefan-water"].source.startswith("Nikolaev")
    assert {method.name: method.stochastic for method in frazil.methods()} == {
        "local": False,
        "pd": False,
        "sph": False,
        "edpd": True,
    }
    told = command("list").stdout
    assert all(name in told for name in scenes)
    assert any(study.name == "shaft-clay" for study in frazil.scenes("study"))
    assert frazil.read("shaft-clay")["scene"] == "frozen-wall-clay"


def test_the_command_came_along(command, tmp_path):
    assert command("--version").stdout == f"frazil {frazil.__version__}\n"
    told = command("run", "stefan-watr")
    assert told.returncode == 2 and 'did you mean "stefan-water"' in told.stderr
    told = command("compare", "stefan-unit", "--methods", "local", "--levels", "1", "--budget-s", "1", "--out", tmp_path)
    assert told.returncode == 0
    page = (tmp_path / "report.html").read_text()
    assert "frazil compare stefan-unit --methods local" in page and "/bin/frazil" not in page


def test_the_cheapest_run_with_an_error_is_found(tmp_path):
    study = frazil.cheapest("stefan-water", 0.01, methods=["local", "pd"], out=tmp_path)
    assert study.verdict == "done" and study.report.exists()
    rows = study.cheapest
    chosen = {method: k for k, (method, chosen) in enumerate(zip(rows["method"], rows["chosen"])) if chosen}
    assert set(chosen) == {"local", "pd"}
    assert all(rows["promised_error"][k] <= 0.01 for k in chosen.values())
    assert all(rows["error_against_reference"][k] <= rows["promised_error"][k] for k in chosen.values())
    # The answer names methods in the order of their run times.
    first, last = sorted(chosen, key=lambda method: rows["cpu_s"][chosen[method]])
    assert str(study).index(first) < str(study).index(last)
    with pytest.raises(frazil.SceneError, match='measure: found "colour", must be one of front, '):
        frazil.cheapest("stefan-water", 0.01, measure="colour", out=tmp_path)


def test_an_ensemble_has_means_and_members(tmp_path):
    short = {"time.duration": 1, "time.profiles": [1], "watch.front_from": 0.1}
    ensemble = frazil.ensemble("stefan-dpd-1", "edpd", seeds=3, seed=5, set=short, threads=2, out=tmp_path)
    assert ensemble.verdict == "done" and [member.seed for member in ensemble.members] == [5, 6, 7]
    assert len({member.state_hash for member in ensemble.members}) == 3
    error = ensemble.errors["temperature_rms_rel"]
    assert error["members"] == 3 and error["interval"][0] < error["mean"] < error["interval"][1]
    each = [member.errors["temperature_rms_rel"] for member in ensemble.members]
    assert error["mean"] == pytest.approx(np.mean(each), rel=1e-12)
    assert error["sd"] == pytest.approx(np.std(each, ddof=1), rel=1e-9)
    # A member is the run of its seed, and in the units of the scene.
    own = frazil.run("stefan-dpd-1", "edpd", seed=6, set=short)
    assert own.state_hash == ensemble.members[1].state_hash
    np.testing.assert_array_equal(own.front["front_m"], ensemble.members[1].front["front_m"])
    assert ensemble.front.units["time_s"] == own.front.units["time_s"] == "dpd"
    assert "temperature_rms_rel" in ensemble._repr_html_() and "front" in ensemble.figures


def test_an_ensemble_of_equal_members_is_refused(tmp_path):
    with pytest.raises(frazil.SceneError, match="all members would be equal"):
        frazil.ensemble("stefan-water", "pd", seeds=2, out=tmp_path)
    with pytest.raises(frazil.SceneError, match="seeds: found 0, must be from 1 to 1000"):
        frazil.ensemble("stefan-dpd-1", "edpd", seeds=0, out=tmp_path)
