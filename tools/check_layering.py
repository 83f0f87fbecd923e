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
SHARED = "core wire layout sim"
FIRMWARE = SHARED + " ports drivers"
# Folder; include prefixes that it owns; prefixes that it may include besides; libraries that are not ours; its target.
PARTS = [
    Part("shared", SHARED, "", "", "triskin_shared"),
    Part("firmware/ports", "ports", SHARED, "", "triskin_fw_ports"),
    Part("firmware/drivers", "drivers", SHARED + " ports", "", "triskin_fw_drivers"),
    Part("firmware/logic", "logic", FIRMWARE, "", "triskin_fw_logic"),
    Part("firmware/boot", "boot", FIRMWARE + " logic", "", "triskin_fw_boot"),
    Part("firmware/app", "app", FIRMWARE + " logic", "", "triskin_fw_app"),
    Part("firmware/board/posix", "", FIRMWARE + " logic boot app", "", "triskin_firmware_posix"),
    Part("firmware/board/stm32", "board", "core wire layout ports drivers logic boot app", "vendor", "triskin_fw_board"),
    # A chip: what it does not share with the others.
    Part("firmware/board/stm32g474", "", "board core wire layout ports", "vendor"),
    Part("firmware/board/stm32l452", "", "board core wire layout ports", "vendor"),
    Part("host/core/base", "base", "", "fmt", "triskin_base"),
    Part("host/core/geometry", "geometry", "", "Eigen", "triskin_geometry"),
    Part("host/core/design", "design", "base geometry core wire layout", HOST_BASE, "triskin_design"),
    Part("host/output/exports", "exports", "base geometry design core wire layout", HOST_BASE, "triskin_exports"),
    Part("host/plan/cad", "cad", "base geometry design", HOST_BASE, "triskin_cad"),
    # A program of its own: nothing else may link the geometry kernel.
    Part("host/plan/cad_reader", "", "base geometry design cad", "Eigen nlohmann fmt CGAL OCCT", "triskin_cad_reader"),
    Part("host/plan/mesh", "mesh", "base geometry design cad", "Eigen nlohmann fmt CGAL tbb assimp minizip expat boost", "triskin_mesh"),
    Part("host/plan/placement", "placement", "base geometry design", "Eigen nlohmann fmt CGAL tbb boost", "triskin_placement"),
    Part("host/plan/unfolding", "unfolding", "base geometry design mesh placement", "Eigen fmt CGAL tbb boost", "triskin_unfolding"),
    Part("host/plan/routing", "routing", "base geometry design mesh", "Eigen fmt tbb", "triskin_routing"),
    Part("host/plan/lattice", "lattice", "base geometry design mesh routing", "Eigen fmt CGAL tbb boost", "triskin_lattice"),
    Part("host/plan/pipeline", "pipeline", "base geometry design mesh placement unfolding lattice routing", HOST_BASE, "triskin_pipeline"),
    Part("host/output/fabrication", "fabrication", "base geometry design cad sheet layout", HOST_BASE + " minizip boost", "triskin_fabrication"),
    Part("host/plan/check", "check", "base", "Eigen nlohmann fmt CGAL boost", "triskin_check"),
    Part("host/device/mechanics", "mechanics", "base", HOST_BASE, "triskin_mechanics"),
    Part("host/device/recording", "recording", "base geometry design core wire layout", HOST_BASE, "triskin_recording"),
    Part("host/output/bridge", "bridge", "base geometry design core wire layout recording", HOST_BASE + " dds", "triskin_bridge"),
    Part("host/device/link", "link", "base core wire layout", "fmt libusb hidapi", "triskin_link"),
    Part("host/device/session", "session", "base geometry design core wire layout link", HOST_BASE + " boost_fiber", "triskin_session"),
    Part("host/device/diagnose", "diagnose", "base geometry design core wire layout link session", HOST_BASE, "triskin_diagnose"),
    Part("host/device/deploy", "deploy", "base geometry design core wire layout link session diagnose", HOST_BASE, "triskin_deploy"),
    Part("host/device/robot", "robot", "base geometry design core wire layout link session deploy", HOST_BASE + " boost", "triskin_robot"),
    Part("host/sim/hardware", "hardware", "base geometry design core wire layout sim link mechanics", HOST_BASE, "triskin_hardware"),
    Part("host/device/connect", "connect", "base geometry design core wire layout sim hardware link session robot", HOST_BASE, "triskin_connect"),
    Part("host/device/skin", "skin", "base geometry design core wire layout link session robot connect mechanics", HOST_BASE, "triskin_skin"),
    Part("host/sim/scenario", "scenario",
         "base geometry design core wire layout sim hardware link session diagnose deploy skin recording mechanics", HOST_BASE, "triskin_scenario"),
    Part("host/output/view", "view", "base geometry design core wire layout", HOST_BASE + " boost_beast", "triskin_view"),
    Part("host/output/sheet", "sheet", "base geometry design core wire layout", HOST_BASE + " cairo", "triskin_sheet"),
    Part("host/output/hdf5", "hdf5", "base geometry design core wire layout recording", HOST_BASE + " HDF5", "triskin_hdf5"),
    # The header of the library is its own: <triskin/triskin.h> has no prefix.
    Part("host/app/library", "", "base geometry design core wire layout link session diagnose deploy skin robot connect hardware recording", "fmt", "triskin_library"),
    Part("host/app/python", "", "", "pybind11", "triskin_python"),
    Part("host/app/cli/src/geometry", "",
         "cli base design exports mesh placement unfolding lattice routing pipeline check core wire layout sim hardware recording link session "
         "diagnose deploy skin robot connect view sheet hdf5 bridge cad fabrication",
         HOST_BASE + " CLI"),
    Part("host/app/cli", "cli",
         "base geometry design exports core wire layout sim hardware recording link session diagnose deploy skin robot connect view sheet hdf5 bridge "
         "mechanics cad scenario",
         HOST_BASE + " CLI", "triskin"),
    Part("tools/machine", "machine", "base core wire layout sim", "fmt unicorn", "triskin_machine"),
]
# Include paths of libraries that only the parts that name them may include.
FOREIGN = {"CGAL": r"^CGAL/", "Eigen": r"^Eigen/", "nlohmann": r"^nlohmann/", "fmt": r"^fmt/", "tbb": r"^(tbb|oneapi)/",
           "assimp": r"^assimp/", "minizip": r"^minizip/", "expat": r"^expat\.h", "boost": r"^boost/(?!fiber/|beast/|asio/)", "boost_fiber": r"^boost/fiber/",
           "boost_beast": r"^boost/(beast|asio)/", "cairo": r"^(cairo|fontconfig|qrencode)", "HDF5": r"^(hdf5|H5)", "CLI": r"^CLI/",
           "libusb": r"^libusb", "hidapi": r"^hidapi", "unicorn": r"^unicorn/",
           "OCCT": r"^[A-Za-z0-9_]+\.hxx$", "pybind11": r"^pybind11/", "dds": r"^dds/", "vendor": r"(?i)^(stm32|cmsis|core_cm)"}
