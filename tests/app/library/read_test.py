# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a served simulation with the Python module: places, pressure of the scene, times, losses.
Usage: read_test.py PROGRAM DESIGN SCENE"""
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import threading

import numpy as np
import triskin

program, design, scene = sys.argv[1:4]
# The scene presses module 5, taxel 3 with 1 N and 3 mm: 3F/(2πr²), 10 counts/kPa (docs/scene.md).
MIDDLE_COUNTS = 3.0 / (2.0 * math.pi * 9e-6) * 1e-3 * 10.0
PRESSED_COUNTS = 20  # docs/stream.md; noise is less
GAIN_SPREAD = 0.024  # of the negative input and of stages (docs/silicon.md); the scene fixes that of chips


def serve():
    """Serves a simulation on a free port; the press begins six seconds of its time after the start."""
    server = subprocess.Popen([program, "simulate", scene, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE, text=True)
    line = server.stdout.readline()
    return server, "sim:127.0.0.1:" + re.search(r"127\.0\.0\.1:(\d+)", line).group(1)


def contents(skin):
    """Compares shapes and places with the design file."""
    d = json.load(open(design))
    assert skin.modules == 8, skin.modules
    assert skin.positions_mm.shape == (8, 12, 3) and skin.normals.shape == (8, 12, 3)
    assert np.allclose(np.linalg.norm(skin.normals, axis=2), 1.0)
    corners = np.array([m["corners"] for m in d["modules"]])
    inside = np.abs(skin.positions_mm.mean(axis=1) - corners.mean(axis=1)).max()
    assert inside < 1.5, inside  # the mean of the pads is near the middle of its module
    assert list(skin.patches) == [m["patch"] for m in d["modules"]] == [0, 0, 0, 0, 2, 2, 2, 2]
    # The design has gaps: arrays are indexed from 0, numbers are those of the labels.
    assert list(skin.numbers) == [m["id"] for m in d["modules"]] == [0, 1, 2, 3, 4, 12, 13, 14], skin.numbers


def stream(skin):
    skin.tare()
    samples = [skin.read(0.5)]
    for _ in range(60):
        samples.append(skin.read(0.5))
        if skin.change_counts().max() > 0.9 * MIDDLE_COUNTS:
            break
    samples = np.concatenate(samples)
    at_rest = skin.change_counts()
    assert at_rest[2].max() < PRESSED_COUNTS, at_rest[2]  # the converters have noise
    assert abs(at_rest[5, 3] - MIDDLE_COUNTS) < GAIN_SPREAD * MIDDLE_COUNTS, at_rest[5]
    assert at_rest.argmax() == 5 * 12 + 3
    for module in range(8):
        mine = samples[samples["module"] == module]
        assert len(mine) > 50, len(mine)
        assert (np.diff(mine["number"].astype(int)) == 1).all(), "a sample is missing"
        assert (np.diff(mine["time_s"]) > 0).all()
    assert samples["value"].shape[1:] == (12,)
    assert samples["valid"][-200:].min() == 0xFFF, "before, the controllers look for the offsets of their converters"
    # On a busy computer the simulation loses time, so its clock is unreliable: a bound exists, but its size is not tested.
    assert (np.isfinite(samples["error_s"])).mean() > 0.5 and samples["error_s"].min() > 0.0
    skin.stop()
    rest = skin.read()
    counts = skin.counts()
    assert counts["lost"] == 0 and counts["lost_here"] == 0, counts
    assert counts["expected"] == counts["received"] >= len(samples) + len(rest), counts


def any_order(skin):
    """Asks in the middle of a stream: it pauses and continues, and the contact is where the scene has it."""
    assert len(skin.read(0.5)) == 0, "behind stop() nothing comes"
    skin.start()
    before = skin.read(1.0)
    assert skin.calibration() is None and skin.verify()[0]
    after = skin.read(1.0)
    assert len(before) > 8 * 15 and len(after) > 8 * 15, (len(before), len(after))
    contacts = skin.contacts()
    assert len(contacts) == 1 and contacts[0]["module"] == 5 and contacts[0]["taxel"] == 3, contacts
    assert np.linalg.norm(contacts[0]["position_mm"] - skin.positions_mm[5, 3]) < 7.0, contacts
    assert math.isnan(contacts[0]["force_n"])
    try:
        skin.pressure_kpa()
    except triskin.BadInput as e:
        assert "triskin calibrate" in str(e)
    else:
        raise AssertionError("kPa without calibration")


def robot():
    """Opens two covers of this design on two buses; nothing of them is flashed, so the test only opens and inspects it."""
    folder = os.path.dirname(design)
    file = os.path.join(folder, "robot.json")
    say = lambda *words: subprocess.run([program, "robot", *words], check=True, stdout=subprocess.DEVNULL)
    say("new", file, "--name", "demo", "--bus", "left=sim", "--bus", "right=sim")
    say("add", file, design, "--name", "arm", "--bus", "left")
    say("add", file, design, "--name", "leg", "--bus", "right", "--xyz-mm", "0,0,500")
    with triskin.open(file) as skin:
        assert skin.covers == ["arm", "leg"] and skin.modules == 16
        assert list(skin.cover) == [0] * 8 + [1] * 8
        assert list(skin.numbers) == 2 * [0, 1, 2, 3, 4, 12, 13, 14]
        assert np.allclose(skin.positions_mm[8:] - skin.positions_mm[:8], [0.0, 0.0, 500.0])


def errors():
    """Every error has a text, also where the file is no text at all."""
    folder = os.path.dirname(design)
    noise, cut = os.path.join(folder, "noise.json"), os.path.join(folder, "cut.mcap")
    open(noise, "wb").write(bytes(range(128, 256)) * 4)
    open(cut, "wb").write(b"\x89MCAP0\r\n" + bytes(range(256)))
    wrong = {"/no/such.json": lambda: triskin.open("/no/such.json"), "nothing": lambda: triskin.open(design, link="nothing"),
             "noise.json": lambda: triskin.open(noise), "cut.mcap": lambda: triskin.open(cut),
             "is a recording": lambda: triskin.open(cut, link="sim")}
    for what, bad in wrong.items():
        try:
            bad()
        except triskin.BadInput as e:
            assert what in str(e) and len(str(e)) > 20, (what, str(e))
        else:
            raise AssertionError("it was opened")


def shared(skin):
    """Calls of several threads are taken one after the other."""
    failed = []

    def work():
        try:
            for _ in range(20):
                skin.read(0.02)
                assert skin.change_counts().shape == (skin.modules, 12)
                skin.contacts()
        except BaseException as e:
            failed.append(repr(e))

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not failed, failed


server, link = serve()
try:
    with triskin.open(pathlib.Path(design), link=link, scene=None) as skin:
        assert re.fullmatch(r"<triskin\.Skin of \d+ modules>", repr(skin)), repr(skin)
        contents(skin)
        stream(skin)
        good, report = skin.verify()
        assert good, report
        any_order(skin)
    errors()
    robot()
finally:
    server.send_signal(signal.SIGINT)
    server.wait()
# Nobody else simulates these boards now, so this process does it in virtual time.
with triskin.open(design, link="sim", scene=scene) as skin:
    assert len(skin.read(2.0)) > 8 * 50 and skin.counts()["lost"] == 0
    shared(skin)
print("ok")
