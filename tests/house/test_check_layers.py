"""check_layers.py passes what follows the arrows and names every kind of violation."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import check_layers  # noqa: E402


class CheckLayers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)

    def check(self, path, text):
        file = self.root / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
        problems = check_layers.check(self.root)
        file.unlink()
        return problems

    def assert_fine(self, path, text):
        self.assertEqual(self.check(path, text), [])

    def assert_refused(self, path, text, *words):
        problems = self.check(path, text)
        self.assertEqual(len(problems), 1, problems)
        for word in (path, *words):
            self.assertIn(word, problems[0])

    def test_includes_along_the_arrows_pass(self):
        for path, included in [
            ("collision/ray.hpp", "core/pose.hpp"),
            ("broadphase/sap.cpp", "collision/aabb.hpp"),
            ("narrowphase/gjk.cpp", "narrowphase/detail/simplex.hpp"),
            ("dynamics/world.cpp", "narrowphase/collide.hpp"),
            ("viz/frame.cpp", "dynamics/world.hpp"),
            ("viz/vtk/view.cpp", "viz/frame.hpp"),
            ("scenes/pile.cpp", "dynamics/world.hpp"),
            ("cli/view.cpp", "viz/vtk/view.hpp"),
            ("tests/narrowphase/gjk.cpp", "narrowphase/detail/simplex.hpp"),
            ("tests/viz/view.cpp", "viz/vtk/detail/scene.hpp"),
            ("tests/viz_vtk/view.cpp", "viz/vtk/detail/scene.hpp"),
            ("tests/dynamics/stack.cpp", "scenes/scene.hpp"),
            ("core/tbb/tbb_executor.cpp", "core/executor.hpp"),
            ("collision/import/read_mesh.cpp", "collision/mesh_data.hpp"),
        ]:
            self.assert_fine(path, f"#include <carom/{included}>\n")

    def test_includes_against_the_arrows_are_named(self):
        for path, included in [
            ("core/pose.hpp", "collision/aabb.hpp"),
            ("core/executor.cpp", "core/tbb/tbb_executor.hpp"),
            ("collision/mesh_data.cpp", "collision/import/read_mesh.hpp"),
            ("dynamics/world.cpp", "collision/import/read_mesh.hpp"),
            ("collision/ray.hpp", "narrowphase/gjk.hpp"),
            ("broadphase/sap.cpp", "narrowphase/gjk.hpp"),
            ("narrowphase/gjk.cpp", "broadphase/broadphase.hpp"),
            ("dynamics/world.cpp", "scenes/scene.hpp"),
            ("dynamics/detail/solver.cpp", "viz/frame.hpp"),
            ("viz/frame.cpp", "viz/vtk/view.hpp"),
            ("scenes/pile.cpp", "viz/frame.hpp"),
            ("bench/step.cpp", "cli/run.hpp"),
            ("bench/step.cpp", "viz/vtk/view.hpp"),
            ("examples/loop.cpp", "cli/run.hpp"),
            ("tests/dynamics/stack.cpp", "viz/vtk/view.hpp"),
        ]:
            room = included.rsplit("/", 1)[0]
            self.assert_refused(path, f"\n#include <carom/{included}>\n", f":2: ", room)

    def test_private_headers_stay_private(self):
        text = "#include <carom/narrowphase/detail/simplex.hpp>\n"
        for path in ("dynamics/world.cpp", "tests/dynamics/world.cpp", "tests/support/shapes.hpp", "bench/gjk.cpp"):
            self.assert_refused(path, text, "private to narrowphase")

    def test_quoted_includes_are_followed(self):
        (self.root / "scenes").mkdir()
        (self.root / "scenes/scene.hpp").write_text("", encoding="utf-8")
        self.assert_refused("dynamics/world.cpp", '#include "../scenes/scene.hpp"\n', "scenes")
        self.assert_refused("dynamics/world.cpp", '#include "nowhere.hpp"\n', "nowhere.hpp")

    def test_commented_includes_do_not_count(self):
        self.assert_fine("core/pose.hpp", "// #include <carom/dynamics/world.hpp>\n/*\n#include <vtkActor.h>\n*/\n")

    def test_outside_libraries_stay_in_their_rooms(self):
        self.assert_fine("viz/vtk/view.cpp", "#include <vtkRenderer.h>\n")
        self.assert_fine("tests/viz/view.cpp", "#include <vtkPolyData.h>\n")
        self.assert_fine("collision/mass.cpp", "#include <Eigen/Dense>\n")
        self.assert_fine("collision/detail/axes.hpp", "#include <Eigen/Dense>\n")
        self.assert_refused("viz/frame.cpp", "#include <vtkRenderer.h>\n", "VTK")
        self.assert_refused("cli/view.cpp", "#include <vtkRenderer.h>\n", "VTK")
        self.assert_refused("viz/vtk/view.hpp", "#include <vtkRenderer.h>\n", "public")
        self.assert_refused("collision/mass.hpp", "#include <Eigen/Dense>\n", "Eigen")
        self.assert_refused("dynamics/world.cpp", "#include <oneapi/tbb/parallel_for.h>\n", "oneTBB")
        self.assert_refused("scenes/pile.cpp", "#include <CLI/CLI.hpp>\n", "CLI11")

    def test_links_follow_the_same_arrows(self):
        self.assert_fine("dynamics/CMakeLists.txt", "carom_room(dynamics PUBLIC carom::broadphase carom::narrowphase)\n")
        self.assert_fine("tests/CMakeLists.txt", "carom_test(viz LINK carom::viz carom::viz_vtk)\n")
        self.assert_fine("core/CMakeLists.txt", "# target_link_libraries(carom_core PUBLIC carom::dynamics)\n")
        self.assert_refused("collision/CMakeLists.txt", "carom_room(collision\n  PUBLIC carom::dynamics)\n", "dynamics")
        self.assert_refused("bench/CMakeLists.txt", "target_link_libraries(b PRIVATE carom::viz_vtk)\n", "viz/vtk")
        self.assert_refused("core/CMakeLists.txt", "carom_room(core PUBLIC carom::attic)\n", "attic")
        self.assert_refused("viz/CMakeLists.txt", "carom_room(viz PUBLIC carom::dynamics VTK::CommonCore)\n", "VTK")
        self.assert_refused("cli/CMakeLists.txt", "find_package(VTK 9.1 REQUIRED)\n", "VTK")
        self.assert_fine("viz/vtk/CMakeLists.txt", "find_package(VTK 9.1)\ncarom_room(viz_vtk PRIVATE ${VTK_LIBRARIES})\n")


if __name__ == "__main__":
    unittest.main()
