#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when an include crosses a forbidden seam (docs/architecture.md). Usage: check_layering.py SOURCE_ROOT"""
import pathlib
import re
import sys

# folder prefix -> patterns of include paths that it must not name
FORBIDDEN = [
    ("shared/", r"^triskin/(host|geometry|check|model|scene|device|cli|ports|drivers|logic|app|boot|board)/"),
    ("shared/", r"^(CGAL|Eigen|nlohmann|fmt|unicorn|stm32|cmsis)"),
    ("firmware/", r"^triskin/(host|geometry|check|model|scene|device|cli)/"),
    ("firmware/", r"^(CGAL|Eigen|nlohmann|fmt|iostream|thread|mutex|chrono)"),
    ("firmware/ports/", r"^triskin/(drivers|logic|app|boot|board)/"),
    ("firmware/drivers/", r"^triskin/(logic|app|boot|board)/"),
    ("firmware/logic/", r"^triskin/(app|boot|board)/"),
    ("firmware/app/", r"^triskin/(boot|board)/"),
    ("firmware/boot/", r"^triskin/(app|board)/"),
    ("firmware/board/stm32g474/", r"^triskin/sim/"),
    ("host/", r"^triskin/(ports|drivers|logic|app|boot|board)/"),
    ("host/base/", r"^triskin/(geometry|check|model|scene|device|cli)/"),
    ("host/geometry/", r"^triskin/(check|model|scene|device|cli|wire|layout|sim|core)/"),
    ("host/check/", r"^triskin/(geometry|scene|device|cli)/"),
    ("host/model/", r"^triskin/(check|scene|device|cli)/"),
    ("host/scene/", r"^triskin/(geometry|check|device|cli)/"),
    ("host/device/", r"^triskin/(geometry|check|cli)/"),
]
VENDOR = re.compile(r"^(stm32|cmsis|core_cm)", re.I)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')


def main(root: pathlib.Path) -> int:
    bad = 0
    for top in ("shared", "firmware", "host"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in {".hpp", ".cpp", ".h", ".c", ".inc"}:
                continue
            name = path.relative_to(root).as_posix()
            for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
                found = INCLUDE.match(line)
                if not found:
                    continue
                target = found.group(1)
                wrong = target.startswith("..") or any(
                    name.startswith(prefix) and re.search(pattern, target) for prefix, pattern in FORBIDDEN)
                if VENDOR.match(target) and not name.startswith("firmware/board/"):
                    wrong = True
                if wrong:
                    print(f"{name}:{number}: include of {target} crosses a seam; see docs/architecture.md")
                    bad += 1
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))
