#!/usr/bin/env python3
"""Runs every command line of README.md, docs/*.md and the help texts as a reader would, and looks for every path that they name.

    documents.py ECORCHE SOURCE_FOLDER [--thorough] [DOCUMENT...]

A block of code after a line `<!-- output of: COMMAND -->` is what that command printed: each of its lines must be printed again, words alike and numbers within 3 % or one
unit of the last digit; "..." stands for lines left out.
Commands are lines of code that begin with `ecorche` or `build/ecorche`. They are run in a folder that holds what their readers have: a body, characters, motions, tables.
A command ends 0 or 8. Of two that ask for the same things (verb, options, kinds of files) the first is run, the other is looked at, and the characters have few of
their muscles; `--thorough`, or ECORCHE_THOROUGH in the environment, runs all, on whole ones. Commands that a line `<!-- not run: WHY -->` stands before are only looked at: their verbs and options must exist.
"""
import glob
import os
import re
import shutil
import subprocess
import sys
import time
import zipfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "command_line"))
from inputs import short_motion, spindle, write_part, write_scan  # noqa: E402
from runner import Runner  # noqa: E402

ROOMS = ("anatomy", "morph", "skinning", "viewer", "app", "data", "docs", "tests")
HELP_VERBS_NOT_RUN = {"demo": "run by make demo and by the options' test", "bench": "minutes"}
# Readers have minutes for a film, a fit by the best method or sixty poses; here a piece of it says as much. What is added to a command line, unless it says itself.
SHORTER = [(r"ecorche fit ", "--method", "--method ellipses"), (r"ecorche animate .*data/motions", "--to", "--to 24f"), (r"ecorche render .*(\.mp4|%04d\.png)", "--size", "--size 320x180"),
           (r"ecorche lift .*\.mp4", "--size", "--size 320x180 --fps 5"), (r"ecorche lift ", "--spacing", "--spacing 0.1"), (r"ecorche sit .*\.mp4", "--size", "--size 320x180 --fps 5"), (r"ecorche check (?!bodies)", "--no-sweeps", "--no-sweeps"), (r"ecorche fall .*\.mp4", "--size", "--size 320x180 --fps 10 --seconds 0.5"), (r"ecorche render .*data/motions.*\.mp4", "--(from|to|frames|at)", "--to 0.4"), (r"ecorche posebook ", "--poses", "--poses few-poses.csv"),
           (r"ecorche check (?!bodies)", "--poses", "--poses my-poses.csv"), (r"ecorche check bodies", "--body", "--body heavy_female")]


def documents(source):
    return ["README.md", "CONTRIBUTING.md"] + sorted("docs/" + name for name in os.listdir(os.path.join(source, "docs")) if name.endswith(".md"))


def commands_of(text):
    """(command, why it is not run or None) of a Markdown text."""
    out, reason, fenced, held = [], None, False, ""
    for line in text.splitlines():
        note = re.match(r"<!-- not run: (.*) -->", line.strip())
        if note:
            reason = note.group(1)
            continue
        if line.startswith("```"):
            fenced = not fenced
            if not fenced:
                reason = None
            continue
        code = line.strip() if fenced or line.startswith("    ") else ""
        if held or re.match(r"(build/)?ecorche\s", code):
            held += code.rstrip("\\")
            if not code.endswith("\\"):
                out.append((re.sub(r"\s+#\s.*", "", held).strip(), reason))
                held = ""
    return out


def outputs_of(text):
    """(command, lines that it printed) of a Markdown text."""
    return [(command, block.splitlines()) for command, block in re.findall(r"<!-- output of: (.*?) -->\n```\w*\n(.*?)```", text, re.S)]


def shorter(command):
    line = re.sub(r"--count 100\b", "--count 4", command)
    for pattern, own, more in SHORTER:
        if re.search(pattern, line) and not re.search(f" {own}", line):
            line += " " + more
    return line


