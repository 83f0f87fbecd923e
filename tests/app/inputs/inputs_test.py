#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Hands what people have to the program and holds what it says against what is right, kind by kind.
Usage: inputs_test.py TRISKIN WRITE_STRIP PART.step PYTHON_FOLDER TRIALS PAGE NODE NODE_MODULES [--write] [KIND]
PAGE (docs/measurements/inputs.md) is the table of all members, which --write makes anew. PYTHON_FOLDER and NODE may be empty.
TRIALS is the folder of the files that were recreated from reports; they are left out where it is not there.
Exit status: 0 all are answered rightly and each kind has eight members, three of them found here; 1 otherwise."""
import base64
import csv
import gzip
import html
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

import members as m
from members import FOUND, REPORTED

TRISKIN, WRITE_STRIP, STEP, PYTHON, TRIALS, PAGE, NODE, NODE_MODULES = sys.argv[1:9]
WRITES = "--write" in sys.argv[9:]
ONLY = [a for a in sys.argv[9:] if a != "--write"]
GOOD_STEP = pathlib.Path(STEP).read_text(encoding="utf-8")
ALL = []
STRIP = ""  # a design, once it is written


def add(kind, what, who, files, command, status, pattern):
    ALL.append((kind, what, who, files, command, status, pattern))


def mesh(kind, what, who, name, data, status, pattern, more=""):
    add(kind, what, who, {name: data}, f"extract {name} -o out.obj {more}".strip(), status, pattern)


# The block of 120 × 90 × 40 mm has 2 (120·90 + 90·40 + 40·120) mm² = 384 cm².
BLOCK = r"120\.0 × 90\.0 × 40\.0 mm: 12 faces, 384\.0 cm²"


def recordings(own, count):
    """`count` is what replay says of the recording as it was written: other writers' forms of it have to say the same."""
    k = "recordings"
    same = list
    back = lambda ms: ms[::-1]
    shuffled = lambda ms: ms[1::2] + ms[::2]
    for what, who, data in [
            ("channel numbers from 0, in a chunk (official TypeScript library)", REPORTED, m.rewritten(own, True, same, -1)),
            ("channel numbers from 0, no chunks", REPORTED, m.rewritten(own, False, same, -1)),
            ("messages in reverse order", REPORTED, m.rewritten(own, True, back, 0)),
            ("reversed, no chunks, channels from 0", FOUND, m.rewritten(own, False, back, -1)),
            ("every other message first", FOUND, m.rewritten(own, True, shuffled, 0)),
            ("channel numbers from 40,000", FOUND, m.rewritten(own, True, same, 40_000))]:
        add(k, what, who, {"a.mcap": data}, "replay a.mcap --speed 0", 0, count)
    add(k, "the same, recovered: the new file plays too", FOUND, {"a.mcap": m.rewritten(own, False, back, -1)},
        "recover a.mcap -o b.mcap", 0, r"is whole")
    add(k, "candump log", REPORTED, {"a.log": b"(1700000000.000100) can0 18DA01F1#0322F190\n"}, "replay a.log", 2, "a candump log; give an MCAP")
    lost = r"{}, where samples of a skin have triskin_msgs/msg/RawFrame"
    for what, change, why in [("lost (schema 0)", lambda name: (0, name), r"has no type \(its schema is 0\)"),
                              ("not in the file", lambda name: (999, name), r"names schema 999, which is not in the file"),
                              ("renamed", lambda name: (None, name.replace("RawFrame", "Raw")), r"has the type triskin_msgs/msg/Raw")]:
        data = m.retyped(own, change)
        add(k, f"type of the samples {what}: played", FOUND, {"a.mcap": data}, "replay a.mcap --speed 0", 1, lost.format(why))
        add(k, f"type of the samples {what}: recovered", FOUND, {"a.mcap": data}, "recover a.mcap -o b.mcap", 0, lost.format(why))
    add(k, "bag of ROS 1", FOUND, {"a.bag": b"#ROSBAG V2.0\nE\0\0\0"}, "replay a.bag", 2, "a bag of ROS 1; give an MCAP")
    for what, name, data, pattern in [
            ("log of Vector tools (ASC)", "a.asc", b"date Mon Jan 1 10:00:00 2024\nbase hex  timestamps absolute\n", r"a log of Vector tools \(ASC\); give an MCAP"),
            ("trace of PEAK tools", "a.trc", b";$FILEVERSION=1.1\n;$STARTTIME=43000.5\n", r"a trace of PEAK tools \(TRC\); give an MCAP"),
            ("list of a bag of ROS 2", "metadata.yaml", b"rosbag2_bagfile_information:\n  version: 5\n", r"the list of a bag of ROS 2 .*give the \.mcap beside it"),
            ("HDF5 of record", "a.h5", b"\x89HDF\r\n\x1a\n" + bytes(90), "an HDF5 file; give an MCAP"),
            ("compressed recording", "a.mcap.zst", b"\x28\xb5\x2f\xfd" + bytes(20), "Zstandard data; unpack it with unzstd"),
            ("log of PX4", "a.ulg", b"ULog\x01\x12\x35\x01" + bytes(20), r"a log of PX4 \(ULog\); give an MCAP"),
            ("measurement of LabVIEW", "a.tdms", b"TDSm" + bytes(40), r"a measurement of LabVIEW \(TDMS\); give an MCAP"),
            ("mesh", "a.obj", m.obj(m.block()), r"a mesh \(OBJ\); give an MCAP"),
            ("array of NumPy", "a.npy", b"\x93NUMPY\x01\0v\0", "an array of NumPy; give an MCAP"),
            ("something unknown", "a.dat", b"\1\2\3\4" * 40, r"not an MCAP file \(wrong first bytes\); give one that")]:
        add(k, what, FOUND, {name: data}, f"replay {name}", 2, pattern)
    add(k, "table given to recover", FOUND, {"a.csv": b"link_time_us,device_time_us\n1,2\n2,3\n"}, "recover a.csv -o b.mcap", 2, r"a table of text \(CSV\); give an MCAP")
    no_design = r"holds samples of a skin \(/skin/.*but not its design: .*add the design to this one as the attachment design\.json"
    add(k, "attachments behind the samples", FOUND, {"a.mcap": m.with_attachments(own, "behind")}, "replay a.mcap --speed 0", 0, count)
    add(k, "attachments left out", FOUND, {"a.mcap": m.with_attachments(own, "none")}, "replay a.mcap --speed 0", 2, no_design)
    add(k, "attachments left out, shown in the browser", FOUND, {"a.mcap": m.with_attachments(own, "none")}, "export a.mcap --format html -o a.html", 2, no_design)
    add(k, "recording of a camera", FOUND, {"a.mcap": m.recording_of("/camera", "sensor_msgs/msg/Image")}, "replay a.mcap", 2, r"holds /camera, but nothing of a skin; give a file that \"triskin record\"")
    add(k, "recording without a message", FOUND, {"a.mcap": m.recording_of("", "")}, "replay a.mcap", 2, r"holds no message; give a file that \"triskin record\"")
    add(k, "cut before its first sample", FOUND, {"a.mcap": own[:600]}, "replay a.mcap", 2, r"was cut before its first sample \(ends at byte 600 without having been closed\)")
    add(k, "empty file", FOUND, {"a.mcap": b""}, "replay a.mcap", 2, "not an MCAP file: it is empty; give one")
    add(k, "empty file given to recover", FOUND, {"a.mcap": b""}, "recover a.mcap -o b.mcap", 2, "not an MCAP file: it is empty; give one")
    add(k, "folder of a bag of ROS 2", FOUND, {}, "replay .", 2, r"is a folder; give a recording in it, as .*_0\.mcap")
    add(k, "extension in capitals, read", FOUND, {"A.MCAP": own}, "export A.MCAP --format html -o a.html", 0, r"a\.html")
    for name in ("A.MCAP", "A.CSV"):
        add(k, f"extension in capitals, written: {name}", FOUND, {}, f"record strip.json --link sim --seconds 0.1 -o {name}", 0, f"-> {re.escape(name)}")
    add(k, "divided by time: parts from _0 on, as rosbag2 names them", FOUND, {}, "record strip.json --link sim --seconds 2.5 --split 1s -o a.mcap", 0, r"-> a_2\.mcap and 2 files before it")
    add(k, "divided by nothing", FOUND, {}, ["record", "strip.json", "--link", "sim", "--split", "", "-o", "a.mcap"], 2, "--split: the value is empty")
    add(k, "disk that is full after 100 kB", REPORTED, {}, ("limited", 100, "record strip.json --link sim --seconds 600 -o a.mcap", "replay a.mcap --speed 0"), 0, r"(?s)a\.mcap: .*File too large.*module samples in")
    add(k, "disk that is full after 100 kB, HDF5", REPORTED, {}, ("limited", 100, "record strip.json --link sim --seconds 600 -o a.h5", ""), 0, r"a\.h5: .*|without HDF5")
    add(k, "disk that is full after 100 kB, CSV", FOUND, {}, ("limited", 100, "record strip.json --link sim --seconds 600 -o a.csv", ""), 0, r"a\.csv: .*File too large")
    add(k, "bag of ROS 2 in SQLite", FOUND, {"a.db3": b"SQLite format 3\0" + bytes(80)}, "replay a.db3", 2, r"a database \(SQLite")
    add(k, "table of our own", FOUND, {"a.csv": b"link_time_us,device_time_us,sample\n1,2,3\n4,5,6\n"}, "replay a.csv", 2, r"a table of text \(CSV\); give an MCAP")


