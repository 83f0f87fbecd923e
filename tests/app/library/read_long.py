# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads served simulations for a time, all at once: every sample that was due must arrive, or the exit status is 1.
Usage: read_long.py PROGRAM SECONDS DESIGN..."""
import os
import re
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import triskin

program, seconds, designs = sys.argv[1], float(sys.argv[2]), sys.argv[3:]


def serve(design):
    command = [program, "simulate", design, "--listen", "127.0.0.1:0", "--fresh"]
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    line = server.stdout.readline()
    return server, "sim:127.0.0.1:" + re.search(r"127\.0\.0\.1:(\d+)", line).group(1), int(line.split()[0])


def read(design, link, results):
    with triskin.open(design, link=link) as skin:
        skin.start()
        first, bad, taken = np.zeros(skin.modules, int), 0, 0
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            samples = skin.read(1.0)
            taken += len(samples)
            for module in range(skin.modules):
                numbers = samples["number"][samples["module"] == module].astype(int)
                if len(numbers) == 0:
                    bad += 1
                    continue
                bad += int((np.diff(numbers) != 1).sum()) + (first[module] > 0 and numbers[0] != first[module] + 1)
                first[module] = numbers[-1]
        skin.stop()
        taken += len(skin.read())
        results.append({"modules": skin.modules, "taken": taken, "gaps": int(bad), **skin.counts()})


servers, results = [], []
try:
    servers = [serve(d) for d in designs]
    for design, (_, link, _) in zip(designs, servers):
        subprocess.run([program, "flash", design, "--link", link], check=True, stdout=subprocess.DEVNULL)
    readers = [threading.Thread(target=read, args=(d, s[1], results)) for d, s in zip(designs, servers)]
    before = os.times()
    for reader in readers:
        reader.start()
    for reader in readers:
        reader.join()
    used = os.times()
finally:
    for server, _, _ in servers:
        server.send_signal(signal.SIGINT)
        server.wait()
controllers, taken = sum(s[2] for s in servers), sum(r["taken"] for r in results)
lost = sum(r["lost"] + r["lost_here"] + r["gaps"] for r in results)
cpu_s = used.user + used.system - before.user - before.system
print(f"{controllers} controllers, {sum(r['modules'] for r in results)} modules, {seconds:.0f} s: {taken} samples, "
      f"{taken / seconds:.0f} a second, {lost} lost; the reader took {cpu_s / seconds:.2f} of a core", results)
sys.exit(0 if lost == 0 and len(results) == len(designs) and taken > 20 * seconds * sum(r["modules"] for r in results) else 1)
