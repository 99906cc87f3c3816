"""What surrounds the program: arguments (44, 45), outputs (64 to 67, 70), limits of the system (69, 71), what is not installed (72, 74 to 77), pages (79)."""
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import tempfile
import time


def row_44(t):
    """Measures out of range, of nothing, in unknown units."""
    new = ["body", "new", "--sex", "male", "-o", "{out}/b.glb"]
    for option, value in (("--height", "17"), ("--height", "0"), ("--height", "-1.8"), ("--height", "-0"), ("--height", "1e308"), ("--height", "abc"), ("--height", "6 parsec"), ("--height", ""), ("--age", "-1"), ("--age", "200"), ("--mass", "0"),
                          ("--mass", "1e9"), ("--muscle", "7"), ("--muscle", "-1")):
        t.bench.case(44, f"{option} {value!r}", [*new, f"{option}={value}"], (2, 3, 4), option.strip("-"))
    for value in ("stature=abc", "stature=-1", "stature=0", "stature=1e308", "stature=inf", "stature=nan", "stature=17m", "stature=1.8parsec", "stature", "=1.8", "girth_of_ears=3cm"):
        t.bench.case(44, f"--measure {value}", [*new, "--measure", value], (2, 3, 4))
    for option in ("--height", "--mass", "--muscle", "--age"):
        t.case(44, f"{option} nan", [*new, f"{option}=nan"], (2,))
    t.case(44, "body modify --fat nan", ["body", "modify", t.body, "--fat", "nan", "-o", "{out}/b.glb"], (2,))
    t.case(44, "body modify --exaggerate nan", ["body", "modify", t.body, "--exaggerate", "nan", "-o", "{out}/b.glb"], (2,))
    t.case(44, "--seed -1", [*new, "--seed", "-1"], (2,))
    t.case(44, "a unit forgotten", ["body", "modify", t.body, "--measure", "waist_girth=80", "-o", "{out}/b.glb"], (2, 4))


def row_45(t):
    """Measures that contradict each other."""
    t.bench.case(45, "a waist of twice the hips", ["body", "new", "--sex", "female", "--measure", "waist_girth=150cm", "--measure", "hip_girth=75cm", "-o", "{out}/b.glb"], 4, ["waist", "hip"])
    t.bench.case(45, "the nearest body, marked", ["body", "new", "--sex", "female", "--measure", "waist_girth=150cm", "--measure", "hip_girth=75cm", "--best-effort", "-o", "{out}/b.glb"], (4, 8), writes=False)
    t.bench.case(45, "a height and a mass that nobody has", ["body", "new", "--sex", "male", "--height", "1.5", "--mass", "390", "-o", "{out}/b.glb"], 4, "kg")


def row_46(t):
    """Unknown verbs and measures, the same measure twice."""
    t.bench.case(46, "an unknown measure", ["body", "new", "--sex", "male", "--measure", "waist_grith=80cm", "-o", "{out}/b.glb"], 2, "waist_girth")
    t.bench.case(46, "no sex", ["body", "new", "-o", "{out}/b.glb"], 2, "sex")
    t.bench.case(46, "an unknown option", ["fit", t.body, "--speed", "9", "-o", "{out}/b.glb"], 2, "speed")
    t.bench.case(46, "an unknown verb", ["dance"], 2)
    t.case(46, "an unknown verb, with what was meant", ["anmate", t.small, t.good_motion, "-o", "{out}/b.glb"], (2,), says="animate")


def row_64(t):
    """A full disk: at opening, in the middle, at the end; an older file stays as it was."""
    if not t.can_mount():
        t.bench.skip(64, "a full disk", "no right to mount one")
    for size in ("4k", "64k", "300k") if t.can_mount() else ():
        t.on_full_disk(64, f"a disk of {size}", size, ["body", "new", "--sex", "male", "-o", "{disk}/a.glb"])
        t.on_full_disk(64, f"a disk of {size} with an older file", size, ["body", "new", "--sex", "male", "-o", "{disk}/old.glb"], old=True)
        t.on_full_disk(64, f"a motion on a disk of {size}", size, ["animate", t.small, t.good_motion, "-o", "{disk}/a.pc2"])
    for verb, arguments in (("body", ["body", "new", "--sex", "male", "-o", "{out}/a.glb"]), ("cache", ["animate", t.small, t.good_motion, "-o", "{out}/a.pc2"]), ("character", ["animate", t.small, t.good_motion, "-o", "{out}/a.glb"])):
        t.bench.case(64, f"a limit on the size of files: {verb}", arguments, 6, limits=[(resource.RLIMIT_FSIZE, 20000)])
    t.case(64, "a table to /dev/full", ["body", "measure", t.body, "--json"], (6,), stdout="/dev/full")
    t.case(64, "why a file could not be written", ["body", "new", "--sex", "male", "-o", "/dev/full/x.glb"], (6,), says="not a directory")


