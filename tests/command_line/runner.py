"""Runs the program as a user does and remembers which options were used in runs that succeeded."""
import functools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

COMMON = {"--report", "--threads", "--seed", "--progress", "-q", "--quiet", "-v", "--verbose", "-h", "--help"}


class Failure(AssertionError):
    pass


class Runner:
    def __init__(self, program, source):
        self.program, self.source = os.path.abspath(program), os.path.abspath(source)
        self.folder = tempfile.mkdtemp(prefix="ecorche-test-")
        self.used = {}       # verb -> options of runs that ended 0 or 8
        self.failures = []
        self.passed = 0
        self.times = []      # (seconds, command line)
        self.verbs = self.find_verbs("")

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def data(self, *parts):
        return os.path.join(self.source, "data", *parts)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as out:
            out.write(text)
        return name

    @functools.cache  # asked for by every run
    def help_of(self, verb):
        return subprocess.run([self.program, *verb.split(), "--help"], capture_output=True, text=True, check=True).stdout

    def find_verbs(self, verb):
        """All verbs that do something, by the help texts."""
        text = self.help_of(verb)
        block = re.search(r"^Subcommands:\n((?:  .*\n|\n)*)", text, re.M)
        if not block:
            return [verb]
        out = []
        for name in re.findall(r"^  ([a-z]\w*)", block.group(1), re.M):
            out += self.find_verbs((verb + " " + name).strip())
        return out

    def options_of(self, verb):
        """Options and positionals of a help text: a set of groups of names that mean the same."""
        out = set()
        part = ""
        for line in self.help_of(verb).splitlines():
            if line.endswith(":") and not line.startswith(" "):
                part = line
            found = re.match(r"  (-[\w-]+(?:,-[\w-]+)*)", line)
            if found and part == "Options:":
                out.add(tuple(found.group(1).split(",")))
            found = re.match(r"  ([a-z]\w*)", line)
            if found and part == "Positionals:":
                out.add((found.group(1),))
        return out

    def verb_of(self, words):
        for length in (2, 1):
            if " ".join(words[:length]) in self.verbs:
                return " ".join(words[:length])
        return ""

    def run(self, codes, *words, env=None, under=(), timeout=900):
        """Runs `ecorche WORDS`; fails unless the exit code is among `codes`. Returns the finished process."""
        words = [str(word) for word in words]
        codes = codes if isinstance(codes, tuple) else (codes,)
        begin = time.monotonic()
        done = subprocess.run([*under, self.program, *words], cwd=self.folder, capture_output=True, text=True, timeout=timeout, errors="replace",
                              env={**os.environ, **(env or {})})
        self.times.append((time.monotonic() - begin, " ".join(words)))
        ok = done.returncode in codes
        self.check(ok, f"ecorche {' '.join(words)}: exit {done.returncode}, expected {codes}\n{done.stderr[-800:]}")
        if ok and done.returncode in (0, 8):
            verb = self.verb_of(words)
            names = self.used.setdefault(verb, set())
            positionals = [g[0] for g in sorted(self.positionals(verb), key=lambda g: self.help_of(verb).index("  " + g[0]))]
            rest = words[len(verb.split()):]
            names |= {word.split("=")[0] for word in rest if word.startswith("-") and not re.match(r"-[\d.]", word)}
            names |= set(positionals[:self.count_positionals(verb, rest)])
        return done

    def positionals(self, verb):
        return {group for group in self.options_of(verb) if not group[0].startswith("-")}

    def count_positionals(self, verb, words):
        flags = {name for group in self.flags(verb) for name in group}
        count, skip = 0, False
        for word in words:
            if skip:
                skip = False
            elif word.startswith("-") and not re.match(r"-[\d.]", word):
                skip = word not in flags and "=" not in word
            else:
                count += 1
        return count

    def flags(self, verb):
        """Options without a value: nothing but their names and a description."""
        out = set()
        for line in self.help_of(verb).splitlines():
            found = re.match(r"  (-[\w-]+(?:,-[\w-]+)*)(\s{2,}.*|$)", line)
            if found:
                out.add(tuple(found.group(1).split(",")))
        return out

    def check(self, condition, what):
        if condition:
            self.passed += 1
        else:
            self.failures.append(what)
            print("FAILED:", what, flush=True)
        return condition

    def there(self, name, least=1):
        return self.check(os.path.isfile(self.path(name)) and os.path.getsize(self.path(name)) >= least, f"{name} is missing")

    def absent(self, name):
        return self.check(not os.path.exists(self.path(name)), f"{name} should not be there")

    def says(self, done, text):
        return self.check(text.lower() in (done.stdout + done.stderr).lower(), f"'{text}' is not said: {done.stderr[-500:]}")

    def json(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return json.load(file)

    def bytes(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def unused(self):
        """Options of the help texts that no successful run has used."""
        out = []
        for verb in self.verbs:
            used = self.used.get(verb, set())
            for group in sorted(self.options_of(verb)):
                if not set(group) & used and not set(group) & COMMON:
                    out.append(f"{verb} {'/'.join(group)}")
        return out

    def finish(self):
        print("slowest commands, of", round(sum(seconds for seconds, _ in self.times)), "s in all:")
        for seconds, words in sorted(self.times, reverse=True)[:15]:
            print(f"  {seconds:5.1f} s  {words}")
        print(f"{self.passed} passed, {len(self.failures)} failed")
        self.close()
        sys.exit(1 if self.failures else 0)
