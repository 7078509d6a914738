"""Several things wrong at once in a joint: two cases of benchmarks/large_misfits."""
import json
import sys
import unittest

from program import ROOT, ProgramTest

sys.path.insert(0, str(ROOT / "benchmarks" / "large_misfits"))
import cases  # noqa: E402


class LargeMisfit(ProgramTest):
    def diagnose(self, seed):
        case = cases.draw_case(seed)
        self.succeeds("data", "synthesize", "drive", *case.words(), "--out", "case.h5", "--quiet")
        return case, json.loads(self.succeeds("diagnose", "drive", "--data", "case.h5", "--threads", 2, "--quiet", "--out",
                                              "why.h5", "--json", "-"))

    def test_five_causes_that_improve_little_one_by_one(self):
        """Fewer causes leave 80 times the squares, which a noise model of ten coefficients predicts: they must not win."""
        case, found = self.diagnose(312)
        named = [cause["effect"] for cause in found["causes"]]
        self.assertEqual(len(named), len(case.effects), named)
        for effect in case.effects:
            self.assertTrue(cases.class_of(effect) & set(named), f"{effect} is not among {named}")
        self.assertEqual(found["unknown_terms"], [])
        self.assertLess(found["gain"]["validate_rmse_after"], 1.2 * case.settings["position_noise"])

    def test_what_is_in_no_library_is_a_curve_and_no_cause(self):
        case, found = self.diagnose(309)
        self.assertEqual(list(case.outsider), ["eccentric_encoder"])
        self.assertEqual({cause["effect"] for cause in found["causes"]}, set(case.effects))
        self.assertEqual([term["name"] for term in found["unknown_terms"]], ["position(position)"])
        self.assertIsNone(found["unknown_terms"][0]["p_value"])
        for cause in found["withdrawn"]:
            self.assertEqual(cause["terms"], ["position(position)"], cause["effect"])
        self.assertEqual(found["verdict"], "unexplained")
        self.assertLess(found["gain"]["validate_rmse_after"], 0.05 * found["gain"]["validate_rmse_before"])


if __name__ == "__main__":
    unittest.main()