def row_65(t):
    """Outputs that cannot be: a folder, the input, a missing parent, a forbidden folder. Said before anything is computed."""
    folder = t.bench.file("outputs/folder.glb")
    folder.mkdir(parents=True, exist_ok=True)
    t.bench.case(65, "a folder", ["fit", t.body, "-o", folder], 6, "folder.glb", seconds=10)
    t.bench.case(65, "a missing parent", ["fit", t.body, "-o", "{out}/no/where/c.glb"], 6, "no/where", seconds=10)
    same = t.bench.file("outputs/same.glb", t.body.read_bytes())
    link = t.bench.file("outputs/link.glb")
    if not link.exists():
        os.link(same, link)
    for name in (same, link, same.parent / "." / "same.glb"):
        t.bench.case(65, f"the input itself: {name.name}", ["fit", same, "-o", name], 6, "input", seconds=10, after=lambda out, done: "" if same.read_bytes() == t.body.read_bytes() else "the input was touched")
    t.bench.case(65, "a device", ["fit", t.body, "-o", "/dev/full"], (2, 6), seconds=10)
    t.bench.case(65, "an unknown ending", ["animate", t.small, t.good_motion, "-o", "{out}/a.fbx"], 2, "fbx", seconds=10)
    if t.nobody is not None:
        forbidden = t.bench.file("outputs/forbidden")
        forbidden.mkdir(exist_ok=True)
        forbidden.chmod(0o555)
        t.bench.case(65, "a forbidden folder", ["body", "new", "--sex", "male", "-o", forbidden / "b.glb"], 6, "b.glb", user=t.nobody, seconds=10)
    t.case(65, "a report in place of the input", ["fit", same, "-o", "{out}/c.glb", "--report", same], (2, 6), may_leave=True)
    t.case(65, "two outputs of one name", ["animate", t.small, t.good_motion, "-o", "{out}/a.glb", "-o", "{out}/a.glb"], (2, 6))


def row_66(t):
    """Stopped while it writes: no half file under the name that was asked for, and none at all where it could clean up."""
    if t.bench.only and 66 not in t.bench.only:
        return
    for number in (signal.SIGKILL, signal.SIGTERM, signal.SIGINT):
        for after in (0.05, 0.4, 0.8, 1.5):
            t.bench.pending.append(t.bench.pool.submit(t.kill_case, 66, number, after))
            t.bench.rows[66] = t.bench.rows.get(66, 0) + 1


def row_67(t):
    """A closed pipe in place of standard output or error."""
    closed = os.open(os.devnull, os.O_RDONLY)
    t.bench.case(67, "help into a closed pipe", ["--help"], (0, 6), stdout=t.closed_pipe(), silent=True)
    t.bench.case(67, "help into what cannot be written", ["--help"], (0, 6), stdout=closed)
    t.case(67, "measures into a closed pipe", ["body", "measure", t.body], (0, 6), stdout=t.closed_pipe(), silent=True)