def switched_off():
    k = "switched off by the author"
    left = r"switched off in the file and left out: {}"
    mesh(k, "glTF: node with KHR_node_visibility false", REPORTED, "a.gltf", m.gltf([{"mesh": 0}, m.hidden({"name": "jig", "mesh": 0, "translation": [0.3, 0, 0]})], scenes=(0, 1)), 0, BLOCK)
    mesh(k, "glTF: visible child of a hidden node", FOUND, "a.gltf", m.gltf([{"mesh": 0}, m.hidden({"name": "jig", "children": [2]}), {"mesh": 0, "translation": [0.3, 0, 0]}], scenes=(0, 1)), 0, left.format("jig"))
    mesh(k, "glTF: the hidden node is asked for", FOUND, "a.gltf", m.gltf([{"mesh": 0, "translation": [0.3, 0, 0]}, m.hidden({"name": "jig", "mesh": 0})], scenes=(0, 1)), 0, BLOCK, "--object jig")
    mesh(k, "glTF: visibility among the required extensions, all hidden", FOUND, "a.gltf", m.gltf([m.hidden({"name": "jig", "mesh": 0})], extra={"extensionsRequired": ["KHR_node_visibility"]}, used=["KHR_node_visibility"]), 2, "no triangle.*jig")
    mesh(k, "3MF: printable=\"0\" of an item", REPORTED, "a.3mf", m.three_mf(f'<object id="1" type="model">{m.mesh_xml(m.block())}</object><object id="2" name="jig" type="model">{m.mesh_xml(m.block(30, 30, 30))}</object>', '<item objectid="1"/><item objectid="2" printable="0" transform="1 0 0 0 1 0 0 0 1 200 0 0"/>'), 0, left.format(r'jig \(printable="0"\)'))
    modifier = '<metadata type="volume" key="volume_type" value="{}"/>'
    mesh(k, "3MF of PrusaSlicer: modifier", REPORTED, "a.3mf", m.prusa(modifier.format("ParameterModifier")), 0, BLOCK)
    mesh(k, "3MF of PrusaSlicer: negative volume", FOUND, "a.3mf", m.prusa(modifier.format("NegativeVolume")), 0, left.format(r"second \(negative volume\)"))
    mesh(k, "3MF of PrusaSlicer: support blocker", FOUND, "a.3mf", m.prusa(modifier.format("SupportBlocker")), 0, left.format(r"second \(support blocker\)"))
    mesh(k, "3MF of PrusaSlicer: triangles of its volumes not said", FOUND, "a.3mf", m.prusa(modifier.format("ParameterModifier"), first="x"), 2, r"does not say which triangles its volumes have \(firstid, lastid\)")
    mesh(k, "3MF of Slic3r: modifier=\"1\"", FOUND, "a.3mf", m.prusa('<metadata type="volume" key="modifier" value="1"/>'), 0, BLOCK)
    mesh(k, "3MF of Bambu Studio: modifier_part", FOUND, "a.3mf", m.bambu("modifier_part"), 0, BLOCK)
    mesh(k, "3MF of Bambu Studio: negative_part", FOUND, "a.3mf", m.bambu("negative_part"), 0, left.format(r"second \(negative volume\)"))
    mesh(k, "3MF of Cura: support mesh", FOUND, "a.3mf", m.cura("support_mesh"), 0, left.format(r"second \(support\)"))
    block = f'<object id="1" type="model">{m.mesh_xml(m.block())}</object>'
    for role in ("support", "solidsupport"):
        mesh(k, f"3MF: object of the type {role}", FOUND, "a.3mf", m.three_mf(block + f'<object id="2" type="{role}">{m.mesh_xml(m.block(30, 30, 30))}</object>', '<item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 200 0 0"/>'), 0, f'1 object of the type "{role}" is no part of the body and left out.*' + BLOCK)
    mesh(k, "3MF of PrusaSlicer: support enforcer", FOUND, "a.3mf", m.prusa(modifier.format("SupportEnforcer")), 0, left.format(r"second \(support enforcer\)"))
    mesh(k, "3MF of Cura: cutting mesh", FOUND, "a.3mf", m.cura("cutting_mesh"), 0, left.format(r"second \(cutting mesh\)"))
    mesh(k, "glTF: node outside the scene", FOUND, "a.gltf", m.gltf([{"mesh": 0}, {"name": "jig", "mesh": 0, "translation": [0.3, 0, 0]}], scenes=(0,)), 0, BLOCK)
    mesh(k, "glTF: visibility true", FOUND, "a.gltf", m.gltf([{"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": True}}}]), 0, BLOCK)
    for what, style in [("opacity 0", 'opacity="0"'), ("opacity 0 in its style", 'style="fill:red;opacity:0.0"'), ("visibility hidden", 'visibility="hidden"')]:
        add(k, f"SVG: {what}", FOUND, {"a.svg": m.svg(f'<rect width="150" height="120" style="opacity:0.5;fill-opacity:0"/><rect x="300" width="50" height="50" {style}/>')}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    square = '<rect x="300" width="50" height="50" {}/>'
    for what, sheet, attributes in [
            ("not painted by a class of the style sheet", ".h{fill:none;stroke:none}", 'class="x h"'),
            ("hidden by its id in the style sheet", "/* off */ #k { display : none }", 'id="k"'),
            ("hidden by two classes, marked as important", ".a.b{visibility:hidden !important}", 'class="b a" style="visibility:visible"')]:
        add(k, f"SVG: {what}", FOUND, {"a.svg": m.svg(f'<style>{sheet}</style><rect width="150" height="120"/>{square.format(attributes)}')}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    for what, sheet, pattern in [("style sheet in another file", "@import url(a.css);", "the style sheet is in another file"),
                                 ("selector of a kind that is not read", "g > rect{display:none}", 'the selector "g > rect", which is not read'),
                                 ("paint under a condition", "@media (min-width:9px){rect{fill:none}}", "paints under the condition")]:
        add(k, f"SVG: {what}", FOUND, {"a.svg": m.svg(f'<style>{sheet}</style><rect width="150" height="120"/>')}, "place a.svg --method r2", 2, pattern)
    add(k, "SVG: shape that is visible in a group that is not", FOUND, {"a.svg": m.svg('<g visibility="hidden"><rect width="150" height="120" visibility="visible"/>' + square.format("") + "</g>")}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "SVG: shapes that are only defined", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/><defs>' + square.format("") + "</defs><symbol>" + square.format("") + "</symbol>")}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    mesh(k, "3MF: printable=\"false\" of an item", FOUND, "a.3mf", m.three_mf(f'<object id="1" type="model">{m.mesh_xml(m.block())}</object><object id="2" name="jig" type="model">{m.mesh_xml(m.block(30, 30, 30))}</object>', '<item objectid="1"/><item objectid="2" printable="false" transform="1 0 0 0 1 0 0 0 1 200 0 0"/>'), 0, left.format(r'jig \(printable="0"\)'))
    mesh(k, "3MF: object of the type other", FOUND, "a.3mf", m.three_mf(f'<object id="1" type="model">{m.mesh_xml(m.block())}</object><object id="2" type="other">{m.mesh_xml(m.block(30, 30, 30))}</object>', '<item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 200 0 0"/>'), 0, BLOCK)
    solid = re.search(r"(#\d+)\s*=\s*MANIFOLD_SOLID_BREP", GOOD_STEP)[1]
    off = "switched off in the CAD program and left out"
    for what, who, entities in [
            ("STEP: INVISIBILITY of a style", REPORTED, f"#9001=STYLED_ITEM('',(),{solid});\n#9002=INVISIBILITY((#9001));\n"),
            ("STEP: INVISIBILITY of a layer", FOUND, f"#9001=PRESENTATION_LAYER_ASSIGNMENT('off','',({solid}));\n#9002=INVISIBILITY((#9001));\n"),
            ("STEP: layer of styles", FOUND, f"#9001=STYLED_ITEM('',(),{solid});\n#9003=PRESENTATION_LAYER_ASSIGNMENT('off','',(#9001));\n#9002=INVISIBILITY((#9003));\n")]:
        mesh(k, what, who, "a.step", m.step_with(GOOD_STEP, entities), 2, "no face|" + off)
    mesh(k, "DXF layer that is off", FOUND, "a.dxf", b"", 2, "empty")
    ALL.pop()
    layers = "0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n0\nLAYER\n2\njig\n70\n0\n62\n-7\n0\nENDTAB\n0\nENDSEC\n"
    add(k, "DXF: layer that is off", FOUND, {"a.dxf": m.dxf(m.lwpolyline(m.RECTANGLE) + m.lwpolyline([(300, 0), (400, 0), (400, 90)], layer="jig"), tables=layers)}, "place a.dxf --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "SVG: artboard without fill and stroke", FOUND, {"a.svg": m.svg('<rect x="-200" width="600" height="300" fill="none"/><rect width="150" height="120"/>')}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "SVG: display none", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/><g style="display:none"><rect x="300" width="50" height="50"/></g>')}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")


def transforms():
    k = "transforms"
    op = "#9006=CARTESIAN_TRANSFORMATION_OPERATOR_3D('','',$,{});\n"
    add(k, "STEP: operator that scales by 2", REPORTED, {"a.step": m.step_with(GOOD_STEP, m.operator(op.format("$,$,#9005,2.,$")))}, "faces a.step", 2, "#9006: an instance of a part is scaled by 2")
    add(k, "STEP: operator that mirrors", REPORTED, {"a.step": m.step_with(GOOD_STEP, m.operator(op.format("#9001,#9002,#9005,1.,#9004")))}, "faces a.step", 2, "#9006: an instance of a part is mirrored")
    add(k, "STEP: operator written as a complex record, mirrored", FOUND, {"a.step": m.step_with(GOOD_STEP, m.operator("#9006=(CARTESIAN_TRANSFORMATION_OPERATOR(#9001,#9002,#9005,1.)CARTESIAN_TRANSFORMATION_OPERATOR_3D(#9004)FUNCTIONALLY_DEFINED_TRANSFORMATION('','')GEOMETRIC_REPRESENTATION_ITEM()REPRESENTATION_ITEM(''));\n"))}, "faces a.step", 2, "#9006: an instance of a part is mirrored")
    add(k, "STEP: operator that moves only", FOUND, {"a.step": m.step_with(GOOD_STEP, m.operator(op.format("#9001,#9002,#9005,1.,#9003")))}, "faces a.step", 0, r"× .* mm")
    mesh(k, "glTF: node of a skinned mesh, not applied", REPORTED, "a.gltf", m.skinned({"scale": [2, 2, 2]}, {}), 0, BLOCK)
    mesh(k, "glTF: joint that scales, applied", FOUND, "a.gltf", m.skinned({}, {"scale": [2, 2, 2]}), 0, r"240\.0 × 180\.0 × 80\.0 mm: 12 faces, 1536\.0 cm²")
    mesh(k, "glTF: joint that mirrors, outside stays outside", FOUND, "a.gltf", m.skinned({}, {"scale": [-1, 1, 1]}), 0, BLOCK)
    mesh(k, "glTF: two instances (EXT_mesh_gpu_instancing)", FOUND, "a.gltf", m.instanced(), 0, r"420\.0 × 90\.0 × 40\.0 mm: 24 faces, 768\.0 cm²")
    # Half of the target's 40 mm: 2 (120·90 + 90·60 + 60·120) mm².
    mesh(k, "glTF: morph target with weight 0.5", FOUND, "a.gltf", m.morphed(0.5), 0, r"120\.0 × 90\.0 × 60\.0 mm: 12 faces, 468\.0 cm²")
    mesh(k, "AMF with its unit", REPORTED, "a.amf", b'<?xml version="1.0"?><amf unit="inch"><object id="0"/></amf>', 2, "an AMF; export it as OBJ, STL, 3MF or glTF")
    mesh(k, "glTF: node that mirrors", FOUND, "a.gltf", m.gltf([{"mesh": 0, "scale": [-1, 1, 1]}]), 0, BLOCK)
    mesh(k, "glTF: matrix that scales by 2", FOUND, "a.gltf", m.gltf([{"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1]}]), 0, r"240\.0 × 180\.0 × 80\.0 mm: 12 faces, 1536\.0 cm²")
    block = f'<object id="1" type="model">{m.mesh_xml(m.block())}</object>'
    mesh(k, "3MF: item that mirrors", FOUND, "a.3mf", m.three_mf(block, '<item objectid="1" transform="-1 0 0 0 1 0 0 0 1 0 0 0"/>'), 0, BLOCK)
    mesh(k, "3MF: item that scales by 2", FOUND, "a.3mf", m.three_mf(block, '<item objectid="1" transform="2 0 0 0 2 0 0 0 2 0 0 0"/>'), 0, r"240\.0 × 180\.0 × 80\.0 mm")
    mesh(k, "3MF without a namespace (JSCAD)", FOUND, "a.3mf", m.three_mf(block, '<item objectid="1"/>', namespace=""), 0, BLOCK)
    add(k, "DXF: metres", FOUND, {"a.dxf": m.dxf(m.lwpolyline([(0, 0), (.15, 0), (.15, .12), (0, .12)]), "9\n$INSUNITS\n70\n6\n")}, "place a.dxf --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "SVG: rotated group", FOUND, {"a.svg": m.svg('<g transform="translate(120 0) rotate(90)"><rect width="150" height="120"/></g>')}, "place a.svg --method r2", 0, r"120\.0 × 150\.0 mm")
    add(k, "DXF without a unit: said", FOUND, {"a.dxf": m.dxf(m.lwpolyline(m.RECTANGLE), "")}, "place a.dxf --method r2", 0, r"names no unit; its numbers are taken as millimetres.*150\.0 × 120\.0 mm")
    add(k, "DXF without a unit, --unit in", FOUND, {"a.dxf": m.dxf(m.lwpolyline([(0, 0), (6, 0), (6, 5), (0, 5)]), "")}, "place a.dxf --method r2 --unit in", 0, r"^outline of 152\.4 × 127\.0 mm")
    add(k, "SVG in pixels: said", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'width="150" height="120"')}, "place a.svg --method r2", 0, r"pixels, taken as 96 an inch.*39\.7 × 31\.8 mm")
    inside = r"150\.0 × 120\.0 mm"
    for what, body, pattern in [
            ("size of a rectangle in its style", '<rect style="width:150px;height:120px"/>', inside),
            ("style before attribute", '<rect width="10" height="10" style="width:150px; height:120px"/>', inside),
            ("size in a rule of the style sheet", "<style>rect{width:150px;height:120px}</style><rect/>", inside),
            ("radius in its style", '<circle cx="50" cy="50" style="r:60px"/>', r"120\.0 × 120\.0 mm"),
            ("radii of an ellipse by a class", '<style>.e{rx:75px;ry:60px}</style><ellipse class="e" cx="75" cy="60"/>', inside),
            ("place of a second rectangle in its style", '<rect width="100" height="120"/><rect style="x:110px" width="40" height="120"/>', "2 outlines beside each other")]:
        add(k, f"SVG: {what}", FOUND, {"a.svg": m.svg(body)}, "place a.svg --method r2", 2 if "outlines" in pattern else 0, pattern)
    for what, body, pattern in [("path in its style", "<path style=\"d:path('M0,0 H9 V9 Z')\"/>", "its style sets \"d: .*write it as the attribute d"),
                                ("size that is calculated", "<style>rect{width:calc(100px + 50px)}</style><rect height='9'/>", "calc.* is not read"),
                                ("size in per cent", '<rect style="width:50%" height="9"/>', 'width="50%" is no number')]:
        add(k, f"SVG: {what}", FOUND, {"a.svg": m.svg(body)}, "place a.svg --method r2", 2, pattern)
    add(k, "SVG of a page that gives it a share of the page", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'width="150mm" height="120mm" viewBox="0 0 150 120" style="width:100%;height:100%"')}, "place a.svg --method r2", 0, inside)
    add(k, "SVG: its size in its style", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'viewBox="0 0 150 120" style="width:150mm;height:120mm"')}, "place a.svg --method r2", 0, inside)
    add(k, "SVG with a width in mm and no viewBox: said", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'width="150mm" height="120mm"')}, "place a.svg --method r2", 0, r"it has a width but no viewBox, so its numbers are pixels of 1/96 inch.*give --unit mm.*39\.7 × 31\.8 mm")
    mesh(k, "glTF that needs a newer reader", FOUND, "a.gltf", m.gltf([{"mesh": 0}]).replace(b'"version": "2.0"', b'"version": "2.0", "minVersion": "2.1"'), 2, r"needs a reader of glTF 2\.1, and this one reads 2\.0")
    add(k, "SVG with a viewBox alone", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'viewBox="0 0 150 120"')}, "place a.svg --method r2", 2, "does not say how large it is.*pass --unit")
    add(k, "SVG with a viewBox alone, --unit mm", FOUND, {"a.svg": m.svg('<rect width="150" height="120"/>', 'viewBox="0 0 150 120"')}, "place a.svg --method r2 --unit mm", 0, r"150\.0 × 120\.0 mm")
    add(k, "WKT in metres, --unit m", FOUND, {"a.wkt": b"POLYGON((0 0, 0.15 0, 0.15 0.12, 0 0.12, 0 0))"}, "place a.wkt --method r2 --unit m", 0, r"150\.0 × 120\.0 mm")
    mesh(k, "DAE: node that scales by 2", FOUND, "a.dae", m.dae("<scale>2 2 2</scale>"), 0, r"240\.0 × 180\.0 × 80\.0 mm: 12 faces, 1536\.0 cm²")
    mesh(k, "DAE: node that mirrors", FOUND, "a.dae", m.dae("<scale>-1 1 1</scale>"), 0, BLOCK)
    mesh(k, "DAE in inches", FOUND, "a.dae", m.dae("", '<unit meter="0.0254"/>', 1 / 0.0254), 0, BLOCK)
    for unit, per_mm in [("inch", 1 / 25.4), ("foot", 1 / 304.8), ("meter", 1e-3), ("micron", 1e3)]:
        mesh(k, f"3MF: unit {unit}", FOUND, "a.3mf", m.three_mf(f'<object id="1" type="model">{m.mesh_xml(m.scaled(m.block(), per_mm))}</object>', '<item objectid="1"/>', unit=unit), 0, BLOCK)
    add(k, "DXF: inches", FOUND, {"a.dxf": m.dxf(m.lwpolyline([(0, 0), (6, 0), (6, 5), (0, 5)]), "9\n$INSUNITS\n70\n1\n")}, "place a.dxf --method r2", 0, r"152\.4 × 127\.0 mm")


