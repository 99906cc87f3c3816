#!/usr/bin/env python3
"""What every verb does when its output cannot be written, and when it is interrupted: one wording each with the system's reason, the right exit code, nothing left.
Usage: outputs.py ECORCHE SOURCE_FOLDER"""
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from inputs import short_motion, spindle, write_part  # noqa: E402
from runner import Runner  # noqa: E402

# Verb: the words before the output's name, the output's option, its name. {} stands for the folder that the output is put into.
FILES = {
    "body new": (["--sex", "male"], "-o", "x.glb"),
    "body modify": (["anna.glb", "--fat", "33"], "-o", "x.glb"),
    "body measure": (["anna.glb"], "--html", "x.html"),
    "fit": (["anna.glb"], "-o", "x.glb"),
    "animate": (["some.glb", "walk.bvh"], "-o", "x.glb"),
    "retarget": (["walk.bvh", "anna-anatomy.glb"], "-o", "x.bvh"),
    "animate pc2": (["some.glb", "walk.bvh"], "-o", "x.pc2"),
    "animate mdd": (["some.glb", "walk.bvh"], "-o", "x.mdd"),
    "bake": (["some.glb", "walk.bvh", "--morphs", "2", "--helpers", "0", "--samples", "4"], "-o", "x.glb"),
    "export": (["anna-anatomy.glb", "--no-meshes"], "-o", "x.osim"),
    "export mjcf": (["anna-anatomy.glb", "--no-meshes"], "-o", "x.xml"),
    "inertia": (["anna-anatomy.glb"], "-o", "x.csv"),
    "dynamics": (["anna-anatomy.glb", "walk.bvh"], "-o", "x.csv"),
    "dynamics page": (["anna-anatomy.glb", "walk.bvh"], "--html", "x.html"),
    "weights": (["some.glb"], "-o", "x.csv"),
    "weights picture": (["some.glb", "--joint", "knee_l"], "--picture", "x.png"),
    "render": (["some.glb", "walk.bvh", "--size", "96x64", "--fps", "2"], "-o", "x.mp4"),
    "fall": (["anna-anatomy.glb", "--seconds", "0.2"], "-o", "x.bvh"),
    "lie": (["anna-anatomy.glb", "--size", "96x64"], "-o", "x.png"),
    "sit": (["anna-anatomy.glb", "--size", "96x64"], "-o", "x.png"),
    "lift": (["anna-anatomy.glb", "--spacing", "0.2"], "--table", "x.csv"),
    "template import": (["anna.osim", "--our-bones"], "-o", "x.glb"),
    "template sweep": (["--step", "40"], "-o", "x.csv"),
    "template resample": (["spindle.obj"], "-o", "x.obj"),
    "report": (["--sex", "male", "-o", "aside.glb"], "--report", "x.json"),
}
# Verbs that write into a folder of their own.
FOLDERS = {
    "animate obj": (["some.glb", "walk.bvh"], "-o", "%03d.obj"),
    "render png": (["some.glb", "walk.bvh", "--size", "96x64", "--fps", "2"], "-o", "%03d.png"),
    "check": (["some.glb", "--poses", "none", "--no-sweeps", "--no-pictures"], "-o", ""),
    "posebook": (["some.glb", "--poses", "poses.csv", "--methods", "lbs"], "-o", ""),
    "body population": (["--count", "1", "--skins"], "-o", ""),
}
VERB = {"animate pc2": "animate", "animate mdd": "animate", "export mjcf": "export", "dynamics page": "dynamics", "weights picture": "weights", "report": "body new", "animate obj": "animate", "render png": "render"}


def words(name, place, table=FILES):
    before, option, file = table[name]
    return [*VERB.get(name, name).split(), *before, option, os.path.join(place, file) if file else place]


def temporaries(folder):
    return [os.path.join(at, f) for at, _, files in os.walk(folder) for f in files if ".part" in f]


def prepare(t):
    t.run((0, 8), "body", "new", "--sex", "female", "--height", "165cm", "-o", "anna.glb")
    t.run((0, 8), "fit", "anna.glb", "-o", "anna-anatomy.glb", "--method", "ellipses")
    write_part(t, "anna-anatomy.glb", "some.glb")
    t.run(0, "export", "anna-anatomy.glb", "-o", "anna.osim", "--no-meshes")
    short_motion(t.data("motions", "walk.bvh"), t.path("walk.bvh"), 6)
    shutil.copy(t.data("motions", "walk.bvh"), t.path("long.bvh"))
    t.write("poses.csv", "name,label,view,angles\nbent,bent,front,elbow 90\n")
    t.write("spindle.obj", spindle())


