#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bounds the stack of an image from above and fails when the bound does not fit.

Usage: check_stack.py OBJDUMP ADDR2LINE ELF PRIORITY_HEADER OUTPUT

The bound is the deepest chain of calls from reset_handler, and on it, for each priority of the NVIC, what the processor
pushes at an exception and the deepest chain of that priority's handlers: handlers of one priority do not interrupt each
other (PM0214 2.3.6). Frames and calls are read from the disassembly, so the C library is in it. A virtual call is
followed into every class of the image whose table holds, at that place, a function of a name that the source calls
there (-g1 tells the line). Other calls through pointers stand in POINTERS. A call that cannot be followed and a
recursion are errors: the bound is never a guess.
"""
import bisect
import os
import pathlib
import re
import struct
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent

# What the processor pushes: 26 words with the registers of the FPU, and a word to align the stack (PM0214 2.3.7).
EXCEPTION_BYTES = 26 * 4 + 4
# Calls through pointers that are no virtual calls: caller -> callees, both as regular expressions of mangled names.
POINTERS = {
    r"^start_up$": r"^_GLOBAL__sub_I_",
    r"Identifiers4read": r"Identifiers5Table(4read|11part_number|11calibration)",
    r"Identifiers5write": r"Identifiers(5Table(5write|15set_calibration)|3Row6refuse)",
    r"wait_through_erase": r"kSampling|_FUN",
    r"start_image": None,  # starts the application, with a stack of its own
}
# Handlers by the name of their priority in PRIORITY_HEADER. The NMI is above all; a hard fault ends in a reset.
HANDLERS = {
    r"^i2c\d_(event|error)_handler$": "kLines",
    r"^can_handler$": "kCan",
    r"^usb_handler$": "kUsb",
    r"^tim2_handler$": "kTimer",
    r"^nmi_handler$": None,
}
NMI_PRIORITY = -2
# Destructors of objects that live for ever: __cxa_atexit (startup.cpp) forgets them.
NEVER_CALLED = r"^__tcf_|D[012]Ev$"
NO_HANDLER = r"^(hard_fault|default)_handler$"


class Unbounded(Exception):
    """A call whose target is not known, or a recursion."""


class Elf:
    """Symbols and contents of a 32-bit little-endian image."""

    def __init__(self, path: str):
        self.data = pathlib.Path(path).read_bytes()
        offset, = struct.unpack_from("<I", self.data, 32)
        size, count = struct.unpack_from("<HH", self.data, 46)
        self.sections = [struct.unpack_from("<10I", self.data, offset + size * k) for k in range(count)]

    def symbols(self, functions: bool = False):
        """(name, address, bytes) of each symbol, or of each function."""
        table = next(s for s in self.sections if s[1] == 2)
        names = self.sections[table[6]]
        for at in range(table[4], table[4] + table[5], 16):
            name, address, size, info = struct.unpack_from("<3IB", self.data, at)
            if functions and info & 15 != 2:
                continue
            start = names[4] + name
            yield self.data[start:self.data.index(b"\0", start)].decode(), address, size

    def words(self):
        """(address, word) of all that is flashed."""
        for _, kind, flags, start, offset, size, *_ in self.sections:
            if kind == 1 and flags & 2:  # allocated contents
                for at in range(0, size - 3, 4):
                    yield start + at, struct.unpack_from("<I", self.data, offset + at)[0]

    def word(self, address: int) -> int:
        for _, kind, _, start, offset, size, *_ in self.sections:
            if kind == 1 and start <= address < start + size:
                return struct.unpack_from("<I", self.data, offset + address - start)[0]
        raise Unbounded(f"nothing stands at {address:08x}")


class Function:
    """What one function takes of the stack, and whom it calls."""

    def __init__(self, name: str):
        self.name = name
        self.frame_bytes = 0
        self.calls: set[str] = set()
        # Address of each call through a pointer, and the place in a table that it is read from; None: not known.
        self.pointers: list[tuple[str, int | None]] = []


def registers(listed: str) -> int:
    """Number of registers in {r4, r5-r7, d8-d9}."""
    count = 0
    for item in listed.strip("{} ").split(","):
        names = [n.strip() for n in item.split("-")]
        numbers = [int(re.sub(r"\D", "", n) or -1) for n in names]
        count += numbers[-1] - numbers[0] + 1
    return count


def taken(operation: str, arguments: str, where: str) -> int:
    """Bytes by which an instruction lowers the stack pointer."""
    if operation == "push" or re.match(r"stmdb", operation) and arguments.startswith("sp!"):
        return 4 * registers(arguments[arguments.index("{"):])
    if operation == "vpush":
        return (8 if "d" in arguments else 4) * registers(arguments)
    if m := re.match(r".*\[sp, #-(\d+)\]!", arguments):
        return int(m[1])
    if operation.startswith("sub") and re.match(r"sp, ", arguments):
        m = re.match(r"sp, (?:sp, )?#(\d+)$", arguments)
        if not m:
            raise Unbounded(f"{where}: the frame has no fixed size: {operation} {arguments}")
        return int(m[1])
    return 0


def disassemble(objdump: str, elf: str) -> dict[str, Function]:
    """All functions of the image."""
    text = subprocess.run([objdump, "-d", "--no-show-raw-insn", elf], check=True, capture_output=True, text=True).stdout
    functions: dict[str, Function] = {}
    now = None
    loads: dict[str, str] = {}
    for line in text.splitlines():
        if m := re.match(r"^[0-9a-f]+ <(.+)>:", line):
            now = functions.setdefault(m[1], Function(m[1]))
            loads = {}
            continue
        m = re.match(r"^\s*([0-9a-f]+):\s+([a-z]\S*)\s*([^@;]*)", line)
        if not m or now is None:
            continue
        operation, arguments = m[2].removesuffix(".w").removesuffix(".n"), m[3].strip()
        now.frame_bytes += taken(operation, arguments, now.name)
        target = re.search(r"<([^>+]+)>$", line.split("@")[0].strip()) if re.match(r"^(b|cb)", operation) else None
        if target and (operation == "bl" or target[1] != now.name):
            now.calls.add(re.sub(r"^__(.+)_veneer$", r"\1", target[1]))  # the linker's jump over a long distance
        elif operation == "blx" or operation.startswith("bx") and arguments != "lr":
            place = re.match(r"\[r\d+, #(\d+)\]", loads.get(arguments, ""))
            now.pointers.append((m[1], int(place[1]) // 4 if place else None))
        elif operation == "ldr" and not (
                not arguments.startswith("pc, ") or re.search(r"\[sp\]|lsl #2\]", arguments) or  # return, switch
                now.name.endswith("_veneer")):
            raise Unbounded(f"{now.name}: jumps through memory: {line.strip()}")
        if "," in arguments:
            register, value = arguments.split(",", 1)
            loads[register] = value.strip() if operation.startswith("ldr") else ""
    return functions


def behind_arguments(mangled: str, at: int) -> int:
    """Behind the arguments of a template that begin at `at`, with the I."""
    depth = 0
    while at < len(mangled):
        if m := re.match(r"\d+", mangled[at:]):
            at += len(m[0]) + int(m[0])
            continue
        if mangled[at] == "L":  # a number, with its type
            at = mangled.index("E", at) + 1
            continue
        depth += mangled[at] in "IN"
        depth -= mangled[at] == "E"
        at += 1
        if depth == 0:
            break
    return at


def unqualified(mangled: str) -> str:
    """Name of a member function without its classes and their template arguments."""
    at, name = re.search(r"N[KVRO]*(?=\d|St|12_GLOBAL)", mangled), ""
    at = at.end() if at else 0
    while m := re.match(r"(\d+)", mangled[at:]):
        at += len(m[1])
        name, at = mangled[at:at + int(m[1])], at + int(m[1])
        if name and at < len(mangled) and mangled[at] == "I":
            at = behind_arguments(mangled, at)
    return name


def source_of(place: str) -> pathlib.Path:
    """The file of the project that the compiler named. A compiler cache may hand over objects of another folder."""
    parts = os.path.normpath(place).split("/")
    inside = (ROOT.joinpath(*parts[k:]) for k in range(1, len(parts)))
    return next((path for path in inside if path.is_file()), pathlib.Path(place))


def names_called(addr2line: str, elf: str, addresses: list[str]) -> dict[str, set[str]]:
    """Names before parentheses about the line of each address: a call of several lines has the place of one of them."""
    told = subprocess.run([addr2line, "-e", elf], input="\n".join(addresses), check=True, capture_output=True,
                          text=True)
    out = {}
    for address, place in zip(addresses, told.stdout.splitlines(), strict=True):
        file, line = place.split(" ")[0].rsplit(":", 1)
        source = source_of(file)
        if not line.isdigit() or not source.is_file():
            continue
        lines = source.read_text().splitlines()[max(0, int(line) - 2):int(line) + 1]
        out[address] = set(re.findall(r"(\w+)\(", "\n".join(lines)))
    return out


def virtual_tables(elf: Elf, addresses: dict[int, str]) -> list[tuple[int, str]]:
    """(place, function) of every entry of every class."""
    out = []
    for name, address, size in elf.symbols():
        if not name.startswith("_ZTV"):
            continue
        place = -2
        for at in range(address, address + size, 4):
            function = addresses.get(elf.word(at) & ~1)
            if function is None and place >= 0:
                place = -2  # the table of the next base: offset and type stand first
            if function is not None:
                out.append((place, function))
            place += 1
    return out


def instructions(objdump: str, path: str) -> set[int]:
    """Addresses of the words that are instructions of a function: such a word may look like an address."""
    text = subprocess.run([objdump, "-d", "--no-show-raw-insn", path], check=True, capture_output=True, text=True).stdout
    found = re.findall(r"^\s*([0-9a-f]+):\s+(\S+)", text, re.M)
    return {int(at, 16) & ~3 for at, operation in found if operation != ".word"}


def require_rules(elf: Elf, addresses: dict[int, str], tables: list[tuple[int, str]], code: set[int]) -> None:
    """Every function whose address stands somewhere is one that a call through a pointer is followed into."""
    known = {name for _, name in tables}
    ranges = sorted((a & ~1, (a & ~1) + size) for _, a, size in elf.symbols(functions=True) if size > 0)
    starts = [start for start, _ in ranges]
    veneers = {address & ~1 for name, address, _ in elf.symbols() if name.endswith("_veneer")}
    for at, word in elf.words():
        name = addresses.get(word & ~1) if word & 1 else None
        if name is None or name in known or at - 4 in veneers or re.search(NEVER_CALLED, name):
            continue
        if name.endswith("_handler"):  # the vectors
            continue
        k = bisect.bisect_right(starts, at) - 1
        if k >= 0 and at < ranges[k][1] and at in code:
            continue
        if not any(rule is not None and re.search(rule, name) for rule in POINTERS.values()):
            raise Unbounded(f"{name}: its address stands at {at:08x}, and no rule of POINTERS says who calls it")


def resolve(functions: dict[str, Function], names: dict[str, set[str]], tables: list[tuple[int, str]]) -> None:
    """Adds the targets of calls through pointers."""
    for f in functions.values():
        if not f.pointers:
            continue
        rules = [callees for caller, callees in POINTERS.items() if re.search(caller, f.name)]
        if rules:
            f.calls |= {g for g in functions if rules[0] is not None and re.search(rules[0], g)}
            continue
        for address, place in f.pointers:
            wanted = names.get(address, set())
            targets = {g for at, g in tables if place in (None, at) and unqualified(g) in wanted}
            if not targets:
                raise Unbounded(f"{f.name}: who is called at place {place}, one of {sorted(wanted)}, is not known"
                                + ("" if wanted else "; is the line of the call in the image (-g1)?"))
            f.calls |= targets


def deepest(functions: dict[str, Function], name: str, known: dict[str, tuple[int, list[str]]],
            way: tuple[str, ...] = ()) -> tuple[int, list[str]]:
    """Bytes of the deepest chain of calls from `name`, and the chain."""
    if name in way:
        raise Unbounded("recursion: " + " -> ".join(way[way.index(name):] + (name,)))
    if name not in known:
        f = functions[name]
        below = max((deepest(functions, g, known, way + (name,)) for g in sorted(f.calls)),
                    key=lambda found: found[0], default=(0, []))
        known[name] = (f.frame_bytes + below[0], [f"{f.frame_bytes:5} {name}"] + below[1])
    return known[name]


def levels(functions: dict[str, Function], header: str) -> dict[int, list[str]]:
    """Handlers of each priority, the least urgent first."""
    text = pathlib.Path(header).read_text()
    out: dict[int, list[str]] = {}
    for name in functions:
        if not name.endswith("_handler") or name == "reset_handler" or re.search(NO_HANDLER, name):
            continue
        rule = next((r for r in HANDLERS if re.search(r, name)), None)
        if rule is None:
            raise Unbounded(f"{name}: a handler without a priority in HANDLERS")
        constant = HANDLERS[rule]
        found = re.search(rf"\b{constant} = (0x[0-9A-F]+|\d+);", text)
        if constant is not None and not found:
            raise Unbounded(f"{name}: no {constant} in {header}")
        out.setdefault(NMI_PRIORITY if constant is None else int(found[1], 0), []).append(name)
    return dict(sorted(out.items(), reverse=True))


def bound(objdump: str, addr2line: str, elf_path: str, header: str) -> tuple[int, list[str]]:
    """Bytes that the stack may need at most, and the chains that need them."""
    elf = Elf(elf_path)
    addresses = {address & ~1: name for name, address, _ in elf.symbols(functions=True)}
    functions = disassemble(objdump, elf_path)
    tables = virtual_tables(elf, addresses)
    require_rules(elf, addresses, tables, instructions(objdump, elf_path))
    called = [address for f in functions.values() for address, _ in f.pointers]
    resolve(functions, names_called(addr2line, elf_path, called), tables)
    known: dict[str, tuple[int, list[str]]] = {}
    total, chain = deepest(functions, "reset_handler", known)
    for priority, handlers in levels(functions, header).items():
        below, calls = max((deepest(functions, h, known) for h in handlers), key=lambda found: found[0])
        total += EXCEPTION_BYTES + below
        chain = chain + [f"{EXCEPTION_BYTES:5} exception of priority {priority}"] + calls
    return total, chain


def main(objdump: str, addr2line: str, elf_path: str, header: str, output: str) -> int:
    elf = Elf(elf_path)
    at = {name: address for name, address, _ in elf.symbols()}
    reserved = at["triskin_stack_top"] - at["triskin_stack_bottom"]
    try:
        most, chain = bound(objdump, addr2line, elf_path, header)
    except Unbounded as error:
        print(f"{elf_path}: the stack has no bound: {error}", file=sys.stderr)
        pathlib.Path(elf_path).unlink()
        return 1
    pathlib.Path(output).write_text(f"{most}\n" + "\n".join(chain) + "\n")
    print(f"{pathlib.Path(elf_path).name}: stack at most {most} of {reserved} bytes")
    if most > reserved:
        print(f"{elf_path}: the stack may overflow; {output} has the chain", file=sys.stderr)
        pathlib.Path(elf_path).unlink()
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
