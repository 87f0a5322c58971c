"""check_denylist.py names what it is there for, and only that."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import check_denylist  # noqa: E402


class CheckDenylist(unittest.TestCase):
    def check(self, path, text):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, path)
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text, encoding="utf-8")
            return check_denylist.check(folder)

    def test_calls_that_change_bits_are_named(self):
        for call in [
            "std::sin(x)", "std::cosf(x)", "std::atan2(y, x)", "std :: pow(x, 2)", "glm::exp(x)", "return sin(x);", "::cosf(x)",
            "glm::angleAxis(a, v)", "glm::slerp(p, q, t)", "std::sort(a, b)", "std::ranges::sort(a)", "std::nth_element(a, b, c)",
            "std::unordered_map<int, int> m", "std::reduce(a, b)", "std::fma(a, b, c)", "fmaf(a, b, c)", "__builtin_fma(a, b, c)",
            "hn::MulAdd(a, b, c)", "NegMulAdd(a, b, c)", "hn::MulSub(a, b, c)", "_mm_rcp_ps(x)", "_mm256_rsqrt_ps(x)",
            "_mm256_fmadd_ps(a, b, c)", "hn::ApproximateReciprocal(x)", "ApproximateReciprocalSqrt(x)", "rand()", "std::rand()",
            "srand(1)", "std::random_device d", "std::mt19937 g", "std::uniform_real_distribution<double> u",
        ]:
            for room in check_denylist.STEP_ROOMS:
                with self.subTest(call=call, room=room):
                    problems = self.check(f"{room}/detail/x.cpp", f"\nvoid f() {{ {call}; }}\n")
                    self.assertTrue(problems, "nothing found")
                    self.assertIn(f"{room}/detail/x.cpp:2", problems[0])

    def test_what_only_looks_alike_passes(self):
        for text in [
            "carom::sin_cos(x)", "Random random(7)", "sc.sin = 1", "auto [sin, cos] = sin_cos(a)", "std::stable_sort(a, b)", "radix_sort(keys)",
            "std::sqrt(x)", "hn::Mul(a, b)", "brand(x)", "operand(x)", "std::map<int, int> m", "Mul(Add(a, b), c)", "std::expected",
            "// std::sin would differ between libraries", "/* rand() */", 'report("std::sort is refused")', "std::log_level x",
        ]:
            with self.subTest(text=text):
                self.assertEqual(self.check("core/x.cpp", text + "\n"), [])

    def test_other_rooms_may_call_them(self):
        self.assertEqual(self.check("studies/oracle/pendulum.cpp", "double f(double x) { return std::sin(x); }\n"), [])

    def test_code_after_a_string_with_quotes_still_counts(self):
        self.assertEqual(len(self.check("core/x.cpp", 'f("a \\" b"); std::sort(a, b);\n')), 1)
        self.assertEqual(len(self.check("core/x.cpp", "g('\"'); rand();\n")), 1)
        self.assertEqual(len(self.check("core/x.cpp", "int n = 1'000'000; rand(); int m = 1'0;\n")), 1)

    def test_unfinished_words_are_named_everywhere(self):
        for word in ["TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK", "not " + "implemented", "DISABLED" + "_Stack"]:
            for path in ["docs/a.md", "core/a.hpp", "tests/a.cpp", "Makefile", "tools/a.py"]:
                with self.subTest(word=word, path=path):
                    self.assertEqual(len(self.check(path, f"one\n# {word}: later\n")), 1)

    def test_machine_paths_are_named_everywhere(self):
        for name in ["/ho" + "me/ada/carom", "/ro" + "ot/x", "/wo" + "rk/main", "../sha" + "red/ccd"]:
            with self.subTest(name=name):
                self.assertEqual(len(self.check("docs/a.md", f"see {name}\n")), 1)
        self.assertEqual(self.check("docs/a.md", "https://example.org/home/page and network/x\n"), [])

    def test_flags_that_change_bits_are_named(self):
        for flag in ["-ffast" + "-math", "-march" + "=native", "-O" + "fast"]:
            with self.subTest(flag=flag):
                self.assertEqual(len(self.check("core/CMakeLists.txt", f"target_compile_options(x PRIVATE {flag})\n")), 1)

    def test_what_is_built_is_not_read(self):
        self.assertEqual(self.check("build/release/x.md", "TO" + "DO\n"), [])


if __name__ == "__main__":
    unittest.main()
