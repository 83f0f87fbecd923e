#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds in the graph of calls what runs while a page of the flash is erased, and places it in RAM.

  place_ram_code.py place OBJDUMP ADDR2LINE ELF MAP OUTPUT       ELF: linked with nothing in RAM
  place_ram_code.py check OBJDUMP ADDR2LINE ELF OUTPUT           the image itself

The bank that is erased stalls whoever reads it for 22 ms (RM0440 3.3.5). Running meanwhile are the functions that begin
an erase and wait for it, all interrupt handlers, and whatever these call: tools/check_stack.py follows the calls. Their
constants are found where their code refers to them, and each table of virtual functions counts. `place` writes the input
sections of all that as lines of a linker script. `check` fails when a function or a constant of that set lies in flash
after all, and writes a list of the set. A call that cannot be followed is an error in both."""
import bisect
import pathlib
import re
import subprocess
import sys

import check_stack

# Functions that begin an erase or a program operation and wait for it, which stalls the bank in the same way.
ROOTS = r"N7triskin5board(16erase_flash_page|18program_flash_unit|19write_flash_options|22write_flash_protection)"
# Reset the controller: nobody waits for them.
NOT_FOLLOWED = r"^(default_handler|hard_fault_handler|note_fault)$|N7triskin5board(4fail|9note_hang)|12_GLOBAL__N_16finish"
# Constants that are reached through a pointer in RAM.
REACHED_BY_POINTER = r"_ZTV|kSampling"
FLASH, FLASH_END = 0x08000000, 0x08080000


class Graph:
    """What may run during an erase, and the constants that its code names."""

    def __init__(self, objdump: str, addr2line: str, path: str):
        self.elf = check_stack.Elf(path)
        self.addresses = {a & ~1: n for n, a, _ in self.elf.symbols(functions=True)}
        names = {n for n, _, _ in self.elf.symbols(functions=True)}  # objdump takes constants for code, too
        self.functions = {n: f for n, f in check_stack.disassemble(objdump, path).items() if n in names}
        tables = check_stack.virtual_tables(self.elf, self.addresses)
        called = [a for f in self.functions.values() for a, _ in f.pointers]
        check_stack.resolve(self.functions, check_stack.names_called(addr2line, path, called), tables)
        self.words = literal_words(objdump, path)
        self.reached: set[str] = set()
        for name in self.functions:
            if name.endswith("_veneer"):  # the linker's jump over a long distance, on the way there
                continue
            if re.search(ROOTS, name) or (name.endswith("_handler") and name != "reset_handler"):
                self.follow(name)

    def follow(self, name: str) -> None:
        if name in self.reached or name not in self.functions or re.search(NOT_FOLLOWED, name):
            return
        self.reached.add(name)
        for callee in self.functions[name].calls:
            self.follow(callee)

    def constants(self) -> set[int]:
        """Addresses in flash that the code that is reached refers to, and constants behind pointers."""
        own = {name: address for name, address, _ in self.elf.symbols()}
        end = own["triskin_image_end"]
        origin = own["triskin_vectors"]
        at = {word for name in self.reached for word in self.words.get(name, ()) if origin < word < end}
        at = {word for word in at if word & ~1 not in self.addresses}
        return at | {a for n, a, _ in self.elf.symbols() if re.search(REACHED_BY_POINTER, n) and FLASH <= a < FLASH_END}


def literal_words(objdump: str, path: str) -> dict[str, list[int]]:
    """The words of each function's pool of literals."""
    text = subprocess.run([objdump, "-d", "--no-show-raw-insn", path], check=True, capture_output=True, text=True).stdout
    out: dict[str, list[int]] = {}
    name = ""
    for line in text.splitlines():
        if m := re.match(r"^[0-9a-f]+ <(.+)>:", line):
            name = m[1]
        elif m := re.search(r"\.word\s+0x([0-9a-f]+)", line):
            out.setdefault(name, []).append(int(m[1], 16))
        elif "movt" in line:
            raise check_stack.Unbounded(f"{name}: an address is made of two halves (movt): constants cannot be found")
    return out


class Map:
    """Input sections by address, as the linker's map has them."""

    def __init__(self, path: str):
        text = pathlib.Path(path).read_text().split("Linker script and memory map")[1]
        text = re.sub(r"^( \.\S+)\n +(0x)", r"\1 \2", text, flags=re.M)  # long names have a line for themselves
        rows = re.findall(r"^ (\.(?:text|rodata)\S*) +0x([0-9a-f]+) +0x([0-9a-f]+) (\S+)$", text, re.M)
        self.sections = sorted((int(a, 16), int(size, 16), name, file) for name, a, size, file in rows if int(size, 16) > 0
                               and int(a, 16) != 0)
        self.starts = [s[0] for s in self.sections]

    def at(self, address: int) -> tuple[int, int, str, str]:
        k = bisect.bisect_right(self.starts, address) - 1
        if k < 0 or address >= self.sections[k][0] + self.sections[k][1]:
            raise check_stack.Unbounded(f"{address:08x}: no input section of the map lies there")
        return self.sections[k]


def pattern(section: str, file: str) -> str:
    """A line of the linker script that takes this input section of this file alone."""
    member = re.search(r"([^/]+)\((.+)\)$", file)
    place = f"*{member[1]}:{member[2]}" if member else f"*{file.rsplit('/', 1)[-1]}"
    return f"{place}({section})"


def place(objdump: str, addr2line: str, elf: str, map_file: str, output: str) -> None:
    graph, sections = Graph(objdump, addr2line, elf), Map(map_file)
    by_name = {name: address & ~1 for name, address, _ in graph.elf.symbols(functions=True)}
    wanted = {sections.at(by_name[name]) for name in graph.reached}
    todo = [sections.at(a) for a in graph.constants()]
    while todo:  # constants that point to constants
        start, size, name, file = section = todo.pop()
        if section in wanted:
            continue
        wanted.add(section)
        for at in range(start & ~3, start + size - 3, 4):
            word = graph.elf.word(at)
            if FLASH <= word < FLASH_END and word & ~1 not in graph.addresses and sections.starts[0] <= word:
                try:
                    todo.append(sections.at(word))
                except check_stack.Unbounded:
                    pass  # a number that looks like an address
    lines = sorted(pattern(name, file) for _, _, name, file in wanted)
    pathlib.Path(output).write_text("\n".join(["/* Made by tools/place_ram_code.py from the graph of calls. */", *lines, ""]))
    print(f"{len(graph.reached)} functions run while a page is erased, {sum(s[1] for s in wanted)} bytes with their constants")


def check(objdump: str, addr2line: str, elf: str, output: str) -> None:
    graph = Graph(objdump, addr2line, elf)
    where = {name: address & ~1 for name, address, _ in graph.elf.symbols(functions=True)}
    wrong = [name for name in sorted(graph.reached) if FLASH <= where[name] < FLASH_END]
    for address in sorted(graph.constants()):
        wrong.append(f"constant at {address:08x}")
    pathlib.Path(output).write_text("\n".join(sorted(graph.reached)) + "\n")
    if wrong:
        raise check_stack.Unbounded("runs or is read while a page is erased, and lies in flash: " + ", ".join(wrong))


def main(mode: str, *arguments: str) -> int:
    try:
        {"place": place, "check": check}[mode](*arguments)
    except check_stack.Unbounded as error:
        print(f"{arguments[2]}: {error}", file=sys.stderr)
        pathlib.Path(arguments[2]).unlink()
        return 1
    return 0


if __name__ == "__main__":
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    sys.exit(main(*sys.argv[1:]))
