"""The schema of scene files: what is bundled is valid, and what a schema can know to be wrong is not."""

import json
import re
import shutil
import subprocess
import sysconfig
import tomllib
from pathlib import Path

import pytest

import frazil

jsonschema = pytest.importorskip("jsonschema")

BAD = Path(__file__).parents[2] / "cases" / "bad"
# Of values that are there: their kinds, and keys that no section of the kind has. What is missing, and words and ranges that depend on
# other keys, only the program knows.
KNOWN = re.compile(r"unknown key, did you mean|found .*, must be (a number|a text|a table|true or false|an integer .*)$")
# Keys whose kind depends on others: a length that is a point in planes.
APART = {"random-two-lengths-on-a-line.toml"}

@pytest.fixture(scope="module")
def validator():
    command = Path(sysconfig.get_path("scripts")) / "frazil"
    found = str(command) if command.exists() else shutil.which("frazil")
    schema = json.loads(subprocess.run([found, "schema"], capture_output=True, text=True, check=True).stdout)
    jsonschema.Draft7Validator.check_schema(schema)
    return jsonschema.Draft7Validator(schema)


def test_every_bundled_scene_is_valid(command, validator):
    for bundled in frazil.scenes() + frazil.scenes("extreme"):
        scene = tomllib.loads(command("show", bundled.name).stdout)
        assert [error.message for error in validator.iter_errors(scene)] == [], bundled.name


def test_what_a_schema_can_know_to_be_wrong_is_invalid(validator):
    held, missed = 0, []
    for path in sorted(BAD.glob("*.toml")):
        text = path.read_text(encoding="utf-8")
        messages = [line for line in text.splitlines() if line.startswith("#^ ")]
        if path.name in APART or not any(KNOWN.search(message) for message in messages):
            continue
        try:
            scene = tomllib.loads(text)
        except tomllib.TOMLDecodeError:
            continue
        held += 1
        if validator.is_valid(scene):
            missed.append((path.name, messages))
    assert held > 10 and missed == []