def places(t):
    """No folder, a folder in the way, a device, one's own input, two outputs of one name."""
    os.makedirs(t.path("way"))
    for name in FILES:
        file = FILES[name][2]
        os.makedirs(t.path("way/" + file), exist_ok=True)
        t.says(t.run(6, *words(name, "nowhere")), "could not be written: the folder nowhere does not exist; create it first")
        t.says(t.run(6, *words(name, "way")), "could not be written: Is a directory")
        kind = os.path.splitext(file)[1]
        os.symlink("/dev/full", t.path("device" + kind)) if not os.path.islink(t.path("device" + kind)) else None
        command = words(name, "")
        command[-1] = "device" + kind
        t.says(t.run(6, *command), "could not be written: it is no regular file")
        report = words(name, "")
        if name != "report":
            t.says(t.run(6, *report, "--report", report[-1]), "two outputs have this name")
    for name in ("body modify", "fit", "animate", "template resample"):
        command = words(name, "")
        command[-1] = command[len(VERB.get(name, name).split())]
        before = t.bytes(command[-1])
        t.says(t.run(6, *command), "it is also the input")
        t.check(t.bytes(command[-1]) == before, f"{name}: the input was touched")
    for name in FOLDERS:
        t.write("file", "x")
        t.says(t.run(6, *words(name, "file", FOLDERS)), "could not be written")
        t.check(t.bytes("file") == b"x", f"{name}: a file in place of its folder was touched")
    t.check(not temporaries(t.folder), f"left: {temporaries(t.folder)}")


def mount(folder, size):
    return subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", folder], capture_output=True).returncode == 0


def fill(file):
    """Writes until there is no room for a single byte."""
    with open(file, "wb", buffering=0) as out:
        try:
            while True:
                out.write(b"x" * 512)
        except OSError:
            pass


def full_disks(t):
    """The system's reason, in every verb; nothing is left there."""
    os.makedirs(t.path("full"))
    if not mount(t.path("full"), "16k"):
        print("skipped: full disks (no right to mount one)")
        return
    fill(t.path("full/filler"))
    try:
        for name in FILES:
            done = t.run(6, *words(name, "full"))
            t.says(done, "No space left on device")
            t.check(os.listdir(t.path("full")) == ["filler"], f"{name}: left on a full disk: {os.listdir(t.path('full'))}")
        for name in FOLDERS:
            t.says(t.run(6, *words(name, "full", FOLDERS)), "No space left on device")
            t.check(not temporaries(t.path("full")), f"{name}: left on a full disk: {temporaries(t.path('full'))}")
            for entry in set(os.listdir(t.path("full"))) - {"filler"}:
                shutil.rmtree(t.path("full/" + entry), ignore_errors=True)
                if os.path.exists(t.path("full/" + entry)):
                    os.remove(t.path("full/" + entry))
    finally:
        subprocess.run(["umount", t.path("full")])
    done = subprocess.run(f"{t.program} list muscles > /dev/full", shell=True, capture_output=True, text=True)
    t.check(done.returncode == 6 and "standard output" in done.stderr and "No space left" in done.stderr, f"stdout to a full disk: {done.returncode} {done.stderr}")
    done = subprocess.run(["bash", "-c", f"{t.program} list muscles | head -1; exit ${{PIPESTATUS[0]}}"], capture_output=True, text=True)
    t.check(done.returncode in (0, 6) and not done.stderr, f"a closed pipe: {done.returncode} {done.stderr}")


def read_only(t):
    """A folder without the right to write, as somebody who is not root."""
    user = ["setpriv", "--reuid", "65534", "--regid", "65534", "--clear-groups"] if os.getuid() == 0 else []
    if user and subprocess.run([*user, t.program, "--version"], capture_output=True).returncode != 0:
        print("skipped: read-only folders (nobody cannot start the program)")
        return
    os.makedirs(t.path("closed"), exist_ok=True)
    os.chmod(t.path("closed"), 0o555)
    os.chmod(t.folder, 0o755)
    for name in FILES:
        if name == "report":
            continue
        t.says(t.run(6, *words(name, "closed"), under=user, env={"HOME": "/nonexistent", "XDG_CACHE_HOME": "/nonexistent"}), "Permission denied")
    for name in FOLDERS:
        t.says(t.run(6, *words(name, "closed/below" if not FOLDERS[name][2] else "closed/below", FOLDERS), under=user,
                     env={"HOME": "/nonexistent", "XDG_CACHE_HOME": "/nonexistent"}), "Permission denied")


