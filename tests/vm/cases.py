#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs in the test machine: every function test_… of case_*.py, and of long_*.py where it is named. Usage: cases.py TRISKIN DESIGN RESULTS [CASE,CASE…]"""
import importlib
import pathlib
import sys
import time
import traceback

import bench


def run_case(function, results: pathlib.Path) -> bool:
    name = function.__name__.removeprefix("test_")
    start = time.monotonic()
    bench.log.clear()
    try:
        function()
        verdict = "PASSED"
    except Exception:  # a case may fail in any way: it is reported, and the next one runs
        bench.log.append(traceback.format_exc())
        verdict = "FAILED"
    bench.stop_all()
    seconds = time.monotonic() - start
    (results / f"{name}.txt").write_text(f"{verdict} after {seconds:.1f} s\n" + "\n".join(bench.log) + "\n")
    print(f"VM: {name}: {verdict} after {seconds:.1f} s", flush=True)
    if verdict == "FAILED":
        print("\n".join(bench.log)[-1500:], flush=True)
    return verdict == "PASSED"


def main() -> int:
    bench.TRISKIN = sys.argv[1]
    results = pathlib.Path(sys.argv[3])
    bench.prepare(sys.argv[2])
    all_passed = True
    wanted = sys.argv[4].split(",") if len(sys.argv) > 4 else []
    folder = pathlib.Path(__file__).parent
    for path in sorted([*folder.glob("case_*.py"), *folder.glob("long_*.py")]):
        kind, _, name = path.stem.partition("_")
        if name not in wanted and (wanted or kind == "long"):  # Those that take long run only when they are named.
            continue
        module = importlib.import_module(path.stem)
        for name, function in list(vars(module).items()):
            if name.startswith("test_") and callable(function):
                all_passed &= run_case(function, results)
    return 0 if all_passed else 1


if __name__ == "__main__":
    sys.exit(main())
