#!/usr/bin/env python3
"""Checks that the rooms follow the layering: includes and CMake links go along the arrows and nowhere else.

    tools/check_layers.py [ROOT]

    core -> collision -> {broadphase, narrowphase} -> dynamics -> viz -> {viz/png, viz/vtk}
    scenes on dynamics; studies, cli, bench, tests and examples on top

Prints one line for each violation, `file:line: what`, and ends with exit code 1 if there is any.
"""
import pathlib
import re
import sys

COLLISION = {"core", "collision"}
DYNAMICS = COLLISION | {"broadphase", "narrowphase", "dynamics"}
LIBRARIES = DYNAMICS | {"core/tbb", "collision/import", "viz", "scenes"}
TOP = LIBRARIES | {"studies"}

# What each room may include besides itself. The longest prefix of a file's path decides its room.
ALLOWED = {
    "core": set(),
    "core/tbb": {"core"},
    "collision": {"core"},
    "collision/import": {"core", "collision"},
    "broadphase": COLLISION,
    "narrowphase": COLLISION,
    "dynamics": DYNAMICS,
    "viz": DYNAMICS,
    "viz/png": DYNAMICS | {"viz"},
    "viz/vtk": DYNAMICS | {"viz"},
    "scenes": DYNAMICS,
    "studies": LIBRARIES,
    "cli": TOP | {"viz/png", "viz/vtk"},
    "bench": TOP,
    "examples": LIBRARIES,
    "tests": TOP,
    "tests/bench": TOP | {"bench"},
    "tests/cli": TOP | {"cli"},
    "tests/viz": TOP | {"viz/png", "viz/vtk"},
    "tests/viz_vtk": TOP | {"viz/vtk"},
    "tests/link": TOP | {"viz/png", "viz/vtk"},
    "tests/consumer": LIBRARIES | {"viz/vtk"},
}

# Libraries from outside, by the header's name: the rooms that may include them, and whether a public header may.
OUTSIDE = [
    (re.compile(r"vtk[A-Z]\w*\.h$"), {"viz/vtk", "tests/viz", "tests/viz_vtk"}, "VTK", False),
    (re.compile(r"(Eigen|unsupported)/"), {"*"}, "Eigen", False),
    (re.compile(r"(oneapi/)?tbb/"), {"core/tbb"}, "oneTBB", False),
    (re.compile(r"CLI/"), {"cli", "bench"}, "CLI11", False),
    (re.compile(r"png\.h$"), {"viz/png"}, "libpng", False),
]

INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"]+)[>"]', re.M)
LINK = re.compile(r"\b(carom_room|carom_test|carom_program|target_link_libraries)\s*\(([^)]*)\)", re.I)
SOURCES = {".hpp", ".cpp", ".h", ".inl", ".ipp"}


def room_of(path):
    """The room that owns a path relative to the root: viz/vtk/viewer.cpp -> viz/vtk, tests/core/hash.cpp -> tests/core.

    None outside every room. Each folder of tests/ is a room of its own.
    """
    folders = path.split("/")[:-1]
    if folders[:1] == ["tests"]:
        return "/".join(folders[:2])
    for length in range(len(folders), 0, -1):
        name = "/".join(folders[:length])
        if name in ALLOWED:
            return name
    return None


def allowed(room):
    """The rooms that `room` may include besides itself."""
    return ALLOWED.get(room, ALLOWED["tests"])


def check_project_include(room, target):
    """What is wrong with a file of `room` including the project's file `target` (relative to the root), or None."""
    owner = room_of(target)
    if owner is None:
        return f"{target} is in no room"
    tests = (f"tests/{owner.split('/')[0]}", f"tests/{owner.replace('/', '_')}")
    if "/detail/" in target and room != owner and room not in tests:
        return f"{target} is private to {owner} and its tests"
    both_tests = room.startswith("tests") and owner.startswith("tests")
    if owner == room or owner in allowed(room) or both_tests:
        return None
    return f"{room} must not include {owner}"


def check_outside_include(room, header, public):
    for pattern, rooms, name, in_public in OUTSIDE:
        if not pattern.match(header):
            continue
        if "*" not in rooms and room not in rooms:
            return f"{name} belongs to {', '.join(sorted(rooms))} only"
        if public and not in_public:
            return f"{name} must stay out of public headers"
    return None


def check_source(root, path):
    relative = path.relative_to(root).as_posix()
    room = room_of(relative)
    if room is None:
        return
    public = path.suffix == ".hpp" and "/detail/" not in relative and not room.startswith(("tests", "cli", "bench"))
    text = strip_comments(path.read_text(encoding="utf-8"))
    for match in INCLUDE.finditer(text):
        kind, header = match.groups()
        if header.startswith("carom/"):
            problem = check_project_include(room, header[len("carom/"):])
        elif kind == '"':
            target = resolve_quoted(root, path, header)
            problem = check_project_include(room, target) if target else f'"{header}" is not in the project'
        else:
            problem = check_outside_include(room, header, public)
        if problem:
            yield f"{relative}:{text.count(chr(10), 0, match.start(2)) + 1}: {problem}"


def resolve_quoted(root, path, header):
    for base in (path.parent, root / "tests", root):
        candidate = (base / header).resolve()
        if candidate.is_file() and candidate.is_relative_to(root):
            return candidate.relative_to(root).as_posix()
    return None


def check_links(root, path):
    """A CMakeLists.txt may link the targets of the rooms its own room may include; carom::viz_vtk is the room viz/vtk."""
    relative = path.relative_to(root).as_posix()
    room = room_of(relative)
    if room is None:
        return
    text = re.sub(r"#[^\n]*", lambda m: " " * len(m.group()), path.read_text(encoding="utf-8"))
    names_every_test = relative == "tests/CMakeLists.txt"  # the links of each folder below it, tests/viz too
    for call in LINK.finditer(text):
        line = text.count("\n", 0, call.start()) + 1
        for target in re.findall(r"carom::(\w+)", call.group(2)):
            linked = target_room(target)
            if linked is None:
                yield f"{relative}:{line}: carom::{target} is no room"
            elif linked != room and linked not in allowed(room) and not (names_every_test and linked.startswith("viz/")):
                yield f"{relative}:{line}: {room} must not link {linked}"
    for use in re.finditer(r"VTK::|VTK_LIBRARIES|find_package\s*\(\s*VTK", text):
        if room not in ("viz/vtk", "tests/viz", "tests/viz_vtk") and not names_every_test:
            yield f"{relative}:{text.count(chr(10), 0, use.start()) + 1}: VTK belongs to viz/vtk only"


def target_room(target):
    """viz_vtk -> viz/vtk; studies_oracle -> studies, which has targets of its own but one set of rights."""
    for name in ALLOWED:
        if name.replace("/", "_") == target:
            return name
    return "studies" if target.startswith("studies_") else None


def strip_comments(text):
    """Blanks comments and keeps every line where it is."""
    def blank(match):
        token = match.group()
        return re.sub(r"[^\n]", " ", token) if token.startswith("/") else token
    return re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', blank, text, flags=re.S)


def check(root):
    """All violations below `root`, sorted by file."""
    root = pathlib.Path(root).resolve()
    problems = []
    for top in sorted({name.split("/")[0] for name in ALLOWED}):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in SOURCES:
                problems += check_source(root, path)
            elif path.name == "CMakeLists.txt":
                problems += check_links(root, path)
    return problems


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent
    problems = check(root)
    print("\n".join(problems) if problems else "layers: every include and link follows the arrows")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
