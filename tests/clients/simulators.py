"""python simulators.py MODEL.xml|MODEL.osim   Loads an exported model in MuJoCo or OpenSim, checks that it stands as it should, and steps it.

MuJoCo: 1000 steps with all muscles at rest, then 1000 with all at a tenth; nothing may become infinite. OpenSim: the system is built, coordinates are at
their defaults, muscle lengths, forces and accelerations are finite, and half a millisecond is integrated (800 muscles take a second a step)."""
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


if sys.argv[1].endswith(".osim"):
    opensim_steps(sys.argv[1])
else:
    mujoco_steps(sys.argv[1])
