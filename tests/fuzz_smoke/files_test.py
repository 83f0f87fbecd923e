#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Damaged files of every format before the program, as a user would give them.

usage: files_test.py TRISKIN WRITE_STRIP [--share 0.1] [--seed 37] [--only NAME] [--list] [--keep FOLDER] [--sanitized]

Each file of sample_files.py is damaged in the ways of mutations.py. It is an error when the program ends by a signal, takes
more than 2 s of processor time or 4 GB, ends with another status than 0, 1, 2 or 3, says what a library says in place of
its own words, refuses line ends or a byte order mark, or reads a file that was cut or lost a line as another mesh than
the whole one without a word. The environment variable TRISKIN_FUZZ_SHARE replaces --share. `--list` shows every kind of answer,
for whoever looks for messages that a person would not understand.
"""
import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import threading

import mutations
import sample_files

MAX_CPU_S = 2.0
MAX_WALL_S = 60.0  # Only ends a command that waits for something that never comes; a loaded machine is slow.
MAX_MEMORY_BYTES = 4 << 30
RAW = re.compile(r"<unspecified|cannot read (value|array|object)|json\.exception|assimp|expat|std::|bad_alloc|basic_string|\bstoi\b|\bstod\b|vector::|map::at|what\(\)|"
                 r"terminate called|parse error at|syntax error while|not well-formed \(invalid|boost|zlib|minizip|"
                 r"inflate|H5E|OCC|Standard_|TopoDS|_M_|invalid argument|out_of_range|length_error|bad_|Assertion", re.I)


class Outcome:
    """What a command did."""

    def __init__(self, status, output, cpu_s, product):
        self.status, self.output, self.cpu_s, self.product = status, output, cpu_s, product
        self.ends_a_line = False  # What is left of a file that was cut ends with a whole line.
        self.changes_one_number = False  # Nothing in a file without checksums tells one number from another.


def limit():
    """Limits of the child process."""
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY_BYTES, MAX_MEMORY_BYTES))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_CPU, (20, 20))


class Bench:
    """Runs the program on damaged copies; each thread has a copy of the folder with the good files."""

    def __init__(self, triskin, folder, is_sanitized):
        # The sanitizer reserves terabytes of addresses, and is slow.
        self.triskin, self.folder, self.preexec = triskin, pathlib.Path(folder), None if is_sanitized else limit
        self.local = threading.local()
        self.made = 0

    def place(self):
        if not hasattr(self.local, "folder"):
            self.made += 1
            self.local.folder = self.folder.parent / f"work_{threading.get_ident()}"
            shutil.copytree(self.folder, self.local.folder)
        return self.local.folder

    def command(self, sample, place, file):
        names = {p.name: p for p in place.iterdir()} | {"file": file, "out": place / "out"}
        return [self.triskin] + [re.sub(r"\{([^}]+)\}", lambda m: str(names[m[1]]), word) for word in sample.command]

    def run(self, sample, data):
        place = self.place()
        for old in place.glob("out.*"):
            old.unlink()
        good = (place / sample.file).read_bytes()
        (place / sample.file).unlink()
        (place / sample.file).write_bytes(data)
        file = place / sample.file
        if sample.pack:
            name, packed = sample.pack(data)
            file = place / name
            file.write_bytes(packed)
        command = self.command(sample, place, file)
        environment = dict(os.environ, HOME=str(place), XDG_STATE_HOME=str(place / "state"), LC_ALL="C.UTF-8")
        with tempfile.TemporaryFile() as output:
            child = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT, cwd=place,
                                     env=environment, preexec_fn=self.preexec)
            watch = threading.Timer(MAX_WALL_S, child.kill)
            watch.start()
            _, status, usage = os.wait4(child.pid, 0)
            watch.cancel()
            child.returncode = os.waitstatus_to_exitcode(status)
            output.seek(0)
            text = output.read().decode(errors="replace")
        (place / sample.file).write_bytes(good)
        products = sorted(place.glob("out.*"))
        product = products[0].read_bytes() if products else b""
        outcome = Outcome(child.returncode, text.replace(str(place), ""), usage.ru_utime + usage.ru_stime, product)
        outcome.ends_a_line = data.endswith(b"\n")
        outcome.changes_one_number = sample.is_text and has_one_other_number(good, data)
        return outcome


def has_one_other_number(good, data):
    """True where the texts have the same words but for one number, as when one of its digits is lost or doubled."""
    a, b = good.split(), data.split()
    other = [(x, y) for x, y in zip(a, b) if x != y]
    return len(a) == len(b) and len(other) == 1 and all(mutations.NUMBER.fullmatch(word) for word in other[0])


def words(text):
    """What is said, without its numbers."""
    return {re.sub(r"[-+]?\d[\d.e+-]*", "#", line) for line in text.splitlines() if line.strip()}



def lost_in_silence(sample, mutation, good, outcome, line):
    """True where the file was damaged, yet is read as another one without a word."""
    if outcome.status != 0 or words(outcome.output) - words(good.output):
        return False
    is_cut = mutation.startswith("cut") and not outcome.ends_a_line
    if sample.is_sealed or sample.is_line_wise:
        return is_cut or (sample.is_sealed and mutation != "none")
    if not sample.reads_mesh or outcome.product == good.product:
        return False
    if mutation.endswith("zeroed"):
        return sample.has_checksums  # Elsewhere a zero is a coordinate like others.
    if mutation.startswith(("cut", "piece")):
        is_one_number = mutation.startswith("piece") and outcome.changes_one_number
        return not is_one_number and not (outcome.ends_a_line and sample.uncounted)
    if sample.has_checksums:
        return True
    return mutation.startswith("line ") and "line ends" not in mutation and not (
        sample.uncounted and line.lstrip().startswith(sample.uncounted))


def judge(sample, mutation, good, outcome, line=b""):
    """What is wrong, in one word; empty where nothing is."""
    if outcome.status < 0:
        return f"signal {-outcome.status}"
    if outcome.status not in (0, 1, 2, 3):
        return f"status {outcome.status}"
    if outcome.cpu_s > MAX_CPU_S + 3 * good.cpu_s:
        return f"slow: {outcome.cpu_s:.1f} s"
    if RAW.search(outcome.output):
        return "raw: " + RAW.search(outcome.output)[0]
    if outcome.status != 0 and not outcome.output.strip():
        return "no message"
    same = mutation.startswith(("line ends", "byte order", "UTF-16"))
    if sample.is_ascii and mutation.startswith("UTF-16"):
        return "" if outcome.status == 2 and "UTF-16" in outcome.output else "UTF-16 is not named"
    if same and (outcome.status != good.status or (sample.reads_mesh and outcome.product != good.product)):
        return "the same content is not read"
    return "silent loss" if lost_in_silence(sample, mutation, good, outcome, line) else ""


def line_of(data, mutation):
    found = re.match(r"line (\d+) ", mutation)
    return data.split(b"\n")[int(found[1]) - 1] if found else b""


class Report:
    """Counts what was tried, and keeps the first of each kind of error."""

    def __init__(self, keep):
        self.tried, self.statuses = 0, collections.Counter()
        self.errors = {}
        self.keep = keep
        self.texts = collections.defaultdict(list)

    def note(self, sample, mutation, data, outcome, wrong):
        self.tried += 1
        self.statuses[outcome.status] += 1
        said = sorted(words(outcome.output))[-1] if outcome.output.strip() else ""
        self.texts[(sample.name, outcome.status, re.sub(r'"[^"]*"', '"…"', said))].append(mutation)
        if not wrong:
            return
        kind = (sample.name, re.sub(r"[\d.]+", "#", wrong), re.sub(r"\d+", "#", mutation) if "same" in wrong else "")
        if kind not in self.errors:
            self.errors[kind] = [0, mutation, outcome.output[-300:], outcome.status]
            if self.keep:
                name = re.sub(r"\W+", "_", "_".join(kind)) + pathlib.Path(sample.file).suffix
                (pathlib.Path(self.keep) / name).write_bytes(data)
        self.errors[kind][0] += 1

    def show(self, all_texts):
        if all_texts:
            for (name, status, text), found in sorted(self.texts.items(), key=str):
                print(f"{name} | {status} | {len(found)} × | {text[:170]} | {found[0]}")
        for (name, wrong, _), (count, mutation, text, status) in self.errors.items():
            print(f"ERROR {name}: {wrong}, {count} times, first: {mutation}; status {status}, it says:\n    {text}")


def try_sample(bench, sample, share, seed, report, pool):
    if not (bench.folder / sample.file).exists():
        print(f"left out: {sample.name}, because {sample.file} is not there")
        return
    data = (bench.folder / sample.file).read_bytes()
    good = bench.run(sample, data)
    if good.status not in (0, 1) or RAW.search(good.output):
        report.note(sample, "none", data, good, "the good file is not read")
        return
    todo = list(mutations.all_of(data, sample.is_text, share / sample.cost, seed))
    for (mutation, changed), outcome in zip(todo, pool.map(lambda entry: bench.run(sample, entry[1]), todo)):
        report.note(sample, mutation, changed, outcome, judge(sample, mutation, good, outcome, line_of(data, mutation)))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("triskin")
    parser.add_argument("write_strip")
    parser.add_argument("--share", type=float, default=float(os.environ.get("TRISKIN_FUZZ_SHARE", "0.1")))
    parser.add_argument("--seed", type=int, default=37)
    parser.add_argument("--only", default="")
    parser.add_argument("--list", action="store_true", help="also every kind of answer")
    parser.add_argument("--sanitized", action="store_true", help="the program has the address sanitizer in it")
    parser.add_argument("--keep", help="the first file of each kind of error goes here")
    arguments = parser.parse_args()
    report = Report(arguments.keep)
    with tempfile.TemporaryDirectory(prefix="fuzz_files") as folder:
        good = pathlib.Path(folder, "good")
        good.mkdir()
        os.environ |= {"HOME": str(good), "XDG_STATE_HOME": str(good / "state")}
        sample_files.make(os.path.abspath(arguments.triskin), os.path.abspath(arguments.write_strip), good)
        bench = Bench(os.path.abspath(arguments.triskin), good, arguments.sanitized)
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            for sample in sample_files.SAMPLES:
                if arguments.only in sample.name:
                    try_sample(bench, sample, arguments.share, arguments.seed, report, pool)
    report.show(arguments.list)
    print(f"{report.tried} files, seed {arguments.seed}, statuses {dict(report.statuses)}, {len(report.errors)} kinds of errors")
    return 1 if report.errors else 0


if __name__ == "__main__":
    sys.exit(main())