def row_68(t):
    """An input that goes away while the program runs: it was read at once and whole, so that nothing of it is asked for later."""
    copy = t.bench.file("vanishing.glb", t.body.read_bytes())
    if t.bench.only and 68 not in t.bench.only:
        return
    out = t.bench.file("vanished.glb")
    child = subprocess.Popen([t.bench.program, "fit", copy, "-o", out, "--method", "paper"], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    time.sleep(1.0)
    copy.unlink()
    words = child.communicate()[1].decode()
    t.bench.count += 1
    t.bench.rows[68] = 1
    if child.returncode not in (0, 3, 8) or (child.returncode != 3) != out.exists():
        t.bench._fail(68, "an input that vanishes", f"exit {child.returncode}: {words}", ["fit", copy])


def row_69(t):
    """Little memory, few files, a small stack, no more threads."""
    for megabytes in (200, 300, 400, 600):
        t.bench.case(69, f"{megabytes} MB of addresses", ["fit", t.body, "-o", "{out}/c.glb", "--threads", "1"], (0, 5, 8), limits=[(resource.RLIMIT_AS, megabytes << 20)], megabytes=0, writes=False)
    t.bench.case(69, "16 files", ["fit", t.body, "-o", "{out}/c.glb"], (0, 5, 8), limits=[(resource.RLIMIT_NOFILE, 16)])
    t.bench.case(69, "6 files", ["fit", t.body, "-o", "{out}/c.glb"], (0, 3, 5, 6, 8), limits=[(resource.RLIMIT_NOFILE, 6)], writes=False)
    t.bench.case(69, "a stack of 256 kB", ["fit", t.body, "-o", "{out}/c.glb"], (0, 5, 8), limits=[(resource.RLIMIT_STACK, 256 << 10)])
    t.bench.case(69, "a stack of 256 kB, a motion", ["animate", t.small, t.good_motion, "-o", "{out}/c.glb"], (0, 5), limits=[(resource.RLIMIT_STACK, 256 << 10)])
    if t.nobody is not None:
        t.bench.case(69, "no more threads", ["fit", t.body, "-o", t.out(t.nobody), "--threads", "8"], (0, 5, 8), user=t.nobody, limits=[(resource.RLIMIT_NPROC, 1)], writes=False)
        t.bench.case(69, "no more threads, a motion", ["animate", t.small, t.good_motion, "-o", t.out(t.nobody, "m.pc2"), "--threads", "8"], (0, 5), user=t.nobody, limits=[(resource.RLIMIT_NPROC, 1)], writes=False)
    else:
        t.bench.skip(69, "no more threads", "nobody else to be")


def row_70(t):
    """Two that write the same file at once: the last one wins, and the file is whole."""
    if t.bench.only and 70 not in t.bench.only:
        return
    out = t.bench.file("both.glb")
    children = [subprocess.Popen([t.bench.program, "body", "new", "--sex", sex, "-o", out], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) for sex in ("male", "female") * 3]
    codes = [child.wait() for child in children]
    t.bench.count += 1
    t.bench.rows[70] = 1
    measured = t.bench.run(["body", "measure", out])
    if any(codes) or measured.code != 0 or list(out.parent.glob(".both*")):
        t.bench._fail(70, "two that write the same file", f"exits {codes}, then {measured.code}", [out])


def row_71(t):
    """Any number of threads, any nonsense about them in the environment: the same bytes."""
    first = t.bench.file("threads.pc2")
    t.bench.run(["animate", t.small, t.good_motion, "-o", first])
    for name, more, environment in (("0", ["--threads", "0"], {}), ("1", ["--threads", "1"], {}), ("2", ["--threads", "2"], {}), ("1000", ["--threads", "1000"], {}), ("nonsense", [], {"OMP_NUM_THREADS": "many", "TBB_NUM_THREADS": "-3"})):
        t.bench.case(71, f"threads: {name}", ["animate", t.small, t.good_motion, "-o", "{out}/m.pc2", *more], 0, environment=environment,
                     after=lambda out, done: "" if (out / "m.pc2").read_bytes() == first.read_bytes() else "other bytes come out")
    for value in ("-1", "1e9", "many"):
        t.bench.case(71, f"threads: {value}", ["animate", t.small, t.good_motion, "-o", "{out}/m.pc2", f"--threads={value}"], 2)


def row_72(t):
    """No display, no graphics driver: said, and what needs none works."""
    bare = {"DISPLAY": None, "WAYLAND_DISPLAY": None}
    t.bench.case(72, "no display: a motion", ["animate", t.small, t.good_motion, "-o", "{out}/m.glb"], 0, environment=bare)
    t.bench.case(72, "no display: the window", ["view", t.small, "--frames", "1"], (2, 4, 6), environment=bare)
    driver = {"LIBGL_DRIVERS_PATH": "/nowhere", "__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere/x.json", "EGL_PLATFORM": None}
    t.case(72, "no driver: pictures", ["render", t.small, t.good_motion, "-o", "{out}/%04d.png", "--size", "64x64"], (0, 4, 5, 6), environment=driver)


def row_74(t):
    """Pictures of no size, odd sizes, too large, of no rate."""
    for size, codes in (("0x0", 2), ("-5x9", 2), ("20000x20000", (2, 5)), ("1e9x3", 2), ("9", 2), ("x", 2)):
        t.bench.case(74, f"a size of {size}", ["render", t.small, t.good_motion, "-o", "{out}/%04d.png", f"--size={size}"], codes)
    for option, value in (("--fps", "0"), ("--fps", "-3"), ("--camera", "under the table"), ("--layers", "fat")):
        t.bench.case(74, f"{option} {value}", ["render", t.small, t.good_motion, "-o", "{out}/%04d.png", f"{option}={value}"], 2)
    t.case(74, "a rate of nan", ["render", t.small, t.good_motion, "-o", "{out}/%04d.png", "--fps=nan"], (2,))
    t.case(74, "no layers", ["render", t.small, t.good_motion, "-o", "{out}/%04d.png", "--layers="], (2,))


def row_75(t):
    """No ffmpeg, one that fails, one that writes nothing."""
    for name, script in (("missing", None), ("fails", "#!/bin/sh\nexit 3\n"), ("writes_nothing", "#!/bin/sh\ncat > /dev/null\n")):
        folder = t.bench.file(f"path_{name}")
        folder.mkdir(exist_ok=True)
        for tool in ("sh", "cat", "true"):
            if not (folder / tool).exists():
                (folder / tool).symlink_to(shutil.which(tool))
        if script:
            (folder / "ffmpeg").write_text(script)
            (folder / "ffmpeg").chmod(0o755)
        arguments = ["render", t.small, t.good_motion, "-o", "{out}/film.mp4", "--size", "64x64"]
        if name == "writes_nothing":
            t.case(75, "ffmpeg that writes nothing", arguments, (4, 6), environment={"PATH": str(folder)})
        else:
            t.bench.case(75, f"ffmpeg: {name}", arguments, (4, 6), "ffmpeg", environment={"PATH": str(folder)})


def row_76(t):
    """Another time zone, another day: the same bytes."""
    first = t.bench.file("clock.glb")
    t.bench.run(["animate", t.small, t.good_motion, "-o", first])
    for zone in ("Asia/Tokyo", "nonsense/zone", ""):
        t.bench.case(76, f"the zone {zone!r}", ["animate", t.small, t.good_motion, "-o", "{out}/clock.glb"], 0, environment={"TZ": zone, "SOURCE_DATE_EPOCH": "-5"},
                     after=lambda out, done: "" if (out / "clock.glb").read_bytes() == first.read_bytes() else "other bytes come out")


def row_77(t):
    """No home, a cache that cannot be written, is damaged, or is another's."""
    from files import noise
    good = t.bench.file("cache_good.glb")
    slow = {"seconds": 240, "megabytes": 3000}  # the template is built anew
    # Another program's template, in the same cache, may differ in its last bits.
    fit = ["fit", t.body, "--method", "paper", "-o"]
    t.bench.run([*fit, good], **slow, environment={"XDG_CACHE_HOME": str(t.bench.file("cache_fresh"))})

    def same(out, done):
        return "" if (out / "c.glb").read_bytes() == good.read_bytes() else "other bytes come out"

    def with_caches(name, change):
        cache = t.bench.file(f"cache_{name}/ecorche")
        cache.mkdir(parents=True, exist_ok=True)
        for file in t.caches():
            shutil.copy(file, cache / file.name)
        change(cache)
        return {"XDG_CACHE_HOME": str(cache.parent)}

    def damage(cache):
        for file in cache.iterdir():
            data = bytearray(file.read_bytes())
            data[len(data) // 2] ^= 1
            file.write_bytes(bytes(data))

    def swap(cache):
        """Two templates under each other's names: the other was made with another table of data."""
        files = list(cache.glob("*.template"))
        files[0].write_bytes(t.other_template())

    def pipes(cache):
        for file in list(cache.iterdir()):
            file.unlink()
            os.mkfifo(file)

    if not t.caches():
        t.bench.skip(77, "caches", "there are none")
        return
    arguments = [*fit, "{out}/c.glb"]
    t.bench.case(77, "damaged caches", arguments, (0, 8), environment=with_caches("damaged", damage), after=same, **slow)
    t.bench.case(77, "another's cache", arguments, (0, 8), environment=with_caches("swapped", swap), after=same, **slow)
    t.bench.case(77, "no home", ["body", "new", "--sex", "male", "-o", "{out}/b.glb"], 0, environment={"HOME": None, "XDG_CACHE_HOME": None})
    t.bench.case(77, "a home that is a file", ["body", "new", "--sex", "male", "-o", "{out}/b.glb"], 0, environment={"HOME": "/dev/null", "XDG_CACHE_HOME": None})
    t.bench.case(77, "a cache folder that is a device", ["body", "new", "--sex", "male", "-o", "{out}/b.glb"], 0, environment={"XDG_CACHE_HOME": "/dev/null"})
    if t.thorough:
        t.bench.case(77, "caches that are pipes", arguments, (0, 8), environment=with_caches("pipes", pipes), after=same, **slow)


def row_79(t):
    """Names that would be marks in a page are shown as they are."""
    path = t.bench.file("page.glb", t.changed_small(lambda d: next(n for n in d["nodes"] if n["name"].startswith("muscle/"))["extras"].update(label="<script>alert(1)</script>")))
    t.bench.case(79, "a muscle called <script>", ["check", path, "-o", "{out}/check", "--no-pictures", "--no-sweeps"], (0, 3, 4, 8), writes=False, may_leave=True,
                 after=lambda out, done: next((f"{p.name} holds the mark" for p in out.rglob("*.html") if "<script>alert(1)" in p.read_text()), ""))
