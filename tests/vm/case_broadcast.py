# SPDX-License-Identifier: GPL-3.0-or-later
"""Sends one image to all boards of a robot's bus that loses frames, while one board dies and one loses its power."""
import json
import pathlib
import random
import re
import subprocess
import time

import bench
from bench import run, start, triskin
from case_dfu import make_package

COVERS = {"a": 13, "b": 1, "c": 1, "d": 1}  # boards of each
IMAGE_BYTES = 100_000
# A frame with an identifier of 29 bits and eight bytes of data has 128 bits, the gap and up to 26 stuff bits: the queue counts every
# frame as 16 bytes, and 2 on top of them; ten wait at most, as in a driver's. The emulated processor computes sixteen boards, so the
# host's end has a fortieth of 1 Mbit/s; bus time is what the frames of both ends take at 1 Mbit/s.
FRAME_BITS = 18 * 8
LOSS = ("loss", "1%")
SLOW = ("limit", "10", "rate", "25kbit", "2")


def simulate(cover):
    """Runs the boards of a cover as a process with their flash in files, so that killing it is a loss of power."""
    return start("env", f"XDG_STATE_HOME=/tmp/{cover}", bench.TRISKIN, "simulate", f"{cover}.json", "--board-seed", ord(cover),
                 "--listen", "can:vxcan1", wait_for="end with Ctrl-C")


def make_robot():
    """A robot file, and the boards of each cover with their tables; returns the processes. d keeps what it left the factory with,
    which does not know the broadcast; the others have an application that does."""
    make_package("first.tsf", 1, size=4_000)
    run(bench.TRISKIN, "robot", "new", "robot.json", "--name", "robot", "--bus", "can=can:vxcan0")
    boards = {}
    for cover, count in COVERS.items():
        run(pathlib.Path(bench.TRISKIN).with_name("write_strip"), f"{cover}.json", count, 1)
        run(bench.TRISKIN, "robot", "add", "robot.json", f"{cover}.json", "--name", cover, "--bus", "can")
        boards[cover] = simulate(cover)
        options = [] if cover == "d" else ["--firmware", "first.tsf"]
        done = triskin("flash", "robot.json", "--cover", cover, "--by-serial", *options, timeout=120)
        assert done["controllers"] == count, done
    return boards


def data_frames(count):
    """Ends when this many frames of an image were on the bus."""
    return subprocess.Popen(["candump", "-r", "4000000", "-n", str(count), "vxcan1,1BF80000:1FFE0000"], stdout=subprocess.DEVNULL)


def outcomes(result):
    """Returns the result for the boards of each cover."""
    of_serial = {f["serial"]: f["outcome"] for f in result["firmware"]}
    return {c["cover"]: {of_serial[p["serial"]] for p in c["patches"]} for c in result["covers"]}


def test_firmware_to_sixteen_boards_on_a_bus_that_loses_frames():
    """c dies when the data begin, b loses its power somewhere in them. The loader of d may be given up: ISO-TP repeats no frame."""
    make_package("second.tsf", 2, size=IMAGE_BYTES)
    seed = 22
    cut_after = random.Random(seed).randrange(IMAGE_BYTES // 8)
    bench.log.append(f"seed {seed}: board b is cut after {cut_after} of {IMAGE_BYTES // 8} data frames")
    with bench.TwoEndedBus("vxcan0", "vxcan1") as bus:
        boards = make_robot()
        bus.queue(SLOW + LOSS, LOSS)
        first, later = data_frames(1), data_frames(cut_after)
        time.sleep(0.5)
        flash = start(bench.TRISKIN, "flash", "robot.json", "--firmware", "second.tsf", "--json")
        for seen, cover in ((first, "c"), (later, "b")):
            seen.wait(120)
            boards[cover].kill()
        flash.wait(180)
        frames = bus.frames()
        bus_s = frames * FRAME_BITS / 1e6
        text = flash.output_path.read_text()
        bench.log.append(f"{frames} frames, {bus_s:.2f} s at 1 Mbit/s\n{text}")
        got = outcomes(json.loads(text[text.index("{"):].splitlines()[0]))
        assert flash.returncode == 1, (flash.returncode, got)
        assert (got["a"], got["b"], got["c"]) == ({"updated"}, {"given up"}, {"given up"}), got
        assert got["d"] <= {"updated", "given up"} and bus_s <= 4.0, (got, bus_s)
        again = int(re.search(r"data frames, (\d+) of them again", text)[1])
        assert again > 0.005 * IMAGE_BYTES / 8, again  # The queue did lose some.
        # Their power is back, and nothing is lost any more: they run their old image, and take the new one.
        bus.no_queue()
        for cover in "bc":
            boards[cover].wait()
            simulate(cover)
        got = outcomes(triskin("flash", "robot.json", "--firmware", "second.tsf", timeout=180))
        assert (got["a"], got["b"], got["c"]) == ({"equal"}, {"updated"}, {"updated"}), got
        verified = triskin("verify", "robot.json", "--no-touch", "--watch-s", "0")
        assert verified["modules_ok"] == sum(COVERS.values()), verified
