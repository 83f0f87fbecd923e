# SPDX-License-Identifier: GPL-3.0-or-later
"""The members of the table of inputs: what people hand to a command, how it is made here, and what is right.

A member is (kind, what it is, who met it, files, command, status, pattern). `files` maps a name to its bytes, `command`
is what follows `triskin`, and `pattern` has to be found in what it says. "reported" members were met by users of other
programs, "found" ones were looked for here beside them."""
import base64
import binascii
import io
import json
import math
import struct
import zipfile

REPORTED, FOUND = "reported", "found"


# Shapes ---------------------------------------------------------------------------------------------------------------

def block(x=120.0, y=90.0, z=40.0, at=(0.0, 0.0, 0.0)):
    """A closed box: vertices and triangles, 2 (xy + yz + zx) of area."""
    v = [(at[0] + x * (k & 1), at[1] + y * (k >> 1 & 1), at[2] + z * (k >> 2 & 1)) for k in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return v, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def strip(turns, count=60):
    """A band of radius 60 mm and width 40 mm that turns over itself `turns` half times: with one it has one side."""
    v = []
    for k in range(count):
        a = 2 * math.pi * k / count
        for side in (-20.0, 20.0):
            r = 60.0 + side * math.cos(turns * a / 2)
            v.append((r * math.cos(a), r * math.sin(a), side * math.sin(turns * a / 2)))
    faces = []
    for k in range(count):
        a, b = 2 * k, 2 * k + 1
        c, d = (2 * k + 2, 2 * k + 3) if k + 1 < count else ((1, 0) if turns % 2 else (0, 1))
        faces += [(a, c, b), (b, c, d)]
    return v, faces


def scaled(mesh, scale):
    v, f = mesh
    return [tuple(scale * c for c in p) for p in v], f


def obj(mesh, scale=1.0):
    v, f = mesh
    return ("".join("v %g %g %g\n" % tuple(scale * c for c in p) for p in v)
            + "".join("f %d %d %d\n" % tuple(k + 1 for k in t) for t in f)).encode()


def text_stl(mesh):
    v, f = mesh
    return ("solid s\n" + "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % v[k] for k in t)
                                  + "endloop\nendfacet\n" for t in f) + "endsolid s\n").encode()


def zipped(files):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, data in files.items():
            archive.writestr(name, data)
    return out.getvalue()


# 3MF ------------------------------------------------------------------------------------------------------------------

CORE = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02"


def mesh_xml(mesh):
    v, f = mesh
    return ("<mesh><vertices>" + "".join('<vertex x="%g" y="%g" z="%g"/>' % p for p in v) + "</vertices><triangles>"
            + "".join('<triangle v1="%d" v2="%d" v3="%d"/>' % t for t in f) + "</triangles></mesh>")


def three_mf(objects, build, more=None, attributes="", namespace=f'xmlns="{CORE}"', unit="millimeter"):
    model = (f'<?xml version="1.0"?><model unit="{unit}" {namespace} {attributes}><resources>{objects}</resources>'
             f"<build>{build}</build></model>")
    return zipped({"_rels/.rels": '<?xml version="1.0"?><Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                   '<Relationship Target="/3D/3dmodel.model" Id="r" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>',
                   "3D/3dmodel.model": model, **(more or {})})


def two_blocks():
    """One object of two blocks, triangles 0 … 11 and 12 … 23."""
    (v, f), (w, g) = block(), block(30, 30, 30, (200, 0, 0))
    return v + w, f + [tuple(k + 8 for k in t) for t in g]


def prusa(second, first="12"):
    return three_mf(f'<object id="1" type="model">{mesh_xml(two_blocks())}</object>', '<item objectid="1"/>',
                    {"Metadata/Slic3r_PE_model.config": '<config><object id="1"><volume firstid="0" lastid="11">'
                     '<metadata type="volume" key="volume_type" value="ModelPart"/></volume>'
                     f'<volume firstid="{first}" lastid="23">'
                     f'<metadata type="volume" key="name" value="second"/>{second}</volume></object></config>'})