# An image has the headers of one chip on its path, which have the prefix of the drivers that all chips share.
CHIP_HEADERS = {("firmware/board/stm32", f"firmware/board/{chip}/include/triskin/board") for chip in ("stm32g474", "stm32l452")}
# What one part offers to a few others alone: header, and the folders that may include it.
RESERVED = {
    # A reader of samples takes them from host/device/skin; verify and bring_up measure the stream itself, scenarios stream from memory.
    "triskin/session/stream.hpp": ["host/device/session", "host/device/skin", "host/device/diagnose", "host/device/deploy", "host/sim/scenario"],
    "triskin/session/icub_stream.hpp": ["host/device/session", "host/device/skin"],
}
# Who answers on a bus is asked for by host/device/skin; these ask without one: they flash, verify or list boards that may be no skin yet.
BUS_DISCOVERY = re.compile(r"(\.|->)discover\(\)")
MAY_DISCOVER = ["host/device/session/", "host/device/skin/", "host/device/diagnose/", "host/device/deploy/", "host/app/cli/src/discover.cpp",
                "host/app/cli/src/doctor.cpp", "host/app/cli/src/flash_firmware.cpp", "host/app/cli/src/site_options.cpp"]
# No heap, no operating system in what also runs on the microcontroller (the posix board is there for simulations).
HOSTED = re.compile(r"^(iostream|fstream|sstream|thread|mutex|chrono|future|regex|filesystem)$")
# Link names of libraries that only some targets may reach, and which ones.
HEAVY = {"OCCT": r"^TK[A-Z0-9]", "CGAL": r"CGAL", "TBB": r"TBB|tbb", "assimp": r"assimp", "minizip": r"minizip", "Cbc": r"Cbc"}
ON_MESHES = {"triskin_mesh", "triskin_unfolding", "triskin_routing", "triskin_lattice", "triskin_pipeline", "triskin"}
MAY_BE_HEAVY = {"OCCT": {"triskin_cad_reader"}, "CGAL": ON_MESHES | {"triskin_placement", "triskin_check", "triskin_cad_reader"},
                "TBB": ON_MESHES | {"triskin_placement"},
                "assimp": ON_MESHES, "minizip": ON_MESHES | {"triskin_fabrication"}, "Cbc": set()}
