#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the result of a case of the test machine; the status is 0 when it passed. Usage: show_result.py FILE"""
import pathlib
import sys

path = pathlib.Path(sys.argv[1])
if not path.exists():
    sys.exit(f"{path.stem}: no result: the test machine did not get to it (see console.log)")
text = path.read_text(errors="replace")
print(text)
sys.exit(0 if text.startswith("PASSED") else 1)
