#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the libFuzzer programs of a build folder one after the other and prints a row of a table for each.

Usage: run_fuzzers.py BUILD [--share S] [--seed N] [TARGET...]
  --share S   fraction of the executions of docs/measurements/robustness.md, which are 10 million in all; default 1
  --seed N    of the first run; default 1

What is found goes into BUILD/found/TARGET. An input that crashes a reader, takes it 2 s of processor time or 1 GB of memory ends
the run of its target; the exit status is then 1. Words of the corpus are the dictionary.
"""
import argparse
import pathlib
import re
import resource
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
# A reader of a file takes a hundred times as long as a decoder of frames, and gets fewer executions.
WIRE_RUNS = 500_000
FILE_RUNS = {"design": 250_000, "check": 150_000, "scene": 350_000, "robot": 350_000, "urdf": 300_000, "touches": 350_000,
             "calibration": 350_000, "backup": 350_000, "kinds": 250_000, "regions": 250_000, "proof": 50_000}
LIMITS = ["-rss_limit_mb=1000", "-timeout=2", "-max_len=32768"]
TIMEOUT_STATUS = 70
HANG_S = 2.0


def dictionary(target: str) -> str:
    """Returns the quoted words and the numbers of a corpus of texts, and some numbers at the ends of ranges."""
    words = {"1e308", "-1e308", "1e-320", "nan", "18446744073709551615", "-2147483648", "null", "[]", "{}"}
    for file in sorted((SOURCE / "tests/fuzz/corpus" / target).iterdir()):
        try:
            text = file.read_text()
        except UnicodeDecodeError:
            return ""
        words.update(re.findall(r'"[A-Za-z_]{2,40}"', text) + re.findall(r"<[a-z]{2,20}|\b[a-z]{2,20}=", text))
    return "".join('"{}"\n'.format(w.replace("\\", "\\\\").replace('"', '\\"')) for w in sorted(words))


def processor_seconds(command: list) -> float:
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before


class Campaign:
    """The runs of one target: those that a busy computer cut short are continued."""

    def __init__(self, program: pathlib.Path, target: str, runs: int, seed: int):
        self.program, self.target, self.runs, self.seed = program, target, runs, seed
        self.done, self.coverage, self.features, self.peak_mb = 0, 0, 0, 0
        self.findings = []
        self.found = program.parents[1] / "found" / target
        self.found.mkdir(parents=True, exist_ok=True)
        words, self.dictionary = dictionary(target), []  # libFuzzer refuses an empty dictionary.
        if words:
            self.found.with_suffix(".dict").write_text(words)
            self.dictionary = [f"-dict={self.found.with_suffix('.dict')}"]
        self.log = self.found.with_suffix(".log")

    def run(self) -> None:
        while self.done < self.runs and not self.findings:
            status = self.run_once()
            if status == 0:
                return
            artifact = self.artifact()
            if status == TIMEOUT_STATUS and artifact and processor_seconds([self.program, artifact]) < HANG_S:
                artifact.unlink()  # The computer was busy; the input is not slow.
                self.seed += 1
            else:
                self.findings.append(f"status {status}: {artifact}")

    def run_once(self) -> int:
        command = [self.program, f"-runs={self.runs - self.done}", f"-seed={self.seed}", *LIMITS, *self.dictionary,
                   f"-artifact_prefix={self.found}.", "-print_final_stats=1", "-verbosity=1", self.found, SOURCE / "tests/fuzz/corpus" / self.target]
        with open(self.log, "w") as log:
            status = subprocess.run([str(c) for c in command], stdout=log, stderr=subprocess.STDOUT, check=False).returncode
        text = self.log.read_text(errors="replace")
        self.done += int((re.findall(r"number_of_executed_units: (\d+)", text) or re.findall(r"^#(\d+)", text, re.M) or [0])[-1])
        self.coverage = int((re.findall(r"cov: (\d+)", text) or [0])[-1])
        self.features = int((re.findall(r"ft: (\d+)", text) or [0])[-1])
        self.peak_mb = max([self.peak_mb, *map(int, re.findall(r"rss: (\d+)Mb", text)), *map(int, re.findall(r"peak_rss_mb: (\d+)", text))])
        return status

    def artifact(self):
        files = re.findall(r"Test unit written to (\S+)", self.log.read_text(errors="replace"))
        return pathlib.Path(files[-1]) if files else None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("--share", type=float, default=1.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("targets", nargs="*")
    arguments = parser.parse_intermixed_args()
    programs = sorted(arguments.build.resolve().glob("bin/fuzz_*"))
    total, bad = 0, False
    print("| target | executions | edges | features | memory, MB | findings |\n|---|---:|---:|---:|---:|---|", flush=True)
    for program in programs:
        target = program.name.removeprefix("fuzz_")
        if arguments.targets and target not in arguments.targets:
            continue
        campaign = Campaign(program, target, int(arguments.share * FILE_RUNS.get(target, WIRE_RUNS)), arguments.seed)
        campaign.run()
        total += campaign.done
        bad = bad or bool(campaign.findings)
        print(f"| {target} | {campaign.done:,} | {campaign.coverage:,} | {campaign.features:,} | {campaign.peak_mb} | "
              f"{'; '.join(campaign.findings) or 'none'} |", flush=True)
    print(f"\n{total:,} executions", flush=True)
    return 1 if bad or total == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
