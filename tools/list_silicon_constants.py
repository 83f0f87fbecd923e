#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists the constants of headers about the silicon, and holds the list against tests/firmware/silicon/facts.txt.

  list_silicon_constants.py FACTS HEADER... [--sources FILE...] [--table OUT]

A constant is what `inline constexpr` declares in a namespace. Each needs a fact, each fact its constant; the sources may
not hold addresses, bits or shifts of registers as numbers. --table writes the C++ rows of the test. Exit 1 with a list
of what is missing."""
import argparse
import pathlib
import re
import sys


def split_top(text):
    """The declarators of one declaration: split at commas outside brackets."""
    parts, depth, start = [], 0, 0
    for at, c in enumerate(text):
        depth += c in "({[<" and (c != "<" or text[at:at + 2] != "<<") and text[at - 1:at + 1] != "<<"
        depth -= c in ")}]"
        if c == "," and depth == 0:
            parts.append(text[start:at])
            start = at + 1
    return parts + [text[start:]]


def constants(path):
    """(qualified name) of every constant of a header, namespaces after triskin::board or triskin::fw."""
    text = re.sub(r"//[^\n]*", "", pathlib.Path(path).read_text())
    stack, found = [], []
    for m in re.finditer(r"namespace ([\w:]+) \{|inline constexpr ([^;]+);|([{}])", text):
        if m[1]:
            stack.append(m[1])
        elif m[2]:
            prefix = "::".join(s for s in stack if s)
            prefix = re.sub(r"^triskin(::(board|fw))?(::)?", "", prefix)
            for k, part in enumerate(split_top(m[2])):
                name = re.search(r"(\w+)\s*(\[(\d+)\])?\s*(=|\{)", part)
                if name is None:
                    sys.exit(f"{path}: cannot read '{part.strip()}'")
                whole = (prefix + "::" if prefix else "") + name[1]
                found += [f"{whole}[{i}]" for i in range(int(name[3]))] if name[3] else [whole]
        elif m[3] == "{":
            stack.append("")
        elif stack:
            stack.pop()
    return found


# `address`, `offset` and names are words; a reset value's address is a number.
EXPRESSION = re.compile(r"-|0x[0-9A-Fa-f]+.*|[A-Za-z_(~].*")


def facts(path):
    """[constant, register, bit, value, source] of each line."""
    out = []
    for number, line in enumerate(pathlib.Path(path).read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        columns = [c.replace("\\|", "|").strip() for c in re.split(r"(?<!\\)\|", line)]
        if len(columns) != 5 or not all(columns):
            sys.exit(f"{path}:{number}: five columns are needed: constant | register | bit | value | source")
        if not EXPRESSION.fullmatch(columns[2]):
            sys.exit(f"{path}:{number}: bit {columns[2]}: an expression of the vendor's header is needed, address, offset or -; "
                     "bits without a name there stand at the register, REGISTER[5:0]")
        out.append(columns)
    return out


def numbers_in(path):
    """Lines of a source that name a register's address, a bit or a shift as a number."""
    raw = re.compile(r"0x[45E]00[0-9A-Fa-f]{5}|\bbit\(\d|<< (1\d|2\d|30|31)|>> (1\d|[2-9]\d)")
    lines = pathlib.Path(path).read_text().splitlines()
    return [f"{path}:{n}: {l.strip()}" for n, l in enumerate(lines, 1) if raw.search(re.sub(r"//.*", "", l))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("facts")
    parser.add_argument("headers", nargs="+")
    parser.add_argument("--sources", nargs="*", default=[])
    parser.add_argument("--table")
    args = parser.parse_args()
    known = facts(args.facts)
    names = [f[0] for f in known if f[0] != "reset"]
    listed = [c for h in args.headers for c in constants(h)]
    bad = [f"no fact in {args.facts}: {c}" for c in listed if c not in names]
    bad += [f"{args.facts}: no such constant in the headers: {n}" for n in names if n not in listed and "(" not in n]
    bad += [f"{args.facts}: twice: {n}" for n in sorted(set(names)) if names.count(n) > 1]
    for source in args.sources:
        bad += [f"a register's number without a name: {line}" for line in numbers_in(source)]
    if bad:
        print("\n".join(bad))
        return 1
    if args.table:
        rows = [f'    {{"{f[0]}", value_of({f[0]}), {f[3]}ULL}},\n' for f in known if f[0] != "reset"]
        rows.append("};\nconst std::vector<Reset> kResets{\n")
        rows += [f'    {{"{f[1]}", {f[2]}U, {f[3]}U}},\n' for f in known if f[0] == "reset"]
        pathlib.Path(args.table).write_text("const std::vector<Row> kRows{\n" + "".join(rows) + "};\n")
    print(f"{len(listed)} constants, each with its fact; {len(known) - len(names)} reset values")
    return 0


if __name__ == "__main__":
    sys.exit(main())
