#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows a simulated robot of three buses to three clients that come and go, and ends view, live, record and flash by each signal.

Usage: clients_and_signals.py TRISKIN [SECONDS]   SECONDS that each page is watched; 3 when left out

A report of a sanitizer is a failure: in a build with one, it is kept as /tmp/…/report.PID and printed.
"""
import base64
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "docs/examples/scenes"
COVERS = {"left_arm": "forearm.json", "chest": "torso.json", "right_arm": "forearm.json"}
CLIENTS = 3
# Ten frames of the 99 modules of the examples, of 32 bytes a module.
MIN_BYTES = 10 * 99 * 32
failures = []


def expect(rule, text):
    if not rule:
        failures.append(text)
        print("not so:", text)


class Client(threading.Thread):
    """Reads the page's live frames, and comes again after some seconds."""

    def __init__(self, url, stays_s):
        super().__init__()
        port, path = re.fullmatch(r"http://127\.0\.0\.1:(\d+)(/[0-9a-f]+/)", url).groups()
        self.port, self.path, self.stays_s = int(port), path, stays_s
        self.ended, self.bytes = threading.Event(), 0

    def run(self):
        while not self.ended.is_set():
            try:
                self.read_for_a_while()
            except OSError:
                time.sleep(0.1)

    def read_for_a_while(self):
        key = base64.b64encode(os.urandom(16)).decode()
        with socket.create_connection(("127.0.0.1", self.port), timeout=5) as wire:
            wire.sendall(f"GET {self.path}live HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\nOrigin: http://127.0.0.1:{self.port}\r\n"
                         f"Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode())
            if not wire.recv(65536).startswith(b"HTTP/1.1 101"):  # The frames follow the answer.
                time.sleep(0.1)
                return
            end = time.monotonic() + self.stays_s
            while time.monotonic() < end and not self.ended.is_set():
                data = wire.recv(65536)
                if not data:
                    return
                self.bytes += len(data)


class Bench:
    def __init__(self, triskin, folder):
        self.triskin, self.folder, self.robot = triskin, folder, str(folder / "robot.json")
        options = f"log_path={folder / 'report'} exitcode=66"
        self.environment = {**os.environ, "XDG_STATE_HOME": str(folder / "state"), "DISPLAY": "", "TSAN_OPTIONS": options, "ASAN_OPTIONS": options}

    def run(self, *words):
        subprocess.run([self.triskin, *words], env=self.environment, check=True, capture_output=True)

    def start(self, *words):
        return subprocess.Popen([self.triskin, *words], env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def make_robot(self):
        buses = [word for k in range(len(COVERS)) for word in ("--bus", f"bus_{k}=sim")]
        self.run("robot", "new", self.robot, "--name", "demo", *buses)
        for k, (name, file) in enumerate(COVERS.items()):
            self.run("robot", "add", self.robot, str(EXAMPLES / file), "--name", name, "--bus", f"bus_{k}", "--xyz-mm", f"0,{300 * k},0")
        self.run("flash", self.robot)

    def end(self, process, by, what):
        """A signal ends the command with its number + 128, or the command was ready before, or an interruption is its usual end."""
        process.send_signal(by)
        process.communicate(timeout=60)
        expect(process.returncode in (0, 128 + by, -by), f"{what} ends by {by.name} with status {process.returncode}")

    def show_to_clients(self, by, seconds):
        server = self.start("view", self.robot, "--no-open", "--port", "0")
        url = server.stdout.readline().strip()
        clients = [Client(url, 1 + k) for k in range(CLIENTS)]
        for client in clients:
            client.start()
        time.sleep(seconds)
        self.end(server, by, "view")
        for client in clients:
            client.ended.set()
            client.join()
            expect(client.bytes > MIN_BYTES, f"a client of view has got {client.bytes} bytes only")
        print(f"view, {by.name}: {[client.bytes for client in clients]} bytes")

    def end_commands(self, by):
        for words in (("live", self.robot), ("record", self.robot, "--seconds", "600", "-o", str(self.folder / "touch.mcap")), ("flash", self.robot, "--force")):
            process = self.start(*words)
            time.sleep(1)
            self.end(process, by, words[0])

    def show_reports(self):
        for report in self.folder.glob("report*"):
            expect(False, report.read_text(errors="replace")[:6000])


def main():
    with tempfile.TemporaryDirectory() as name:
        bench = Bench(sys.argv[1], pathlib.Path(name))
        bench.make_robot()
        for by in (signal.SIGINT, signal.SIGTERM):
            bench.show_to_clients(by, float(sys.argv[2]) if len(sys.argv) > 2 else 3.0)
        for by in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            bench.end_commands(by)
        bench.run("verify", bench.robot, "--no-touch", "--watch-s", "0")
        bench.show_reports()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
