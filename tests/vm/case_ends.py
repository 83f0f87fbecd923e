# SPDX-License-Identifier: GPL-3.0-or-later
"""Commands that are ended by Ctrl-C, and cables that are pulled while a flash runs."""
import json
import signal
import subprocess
import time

import bench
from bench import DESIGN, controllers, run, start, stop, triskin
from case_can import flash_verify_live
from case_usb import wait_for_devices


def test_ctrl_c_ends_live_and_stops_the_stream():
    with controllers("can:vcan0"):
        triskin("flash", DESIGN, "--link", "can:vcan0")
        live = start(bench.TRISKIN, "live", DESIGN, "--link", "can:vcan0", "--json")
        time.sleep(3)
        live.send_signal(signal.SIGINT)
        live.wait(20)
        text = live.output_path.read_text()
        assert live.returncode == 0 and json.loads(text[text.index("{"):])["frames"] > 0, text
        listening = subprocess.run(["timeout", "1", "candump", "-L", "vcan0,18F00000:1FFF0000"], capture_output=True, text=True)
        assert listening.stdout == "", listening.stdout[:500]


def test_ctrl_c_ends_a_flash_and_it_says_what_was_done():
    with controllers("can:vcan1") as skin:
        triskin("flash", DESIGN, "--link", "can:vcan1")
        skin.send_signal(signal.SIGSTOP)  # controllers that do not answer
        try:
            flash = start(bench.TRISKIN, "flash", DESIGN, "--link", "can:vcan1", "--force")
            time.sleep(0.1)
            skin.send_signal(signal.SIGCONT)
            time.sleep(0.4)
            skin.send_signal(signal.SIGSTOP)
            time.sleep(0.5)
            flash.send_signal(signal.SIGINT)
            flash.wait(20)
        finally:
            skin.send_signal(signal.SIGCONT)
        text = flash.output_path.read_text()
        assert flash.returncode == 0 or (flash.returncode == 3 and ("ended on request" in text or "no controller answers" in text)), text
        assert triskin("flash", DESIGN, "--link", "can:vcan1")["controllers"] == bench.PATCHES
        assert triskin("verify", DESIGN, "--link", "can:vcan1", "--no-touch", "--watch-s", "0")["findings"] == []


def pull_and_plug(link):
    """Controllers vanish while they are flashed, and come back as fresh boards: the same command completes."""
    for delay_s in (0.5, 0.8, 0.3, 1.1, 0.65, 0.4, 1.4, 0.2):  # one of them falls into the flash
        with controllers(link) as skin:
            if link == "usb":
                wait_for_devices(bench.PATCHES)
            process = start(bench.TRISKIN, "flash", DESIGN, "--link", link, "--wait-s", "60")
            time.sleep(delay_s)
            skin.kill()
            skin.wait()
            end = time.monotonic() + 30
            while process.poll() is None and "waiting 60 s" not in process.output_path.read_text():
                assert time.monotonic() < end, process.output_path.read_text()
                time.sleep(0.05)
        if process.poll() is not None:
            stop(process)  # too early or too late
            continue
        with controllers(link):
            process.wait(90)
            text = process.output_path.read_text()
            assert process.returncode == 0 and "going on" in text, text
            assert triskin("verify", DESIGN, "--link", link, "--no-touch", "--watch-s", "0")["findings"] == []
        return
    raise AssertionError("no cable was pulled while a flash ran")


def test_a_flash_waits_for_a_can_cable_and_goes_on():
    pull_and_plug("can:vcan1")


def test_a_flash_waits_for_a_usb_cable_and_goes_on():
    pull_and_plug("usb")


def test_without_iso_tp_in_the_kernel_the_program_does_it():
    with controllers("can:vcan1"):
        assert triskin("discover", "--link", "can:vcan1")["iso_tp"] == "kernel"
    loader = "/proc/sys/kernel/modprobe"
    before = open(loader).read()
    run("rmmod", "can_isotp")
    try:
        open(loader, "w").write("/bin/false")
        with controllers("can:vcan1"):
            assert triskin("discover", "--link", "can:vcan1")["iso_tp"] == "program"
            flash_verify_live("can:vcan1")
    finally:
        open(loader, "w").write(before)


def test_one_command_serves_controllers_on_two_links():
    with controllers("usb"):
        wait_for_devices(bench.PATCHES)
        serials = [c["serial"] for c in triskin("discover", "--link", "usb")["controllers"]]
        link = ",".join(f"usb:{serial}" for serial in serials)
        done = triskin("flash", DESIGN, "--link", link)
        assert done["controllers"] == bench.PATCHES and sorted(p["serial"] for p in done["patches"]) == sorted(serials), done
        assert triskin("verify", DESIGN, "--link", link, "--no-touch", "--watch-s", "0")["findings"] == []
        assert "cannot be one of several" in triskin("discover", "--link", "sim,usb", status=2)["error"]
