#!/usr/bin/env python3
"""Makes bad inputs afresh, some eighty kinds of them, runs the program on each and holds it to what is stated of them. See SECURITY.md.

run.py PROGRAM SOURCE_FOLDER [--rows 3,17] [--seed N] [--mutants N] [--thorough] [--verbose] [--keep]

--seed     other mutants, from other places; the one that is used is said
--thorough more of them, and what is taken is fitted to the end; some ten minutes of a core more. As ECORCHE_THOROUGH in the environment
--keep     leave the inputs in the folder that is said
"""
import argparse
import copy
import os
import pathlib
import pwd
import resource
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import bench
import characters
import files
import meshes
import motions
import scans
import surroundings
import tables

LEFT_OUT = {20: "zip, gz and 3MF files are not read", 58: "C3D files are tried in row 86", 59: "TRC files are tried in row 86", 73: "nobody resizes a window here; the viewer's own tests do", 80: "there is no Python interface"}
MUSCLES = ("biceps_femoris_long_l", "soleus_r", "biceps_brachii_short_r", "rectus_abdominis_l")
BONES = ("femur_l", "tibia_r", "humerus_l", "scapula_l", "skull")
FASCIA = ("linea_alba",)


class Things:
    """The good files that the bad ones are made of, and what several rows need."""

    def __init__(self, found, source, options):
        self.bench, self.source = found, source
        self.seed, self.mutants, self.thorough = options.seed, options.mutants, options.thorough
        self.nobody = pwd.getpwnam("nobody").pw_uid if os.getuid() == 0 else None
        self.made = found.scratch / "in"
        self.made.mkdir(parents=True)
        for folder in (found.scratch, self.made):
            folder.chmod(0o755)
        self.body = self._make("anna.glb", ["body", "new", "--sex", "female", "--age", "30", "--height", "1.68", "--mass", "60", "-o"])
        whole = self._make("anna-anatomy.glb", ["fit", self.body, "-o"])
        self.skin = files.skin_of(*files.read_glb(self.body))
        self._small = files.smaller(*files.read_glb(whole), MUSCLES, BONES, FASCIA)
        self.small = found.file("small.glb", files.glb(*self._small))
        self.walk = files.Motion((source / "data/motions/walk.bvh").read_text())
        self.good_motion = found.file("good.bvh", self.walk.first(3).text())
        self.crowd = self._make_crowd()

    def _make(self, name, arguments):
        path = self.bench.file(name)
        done = self.bench.run([*arguments, path], seconds=300, megabytes=0)
        if done.code not in (0, 8):
            raise SystemExit(f"{name} could not be made: exit {done.code}, signal {done.signal}: {done.stderr}")
        return path

    def _make_crowd(self):
        folder = self.bench.file("crowd")
        table = self.bench.file("people.csv", "name,sex,stature\nada,female,1.70\nbob,male,1.80\n")
        folder.mkdir()
        crowd = folder / "crowd.gltf"
        done = self.bench.run(["body", "population", table, "--skins", "-o", folder, "--crowd", crowd], seconds=600, megabytes=0)
        if done.code not in (0, 8):
            raise SystemExit(f"a crowd could not be made: {done.stderr}")
        return crowd

    def small_parts(self):
        return copy.deepcopy(self._small[0]), self._small[1]

    def changed_small(self, change):
        return files.glb(files.changed(self._small[0], change), self._small[1])

    def crowd_text(self):
        return self.crowd.read_text()

    def scene_of(self, shapes, names):
        """A glTF scene with a node a mesh: document and binary chunk."""
        binary, views, accessors, scene_meshes = b"", [], [], []
        for vertices, faces in shapes:
            for data, kind, count, shape in ((b"".join(struct.pack("<3f", *v) for v in vertices), 5126, len(vertices), "VEC3"), (b"".join(struct.pack("<3I", *f) for f in faces), 5125, 3 * len(faces), "SCALAR")):
                views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": len(data)})
                accessors.append({"bufferView": len(views) - 1, "componentType": kind, "count": count, "type": shape})
                binary += data
            scene_meshes.append({"primitives": [{"attributes": {"POSITION": len(accessors) - 2}, "indices": len(accessors) - 1}]})
        return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(names)))}], "nodes": [{"mesh": k, "name": name} for k, name in enumerate(names)],
                "meshes": scene_meshes, "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(binary)}]}, binary

    def animate(self, row, what, codes, character=None, motion=None, more=(), says=(), **options):
        """A character moved by a motion, one of which is bad."""
        self.bench.case(row, what, ["animate", character or self.small, motion or self.good_motion, "-o", "{out}/m.pc2", *more], codes, says, **options)

    def near_body(self, cache, metres=20.0):
        """Whether all of a vertex cache lies within so many metres of its own middle, frame by frame; a word where it does not."""
        data = cache.read_bytes()
        points, frames = struct.unpack("<i", data[16:20])[0], struct.unpack("<i", data[28:32])[0]
        for f in range(frames):
            values = struct.unpack_from(f"<{3 * points}f", data, 32 + 12 * points * f)
            middle = [sum(values[k::3]) / points for k in range(3)]
            if not all(abs(m) <= 1e5 for m in middle) or not all(abs(v - middle[i % 3]) <= min(metres, 12.0) for i, v in enumerate(values)):
                return f"frame {f} has vertices far from its body"
        return ""

    def out(self, user=None, name="m.glb"):
        """An output; for a run by somebody else in a folder of their own, the only one that they may write to."""
        if user is None:
            return "{out}/" + name
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.bench.scratch))
        os.chown(folder, user, -1)
        return folder / name

    def osim(self, mesh=None, points=((0.1, 0, 0), (0.02, -0.2, 0.01)), bodies=0):
        """An OpenSim model of two bones and a muscle."""
        geometry = f"<attached_geometry><Mesh name='m'><mesh_file>{mesh}</mesh_file></Mesh></attached_geometry>" if mesh else ""
        frames = ["tibia_r", "femur_r"] if len(points) == 2 else ["femur_r"] * len(points)
        path = "".join(f"<PathPoint name='p{k}'>\n<socket_parent_frame>/bodyset/{frame}</socket_parent_frame>\n<location>{p[0]:g} {p[1]:g} {p[2]:g}</location></PathPoint>\n" for k, (frame, p) in enumerate(zip(frames, points)))
        names = ["pelvis", "femur_r", "tibia_r", *[f"b{k}" for k in range(bodies)]]
        joints = "".join(f"<PinJoint name='j_{child}'><socket_parent_frame>/{'ground' if not k else 'bodyset/' + names[k - 1]}_o{k}</socket_parent_frame><socket_child_frame>/bodyset/{child}</socket_child_frame>"
                         f"<coordinates><Coordinate name='q_{child}'/></coordinates><frames><PhysicalOffsetFrame name='{'ground' if not k else names[k - 1]}_o{k}'><socket_parent>/{'ground' if not k else 'bodyset/' + names[k - 1]}</socket_parent>"
                         f"<translation>0 -0.4 0</translation><orientation>0 0 0</orientation></PhysicalOffsetFrame></frames></PinJoint>\n" for k, child in enumerate(names[:3]))
        return ("<?xml version='1.0'?>\n<OpenSimDocument Version='40000'>\n<Model name='leg'>\n<credits>nobody</credits>\n<BodySet><objects>\n" + "".join(f"<Body name='{name}'>{geometry if name == 'femur_r' else ''}</Body>\n" for name in names)
                + f"</objects></BodySet>\n<JointSet><objects>\n{joints}</objects></JointSet>\n<ForceSet><objects>\n<Millard2012EquilibriumMuscle name='hamstring_r'><GeometryPath name='path'><PathPointSet><objects>\n{path}</objects></PathPointSet></GeometryPath>"
                  "<max_isometric_force>1000</max_isometric_force><optimal_fiber_length>0.1</optimal_fiber_length><tendon_slack_length>0.2</tendon_slack_length></Millard2012EquilibriumMuscle>\n</objects></ForceSet>\n</Model>\n</OpenSimDocument>\n")

    def german_locale(self):
        """An environment with decimal commas, made with the system's own sources; None where there are none."""
        folder = self.bench.file("locale")
        folder.mkdir(exist_ok=True)
        made = subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", str(folder / "de_DE.UTF-8")], capture_output=True) if shutil.which("localedef") else None
        return {"LOCPATH": str(folder), "LC_ALL": "de_DE.UTF-8"} if made and (folder / "de_DE.UTF-8").is_dir() else None

    def case(self, row, what, arguments, codes, says=(), stdout=None, **options):
        """A case of the bench whose standard output may be a file's name."""
        if isinstance(stdout, str):
            stdout = os.open(stdout, os.O_WRONLY)
        return self.bench.case(row, what, arguments, codes, says, **({"stdout": stdout} if stdout is not None else {}), **options)

    def closed_pipe(self):
        reading, writing = os.pipe()
        os.close(reading)
        return writing

    def can_mount(self):
        place = self.bench.file("mount")
        place.mkdir(exist_ok=True)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=4k", "none", place], capture_output=True).returncode != 0:
            return False
        subprocess.run(["umount", place])
        return True

    def on_full_disk(self, row, what, size, arguments, old=False):
        if self.bench.only and row not in self.bench.only:
            return
        place = pathlib.Path(tempfile.mkdtemp(dir=self.bench.scratch))
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "none", place], check=True)
        before = b"what was there before"
        if old:
            (place / "old.glb").write_bytes(before)

        def after(out, done):
            left = {p.name: p.read_bytes() for p in place.iterdir()}
            subprocess.run(["umount", place])
            return "" if left == ({"old.glb": before} if old else {}) else f"on the disk: {sorted(left)}"

        self.bench.case(row, what, [str(a).replace("{disk}", str(place)) for a in arguments], 6, after=after)

    def kill_case(self, row, number, delay):
        out = pathlib.Path(tempfile.mkdtemp(dir=self.bench.scratch))
        child = subprocess.Popen([self.bench.program, "animate", self.small, self.source / "data/motions/walk.bvh", "-o", out / "m.pc2", "-o", out / "m.glb"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(delay)
        child.send_signal(number)
        code = child.wait()
        left = {p.name for p in out.iterdir()}
        self.bench.count += 1
        wrong = [name for name in left if not name.startswith(".")] if code != 0 else []
        if number != signal.SIGKILL and code != 0:
            wrong += [name for name in left if name.startswith(".")]
            if code not in (128 + number, -number):
                wrong.append(f"an exit code that is not {128 + number}")
        for name in wrong:
            self.bench._fail(row, f"{signal.Signals(number).name} after {delay} s", f"exit {code}, left {name}", [out])

    def caches(self):
        home = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.environ.get("HOME", "/nowhere"), ".cache")
        return sorted(p for p in (pathlib.Path(home) / "ecorche").glob("*.template") if p.is_file() and p.stat().st_size > 1000)[:1]

    def other_template(self):
        """The template of another table of data: the cache file of a program whose muscles are others."""
        data = self.bench.file("other_data")
        if not data.exists():
            shutil.copytree(self.source / "data", data)
            table = data / "fat.csv"
            table.write_text(table.read_text() + "# another table\n")
            joints = data / "poses.csv"
            joints.write_text(joints.read_text() + "# another table\n")
        home = self.bench.file("other_cache")
        home.mkdir(exist_ok=True)
        self.bench.run(["template", "info"], seconds=300, megabytes=0, environment={"ECORCHE_DATA": str(data), "XDG_CACHE_HOME": str(home)})
        return next((home / "ecorche").glob("*.template")).read_bytes()


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("source", type=pathlib.Path)
    parser.add_argument("--rows", default="")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--mutants", type=int)
    parser.add_argument("--workers", type=int, default=2)
    for flag in ("thorough", "verbose", "keep"):
        parser.add_argument("--" + flag, action="store_true")
    options = parser.parse_args()
    options.thorough = bench.THOROUGH
    if options.mutants is None:
        options.mutants = 40 if options.thorough else 6
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="ecorche-bad-inputs-"))
    begin = time.monotonic()
    only = {int(row) for row in options.rows.split(",") if row}
    found = bench.Bench(options.program.resolve(), scratch, only, options.workers, options.verbose)
    try:
        things = Things(found, options.source.resolve(), options)
        for module in (meshes, characters, motions, scans, tables, surroundings):
            for name, function in vars(module).items():
                if name in ("crowds", "models") or (name.startswith("row_") and (not only or int(name[4:]) in only)):
                    function(things)
        found.finish()
    finally:
        if options.keep:
            print("the inputs are in", scratch)
        else:
            shutil.rmtree(scratch, ignore_errors=True)
    for title, lines in (("skipped", found.skipped), ("left out", [f"{row:>3} {why}" for row, why in LEFT_OUT.items()])):
        if lines:
            print(f"{title}:\n  " + "\n  ".join(lines))
    silent = sorted(set(range(1, 81)) - set(found.rows) - set(LEFT_OUT)) if not only else []
    if silent:
        print("rows without a case:", silent)
    print(f"{found.count} inputs of {len(found.rows)} rows, {len(found.failures)} not as stated; seed {options.seed}; {time.monotonic() - begin:.0f} s; most memory {found.most_memory[0]:.0f} MB ({found.most_memory[1]}), "
          f"longest {found.most_time[0]:.1f} s of a processor ({found.most_time[1]})")
    return 1 if found.failures or silent else 0


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.exit(main())
