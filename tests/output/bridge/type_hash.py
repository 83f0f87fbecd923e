# SPDX-License-Identifier: GPL-3.0-or-later
"""Computes the ROS 2 hash of message types (REP-2016, RIHS01) from their definitions, and compares.
Usage: type_hash.py FILE   lines "TYPE HASH", each followed by its definition and a line "@@@@"
"""
import hashlib
import json
import re
import sys

NUMBERS = {"int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9, "float32": 10,
           "float64": 11, "char": 13, "bool": 15, "byte": 16, "string": 17}
NESTED, ARRAY, SEQUENCE = 1, 48, 144


def full(name):
    parts = name.split("/")
    return f"{parts[0]}/msg/{parts[-1]}"


def field(line, package):
    kind, name = line.split()
    base, bracket, size = re.match(r"([\w/]+)(\[(\d*)\])?$", kind).groups()
    nested = "" if base in NUMBERS else full(base if "/" in base else f"{package}/{base}")
    number = NUMBERS.get(base, NESTED) + (0 if not bracket else ARRAY if size else SEQUENCE)
    return {"name": name, "type": {"type_id": number, "capacity": int(size or 0), "string_capacity": 0,
                                   "nested_type_name": nested}}


def types_of(name, definition):
    found = {}
    for k, part in enumerate(definition.split("=" * 80 + "\n")):
        lines = part.splitlines()
        me = full(lines.pop(0).split()[1]) if k else name
        lines = [line.split("#")[0].strip() for line in lines]
        fields = [field(line, me.split("/")[0]) for line in lines if line and "=" not in line]
        found[me] = {"type_name": me, "fields": fields}
    return found


def type_hash(name, definition):
    found = types_of(name, definition)
    text = {"type_description": found.pop(name), "referenced_type_descriptions": [found[k] for k in sorted(found)]}
    text = json.dumps(text, ensure_ascii=True, separators=(", ", ": "))
    return "RIHS01_" + hashlib.sha256(text.encode()).hexdigest()


# ROS 2 Jazzy prints these hashes for two of its own types (ros2 topic info --verbose).
assert type_hash("std_msgs/msg/String", "string data\n") == \
    "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"
assert type_hash("builtin_interfaces/msg/Time", "int32 sec\nuint32 nanosec\n") == \
    "RIHS01_b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"
bad = 0
for entry in open(sys.argv[1]).read().split("@@@@\n"):
    if not entry:
        continue
    head, definition = entry.split("\n", 1)
    name, given = head.split()
    if type_hash(name, definition) != given:
        print(f"{name}: is {type_hash(name, definition)}, the bridge says {given}")
        bad = 1
sys.exit(bad)
