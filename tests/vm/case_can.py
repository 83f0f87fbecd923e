# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs triskin and foreign programs with controllers on a CAN bus of this kernel."""
import pathlib
import subprocess
import time

import bench
from bench import DESIGN, controllers, run, start, stop, triskin

TSHARK = ["tshark", "-n", "-o", "iso15765.can.extended_ids:0x18da0000-0x18daffff,0x18db0000-0x18dbffff", "-o",
          'uat:ISO15765_can_id_mappings:"TRUE","18DA0000","FFFF0000","000000FF","0000FF00","00000000"', "-d", "iso15765.subdissector,uds"]


def flash_verify_live(link):
    """Follows all steps of a user; the controllers were never flashed before."""
    found = triskin("discover", "--link", link)["controllers"]
    assert len(found) == bench.PATCHES and all(c["node_address"] == 1 and not c["flashed"] for c in found), found
    planned = triskin("flash", DESIGN, "--by-serial", "--link", link, "--dry-run")
    assert planned["dry_run"] and planned["bytes"] == 0
    assert triskin("verify", DESIGN, "--link", link, "--no-touch", "--watch-s", "0", status=1)["findings"][0]["kind"] == "not_flashed"
    done = triskin("flash", DESIGN, "--by-serial", "--link", link)
    assert done["controllers"] == bench.PATCHES and done["skipped"] == 0 and done["bytes"] == 32 * bench.PATCHES + 12 * bench.MODULES, done
    again = triskin("flash", DESIGN, "--by-serial", "--link", link)
    assert again["skipped"] == bench.PATCHES and again["bytes"] == 0
    bench.verify_all(link, watch_s=1)


def test_flash_verify_live_over_can_fd():
    with controllers("can:vcan0"):
        flash_verify_live("can:vcan0")
        live = triskin("live", DESIGN, "--link", "can:vcan0", "--seconds", "2")
        assert live["frames"] > 10 * bench.MODULES and live["lost"] == 0, live
        record = triskin("record", DESIGN, "--link", "can:vcan0", "--seconds", "1", "-o", "/tmp/record.csv")
        assert record["samples"] > 0 and record["lost"] == 0, record


def test_flash_and_verify_over_classic_can():
    with controllers("can:vcan1"):
        flash_verify_live("can:vcan1")


def test_an_interface_that_is_down_or_missing_is_named():
    assert "no such interface" in triskin("discover", "--link", "can:nowhere", status=3)["error"]
    run("ip", "link", "set", "vcan1", "down")
    try:
        assert "the interface is down" in triskin("discover", "--link", "can:vcan1", status=3)["error"]
    finally:
        run("ip", "link", "set", "vcan1", "up")


def test_isotpsend_and_isotprecv_read_the_part_number():
    with controllers("can:vcan1"):
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")  # node addresses 1 and 2 from now on
        receiver = start("isotprecv", "-s", "18DA01F1", "-d", "18DAF101", "-p", "CC:CC", "-b", "8", "-m", "0", "vcan1")
        time.sleep(0.5)
        run("isotpsend", "-s", "18DA01F1", "-d", "18DAF101", "-p", "CC:", "vcan1", text="22 F1 90\n")
        receiver.wait(20)
        got = receiver.output_path.read_text().split()
        assert bytes(int(b, 16) for b in got) == bytes([0x62, 0xF1, 0x90]) + b"TRISKIN1", got


def test_tshark_decodes_a_flash_session():
    with controllers("can:vcan1"):
        with open("/tmp/flash.log", "w") as out:
            dump = subprocess.Popen(["candump", "-L", "vcan1"], stdout=out)
            time.sleep(0.5)
            triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")
            time.sleep(0.5)
            dump.terminate()
            dump.wait()
    decoded = run(*TSHARK, "-r", "/tmp/flash.log", "-Y", "uds", "-T", "fields", "-e", "uds.sid", "-e", "uds.reply", timeout=120)
    rows = [line.split("\t") for line in decoded.splitlines() if line.startswith("0x")]
    requests = {sid for sid, reply in rows if reply == "0x00"}
    answers = {sid for sid, reply in rows if reply == "0x01"}
    wanted = {"0x10", "0x22", "0x27", "0x31", "0x34", "0x35", "0x36", "0x37"}
    assert wanted <= requests and wanted <= answers, (requests, answers)
    text = run(*TSHARK, "-r", "/tmp/flash.log", "-Y", "uds || iso15765", timeout=120)
    assert "Malformed" not in text and "Request download" in text.replace("Download", "download"), text[:3000]
    assert pathlib.Path("/tmp/flash.log").stat().st_size > 1000


def test_bus_off_ends_a_command_with_the_remedy():
    with controllers("can:vcan1"):
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")
        seen = subprocess.Popen(["candump", "-n", "20", "vcan1"], stdout=subprocess.DEVNULL)
        watching = start(bench.TRISKIN, "verify", DESIGN, "--link", "can:vcan1", "--no-touch", "--watch-s", "60")
        seen.wait(30)  # it has the bus open now; the simulated controllers end at the error frame as well
        run("cansend", "vcan1", "20000040#0000000000000000")  # the error frame of a controller chip that leaves the bus
        watching.wait(20)
        assert watching.returncode == 3 and "type can restart" in watching.output_path.read_text(), watching.output_path.read_text()


def test_a_controller_streams_as_an_icub_board():
    """Sends frames of an MTB4 board from a source that knows nothing of Triskin; live must read them."""
    with controllers("can:vcan1"):
        triskin("flash", DESIGN, "--by-serial", "--link", "can:vcan1")
        log = open("/tmp/icub.log", "w")
        dump = subprocess.Popen(["candump", "-L", "vcan1,400:700,700:700"], stdout=log)
        time.sleep(0.5)
        run("cansend", "vcan1", "701#FF")
        run("cansend", "vcan1", "201#0700")
        time.sleep(2)
        run("cansend", "vcan1", "201#0701")
        dump.terminate()
        dump.wait()
        frames = [line.split()[2].split("#") for line in pathlib.Path("/tmp/icub.log").read_text().splitlines()]
        version = [int(n) for n in run(bench.TRISKIN, "--version").split(".")]  # the controllers have that of the release
        assert ["710", "FF0B" + bytes(version).hex().upper()] in frames, frames[:5]
        taxels = [(i, d) for i, d in frames if i.startswith("41") and len(d) == 16]
        assert len(taxels) > 100 and {d[:2] for _, d in taxels} == {"40", "C0"}, taxels[:5]
        assert all(200 < int(d[k:k + 2], 16) <= 255 for _, d in taxels if d[:2] == "40" for k in range(2, 16, 2)), taxels[:5]
        live = triskin("live", "--link", "can:vcan1", "--protocol", "icub", "--seconds", "2")
        assert [b["type"] for b in live["boards"]] == [11] * bench.PATCHES and len(live["triangles"]) == bench.MODULES, live