def things_of(verb, words):
    """What a command line asks for: options, and endings of files, of a verb."""
    endings = re.findall(r"[\w*%]\.([a-z]\w*)\b", " ".join(words))
    return {(verb, word.split("=")[0]) for word in words if word.startswith("-") and not re.match(r"-[\d.]", word)} | {(verb, "." + ending) for ending in endings} | {(verb, "")}


def outputs_named(command):
    """Files and folders that a command line names as its own, by their first part."""
    return {word.split("/")[0].split(".")[0].split("%")[0] for word in re.findall(r"(?:-o|--output|--report|--table|--html|--page|--posed|--tissue|--crowd|--picture|>)[ =](?:[\w:-]+=)?(\S+)", command)} - {""}


def worth_running(lines, verb_of):
    """The commands, of (where, command), that ask for what none before them did, and those whose outputs such a one takes."""
    seen, chosen = set(), set()
    for k, (_, command) in enumerate(lines):
        words = re.sub(r"[|;>].*", "", command).split()[1:]
        things = things_of(verb_of(words), words)
        if not things <= seen:
            chosen.add(k)
        seen |= things
    for k in reversed(range(len(lines))):
        takers = (j for j in chosen if j > k)
        made = outputs_named(lines[k][1])
        if k not in chosen and any(re.search(rf"(?<![\w.-]){re.escape(name)}\b", lines[j][1]) for j in takers for name in made):
            chosen.add(k)
    return {lines[k] for k in chosen}


def alike(written, printed):
    """Whether two lines have the same words, and nearly the same numbers."""
    number = r"-?\d+(?:\.\d+)?"
    if re.sub(number, "#", " ".join(written.split())) != re.sub(number, "#", " ".join(printed.split())):
        return False
    for a, b in zip(re.findall(number, written), re.findall(number, printed)):
        unit = 10.0 ** -len(a.partition(".")[2])
        if abs(float(a) - float(b)) > max(1.001 * unit, 0.03 * abs(float(a))):
            return False
    return True


