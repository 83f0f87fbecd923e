# SPDX-License-Identifier: GPL-3.0-or-later
"""Breaks the wire in every state of a flash, a firmware update and a recording, and mends it again: the interface goes down and comes
up, a controller chip leaves the bus, the queue of the interface is full for seconds, a USB cable is pulled.

A virtual CAN interface has no error counters, so bus-off is the error frame that a driver would send; the frame comes from the
other end of the wire, and only the computer hears it. The kernel unplugs USB devices; the boards keep their power."""
import contextlib
import pathlib
import signal
import socket
import struct
import subprocess
import time

import bench
from bench import DESIGN, controllers, run, start, triskin
from case_dfu import make_package
from case_usb import wait_for_devices

HOST, BOARDS = "vxcan0", "vxcan1"
AWAY_S = 1.5
# Shares of the frames, or of the time, of an undisturbed command. Faults take them in turn, because the emulated processor is slow.
STATES = ((0.1, 0.6), (0.35, 0.85))
WRITTEN = "all tables are written"  # A flash waits for the wire, but not when only the offsets of converters are still asked for.
VHCI = pathlib.Path("/sys/devices/platform/vhci_hcd.0")


@contextlib.contextmanager
def two_ended_bus():
    """A bus of FD frames with an end for the computer and one for the boards."""
    run("ip", "link", "add", HOST, "type", "vxcan", "peer", "name", BOARDS)
    for end in (HOST, BOARDS):
        run("ip", "link", "set", end, "mtu", 72, "up")
    try:
        yield
    finally:
        run("ip", "link", "del", HOST)


# Faults of a CAN bus. Each is a context: it is present inside.
@contextlib.contextmanager
def interface_down():
    run("ip", "link", "set", HOST, "down")
    try:
        yield
    finally:
        run("ip", "link", "set", HOST, "up")


@contextlib.contextmanager
def bus_off():
    with socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as wire:
        wire.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_LOOPBACK, 0)  # The boards hear nothing of it.
        wire.bind((BOARDS,))
        wire.send(struct.pack("=IB3x8s", socket.CAN_ERR_FLAG | 0x40, 8, bytes(8)))
    yield  # The program opens the interface again, which stands for a restart of the chip.


@contextlib.contextmanager
def full_queue():
    """One frame waits for seconds, and the next finds no room: write() says ENOBUFS."""
    run("tc", "qdisc", "add", "dev", HOST, "root", "netem", "limit", "1", "rate", "32bit")
    try:
        yield
    finally:
        run("tc", "qdisc", "del", "dev", HOST, "root")


# What a command says of each. A question that still found room in the queue has no answer.
CAN_FAULTS = {interface_down: ("interface is down",), bus_off: ("bus-off",), full_queue: ("frames do not leave", "does not answer", "is silent")}
UNPLUGGED = ("unplugged",)


def frames_of(command, timeout=120):
    """Runs a command undisturbed; returns how many frames it took."""
    with open("/tmp/frames", "w+") as out:
        seen = subprocess.Popen(["candump", "-L", BOARDS], stdout=out)
        time.sleep(0.5)
        run(*command, timeout=timeout)
        seen.kill()
        seen.wait()
    return sum(1 for _ in open("/tmp/frames"))


def wait_for_frames(process, count):
    seen = subprocess.Popen(["candump", "-n", str(max(1, count)), BOARDS], stdout=subprocess.DEVNULL)
    while seen.poll() is None and process.poll() is None:
        time.sleep(0.005)
    seen.kill()
    seen.wait()


def ends_well_or_names(process, messages, left_behind=""):
    """A command that was not yet, or no longer, using the wire ends well; any other names the fault and goes on, or ends with a status
    above 0 and says what it left behind. Returns true if it met the fault."""
    process.wait(150)
    text = process.output_path.read_text()
    bench.log.append(f"status {process.returncode}: {text[-600:]}")
    assert process.returncode in (0, 1, 3) and "terminate" not in text, (process.returncode, text)
    named = any(m in text for m in messages)
    assert process.returncode == 0 or (named and left_behind in text), (process.returncode, messages, text)
    return named


def break_can(command, after, left_behind=""):
    """Breaks the bus in every state of a command by every fault. `after` runs when the wire is whole again. Each fault must have met
    the command at least once, or the test shows nothing; but a queue that empties in time may only delay it."""
    frames = frames_of(command)
    for k, (fault, messages) in enumerate(CAN_FAULTS.items()):
        met = 0
        for state in STATES[k % 2]:
            process = start(*command)
            wait_for_frames(process, int(state * frames))
            with fault():
                time.sleep(AWAY_S)
            met += ends_well_or_names(process, messages, left_behind)
            after()
        assert met > 0 or fault is full_queue, f"{fault.__name__} met no {command[1]}"


def flash_command(link, *more):
    return [bench.TRISKIN, "flash", DESIGN, "--by-serial", "--link", link, "--wait-s", "60", *more]


def test_a_can_bus_breaks_in_every_state_of_a_flash():
    link = f"can:{HOST}"
    with two_ended_bus(), controllers(f"can:{BOARDS}"):
        run(*flash_command(link))

        def after():
            run(*flash_command(link), timeout=120)
            bench.verify_all(link)

        break_can(flash_command(link, "--force"), after, WRITTEN)


def test_a_can_bus_breaks_in_every_state_of_an_update():
    link = f"can:{HOST}"
    make_package("/tmp/first.tsf", 1, size=6_000)
    with two_ended_bus(), controllers(f"can:{BOARDS}"):
        run(*flash_command(link), timeout=120)
        run(*flash_command(link, "--firmware", "/tmp/first.tsf"), timeout=120)

        def after():
            run(*flash_command(link, "--firmware", "/tmp/first.tsf"), timeout=120)
            bench.verify_all(link)

        break_can(flash_command(link, "--firmware", "/tmp/first.tsf", "--force"), after)


