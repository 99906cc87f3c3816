#!/usr/bin/env python3
"""Laws of the source tree, read off the sources themselves: house.py LAW SOURCE [BUILD]

layers    Rooms include what layers.csv lets them, and no file or room includes itself by a detour.
pairs     What x.h declares is defined in x.cpp, and every x.cpp has an x.h.
types     No two headers define a type of the same name: rooms share one namespace.
rooms     Folders have at most 45 files and a README.md that begins with a heading.
lines     Lines have at most 100 columns, and casts are rare.
format    The formatter has nothing to change.
includes  A header includes the standard header of every std:: name that it uses.
headers   Every header that is installed compiles by itself.

Prints a line `file:line: what` for each break, and ends 1 where there is one.
"""
import collections
import concurrent.futures
import csv
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

TOPS = ("anatomy", "morph", "skinning", "viewer", "app")
MOST_FILES = 45
MOST_COLUMNS = 100
MOST_CASTS = 8  # per 1,000 lines
SKIPPED = 77  # exit code: what the law needs is not installed


def sources(root, tops=TOPS, endings=(".h", ".cpp")):
    """Paths relative to root, in order."""
    found = []
    for top in tops:
        found += [p.relative_to(root) for p in (root / top).rglob("*") if p.suffix in endings]
    return sorted(found)


def stem(path):
    return str(path.with_suffix(""))


def includes(root):
    """(file, line, included path) of every include of ours."""
    for path in sources(root):
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            found = re.match(r'#include "([^"]+/[^"]+)"', line)
            if found:
                yield path, number, pathlib.Path(found[1])