def bambu(subtype):
    parts = (f'<object id="1" type="model">{mesh_xml(block())}</object><object id="2" name="second" type="model">'
             f'{mesh_xml(block(30, 30, 30))}</object><object id="3" type="model"><components><component objectid="1"/>'
             '<component objectid="2" transform="1 0 0 0 1 0 0 0 1 200 0 0"/></components></object>')
    return three_mf(parts, '<item objectid="3"/>', {
        "Metadata/model_settings.config": '<config><object id="3"><part id="1" subtype="normal_part"/>'
        f'<part id="2" subtype="{subtype}"><metadata key="name" value="second"/></part></object></config>'})


def cura(key):
    return three_mf(f'<object id="1" type="model">{mesh_xml(block())}</object><object id="2" name="second" type="model"><metadatagroup>'
                    f'<metadata name="cura:{key}" preserve="1" type="xs:boolean">True</metadata></metadatagroup>'
                    f'{mesh_xml(block(30, 30, 30))}</object>',
                    '<item objectid="1"/><item objectid="2" transform="1 0 0 0 1 0 0 0 1 200 0 0"/>')


# glTF -----------------------------------------------------------------------------------------------------------------

def gltf(nodes, mesh_extra=None, scenes=(0,), extra=None, used=(), accessors=(), more=b"", views=()):
    v, f = block()
    flat = [i for t in f for i in t]
    positions = struct.pack(f"<{3 * len(v)}f", *(c / 1000.0 for p in v for c in p))
    indices = struct.pack(f"<{len(flat)}H", *flat)
    data = positions + indices + more
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(scenes)}], "nodes": nodes,
        "meshes": [{"name": "block", "primitives": [{"attributes": {"POSITION": 0, **(mesh_extra or {})}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
                        {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)},
                        *[{"buffer": 0, "byteOffset": len(positions) + len(indices) + at, "byteLength": size} for at, size in views]],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(v), "type": "VEC3", "min": [0, 0, 0], "max": [0.12, 0.09, 0.04]},
                      {"bufferView": 1, "componentType": 5123, "count": len(flat), "type": "SCALAR"}, *accessors],
        **({"extensionsUsed": list(used)} if used else {}), **(extra or {})}
    return json.dumps(document).encode()


def hidden(node):
    return {**node, "extensions": {"KHR_node_visibility": {"visible": False}}}


def skinned(node_transform, joint_transform):
    count = 8
    joints, weights = struct.pack(f"<{4 * count}B", *([0, 0, 0, 0] * count)), struct.pack(f"<{4 * count}f", *([1.0, 0, 0, 0] * count))
    return gltf([{"mesh": 0, "skin": 0, **node_transform}, {"name": "joint", **joint_transform}],
                {"JOINTS_0": 2, "WEIGHTS_0": 3}, scenes=(0, 1), extra={"skins": [{"joints": [1]}]},
                accessors=[{"bufferView": 2, "componentType": 5121, "count": count, "type": "VEC4"},
                           {"bufferView": 3, "componentType": 5126, "count": count, "type": "VEC4"}],
                more=joints + weights, views=[(0, len(joints)), (len(joints), len(weights))])


def instanced():
    places = struct.pack("<6f", 0, 0, 0, 0.3, 0, 0)
    return gltf([{"mesh": 0, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 2}}}}],
                used=["EXT_mesh_gpu_instancing"], accessors=[{"bufferView": 2, "componentType": 5126, "count": 2, "type": "VEC3"}],
                more=places, views=[(0, len(places))])


def morphed(weight):
    v, _ = block()
    moved = struct.pack(f"<{3 * len(v)}f", *(c for p in v for c in (0.0, 0.0, 0.04 if p[2] > 0 else 0.0)))
    document = json.loads(gltf([{"mesh": 0, "weights": [weight]}], accessors=[{"bufferView": 2, "componentType": 5126, "count": len(v), "type": "VEC3"}],
                               more=moved, views=[(0, len(moved))]))
    document["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": 2}]
    return json.dumps(document).encode()


