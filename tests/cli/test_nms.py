"""Muscles through the program: the ankle study and its diagnosis, CEINMS projects, and what is wrong with files.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_nms.py
"""
import json
import os
import shutil
import unittest
from pathlib import Path

import h5py

from program import ROOT, ProgramTest

EXAMPLE = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "ceinms_example"
STUDY = ROOT / "datasets" / "data" / "ankle_study.h5"


class AnkleStudy(ProgramTest):
    def found(self, data):
        self.succeeds("diagnose", "nms", "--data", data, "--threads", "1", "--quiet", "--out", "why.h5", "--json", "why.json")
        return json.loads(self.path("why.json").read_text())

    def test_nothing_is_wrong(self):
        self.succeeds("data", "synthesize", "nms", "--seed", "2", "--out", "ankle.h5")
        found = self.found("ankle.h5")
        self.assertEqual(found["verdict"], "adequate", found["sentences"])

    def test_what_is_hidden_in_the_committed_study_is_found(self):
        truth = json.loads(STUDY.with_name("ankle_study.truth.json").read_text())
        (effect, numbers), = truth["effects"].items()
        found = self.found(STUDY)
        self.assertEqual([c["effect"] for c in found["causes"]], [effect], found["sentences"])
        for parameter in found["causes"][0]["parameters"]:
            low, high = parameter["ci95"]
            self.assertLess(low, numbers[parameter["name"]])
            self.assertLess(numbers[parameter["name"]], high)
        after = {p["name"]: p for p in found["extended_parameters"]}
        for name, value in truth["base"].items():
            low, high = after[name]["ci95"]
            wide = 0.5 * (high - low)
            self.assertLess(low - wide, value, name)
            self.assertLess(value, high + wide, name)
        self.assertGreater(found["gains"][0]["reduction"], 0.1)

    def test_raw_emg_gives_the_excitations(self):
        """The committed study holds the raw EMG of one electrode; its envelope is near the mean of many."""
        shutil.copy(STUDY, self.path("study.h5"))
        self.run_program("data", "envelope", "study.h5", "--grid", "emg", "--normalise", "values:" + ",".join(
            f"{m}=1e-3" for m in ("lat_gas_r", "med_gas_r", "soleus_r", "tib_ant_r", "per_long_r", "per_brev_r", "per_tert_r")),
            "--out", "envelopes.h5")
        with h5py.File(STUDY) as study, h5py.File(self.path("envelopes.h5")) as made:
            for trial in study["trials"]:
                mean = study[f"trials/{trial}/excitations/channels/soleus_r"][:]
                one = made[f"trials/{trial}/excitations/channels/soleus_r"][:]
                self.assertEqual(len(mean), len(one))
                middle = slice(20, -20)  # the ends of an envelope hang on single samples
                self.assertLess(((mean - one)[middle] ** 2).mean() ** 0.5, 0.15 * mean.max())

    def test_steps_hold_what_was_found_before(self):
        with h5py.File(STUDY) as study:
            settings = study["files/nms.yaml"].asstr()[()]
        config = self.path("steps.yaml")
        config.write_text(settings.replace("  parameters:", "  steps:\n    - {parameters: [strength]}\n"
                                           "    - {parameters: [shape]}\n  parameters:", 1))
        steps = json.loads(self.succeeds("identify", "nms", "--data", STUDY, "--config", config, "--stepwise", "--quiet",
                                         "--out", "last.h5", "--json", "-"))
        told = {(fact["step"], name) for fact in steps["finding_facts"] for name in fact["about"]}
        self.assertIn(("step 1 (ankle_angle_r: strength)", "triceps.strength"), told)
        first = json.loads(self.succeeds("identify", "nms", "--data", STUDY, "--quiet", "--out", "first.h5", "--free",
                                         "triceps.strength,peronei.strength,dorsiflexors.strength", "--json", "-"))
        self.assertEqual({fact["step"] for fact in first["finding_facts"]}, {""})
        with h5py.File(self.path("last.h5")) as last, h5py.File(self.path("first.h5")) as alone:
            values = [dict(zip(run["parameters/name"].asstr()[:], run["parameters/value"][:])) for run in (last, alone)]
        self.assertEqual(values[0]["triceps.strength"], values[1]["triceps.strength"])
        self.assertNotEqual(values[0]["plantarflexors.shape"], values[1]["plantarflexors.shape"])
        self.assertEqual(values[0]["triceps.tendon_slack_length"], 1, "no step frees it")
        self.refuses("the settings of this problem list no steps", "identify", "nms", "--data", STUDY, "--stepwise", "--quiet",
                     "--out", "none.h5")

    def test_a_run_holds_the_muscles_and_the_subject(self):
        self.succeeds("identify", "nms", "--data", STUDY, "--quiet", "--out", "run.h5", "--release",
                      "passive_stiffness.ankle_angle_r")
        with h5py.File(self.path("run.h5")) as run:
            muscle = run["details/nms/train_60/soleus_r"]
            self.assertGreater(muscle["force"][:].max(), 100)
            self.assertTrue((muscle["activation"][:] >= 0).all())
            strengths = dict(zip(run["parameters/name"].asstr()[:], run["parameters/value"][:]))
        self.succeeds("data", "subject", "run.h5", "--out", "calibrated.xml")
        text = self.path("calibrated.xml").read_text()
        self.assertIn(f"<strengthCoefficient>{strengths['triceps.strength']:.4f}"[:24], text)
        self.refuses("holds no subject", "data", "subject", STUDY, "--out", "other.xml")


