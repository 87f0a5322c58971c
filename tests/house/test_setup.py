"""setup.sh installs only what is missing, uses sudo only where it must, and says what it does.

Runs it with a PATH of our own programs in place of dpkg-query, apt-get, sudo and id; each writes its call to a log.
"""
import pathlib
import shutil
import subprocess
import tempfile
import unittest

SETUP = pathlib.Path(__file__).resolve().parents[2] / "tools/setup.sh"


class Setup(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.bin = pathlib.Path(folder.name, "bin")
        self.bin.mkdir()
        self.log = pathlib.Path(folder.name, "log")
        for name in ("bash", "env", "mktemp", "rm", "tail"):
            (self.bin / name).symlink_to(shutil.which(name))

    def program(self, name, script):
        file = self.bin / name
        file.write_text(f'#!/bin/bash\necho "{name} $*" >>"{self.log}"\n{script}\n', encoding="utf-8")
        file.chmod(0o755)

    def debian(self, installed, user=0):
        """A Debian where the packages of the case pattern `installed` are there."""
        self.program("dpkg-query", f'case "${{@: -1}}" in {installed}) printf "ii " ;; *) exit 1 ;; esac')
        self.program("apt-get", "exit 0")
        self.program("id", f"echo {user}")

    def run_setup(self, *groups):
        result = subprocess.run([SETUP, *groups], env={"PATH": str(self.bin)}, capture_output=True, text=True, timeout=60)
        calls = self.log.read_text(encoding="utf-8").splitlines() if self.log.exists() else []
        return result, [call for call in calls if not call.startswith(("dpkg-query", "id "))]

    def test_nothing_missing_runs_nothing(self):
        self.debian("*")
        result, calls = self.run_setup("base", "tests", "viz", "bench", "peers")
        self.assertEqual((result.returncode, result.stdout, calls), (0, "", []))

    def test_only_the_missing_are_installed_and_said(self):
        self.debian("cmake|g++|libglm-dev|make|pkg-config|python3|lib[e-z]*|nlohmann*|libboost-dev|libcli11-dev")
        result, calls = self.run_setup("base")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(len(calls), 2, calls)
        self.assertTrue(calls[0].endswith(" update"), calls)
        self.assertTrue(calls[1].endswith("install --no-install-recommends ninja-build"), calls)
        self.assertIn("apt-get install --no-install-recommends ninja-build", result.stdout)
        self.assertNotIn("sudo", result.stdout)

    def test_sudo_only_where_not_root(self):
        self.debian("none", user=1000)
        self.program("sudo", 'exec "$@"')
        result, calls = self.run_setup("bench")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([call.split()[0] for call in calls], ["sudo", "apt-get"] * 2)
        self.assertIn("setup: sudo apt-get install", result.stdout)

    def test_neither_root_nor_sudo_says_what_to_run(self):
        self.debian("none", user=1000)
        result, calls = self.run_setup("bench")
        self.assertEqual((result.returncode, calls), (1, []))
        self.assertIn("apt-get install --no-install-recommends libbenchmark-dev", result.stderr)

    def test_a_failing_install_fails_and_names_the_packages(self):
        self.debian("none")
        self.program("apt-get", 'echo "E: Unable to locate"; exit 100')
        result, _ = self.run_setup("bench")
        self.assertEqual(result.returncode, 1)
        self.assertIn("Unable to locate", result.stderr)
        self.assertIn("libbenchmark-dev", result.stderr)

    def test_another_system_gets_the_list_and_goes_on(self):
        result, calls = self.run_setup("base", "bench")
        self.assertEqual((result.returncode, calls), (0, []))
        self.assertIn("libglm-dev", result.stdout)
        self.assertIn("libbenchmark-dev", result.stdout)

    def test_without_viz_no_vtk(self):
        result, _ = self.run_setup("base", "tests", "bench", "peers")
        self.assertNotIn("vtk", result.stdout)

    def test_an_unknown_group_is_refused(self):
        self.debian("*")
        result, _ = self.run_setup("kitchen")
        self.assertEqual(result.returncode, 2)
        self.assertIn("kitchen", result.stderr)


if __name__ == "__main__":
    unittest.main()