class Reader:
    """What readers of the documents have before them."""

    def __init__(self, program, source, whole):
        self.tools = Runner(program, source)
        self.program, self.source, self.folder = self.tools.program, self.tools.source, self.tools.folder
        t = self.tools
        t.run((0, 8), "body", "new", "--sex", "female", "--age", 30, "--height", "168cm", "--mass", "60kg", "-o", "anna.glb")
        t.run((0, 8), "body", "new", "--sex", "male", "-o", "ben.glb")
        for name in ("anna", "ben"):
            t.run((0, 8), "fit", f"{name}.glb", "-o", f"{name}-anatomy.glb", "--method", "ellipses")
            if not whole:
                write_part(t, f"{name}-anatomy.glb", f"{name}-anatomy.glb", bones=t.run(0, "list", "bones", "--names").stdout.split())
        write_scan(t, "anna.glb", "scan.ply", 1000)
        write_scan(t, "anna.glb", "scan.obj", 1000)
        t.run(0, "export", "anna-anatomy.glb", "-o", "gait.osim")
        t.run(0, "weights", "anna-anatomy.glb", "-o", "mine.csv")
        for name in ("walk", "run", "curl"):
            short_motion(t.data("motions", "walk.bvh"), t.path(f"{name}.bvh"), 6)
        for name in ("person.asf", "person_01.amc", "character_person.txt", "person_walk.txt", "legs.mot"):
            shutil.copy(os.path.join(self.source, "tests", "corpus", "motion", name), t.path(name))
        t.write("curl.csv", "time,muscle,value\n0,biceps_brachii_*,0\n0.05,biceps_brachii_*,1\n")
        t.write("people.csv", "name,sex,stature,waist_girth\nada,female,168cm,74cm\nbob,male,178cm,90cm\n")
        t.write("arm.txt", "include biceps.txt\n")
        t.write("more.txt", "set_belly biceps_brachii_long begin=0.3 end=0.7\nsave\n")
        t.write("few-poses.csv", "name,label,view,angles\nbent,bent,front,elbow 90\n")
        t.write("my-poses.csv", "pose,joint,flexion,abduction,rotation\nsitting,hip,0.75,0.2,0\n")
        t.write("biceps.obj", spindle())
        for wheel in glob.glob(os.path.join(os.path.dirname(self.program), "packages", "musclemimic_models-*.whl")):
            with zipfile.ZipFile(wheel) as package:  # a MuJoCo model as its users have it
                prefix = "musclemimic_models/"
                package.extractall(t.folder, [name for name in package.namelist() if name.startswith(prefix + "model/")])
            os.rename(t.path(prefix + "model"), t.path("model"))
        for name in ("biceps.txt", "plate.txt", "keep.txt", "insertion.txt"):
            shutil.copy(os.path.join(self.source, "docs", "studio", name), t.path(name))
        left = ".local/state/ecorche/studio/20260101-000000-aaaaaa"  # by a session that was killed
        os.makedirs(t.path(left))
        t.write(f"{left}/journal.txt", "set_layer 0.9\n")
        os.symlink(os.path.join(self.source, "data"), t.path("data"))
        os.makedirs(t.path("build"))
        os.makedirs(t.path("out"))
        os.symlink(self.program, t.path("build/ecorche"))
        os.symlink(os.path.join(os.path.dirname(self.program), "tests"), t.path("build/tests"))
        self.done = {}

    def run(self, where, command):
        """Each command once, as a shell runs it; windows close after two frames."""
        if command in self.done:
            return
        self.done[command] = where
        line = re.sub(r"^(build/)?ecorche view\b(.*)", r"xvfb-run -a build/ecorche view\2 --frames 2", shorter(command))
        if re.match(r"(build/)?ecorche studio\b(?!.* (--script|--list-actions|-o)\b)", line):  # likewise
            line = "xvfb-run -a build/" + re.sub(r"^build/", "", line) + ("" if " --input " in line else " --frames 2")
        if re.search(r" --(at|from|frames) ", command):  # moments that a short motion has not
            line = re.sub(r" walk\.bvh", " data/motions/walk.bvh", line)
        if line.startswith("xvfb-run ") and not shutil.which("xvfb-run"):
            print(f"skipped: {command} (no xvfb-run)")
            return
        path = self.folder + "/build:" + os.environ["PATH"]
        begin = time.monotonic()
        found = subprocess.run(["bash", "-c", line], cwd=self.folder, capture_output=True, text=True, timeout=1500, env={**os.environ, "PATH": path, "HOME": self.folder, "XDG_STATE_HOME": self.folder + "/.local/state"}, errors="replace")
        self.tools.times.append((time.monotonic() - begin, f"{where}: {command}"))
        self.tools.check(found.returncode in (0, 8), f"{where}: {command}: exit {found.returncode}\n{found.stderr[-600:]}")

    def compare(self, where, command, lines):
        """The lines are there among what the command prints, one after the other; of the twenty bodies those that are measured here."""
        bodies = re.findall(r"--body (\w+)", shorter(command))
        if bodies:
            lines = [line for line in lines if not re.search(r" \d+\.\d ", line) or line.split()[0] in bodies]
        begin = time.monotonic()
        done = subprocess.run(["bash", "-c", shorter(command)], cwd=self.folder, capture_output=True, text=True, timeout=1500, errors="replace",
                              env={**os.environ, "PATH": f"{self.folder}/build:{os.environ['PATH']}"})
        self.tools.times.append((time.monotonic() - begin, f"{where}: {command}"))
        if done.returncode == 77:
            print(f"{where}: skipped: {command}: {done.stdout.strip()[-200:]}")
            return
        self.tools.check(done.returncode in (0, 8), f"{where}: {command}: exit {done.returncode}\n{done.stderr[-600:]}")
        printed = iter(done.stdout.splitlines())
        gone = next((line for line in lines if line.strip() not in ("", "...") and not any(alike(line, each) for each in printed)), None)
        self.tools.check(gone is None, f"{where}: {command} no longer prints\n  {gone}\nbut\n{done.stdout}")

    def look(self, where, command):
        """The verb and the options exist."""
        words = re.sub(r"[|;>].*", "", command).split()[1:]
        verb = self.tools.verb_of(words)
        known = {name for group in self.tools.options_of(verb) for name in group} if verb or not words else set()
        unknown = [word.split("=")[0] for word in words if re.match(r"--?[a-zA-Z]", word) and word.split("=")[0] not in known]
        self.tools.check((verb or words[:1] in (["help"], ["--help"], ["--version"])) and not unknown, f"{where}: {command}: there is no such verb or option {unknown}")


