"""What ./demo and ./check install, and whom the compiler's warnings stop.

    /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_build_scripts.py
"""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
# Debian's tools, so that nothing is installed: a package of $installed is there, one of $known can be had.
WITHOUT_DEBIAN = """
source cmake/steps.sh
dpkg-query() { [[ " $installed " == *" ${@: -1} "* ]] && echo "install ok installed"; }
apt-cache() { [[ " $known " == *" ${@: -1} "* ]]; }
apt-get() { echo "apt-get $*"; }
env() { shift; "$@"; }
sudo() { "$@"; }
"""


def bash(script, **variables):
    done = subprocess.run(["bash", "-euc", WITHOUT_DEBIAN + script], cwd=ROOT, env={**os.environ, "installed": "", "known": "",
                          **variables}, capture_output=True, text=True, check=True)
    return done.stdout


def packages(*sections):
    return bash("packages_of " + " ".join(sections)).split()


class Packages(unittest.TestCase):
    def test_of_the_demo_are_those_of_building_and_running(self):
        for name in packages("build"):
            self.assertNotRegex(name, "clang|gtest|gmock|benchmark|^git$")
        self.assertIn("libsimbody-dev", packages("build"))

    def test_are_each_in_one_section(self):
        every = packages("build", "check", "format", "full")
        self.assertEqual(len(set(every)), len(every))
        lines = (line.split("#")[0].split() for line in (ROOT / "packages.txt").read_text().splitlines())
        self.assertEqual(sorted(every), sorted(words[0] for words in lines if words and not words[0].startswith("[")))

    def test_that_are_missing_are_installed(self):
        *others, one, another = packages("check")
        done = bash("install_packages check", installed=" ".join(others))
        self.assertIn(f"apt-get install -y --no-install-recommends {one} {another}\n", done)
        self.assertIn(f"summary: {len(others) + 2} packages, 2 installed now", done)
        self.assertNotIn("apt-get", bash("install_packages check", installed=" ".join(packages("check"))))

    def test_of_the_format_are_left_out_where_debian_has_none(self):
        formatter, = packages("format")
        *others, one = packages("check")
        without = bash("install_packages check format", installed=" ".join(others))
        self.assertNotIn(formatter, without.split("install -y")[1])
        self.assertIn(f"{formatter} is not in this release of Debian", without)
        self.assertIn(f"{one} {formatter}\n", bash("install_packages check format", installed=" ".join(others), known=formatter))
        only = bash("install_packages format")
        self.assertNotIn("apt-get install", only)
        self.assertIn("summary: skipped", bash("command() { return 1; }; check_format"))


class Warnings(unittest.TestCase):
    def test_do_not_stop_a_users_build(self):
        presets = {p["name"]: p for p in json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]}
        self.assertEqual(presets["release"]["cacheVariables"]["SINEW_WERROR"], "OFF")
        self.assertEqual(presets["release"]["cacheVariables"]["SINEW_KEEP_WARNINGS"], "ON")

    def test_are_kept_beside_the_object_until_it_has_none(self):
        with tempfile.TemporaryDirectory() as folder:
            source, kept = Path(folder, "a.cpp"), Path(folder, "a.o.warnings")

            def compile_it(text):
                source.write_text(text)
                done = subprocess.run([ROOT / "cmake" / "keep_warnings.sh", "c++", "-Wall", "-c", "a.cpp", "-o", "a.o"],
                                      cwd=folder, capture_output=True, text=True, check=False)
                return done.returncode, done.stderr

            status, said = compile_it("int f() { int unused; return 1; }\n")
            self.assertEqual((status, kept.read_text()), (0, said))
            self.assertIn("unused variable", said)
            self.assertEqual(compile_it("int f() { return 1; }\n"), (0, ""))
            self.assertFalse(kept.exists())
            self.assertEqual(compile_it("int f( {}\n")[0], 1)


class FailedTests(unittest.TestCase):
    def test_are_told_again_at_the_end_without_those_that_passed(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "LastTestsFailed.log").write_text("2:cli.report\n")
            Path(folder, "LastTest.log").write_text("".join(
                f"{number}/3 Testing: {name}\n{number}/3 Test: {name}\nOutput:\n{said}\n<end of output>\nTest time = 1 s\n"
                for number, name, said in ((1, "cli.reports", "well"), (2, "cli.report", "the reason"), (3, "report", "well"))))
            self.assertEqual(bash(f"print_failed_tests {folder}"), "--- cli.report\nOutput:\nthe reason\n")


if __name__ == "__main__":
    unittest.main()
