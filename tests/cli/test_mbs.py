"""The mechanisms through the program: figures, JSON, references of one's own, and words that are wrong.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_mbs.py
"""
import json
import os
import unittest
from pathlib import Path

from program import ROOT, ProgramTest

SHARED = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "mbs_benchmark"


# Total errors of OpenSim in the thesis [%], a tenth of them; A03-IVP was not in it.
TENTH_OF_THESIS = {"A01": 3.6e-4, "A02": 9.8e-5, "A03": 4.7e-3, "A04": 6.4e-5, "A05": 7.3e-6, "A03-IVP": 2e-5}


class Mbs(ProgramTest):
    def runs(self, *words):
        return json.loads(self.succeeds("mbs", *words, "--json", "-", "--quiet"))["runs"]

    def test_all_mechanisms_come_with_their_figures(self):
        runs = self.runs()
        self.assertEqual([r["mechanism"] for r in runs], ["A01", "A02", "A03", "A04", "A05", "A03-IVP"])
        for one in runs:
            with self.subTest(one["mechanism"]):
                self.assertIsNone(one["failure"])
                self.assertLess(one["total_error_percent"], TENTH_OF_THESIS[one["mechanism"]])
                self.assertLess(one["energy_drift"], 1e-3 * one["kinetic_energy"])
                self.assertGreater(one["cpu_seconds"], 0)
                self.assertGreater(one["evaluations"], one["steps"])
                for coordinate in one["coordinates"]:
                    self.assertLessEqual(coordinate["rmse"], coordinate["peak"])

    def test_the_table_names_what_it_shows(self):
        text = self.succeeds("mbs", "A01")
        for words in ("rk_merson at accuracy", "A01", "thesis %", "0.00360", "exact (Jacobi's elliptic functions)"):
            self.assertIn(words, text)

    def test_every_integrator_that_is_listed_runs(self):
        names = [line.split()[0] for line in self.succeeds("list", "integrators").splitlines()[1:-1]]
        self.assertIn("cpodes_bdf", names)
        for name in names:
            with self.subTest(name):
                self.assertLess(self.runs("A01", "--integrator", name, "--accuracy", "1e-4")[0]["total_error_percent"], 50)

    def test_a_motion_that_cannot_be_trusted_is_not_shown_as_if(self):
        text = self.succeeds("mbs", "A04", "--integrator", "rk_merson", "--accuracy", "1e-3")
        self.assertIn("A04  does not conserve energy", text)
        self.assertNotIn("does not conserve energy", self.succeeds("mbs", "A04"))

    def test_references_of_ones_own(self):
        self.write("A01_reference_x.csv", "t_s,value_m\n0,-1\n")
        self.write("A01_reference_y.csv", "t_s,value_m\n0,0.5\n")
        one = self.runs("A01", "--reference", self.folder)[0]
        self.assertEqual(one["coordinates"][0]["peak"], 0)
        self.assertAlmostEqual(one["coordinates"][1]["peak"], 0.5)
        self.assertAlmostEqual(one["total_error_percent"], 100 * 0.5**0.5)

    @unittest.skipUnless(SHARED.is_dir(), "needs the shared data")
    def test_the_curves_of_the_library_of_benchmark_problems(self):
        for mechanism, accuracy, percent in (("A01", "1e-9", 3.6e-4), ("A03", "1e-8", 4.7e-3), ("A05", "1e-7", 1e-4)):
            with self.subTest(mechanism):
                one = self.runs(mechanism, "--accuracy", accuracy, "--reference", SHARED)[0]
                self.assertLess(one["total_error_percent"], percent)

    def test_what_cannot_be_had(self):
        self.fails("mechanism 'A06' does not exist; did you mean 'A01'?", "mbs", "A06")
        self.fails("at most -1 s of CPU time: expected a time above 0", "mbs", "A01", "--max-seconds", "-1")
        self.fails("integrator 'rk_fehlberg' does not exist; did you mean 'rk_feldberg'?", "mbs", "A01", "--integrator",
                   "rk_fehlberg")
        self.fails("accuracy 1: expected 1e-14 .. 0.1", "mbs", "A01", "--accuracy", "1")
        self.fails("A01 has no formulation 'loops'; expected one of tree", "mbs", "A01", "--formulation", "loops")
        self.fails("absent: cannot be read as a folder of references", "mbs", "A01", "--reference", "absent")
        self.write("A01_reference_x.csv", "t_s,value_m\n0,-1\n0,2\n")
        self.fails("./A01_reference_x.csv:3: time does not increase", "mbs", "A01", "--reference", ".")

    def test_a_run_that_does_not_end_in_time(self):
        done = self.run_program("mbs", "A01", "--integrator", "semi_explicit_euler2", "--accuracy", "1e-13", "--max-seconds", "0.2")
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^sinew: no usable answer: A01 with semi_explicit_euler2 at accuracy 1e-13: stopped at t = ")


if __name__ == "__main__":
    unittest.main()
