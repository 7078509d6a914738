#!/usr/bin/env python3
"""How much faster more processors would do a command, from the times of its pieces.

    sinew diagnose drive --data drive.h5 --threads 1 --out why.h5 --work-times times.json
    benchmarks/ranks/model.py times.json [--dispatch S] [--repeat S] [--answer BYTES] [--cores 1,2,4,16,1000]

Pieces of a loop are handed out in their order, each to the processor that is free first; loops wait for their last piece; what is
between loops is done by all ranks alike and so not divided. Added are what a piece costs beyond its work: `dispatch` [s], from asking
for a piece to having it, which the asking rank waits; `serve` [s], for which rank 0 is busy per piece and per rank that the answer goes
to; and `repeat` [s], for which each rank is busy with a piece that another one did.
"""
import argparse
import heapq
import json


def makespan(pieces, cores, cost):
    """Seconds of one loop."""
    if cores == 1 or len(pieces) < 2:
        return sum(pieces)
    free = [0.0] * min(cores, len(pieces))
    server = 0.0  # when rank 0 has handed out what it was asked for so far
    heapq.heapify(free)
    for seconds in pieces:
        asked = heapq.heappop(free)
        server = max(server, asked) + cost["serve"] * cores
        heapq.heappush(free, max(server, asked + cost["dispatch"]) + seconds)
    others = len(pieces) * (1 - 1 / cores)
    return max(max(free), server) + others * cost["repeat"]


def model(times, cores, cost):
    loops = [[seconds for seconds in loop["pieces"] if seconds is not None] for loop in times["loops"]]
    work = sum(sum(pieces) for pieces in loops)
    serial = times["processor_seconds"] - work
    return serial + sum(makespan(pieces, cores, cost) for pieces in loops), serial, work, loops


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("times", nargs="+")
    parser.add_argument("--dispatch", type=float, default=0.0)
    parser.add_argument("--serve", type=float, default=0.0)
    parser.add_argument("--repeat", type=float, default=0.0)
    parser.add_argument("--cores", default="1,2,4,16,100,1000")
    words = parser.parse_args()
    cost = {"dispatch": words.dispatch, "serve": words.serve, "repeat": words.repeat}
    for path in words.times:
        with open(path, encoding="utf-8") as file:
            times = json.load(file)
        alone, serial, work, loops = model(times, 1, cost)
        pieces = sorted(seconds for loop in loops for seconds in loop)
        if not pieces:
            print(f"{path}: {alone:.2f} s, and no piece that could be done elsewhere")
            continue
        print(f"{path}: {alone:.2f} s, {serial:.2f} s of it between {len(loops)} loops; {len(pieces)} pieces of "
              f"{pieces[len(pieces) // 2] * 1e3:.3g} ms (median), {pieces[-1] * 1e3:.3g} ms (longest)")
        for cores in map(int, words.cores.split(",")):
            seconds = model(times, cores, cost)[0]
            print(f"  {cores:5d} cores: {seconds:9.3f} s, {alone / seconds:6.2f} times as fast")
        longest = serial + sum(max(loop, default=0) for loop in loops)
        print(f"  no end of cores, free of charge: {longest:9.3f} s, {alone / longest:6.2f} times as fast")


if __name__ == "__main__":
    main()
