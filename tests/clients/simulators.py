"""python simulators.py MODEL.xml|MODEL.osim [MOTION.mot MARKERS.trc MOTION.glb]   Loads an exported model in MuJoCo or OpenSim, checks that it stands as it
should, and steps it.

MuJoCo: 1000 steps with all muscles at rest, then 1000 with all at a tenth; nothing may become infinite. OpenSim: the system is built, coordinates are at
their defaults, muscle lengths, forces and accelerations are finite, and half a millisecond is integrated (800 muscles take a second a step).
With a ground: held stiff, the model stands on it with its whole weight between its feet.
With a motion (OpenSim): its angles move every body of the model to where the same motion's .glb has the joint, and its markers are read in their places."""
import math
import sys


def mujoco_steps(path):
    import mujoco

    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert model.nu > 0 and all(math.isfinite(x) for x in data.ten_length), "tendon lengths"
    for effort in (0.0, 0.1):
        data.ctrl[:] = effort
        for _ in range(1000):
            mujoco.mj_step(model, data)
        assert all(math.isfinite(x) for x in data.qpos), "positions are not finite"
        warnings = [w.number for w in data.warning]
        assert sum(warnings[mujoco.mjtWarning.mjWARN_BADQPOS : mujoco.mjtWarning.mjWARN_BADQACC + 1]) == 0, "bad state: %s" % warnings
    print("MuJoCo %s: %d bodies, %d coordinates, %d muscles, 2000 steps" % (mujoco.__version__, model.nbody - 1, model.nq, model.nu))


def opensim_steps(path):
    import opensim

    opensim.Logger.setLevelString("Error")
    model = opensim.Model(path)
    state = model.initSystem()
    model.equilibrateMuscles(state)
    model.realizeAcceleration(state)
    assert all(math.isfinite(state.getUDot().get(i)) for i in range(state.getNU())), "accelerations are not finite"
    muscles = model.getMuscles()
    for i in range(muscles.getSize()):
        muscle = muscles.get(i)
        assert math.isfinite(muscle.getLength(state)) and math.isfinite(muscle.getTendonForce(state)), muscle.getName()
    manager = opensim.Manager(model)
    manager.setIntegratorMethod(opensim.Manager.IntegratorMethod_SemiExplicitEuler2)
    manager.setIntegratorAccuracy(0.1)
    manager.initialize(state)
    state = manager.integrate(5e-4)
    assert all(math.isfinite(state.getQ().get(i)) for i in range(state.getNQ())), "positions are not finite"
    print("OpenSim %s: %d bodies, %d muscles, 0.5 ms" % (opensim.GetVersion(), model.getNumBodies(), muscles.getSize()))


def mujoco_stands(path):
    import mujoco
    import numpy as np

    model = mujoco.MjModel.from_xml_path(path)
    if mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "floor") < 0:
        return
    data = mujoco.MjData(model)
    for joint in range(model.njnt):
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            model.jnt_stiffness[joint] = 20000
            model.dof_damping[model.jnt_dofadr[joint]] = 200
            model.qpos_spring[model.jnt_qposadr[joint]] = model.qpos0[model.jnt_qposadr[joint]]
    model.opt.timestep = 5e-4
    begin, forces = data.qpos[:3].copy(), []
    for step in range(4000):
        mujoco.mj_step(model, data)
        if step < 3000:
            continue
        total, force = 0.0, np.zeros(6)
        for contact in range(data.ncon):
            mujoco.mj_contactForce(model, data, contact, force)
            total += force[0]
        forces.append(total)
    weight = sum(model.body_mass) * 9.81
    upright = data.xmat[1].reshape(3, 3)[2, 2]
    held = np.mean(forces) / weight
    assert abs(held - 1) < 0.02, "the ground holds %.3f of the weight" % held
    assert np.linalg.norm(data.qpos[:3] - begin) < 0.03 and upright > 0.995, "it does not stand: %s, %.3f" % (data.qpos[:3] - begin, upright)
    print("MuJoCo: stands for 2 s, the ground holds %.3f of %.0f N, moved %.1f mm" % (held, weight, 1e3 * np.linalg.norm(data.qpos[:3] - begin)))


def opensim_stands(path):
    import opensim

    opensim.Logger.setLevelString("Error")
    model = opensim.Model(path)
    if model.getContactGeometrySet().getSize() == 0:
        return
    state = model.initSystem()
    height = model.getCoordinateSet().get("pelvis_ty")
    contacts = [f for f in (model.getForceSet().get(i) for i in range(model.getForceSet().getSize())) if f.getName().startswith("contact_")]

    def held():
        model.realizeDynamics(state)
        sides = {"l": 0.0, "r": 0.0}
        for force in contacts:
            sides[force.getName()[-1]] += force.getRecordValues(state).get(1)
        return sides

    low, high = -0.02, 0.005
    weight = model.getTotalMass(state) * 9.80665
    for _ in range(40):
        middle = 0.5 * (low + high)
        height.setValue(state, middle)
        low, high = (middle, high) if sum(held().values()) > weight else (low, middle)
    sides = held()
    assert abs(sum(sides.values()) / weight - 1) < 0.01, "no height at which the ground holds the weight"
    assert abs(sides["l"] - sides["r"]) < 0.1 * weight, "it stands on one foot: %s" % sides
    print("OpenSim: the ground holds the weight with the pelvis %.1f mm lower" % (-1e3 * height.getValue(state)))


