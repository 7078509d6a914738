"""What the documents tell people to write and to run does run.

A fence with a file's name (```yaml bench.yaml) is that file; ```python and ```sh are run, in the order of the page.

    SINEW_PROGRAM=build/release/sinew /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_documents.py
"""
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

from program import LONGEST, PROGRAM, ROOT, ProgramTest

GAIT = Path(os.environ.get("SINEW_SHARED_DATA", ROOT.parent / "shared" / "data")) / "gait_subject01"
FENCE = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)


class Documents(ProgramTest):
    def follow(self, page):
        path = f"{Path(PROGRAM).resolve().parent}:{os.environ['PATH']}"
        ran = 0
        for language, name, text in FENCE.findall((ROOT / "docs" / page).read_text()):
            if name:
                self.write(name, text)
                continue
            if "$DATA" in text and not GAIT.is_dir():
                continue
            command = {"python": [sys.executable, "-c", text], "sh": ["bash", "-ec", text]}[language]
            done = subprocess.run(command, cwd=self.folder, env={**os.environ, "PATH": path, "DATA": str(GAIT)},
                                  capture_output=True, text=True, timeout=LONGEST, check=False)
            self.assertEqual(done.returncode, 0, f"{page}:\n{text}\n{done.stderr}")
            ran += 1
        self.assertGreater(ran, 0)

    def test_import(self):
        self.follow("import.md")

    def test_dataset_file(self):
        self.follow("dataset_file.md")

    def test_envelopes(self):
        self.follow("envelopes.md")

    @unittest.skipUnless(GAIT.is_dir(), f"{GAIT} is not there")
    def test_muscle_geometry(self):
        self.follow("muscle_geometry.md")


if __name__ == "__main__":
    unittest.main()
