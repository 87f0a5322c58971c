"""Other people's projects use Carom, installed and as a folder, and get no flag, test or program of ours with it.

Run by ctest, which says where the build is: CAROM_SOURCE, CAROM_BUILD, CAROM_ROOMS (the installed rooms), CXX, CC.
"""
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import unittest

HERE = pathlib.Path(__file__).resolve().parent
SOURCE = os.environ["CAROM_SOURCE"]
ROOMS = os.environ["CAROM_ROOMS"].split()
# Flags that change a user's warnings, floating-point results, target machine, checks or debug output.
OURS = re.compile(r"-(W|f|m|O|pedantic|DCAROM|DNDEBUG)")
OPTIONAL_PACKAGES = ("Eigen3", "TBB", "VTK", "PNG", "Boost", "fmt", "nlohmann_json", "CLI11", "GTest")


def leaked(command):
    """The flags of a compile command that a user did not ask for."""
    return [word for word in shlex.split(command)[1:] if OURS.match(word)]


class Consumer(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(os.environ["CAROM_BUILD"], "consumer")  # always the same place, so that ccache knows it
        shutil.rmtree(cls.folder, ignore_errors=True)
        cls.prefix = cls.folder / "prefix"
        cls.run_program("cmake", "--install", os.environ["CAROM_BUILD"], "--prefix", cls.prefix)

    @staticmethod
    def run_program(*command, check=True):
        result = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600)
        if check and result.returncode != 0:
            raise AssertionError(f"{command} failed:\n{result.stdout}\n{result.stderr}")
        return result

    def configure(self, name, project, *options, check=True):
        build = self.folder / name
        return build, self.run_program(
            "cmake", "-G", "Ninja", "-S", HERE / project, "-B", build, "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON",
            f"-DCMAKE_PREFIX_PATH={self.prefix}", *options, check=check)

    def configure_installed(self, name, rooms, *options, check=True):
        return self.configure(name, "installed", f"-DROOMS={';'.join(rooms)}", *options, check=check)

    def build_and_run(self, build, program):
        self.run_program("cmake", "--build", build, "--target", program)
        self.run_program(build / program)

    def compile_commands(self, build):
        entries = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
        return {pathlib.Path(entry["file"]).resolve(): entry["command"] for entry in entries}

    def test_one_room_needs_no_package_of_another(self):
        without = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{package}=TRUE" for package in OPTIONAL_PACKAGES]
        build, _ = self.configure_installed("rays", ["collision"], *without)
        self.build_and_run(build, "rays")
        for command in self.compile_commands(build).values():
            self.assertEqual(leaked(command), [])

    def test_every_room_is_found(self):
        build, _ = self.configure_installed("all", ROOMS)
        self.build_and_run(build, "fall")
        for command in self.compile_commands(build).values():
            self.assertEqual(leaked(command), [])

    def test_no_components_means_every_room(self):
        build, _ = self.configure_installed("default", [])
        self.run_program("cmake", "--build", build, "--target", "help")

    def test_an_unknown_room_is_named(self):
        _, result = self.configure_installed("attic", ["collision", "attic"], check=False)
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("no component 'attic'", re.sub(r"\s+", " ", result.stderr))

    def test_private_headers_are_not_installed(self):
        headers = list((self.prefix / "include/carom").rglob("*.hpp"))
        self.assertGreater(len(headers), 10)
        self.assertEqual([header for header in headers if "detail" in header.parts], [])

    def test_a_folder_of_ones_own(self):
        build, _ = self.configure("included", "included", f"-DCAROM_SOURCE={SOURCE}")
        self.build_and_run(build, "rays")
        commands = self.compile_commands(build)
        self.assertEqual(leaked(commands[HERE / "rays.cpp"]), [])
        for file, command in commands.items():
            if file != HERE / "rays.cpp":
                self.assertIn("-ffp-contract=off", command, file)  # ours alone: the same bits in every project
                self.assertNotRegex(command, r" -(W\w|m\w|fsanitize)", file)

        targets = self.run_program("ninja", "-C", build, "-t", "targets", "all").stdout
        self.assertNotRegex(targets, r"(?m)\b(test|link|example)_\w+\.dir|^carom: |\bGTest|\bscenes\b|viz_vtk")
        self.run_program("cmake", "--install", build, "--prefix", self.folder / "included_prefix")
        self.assertFalse((self.folder / "included_prefix").exists(), "a project that includes us installs nothing of ours")
        self.assertIn("No tests were found", self.run_program("ctest", "--test-dir", build, "-N").stdout
                      + self.run_program("ctest", "--test-dir", build).stderr)

    def test_a_leak_would_be_seen(self):
        clean = "/usr/bin/c++ -I/opt/carom/include -isystem /opt/glm -g -std=gnu++20 -o rays.o -c rays.cpp"
        self.assertEqual(leaked(clean), [])
        for flag in ("-Wall", "-Werror", "-ffp-contract=off", "-march=native", "-fsanitize=address", "-DCAROM_ENABLE_ASSERT"):
            self.assertEqual(leaked(f"{clean} {flag}"), [flag])


if __name__ == "__main__":
    unittest.main(verbosity=2)
