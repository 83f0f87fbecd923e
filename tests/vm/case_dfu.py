# SPDX-License-Identifier: GPL-3.0-or-later
"""Installs new firmware with dfu-util over USB and with triskin over CAN."""
import os
import pathlib
import struct
import sys
import time

import bench
from bench import DESIGN, controllers, run, triskin
from case_usb import wait_for_devices

MAKE_PACKAGE = pathlib.Path(__file__).parents[2] / "tools/make_firmware_package"


VERSION = (0, 2, 0)  # that of the simulated boards, so that the package is not older


def make_package(path, fill, size=20_000):
    """Makes images that would start: stack, entry and label fit their slots."""
    for name, origin in (("a", 0x08004000), ("b", 0x08040000)):
        image = bytearray(struct.pack("<II", 0x20010000, origin + 0x201) + bytes([fill]) * (size - 8))
        version = VERSION[0] << 24 | VERSION[1] << 16 | VERSION[2]
        image[0x1D8:0x1F0] = b"TSKL" + bytes([1, 0, 0, 0]) + b"TRISKIN1" + struct.pack("<II", version, origin)
        pathlib.Path(f"/tmp/{name}.bin").write_bytes(image)
    run(sys.executable, MAKE_PACKAGE, "/tmp/a.bin", "/tmp/b.bin", path, ".".join(map(str, VERSION)))


def test_firmware_over_can():
    make_package("/tmp/first.tsf", 1)
    make_package("/tmp/second.tsf", 2)
    with controllers("can:vcan1"):
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")
        first = triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1", "--firmware", "/tmp/first.tsf", timeout=120)
        assert [f["slot"] for f in first["firmware"]] == [0] * bench.PATCHES and first["skipped"] == bench.PATCHES, first
        again = triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1", "--firmware", "/tmp/first.tsf")
        assert all(f["equal"] and f["bytes"] == 0 for f in again["firmware"]), again
        second = triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1", "--firmware", "/tmp/second.tsf", timeout=120)
        assert [f["slot"] for f in second["firmware"]] == [1] * bench.PATCHES, second
        bench.verify_all("can:vcan1")
    os.truncate("/tmp/second.tsf", 30_000)
    assert "cut off" in triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1", "--firmware", "/tmp/second.tsf", status=2)["error"]


def test_firmware_to_all_controllers_at_once():
    make_package("/tmp/first.tsf", 1)
    make_package("/tmp/second.tsf", 2)
    for link in ("can:vcan0", "can:vcan1"):
        with controllers(link):
            triskin("flash", DESIGN, "--by-serial", "--link", link)
            first = triskin("flash", DESIGN, "--by-serial", "--link", link, "--firmware", "/tmp/first.tsf", timeout=120)
            assert [f["outcome"] for f in first["firmware"]] == ["updated"] * bench.PATCHES, first  # by their loaders
            second = triskin("flash", DESIGN, "--by-serial", "--link", link, "--firmware", "/tmp/second.tsf", timeout=120)
            assert [(f["outcome"], f["slot"], f["bytes"]) for f in second["firmware"]] == [("updated", 1, 20_000)] * bench.PATCHES, second
            again = triskin("flash", DESIGN, "--by-serial", "--link", link, "--firmware", "/tmp/second.tsf")
            assert all(f["outcome"] == "equal" for f in again["firmware"]), again
            bench.verify_all(link)


def test_dfu_util_updates_the_firmware():
    make_package("/tmp/first.tsf", 3)
    run("dfu-suffix", "-v", "1209", "-p", "0002", "-d", "ffff", "-a", "/tmp/first.tsf")
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        triskin("flash", DESIGN, "--by-serial", "--link", "usb")
        serial = triskin("discover", "--link", "usb")["controllers"][0]["serial"]
        assert "1209:0001" in run("dfu-util", "-l")
        text = run("dfu-util", "-d", "1209:0001,1209:0002", "-S", serial, "-D", "/tmp/first.tsf", "-R", timeout=120, status=None)
        assert "state(2) = dfuIDLE, status(0)" in text.partition("Download done")[2], text
        wait_for_devices(bench.PATCHES)
        time.sleep(1)
        bench.verify_all("usb")
        # A file that is no package is refused, and the controller returns unchanged.
        pathlib.Path("/tmp/nonsense.tsf").write_bytes(bytes(5000))
        text = run("dfu-util", "-d", "1209:0001,1209:0002", "-S", serial, "-D", "/tmp/nonsense.tsf", "-R", timeout=120, status=None)
        assert "Download done" not in text, text
        wait_for_devices(bench.PATCHES, timeout=40)  # it gives the host up after 15 s
        time.sleep(1)
        bench.verify_all("usb")
