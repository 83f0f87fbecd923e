#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Follows both recipes of docs/port.md from an empty folder, with the commands that stand there.

Usage: port_pages_test.py board|chip

The project is copied without the folder that the page makes. The reader's own part, the contents of the files that the page
names, is what the project has; a file that the page forgets is missing, and the image is not built."""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
NEEDED = ["CMakeLists.txt", "CMakePresets.json", "cmake", "shared", "firmware", "tools"]


def commands(page: str) -> list[str]:
    """The lines of all code blocks of a page."""
    blocks = re.findall(r"^```\n(.*?)^```", (ROOT / "docs" / page).read_text(), re.M | re.S)
    return [line for block in blocks for line in block.splitlines()]


def copy_project(to: pathlib.Path, without: str) -> None:
    for name in NEEDED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, to / name, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy(source, to / name)
    shutil.rmtree(to / without)


def run(command: str, folder: pathlib.Path, must_fail: bool = False) -> str:
    done = subprocess.run(command, shell=True, cwd=folder, capture_output=True, text=True, check=False)
    text = done.stdout + done.stderr
    if (done.returncode != 0) != must_fail:
        sys.exit(f"$ {command}\n{text[-3000:]}\n{'succeeds' if must_fail else 'fails'}")
    return text


def build(project: pathlib.Path, page: str, board: str) -> dict:
    lines = [line for line in commands(page) if line.startswith("cmake") and f"build/{board}" in line]
    assert len(lines) == 2, f"{page}: two lines that configure and build {board}, not {lines}"
    for line in lines:
        run(line, project)
    return json.loads((project / "build" / board / "bin/triskin_factory.json").read_text())


def follow_board(project: pathlib.Path) -> None:
    folder = "firmware/board/stm32g474/boards/icub_patch"
    copy_project(project, folder)
    lines = commands("port.md")
    configure = next(line for line in lines if line.startswith("cmake --preset"))
    refusal = run(configure, project, must_fail=True)
    words = " ".join(refusal.split())  # CMake breaks its messages into lines.
    assert "there is no firmware/board/*/boards/icub_patch" in words, refusal[-500:]
    for line in lines:
        if line.startswith(("mkdir", "cp")):
            run(line, project)
    for name in ["board.cmake", "triskin/board/board_config.hpp"]:
        assert (project / folder / name).is_file(), f"the page's commands make no {name}"
        shutil.copy(ROOT / folder / name, project / folder / name)
    manifest = build(project, "port.md", "icub_patch")
    assert manifest["chip"] == "STM32G474xE" and manifest["pins"]["Sda1"] == "PB9", manifest


def follow_chip(project: pathlib.Path) -> None:
    folder = "firmware/board/stm32l452"
    copy_project(project, folder)
    text = (ROOT / "docs/port.md").read_text().replace("NAME", "nucleo_l452re")
    names = sorted(set(re.findall(r"`((?:include|src|boards)/[\w/.]+\.(?:hpp|cpp|cmake))`", text)))
    assert len(names) >= 9, names
    for name in names:
        (project / folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / folder / name, project / folder / name)
    manifest = build(project, "port.md", "nucleo_l452re")
    assert manifest["chip"] == "STM32L452xE" and manifest["crystals_MHz"] == [8], manifest
    print(f"{len(names)} files named by the page make the image")


def main(page: str) -> None:
    with tempfile.TemporaryDirectory() as name:
        {"board": follow_board, "chip": follow_chip}[page](pathlib.Path(name))


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1] not in ("board", "chip"):
        sys.exit(__doc__)
    main(sys.argv[1])