# COLLADA --------------------------------------------------------------------------------------------------------------

def dae(node, unit='<unit meter="1"/>', per_metre=1.0):
    v, f = scaled(block(), 1e-3 * per_metre)
    return f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>{unit}
<up_axis>Z_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="{3 * len(v)}">
{' '.join(str(c) for q in v for c in q)}</float_array><technique_common><accessor source="#a" count="{len(v)}" stride="3">
<param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="{len(f)}"><input semantic="VERTEX" source="#v"
offset="0"/><p>{' '.join(str(k) for t in f for k in t)}</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node id="n">{node}<instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


# STEP -----------------------------------------------------------------------------------------------------------------

def step_with(good, entities):
    return good.replace("ENDSEC;\nEND-ISO", entities + "ENDSEC;\nEND-ISO", 1).encode()


def operator(values):
    return ("#9001=DIRECTION('',(1.,0.,0.));\n#9002=DIRECTION('',(0.,1.,0.));\n#9003=DIRECTION('',(0.,0.,1.));\n"
            "#9004=DIRECTION('',(0.,0.,-1.));\n#9005=CARTESIAN_POINT('',(0.,0.,0.));\n" + values)


# Drawings -------------------------------------------------------------------------------------------------------------

def dxf(entities, header="9\n$INSUNITS\n70\n4\n", tables=""):
    return ("0\nSECTION\n2\nHEADER\n" + header + "0\nENDSEC\n" + tables + "0\nSECTION\n2\nENTITIES\n" + entities
            + "0\nENDSEC\n0\nEOF\n").encode()


def lwpolyline(points, closed=1, layer="0"):
    return f"0\nLWPOLYLINE\n8\n{layer}\n90\n{len(points)}\n70\n{closed}\n" + "".join(
        f"10\n{p[0]}\n20\n{p[1]}\n" + (f"42\n{p[2]}\n" if len(p) > 2 else "") for p in points)


def line(a, b):
    return f"0\nLINE\n8\n0\n10\n{a[0]}\n20\n{a[1]}\n11\n{b[0]}\n21\n{b[1]}\n"


RECTANGLE = [(0, 0), (150, 0), (150, 120), (0, 120)]


def svg(inside, head='width="150mm" height="120mm" viewBox="0 0 150 120"'):
    return f'<?xml version="1.0"?><svg xmlns="http://www.w3.org/2000/svg" {head}>{inside}</svg>'.encode()


def geojson(points):
    return json.dumps({"type": "Polygon", "coordinates": [[*points, points[0]]]}).encode()


# URDF -----------------------------------------------------------------------------------------------------------------

def urdf(inside, head='name="r"'):
    return f'<?xml version="1.0"?><robot {head}>{inside}</robot>'.encode()


def joint(origin, parent="base", child="arm", name="j", type="fixed"):
    return f'<joint name="{name}" type="{type}"><parent link="{parent}"/><child link="{child}"/>{origin}</joint>'


LINKS = '<link name="base"/><link name="arm"/>'


# Recordings -----------------------------------------------------------------------------------------------------------

def mcap_records(data):
    """Yields (kind, contents) of the records behind the magic bytes."""
    at = 8
    while at + 9 <= len(data) - 8:
        kind, size = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        yield kind, data[at + 9:at + 9 + size]
        at += 9 + size


def record(kind, contents):
    return bytes([kind]) + struct.pack("<Q", len(contents)) + contents


MAGIC = b"\x89MCAP0\r\n"


def closed(records):
    """A file of these records without summary."""
    return MAGIC + records + record(15, struct.pack("<I", 0)) + record(2, struct.pack("<QQI", 0, 0, 0)) + MAGIC


