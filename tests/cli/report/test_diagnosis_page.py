"""The report of a diagnosis, through its command line, on fabricated files.

    /usr/bin/python3 -B -m unittest discover -s tests/cli/report
"""
import re
import unittest

import h5py

from fabricated_diagnosis import write_diagnosis
from fabricated_files import write_run
from test_report import WithFolder, report


class OneDiagnosis(WithFolder):
    def page_of(self, **changes):
        """(text of the notebook's outputs, the page, headings) of a made-up diagnosis."""
        write_diagnosis(self.run_path, **changes)
        status, said, complaint = report(self.run_path, "--out-dir", self.out)
        self.assertEqual((status, complaint), (0, ""), said)
        page = self.check_page(self.out / "index.html")
        return self.check_notebook(self.out / "index.ipynb"), page, re.findall(r'<h2 id="[^"]*">([^<]*)', page)

    def test_says_what_is_wrong_and_draws_every_part(self):
        text, page, headings = self.page_of()
        self.assertEqual(headings, ["The error", "What could explain it", "How the causes were chosen", "Where the error is",
                                    "Not in the library", "Gain on held-out trials", "Parameters", "Words on this page", "How this was made"])
        self.assertEqual(page.count("<figure>"), 7)
        self.assertIn("<b>Ambiguous</b>", text)
        self.assertIn("drive: diagnosis of made-up joint &amp; &lt;nothing measured&gt;", page)
        self.assertIn("−87 %", text)
        self.assertEqual(page.count("<li class=minor>"), 1)   # the alternative belongs to its cause
        self.assertIn("95 % interval −91 % to −82 %", text)
        self.assertIn("<b>bias +138.2 %</b>", text)           # viscous friction: 0.081 instead of 0.034
        self.assertIn("(null)", text)                        # of the effect parameter
        self.assertIn("a trial with very slow motion", text)
        self.assertIn("Withdrawn: position.gain: it does not generalise to the held-out trials.", text)
        self.assertIn("Not judged: position.drift: the base parameters compensate it fully.", text)
        self.assertIn("0.0040 s", text)                      # smallest time offset that would have been noticed

    def test_shows_how_causes_were_chosen_by_cross_validation(self):
        text, _, _ = self.page_of()
        self.assertIn("Chosen, of 1000 resamples: coulomb 97\u00a0%, position.gain 31\u00a0%, stribeck 3\u00a0%.", text)
        rows = re.findall(r"<tr><td class=\"value\">(\d)</td><td>(.*?)</td><td class=\"value\">(.*?)</td></tr>", text)
        self.assertEqual(rows, [("0", "–", "100 %"), ("1", "<b>coulomb</b>", "41 %"), ("2", "coulomb, position.gain", "38 %"),
                                ("3", "coulomb, stribeck, position.gain", "40 %")])

    def test_without_cross_validation_there_is_no_ladder(self):
        for change in (dict(ladder=()), dict(ladder=(("", 1.0),))):  # chosen by likelihood; a search that found nothing
            with self.subTest(change):
                self.assertNotIn("How the causes were chosen", self.page_of(**change)[2])

    def test_a_set_of_many_causes_that_is_not_on_the_ladder(self):
        names = [f"effect_{i:02}" for i in range(6)]
        text, page, headings = self.page_of(ladder=[(",".join(names[:i]), 0.9 ** i if i else 1.0) for i in range(7)])
        self.assertIn("How the causes were chosen", headings)
        self.assertNotIn("<b>effect_00", text)
        self.assertIn("53 %", text)
        self.assertIn("effect_05", page)

    def test_nothing_wrong(self):
        text, _, headings = self.page_of(verdict="adequate", found=False, ladder=())
        self.assertEqual(headings, ["The error", "What could explain it", "Parameters", "Words on this page", "How this was made"])
        self.assertIn("<b>Adequate</b>", text)
        self.assertIn("p = 0.41", text)
        self.assertNotIn("Extended model", text)
        self.assertIn("<details open>", text)  # how small an effect would have been noticed is the finding

    def test_without_a_base_fit_nothing_is_concluded(self):
        text, _, headings = self.page_of(usable=0, ladder=())
        self.assertEqual(headings, ["Words on this page", "How this was made"])
        self.assertIn("<b>No conclusion</b>", text)
        self.assertNotIn("Unexplained", text)

    def test_many_effects_and_no_held_out_trial(self):
        text, _, headings = self.page_of(many=True, validate=(), trials=[f"trial_{i}" for i in range(30)])
        self.assertIn("all 46 as a table", text)
        self.assertIn("24 of 60 traces are drawn", text)
        self.assertNotIn("Gain on held-out trials", headings)
        self.assertIn("effect_39", text)

    def test_beside_a_run_it_has_its_page_and_its_words_in_the_overview(self):
        write_diagnosis(self.folder / "why.h5")
        write_run(self.run_path)
        status, _, complaint = report(self.run_path, self.folder / "why.h5", "--out-dir", self.out)
        self.assertEqual((status, complaint), (0, ""))
        self.assertEqual(sorted(path.name for path in self.out.glob("*.html")), ["index.html", "run.html", "why.html"])
        self.assertIn("more than one known cause could explain it", self.check_page(self.out / "index.html"))


class BadDiagnosis(WithFolder):
    def complaint(self, change):
        write_diagnosis(self.run_path)
        with h5py.File(self.run_path, "r+") as file:
            change(file)
        status, said, complaint = report(self.run_path, "--out-dir", self.out)
        self.assertEqual((status, said), (2, ""))
        self.assertFalse(self.out.exists())
        return complaint.removeprefix(f"sinew: error: {self.run_path}: ").rstrip("\n")

    def test_parts_missing_or_misshapen(self):
        def shorten(file):
            del file["diagnosis/scores/statistic"]
            file["diagnosis/scores/statistic"] = [1.0]

        def rename_finding(file):
            file["diagnosis/scores/finding"][0] = "culprit"

        for change, expected in (
                (lambda file: file["diagnosis"].attrs.update(sinew_schema="diagnosis/9"),
                 "/diagnosis has schema 'diagnosis/9', expected 'diagnosis/1'"),
                (lambda file: file["diagnosis"].attrs.update(verdict="fine"),
                 "/diagnosis@verdict is 'fine', expected one of adequate, explained, ambiguous, unexplained"),
                (lambda file: file["diagnosis"].attrs.__delitem__("threshold"),
                 "/diagnosis has no attribute 'threshold'"),
                (lambda file: file.__delitem__("run"), "/run is missing"),
                (lambda file: file.__delitem__("diagnosis/gain/after"), "/diagnosis/gain/after is missing"),
                (lambda file: file.__delitem__("diagnosis/ladder/error"), "/diagnosis/ladder/error is missing"),
                (lambda file: file.__delitem__("diagnosis/traces/slow/position/before"),
                 "/diagnosis/traces/slow/position/before is missing"),
                (shorten, "/diagnosis/scores/statistic has 1 entries, /diagnosis/scores/effect has 7"),
                (rename_finding, "/diagnosis/scores/finding is 'culprit', expected one of cause, alternative, withdrawn, "
                                 "unknown_term, ruled_out, not_judged")):
            with self.subTest(expected):
                self.assertEqual(self.complaint(change), expected)


if __name__ == "__main__":
    unittest.main()