def paths_of(text):
    """Paths into the repository that a text names: links, and words in backticks that begin with one of its rooms."""
    out = {target.split("#")[0] for target in re.findall(r"\]\(([^)\s]+)\)", text) if "://" not in target and not target.startswith("#")}
    words = {word for quoted in re.findall(r"`([^`\n]+)`", text) for word in re.findall(r"[\w./*-]+", quoted)}
    return out, {word.rstrip(".") for word in words if word.split("/")[0] in ROOMS and "/" in word}


def exists(source, path):
    full = os.path.join(source, path)
    return bool(glob.glob(full)) or any(glob.glob(full + ending) for ending in (".h", ".cpp"))


def look_for_paths(reader, name, text):
    links, words = paths_of(text)
    folder = os.path.dirname(name)
    for link in links:
        reader.tools.check(exists(reader.source, os.path.normpath(os.path.join(folder, link))), f"{name}: the link {link} leads nowhere")
    for word in words:
        reader.tools.check(exists(reader.source, word), f"{name}: {word} is not there")


def examples_of(help_text):
    found = re.search(r"^Examples?:\n((?:  .*\n?)+)", help_text, re.M)
    return [line.strip() for line in found.group(1).splitlines() if "ecorche " in line] if found else []


def gather(reader, source, chosen):
    """(where, command, why it is not run or None) of all documents, and (where, command, lines) of what they say was printed. Looks for paths on the way."""
    lines, printed = [], []
    for name in chosen:
        if name == "help":
            for verb in reader.tools.verbs:
                examples = examples_of(reader.tools.help_of(verb))
                reader.tools.check(examples, f"{verb} --help has no example")
                lines += [(f"{verb} --help", command, HELP_VERBS_NOT_RUN.get(verb)) for command in examples]
            continue
        with open(os.path.join(source, name), encoding="utf-8") as file:
            text = file.read()
        look_for_paths(reader, name, text)
        printed += [(name, *each) for each in outputs_of(text)]
        lines += [(name, *each) for each in commands_of(text)]
    return lines, printed


def main():
    source = os.path.abspath(sys.argv[2])
    everything = "--thorough" in sys.argv or "ECORCHE_THOROUGH" in os.environ
    reader = Reader(sys.argv[1], source, everything)
    names = [name for name in sys.argv[3:] if name != "--thorough"]
    lines, printed = gather(reader, source, names or documents(source) + ["help"])
    for each in printed:
        reader.compare(*each)
    run = [(where, command) for where, command, reason in lines if not reason]
    worth = set(run) if everything or names else worth_running(run, reader.tools.verb_of)
    for where, command, reason in lines:
        if not reason and (where, command) in worth:
            reader.run(where, command)
            continue
        reader.look(where, command)
        if reason:
            print(f"{where}: not run ({reason}): {command}")
    print(f"{len(reader.done)} commands run, of {len(set(command for _, command in run))}")
    reader.tools.finish()


if __name__ == "__main__":
    main()
