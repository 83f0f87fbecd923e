# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases in the test machine share this: programs under test, simulated controllers, a log that is shown with the verdict."""
import contextlib
import json
import os
import pathlib
import signal
import subprocess
import time

TRISKIN = ""
DESIGN = "/tmp/plate.json"  # The folder is in this machine's own tmpfs.
MODULES, PATCHES = 0, 0
log = []
_running = []


def run(*command, timeout=60, status=0, text=None):
    """Runs a program to its end, checks its exit status (None: any), returns what it wrote to both outputs."""
    command = [str(c) for c in command]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, input=text, stdin=subprocess.DEVNULL if text is None else None)
    log.append(f"$ {' '.join(command)}\n{done.stdout}{done.stderr}")
    assert status is None or done.returncode == status, f"{command[0]}: status {done.returncode}, expected {status}"
    return done.stdout + done.stderr


def triskin(*arguments, timeout=60, status=0):
    """Runs triskin with --json and returns the object. It must exit with `status`; None allows 0 or 1."""
    command = [TRISKIN, *map(str, arguments), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, stdin=subprocess.DEVNULL)
    log.append(f"$ triskin {' '.join(map(str, arguments))}\n{done.stdout[:4000]}{done.stderr[-2000:]}")
    assert done.returncode in ([0, 1] if status is None else [status]), f"triskin {arguments[0]}: status {done.returncode}, expected {status}: {done.stderr[-500:]}"
    # live writes one object per line; the last one is its result.
    return json.loads(done.stdout.strip().splitlines()[-1]) if done.stdout.strip().startswith("{") else {"error": done.stderr}


def verify_all(link, watch_s=0):
    """Verifies without touches: every module in order and nothing found. Over USB, where the emulated processor may be too slow for
    the whole stream, samples may be missing if each of them is counted and said (status 1)."""
    usb = link.startswith(("usb", "hid"))
    answer = triskin("verify", DESIGN, "--link", link, "--no-touch", "--watch-s", str(watch_s), status=None if usb else 0)
    findings = [f for f in answer["findings"] if not (usb and f["kind"] == "lost_samples")]
    assert answer["modules_ok"] == MODULES and findings == [], answer
    assert answer["samples"] + answer["lost"] == answer["expected"] and not answer["never_heard"], answer


def start(*command, wait_for=None, timeout=120):
    """Starts a program in the background; waits until its output holds `wait_for`."""
    out = open(f"/tmp/output{len(_running)}_{time.monotonic_ns()}", "w+")
    process = subprocess.Popen([str(c) for c in command], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)
    process.output_path = pathlib.Path(out.name)
    _running.append(process)
    end = time.monotonic() + timeout
    while wait_for is not None and wait_for not in process.output_path.read_text():
        assert process.poll() is None, f"{command[0]} ended: {process.output_path.read_text()}"
        assert time.monotonic() < end, f"{command[0]} does not say \"{wait_for}\": {process.output_path.read_text()}"
        time.sleep(0.02)
    return process


def stop(process):
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
    if process in _running:
        _running.remove(process)
        log.append(f"[{process.args[0]}]\n{process.output_path.read_text()[-3000:]}")


def stop_all():
    for process in list(_running):
        stop(process)


@contextlib.contextmanager
def controllers(link, scene=DESIGN, fresh=True):
    """Starts simulated controllers on a link of this kernel."""
    process = start(TRISKIN, "simulate", scene, "--board-seed", "0", "--listen", link, *(["--fresh"] if fresh else []), wait_for="end with Ctrl-C")
    try:
        yield process
    finally:
        stop(process)


class TwoEndedBus:
    """Makes a classic bus with an end for the host and one for the boards, so that each can have a queue of the kernel (netem)."""

    def __init__(self, host, boards):
        self.ends = (host, boards)
        run("ip", "link", "add", host, "type", "vxcan", "peer", "name", boards)
        for end in self.ends:
            run("ip", "link", "set", end, "mtu", 16, "up")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        run("ip", "link", "del", self.ends[0])

    def queue(self, of_host, of_boards):
        """From now on frames go through queues with these bit rates, lengths and losses."""
        for end, netem in zip(self.ends, (of_host, of_boards)):
            run("tc", "qdisc", "add", "dev", end, "root", "netem", *netem)

    def no_queue(self):
        for end in self.ends:
            run("tc", "qdisc", "del", "dev", end, "root")

    def frames(self):
        """How many the queues have carried; not those that they lost, or had no room for."""
        return sum(json.loads(run("tc", "-s", "-j", "qdisc", "show", "dev", end))[0]["packets"] for end in self.ends)


def prepare(design_file):
    """Returns the design that all cases use, with two controllers."""
    global MODULES, PATCHES
    os.chdir("/tmp")
    pathlib.Path(DESIGN).write_bytes(pathlib.Path(design_file).read_bytes())
    design = json.loads(pathlib.Path(DESIGN).read_text())
    MODULES, PATCHES = len(design["modules"]), len(design["patches"])
