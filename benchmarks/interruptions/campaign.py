#!/usr/bin/python3
"""Kills commands at random moments and resumes them: is every file readable, and the result that of an uninterrupted run?

    benchmarks/interruptions/campaign.py --sinew build/release/sinew --kills 300 --terms 100 --seed 1
"""
import argparse
import collections
import os
import pathlib
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import time

import h5py

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests/cli"))
from program import differences  # noqa: E402

from cases import DATA, DRAWN, SETTINGS, others, solvers  # noqa: E402

LONGEST = 600  # [s] of any command
LONGEST_END = 10  # [s] after a signal, on a busy machine
STATUS = {signal.SIGKILL: {-signal.SIGKILL}, signal.SIGTERM: {143, -signal.SIGTERM}}
NOT_COMPARED = ("seconds_to_target",)  # of a study, besides everything that is called seconds


class Broken(Exception):
    pass


class Campaign:
    def __init__(self, sinew, folder):
        self.sinew, self.folder = sinew, folder
        self.whole, self.seconds, self.span = {}, {}, {}
        self.said = ""  # on standard error, by the last command
        self.errors = folder.parent / (folder.name + ".errors")

    def do(self, words, how=None, moment=LONGEST):
        """Runs a command, and sends it a signal after so many seconds. Returns its status, its CPU seconds and whether it was sent."""
        with self.errors.open("w") as errors:
            program = subprocess.Popen([self.sinew, *words], cwd=self.folder, stdout=subprocess.DEVNULL, stderr=errors)
        began = time.monotonic()
        sent = None
        while True:
            pid, status, usage = os.wait4(program.pid, os.WNOHANG)
            now = time.monotonic()
            if pid:
                break
            if sent is None and now - began >= moment and how is not None:
                program.send_signal(how)
                sent = now
            if now - began > LONGEST:
                program.kill()
            time.sleep(0.005)
        program.returncode = os.waitstatus_to_exitcode(status)  # Popen does not wait again
        self.said = self.errors.read_text()
        if sent is not None and now - sent > LONGEST_END:
            raise Broken(f"{' '.join(words)}: ended {now - sent:.1f} s after {how.name}")
        return program.returncode, usage.ru_utime + usage.ru_stime, sent is not None

    def run(self, words):
        """CPU seconds of a command that has to succeed, those of the processes that it waited for too."""
        status, seconds, _ = self.do(words)
        # 1: it ran, but there is no usable answer (a solver at its limit, a diagnosis without a conclusion)
        if status not in (0, 1):
            raise Broken(f"{' '.join(words)}: status {status}\n{self.said}")
        return seconds

    def prepare(self, cases):
        for _, line in DATA:
            name = next(name for name, other in DATA if other == line)
            self.run([*line.split(), "--out", name])
        for _, line in DRAWN:
            self.run(line.split())
        for name, text in SETTINGS:
            (self.folder / name).write_text(text)
        for case in cases:
            began = time.monotonic()
            self.seconds[case.name] = self.run(case.command())
            self.span[case.name] = time.monotonic() - began
            if not (self.folder / case.out).exists():
                raise Broken(f"{case.name}: wrote nothing\n{self.said}")
            self.whole[case.name] = self.folder / f"whole_{len(self.whole)}"
            (self.folder / case.out).rename(self.whole[case.name])

    def leftovers(self):
        return [path.name for path in self.folder.rglob(".sinew-*")]

    def check_files(self):
        """Whatever stands in the folder is whole."""
        for path in self.folder.rglob("*.h5"):
            try:
                with h5py.File(path) as file:
                    file.visititems(lambda _, item: item[()] if isinstance(item, h5py.Dataset) else None)
            except OSError as error:
                raise Broken(f"{path.name} cannot be read: {error}") from error

    def stop(self, words, how, moment):
        """Runs a command for so long. Returns the CPU seconds it had, None if it had ended before."""
        status, seconds, sent = self.do(words, how, moment)
        if sent and status in STATUS[how]:
            return seconds
        if status not in (0, 1):
            raise Broken(f"{' '.join(words)}: status {status} after {how.name}\n{self.said}")
        return None

    def same(self, case):
        new, old = self.folder / case.out, self.whole[case.name]
        if new.is_file():
            return self.differing(new, old)
        missing = {str(p.relative_to(old)) for p in old.rglob("*")} ^ {str(p.relative_to(new)) for p in new.rglob("*")}
        found = sorted(missing)
        for path in [] if missing else old.rglob("*.h5"):
            found += [f"{path.name}{place}" for place in self.differing(new / path.relative_to(old), path)]
        return found

    @staticmethod
    def differing(new, old):
        with h5py.File(new) as first, h5py.File(old) as second:
            return [place for place in differences(first, second) if not place.endswith(NOT_COMPARED)]

    def interrupt(self, case, how, draw):
        """One interruption, sometimes another one of the resumed command. Returns CPU seconds lost, None if it came too late."""
        words, spent = case.command(), 0.0
        again = (*words, "--resume") if case.resumes else words
        for attempt in range(draw.choice((1, 1, 2, 3))):
            had = self.stop(again if attempt else words, how, draw.uniform(0, self.span[case.name]))
            if had is None:
                if attempt == 0:
                    self.remove(case)
                    return None
                break
            spent += had
            self.check_files()
            page = self.folder / "page"
            shown = [path for path in page.iterdir() if path.name != ".sinew-report"] if page.exists() else []
            if case.out == "page" and shown and self.same(case):
                raise Broken(f"half a page after {how.name}")
        spent += self.run(again)
        if self.leftovers():
            raise Broken(f"{case.name}: left after the next command: {self.leftovers()}")
        if differing := self.same(case):
            shutil.copytree(self.folder, f"/tmp/interruption_{os.getpid()}", dirs_exist_ok=True)
            raise Broken(f"{case.name} after {how.name}: differs from the uninterrupted result in {differing[:5]}")
        self.remove(case)
        return max(0.0, spent - self.seconds[case.name])

    def remove(self, case):
        path = self.folder / case.out
        shutil.rmtree(path) if path.is_dir() else path.unlink(missing_ok=True)