def joints_of_glb(path, times):
    """World places of the joints of an animated .glb: name -> #times x 3."""
    import json
    import struct

    import numpy as np

    with open(path, "rb") as f:
        content = f.read()
    length = struct.unpack_from("<I", content, 12)[0]
    doc, binary = json.loads(content[20 : 20 + length]), content[28 + length :]

    def values(index):
        accessor = doc["accessors"][index]
        view = doc["bufferViews"][accessor["bufferView"]]
        parts = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        return np.frombuffer(binary, "<f4", accessor["count"] * parts, view.get("byteOffset", 0)).reshape(-1, parts)

    curves = {}
    animation = doc["animations"][0]
    for channel in animation["channels"]:
        sampler = animation["samplers"][channel["sampler"]]
        curves[channel["target"]["node"], channel["target"]["path"]] = (values(sampler["input"])[:, 0], values(sampler["output"]))

    def at(node, what, time, default):
        if (node, what) not in curves:
            return default
        keys, rows = curves[node, what]
        return rows[int(np.argmin(np.abs(keys - time)))]

    def turn(q):
        x, y, z, w = q
        return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                         [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])

    joints, out = set(doc["skins"][0]["joints"]), {}

    def walk(node, R, p, time):
        own = doc["nodes"][node]
        place = p + R @ np.array(at(node, "translation", time, own.get("translation", (0, 0, 0))), dtype=float)
        here = R @ turn(np.array(at(node, "rotation", time, (0, 0, 0, 1)), dtype=float))
        out.setdefault(own["name"], []).append(place)
        for child in own.get("children", []):
            if child in joints:
                walk(child, here, place, time)

    for time in times:
        walk(doc["skins"][0]["joints"][0], np.eye(3), np.zeros(3), time)
    return {name: np.array(rows) for name, rows in out.items()}


def opensim_moves(path, angles, markers, glb):
    import numpy as np
    import opensim

    opensim.Logger.setLevelString("Error")
    model = opensim.Model(path)
    state = model.initSystem()
    table = opensim.TimeSeriesTable(angles)
    assert table.getTableMetaDataString("inDegrees") == "yes"
    labels, times = list(table.getColumnLabels()), list(table.getIndependentColumn())
    coordinates = model.getCoordinateSet()
    names = {coordinates.get(i).getName() for i in range(coordinates.getSize())}
    assert set(labels) == names, "coordinates and columns differ: %s" % sorted(set(labels) ^ names)[:4]
    frames = [round(share * (len(times) - 1)) for share in (0, 0.3, 0.6, 1)]
    places = joints_of_glb(glb, [times[f] for f in frames])
    worst, where, sums, count = 0, "", 0, 0
    for at, frame in enumerate(frames):
        row = table.getRowAtIndex(frame)
        for i, label in enumerate(labels):
            value = row[i] if label.endswith(("_tx", "_ty", "_tz")) else math.radians(row[i])
            coordinate = coordinates.get(label)
            if not coordinate.isConstrained(state):
                coordinate.setValue(state, value, False)
        model.assemble(state)
        model.realizePosition(state)
        for name, rows in places.items():
            x, y, z = rows[at]
            there = model.getBodySet().get(name).getPositionInGround(state)
            off = np.linalg.norm([there[0] - z, there[1] - y, there[2] + x])
            sums, count = sums + off, count + 1
            if off > worst:
                worst, where = off, name
    read = opensim.TimeSeriesTableVec3(markers)
    assert read.getNumRows() == len(times) and read.getNumColumns() > 50, "%d x %d markers" % (read.getNumRows(), read.getNumColumns())
    assert read.getTableMetaDataString("Units") == "m"
    # Skin slides over bone, but not far: the model's markers lie near those of the motion.
    last = read.getRowAtIndex(len(times) - 1)
    gaps = []
    for i, label in enumerate(read.getColumnLabels()):
        own, there = model.getMarkerSet().get(label).getLocationInGround(state), last[i]
        gaps.append(math.dist([own[k] for k in range(3)], [there[k] for k in range(3)]))
    print("OpenSim: %d coordinates over %d frames put bodies %.2f mm from the .glb's joints on average, at most %.1f (%s); %d markers, %.0f mm from the bones' own in the middle"
          % (len(labels), len(times), 1e3 * sums / count, 1e3 * worst, where, len(gaps), 1e3 * sorted(gaps)[len(gaps) // 2]))
    assert worst < 0.03 and sums / count < 0.005, "bodies are not where the joints are"
    assert sorted(gaps)[len(gaps) // 2] < 0.03, "markers are not where the skin is"


if sys.argv[1].endswith(".osim"):
    if len(sys.argv) > 2:
        opensim_moves(*sys.argv[1:5])
    else:
        opensim_steps(sys.argv[1])
        opensim_stands(sys.argv[1])
else:
    mujoco_steps(sys.argv[1])
    mujoco_stands(sys.argv[1])
