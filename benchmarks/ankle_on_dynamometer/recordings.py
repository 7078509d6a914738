#!/usr/bin/python3
"""Makes a data set for ankle_on_dynamometer of the recordings of a real person (PaulT95/Tecchio_et_al_2023), with the maps of
docs/examples/dynamometer_ankle: passive recordings, Ref_Long_*, PL_0_01 and PL_50_01 are fitted, the others held out.

usage: recordings.py --sinew build/release/sinew --recordings FOLDER --out person.h5
"""
import argparse
import pathlib
import subprocess
import sys

MAPS = pathlib.Path(__file__).resolve().parents[2] / "docs" / "examples" / "dynamometer_ankle"
FITTED = ("Ref_Long_01", "Ref_Long_02", "PL_0_01", "PL_50_01")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--sinew", required=True)
    parser.add_argument("--recordings", required=True, type=pathlib.Path)
    parser.add_argument("--out", required=True, type=pathlib.Path)
    words = parser.parse_args()

    def sinew(*command):
        subprocess.run([words.sinew, *map(str, command)], check=True, stdout=subprocess.DEVNULL)

    words.out.unlink(missing_ok=True)
    for file in sorted(words.recordings.glob("Pas_*.mat")):
        sinew("data", "import", file, "--map", MAPS / "passive.yaml", "--role", "train", "--append", "--out", words.out)
    for file in sorted(words.recordings.glob("PL_*.mat")) + sorted(words.recordings.glob("Ref_*.mat")):
        sinew("data", "import", file, words.recordings / "fascicles" / file.name, "--map", MAPS / "contraction.yaml", "--role",
              "train" if file.stem in FITTED else "validate", "--append", "--out", words.out)
    sinew("data", "envelope", words.out, "--grid", "tib_ant", "--channels", "tib_ant=tib_ant_r")
    return 0


if __name__ == "__main__":
    sys.exit(main())
