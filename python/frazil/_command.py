"""The command ``frazil``."""

from __future__ import annotations

import signal
import sys

from . import _native


def main() -> int:
    """Runs the program with the arguments of this process and returns its exit code."""
    # An interrupt before the first step ends the program at once; from then on the program has a handler of its own.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return int(_native.command(["frazil", *sys.argv[1:]]))