def held():
    k = "what people hold"
    solid = "; export the part as STEP, or as a mesh"
    scene = "; export it as OBJ, STL, 3MF or glTF"
    for what, who, name, data, pattern in [
            ("zip with an STL in it", REPORTED, "a.zip", m.zipped({"cover.stl": m.text_stl(m.block())}), r"a zip archive with cover\.stl in it; unpack it"),
            ("zip of a whole folder", FOUND, "a.zip", m.zipped({f"p{i}.stl": b"x" for i in range(5)}), r"a zip archive with p0\.stl, p1\.stl, p2\.stl and 2 more in it"),
            ("FreeCAD document", REPORTED, "a.FCStd", m.zipped({"Document.xml": b"<Document/>", "PartShape.brp": b"x"}), "a FreeCAD document" + solid),
            ("Parasolid, text", FOUND, "a.x_t", b"**ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz**\n", r"a Parasolid model \(text\)" + solid),
            ("ACIS, text", REPORTED, "a.sat", b"400 0 1 0\n10 ACIS 4.00 9 ACIS 7.0 NT 24 Mon Jan 01 00:00:00 2024\n1 1e-006 1e-010\nbody $-1 $1 $-1 $-1 #\n", r"an ACIS model \(SAT\)" + solid),
            ("ACIS, binary", FOUND, "a.sab", b"ACIS BinaryFile\0\0\0\0", r"an ACIS model \(SAB\)" + solid),
            ("SolidWorks part", FOUND, "a.sldprt", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(60), "SolidWorks.*" + solid),
            ("USD, text", REPORTED, "a.usda", b"#usda 1.0\n", r"a USD scene \(text\)" + scene),
            ("USDZ", FOUND, "a.usdz", m.zipped({"scene.usdc": b"PXR-USDC"}), r"a USD scene \(USDZ\)" + scene),
            ("FBX", FOUND, "a.fbx", b"Kaydara FBX Binary  \0\x1a\0", "an FBX scene" + scene),
            ("AutoCAD drawing", FOUND, "a.dwg", b"AC1032\0\0", r"an AutoCAD drawing \(DWG\); save it as DXF"),
            ("DXF outline", REPORTED, "a.dxf", m.dxf(m.lwpolyline(m.RECTANGLE)), 'a DXF drawing; it belongs to "triskin place"'),
            ("table of points", FOUND, "a.csv", b"x,y,z\n1,2,3\n4,5,6\n", r"a table of text \(CSV\); give a mesh"),
            ("3MF of beams only", REPORTED, "a.3mf", m.three_mf('<object id="1" type="model"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="9" y="0" z="0"/></vertices><triangles/><b:beamlattice radius="1"><b:beams><b:beam v1="0" v2="1"/></b:beams></b:beamlattice></mesh></object>', '<item objectid="1"/>', attributes='xmlns:b="http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02"'), "no triangle.*a beam lattice"),
            ("STEP in gzip", FOUND, "a.stp.gz", gzip.compress(GOOD_STEP.encode()), "gzip data; unpack it with gunzip"),
            ("SketchUp model", FOUND, "a.skp", b"\xff\xfe\xff\x0eS\0k\0e\0t\0c\0h\0U\0p\0 \0M\0o\0d\0e\0l\0", "a SketchUp model" + solid),
            ("Maya scene", FOUND, "a.ma", b"//Maya ASCII 2023 scene\n", "a Maya scene" + scene),
            ("finite elements of Abaqus", FOUND, "a.inp", b"*HEADING\n*NODE\n1, 0., 0., 0.\n", r"finite elements \(Abaqus\)" + scene),
            ("list of points", FOUND, "a.xyz", b"0.0 0.0 0.0\n1.0 0.0 0.0\n1.0 2.0 0.0\n", "a list of points; make a surface of the points"),
            ("cloud of points of a scanner (E57)", FOUND, "a.e57", b"ASTM-E57" + bytes(90), r"a cloud of points \(E57\); make a surface of the points"),
            ("Alembic", FOUND, "a.abc", b"Ogawa\xff\0\1" + bytes(90), "an Alembic scene" + scene),
            ("finite elements of LS-DYNA", FOUND, "a.k", b"*KEYWORD\n*NODE\n", r"finite elements \(LS-DYNA\)" + scene),
            ("finite elements of Ansys", FOUND, "a.cdb", b"/COM,ANSYS RELEASE 19\n", r"finite elements \(Ansys\)" + scene),
            ("Exodus", FOUND, "a.exo", b"CDF\x02" + bytes(60), r"a netCDF file .*" + scene),
            ("volume of a scanner (NIfTI)", FOUND, "a.nii", bytes(344) + b"n+1\0", r"a medical picture \(NIfTI\); make a surface of it"),
            ("part of NX, told by its name", FOUND, "a.prt", b"\1\2\3\4" * 40, "a part of NX or Creo" + solid),
            ("CATIA part, told by its name", FOUND, "a.CATPart", b"\1\2\3\4" * 40, "a CATIA model" + solid),
            ("OpenSCAD, told by its name", FOUND, "a.scad", b"cube([120, 90, 40]);\n", "a program of OpenSCAD; render it and export it"),
            ("world of Webots", FOUND, "a.wbt", b"#VRML_SIM R2023b utf8\n", "a world of Webots; "),
            ("program of a printer", FOUND, "a.gcode", b"M73 P0 R30\nG28 ; home\n", r"\(G-code\); give a mesh"),
            ("photograph", FOUND, "a.heic", b"\0\0\0\x18ftypheic", "a HEIC picture; give a mesh"),
            ("slices of a scanner", FOUND, "a.dcm", bytes(128) + b"DICM", r"a medical picture \(DICOM\); make a surface of it"),
            ("arrays of NumPy", FOUND, "a.npz", m.zipped({"v.npy": b"\x93NUMPY"}), "an archive of NumPy arrays; give a mesh"),
            ("board of KiCad", FOUND, "a.kicad_pcb", b"(kicad_pcb (version 20221018)\n", "a circuit board of KiCad; export it as STEP"),
            ("script that makes the part", FOUND, "a.py", b"#!/usr/bin/env python3\nimport cadquery\n", "a script; give a mesh"),
            ("something unknown", FOUND, "a.bin", b"\1\2\3\4" * 40, "not known here; give a mesh .* or a part in STEP or IGES")]:
        mesh(k, what, who, name, data, 2, pattern)
    for what, who, name, data in [
            ("DXF: closed polyline", REPORTED, "a.dxf", m.dxf(m.lwpolyline(m.RECTANGLE))),
            ("DXF: four lines in any order and direction", FOUND, "a.dxf", m.dxf(m.line((0, 0), (150, 0)) + m.line((0, 120), (150, 120)) + m.line((150, 0), (150, 120)) + m.line((0, 0), (0, 120)))),
            ("SVG: path with an arc", REPORTED, "a.svg", m.svg('<path d="M0,0 H150 V120 H0 Z M60,60 a10,10 0 1,0 20,0 a10,10 0 1,0 -20,0 Z"/>'))]:
        add(k, what, who, {name: data}, f"place {name} --method r2", 0, r"150\.0 × 120\.0 mm")
    outline = "; export the outline as DXF or SVG"
    for what, name, data, pattern in [
            ("plot (HPGL)", "a.plt", b"IN;SP1;PU0,0;PD400,0;", r"a plot \(HPGL\)" + outline),
            ("layer of a board (Gerber)", "a.gbr", b"G04 edge*\n%FSLAX46Y46*%\n%MOMM*%\n", r"\(Gerber\)" + outline),
            ("enhanced metafile", "a.emf", b"\1\0\0\0" + bytes(36) + b" EMF" + bytes(40), r"\(EMF\)" + outline),
            ("shapefile", "a.shp", b"\0\0\x27\x0a" + bytes(96), "an ESRI shapefile; convert it to GeoJSON or DXF with coordinates in mm"),
            ("map for a globe (KML)", "a.kml", b'<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2"/>', r"a map \(kml\); convert it"),
            ("TopoJSON", "a.json", b'{"type":"Topology","arcs":[]}', r"a map \(TopoJSON\); convert it"),
            ("GeoPackage", "a.gpkg", b"SQLite format 3\0" + bytes(52) + b"GPKG", r"a map \(GeoPackage\); convert it"),
            ("PDF", "a.pdf", b"%PDF-1.4\n", "a PDF" + outline),
            ("drawing of CorelDRAW", "a.cdr", b"RIFF\0\0\0\0CDR9" + bytes(20), "a CorelDRAW drawing" + outline),
            ("IGES", "a.igs", b" " * 72 + b"S      1\n", r"a part in IGES; \"triskin design\" covers a part"),
            ("DAE", "a.dae", m.dae(""), r"a mesh \(DAE\); \"triskin design\" covers a part"),
            ("glTF", "a.gltf", m.gltf([{"mesh": 0}]), r"a mesh \(glTF\); \"triskin design\" covers a part"),
            ("design", "a.json", pathlib.Path(STRIP).read_bytes(), "a design of Triskin; give a polygon"),
            ("GeoJSON of a town", "a.geojson", m.geojson([(9.18, 45.46), (9.2, 45.46), (9.2, 45.48)]), r"look like degrees of longitude and latitude \(9\.18, 45\.46\)"),
            ("GeoJSON of a country", "a.geojson", m.geojson([(5, 45), (15, 45), (15, 53)]), "look like degrees of longitude and latitude")]:
        add(k, f"{what} given to place", FOUND, {name: data}, f"place {name} --method r2", 2, pattern)
    add(k, "DXF: outline with a gap of 2 mm", FOUND, {"a.dxf": m.dxf(m.lwpolyline([(0, 0), (150, 0), (150, 120), (2, 0)], closed=0))}, "place a.dxf", 2, r"the outline is open .* 2 mm away")
    add(k, "DXF: two outlines", FOUND, {"a.dxf": m.dxf(m.lwpolyline(m.RECTANGLE) + m.lwpolyline([(300, 0), (400, 0), (400, 90)]))}, "place a.dxf", 2, "holds 2 outlines beside each other; place each one alone")
    ring = '{"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":[[[0,0],[150,0],[150,120],[0,0]]]}}'
    add(k, "GeoJSON: collection of two polygons", REPORTED, {"a.geojson": ('{"type":"FeatureCollection","features":[%s,%s]}' % (ring, ring)).encode()}, "place a.geojson", 2, "holds 2 polygons.*place each one alone")
    add(k, "STL given to place", FOUND, {"a.zip": m.zipped({"cover.stl": b"x"})}, "place a.zip", 2, r"a zip archive with cover\.stl in it; unpack it")
    add(k, "Intel HEX as firmware", REPORTED, {"a.hex": b":020000040800F2\n:00000001FF\n"}, "flash strip.json --link sim --firmware a.hex", 2, "an Intel HEX file; give the firmware's package")
    add(k, "Motorola S-records as firmware", FOUND, {"a.s19": b"S00600004844521B\nS9030000FC\n"}, "flash strip.json --link sim --firmware a.s19", 2, "a file of Motorola S-records; give the firmware's package")
    add(k, "ELF as firmware", FOUND, {"a.elf": b"\x7fELF\2\1\1" + bytes(60)}, "flash strip.json --link sim --firmware a.elf", 2, r"a program \(ELF\); give the firmware's package")


