# SPDX-License-Identifier: GPL-3.0-or-later
"""One small good file of every format that the program reads, with the cheapest command that reads it."""
import base64
import io
import json
import pathlib
import struct
import subprocess
import zipfile
from dataclasses import dataclass

# A tent of 120 × 90 mm: twelve vertices, twelve triangles, all numbers different from zero.
VERTICES = [(10.5 + 40 * i, 20.25 + 45 * j, 31.125 + 6 * (i in (1, 2)) + j) for j in range(3) for i in range(4)]
FACES = [corner for j in range(2) for i in range(3)
         for corner in ((4 * j + i, 4 * j + i + 1, 4 * j + i + 5), (4 * j + i, 4 * j + i + 5, 4 * j + i + 4))]


@dataclass
class Sample:
    """A file, and how the program reads it. `{file}`, `{out}` and names of other files in braces are put into `command`."""
    name: str
    file: str
    command: tuple
    is_text: bool = True
    reads_mesh: bool = False    # What it writes is the mesh that was read.
    has_checksums: bool = False  # A mesh that differs must be refused or said, whatever was damaged.
    is_sealed: bool = False     # Any damage must be refused or said.
    is_ascii: bool = False      # By its standard: a file in UTF-16 is refused by that name.
    is_line_wise: bool = False  # Each line has an end; the last one without may have been cut.
    # A line of this text may be missing or stand twice without a trace: nothing in the format counts it.
    uncounted: tuple = ()
    pack: object = None  # Puts the damaged part into a whole file, in place of {file}.
    cost: float = 1.0  # Processor time beside that of reading a mesh: dear commands get fewer trials.


def obj():
    text = "# tent\no tent\n" + "".join(f"v {x} {y} {z}\n" for x, y, z in VERTICES)
    return text + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)


def text_stl():
    text = "solid tent\n"
    for face in FACES:
        text += "facet normal 0 0 1\nouter loop\n"
        text += "".join("vertex {} {} {}\n".format(*VERTICES[v]) for v in face) + "endloop\nendfacet\n"
    return text + "endsolid tent\n"


def binary_stl():
    data = b"made for a test".ljust(80) + struct.pack("<I", len(FACES))
    for face in FACES:
        data += struct.pack("<3f", 0, 0, 1) + b"".join(struct.pack("<3f", *VERTICES[v]) for v in face) + b"\0\0"
    return data


def off():
    text = f"OFF\n{len(VERTICES)} {len(FACES)} 0\n" + "".join("{} {} {}\n".format(*v) for v in VERTICES)
    return text + "".join("3 {} {} {}\n".format(*f) for f in FACES)


def ply(form):
    head = (f"ply\nformat {form} 1.0\ncomment tent\nelement vertex {len(VERTICES)}\nproperty double x\nproperty double y\n"
            f"property double z\nelement face {len(FACES)}\nproperty list uchar int vertex_indices\nend_header\n")
    if form == "ascii":
        rows = ["{} {} {}\n".format(*v) for v in VERTICES] + ["3 {} {} {}\n".format(*f) for f in FACES]
        return (head + "".join(rows)).encode()
    order = "<" if form == "binary_little_endian" else ">"
    return head.encode() + b"".join(struct.pack(order + "3d", *v) for v in VERTICES) + \
        b"".join(struct.pack(order + "B3i", 3, *f) for f in FACES)


def buffer():
    metres = b"".join(struct.pack("<3f", *(c / 1000 for c in v)) for v in VERTICES)
    return metres + b"".join(struct.pack("<3H", *f) for f in FACES)


def gltf(uri):
    data = buffer()
    positions = 12 * len(VERTICES)
    stored = {"byteLength": len(data)} | ({"uri": uri} if uri else {})
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": "tent"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(VERTICES), "type": "VEC3"},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(FACES), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteLength": positions},
                        {"buffer": 0, "byteOffset": positions, "byteLength": len(data) - positions}],
        "buffers": [stored]}, indent=1)


