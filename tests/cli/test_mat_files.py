"""MAT files: what comes in, and what is refused in one line.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_mat_files.py
"""
import json
import os
import unittest
import zlib
from pathlib import Path

import h5py
import numpy as np

from mat_files import big_endian, channel, numbers, struct5, table, text, version5, write_version73
from program import ROOT, ProgramTest

ANKLE = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "dynamometer_ankle"
MAPS = ROOT / "docs" / "examples" / "dynamometer_ankle"
MAP = "channels:\n  torque: {column: Torque, unit: N*m}\n"
TORQUE = struct5("Torque", **channel("Torque", [1.5, 2.5, 3.5], "Nm"))


class MatFile(ProgramTest):
    def bring(self, data, data_map=MAP):
        """The grids of the trial: {channel: (times, values)}."""
        if data is not None:
            self.write("walk.mat", data)
        self.write("map.yaml", data_map)
        done = self.run_program("data", "import", "walk.mat", "--map", "map.yaml", "--out", "walk.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        with h5py.File(self.path("walk.h5")) as file:
            return {name: (grid["time"][:], grid["channels"][name][:]) for grid in file["trials/walk"].values()
                    for name in grid["channels"]}

    def import_fails(self, message, data=None, data_map=MAP):
        if data is not None:
            self.write("walk.mat", data)
        self.write("map.yaml", data_map)
        self.fails(message, "data", "import", "walk.mat", "--map", "map.yaml", "--out", "walk.h5")


class BothVersions(MatFile):
    def test_a_channel_of_spike2(self):
        write_version73(self.path("walk.mat"), Torque=channel("Torque", [1.5, 2.5, 3.5], "Nm"))
        new = self.bring(None)
        old = self.bring(version5(TORQUE))
        compressed = zlib.compress(TORQUE)
        small = self.bring(version5(b"\x0f\0\0\0" + len(compressed).to_bytes(4, "little") + compressed))
        for found in (new, old, small):
            np.testing.assert_allclose(found["torque"][0], [0.0002, 0.0012, 0.0022], rtol=1e-12)
            np.testing.assert_array_equal(found["torque"][1], [1.5, 2.5, 3.5])

    def test_arrays_with_a_time_vector(self):
        write_version73(self.path("walk.mat"), t=[0, 10, 30], q=[90, np.nan, 180])
        data_map = "time: {column: t, unit: ms}\nchannels: {q: {unit: deg}}\n"
        for found in (self.bring(None, data_map), self.bring(version5(numbers("t", [0, 10, 30]), numbers("q", [90, np.nan, 180])),
                                                             data_map)):
            np.testing.assert_allclose(found["q"][0], [0, 0.01, 0.03], rtol=1e-12)
            np.testing.assert_allclose(found["q"][1], [np.pi / 2, np.nan, np.pi], rtol=1e-12)


    def test_the_other_order_of_bytes(self):
        found = self.bring(big_endian("q", [1.5, -2]), "time: {rate: 10}\nchannels: {q: {unit: m}}\n")
        np.testing.assert_array_equal(found["q"][1], [1.5, -2])


class Refused(MatFile):
    def test_other_files(self):
        expected = "expected a MAT file of version 5 or 7.3"
        self.import_fails(f"walk.mat: is empty, {expected}", b"")
        self.import_fails(f"walk.mat: is not a MAT file, {expected}", b"time,torque\n0,1\n")
        with h5py.File(self.path("walk.mat"), "w") as file:
            file["Torque"] = [1.0, 2.0]
        self.import_fails(f"walk.mat: is an HDF5 file without the header of a MAT file, {expected}")
        version4 = b"\0\0\0\0" + b"\2\0\0\0" + b"\1\0\0\0" + bytes(4) + b"\2\0\0\0" + b"x\0" + bytes(16)
        self.import_fails(f"walk.mat: is a MAT file of version 4, {expected} (in MATLAB: load it, then save with -v7)", version4)

    def test_truncated(self):
        whole = version5(TORQUE)
        self.import_fails(f"walk.mat: is truncated: the element at byte 128 announces {len(TORQUE) - 8} bytes, "
                          f"{len(TORQUE) - 18} are there", whole[:-10])
        compressed = zlib.compress(TORQUE)[:-6]
        self.import_fails("walk.mat: is damaged: the compressed element at byte 128 disagrees with its checksum or ends early",
                          version5(b"\x0f\0\0\0" + len(compressed).to_bytes(4, "little") + compressed))
        write_version73(self.path("walk.mat"), Torque=channel("Torque", np.arange(5000.0), "Nm"))
        self.write("walk.mat", self.path("walk.mat").read_bytes()[:-3000])
        self.import_fails("walk.mat: cannot be opened as HDF5 (truncated or damaged)")

    def test_a_table(self):
        self.import_fails("walk.mat: Torque is a 'table', an object that MATLAB alone can read, expected an array or a struct of "
                          "arrays (in MATLAB: s = table2struct(t, 'ToScalar', true), then save s)", version5(table("Torque")))

        def add(file):
            file["Torque"] = np.array([[0xDD000000, 2, 1, 1, 1, 1]], np.uint32)
            file["Torque"].attrs["MATLAB_class"] = np.bytes_("table")

        write_version73(self.path("walk.mat"), add)
        self.write("map.yaml", MAP)
        self.refuses("walk.mat: Torque is a table, a string, an object or a function of MATLAB", "data", "import", "walk.mat", "--map",
                     "map.yaml", "--out", "walk.h5")

    def test_a_missing_channel_lists_those_that_are_there(self):
        data = version5(*(struct5(name, **channel(name, [1, 2])) for name in ("Angle", "EMG_TA", "Torque")))
        self.import_fails("map.yaml:2: walk.mat has no variable and no title 'Torqe'; there are Torque, Angle, EMG_TA", data,
                          "channels:\n  torque: {column: Torqe}\n")

    def test_two_channels_of_one_title(self):
        data = version5(struct5("Ch1", **channel("EMG", [1, 2])), struct5("Ch2", **channel("EMG", [1, 2])))
        self.import_fails("map.yaml:1: two channels of walk.mat have the title 'EMG': Ch1 and Ch2; name the variable", data,
                          "channels: {emg: {column: EMG}}\n")
        self.import_fails("walk.mat: two variables are named 'Torque'", version5(TORQUE, TORQUE))

    def test_no_unit(self):
        self.import_fails("map.yaml:2: channel 'q' has no unit; walk.mat: q does not contain it (1 if there is none)",
                          version5(numbers("q", [1, 2])), "time: {rate: 10}\nchannels: {q: {}}\n")

    def test_text(self):
        self.import_fails("walk.mat: q is 1 x 3 text, expected a vector of numbers", version5(text("q", "abc")),
                          "time: {rate: 10}\nchannels: {q: {unit: m}}\n")

    def test_no_map(self):
        self.write("walk.mat", version5(TORQUE))
        self.fails("walk.mat: needs a map that assigns its variables to channels (they are Torque (1 x 1 struct))", "data", "import",
                   "walk.mat", "--out", "walk.h5")

    def test_links_and_numbers_in_other_files(self):
        with h5py.File(self.path("secret.h5"), "w") as file:
            file["numbers"] = np.arange(5.0)
        self.path("secret.bin").write_bytes(np.arange(5.0).tobytes())

        def link(file):
            file["Torque"] = h5py.ExternalLink("secret.h5", "/numbers")

        def outside(file):
            file.create_dataset("Torque", shape=(1, 5), dtype="f8", external=[("secret.bin", 0, 40)])

        def virtual(file):
            layout = h5py.VirtualLayout(shape=(5,), dtype="f8")
            layout[:] = h5py.VirtualSource("secret.h5", "numbers", shape=(5,))
            file.create_virtual_dataset("Torque", layout)

        write_version73(self.path("walk.mat"), link)
        self.import_fails("walk.mat: /: member 'Torque' is a link to another file, expected the data themselves")
        for change in (outside, virtual):
            write_version73(self.path("walk.mat"), change)
            self.import_fails("walk.mat: /Torque: its numbers are in another file, expected them in this one")

    def test_enormous_sizes(self):
        sizes = b"\3\0\0\0\1\0\0\0"
        data = version5(numbers("q", [1, 2, 3]))
        data_map = "time: {rate: 10}\nchannels: {q: {unit: m}}\n"
        self.import_fails("walk.mat: variable 'q' announces more values than the file can hold",
                          data.replace(sizes, b"\0\0\0\x10\1\0\0\0"), data_map)
        self.import_fails("walk.mat: q has more than 268435456 values",
                          data.replace(sizes, b"\xff\xff\xff\x7f\xff\xff\xff\x7f"), data_map)


@unittest.skipUnless(ANKLE.is_dir(), f"{ANKLE} is not there")
class Dynamometer(ProgramTest):
    def test_a_recording_and_its_ultrasound(self):
        done = self.run_program("data", "import", ANKLE / "PL_100_01.mat", ANKLE / "fascicles" / "PL_100_01.mat", "--map",
                                MAPS / "contraction.yaml", "--role", "validate", "--out", "ankle.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        info = json.loads(self.succeeds("data", "info", "ankle.h5", "--json"))
        trial = info["trials"]["PL_100_01"]
        self.assertEqual(trial["role"], "validate")
        self.assertEqual({name: grid["samples"] for name, grid in trial["grids"].items()},
                         {"machine_angle": 34000, "machine_torque": 34000, "tib_ant": 34000, "tib_ant_fascicle_1": 500})
        with h5py.File(self.path("ankle.h5")) as made, h5py.File(ANKLE / "PL_100_01.mat") as raw:
            grid = made["trials/PL_100_01/machine_angle"]
            np.testing.assert_allclose(grid["channels/machine_angle"][:], -np.radians(raw["Angle/values"][0]), rtol=1e-12)
            np.testing.assert_allclose(np.diff(grid["time"][:]), 0.0005, rtol=1e-9)
            self.assertEqual(grid["time"][0], raw["Angle/start"][0, 0])
            np.testing.assert_array_equal(made["trials/PL_100_01/tib_ant_fascicle_1/time"][:], raw["US/times"][0])


if __name__ == "__main__":
    unittest.main()
