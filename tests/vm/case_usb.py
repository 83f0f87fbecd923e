# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs triskin and lsusb with controllers that are USB devices of this kernel."""
import time

import bench
from bench import DESIGN, controllers, run, triskin
from case_can import flash_verify_live


def wait_for_devices(count, product="1209:0001", timeout=20):
    end = time.monotonic() + timeout
    while (found := run("lsusb", "-d", product, status=None).count(product)) != count:
        assert time.monotonic() < end, f"{found} devices {product}, expected {count}"
        time.sleep(0.1)


def stream(link):
    live = triskin("live", DESIGN, "--link", link, "--seconds", "2", status=None)
    # An emulated processor that shows its own stream to itself may be too slow for all of it; then it must say so.
    assert live["frames"] > 5 * bench.MODULES, live
    assert live["samples"] + live["lost"] == live["expected"] > 15 * bench.MODULES / live["every"], live


def test_flash_verify_live_over_hid():
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        time.sleep(1)  # hidraw nodes
        flash_verify_live("hid")
        stream("hid")


def test_flash_verify_live_over_usb_bulk():
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        flash_verify_live("usb")
        stream("usb")


def test_one_controller_by_its_serial_number():
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        serial = triskin("discover", "--link", "usb")["controllers"][1]["serial"]
        only = triskin("discover", "--link", f"usb:{serial.lower()}")["controllers"]
        assert [c["serial"] for c in only] == [serial] and only[0]["address_unique"], only
        assert "no Triskin controller with this serial number" in triskin("discover", "--link", "usb:00", status=3)["error"]


def test_lsusb_shows_valid_descriptors():
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        text = " ".join(run("lsusb", "-v", "-d", "1209:0001").split())
    for wanted in ("bcdUSB 2.10", "bNumInterfaces 3", "Human Interface Device", "Vendor Specific Class",
                   "Application Specific Interface", "Device Firmware Upgrade", "bcdDFUVersion 1.10",
                   "wTransferSize 1024", "Platform Device Capability", "d8dd60df-4589-4cc7-9cd2-659d9e648a9f",
                   "Triskin patch controller"):
        assert wanted.lower() in text.lower(), f"lsusb does not say \"{wanted}\""
    assert "UNRECOGNIZED" not in text and "cannot read" not in text and "Warning" not in text


def test_the_kernel_has_no_complaint():
    text = run("dmesg")
    bad = [line for line in text.splitlines() if "usb" in line and any(w in line for w in ("error", "invalid", "unable", "failed"))]
    assert not bad, bad
