"""Runs the program on one bad input after the other and says what was not as stated.

A case states exit codes, what the message has to say, and that nothing is written where it fails. Every case is also held to what is promised of
all: it ends by itself and not by a signal, says why it fails, calls nothing an internal error, and keeps to limits of memory and time.
"""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

SECONDS, MEGABYTES = 30, 1500  # of a processor, of memory, unless a case states others
THOROUGH = "--thorough" in sys.argv or "ECORCHE_THOROUGH" in os.environ
PATIENCE = 12  # times its seconds on the clock: others may use the machine


def words(says):
    return [says] if isinstance(says, str) else list(says)


class Bench:
    def __init__(self, program, scratch, only=None, workers=2, verbose=False):
        self.program, self.scratch, self.only, self.verbose = program, pathlib.Path(scratch), only, verbose
        self.failures, self.skipped, self.count = [], [], 0
        self.most_memory, self.most_time = (0, ""), (0, "")
        self.rows = {}
        self.lock = threading.Lock()
        self.pool = ThreadPoolExecutor(max_workers=workers)
        self.pending = []

    def file(self, name, data=None):
        """A path in the scratch folder, written if data are given."""
        path = self.scratch / "in" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        if data is not None:
            path.write_bytes(data if isinstance(data, bytes) else data.encode())
        return path

    def skip(self, row, what, why):
        self.skipped.append(f"{row:>3} {what}: {why}")

    def case(self, row, what, arguments, codes, says=(), **options):
        """Queues a run. codes: exit codes, one or several; says: pieces of the message, whatever the case; names: what a refusal has to name, mostly the
        file. In arguments, {out} is a fresh folder."""
        if self.only and row not in self.only:
            return
        self.rows[row] = self.rows.get(row, 0) + 1
        self.pending.append(self.pool.submit(self._guarded, row, what, arguments, codes, says, options))

    def _guarded(self, *case):
        try:
            self._run(*case)
        except Exception as error:  # a case that cannot be run has failed
            self._fail(case[0], case[1], f"{type(error).__name__}: {error}", case[2])

    def _fail(self, row, what, why, arguments):
        with self.lock:
            self.failures.append(f"row {row}, {what}: {why}\n    {' '.join(map(str, arguments))[:600]}")
            print("FAILED", self.failures[-1], flush=True)

    def _run(self, row, what, arguments, codes, says, options):
        with self.lock:
            self.count += 1
            out = self.scratch / "out" / str(self.count)
        out.mkdir(parents=True)
        command = [str(a).replace("{out}", str(out)) if not isinstance(a, bytes) else a for a in arguments]
        done = self.run(command, **{k: v for k, v in options.items() if k in ("seconds", "megabytes", "environment", "folder", "limits", "stdin", "stdout", "user")})
        codes = (codes,) if isinstance(codes, int) else tuple(codes)
        left = sorted(str(p.relative_to(out)) for p in out.rglob("*") if not p.is_dir())
        problems = []
        if done.signal and not options.get("by_signal"):
            problems.append(f"ended by signal {done.signal}")
        elif done.code not in codes:
            problems.append(f"exit {done.code}, expected {' or '.join(map(str, codes))}")
        if "internal error" in done.stderr and 1 not in codes:
            problems.append("an internal error")
        if done.code not in (0, None) and not done.stderr.strip() and not options.get("silent"):
            problems.append("no word why")
        text = (done.stderr + done.stdout).lower()
        if options.get("names") and done.code not in (0, 8) and options["names"].lower() not in text:
            problems.append(f"the message does not name {options['names']}")
        problems += [f"the message does not say '{piece}'" for piece in words(says) if piece.lower() not in text]
        if done.code in (0, 8) and options.get("writes", True) and "{out}" in " ".join(map(str, arguments)) and not left:
            problems.append("nothing was written")
        if done.code not in (0, 8) and left and not options.get("may_leave"):
            problems.append(f"left behind: {', '.join(left)}")
        if any(name.startswith(".") and name.count(".") > 1 for name in (pathlib.Path(p).name for p in left)):
            problems.append(f"a temporary file is left: {left}")
        if options.get("after"):
            problems += [p for p in [options["after"](out, done)] if p]
        if done.late:
            problems.append(f"took more than {options.get('seconds', SECONDS)} s")
        if done.large:
            problems.append(f"took {done.megabytes:.0f} MB of memory")
        if problems:
            self._fail(row, what, "; ".join(problems) + "\n    " + " | ".join(done.stderr.strip().splitlines()[:3])[:400], command)
        elif self.verbose:
            print(f"{row:>3} {what}: exit {done.code}, {done.seconds:.1f} s, {done.megabytes:.0f} MB: {(done.stderr.strip().splitlines() or [''])[0][:200]}", flush=True)
        with self.lock:
            self.most_memory = max(self.most_memory, (done.megabytes, f"{row} {what}"))
            self.most_time = max(self.most_time, (done.seconds, f"{row} {what}"))
        shutil.rmtree(out, ignore_errors=True)

    def run(self, arguments, seconds=SECONDS, megabytes=MEGABYTES, environment=None, folder=None, limits=(), stdin=None, stdout=None, user=None):
        """One run of the program to its end."""
        return Run([str(self.program), *arguments], seconds, megabytes, environment, folder or self.scratch, limits, stdin, stdout, user)

    def finish(self):
        for task in self.pending:
            task.result()
        self.pending.clear()


class Run:
    """A child with limits on memory and time; code, signal, words, memory and time of it."""

    def __init__(self, command, seconds, megabytes, environment, folder, limits, stdin, stdout, user):
        def prepare():
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
            if megabytes:
                resource.setrlimit(resource.RLIMIT_AS, ((megabytes << 20) + (2 << 30),) * 2)  # threads' stacks are address space that is not used
            for kind, value in limits:
                resource.setrlimit(kind, (value, value))
            if user is not None:
                os.setgroups([])
                os.setgid(user)
                os.setuid(user)

        environment = {**os.environ, **(environment or {})}
        environment = {k: v for k, v in environment.items() if v is not None}
        begin = time.monotonic()
        child = subprocess.Popen(command, stdin=stdin or subprocess.DEVNULL, stdout=stdout or subprocess.PIPE, stderr=subprocess.PIPE, cwd=folder, env=environment,
                                 preexec_fn=prepare, start_new_session=True)
        texts = {}
        readers = [threading.Thread(target=lambda name=name, pipe=pipe: texts.__setitem__(name, pipe.read())) for name, pipe in (("out", child.stdout), ("err", child.stderr)) if pipe]
        for reader in readers:
            reader.start()
        timer = threading.Timer(PATIENCE * seconds, lambda: os.killpg(child.pid, signal.SIGKILL))
        timer.start()
        status, used = os.wait4(child.pid, 0)[1:]
        timer.cancel()
        child.returncode = 0  # it has been waited for
        for reader in readers:
            reader.join()
        for pipe in (child.stdout, child.stderr):
            if pipe:
                pipe.close()
        self.code = os.WEXITSTATUS(status) if os.WIFEXITED(status) else None
        self.signal = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
        self.stdout, self.stderr = (texts.get(name, b"").decode(errors="replace") for name in ("out", "err"))
        self.seconds, self.megabytes = used.ru_utime + used.ru_stime, used.ru_maxrss / 1024
        self.late = self.signal in (signal.SIGXCPU, signal.SIGKILL) and (self.seconds >= seconds - 1 or time.monotonic() - begin >= PATIENCE * seconds - 1)
        self.large = bool(megabytes) and self.megabytes > megabytes
