"""Runs: scenes as they may be given, what comes out, what goes wrong."""

import json
import os
import pathlib
import shutil
import signal
import sys
import threading
import time

import numpy as np
import pytest

import frazil

#: Minutes on any machine: Euler's steps at a fortieth of the spacing. Whoever starts it stops it.
LONG = {"method.pd.spacing_m": 0.00005, "method.pd.integrator": "euler"}


def test_a_bundled_scene_is_run_by_its_name(stefan):
    assert stefan.outcome == "ok"
    assert stefan.record["scene"] == "stefan-water"
    assert stefan.record["method"] == "pd"
    assert 0.0 < stefan.errors["front_rms_rel"] < 1e-3
    assert stefan.folder is None
    assert not os.listdir("."), "nothing was asked to be written"


def test_the_first_method_is_taken_where_none_is_named():
    assert frazil.run("stefan-unit").record["method"] == "local"


def test_a_scene_is_run_by_its_path(stefan, scene, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(bundled_text(), encoding="utf-8")
    for given in (path, str(path)):
        run = frazil.run(given, "local", set={"method.local.spacing_m": 0.01})
        assert run.record["scene"] == "mine"
        assert run.record["particles"] == 40


def test_a_run_has_the_error_that_was_asked_for():
    run = frazil.run("stefan-water", "local", error=0.01)
    promised = run.record["estimated_error"]
    assert promised["measure"] == "front" and promised["promised_rel"] <= 0.01
    assert run.errors["front_rms_rel"] <= promised["promised_rel"]
    with pytest.raises(frazil.SceneError, match="measure: found .colour., must be one of front, "):
        frazil.run("stefan-water", "local", error=0.01, measure="colour")
    with pytest.raises((frazil.SceneError, frazil.RunError)):
        frazil.run("stefan-water", "local", error=1e-9, budget_s=0.5)


def bundled_text():
    return """
title = "Ice"
source = "none"
domain.line.length_m = 0.4
time = { duration_h = 1, outputs = 4 }
initial.temperature_c = 8
walls.left.temperature_c = -20
walls.right.temperature_c = 8
method.local.spacing_m = 0.002
[materials.water]
density_kg_per_m3 = 1000
frozen = { conductivity_W_per_m_K = 2.14, heat_capacity_J_per_kg_K = 2060 }
unfrozen = { conductivity_W_per_m_K = 0.6, heat_capacity_J_per_kg_K = 4182 }
freezing = { law = "isothermal", temperature_c = 0, latent_heat_J_per_kg = 334000 }
"""


def test_a_dictionary_is_the_same_scene(stefan, scene):
    run = frazil.run(scene, "pd")
    assert run.state_hash == stefan.state_hash
    assert run.record["title"] == stefan.record["title"]
    assert run.record["scene"] == "water-freezes-from-a-cold-wall-sharp-front"
    scene["walls"]["left"]["temperature_c"] = np.float64(-10.0)
    scene["time"]["profiles_h"] = np.array([2.0, 10.0])
    colder = frazil.run(scene, "pd")
    assert colder.front["front_m"][-1] < run.front["front_m"][-1]
    assert set(colder.profiles["time_s"]) == {7200.0, 36000.0}


def test_measured_points_of_a_dictionary_lie_where_python_works(tmp_path, scene):
    (tmp_path / "front.csv").write_text("time_h,front_m\n0.5,0.02\n1,0.03\n", encoding="utf-8")
    front = {"file": "front.csv", "sd_m": 0.001}
    measured = {"kind": "measured", "source": "a logger", "front": front}
    run = frazil.run({**scene, "reference": measured}, "local")
    found = run.record["measured"]["front_m"]
    assert (found["points"], found["sd_rms"]) == (2, 0.001)
    off = run.measured["value"] - run.measured["value_ref"]
    np.testing.assert_allclose(found["rms"], np.sqrt(np.mean(off**2)))
    assert "measured" in run.figures
    (tmp_path / "front.csv").write_text("time_h,front_m\n0.5,-1\n", encoding="utf-8")
    with pytest.raises(frazil.SceneError, match="front.csv:2: front_m: found -1"):
        frazil.run({**scene, "reference": measured}, "local")


def test_keys_are_set_over_those_of_the_scene():
    run = frazil.run("stefan-water", "pd", set={"method.pd.spacing_m": 0.004, "method.pd.front": "cell"})
    assert run.record["particles"] == 100
    assert run.record["settings"]["front"] == "cell"
    with pytest.raises(frazil.SceneError, match="spacing_m"):
        frazil.run("stefan-water", "pd", set={"method.pd.spacing_m": "wide"})


def test_the_state_is_that_of_the_command(command, tmp_path):
    for scene, method, options in [("stefan-water", "pd", {}), ("stefan-unit", "edpd", {"seed": 3, "threads": 2})]:
        run = frazil.run(scene, method, **options)
        folder = tmp_path / method
        told = command("run", scene, "--method", method, "--seed", options.get("seed", 1), "--out", folder)
        assert told.returncode == 0, told.stderr
        record = json.loads((folder / "record.json").read_text())
        assert run.state_hash == record["state_hash"]
        assert run.record["scene_hash"] == record["scene_hash"]
        assert run.errors == record["errors"]


def test_a_seed_decides_the_noise():
    hashes = [frazil.run("stefan-unit", "edpd", seed=seed).state_hash for seed in (1, 2, 1)]
    assert hashes[0] == hashes[2] != hashes[1]


@pytest.mark.parametrize(
    "scene, options, words",
    [
        ("stefan-watr", {}, r'did you mean "stefan-water"'),
        ("no/such.toml", {}, "no/such.toml: cannot be read"),
        ("shaft-clay", {}, "is a layout study"),
        ("stefan-water", {"method": "fem"}, "has settings for local, pd, sph, edpd"),
        ("stefan-water", {"set": {"method.pd.spacin_m": 1.0}}, 'did you mean "spacing_m"'),
        ("stefan-water", {"threads": 0}, "threads: found 0"),
        ({}, {}, "scene: title: missing, must be a text\n(.*\n)*scene: method: missing"),
        ({"title": "a", "walls": {"left": {"film": object()}}}, {}, "walls.left.film: found object"),
        ({"title": "a", 3: 4}, {}, "found the key 3"),
    ],
)
def test_what_is_wrong_with_a_scene_is_told_with_its_key(scene, options, words):
    with pytest.raises(frazil.SceneError, match=words) as told:
        frazil.run(scene, **options)
    assert isinstance(told.value, ValueError)


def test_a_key_of_a_dictionary_that_nobody_knows_is_named(scene):
    scene["walls"]["left"]["temprature_c"] = -20
    with pytest.raises(frazil.SceneError) as told:
        frazil.run(scene)
    assert str(told.value).endswith('walls.left.temprature_c: unknown key, did you mean "temperature_c"?')


def test_a_run_that_is_refused_is_no_bad_scene():
    with pytest.raises(frazil.RunError, match="above the stable bound"):
        frazil.run("stefan-water", "pd", set={"method.pd.step_s": 1e5})
    assert issubclass(frazil.RunError, RuntimeError)


def test_what_is_no_scene_is_refused():
    with pytest.raises(TypeError, match="a path, a bundled name or a dictionary"):
        frazil.run(3)


def test_results_are_written_where_they_are_asked_for(tmp_path):
    run = frazil.run("stefan-unit", "pd", out=tmp_path / "out")
    assert run.folder == tmp_path / "out"
    names = {path.name for path in run.folder.iterdir()}
    assert {"record.json", "front.csv", "front.svg", "budget.csv"} <= names
    assert json.loads((run.folder / "record.json").read_text()) == run.record
    assert (run.folder / "front.svg").read_text() == run.figures["front"]


def test_progress_is_told_to_the_end():
    told = []
    finer = {"method.pd.spacing_m": 0.0005, "method.pd.integrator": "euler"}
    run = frazil.run("stefan-water", "pd", set=finer, progress=told.append)
    assert len(told) >= 2
    assert all(isinstance(at, frazil.Progress) and at.duration_s == 36000.0 for at in told)
    assert [at.time_s for at in told] == sorted(at.time_s for at in told)
    assert told[-1].time_s == 36000.0 and told[-1].steps == run.record["steps"]


def test_progress_is_a_line_on_standard_error(capsys):
    frazil.run("stefan-unit", "pd", progress=True)
    assert "100 %" in capsys.readouterr().err


def test_what_progress_raises_stops_the_run():
    class Enough(Exception):
        pass

    def stop(at):
        raise Enough

    began = time.monotonic()
    with pytest.raises(Enough):
        frazil.run("stefan-water", "pd", set=LONG, progress=stop)
    assert time.monotonic() - began < 10.0


@pytest.mark.skipif(sys.platform == "win32", reason="signals are others there")
def test_an_interrupt_stops_a_run():
    handler = signal.getsignal(signal.SIGINT)
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        frazil.run("stefan-water", "pd", set=LONG)
    assert time.monotonic() - began < 10.0
    assert signal.getsignal(signal.SIGINT) is handler
    assert frazil.run("stefan-unit", "pd").outcome == "ok", "the next run is another one"


@pytest.mark.skipif(sys.platform == "win32", reason="signals are others there")
def test_an_interrupted_run_leaves_what_the_command_leaves(python, command, tmp_path):
    program = python(
        "import frazil\n"
        "try:\n"
        f"    frazil.run('stefan-water', 'pd', set={LONG!r}, out='out', progress=lambda at: print(at, flush=True))\n"
        "except KeyboardInterrupt:\n"
        "    print('interrupted', flush=True)\n"
    )
    program.stdout.readline()
    program.send_signal(signal.SIGINT)
    told, complaints = program.communicate(timeout=60)
    assert told.endswith("interrupted\n"), complaints
    assert json.loads((tmp_path / "out/record.json").read_text())["outcome"] == "interrupted"
    assert "stefan-water" in command("status", tmp_path / "out").stdout


def test_other_threads_go_on_meanwhile():
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    frazil.run("stefan-water", "pd", set={"method.pd.spacing_m": 0.0005, "method.pd.integrator": "euler"})
    done.set()
    thread.join()
    assert counted[0] > 20


def test_runs_are_made_side_by_side(stefan):
    hashes = []
    threads = [
        threading.Thread(target=lambda: hashes.append(frazil.run("stefan-water", "pd", threads=1).state_hash))
        for _ in range(3)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert hashes == 3 * [stefan.state_hash]
