#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fails when an include or a link crosses a forbidden seam (docs/architecture.md).
Usage: check_layering.py SOURCE_ROOT [LINKS]

The table PARTS is the only statement of which part may use which. Every include of "triskin/PREFIX/..." is held against
it, and so is the link closure of every target where LINKS is given: the file that cmake/layering.cmake writes, one target
a line, "target: what it links directly". Each include prefix belongs to one part.
"""
import pathlib
import re
import sys


class Part:
    def __init__(self, folder, prefixes, uses, foreign="", target=""):
        self.folder, self.prefixes, self.uses = folder, prefixes.split(), uses.split()
        self.foreign, self.target = foreign.split(), target


HOST_BASE = "Eigen nlohmann fmt"
GEOMETRY = "Eigen nlohmann fmt CGAL tbb assimp minizip boost Cbc"
# Folder; include prefixes that it owns; prefixes that it may include besides; libraries that are not ours; its target.
PARTS = [
    Part("shared", "base wire layout sim", "", "", "triskin_shared"),
    Part("firmware/ports", "ports", "base wire layout sim", "", "triskin_fw_ports"),
    Part("firmware/drivers", "drivers", "base wire layout sim ports", "", "triskin_fw_drivers"),
    Part("firmware/logic", "logic", "base wire layout sim ports drivers", "", "triskin_fw_logic"),
    Part("firmware/boot", "boot", "base wire layout sim ports drivers logic", "", "triskin_fw_boot"),
    Part("firmware/app", "app", "base wire layout sim ports drivers logic", "", "triskin_fw_app"),
    Part("firmware/board/posix", "", "base wire layout sim ports drivers logic boot app", "", "triskin_firmware_posix"),
    Part("firmware/board/stm32g474", "board", "base wire layout ports drivers logic boot app", "vendor", "triskin_fw_board"),
    Part("host/base", "host", "", "fmt", "triskin_base"),
    Part("host/design", "design", "host base wire layout", HOST_BASE, "triskin_design"),
    Part("host/geometry", "geometry", "host design", GEOMETRY, "triskin_geometry"),
    Part("host/pipeline", "pipeline", "host design geometry", HOST_BASE, "triskin_pipeline"),
    Part("host/check", "check", "host", "Eigen nlohmann fmt CGAL boost", "triskin_check"),
    Part("host/mechanics", "mechanics", "host", HOST_BASE, "triskin_mechanics"),
    Part("host/scene", "scene", "host design base wire layout sim", HOST_BASE, "triskin_scene"),
    Part("host/recording", "recording", "host design base wire layout", HOST_BASE, "triskin_recording"),
    Part("host/bridge", "bridge", "host design base wire layout recording", HOST_BASE + " dds", "triskin_bridge"),
    Part("host/device/link", "link", "host base wire layout", "fmt libusb hidapi", "triskin_link"),
    Part("host/device/session", "session", "host design base wire layout link", HOST_BASE + " boost_fiber",
         "triskin_session"),
    Part("host/device/jobs", "jobs", "host design base wire layout link session", HOST_BASE, "triskin_jobs"),
    Part("host/robot", "robot", "host design base wire layout link session jobs", HOST_BASE + " boost", "triskin_robot"),
    Part("host/simlink", "simlink", "host design base wire layout sim scene link session jobs robot", HOST_BASE,
         "triskin_simlink"),
    Part("host/view", "view", "host design base wire layout", HOST_BASE + " boost_beast", "triskin_view"),
    Part("host/sheet", "sheet", "host design base wire layout", HOST_BASE + " cairo", "triskin_sheet"),
    Part("host/hdf5", "hdf5", "host design base wire layout recording", HOST_BASE + " HDF5", "triskin_hdf5"),
    # Each header of the library is its own: <triskin/triskin.h> has no prefix.
    Part("host/library", "", "host design base wire layout link session jobs robot simlink scene", "fmt", "triskin_library"),
    Part("host/python", "", "", "pybind11", "triskin_python"),
    Part("host/cli/src/geometry", "",
         "cli host design geometry pipeline check base wire layout sim scene recording link session jobs robot simlink "
         "view sheet hdf5 bridge mechanics",
         HOST_BASE + " CLI"),
    Part("host/cli", "cli",
         "host design base wire layout sim scene recording link session jobs robot simlink view sheet hdf5 bridge mechanics",
         HOST_BASE + " CLI", "triskin"),
    Part("tools/machine", "machine", "host base wire layout sim", "fmt unicorn", "triskin_machine"),
]
# Include paths of libraries that only the parts that name them may include.
FOREIGN = {"CGAL": r"^CGAL/", "Eigen": r"^Eigen/", "nlohmann": r"^nlohmann/", "fmt": r"^fmt/", "tbb": r"^(tbb|oneapi)/",
           "assimp": r"^assimp/", "minizip": r"^minizip/", "boost": r"^boost/(?!fiber/|beast/|asio/)", "boost_fiber": r"^boost/fiber/",
           "boost_beast": r"^boost/(beast|asio)/", "cairo": r"^(cairo|fontconfig|qrencode)", "HDF5": r"^(hdf5|H5)", "CLI": r"^CLI/",
           "Cbc": r"^(Cbc|Coin|Osi|Cgl|Clp)", "libusb": r"^libusb", "hidapi": r"^hidapi", "unicorn": r"^unicorn/",
           "pybind11": r"^pybind11/", "dds": r"^dds/", "vendor": r"(?i)^(stm32|cmsis|core_cm)"}
# No heap, no operating system in what also runs on the microcontroller (the posix board is there for simulations).
HOSTED = re.compile(r"^(iostream|fstream|sstream|thread|mutex|chrono|future|regex|filesystem)$")
# Link names of libraries that only some targets may reach, and which ones.
HEAVY = {"CGAL": r"CGAL", "TBB": r"TBB|tbb", "assimp": r"assimp", "minizip": r"minizip", "Cbc": r"Cbc"}
MAY_BE_HEAVY = {"CGAL": {"triskin_geometry", "triskin_pipeline", "triskin_check", "triskin"},
                "TBB": {"triskin_geometry", "triskin_pipeline", "triskin"},
                "assimp": {"triskin_geometry", "triskin_pipeline", "triskin"},
                "minizip": {"triskin_geometry", "triskin_pipeline", "triskin"},
                "Cbc": {"triskin_geometry", "triskin_pipeline", "triskin"}}
# Targets without a prefix of their own that parts may link.
NEUTRAL = {"triskin_options"}
# What implements an interface of shared for a part: stated for its place on the linker's line, not for the part's use.
BROUGHT = {"triskin_scene": {"triskin_firmware_posix"}}
# The program is put together of everything; its sources are held against the table by their includes.
WHOLE = {"triskin", "triskin_library", "triskin_python"}

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]')
SUFFIXES = {".hpp", ".cpp", ".h", ".c", ".inc"}


def part_of(name):
    found = [p for p in PARTS if name.startswith(p.folder + "/")]
    return max(found, key=lambda p: len(p.folder)) if found else None


def crosses(part, name, target):
    if target.startswith(".."):
        return True
    ours = re.match(r"^triskin/([a-z0-9_]+)/", target)
    if ours:
        return ours.group(1) not in part.prefixes + part.uses
    if name.startswith(("shared/", "firmware/")) and "/posix/" not in name and HOSTED.match(target):
        return True
    return any(re.search(pattern, target) and library not in part.foreign for library, pattern in FOREIGN.items())


def check_includes(root):
    bad = 0
    for top in ("shared", "firmware", "host", "tools"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            name = path.relative_to(root).as_posix()
            part = part_of(name)
            if part is None:
                print(f"{name}: belongs to no part; add its folder to the table in tools/check_layering.py")
                bad += 1
                continue
            for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
                found = INCLUDE.match(line)
                if found and crosses(part, name, found.group(1)):
                    print(f"{name}:{number}: include of {found.group(1)} crosses a seam; see docs/architecture.md")
                    bad += 1
    return bad


def check_prefixes(root):
    """An include prefix in two folders would let one part's header answer for another's."""
    bad = 0
    owner = {prefix: part.folder for part in PARTS for prefix in part.prefixes}
    for include in sorted(root.glob("**/include/triskin/*")):
        name = include.relative_to(root).as_posix()
        if not include.is_dir() or not name.startswith(("shared/", "firmware/", "host/", "tools/")):
            continue
        expected = owner.get(include.name)
        if expected is None or not name.startswith(expected + "/include/"):
            print(f"{name}: the include prefix triskin/{include.name}/ belongs to {expected or 'no part'}")
            bad += 1
    return bad


def closure(links, target):
    seen, todo = set(), [target]
    while todo:
        for name in links.get(todo.pop(), []):
            if name not in seen:
                seen.add(name)
                todo.append(name)
    return seen


def used_targets(part, owner):
    """Targets of the parts that a part uses, and of those that these use: what a linker sees through them."""
    targets, todo = set(), [part]
    while todo:
        for prefix in todo.pop().uses:
            if owner[prefix].target not in targets:
                targets.add(owner[prefix].target)
                todo.append(owner[prefix])
    return targets


def check_links(text):
    links = {}
    for line in text.splitlines():
        target, _, rest = line.partition(":")
        brought = BROUGHT.get(target.strip(), set())
        links[target.strip()] = [name for name in rest.split() if name not in brought]
    owner = {prefix: part for part in PARTS for prefix in part.prefixes}
    bad = 0
    for part in PARTS:
        if part.target not in links or not part.target:
            continue
        allowed = NEUTRAL | {part.target} | used_targets(part, owner)
        reached = closure(links, part.target)
        if part.target not in WHOLE:
            for name in sorted(reached & set(links) - allowed):
                print(f"target {part.target} links {name}, which its part may not use; see docs/architecture.md")
                bad += 1
        for library, pattern in HEAVY.items():
            hit = [name for name in sorted(reached) if re.search(pattern, name) and name not in links]
            if hit and part.target not in MAY_BE_HEAVY[library]:
                print(f"target {part.target} links {hit[0]}: only the geometry side may; see docs/architecture.md")
                bad += 1
    return bad


def main(arguments):
    root = pathlib.Path(arguments[0])
    bad = check_includes(root) + check_prefixes(root)
    if len(arguments) > 1:
        bad += check_links(pathlib.Path(arguments[1]).read_text())
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