def cycles(edges):
    """Strongly connected components of more than one node (Tarjan)."""
    sys.setrecursionlimit(10000)
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(edges[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            at = stack.index(node)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for node in sorted(edges):
        if node not in index:
            visit(node)
    return found


def read_layers(root):
    layers = {}
    with open(root / "tests/house/layers.csv") as file:
        for row in csv.DictReader(line for line in file if not line.startswith("#")):
            layers[row["room"]] = set(row["may_include"].split())
    return layers


def check_layers(root):
    allowed = read_layers(root)
    seen = []
    for room, may in allowed.items():
        for other in sorted(may):
            if other not in seen:
                yield f"tests/house/layers.csv: {room} includes {other}, which does not stand above it"
        seen.append(room)
    edges = collections.defaultdict(set)
    for path, number, included in includes(root):
        if not (root / included).exists():
            yield f"{path}:{number}: there is no {included}"
            continue
        if stem(path) != stem(included):
            edges[stem(path)].add(stem(included))
            edges[stem(included)]
        room, other = str(path.parent), str(included.parent)
        if room not in allowed:
            yield f"{path}:{number}: tests/house/layers.csv does not know the room {room}"
        elif other != room and other not in allowed[room]:
            yield f"{path}:{number}: {room} may not include {other} (tests/house/layers.csv)"
    for knot in cycles(edges):
        yield f"{knot[0]}: files include each other by a detour: {' '.join(knot)}"


# at the left edge: not within another type
TYPE = re.compile(r"(?:template <.*> )?(?:struct|class|enum class) (?:alignas\([^)]*\) )?(\w+)\b[^;]*\{")
FUNCTION = re.compile(r"^(?!namespace|using|struct|class|enum|typedef|template|extern|return|else)"
                      r"[A-Za-z_][\w:<>,&*\[\] ]*?[ &*]((?:\w+::)?\w+|operator\S+)\(")


def statements(text):
    """Top-level statements of formatted text outside anonymous namespaces: (line, text to ; or {)."""
    lines = text.splitlines()
    inside = hidden = False
    number = 0
    while number < len(lines):
        line = lines[number]
        if line.startswith("namespace {"):
            hidden = True
        elif line.startswith("}  // namespace") and hidden:
            hidden = False
        elif not hidden and FUNCTION.match(line) or (not hidden and line.startswith("inline ")):
            begin, whole = number, line
            while not re.search(r"[;{}]\s*(//.*)?$", whole) and number + 1 < len(lines):
                number += 1
                whole += " " + lines[number].strip()
            yield begin + 1, whole
        number += 1


def check_pairs(root):
    defined = collections.defaultdict(set)
    for path in sources(root, endings=(".cpp",)):
        for _, text in statements((root / path).read_text()):
            name = FUNCTION.match(text)
            if name and re.search(r"\)[^;{]*\{", text):
                defined[name[1]].add(stem(path))
        if not (root / path).with_suffix(".h").exists() and not path.name.endswith("main.cpp"):
            yield f"{path}:1: has no header of its name"
    for path in sources(root, endings=(".h",)):
        for number, text in statements((root / path).read_text()):
            name = FUNCTION.match(text)
            if not name or text.startswith("inline") or not re.search(r"\)[^(]*;\s*(//.*)?$", text):
                continue
            places = defined[name[1]]
            if places and stem(path) not in places:
                yield f"{path}:{number}: {name[1]} is defined in {', '.join(sorted(places))}.cpp"


def check_types(root):
    first = {}
    for path in sources(root, endings=(".h",)):
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            name = TYPE.match(line)
            if not name:
                continue
            other = first.setdefault(name[1], path)
            if other != path:
                yield f"{path}:{number}: {name[1]} is defined in {other}, too"


def check_rooms(root):
    for top in TOPS:
        for folder in [root / top, *(p for p in (root / top).rglob("*") if p.is_dir())]:
            files = [p for p in folder.iterdir() if p.is_file()]
            name = folder.relative_to(root)
            if len(files) > MOST_FILES:
                yield f"{name}: {len(files)} files in one folder"
            readme = folder / "README.md"
            if not readme.exists():
                yield f"{name}: has no README.md"
            elif not readme.read_text().startswith("# "):
                yield f"{name}/README.md: does not begin with a heading"


def check_lines(root):
    lines = casts = 0
    for path in sources(root, TOPS + ("tests",)):
        if path.parts[:2] == ("tests", "corpus"):
            continue
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            lines += 1
            casts += line.count("static_cast<")
            if len(line) > MOST_COLUMNS:
                yield f"{path}:{number}: {len(line)} columns"
    print(f"{lines} lines, {1000 * casts / lines:.2f} static_cast in 1,000")
    if casts > MOST_CASTS * lines / 1000:
        yield f"{casts} casts in {lines} lines"


def check_format(root):
    program = shutil.which("clang-format-14")
    if program is None:
        raise SystemExit(SKIPPED)
    files = [str(p) for p in sources(root, TOPS + ("tests",)) if p.parts[:2] != ("tests", "corpus")]

    def first_difference(file):
        ours = (root / file).read_text()
        run = subprocess.run([program, file], cwd=root, text=True, capture_output=True)
        pairs = zip(ours.splitlines(), run.stdout.splitlines())
        different = (n for n, (a, b) in enumerate(pairs, 1) if a != b)
        return None if run.stdout == ours else f"{file}:{next(different, 1)}: not as the formatter has it"

    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        yield from (found for found in pool.map(first_difference, files) if found)


# Names that a header may use by way of another header of the same row are not looked for.
STANDARD = {
    "array": r"std::array\b", "atomic": r"std::atomic\b", "chrono": r"std::chrono\b",
    "cstddef": r"std::(size_t|ptrdiff_t|byte)\b", "cstdint": r"std::u?int(8|16|32|64)_t\b",
    "deque": r"std::deque\b", "exception": r"std::exception\b", "filesystem": r"std::filesystem\b",
    "functional": r"std::function\b", "initializer_list": r"std::initializer_list\b",
    "iosfwd|iostream|ostream|istream|fstream|sstream": r"std::(istream|ostream)\b", "map": r"std::map\b",
    "memory": r"std::(unique_ptr|shared_ptr|make_unique|make_shared)\b", "mutex": r"std::mutex\b",
    "optional": r"std::(optional|nullopt)\b", "set": r"std::set\b", "span": r"std::span\b",
    "stdexcept": r"std::(runtime_error|invalid_argument|logic_error)\b",
    "string": r"std::(string|to_string)\b", "string_view": r"std::string_view\b",
    "tuple": r"std::tuple\b", "unordered_map": r"std::unordered_map\b",
    "utility": r"std::(pair|move|forward|exchange)\b", "variant": r"std::variant\b",
    "vector": r"std::vector\b", "cmath": r"std::(sqrt|abs|cos|sin|pow|exp|floor|hypot)\(",
    "algorithm": r"std::(min|max|clamp|sort|fill|copy)\(", "limits": r"std::numeric_limits\b",
    "numbers": r"std::numbers\b",
}


def check_includes(root):
    for path in sources(root, endings=(".h",)):
        text = (root / path).read_text()
        code = re.sub(r"//.*", "", text)
        for header, names in STANDARD.items():
            used = re.search(names, code)
            if used and not re.search(rf"#include <({header})>", text):
                number = code[:used.start()].count("\n") + 1
                yield f"{path}:{number}: uses {used[0]} without <{header}>"


def uses_eigen(root, header):
    return "Eigen::" in re.sub(r"//.*", "", (root / header).read_text())


def includes_eigen(root, header, seen):
    """Whether a header includes one of Eigen's, by way of others of ours too."""
    seen.add(header)
    text = (root / header).read_text()
    ours = set(re.findall(r'#include "([^"]+/[^"]+)"', text)) - seen
    return "#include <Eigen/" in text or any(includes_eigen(root, other, seen) for other in ours)


def check_headers(root, build):
    """Standard headers and Eigen's come precompiled, for speed; who includes them is read. Every
    third is compiled, or all where ECORCHE_THOROUGH is set."""
    commands = json.loads((build / "compile_commands.json").read_text())
    words = shlex.split(next(c["command"] for c in commands if "anatomy.dir" in c["command"]))
    flags = [w for w in words if re.match(r"-(I|std|D|m|W)", w) and w != "-Winvalid-pch"]
    flags += ["-isystem", "/usr/include/eigen3"]
    headers = (build / "installed_headers.txt").read_text().split()
    names = {name for names in STANDARD for name in names.split("|")}
    names |= {"Eigen/Core", "Eigen/Geometry", "Eigen/SparseCore"}
    for header in headers:
        if uses_eigen(root, header) and not includes_eigen(root, header, set()):
            yield f"{header}:1: uses Eigen:: without a header of it"

    with tempfile.TemporaryDirectory() as folder:
        known = pathlib.Path(folder, "known.h")
        known.write_text("".join(f"#include <{name}>\n" for name in sorted(names)))
        subprocess.run(["g++", *flags, "-x", "c++-header", known], check=True)

        def compile_alone(header):
            run = subprocess.run(["g++", *flags, "-include", known, "-fsyntax-only",
                                  "-Wno-pragma-once-outside-header", "-x", "c++", header],
                                 cwd=root, text=True, capture_output=True)
            wrong = (w for w in run.stderr.splitlines() if " error: " in w or " warning: " in w)
            return [w for w in wrong if "#pragma once in main file" not in w][:1]

        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            tried = headers[::1 if "ECORCHE_THOROUGH" in os.environ else 3]
            for wrong in pool.map(compile_alone, tried):
                yield from wrong
    print(f"{len(tried)} of {len(headers)} headers")


def main():
    law, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    more = [pathlib.Path(p).resolve() for p in sys.argv[3:]]
    broken = list(globals()["check_" + law](root, *more))
    print("\n".join(broken))
    print(f"{law}: {len(broken)} breaks")
    raise SystemExit(1 if broken else 0)


if __name__ == "__main__":
    main()
