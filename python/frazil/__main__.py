"""``python -m frazil`` is the command ``frazil``."""

import sys

from ._command import main

sys.exit(main())