def with_attachments(data, place):
    """The recording as a program writes it that puts attachments behind the messages, or leaves them out."""
    kept, attached = b"", b""
    for kind, contents in mcap_records(data):
        if kind == 15:
            break
        if kind == 9:
            attached += record(kind, contents)
        else:
            kept += record(kind, contents)
    return closed(kept + (attached if place == "behind" else b""))


def recording_of(topic, schema):
    """A recording of another program: one message, or none without a topic."""
    text = lambda t: struct.pack("<I", len(t)) + t.encode()
    records = record(1, text("ros2") + text("other"))
    if topic:
        records += record(3, struct.pack("<H", 1) + text(schema) + text("ros2msg") + struct.pack("<I", 0))
        records += record(4, struct.pack("<HH", 0, 1) + text(topic) + text("cdr") + struct.pack("<I", 0))
        records += record(5, struct.pack("<HIQQ", 0, 0, 1, 1) + b"abc")
    return closed(records)


def retyped(data, change):
    """The recording without chunks, in which `change(name)` gives the schema of the samples another number (None: the
    same) and another name."""
    plain = rewritten(data, False, list, 0)
    kept, number = b"", None
    for kind, contents in mcap_records(plain):
        if kind == 15:
            break
        if kind == 3:
            size = struct.unpack_from("<I", contents, 2)[0]
            name = contents[6:6 + size].decode()
            if name.endswith("/RawFrame"):
                number = struct.unpack_from("<H", contents)[0]
                name = change(name)[1]
                contents = contents[:2] + struct.pack("<I", len(name)) + name.encode() + contents[6 + size:]
        if kind == 4 and number is not None and struct.unpack_from("<H", contents, 2)[0] == number:
            wanted = change("RawFrame")[0]
            contents = contents[:2] + struct.pack("<H", number if wanted is None else wanted) + contents[4:]
        kept += record(kind, contents)
    return closed(kept)


def rewritten(data, chunked, order, shift):
    """The recording as another writer would store it: with or without chunks, messages in another order, channel and
    schema numbers moved by `shift`, without summary and indexes."""
    out, chunks = [], []
    for kind, contents in mcap_records(data):
        if kind == 15:  # End of the data: the summary behind it is left out.
            break
        if kind == 6:
            head = struct.unpack_from("<QQQI", contents)
            inside = contents[28 + 4 + struct.unpack_from("<I", contents, 28)[0] + 8:]
            assert len(inside) == head[2]
            at = 0
            while at < len(inside):
                size = struct.unpack_from("<Q", inside, at + 1)[0]
                chunks.append((inside[at], inside[at + 9:at + 9 + size]))
                at += 9 + size
        elif kind in (1, 9, 12):
            out.append((kind, contents))
        elif kind in (3, 4, 5):
            chunks.append((kind, contents))
    def moved(kind, contents):
        if kind == 3:
            return struct.pack("<H", struct.unpack_from("<H", contents)[0] + max(shift, 0)) + contents[2:]
        if kind == 4:
            channel, schema = struct.unpack_from("<HH", contents)
            return struct.pack("<HH", channel + shift, schema + max(shift, 0)) + contents[4:]
        return struct.pack("<H", struct.unpack_from("<H", contents)[0] + shift) + contents[2:]
    definitions = [(k, moved(k, c)) for k, c in chunks if k != 5]
    messages = [moved(k, c) for k, c in chunks if k == 5]
    messages = order(messages)
    body = b"".join(record(k, c) for k, c in out)
    inside = b"".join(record(k, c) for k, c in definitions)
    if chunked:
        inside += b"".join(record(5, m) for m in messages)
        times = [struct.unpack_from("<Q", m, 6)[0] for m in messages]
        body += record(6, struct.pack("<QQQI", min(times), max(times), len(inside), binascii.crc32(inside)) + struct.pack("<I", 0)
                       + struct.pack("<Q", len(inside)) + inside)
    else:
        body += inside + b"".join(record(5, m) for m in messages)
    return closed(body)