def in_place_of_designs():
    k = "what people hold"
    for what, name, data, command, pattern in [
            ("STL given to live", "a.stl", m.text_stl(m.block()), "live a.stl --link sim", r"a mesh \(STL\); \"triskin design\" makes a design of it"),
            ("STEP given to check", "a.step", GOOD_STEP.encode(), "check a.step", "design"),
            ("OBJ given to flash", "a.obj", m.obj(m.block()), "flash a.obj --link sim", r"a mesh \(OBJ\); \"triskin design\" makes a design of it"),
            ("table given to export", "a.csv", b"x,y,z\n1,2,3\n4,5,6\n", "export a.csv --format gltf -o o.gltf", r"a table of text \(CSV\); give a design"),
            ("table given to view", "a.csv", b"x,y,z\n1,2,3\n4,5,6\n", "view a.csv", r"a table of text \(CSV\); give a design"),
            ("recording of which nothing is left given to replay", "a.mcap", b"\x89MCAP0\r\n", "replay a.mcap", "was cut before its first sample"),
            ("glTF given to live", "a.gltf", m.gltf([{"mesh": 0}]), "live a.gltf --link sim", r"a mesh \(glTF\); \"triskin design\" makes a design of it"),
            ("IGES given to live", "a.igs", b" " * 72 + b"S      1\n", "live a.igs --link sim", r"a part in IGES; \"triskin design\" makes a design of it"),
            ("OBJ given as URDF", "a.obj", m.obj(m.block()), "robot new r.json --name r --urdf a.obj", r"a mesh \(OBJ\); give a URDF"),
            ("raw image as firmware", "a.bin", b"\0\0\2\x20\xc1\1\0\x08" + bytes(200), "flash strip.json --link sim --firmware a.bin", "a raw image for a microcontroller; give the firmware's package"),
            ("FreeCAD document given to verify", "a.FCStd", m.zipped({"Document.xml": b"<Document/>"}), "verify a.FCStd --link sim", "a FreeCAD document; give a design"),
            ("mesh given to route", "a.stl", m.text_stl(m.block()), "route a.stl -o o.json", r"a mesh \(STL\), where a file in JSON is wanted"),
            ("URDF given to robot show", "a.urdf", m.urdf(m.LINKS + m.joint("")), "robot show a.urdf", "a URDF robot description, where a file in JSON is wanted"),
            ("table given to simulate", "a.csv", b"x,y,z\n1,2,3\n4,5,6\n", "simulate a.csv --seconds 0.1", r"a table of text \(CSV\), where a file in JSON is wanted"),
            ("empty file given to live", "a.json", b"", "live a.json --link sim", r"a\.json: the file is empty"),
            ("empty file given to robot show", "a.json", b"", "robot show a.json", "is not JSON: it is empty"),
            ("empty file given to design", "a.json", b"", "design a.json -o d.json", "the file is empty"),
            ("JSON of another program given to design", "a.json", b'{"a":1}', "design a.json -o d.json", "JSON of another kind; give a mesh"),
            ("UF2 as firmware", "a.uf2", b"UF2\n" + bytes(508), "flash strip.json --link sim --firmware a.uf2", "an image in UF2; give the firmware's package"),
            ("DfuSe as firmware", "a.dfu", b"DfuSe\1" + bytes(80), "flash strip.json --link sim --firmware a.dfu", r"an image for DFU \(DfuSe\); give the firmware's package"),
            ("bytes as firmware", "a.bin", bytes(range(256)), "flash strip.json --link sim --firmware a.bin", r"not a firmware package \(wrong first bytes\); give triskin_firmware")]:
        add(k, what, FOUND, {name: data}, command, 2, pattern)