def recording_grows(process, path, kib):
    """Waits until the file has this size."""
    end = time.monotonic() + 60
    while process.poll() is None and (not path.exists() or path.stat().st_size < kib * 1024):
        assert time.monotonic() < end, process.output_path.read_text()
        time.sleep(0.01)


def expect_whole_recording(path, link):
    """What came until the fault is in the file, and the next recording works."""
    text = run(bench.TRISKIN, "recover", path)
    assert "is whole" in text, text
    run(bench.TRISKIN, "replay", path, "--speed", "0")
    again = triskin("record", DESIGN, "--link", link, "--seconds", "0.5", "-o", "/tmp/again.mcap", status=None)
    assert again["samples"] > 0, again


def test_a_can_bus_breaks_while_it_is_recorded():
    link, path = f"can:{HOST}", pathlib.Path("/tmp/broken.mcap")
    with two_ended_bus(), controllers(f"can:{BOARDS}"):
        run(*flash_command(link))
        for fault, messages in CAN_FAULTS.items():
            for kib in (1, 100):
                path.unlink(missing_ok=True)
                process = start(bench.TRISKIN, "record", DESIGN, "--link", link, "--seconds", "60", "-o", path)
                recording_grows(process, path, kib)
                with fault():
                    time.sleep(AWAY_S)
                met = ends_well_or_names(process, messages)
                assert met or fault is full_queue, f"{fault.__name__} after {kib} KiB"
                expect_whole_recording(path, link)


@contextlib.contextmanager
def cable_pulled(skin):
    """The kernel unplugs every device. While the boards are stopped they do not plug themselves in again."""
    skin.send_signal(signal.SIGSTOP)
    try:
        # Each of the kernel's virtual host controllers has a file with a line for each port; 006 is a port in use.
        rows = [line.split() for file in VHCI.glob("status*") for line in file.read_text().splitlines()[1:]]
        in_use = [row[1] for row in rows if row[2] == "006"]
        assert in_use, rows  # A board that starts new firmware is not plugged in for a moment.
        for port in in_use:
            (VHCI / "detach").write_text(port)
        wait_for_devices(0)
        yield
    finally:
        skin.send_signal(signal.SIGCONT)
    wait_for_devices(bench.PATCHES, timeout=40)
    time.sleep(1)  # hidraw nodes


def wait_for_text(process, text):
    """Waits until a command has written this, or has ended."""
    while process.poll() is None and text not in process.output_path.read_text():
        time.sleep(0.005)


def pull_in_states(states, skin, command, after):
    """Pulls the cables at the first word of each state. How long a command takes to start differs from run to run."""
    met = 0
    for state in states:
        wait_for_devices(bench.PATCHES, timeout=40)
        process = start(*command)
        wait_for_text(process, state)
        with cable_pulled(skin):
            time.sleep(AWAY_S)
        met += ends_well_or_names(process, UNPLUGGED, WRITTEN)
        after()
    assert met > 0, f"no cable was pulled while {command[1]} used it"


def test_a_usb_cable_is_pulled_in_every_state_of_a_flash():
    for link, states in (("usb", ("…", "writing patch")), ("hid", ("writing patch", "done patch"))):
        with controllers("usb") as skin:
            wait_for_devices(bench.PATCHES)
            time.sleep(1)
            run(*flash_command(link))

            def after():
                run(*flash_command(link), timeout=120)
                bench.verify_all(link)

            pull_in_states(states, skin, flash_command(link, "--force"), after)


def test_a_usb_cable_is_pulled_in_every_state_of_an_update():
    """Over USB new firmware comes by DFU. What ran before starts again, or the new image does, and the next download works."""
    make_package("/tmp/first.tsf", 3, size=6_000)
    run("dfu-suffix", "-v", "1209", "-p", "0002", "-d", "ffff", "-a", "/tmp/first.tsf")
    with controllers("usb") as skin:
        wait_for_devices(bench.PATCHES)
        run(*flash_command("usb"))
        serial = triskin("discover", "--link", "usb")["controllers"][0]["serial"]
        download = ["dfu-util", "-d", "1209:0001,1209:0002", "-S", serial, "-D", "/tmp/first.tsf", "-R"]

        def download_works():
            text = run(*download, timeout=120, status=None)
            assert "Download done" in text, text
            wait_for_devices(bench.PATCHES, timeout=40)
            time.sleep(1)
            bench.verify_all("usb")

        before = time.monotonic()
        download_works()
        duration_s = time.monotonic() - before
        unfinished = 0
        for state in (*STATES[0], STATES[1][1]):
            process = start(*download)
            time.sleep(state * duration_s)
            with cable_pulled(skin):
                process.wait(60)
            unfinished += "Download done" not in process.output_path.read_text()
            download_works()
        assert unfinished > 0, "no cable was pulled while dfu-util used it"


def test_a_usb_cable_is_pulled_while_it_is_recorded():
    path = pathlib.Path("/tmp/pulled.mcap")
    for link in ("usb", "hid"):
        with controllers("usb") as skin:
            wait_for_devices(bench.PATCHES)
            time.sleep(1)
            run(*flash_command(link))
            for kib in (1, 60):
                path.unlink(missing_ok=True)
                process = start(bench.TRISKIN, "record", DESIGN, "--link", link, "--seconds", "60", "-o", path)
                recording_grows(process, path, kib)
                with cable_pulled(skin):
                    time.sleep(AWAY_S)
                assert ends_well_or_names(process, UNPLUGGED), f"after {kib} KiB over {link}"
                expect_whole_recording(path, link)