def listed_solvers(sinew):
    text = subprocess.run([sinew, "list", "solvers"], capture_output=True, text=True, check=True).stdout
    return [line.split()[0] for line in text.splitlines()[1:] if len(line) > 34 and line[34:40].strip() in ("global", "local")]


def summary(lost):
    return f"{statistics.median(lost):.2f}, {max(lost):.2f}" if lost else "-"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--terms", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="cases whose name contains this")
    options = parser.parse_args()
    sinew = os.path.abspath(options.sinew)
    cases = solvers(listed_solvers(sinew)) + others() + [case for case in others() if case.resumes]  # the latter keep most
    cases = [case for case in cases if options.only in case.name]
    draw = random.Random(options.seed)
    lost = collections.defaultdict(lambda: collections.defaultdict(list))
    broken, late = [], 0
    with tempfile.TemporaryDirectory() as around:
        folder = pathlib.Path(around) / "work"
        folder.mkdir()
        campaign = Campaign(sinew, folder)
        campaign.prepare(list(dict.fromkeys(cases)))
        for how, wanted in ((signal.SIGKILL, options.kills), (signal.SIGTERM, options.terms)):
            done = 0
            while done < wanted:
                case = draw.choice(cases)
                try:
                    seconds = campaign.interrupt(case, how, draw)
                except Broken as error:
                    broken.append(str(error))
                    print(f"BROKEN {error}", flush=True)
                    campaign.remove(case)
                    done += 1
                    continue
                if seconds is None:
                    late += 1
                    continue
                done += 1
                lost[how][case.name].append(seconds)
                if done % 20 == 0:
                    print(f"{how.name}: {done} of {wanted}", file=sys.stderr, flush=True)
        print(f"{late} more came after the end. {len(broken)} broken.")
        for how, of_cases in lost.items():
            every = [seconds for values in of_cases.values() for seconds in values]
            print(f"{how.name}: {len(every)} resumed to the uninterrupted result; CPU seconds lost, median and worst: {summary(every)}")
        print("| command | uninterrupted, CPU s | interrupted | SIGKILL: CPU s lost, median, worst | SIGTERM |\n|---|---|---|---|---|")
        for name, whole in campaign.seconds.items():
            killed, stopped = lost[signal.SIGKILL][name], lost[signal.SIGTERM][name]
            print(f"| {name} | {whole:.1f} | {len(killed) + len(stopped)} | {summary(killed)} | {summary(stopped)} |")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