SCRIPTS = [("Latin with accents", "Überärmel", "Überärmèl"), ("Cyrillic", "левая рука", "левая руки"), ("Chinese", "左腕", "左臂"),
           ("Arabic", "ذراع", "ذراغ"), ("emoji", "arm 🦾", "arm 🦿"), ("spaces and quotes", 'my "arm" a', "my \"arm\" '")]


def names():
    k = "names"
    for what, name in [("a blank in percent", "a%20b.obj"), ("a hash", "a#b.obj"), ("a semicolon", "a;b.obj"), ("a line break", "a\nb.obj"), ("a device of Windows", "CON.obj")]:
        add(k, f"file name with {what}", FOUND, {name: m.obj(m.block())}, ["extract", name, "-o", "out.obj"], 0, BLOCK)
    document = json.loads(m.gltf([{"mesh": 0}]))
    data = base64.b64decode(document["buffers"][0]["uri"].split(",")[1])
    document["buffers"][0]["uri"] = "my%20data%20%C3%A9.bin"
    add(k, "glTF that names its data in percent", FOUND, {"a.gltf": json.dumps(document).encode(), "my data é.bin": data}, "extract a.gltf -o out.obj", 0, BLOCK)
    for what, one, other in SCRIPTS:
        who = REPORTED if what == "Chinese" else FOUND
        add(k, f"cover named in {what}", who, {}, ("names", one, other), 0, r"^\d\d formats keep the names apart")
        # A name on a command line and in a table of a robot has no blanks and quotes.
        if what != "spaces and quotes":
            add(k, f"covers of a robot named in {what}", FOUND, {}, ("covers", one.replace(" ", "_"), other.replace(" ", "_")), 0, r"^\d\d formats, covers apart")
    mesh(k, "file name with a line of every script", FOUND, "左 é ж ذ 🦾 '\".obj", m.obj(m.block()), 0, BLOCK)
    ALL[-1] = ALL[-1][:4] + (["extract", "左 é ж ذ 🦾 '\".obj", "-o", "out.obj"],) + ALL[-1][5:]
    add(k, "file name that begins with a dash", FOUND, {"-a.obj": m.obj(m.block())}, "extract ./-a.obj -o out.obj", 0, BLOCK)


def frames():
    k = "ROS frames"
    base = "bridge strip.json --link sim --seconds 0.1 --parent "
    for what, who, more, pattern in [
            ("leading slash", REPORTED, "/base_link", "without a leading slash"), ("blank within", FOUND, "'base link'", "without a leading slash or blanks"),
            ("empty", FOUND, "''", "--parent"), ("itself", REPORTED, "skin_strip", "cannot be its own parent|--parent"),
            ("nan as a place", REPORTED, "base --pose nan,0,0,0,0,0,1", "--pose: x y z must be finite"),
            ("infinite place", FOUND, "base --pose 0,inf,0,0,0,0,1", "--pose: x y z must be finite"),
            ("quaternion of length 2", REPORTED, "base --pose 0,0,0,0,0,0,2", "--pose"),
            ("quaternion of zeros", FOUND, "base --pose 0,0,0,0,0,0,0", "--pose"),
            ("tabulator within", FOUND, "'base\tlink'", "without a leading slash or blanks"),
            ("millimetres as a place", FOUND, "base --pose 0,250,0,0,0,0,1", r"250 m from the parent .* are they millimetres\? Then divide"),
            ("angles in place of a quaternion", FOUND, "base --pose 0,0,0,1.57,0,0", "--pose: 7 values are needed, 6 given"),
            ("words in place of numbers", FOUND, "base --pose a,0,0,0,0,0,1", "--pose: .* is not a number"),
            ("eight numbers", FOUND, "base --pose 0,0,0,0,0,0,1,0", "--pose: 7 values are needed, 8 given"),
            ("quaternion that is nearly of length 1", FOUND, "base --pose 0,0,0,0,0,0,0.99", "--pose"),
            ("line break within", FOUND, "'a\nb'", "without a leading slash or blanks")]:
        add(k, what, who, {}, base + more, 2, pattern)


def robots():
    k = "URDF"
    new = "robot new r.json --name r --urdf a.urdf"
    for what, who, data, status, pattern in [
            ("xacro with calls only", REPORTED, m.urdf('<xacro:include filename="x"/>', 'name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"'), 2, r"a xacro robot description; make a URDF of it: xacro FILE > robot\.urdf"),
            ("xacro with links beside calls", FOUND, m.urdf(LINKS_BOTH, 'name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"'), 2, "a xacro robot description"),
            ("joint 400 m away", REPORTED, m.urdf(m.LINKS + m.joint('<origin xyz="0 0 400"/>')), 2, "400 m from its parent; a URDF is in metres: are its numbers millimetres"),
            ("joint turned by 90 rad", FOUND, m.urdf(m.LINKS + m.joint('<origin rpy="0 90 0"/>')), 2, "are its numbers degrees"),
            ("two roots", REPORTED, m.urdf(m.LINKS), 2, r"2 links that hang on no joint \(arm, base\)"),
            ("a link that stands alone", FOUND, m.urdf(m.LINKS + '<link name="stand"/>' + m.joint("")), 2, r"\(base, stand\)"),
            ("two robots in one file", REPORTED, m.urdf(m.LINKS + m.joint("")) + m.urdf(m.LINKS, 'name="s"')[21:], 2, r"holds 2 robots \(r, s\)"),
            ("ring of joints", FOUND, m.urdf(m.LINKS + m.joint("") + m.joint("", "arm", "base", "k")), 2, "form a ring"),
            ("no link", FOUND, m.urdf(""), 2, "has no <link>"),
            ("SDF", FOUND, b'<?xml version="1.0"?><sdf version="1.7"/>', 2, "an SDF robot description; give a URDF"),
            ("a mesh", FOUND, m.zipped({"a.stl": b"x"}), 2, "a zip archive"),
            ("SRDF", FOUND, b'<?xml version="1.0"?><robot name="r"><group name="arm"/></robot>', 2, "an SRDF of MoveIt; give a URDF"),
            ("a link twice", FOUND, m.urdf(m.LINKS + '<link name="arm"/>' + m.joint("")), 2, 'link "arm" stands there twice'),
            ("two parents", FOUND, m.urdf(m.LINKS + '<link name="c"/>' + m.joint("") + m.joint("", "c", "arm", "k")), 2, 'link "arm" is the child of two joints'),
            ("commas in xyz", FOUND, m.urdf(m.LINKS + m.joint('<origin xyz="0,0,0.4"/>')), 2, "must be three numbers"),
            ("cut off", FOUND, m.urdf(m.LINKS + m.joint(""))[:-20], 2, "not well-formed XML"),
            ("byte order mark", FOUND, b"\xef\xbb\xbf" + m.urdf(m.LINKS + m.joint("")), 0, "robot r with"),
            ("UTF-16", FOUND, m.urdf(m.LINKS + m.joint("")).decode().replace('"1.0"?', '"1.0" encoding="utf-16"?', 1).encode("utf-16"), 0, "robot r with"),
            ("a joint twice", FOUND, m.urdf(m.LINKS + '<link name="c"/>' + m.joint("") + m.joint("", "arm", "c")), 2, 'joint "j" stands there twice'),
            ("joint without a type", FOUND, m.urdf(m.LINKS + m.joint("").replace(' type="fixed"', "")), 2, 'has no attribute "type"'),
            ("joint of an unknown type", FOUND, m.urdf(m.LINKS + m.joint("", type="hinge")), 2, 'has the type "hinge"; there are fixed'),
            ("revolute joint without a limit", FOUND, m.urdf(m.LINKS + m.joint("", type="revolute")), 2, "is revolute and has no <limit>"),
            ("limits exchanged", FOUND, m.urdf(m.LINKS + m.joint('<limit effort="1" velocity="1" lower="1" upper="-1"/>', type="revolute")), 2, "lower limit above its upper one"),
            ("axis of length 2", FOUND, m.urdf(m.LINKS + m.joint('<axis xyz="0 0 2"/>', type="continuous")), 2, "axis of length 2; write it with length 1: 0 0 1"),
            ("axis of zeros", FOUND, m.urdf(m.LINKS + m.joint('<axis xyz="0 0 0"/>', type="continuous")), 2, "axis of length 0"),
            ("joint from a link to itself", FOUND, m.urdf(m.LINKS + m.joint("") + m.joint("", "base", "base", "k")), 2, "form a ring"),
            ("turned by a quaternion", FOUND, m.urdf(m.LINKS + m.joint('<origin quat_xyzw="0 0 0.6 0.8"/>')), 0, "robot r with"),
            ("quaternion of length 2", FOUND, m.urdf(m.LINKS + m.joint('<origin quat_xyzw="0 0 0 2"/>')), 2, "must be four numbers of length 1"),
            ("quaternion and angles", FOUND, m.urdf(m.LINKS + m.joint('<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>')), 2, "has rpy and quat_xyzw; leave one out"),
            ("transmissions and notes of a simulator", FOUND, m.urdf(m.LINKS + m.joint("") + '<transmission name="t"><joint name="j"/></transmission><gazebo reference="arm"/>'), 0, "robot r with"),
            ("limits in degrees", FOUND, m.urdf(m.LINKS + m.joint('<limit effort="1" velocity="1" lower="-90" upper="90"/>', type="revolute")), 2, 'has the limit lower="-90", more than two turns; a URDF is in radians: is it in degrees. Then write -1.570796'),
            ("a wrist of two turns", FOUND, m.urdf(m.LINKS + m.joint('<limit effort="1" velocity="1" lower="-12.566" upper="12.566"/>', type="revolute")), 0, "robot r with"),
            ("a slide of 90 m, whose limits are no angles", FOUND, m.urdf(m.LINKS + m.joint('<limit effort="1" velocity="1" lower="0" upper="90"/>', type="prismatic")), 0, "robot r with"),
            ("a joint that mimics itself", FOUND, m.urdf(m.LINKS + m.joint('<mimic joint="j"/>', type="continuous")), 2, 'joint "j" mimics itself'),
            ("a good one", FOUND, m.urdf(m.LINKS + m.joint('<origin xyz="0 0 0.4" rpy="0 1.57 0"/>')), 0, "robot r with")]:
        add(k, what, who, {"a.urdf": data}, new, status, pattern)


