"""What the compiler does not see because it reads one file at a time.

    /usr/bin/python3 -B -m unittest discover -s tests/cli -p test_sources.py
"""
import collections
import re
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("base", "datasets", "models", "identify", "problems", "cli")
ANONYMOUS = re.compile(r"^namespace \{\n.*?^\}  // namespace$", re.DOTALL | re.MULTILINE)
NAMESPACE = re.compile(r"^namespace ([\w:]+) \{", re.MULTILINE)
TYPE = re.compile(r"^(?:class|struct|enum class|enum) (?:\[\[\w+\]\] )?(\w+)(?: final)?(?: :[^;{]*)? \{", re.MULTILINE)


def sources():
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                yield path


class Sources(unittest.TestCase):
    # Two types of one name in one namespace break the one-definition rule: the linker keeps the functions of one of them,
    # and the program crashes where it uses the other.
    def test_every_type_is_defined_once_in_its_namespace(self):
        places = collections.defaultdict(set)
        for path in sources():
            text = ANONYMOUS.sub("", path.read_text())
            namespace = (NAMESPACE.findall(text) or [""])[0]
            for name in TYPE.findall(text):
                places[namespace, name].add(str(path.relative_to(ROOT)))
        self.assertGreater(len(places), 300)
        twice = {name: files for name, files in places.items() if len(files) > 1}
        self.assertEqual(twice, {})

    # Sentences for people are made in one folder, from facts, and nothing reads them again.
    def test_nothing_outside_identify_text_parses_a_sentence(self):
        reading = re.compile(r"(?:sentence|finding|warning|text)s?(?:\[\w*\])?(?:\.text)?\.(?:find|rfind|compare)\(\"[^\"]* ")
        found = [f"{path.relative_to(ROOT)}: {line.strip()}" for path in sources()
                 for line in path.read_text().splitlines() if reading.search(line)]
        self.assertEqual(found, [])

    def test_every_module_of_tests_is_run(self):
        listed = set(re.findall(r"\w+", (ROOT / "tests/cli/CMakeLists.txt").read_text()))
        modules = [path.stem for path in sorted((ROOT / "tests/cli").rglob("test_*.py"))]
        self.assertGreater(len(modules), 40)
        self.assertEqual([name for name in modules if name not in listed and name[5:] not in listed], [])


if __name__ == "__main__":
    unittest.main()