# Targets without a prefix of their own that parts may link.
NEUTRAL = {"triskin_options"}
# What implements an interface of shared for a part: stated for its place on the linker's line, not for the part's use.
BROUGHT = {"triskin_hardware": {"triskin_firmware_posix"}}
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
    if target in RESERVED and part.folder not in RESERVED[target]:
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
                if BUS_DISCOVERY.search(line) and name.startswith("host/") and not name.startswith(tuple(MAY_DISCOVER)):
                    print(f"{name}:{number}: asks a bus who is there; take LiveBus::find_controllers (docs/stream.md)")
                    bad += 1
                if found and crosses(part, name, found.group(1)):
                    print(f"{name}:{number}: include of {found.group(1)} crosses a seam; see docs/architecture.md")
                    bad += 1
    return bad


def check_tests(root):
    """A private header is included by the tests of its own part (tests/plan/mesh for host/plan/mesh), or by its place,
    "plan/mesh/src/bvh.hpp"."""
    bad = 0
    owner = {}
    for top in ("shared", "firmware", "host", "tools"):
        for path in (root / top).glob("**/src/**/*.hpp"):
            folder, name = path.relative_to(root).as_posix().split("/src/", 1)
            owner.setdefault(name, set()).add(folder)
    for path in sorted((root / "tests").rglob("*")):
        if path.suffix not in SUFFIXES:
            continue
        part = "host/" + path.parent.relative_to(root / "tests").as_posix()
        for number, line in enumerate(path.read_text(errors="replace").splitlines(), 1):
            found = INCLUDE.match(line)
            name = found.group(1) if found else ""
            here = (path.parent / name).exists() or (root / "tests" / name).exists()
            if name in owner and part not in owner[name] and not here:
                print(f"{path.relative_to(root)}:{number}: {name} is private to {', '.join(sorted(owner[name]))}; "
                      f"include it by its place, as \"plan/mesh/src/bvh.hpp\"")
                bad += 1
    return bad


def check_public(root):
    """A header under include/ of a part of the host is one that another part uses, itself or by a header that is used."""
    public, users, within = {}, {}, {}
    for path in (root / "host").glob("*/*/include/triskin/**/*.hpp"):
        public[path.relative_to(root).as_posix().split("/include/", 1)[1]] = path.relative_to(root).parts[:3]
    for top in ("host", "tools", "docs/examples"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in SUFFIXES:
                continue
            place = path.relative_to(root)
            for name in {m.group(1) for m in map(INCLUDE.match, path.read_text(errors="replace").splitlines()) if m} & set(public):
                if place.parts[:3] != public[name]:
                    users.setdefault(name, set()).add(place)
                elif "/include/" in place.as_posix():
                    within.setdefault(place.as_posix().split("/include/", 1)[1], set()).add(name)
    used, todo = set(), list(users)
    while todo:
        name = todo.pop()
        if name not in used:
            used.add(name)
            todo += within.get(name, ())
    for name in sorted(set(public) - used):
        print(f"{'/'.join(public[name])}/include/{name}: no other part uses it; move it to src/")
    return len(set(public) - used)


def check_prefixes(root):
    """An include prefix in two folders would let one part's header answer for another's."""
    bad = 0
    owner = {prefix: part.folder for part in PARTS for prefix in part.prefixes}
    for include in sorted(root.glob("**/include/triskin/*")):
        name = include.relative_to(root).as_posix()
        if not include.is_dir() or not name.startswith(("shared/", "firmware/", "host/", "tools/")):
            continue
        expected = owner.get(include.name)
        if (expected, name) in CHIP_HEADERS:
            continue
        if expected is None or not name.startswith(expected + "/include/"):
            print(f"{name}: the include prefix triskin/{include.name}/ belongs to {expected or 'no part'}")
            bad += 1
    return bad


def check_circles():
    """The table itself must have an order: no part may use, directly or over others, a part that uses it."""
    owner = {prefix: part for part in PARTS for prefix in part.prefixes}
    below = {part.folder: {owner[prefix].folder for prefix in part.uses} - {part.folder} for part in PARTS}
    bad = 0
    for folder in below:
        if folder in closure(below, folder):
            print(f"{folder}: uses a part that uses it in turn; the table in tools/check_layering.py has a circle")
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
    bad = check_circles() + check_includes(root) + check_prefixes(root) + check_public(root) + check_tests(root)
    if len(arguments) > 1:
        bad += check_links(pathlib.Path(arguments[1]).read_text())
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
