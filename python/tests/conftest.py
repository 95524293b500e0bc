"""What the tests share."""

import copy
import shutil
import signal
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

import frazil


@pytest.fixture(autouse=True, scope="session")
def interrupts():
    """Ctrl-C as in a terminal, also where those who started the tests have it ignored, as shells do in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Each test in a folder of its own, where nothing is written that nobody asked for."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture(scope="session")
def stefan():
    """A run that takes some hundredths of a second."""
    return frazil.run("stefan-water", "pd")


@pytest.fixture
def scene():
    """A scene as a dictionary."""
    return copy.deepcopy(frazil.read("stefan-water"))


@pytest.fixture(scope="session")
def command():
    """Runs the command that came with the package."""
    name = Path(sysconfig.get_path("scripts")) / "frazil"
    found = str(name) if name.exists() else shutil.which("frazil")
    assert found, "the command is not installed"

    def call(*arguments):
        return subprocess.run([found, *map(str, arguments)], capture_output=True, text=True, timeout=300)

    call.path = found
    return call


@pytest.fixture
def python(tmp_path):
    """Starts a program in another interpreter."""

    def start(text):
        path = tmp_path / "program.py"
        path.write_text(text, encoding="utf-8")
        return subprocess.Popen(
            [sys.executable, str(path)], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )

    return start