LINKS_BOTH = m.LINKS + m.joint("") + "<xacro:arm/>"


def sizes():
    k = "one-sided, sizeless, implausible"
    mesh(k, "Möbius strip", REPORTED, "a.obj", m.obj(m.strip(1)), 0, "has only one side, as a Möbius strip has")
    mesh(k, "strip of three half turns", FOUND, "a.obj", m.obj(m.strip(3)), 0, "has only one side")
    mesh(k, "strip of two half turns (two sides)", FOUND, "a.obj", m.obj(m.strip(2)), 0, r"part of (?!.*only one side)")
    mesh(k, "2 m in a file of millimetres", FOUND, "a.stl", m.text_stl(m.block(2000, 300, 300)), 2, r"2000 × 300 × 300 mm large if its numbers are millimetres; are they\? Then pass --unit mm")
    mesh(k, "the same, confirmed", FOUND, "a.stl", m.text_stl(m.block(2000, 300, 300)), 0, r"part of 2000\.0 × 300\.0 × 300\.0 mm", "--unit mm")
    mesh(k, "numbers in metres", REPORTED, "a.obj", m.obj(m.block(), 1e-3), 2, "are its numbers metres")
    mesh(k, "glTF of 3 m by its format", FOUND, "a.gltf", m.gltf([{"mesh": 0, "scale": [25, 25, 25]}]), 2, r"3000 × 2250 × 1000 mm large if its numbers are metres as the file says")
    add(k, "cover of 3.1 m²", REPORTED, {"a.obj": m.obj(m.block(1000, 500, 700))}, "design a.obj -o d.json --time-limit-s 1", 2, r"3\.1 m² are more than the skin of a person \(1\.5 m²\), for up to \d+ modules and \d+ controllers")
    add(k, "outline of 6 m²", FOUND, {"a.wkt": b"POLYGON((0 0, 3000 0, 3000 2000, 0 2000, 0 0))"}, "place a.wkt --method r2", 0, r"6\.0 m² are more than the skin of a person \(1\.5 m²\); if the unit is wrong, --unit")
    add(k, "outline that is too small for a module", FOUND, {"a.wkt": b"POLYGON((0 0, 9 0, 9 8, 0 8, 0 0))"}, "place a.wkt --method r2", 1, "no module fits: .* unless --unit names another unit")
    mesh(k, "triangles without area", FOUND, "a.obj", b"v 0 0 0\nv 50 0 0\nv 100 0 0\nf 1 2 3\n", 2, "no triangle with an area in it")
    mesh(k, "corner that is no number", FOUND, "a.obj", b"v nan 0 0\n" + m.obj(m.block()), 2, "vertex 0 is not a finite point")
    mesh(k, "numbers in micrometres", FOUND, "a.obj", m.obj(m.block(), 1e3), 2, r"155 m across, larger than a body part")
    add(k, "an option without a value: --gap-mm", FOUND, {"a.wkt": b"POLYGON((0 0, 150 0, 150 120, 0 120, 0 0))"}, ["place", "a.wkt", "--gap-mm", ""], 2, "--gap-mm: the value is empty")
    for option in ("--unit", "--method"):
        add(k, f"an option without a value: {option}", FOUND, {"a.wkt": b"POLYGON((0 0, 150 0, 150 120, 0 120, 0 0))"}, ["place", "a.wkt", option, ""], 2, f"{option}: the value is empty")
    for command in ("record strip.json --link sim -o a.mcap --seconds", "live strip.json --link sim --seconds", "bridge strip.json --link sim --stop-counts", "extract a.obj -o b.obj --sky"):
        add(k, f"nan for a number: {command.split()[0]} {command.split()[-1]}", FOUND, {"a.obj": m.obj(m.block())}, command + " nan", 2, f"{command.split()[-1]}: nan is no number")
    add(k, "an option without a value: --link", FOUND, {}, ["live", "strip.json", "--link", ""], 2, "--link: the value is empty")
    add(k, "every answer has the size: design", FOUND, {"a.obj": m.obj(m.block())}, "design a.obj -o d.json --time-limit-s 1", 0, r"120\.0 × 90\.0 × 40\.0 mm")
    add(k, "every answer has the size: place", FOUND, {"a.wkt": b"POLYGON((0 0, 150 0, 150 120, 0 120, 0 0))"}, "place a.wkt --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "every answer has the size: faces", FOUND, {"a.step": GOOD_STEP.encode()}, "faces a.step", 0, r"\d × \d.* mm")


def endless():
    """What has no end, or more levels than a reader that recurses has stack for."""
    k = "deep and endless"
    for command in ("extract /dev/zero -o o.obj", "faces /dev/zero", "place /dev/zero", "design /dev/zero -o d.json", "check /dev/zero",
                    "robot show /dev/zero", "export /dev/zero --format gltf -o o.gltf", "flash strip.json --link sim --firmware /dev/zero",
                    "replay /dev/zero", "recover /dev/zero -o r.mcap", "robot new r.json --name r --urdf /dev/zero"):
        add(k, command, FOUND, {}, command, 2, "/dev/zero: is a device or socket; give a file")
    deep = lambda tag, count, inside: f"<{tag}>" * count + inside + f"</{tag}>" * count
    nested = "its XML is nested more than 500 deep; repair or export it again"
    add(k, "SVG: 15,000 nested groups", FOUND, {"a.svg": m.svg(deep("g", 15_000, '<rect width="150" height="120"/>'))}, "place a.svg --method r2", 2, nested)
    add(k, "SVG: 50 nested groups", FOUND, {"a.svg": m.svg(deep("g", 50, '<rect width="150" height="120"/>'))}, "place a.svg --method r2", 0, r"150\.0 × 120\.0 mm")
    add(k, "URDF: 200,000 nested elements", FOUND, {"a.urdf": m.urdf(m.LINKS + m.joint("") + deep("g", 200_000, ""))}, "robot new r.json --name r --urdf a.urdf", 2, nested)
    mesh(k, "3MF: 200,000 nested elements", FOUND, "a.3mf", m.three_mf(f'<object id="1" type="model">{deep("g", 200_000, "")}{m.mesh_xml(m.block())}</object>', '<item objectid="1"/>'), 2, nested)
    mesh(k, "DAE: 200,000 nested elements", FOUND, "a.dae", m.dae("").replace(b"</COLLADA>", deep("extra", 200_000, "").encode() + b"</COLLADA>"), 2, nested)
    mesh(k, "glTF: 200,000 nested lists", FOUND, "a.gltf", m.gltf([{"mesh": 0}])[:-1] + b',"extras":' + b"[" * 200_000 + b"]" * 200_000 + b"}", 2, "nested too deeply")
    add(k, "JSON: 200,000 nested lists given to check", FOUND, {"a.json": b"[" * 200_000 + b"]" * 200_000}, "check a.json", 2, "a.json: ")
    if PYTHON:
        fifo = "import os\nos.mkfifo('a.mcap')\n"
        add(k, "Python: a pipe that nobody writes, read", FOUND, {}, ("python", fifo + "triskin.read('a.mcap')"), 1, r"BadInput: a\.mcap: is a folder, a pipe or a device")
        add(k, "Python: a pipe that nobody writes, opened", FOUND, {}, ("python", fifo + "triskin.open('a.mcap', link='sim')"), 1, r"BadInput: a\.mcap: is a folder, a pipe or a device")
        add(k, "Python: a device", FOUND, {}, ("python", "triskin.open('/dev/zero', link='sim')"), 1, "BadInput: /dev/zero: is a folder, a pipe or a device")


def trials():
    """The files that were recreated from reports, each with the command of its reporter."""
    k = "files of reports"
    folder = pathlib.Path(TRIALS)
    if not folder.is_dir():
        print(f"{TRIALS} is not there: its files are left out")
        return
    off, samples = "left out: ", "^130 module samples in 0.57 s$"
    for command, status, pattern in [
            ("faces step_mapped_scale2.step", 2, "#171: an instance of a part is scaled by 2"),
            ("faces step_instance_scale2.step", 2, "#186: an instance of a part is scaled by 2"),
            ("faces step_edition3_anchor.step", 0, r"6 faces, 384\.000 cm²"),
            ("extract step_hidden_solid.step -o s.obj", 0, off + r"fixture.*384\.0 cm²"),
            ("extract gltf_hidden_node.gltf -o s.obj", 0, off + r"fixture.*112\.9 cm²"),
            ("extract 3mf_slicer_modifier.3mf -o s.obj", 0, off + r"denser \(modifier\).*504\.0 cm²"),
            ("extract 3mf_printable_0.3mf -o s.obj", 0, off + r"spare \(printable=\"0\"\).*504\.0 cm²"),
            ("extract gltf_skin.gltf -o s.obj", 0, r"112\.9 cm²"),
            ("extract amf_inch.amf -o s.obj", 2, "is an AMF; export it"),
            ("extract 3mf_beams_only.3mf -o s.obj", 2, "a beam lattice"),
            ("extract zipped_stl.zip -o s.obj", 2, r"a zip archive with cover\.stl in it; unpack it"),
            ("extract part.FCStd -o s.obj", 2, "a FreeCAD document; export the part as STEP"),
            ("extract part.usda -o s.obj", 2, "a USD scene"),
            ("extract part.sat -o s.obj", 2, "an ACIS model"),
            ("extract step_inch_tag_mm_numbers.step -o s.obj", 2, "2032 × 1524 × 762 mm large if its numbers are inches"),
            ("design step_inch_tag_mm_numbers.step -o d.json --time-limit-s 1", 2, "2032 × 1524 × 762 mm large if its numbers are inches"),
            ("extract moebius.obj -o s.obj", 0, "has only one side"),
            ("place outline.dxf --method r2", 0, r"150\.0 × 120\.0 mm"),
            ("place outline.svg --method r2", 0, r"150\.0 × 120\.0 mm"),
            ("place fc_two_polygons.geojson", 2, "holds 2 polygons"),
            ("replay mcap_ts_plain.mcap --speed 0", 0, samples),
            ("replay mcap_ts_unchunked.mcap --speed 0", 0, samples),
            ("replay mcap_order.mcap --speed 0", 0, samples),
            ("recover mcap_foreign.mcap -o r.mcap", 0, "130 module samples"),
            ("replay candump.log", 2, "a candump log"),
            ("robot new r.json --name r --urdf xacro_call.urdf", 2, "xacro FILE > robot.urdf"),
            ("robot new r.json --name r --urdf millimetres.urdf", 2, "400 m from its parent"),
            ("robot new r.json --name r --urdf two_roots.urdf", 2, r"2 links that hang on no joint \(base_link, stand\)"),
            ("flash mini.json --link sim --firmware intel.hex", 2, "an Intel HEX file"),
            ("record mini.json --link sim -o n.mcap --seconds 0.2", 3, "run triskin flash"),
            ("live mini.json --link sim --seconds 0.2", 3, "run triskin flash"),
            ("bridge mini.json --link sim --parent /base_link --seconds 0.1", 2, "without a leading slash"),
            ("bridge mini.json --link sim --pose nan,0,0,0,0,0,1 --seconds 0.1", 2, "must be finite numbers"),
            ("fabricate mini.json -o made --only parts", 0, "made: 1 file for 2 islands")]:
        name = next(word for word in command.split() if (folder / word).exists())
        add(k, name, REPORTED if command.split()[0] != "live" else FOUND,
            {"fresh": b"", **{word: (folder / word).read_bytes() for word in command.split() if (folder / word).exists()}}, command, status, pattern)


def fresh():
    k = "a skin not flashed yet"
    flash = "run triskin flash"
    for command, who in [("live strip.json --link sim --seconds 0.1", REPORTED), ("record strip.json --link sim --seconds 0.1 -o a.mcap", REPORTED),
                         ("verify strip.json --link sim", FOUND), ("bridge strip.json --link sim --seconds 0.1", FOUND),
                         ("record strip.json --link sim --seconds 0.1 -o a.csv", FOUND), ("record strip.json --link sim --seconds 0.1 -o a.h5", FOUND),
                         ("log strip.json --link sim --seconds 0.1", FOUND), ("repair strip.json --link sim", FOUND)]:
        add(k, command, who, {"fresh": b""}, command, None, flash)


    for command in ("dump strip.json --link sim --ask --seconds 0.2", "dump strip.json --link sim --seconds 0.2", "live strip.json --link sim --protocol icub --seconds 0.2"):
        add(k, command, FOUND, {"fresh": b""}, command, 1, flash + "|not flashed yet sends nothing")

    # Of three new controllers each has the first address, so the second and third are silent.
    for command in ("live", "record -o a.mcap", "record -o a.csv", "bridge", "log", "verify", "live --tare"):
        verb, *more = command.split()
        add(k, f"three controllers: {command}", FOUND, {"fresh": b""}, " ".join([verb, "three.json --link sim --seconds 0.1" if verb != "verify" else "three.json --link sim", *more]), None, flash + "|triskin flash first")


def python():
    k = "Python"
    rows = [("pathlib.Path", REPORTED, "with triskin.open(pathlib.Path('own.mcap')) as s: print('read', len(s.layout.positions_mm) if hasattr(s, 'layout') else 'ok')", 0, "read"),
            ("os.PathLike of one's own", FOUND, "class P:\n  def __fspath__(self): return 'own.mcap'\nwith triskin.open(P()) as s: print('read')", 0, "read"),
            ("bytes as a path", FOUND, "with triskin.open(b'own.mcap') as s: print('read')", None, "read|TypeError"),
            ("link=None", REPORTED, "with triskin.open('own.mcap', link=None) as s: print('read')", 0, "read"),
            ("a number as a path", FOUND, "triskin.open(3)", 1, "TypeError"),
            ("a file that is not there", FOUND, "triskin.open('none.mcap')", 1, r"triskin\.BadInput: none\.mcap: cannot read"),
            ("a design, read as a recording", FOUND, "triskin.read('strip.json')", 1, r"BadInput: strip\.json: .*a design of Triskin"),
            ("a table, read as a recording", FOUND, "open('a.csv','w').write('a,b\\n1,2\\n3,4\\n')\ntriskin.read('a.csv')", 1, r"BadInput: a\.csv: .*a table of text \(CSV\); give an MCAP"),
            ("JSON of another program, read as a recording", FOUND, "open('x.json','w').write('{\"a\":1}')\ntriskin.read('x.json')", 1, r"BadInput: x\.json: (?!no link)"),
            ("repr of a recording", REPORTED, "with triskin.open('own.mcap') as s: print(repr(s))", 0, r"<triskin\.Recording of strip: 4 modules, \d+ samples of a simulation>"),
            ("a thread of its own", FOUND, "import threading\nout=[]\ndef f():\n  with triskin.open('own.mcap') as s: out.append('read')\nt=threading.Thread(target=f); t.start(); t.join(); print(out)", 0, "read"),
            ("None as a path", FOUND, "triskin.open(None)", 1, "TypeError: expected str, bytes or os.PathLike object, not NoneType"),
            ("an empty path", FOUND, "triskin.open('')", 1, "BadInput: the name of the file is empty"),
            ("a time below 0", FOUND, "triskin.simulate('strip.json').read(-1)", 1, "BadInput: read: seconds must be 0 or more"),
            ("no link named", FOUND, "triskin.open('strip.json')", 1, r"(?s)BadInput: no link is named(?!.*--)"),
            ("a scene and a real link", FOUND, "open('s.json','w').write('{}')\ntriskin.open('strip.json', link='can:none', scene='s.json')", 1, "BadInput(?!.*--)"),
            ("a mesh", FOUND, "open('a.obj','w').write('v 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\n')\ntriskin.open('a.obj', link='sim')", 1, r"BadInput: a\.obj: is a mesh \(OBJ\)"),
            ("a skin that is closed", FOUND, "s = triskin.simulate('strip.json'); s.close(); s.read()", 1, "BadInput: the skin is closed"),
            ("an argument that is unknown", FOUND, "triskin.open('own.mcap', lnk='sim')", 1, "TypeError"),
            ("pressure without calibration", FOUND, "with triskin.open('own.mcap') as s: s.pressure_kpa()", 1, "BadInput: .*calibrat"),
            ("the same skin twice", FOUND, "a = triskin.simulate('strip.json')\ntriskin.simulate('strip.json')", 1, "DeviceFailed: .*is simulated by this process already; end that first"),
            ("four threads", FOUND, "import threading\nout=[]\ndef f():\n  with triskin.open('own.mcap') as s: out.append(len(s.samples) > 0)\nts=[threading.Thread(target=f) for _ in range(4)]\n[t.start() for t in ts]; [t.join() for t in ts]; print(out)", 0, r"\[True, True, True, True\]"),
            ("a text of NumPy as a path", FOUND, "import numpy\nwith triskin.open(numpy.str_('own.mcap')) as s: print('read')", 0, "read|No module named 'numpy'"),
            ("a time that is no number", FOUND, "triskin.simulate('strip.json').read(float('nan'))", 1, "BadInput: read: seconds must be 0 or more"),
            ("a time without end", FOUND, "triskin.simulate('strip.json').read(float('inf'))", 1, "BadInput: read: seconds"),
            ("an extension in capitals", FOUND, "import shutil\nshutil.copy('own.mcap', 'A.MCAP')\nwith triskin.open('A.MCAP') as s: print('read', len(s.samples) > 0)", 0, "read True"),
            ("a folder", FOUND, "triskin.open('.')", 1, "BadInput: "),
            ("a glTF", FOUND, "open('a.gltf','w').write('{\"asset\":{\"version\":\"2.0\"}}')\ntriskin.open('a.gltf', link='sim')", 1, r"BadInput: a\.gltf: is a mesh \(glTF\)"),
            ("fork", FOUND, "import os,sys\nwith triskin.open('own.mcap') as s:\n  pid=os.fork()\n  if pid == 0: os._exit(0)\n  print('read', os.waitpid(pid,0)[1])", 0, "read 0")]
    for what, who, code, status, pattern in rows:
        add(k, what, who, {}, ("python", code), status, pattern)


def run(arguments, folder, environment):
    try:
        done = subprocess.run(arguments, cwd=folder, env=environment, capture_output=True, check=False, timeout=60)
    except subprocess.TimeoutExpired:
        return -1, "no answer within 60 s"
    return done.returncode, (done.stderr + done.stdout).decode(errors="replace")


def with_limit(kilobytes, command, read, folder, environment):
    """Runs a command while no file may be larger, as on a full disk: it has to end with status 2, by itself, and what it
    wrote has to be read."""
    done = subprocess.run(["sh", "-c", f'ulimit -f {2 * kilobytes}; trap "" XFSZ; exec "$@"', "sh", TRISKIN, *command],
                          cwd=folder, env=environment, capture_output=True, check=False, timeout=60)
    said = (done.stderr + done.stdout).decode(errors="replace")
    if done.returncode != 2 and "without HDF5" not in said:
        return done.returncode or 1, said
    status, played = run([TRISKIN, *read], folder, environment) if read else (0, "")
    return status, said + played


def plain(path):
    return path.read_text(encoding="utf-8")


def root_of(path):
    return tree.fromstring(path.read_bytes())


def asked(folder, environment, *command):
    """What a foreign reader says; None if it is not installed."""
    if not shutil.which(command[0]):
        return None
    status, said = run(list(command), folder, environment)
    if status == 77 or "ModuleNotFoundError" in said:
        return None
    assert status == 0, f"{command[0]} refuses {command[-1]}: {said[:300]}"
    return said.strip()


# The name that each format keeps, by a reader that is not ours. SPELLED formats take letters, digits and _ alone.
SPELLED = {"mjcf", "mjcf-touch", "npz", "taxel-list", "icub-positions", "icub-skingui", "modules"}
H5PY = "import h5py, sys; n = h5py.File(sys.argv[1]).attrs['name']; print(n.decode() if isinstance(n, bytes) else n)"
NUMPY = "import numpy, sys; print(numpy.load(sys.argv[1])['link'][0])"


def name_in(kind, path, folder, environment):
    if kind == "gltf":
        nodes = json.loads(plain(path))
        return nodes["nodes"][nodes["scenes"][0]["nodes"][0]]["name"]
    if kind == "hdf5":
        return asked(folder, environment, "/usr/bin/python3", "-c", H5PY, path.name)
    if kind == "npz":
        return asked(folder, environment, "/usr/bin/python3", "-c", NUMPY, path.name)
    if kind == "html":
        return html.unescape(re.search("<title>(.*?) – triskin view</title>", plain(path), re.DOTALL)[1])
    if kind == "pdf":
        said = asked(folder, environment, "mutool", "show", path.name, "trailer/Info/Title")
        return said and title_of_pdf(said)
    if kind in ("icub-positions", "icub-skingui"):
        return re.search(r"^(?:name|robotPart)\s+(\S+)$", plain(path), re.MULTILINE)[1]
    if kind == "modules":
        return re.search(r"^o (\S+)$", plain(path), re.MULTILINE)[1]
    if kind == "taxel-list":
        return json.loads(plain(path))["frame"]
    if kind == "taxels":
        with open(path, encoding="utf-8", newline="") as rows:
            return {row["cover"] for row in csv.DictReader(rows)}.pop()
    if kind == "picture":
        return root_of(path).findall("{http://www.w3.org/2000/svg}text")[-1].text.rsplit(": ", 1)[0]
    if kind == "sheet-svg":
        return root_of(path).find("{http://www.w3.org/2000/svg}title").text
    if kind == "urdf":
        asked(folder, environment, "check_urdf", path.name)
        return root_of(path).get("name")
    if kind == "sdf":
        return root_of(path).find("model").get("name")
    assert kind in ("mjcf", "mjcf-touch"), f"the format {kind} has no test of its name"
    return root_of(path).get("model")


def title_of_pdf(shown_text):
    """A text string of PDF: PDFDocEncoding, or UTF-16 behind FE FF; in parentheses with escapes, or in hexadecimal."""
    if shown_text.startswith("<"):
        raw = bytes.fromhex(shown_text[1:-1])
    else:
        octal = re.sub(rb"\\([0-7]{1,3})", lambda m: bytes([int(m[1], 8)]), shown_text[1:-1].encode("latin-1"))
        raw = re.sub(rb"\\(.)", lambda m: {b"n": b"\n", b"r": b"\r", b"t": b"\t"}.get(m[1], m[1]), octal)
    return raw[2:].decode("utf-16-be") if raw[:2] == b"\xfe\xff" else raw.decode("latin-1")


def compare_names(one, other, folder, environment):
    """Exports two covers in every format that the program has: its name has to be there, spelled where the format takes
    no other letters, and differ."""
    status, said = run([TRISKIN, "export", "--help"], folder, environment)
    formats = re.findall(r"[\w-]+", re.search(r"\(one of ([\w\s,-]+)\)", said)[1])
    found, left_out, foreign = {}, set(), []
    for name in (one, other):
        (folder / f"{name}.obj").write_bytes(m.obj(m.block()))
        status, said = run([TRISKIN, "design", f"{name}.obj", "-o", f"{name}.json", "--time-limit-s", "1", "--iterations", "20"], folder, environment)
        if status != 0:
            return status, said
        for kind in formats:
            status, said = run([TRISKIN, "export", f"{name}.json", "--format", kind], folder, environment)
            if re.search("was built without", said):
                left_out.add(kind)
                continue
            if status != 0:
                return status, f"{kind}: {said}"
            written = folder / said.strip().splitlines()[-1]
            if kind in ("gltf", "mjcf", "mjcf-touch"):
                foreign.append(written.name)
            kept = name_in(kind, written, folder, environment)
            if kept is None:
                left_out.add(kind)
            elif kind in SPELLED and not re.fullmatch(r"[\w.-]+", kept, re.ASCII):
                return 1, f"{kind}: {kept} is no identifier"
            elif kind not in SPELLED and kept != name:
                return 1, f"{kind}: {name!r} became {kept!r}"
            else:
                found[name, kind] = kept
    readers = ""
    if NODE and foreign:
        status, said = run([NODE, str(pathlib.Path(__file__).parent / "foreign_test.mjs"), NODE_MODULES, *foreign], folder, environment)
        if status not in (0, 77):
            return status, f"a foreign reader refuses: {said[:400]}"
        readers = ", read by gltf-validator and MuJoCo" if status == 0 else ""
    same = [kind for kind in formats if kind not in left_out and found[one, kind] == found[other, kind]]
    if same:
        return 1, f"both covers have one name in {', '.join(same)}"
    return 0, f"{len(formats)} formats keep the names apart{readers}" + (f" ({', '.join(sorted(left_out))} not read)" if left_out else "")


COVERS = "import numpy, sys; print(*sorted(set(numpy.load(sys.argv[1])['cover'])))"


def compare_covers(one, other, folder, environment):
    """A robot with two covers of these names, exported in every format: tables keep the names, files differ."""
    for command in (["robot", "new", "r.json", "--name", one, "--bus", "a=can:can0"],
                    ["robot", "add", "r.json", "strip.json", "--name", one, "--bus", "a", "--xyz-mm", "0,0,0"],
                    ["robot", "add", "r.json", "strip.json", "--name", other, "--bus", "a", "--xyz-mm", "0,0,600"]):
        status, said = run([TRISKIN, *command], folder, environment)
        if status != 0:
            return status, said
    status, said = run([TRISKIN, "export", "--help"], folder, environment)
    formats = re.findall(r"[\w-]+", re.search(r"\(one of ([\w\s,-]+)\)", said)[1])
    for kind in formats:
        status, said = run([TRISKIN, "export", "r.json", "--format", kind], folder, environment)
        if status != 0 and "was built without" not in said:
            return status, f"{kind}: {said}"
        written = said.strip().splitlines()
        if len(written) > 1 and not all(any(name in line for line in written) for name in (one, other)):
            return 1, f"{kind}: {said}"
    with open(folder / "r.taxels.csv", encoding="utf-8", newline="") as rows:
        covers = sorted({row["cover"] for row in csv.DictReader(rows)})
    in_arrays = asked(folder, environment, "/usr/bin/python3", "-c", COVERS, "r.npz")
    if covers != sorted([one, other]) or in_arrays not in (None, " ".join(covers)):
        return 1, f"the tables name {covers} and {in_arrays}"
    return 0, f"{len(formats)} formats, covers apart"


def shown(text, state):
    # Of an exception of Python the last line; the frames name folders of this machine.
    text = re.sub(r"Traceback \(most recent call last\):\n(?: .*\n)+", "", text)
    lines = [line for line in text.strip().splitlines() if line.strip() and not line.startswith("…")]
    # Times and the folder of the run differ from run to run.
    return re.sub(r"\d+\.\d+ s\b", "… s", " ⏎ ".join(lines).replace(state + "/triskin/", "…/"))


def cell(text):
    return text.replace("|", "\\|").replace("<", "&lt;")


def main():
    with tempfile.TemporaryDirectory() as top:
        top = pathlib.Path(top)
        home = top / "home"
        environment = dict(os.environ, XDG_STATE_HOME=str(home), XDG_CONFIG_HOME=str(home), LC_ALL="C.UTF-8", NO_COLOR="1")
        subprocess.run([WRITE_STRIP, str(top / "strip.json"), "4"], check=True)
        subprocess.run([WRITE_STRIP, str(top / "three.json"), "40"], check=True)
        for command in (["flash", "strip.json", "--link", "sim"], ["record", "strip.json", "--link", "sim", "--seconds", "0.5", "-o", "own.mcap"]):
            status, said = run([TRISKIN, *command], top, environment)
            assert status == 0, said
        own = (top / "own.mcap").read_bytes()
        global STRIP
        STRIP = str(top / "strip.json")
        status, said = run([TRISKIN, "replay", "own.mcap", "--speed", "0"], top, environment)
        played = re.search(r"^[1-9]\d+ module samples in \d\.\d\d s$", said, re.MULTILINE)
        assert status == 0 and played, said
        recordings(own, "^" + re.escape(played[0]) + "$")
        for part in (switched_off, transforms, held, in_place_of_designs, names, frames, robots, sizes, endless, fresh, trials):
            part()
        if PYTHON:
            python()
        rows, wrong = [], []
        for number, (kind, what, who, files, command, status, pattern) in enumerate(ALL):
            if ONLY and kind not in ONLY:
                continue
            folder = top / f"m{number}"
            folder.mkdir()
            (folder / "strip.json").write_bytes((top / "strip.json").read_bytes())
            (folder / "three.json").write_bytes((top / "three.json").read_bytes())
            (folder / "own.mcap").write_bytes(own)
            for name, data in files.items():
                (folder / name).write_bytes(data)
            used = dict(environment, XDG_STATE_HOME=str(folder / "home")) if "fresh" in files else environment
            if command[0] == "names":
                got, said = compare_names(command[1], command[2], folder, used)
                text = f"design, export: {command[1]}, {command[2]}"
            elif command[0] == "covers":
                got, said = compare_covers(command[1], command[2], folder, used)
                text = f"robot new, robot add, export: {command[1]}, {command[2]}"
            elif command[0] == "limited":
                got, said = with_limit(command[1], command[2].split(), command[3].split(), folder, used)
                text = "triskin " + command[2]
            elif command[0] == "python":
                used = dict(used, PYTHONPATH=PYTHON)
                got, said = run(["/usr/bin/python3", "-c", "import pathlib, triskin\n" + command[1]], folder, used)
                text = command[1].splitlines()[-1]
            else:
                words = command if isinstance(command, list) else shlex.split(command)
                got, said = run([TRISKIN, *words], folder, used)
                text = "triskin " + (command if isinstance(command, str) else " ".join(command))
            good = (status is None or got == status) and re.search(pattern, said, re.DOTALL | re.MULTILINE)
            if not good:
                wrong.append(f"{kind}: {what}: status {got} (right: {status}), wanted /{pattern}/, said:\n  {said.strip()[:600]}")
            rows.append((kind, what, who, text, got, shown(said, used["XDG_STATE_HOME"])))
        for kind in sorted({row[0] for row in rows}):
            those = [row for row in rows if row[0] == kind]
            if not ONLY and kind != "files of reports" and (len(those) < 8 or sum(row[2] == FOUND for row in those) < 3):
                wrong.append(f"{kind}: {len(those)} members are too few")
        if WRITES:
            write_page(rows)
        print(f"{len(rows)} inputs, {len(wrong)} answered otherwise")
        for text in wrong:
            print(text)
        return 1 if wrong else 0


def write_page(rows):
    out = ["# Inputs of other people, kind by kind", "",
           "What people hand to the commands, and what the program says. *Reported* members were met by users of other programs;",
           "*found* ones were looked for beside them. `tests/app/inputs` makes each file, runs the command and holds status and",
           "message against what is right. Written by `tests/app/inputs/inputs_test.py … --write`.", ""]
    for kind in dict.fromkeys(row[0] for row in rows):
        out += [f"## {kind[0].upper()}{kind[1:]}", "", "| input | met | status | what is said |", "|---|---|---|---|"]
        for _, what, who, _, status, said in (row for row in rows if row[0] == kind):
            out.append(f"| {cell(what)} | {who} | {status} | {cell(said[:400])} |")
        out.append("")
    pathlib.Path(PAGE).write_text("\n".join(out).rstrip() + "\n", encoding="utf-8")


if __name__ == "__main__":
    sys.exit(main())
