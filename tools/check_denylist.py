#!/usr/bin/env python3
"""Checks for what must not be in the tree.

    tools/check_denylist.py [ROOT]

1. In the rooms whose results are the same bits everywhere (core, collision, broadphase, narrowphase, dynamics): functions
   whose result depends on the standard library, on the compiler or on hash order. Comments and strings do not count.
2. Anywhere: paths of somebody's machine and words that mark unfinished work.

Prints one line for each violation, `file:line: what`, and ends with exit code 1 if there is any.
"""
import os
import pathlib
import re
import sys

STEP_ROOMS = ("core", "collision", "broadphase", "narrowphase", "dynamics")
SOURCES = {".hpp", ".cpp", ".h", ".inl", ".ipp"}
NOT_OURS = {".git", "build", "out", ".cache", "__pycache__"}

ELEMENTARY = r"a?(?:sin|cos|tan)h?|sincos|atan2|pow|exp2?|expm1|log(?:2|10|1p)?|cbrt|hypot|[lt]gamma|erfc?"
STEP_CODE = [
    (rf"\b(?:std|glm)\s*::\s*(?:{ELEMENTARY})[fl]?\b", "elementary functions differ between libraries: core/math.hpp"),
    (rf"(?<![\w.>:])(?:::\s*)?(?:{ELEMENTARY})[fl]?\s*\((?=[^)\s])", "elementary functions differ between libraries: core/math.hpp"),
    (r"\bglm\s*::\s*(?:slerp|angleAxis|axis|angle|eulerAngles|pitch|yaw|roll|fastInverseSqrt)\b",
     "uses elementary functions of the library inside: core/math.hpp"),
    (r"\bstd\s*::\s*(?:ranges\s*::\s*)?(?:sort|nth_element|partial_sort|partition)\b",
     "leaves equal elements in any order: std::stable_sort, or core/radix_sort.hpp inside a step"),
    (r"\bstd\s*::\s*unordered_\w+", "iterates in hash order"),
    (r"\bstd\s*::\s*(?:reduce|transform_reduce|execution)\b", "adds in any order"),
    (r"\b(?:std\s*::\s*|__builtin_)?fma[fl]?\s*\(", "fuses: bits differ between machines"),
    (r"\b(?:Neg)?Mul(?:Add|Sub)\w*\s*\(", "fuses where it can: use Mul and Add"),
    (r"\b_mm\d*_\w*(?:fn?m(?:add|sub)|rcp|rsqrt)\w*", "fuses or approximates: bits differ between machines"),
    (r"\bApproximateReciprocal\w*", "approximates: bits differ between machines"),
    (r"\bs?rand(?:_r)?\s*\(|\b[dlm]rand48\b|\bstd\s*::\s*(?:random\w*|mt19937\w*|minstd\w*|default_random_engine|\w+_distribution)\b",
     "not the same numbers everywhere: core/random.hpp"),
]
BUILD_FILES = [
    (r"-(?:ffast-math|Ofast|funsafe-math-optimizations|fassociative-math|freciprocal-math|march=|mfma)\b",
     "changes bits or ties the build to one machine"),
]
# Written so that this file does not match itself.
ANYWHERE = [
    (r"\b(?:TO[D]O|FIX[M]E|XX[X]|HAC[K])\b|(?i:\bnot (?:yet )?implemente[d]\b)|\bDISABLE[D]_\w", "unfinished"),
    (r"(?<![\w.])/(?:wor[k]|roo[t]|hom[e]|User[s])/\w|\bC:\\User[s]\b|bash_job[s]", "path of a machine"),
    (r"\.\./share[d]\b", "path outside the project"),
]
EXCEPTIONS = {
    ".ci/run": {"path outside the project"},  # CI alone knows what lies beside its checkout
    "core/lanes_fused.hpp": {"fuses where it can: use Mul and Add"},  # fuses on every target, by hand where it must
}


def strip_comments_and_strings(text):
    """Blanks comments, strings and character literals; every line stays where it is."""
    token = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"' r"|(?<!\w)'(?:\\.|[^'\\\n])+'", re.S)
    return token.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)


def find(rules, text, relative):
    for pattern, why in rules:
        if why in EXCEPTIONS.get(relative, ()):
            continue
        for match in re.finditer(pattern, text):
            line = text.count("\n", 0, match.start()) + 1
            yield line, f"{relative}:{line}: `{match.group().strip()}`: {why}"


def check_file(root, path):
    """Violations of one file, in order of lines."""
    relative = path.relative_to(root).as_posix()
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return []
    found = list(find(ANYWHERE, text, relative))
    if path.suffix in SOURCES and relative.startswith(tuple(room + "/" for room in STEP_ROOMS)):
        found += find(STEP_CODE, strip_comments_and_strings(text), relative)
    if path.name in ("CMakeLists.txt", "CMakePresets.json", "Makefile") or path.suffix == ".cmake":
        found += find(BUILD_FILES, text, relative)
    return [message for _, message in sorted(found)]


def files(root):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in NOT_OURS)
        yield from (pathlib.Path(folder, name) for name in sorted(names) if name not in NOT_OURS)


def check(root):
    """All violations below `root`, sorted by file."""
    root = pathlib.Path(root).resolve()
    return [problem for path in files(root) for problem in check_file(root, path)]


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    problems = check(root)
    print("\n".join(problems) if problems else "deny-list: nothing found")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
