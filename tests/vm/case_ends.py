# SPDX-License-Identifier: GPL-3.0-or-later
"""Ends commands by Ctrl-C, and pulls cables while a flash runs."""
import json
import signal
import subprocess
import time

import bench
from bench import DESIGN, controllers, start, stop, triskin


def test_ctrl_c_ends_live_and_stops_the_stream():
    with controllers("can:vcan0"):
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan0")
        seen = subprocess.Popen(["candump", "-n", "20", "vcan0,18F00000:1FFF0000"], stdout=subprocess.DEVNULL)
        time.sleep(0.5)
        live = start(bench.TRISKIN, "live", DESIGN, "--link", "can:vcan0", "--json")
        seen.wait(30)  # the stream runs
        live.send_signal(signal.SIGINT)
        live.wait(20)
        text = live.output_path.read_text()
        assert live.returncode == 0 and json.loads(text.strip().splitlines()[-1])["frames"] > 0, text
        listening = subprocess.run(["timeout", "1", "candump", "-L", "vcan0,18F00000:1FFF0000"], capture_output=True, text=True)
        assert listening.stdout == "", listening.stdout[:500]


def test_ctrl_c_ends_a_flash_and_it_says_what_was_done():
    with controllers("can:vcan1") as skin:
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")
        try:
            seen = subprocess.Popen(["candump", "-n", "40", "vcan1"], stdout=subprocess.DEVNULL)
            time.sleep(0.5)
            flash = start(bench.TRISKIN, "flash", DESIGN, "--by-serial", "--link", "can:vcan1", "--force")
            seen.wait(30)  # all controllers are found, and the first is written
            skin.send_signal(signal.SIGSTOP)  # now they do not answer
            time.sleep(0.3)
            flash.send_signal(signal.SIGINT)
            flash.wait(20)
        finally:
            skin.send_signal(signal.SIGCONT)
        text = flash.output_path.read_text()
        assert flash.returncode == 130 and "ended on request" in text and "controller" in text, (flash.returncode, text)
        assert triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")["controllers"] == bench.PATCHES
        bench.verify_all("can:vcan1")


def wait_for_frames(process, count):
    """Waits until this many frames were on the bus."""
    with open("/tmp/frames", "w+") as out:
        seen = subprocess.Popen(["candump", "-n", str(count), "vcan1"], stdout=out)
        while seen.poll() is None and process.poll() is None:
            time.sleep(0.005)
        seen.kill()
        seen.wait()


def pull_and_plug(link, moments, wait_for_moment):
    """Controllers vanish while they are flashed, and come back as fresh boards: the same command completes."""
    for moment in moments:  # one of them falls into the flash
        with controllers(link) as skin:
            process = start(bench.TRISKIN, "flash", DESIGN, "--by-serial", "--link", link, "--wait-s", "60")
            wait_for_moment(process, moment)
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
            bench.verify_all(link)
        return
    raise AssertionError("no cable was pulled while a flash ran")


def test_a_flash_waits_for_a_can_cable_and_goes_on():
    pull_and_plug("can:vcan1", (40, 30, 50, 60, 25, 80), wait_for_frames)
