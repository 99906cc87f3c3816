#!/usr/bin/env python3
"""Holds the table of limits in SECURITY.md and the constants in anatomy/limits.h together.

limits.py SOURCE_FOLDER            fails where the table is not what the constants say
limits.py SOURCE_FOLDER --write    writes the table anew
"""
import pathlib
import re
import sys

BEGIN, END = "<!-- limits: begin -->\n", "<!-- limits: end -->\n"


def value_of(expression):
    plain = re.sub(r"std::size_t\{(\d+)\}", r"\1", expression).replace("LL", "")
    if not re.fullmatch(r"[\d\s*<+-]+", plain):
        raise SystemExit(f"limits.h: '{expression}' is no whole number")
    return eval(plain)  # digits and operators alone


def shown(value, what):
    if what.startswith("bytes") and value % (1 << 20) == 0:
        return f"{value >> 20} MiB" if value < 1 << 30 else f"{value >> 30} GiB"
    return f"{value:,}"


def table(header):
    constant = r"((?:^// .+\n)+)inline constexpr [\w:]+(?: \w+)* (k\w+) =\s+([^;]+);$"
    rows = [(name, " ".join(value.split()), " ".join(re.sub("^// ", "", remark, flags=re.M).split()))
            for remark, name, value in re.findall(constant, header, re.M)]
    if len(rows) != header.count("inline constexpr"):
        raise SystemExit("limits.h: a constant without a remark")
    return "| at most | of |\n|---:|---|\n" + "".join(f"| {shown(value_of(value), what)} | {what} |\n" for _, value, what in rows)


def main():
    source = pathlib.Path(sys.argv[1])
    page = (source / "SECURITY.md").read_text()
    wanted = BEGIN + table((source / "anatomy/limits.h").read_text()) + END
    begin, end = page.find(BEGIN), page.find(END)
    if begin < 0 or end < begin:
        raise SystemExit("SECURITY.md: the marks around the table of limits are missing")
    new = page[:begin] + wanted + page[end + len(END):]
    if "--write" in sys.argv:
        (source / "SECURITY.md").write_text(new)
    elif new != page:
        raise SystemExit("SECURITY.md states other limits than anatomy/limits.h; run tests/bad_inputs/limits.py . --write")


if __name__ == "__main__":
    main()
