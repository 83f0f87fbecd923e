#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Boots the test machine once and runs all cases in it; each leaves RESULTS/<case>.txt, whose first line is PASSED or FAILED.

Usage: run_machine.py SOURCE BUILD WORK [CASES]   CASES: for example can,dfu; all but faults when left out

Exit status: 0 when the machine ran to its end and, with CASES, each of them passed. Without CASES, CTest reads the results.
"""
import pathlib
import shutil
import subprocess
import sys

import make_image

NEEDED = {"qemu-system-x86_64": "qemu-system-x86", "busybox": "busybox-static", "cpio": "cpio", "depmod": "kmod"}


def make_design(build: pathlib.Path, work: pathlib.Path) -> None:
    """Makes a flat plate with more modules than one controller can have."""
    nx, ny, step_mm = 6, 4, 20
    lines = [f"v {x * step_mm} {y * step_mm} 0" for y in range(ny + 1) for x in range(nx + 1)]
    for y in range(ny):
        for x in range(nx):
            a = y * (nx + 1) + x + 1
            lines += [f"f {a} {a + 1} {a + nx + 2}", f"f {a} {a + nx + 2} {a + nx + 1}"]
    (work / "plate.obj").write_text("\n".join(lines) + "\n")
    subprocess.run([build / "bin/triskin", "design", work / "plate.obj", "-o", work / "plate.json", "--time-limit-s", "1"], check=True)


TIMEOUT_S, NAMED_TIMEOUT_S = 1200, 3600  # CTest waits a little longer than the first.


def main(source: pathlib.Path, build: pathlib.Path, work: pathlib.Path, cases: str) -> int:
    missing = [package for program, package in NEEDED.items() if shutil.which(program, path="/usr/sbin:/usr/bin:/sbin:/bin") is None]
    if missing:
        print(f"The test machine needs the Debian packages {' '.join(missing)}: run tools/setup test", file=sys.stderr)
        return 1
    make_image.main(work)
    make_design(build, work)
    results = work / "results"
    shutil.rmtree(results, ignore_errors=True)
    results.mkdir()
    command = ["qemu-system-x86_64", "-accel", "tcg", "-cpu", "max", "-m", "512", "-nographic", "-no-reboot", "-nodefaults", "-serial", "stdio",
               "-kernel", str(work / "vmlinux"), "-initrd", str(work / "initramfs.cpio"),
               "-append", "console=ttyS0 quiet panic=-1 mitigations=off random.trust_cpu=on triskin_cases=" + cases]
    for tag, folder, mode in (("host", "/", ",readonly=on"), ("source", source, ",readonly=on"), ("build", build, ",readonly=on"),
                              ("results", results, "")):
        command += ["-virtfs", f"local,path={folder},mount_tag={tag},security_model=none,multidevs=remap{mode}"]
    timeout_s = NAMED_TIMEOUT_S if cases else TIMEOUT_S
    with open(work / "console.log", "w") as console:
        try:
            subprocess.run(command, stdin=subprocess.DEVNULL, stdout=console, stderr=subprocess.STDOUT, timeout=timeout_s, check=False)
        except subprocess.TimeoutExpired:
            print(f"The test machine did not end within {timeout_s} s", file=sys.stderr)
    text = (work / "console.log").read_text(errors="replace")
    print(text[-6000:])
    failed = [file.name for file in results.iterdir() if file.read_text().startswith("FAILED")] if cases else []
    return 0 if "VM: done" in text and not failed else 1


if __name__ == "__main__":
    if len(sys.argv) not in (4, 5):
        sys.exit(__doc__)
    sys.exit(main(*(pathlib.Path(a).resolve() for a in sys.argv[1:4]), sys.argv[4] if len(sys.argv) == 5 else ""))
