"""What the documents say is there is there."""
import pathlib
import re
import textwrap
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


class Docs(unittest.TestCase):
    def test_every_link_leads_somewhere(self):
        for document in DOCUMENTS:
            prose = re.sub(r"```.*?```", "", document.read_text(encoding="utf-8"), flags=re.S)  # code has brackets of its own
            for link in re.findall(r"\]\((?!https?:|#)([^)#]+)", prose):
                self.assertTrue((document.parent / link).exists(), f"{document.name} links {link}")

    def test_every_command_of_the_readme_is_in_the_makefile(self):
        commands = set(re.findall(r"\bmake ([a-z]+)\b", (ROOT / "README.md").read_text(encoding="utf-8")))
        targets = set(re.findall(r"^([a-z]+(?: [a-z]+)*):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))
        known = {name for names in targets for name in names.split()}
        self.assertTrue({"demo", "test"} <= commands, commands)
        self.assertEqual(commands - known, set())

    def test_examples_are_short(self):
        for example in sorted((ROOT / "examples").glob("*.cpp")):
            self.assertLessEqual(len(example.read_text(encoding="utf-8").splitlines()), 60, example.name)

    def test_what_a_page_shows_of_an_example_is_in_the_example(self):
        shown = 0
        for document in DOCUMENTS:
            text = document.read_text(encoding="utf-8")
            for name, block in re.findall(r"examples/(\w+)\.cpp\)[^`]*?```cpp\n(.*?)```", text, re.S):
                shown += 1
                example = (ROOT / "examples" / f"{name}.cpp").read_text(encoding="utf-8")
                self.assertIn(textwrap.indent(block, "    "), example, f"{document.name} shows another {name}.cpp")
        self.assertGreater(shown, 0)

    def test_every_reference_is_whole_and_there_once(self):
        entries = re.findall(r"^@\w+\{(\w+),(.*?)^\}", (ROOT / "docs/references.bib").read_text(encoding="utf-8"), re.M | re.S)
        keys = [key for key, _ in entries]
        self.assertGreater(len(keys), 10)
        self.assertEqual(keys, sorted(set(keys)))
        for key, fields in entries:
            for field in ("author", "title", "year"):
                self.assertRegex(fields, rf"\b{field}\s*= ", f"{key} has no {field}")


if __name__ == "__main__":
    unittest.main()