def glb():
    text = gltf("").encode()
    text += b" " * (-len(text) % 4)
    data = buffer()
    data += bytes(-len(data) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def model():
    points = "\n".join('<vertex x="{}" y="{}" z="{}"/>'.format(*v) for v in VERTICES)
    corners = "\n".join('<triangle v1="{}" v2="{}" v3="{}"/>'.format(*f) for f in FACES)
    return ('<?xml version="1.0"?>\n<model unit="millimeter" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n<resources>\n<object id="1" type="model">'
            f'<mesh><vertices>\n{points}\n</vertices><triangles>\n{corners}\n</triangles></mesh></object>\n</resources>\n'
            '<build><item objectid="1" transform="1 0 0 0 1 0 0 0 1 5 0 0"/></build>\n</model>\n')


def three_mf(text, method=zipfile.ZIP_DEFLATED):
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w", method) as package:
        package.writestr("[Content_Types].xml", '<?xml version="1.0"?><Types xmlns="http://schemas.openxmlformats.org/'
                         'package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-'
                         'package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.'
                         '3dmanufacturing-3dmodel+xml"/></Types>')
        package.writestr("_rels/.rels", '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/'
                         'package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.'
                         'microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
        package.writestr("3D/3dmodel.model", text)
    return held.getvalue()


def dae():
    points = "\n".join("{} {} {}".format(*v) for v in VERTICES)
    corners = "\n".join("{} {} {}".format(*f) for f in FACES)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="a" count="{3 * len(VERTICES)}">
{points}
</float_array><technique_common><accessor source="#a" count="{len(VERTICES)}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="{len(FACES)}"><input semantic="VERTEX" source="#v" offset="0"/><p>
{corners}
</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>
"""


OUTLINE = [[[0.5, 0.25], [120.5, 0.25], [120.5, 80.25], [0.5, 80.25], [0.5, 0.25]],
           [[50.5, 30.25], [50.5, 40.25], [60.5, 40.25], [50.5, 30.25]]]
SURFACE = ("extract", "{file}", "-o", "{out}.obj", "--outer", "never", "--wrap", "never")
PLACE = ("place", "{file}", "-o", "{out}.json", "--time-limit-s", "0.1")
SIM = ("--link", "sim")
CONE = pathlib.Path(__file__).resolve().parents[3] / "shared" / "data" / "step" / "cone_tip.step"

SAMPLES = [
    Sample("OBJ", "tent.obj", SURFACE, reads_mesh=True, uncounted=(b"f ", b"o ", b"#")),
    Sample("STL, text", "text.stl", SURFACE, reads_mesh=True, uncounted=(b"facet",)),
    Sample("STL, binary", "binary.stl", SURFACE, is_text=False, reads_mesh=True),
    Sample("OFF", "tent.off", SURFACE, reads_mesh=True),
    Sample("PLY, text", "text.ply", SURFACE, reads_mesh=True, uncounted=(b"comment",)),
    Sample("PLY, little endian", "little.ply", SURFACE, is_text=False, reads_mesh=True),
    Sample("PLY, big endian", "big.ply", SURFACE, is_text=False, reads_mesh=True),
    Sample("glTF with data in it", "inline.gltf", SURFACE, reads_mesh=True),
    Sample("glTF", "tent.gltf", SURFACE, reads_mesh=True),
    Sample("buffer of a glTF", "tent.bin", ("extract", "{tent.gltf}", "-o", "{out}.obj"), is_text=False, reads_mesh=True),
    Sample("GLB", "tent.glb", SURFACE, is_text=False, reads_mesh=True),
    Sample("3MF", "tent.3mf", SURFACE, is_text=False, reads_mesh=True, has_checksums=True),
    Sample("3MF, stored", "stored.3mf", SURFACE, is_text=False, reads_mesh=True, has_checksums=True),
    Sample("model of a 3MF", "tent.model", SURFACE, reads_mesh=True, uncounted=(b"<triangle",),
           pack=lambda text: ("packed.3mf", three_mf(text))),
    Sample("DAE", "tent.dae", SURFACE, reads_mesh=True, cost=2),
    Sample("GeoJSON", "outline.geojson", PLACE, cost=2),
    Sample("WKT", "outline.wkt", PLACE, cost=2),
    Sample("design, check", "strip.json", ("check", "{file}")),
    Sample("design, export", "strip.json", ("export", "{file}", "--format", "taxels", "-o", "{out}.csv")),
    Sample("design, verify", "strip.json", ("verify", "{file}", *SIM, "--no-touch"), cost=5),
    Sample("robot", "robot.json", ("robot", "show", "{file}")),
    Sample("URDF", "robot.urdf", ("robot", "show", "{robot.json}")),
    Sample("touches", "touches.csv", ("robot", "register", "{robot.json}", "{file}", "--name", "arm", "--dry-run"),
           is_line_wise=True),
    Sample("scene", "scene.json", ("simulate", "{file}", "--seconds", "0.01"), cost=4),
    Sample("regions", "regions.json", ("design", "{tent.obj}", "-o", "{out}.json", "--regions", "{file}", "--iterations", "1",
                                       "--time-limit-s", "0.2"), cost=20),
    Sample("kinds", "kinds.json", ("edit", "{strip.json}", "-o", "{out}.json", "--kinds", "{file}")),
    Sample("module list", "modules.json", ("route", "{file}", "-o", "{out}.json")),
    Sample("net", "net.json", PLACE, cost=4),
    Sample("proof", "proof.json", ("check-proof", "{file}", "{outline.wkt}")),
    Sample("calibration", "calibration.json", ("live", "{strip.json}", *SIM, "--calibration", "{file}", "--seconds", "0.05"),
           cost=4),
    Sample("rest values", "state/triskin/rest/*.json", ("live", "{strip.json}", *SIM, "--seconds", "0.05"), cost=4),
    Sample("flash of a simulated board", "state/triskin/sim/*/controller_1.flash",
           ("verify", "{strip.json}", *SIM, "--no-touch"), is_text=False, cost=8),
    Sample("gauge", "gauge.csv", ("calibrate", "{strip.json}", *SIM, "--ramp", "{file}", "--by-hand"), is_line_wise=True, cost=8),
    Sample("backup", "backup.json", ("flash", "{strip.json}", *SIM, "--restore", "{file}", "--dry-run"), cost=4),
    Sample("assignment", "boards.json", ("flash", "{strip.json}", *SIM, "--assign-file", "{file}", "--dry-run"), cost=4),
    Sample("recording, recover", "work.mcap", ("recover", "{file}", "-o", "{out}.mcap"), is_text=False, is_sealed=True),
    Sample("recording, replay", "work.mcap", ("replay", "{file}", "--speed", "0"), is_text=False),
    Sample("recording, page", "work.mcap", ("export", "{file}", "--format", "html", "-o", "{out}.html"), is_text=False),
    Sample("observations", "inverse.json", ("contact", "--inverse", "{file}"), cost=10),
    Sample("STEP", "part.step", ("faces", "{file}"), is_ascii=True, cost=40),
    Sample("seams", "seams.obj", ("unfold", "{tent.obj}", "-o", "{out}.json", "--seams", "{file}"), is_line_wise=True, uncounted=(b"v ", b"l ")),
]


def run(triskin, *arguments, folder):
    """Runs the program where the good files are made; it must work."""
    subprocess.run([triskin, *map(str, arguments)], cwd=folder, check=True, stdout=subprocess.DEVNULL,
                   stderr=subprocess.PIPE)


def make(triskin, write_strip, folder):
    """Writes all files into `folder`, which is also where the program keeps its state."""
    folder = pathlib.Path(folder)
    texts = {"tent.obj": obj(), "text.stl": text_stl(), "tent.off": off(), "tent.gltf": gltf("tent.bin"),
             "inline.gltf": gltf("data:application/octet-stream;base64," + base64.b64encode(buffer()).decode()),
             "tent.model": model(), "tent.dae": dae(),
             "outline.geojson": json.dumps({"type": "Polygon", "coordinates": OUTLINE}),
             "outline.wkt": "POLYGON (" + ", ".join(
                 "(" + ", ".join(f"{x} {y}" for x, y in ring) + ")" for ring in OUTLINE) + ")",
             "seams.obj": "v 50.5 20.25 37.125\nv 50.5 65.25 38.125\nl 1 2\n"}
    for name, text in texts.items():
        (folder / name).write_text(text)
    data = {"binary.stl": binary_stl(), "text.ply": ply("ascii"), "little.ply": ply("binary_little_endian"),
            "big.ply": ply("binary_big_endian"), "tent.bin": buffer(), "tent.glb": glb(), "tent.3mf": three_mf(model()),
            "stored.3mf": three_mf(model(), zipfile.ZIP_STORED)}
    for name, content in data.items():
        (folder / name).write_bytes(content)
    if CONE.exists():
        (folder / "part.step").write_bytes(CONE.read_bytes())
    make_designs(triskin, write_strip, folder)
    for sample in SAMPLES:
        for found in folder.glob(sample.file) if "*" in sample.file else ():
            sample.file = str(found.relative_to(folder))


def make_designs(triskin, write_strip, folder):
    """What hangs on a design: robot, scene, kinds, calibration, backup, recording."""
    subprocess.run([write_strip, folder / "strip.json", "4"], check=True)
    (folder / "robot.urdf").write_text('<?xml version="1.0"?>\n<robot name="r"><link name="base"/><link name="arm_link"/>\n'
                                       '<joint name="j" type="fixed"><parent link="base"/><child link="arm_link"/>\n'
                                       '<origin xyz="0.1 0 0.2" rpy="0 1.5 0"/></joint></robot>\n')
    run(triskin, "robot", "new", "robot.json", "--name", "r", "--bus", "left=sim", "--urdf", "robot.urdf", folder=folder)
    run(triskin, "robot", "add", "robot.json", "strip.json", "--name", "arm", "--bus", "left", "--frame", "arm_link",
        "--xyz-mm", "1.5,2.5,3.5", "--serial", "0=0123456789ABCDEF01234567", folder=folder)
    make_touches(folder)
    (folder / "scene.json").write_text(json.dumps({
        "format": "triskin-scene", "version": 1, "design": "strip.json", "seed": 5,
        "contacts": [{"at_s": 0.5, "until_s": 1.5, "module": 1, "taxel": 3, "force_n": 1.5, "radius_mm": 3.5},
                     {"module": 0, "every_s": 4, "passes": 5, "keyframes": [
                         {"at_s": 2, "force_n": 0}, {"at_s": 2.5, "force_n": 6}, {"at_s": 3, "module": 1, "force_n": 0}]}],
        "faults": [{"kind": "swapped_chips", "module": 1, "other": 2}], "effects": {"noise_counts": 3.5},
        "expect": [{"at_s": 1.25, "module": 1, "pressed": True}]}, indent=1))
    (folder / "regions.json").write_text(json.dumps({
        "format": "triskin-regions", "version": 1, "elsewhere": 1.5, "regions": [
            {"name": "palm", "sphere": {"center_mm": [60, 60, 35], "radius_mm": 35}, "weight": 3},
            {"name": "shin", "box": {"low_mm": [5, 5, 5], "high_mm": [60, 60, 80]}, "cover": True, "within_mm": 2.5},
            {"name": "logo", "faces": [9, 10], "free": True}]}, indent=1))
    (folder / "kinds.json").write_text(json.dumps({
        "format": "triskin-kinds", "version": 1,
        "kinds": [{"name": "soft", "taxels": 10, "dielectric": "foam", "sensitivity_counts_per_kpa": 80.5}, {"name": "hard"}],
        "regions": [{"kind": "soft", "box": {"low_mm": [0.5, -1.5, -1.5], "high_mm": [50, 30, 1]}},
                    {"kind": "hard", "modules": [1, 2]}]}, indent=1))
    (folder / "gauge.csv").write_text("time_s,kpa\n" + "".join(f"{0.1 * k:.1f},{2.5 * k}\n" for k in range(20)))
    (folder / "inverse.json").write_text(json.dumps(observations(), indent=1))
    run(triskin, "unfold", "tent.obj", "-o", "net.json", folder=folder)
    run(triskin, "place", "outline.wkt", "-o", "modules.json", "--proof", "proof.json", folder=folder)
    run(triskin, "flash", "strip.json", *SIM, "--save", "backup.json", folder=folder)
    run(triskin, "calibrate", "strip.json", *SIM, "--steps", "5,10,20", "-o", "calibration.json", folder=folder)
    run(triskin, "live", "strip.json", *SIM, "--seconds", "0.2", "--tare", folder=folder)
    run(triskin, "identify", "strip.json", *SIM, "-o", "boards.json", folder=folder)
    run(triskin, "record", "strip.json", *SIM, "--seconds", "1", "-o", "work.mcap", folder=folder)


def make_touches(folder):
    """Taxels of the strip, where the arm of the robot has them."""
    rows = "module,taxel,x_mm,y_mm,z_mm\n"
    modules = json.loads((folder / "strip.json").read_text())["modules"]
    for module in modules:
        for taxel in (0, 4, 8):
            x, y, z = module["taxels"][taxel]["position"]
            rows += f"{module['id']},{taxel},{x + 1.5:.3f},{y + 2.5:.3f},{z + 3.5:.3f}\n"
    (folder / "touches.csv").write_text(rows)


def observations():
    """Seven taxels under one round tip."""
    places = [[4.5 * i, 4.5 * j] for j in range(3) for i in range(4)]
    return {"modules": [{"taxels_mm": places}],
            "cases": [{"id": "one", "material": {"h_mm": 2.5, "nu": 0.3, "E_kpa": 100.5},
                       "dC_over_C0": [[0.01, 0.03, 0.02, 0.001, 0.02, 0.08, 0.05, 0.002, 0.01, 0.03, 0.02, 0.001]]}]}