@unittest.skipUnless(EXAMPLE.is_dir(), f"{EXAMPLE} is not there")
class CeinmsProject(ProgramTest):
    def project(self):
        folder = self.path("project")
        shutil.copytree(EXAMPLE, folder)
        for path in [folder, *folder.rglob("*")]:
            path.chmod(0o755)
        return folder

    def test_a_calibration_is_one_import_away(self):
        self.run_program("data", "ceinms", EXAMPLE / "csetup_stiff.xml", "--validate", EXAMPLE / "trial3" / "trial3.xml", "--out",
                         "project.h5")
        said = self.succeeds("identify", "nms", "--data", "project.h5", "--solver", "lm", "--intervals", "linear", "--quiet",
                             "--out", "run.h5", "--json", "run.json").replace("\n    ", " ")
        found = json.loads(self.path("run.json").read_text())
        with h5py.File(self.path("run.h5")) as run:
            self.assertEqual(len(run["uncertainty/name"]), 50)
            f = 2 * run["run"].attrs["cost"]
            self.assertLess(f, 2.5e-6)
            self.assertEqual(len(run["derived/name"]), 22)
            self.assertAlmostEqual(run["figures/value"][0] / f, 1, 9)
        # What a user of CEINMS looks for: the objective, f, C1 and C2, who is in a group.
        self.assertRegex(said, r"cost \S+: half the sum over trials and joints of the mean squared error")
        self.assertRegex(said, r"CEINMS's f \S+: sum over fitted trials and joints")
        self.assertRegex(said, r"evaluations \S+ m?s, intervals \S+ m?s converged")
        self.assertIn("group_4.strength: shared by med_gas_r and lat_gas_r.", said)
        self.assertRegex(said, r"soleus_r.C1 = -0.42\d* \(95 % interval \S+ to \S+\): derived from soleus_r.filter_mean and "
                               r"soleus_r.filter_spread.")
        c2 = next(d for d in found["derived"] if d["name"] == "soleus_r.C2")
        self.assertAlmostEqual(c2["value"], -0.67, 2)
        self.assertTrue(c2["ci95"][0] < c2["value"] < c2["ci95"][1])
        self.assertEqual(found["figures"][0]["name"], "CEINMS's f")
        members = {p["name"]: p["shared_by"] for p in found["parameters"]}
        self.assertEqual(members["group_4.strength"], ["med_gas_r", "lat_gas_r"])
        self.assertEqual(members["soleus_r.strength"], [])

    def test_an_execution_is_imported_too(self):
        done = self.run_program("data", "ceinms", EXAMPLE / "setup_true_equilibriumElastic_1.xml", "--out", "one.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.succeeds("simulate", "nms", "--data", "one.h5", "--out", "out.h5")

    def test_wrong_files_get_one_sentence_and_write_nothing(self):
        for file, old, new, words in (
                ("csetup_stiff.xml", "<subjectFile>start.xml", "<subjectFile>missing.xml", "missing.xml"),
                ("csetup_stiff.xml", "<ceinmsCalibration>", "<calibrations>", "csetup_stiff.xml:"),
                ("cal_stiff.xml", "<name>c1</name>", "<name>c3</name>", "parameter 'c3' does not exist"),
                ("cal_stiff.xml", "0.85 1.15", "1.15 0.85", "not two increasing numbers"),
                ("cal_stiff.xml", "<stiff/>", "<rubber/>", "no kind <rubber>"),
                ("exc.xml", '<excitation id="soleus_r"><input weight="1">soleus_r', '<excitation id="soleus_r"><input weight="1">solus_r',
                 "there is no column 'solus_r'"),
                ("trial1/trial1.xml", "Length.sto", "Lengths.sto", "Lengths.sto"),
                ("trial1/trial1.xml", "inputData>", "input>", "expected <inputData>"),
        ):
            with self.subTest(words=words):
                folder = self.project()
                text = (folder / file).read_text()
                self.assertIn(old, text)
                (folder / file).write_text(text.replace(old, new))
                self.refuses(words, "data", "ceinms", folder / "csetup_stiff.xml", "--out", "project.h5")
                self.assertFalse(self.path("project.h5").exists())
                shutil.rmtree(folder)

    def test_a_muscle_without_input_is_said(self):
        folder = self.project()
        text = (folder / "exc.xml").read_text()
        (folder / "exc.xml").write_text(text.replace('<input weight="1">soleus_r</input>', ""))
        done = self.run_program("data", "ceinms", folder / "csetup_stiff.xml", "--out", "project.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("muscle 'soleus_r' has no input", done.stderr.replace("\n  ", " "))
        self.refuses("soleus_r", "identify", "nms", "--data", "project.h5", "--out", "run.h5")

    def test_excitations_outside_of_their_range_are_one_warning(self):
        self.run_program("data", "ceinms", EXAMPLE / "csetup_stiff.xml", "--out", "project.h5")
        with h5py.File(self.path("project.h5"), "r+") as file:
            file["trials/trial1/excitations/channels/soleus_r"][5:9] = 1.5
        told = self.run_program("identify", "nms", "--data", "project.h5", "--max-evaluations", "1", "--out", "run.h5").stdout
        self.assertEqual(" ".join(told.split()).count("outside of 0..1"), 1, told)


if __name__ == "__main__":
    unittest.main()