def interrupts(t):
    """Ctrl-C and SIGTERM at any moment: 130 and 143, a word about what is written, and nothing half-written."""
    # Long enough to be interrupted in the middle of writing.
    long_ones = {
        "animate pc2": ["animate", "anna-anatomy.glb", "long.bvh", "-o", "cut/x.pc2", "-o", "cut/x.glb"],
        "render": ["render", "anna-anatomy.glb", "long.bvh", "--size", "320x240", "-o", "cut/x.mp4"],
        "bake": ["bake", "anna-anatomy.glb", "long.bvh", "-o", "cut/x.glb"],
        "body population": ["body", "population", "--count", "20000", "--skins", "-o", "cut"],
        "fit tetgen": ["fit", "anna.glb", "--interior", "tetgen", "-o", "cut/x.glb"],
        "animate obj": ["animate", "anna-anatomy.glb", "long.bvh", "-o", "cut/%03d.obj"],
    }
    dice = random.Random(7)
    for name, command in long_ones.items():
        for sent, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            shutil.rmtree(t.path("cut"), ignore_errors=True)
            os.makedirs(t.path("cut"))
            run = subprocess.Popen([t.program, *command], cwd=t.folder, stderr=subprocess.PIPE, text=True)
            time.sleep(dice.uniform(1.5, 5))
            if run.poll() is not None:
                print(f"{name} ended before it was interrupted")
                run.communicate()
                continue
            run.send_signal(sent)
            said = run.communicate(timeout=20)[1]
            t.check(run.returncode == code, f"{name}: {sent.name} ends {run.returncode}")
            t.check("written" in said, f"{name}: {sent.name} is not told what was written: {said[-200:]}")
            left = [f for at, _, files in os.walk(t.path("cut")) for f in files if f.startswith(".")]
            left = [f for f in left if not f.startswith(".rows")]
            t.check(not left, f"{name}: {sent.name} leaves {left}")
            t.check(not os.path.exists(t.path("cut/x.mp4")) and not os.path.exists(t.path("cut/x.pc2")), f"{name}: half a file is there")
    shutil.rmtree(t.path("cut"), ignore_errors=True)
    os.makedirs(t.path("cut"))
    ignored = subprocess.Popen(["nohup", t.program, *long_ones["body population"]], cwd=t.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(1)
    ignored.send_signal(signal.SIGHUP)
    time.sleep(0.5)
    t.check(ignored.poll() is None, "under nohup a hang-up is ignored")
    ignored.kill()
    ignored.wait()


def kills(t):
    """kill -9 leaves temporaries; the next run that writes there removes them."""
    shutil.rmtree(t.path("cut"), ignore_errors=True)
    os.makedirs(t.path("cut"))
    run = subprocess.Popen([t.program, "animate", "anna-anatomy.glb", "long.bvh", "-o", "cut/x.pc2"], cwd=t.folder, stderr=subprocess.DEVNULL)
    deadline = time.time() + 30
    while not temporaries(t.path("cut")) and time.time() < deadline:
        time.sleep(0.02)
    run.kill()
    run.wait()
    t.check(len(temporaries(t.path("cut"))) == 1, "a killed run leaves its temporary")
    t.run((0, 8), "animate", "anna-anatomy.glb", "walk.bvh", "-o", "cut/x.pc2")
    t.check(os.listdir(t.path("cut")) == ["x.pc2"], f"left of a killed run: {os.listdir(t.path('cut'))}")


def limits(t):
    """Little memory, few files, a small stack: a clear end, no crash."""
    def limited(kind, value, *command):
        return subprocess.run([t.program, *command], cwd=t.folder, capture_output=True, text=True, preexec_fn=lambda: resource.setrlimit(kind, (value, value)))
    for megabytes in (200, 300, 400, 500):
        done = limited(resource.RLIMIT_AS, megabytes << 20, "fit", "anna.glb", "-o", "small.glb")
        t.check(done.returncode in (0, 5, 8), f"{megabytes} MB: exit {done.returncode}: {done.stderr[-200:]}")
    done = limited(resource.RLIMIT_NOFILE, 16, "body", "new", "--sex", "male", "-o", "few.glb")
    t.check(done.returncode in (0, 5, 6), f"16 files: exit {done.returncode}: {done.stderr[-200:]}")


def main():
    t = Runner(sys.argv[1], sys.argv[2])
    prepare(t)
    for part in (places, full_disks, read_only, interrupts, kills, limits):
        if len(sys.argv) > 3 and part.__name__ not in sys.argv[3:]:
            continue
        try:
            part(t)
        except Exception as error:  # noqa: BLE001  one part must not hide the others
            t.check(False, f"{part.__name__}: {type(error).__name__}: {error}")
        print(part.__name__, flush=True)
    t.finish()


if __name__ == "__main__":
    main()
