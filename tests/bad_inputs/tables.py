"""Bad tables and models: rows 46 (of tables), 60 (of models), 62 and 78."""
import random


def weights(t, row, name, text, codes=3, says=(), **options):
    path = t.bench.file(f"{name}.csv", text)
    t.animate(row, f"weights: {name}", more=["--weights", path], codes=codes, says=says, names=path.name, **options)


def poses(t, row, name, text, codes=3, says=()):
    path = t.bench.file(f"{name}.csv", text)
    t.bench.case(row, f"poses: {name}", ["posebook", t.small, "--poses", path, "-o", "{out}/p", "--no-pictures", "--methods", "anchors"], codes, says,
                 names=path.name, may_leave=codes != 3)


def people(t, row, name, text, codes=3, says=()):
    path = t.bench.file(f"{name}.csv", text)
    t.bench.case(row, f"people: {name}", ["body", "population", path, "--skins", "-o", "{out}/p"], codes, says, names=path.name, may_leave=True)


def activation(t, row, name, text, codes=3, says=()):
    path = t.bench.file(name, text)
    t.animate(row, f"activation: {name}", more=["--activation", path], codes=codes, says=says, names=path.name)


def row_46(t):
    """People of too few, too many, unknown measures, or the same twice: file and row are said, and what was meant."""
    people(t, 46, "unknown_measure", "name,sex,girth_of_ears\na,male,3cm\n", (2, 3), [":1", "list measures"])
    people(t, 46, "measure_twice", "name,sex,stature,stature\na,male,1.8,1.8\n", (2, 3), [":1", "two columns"])
    people(t, 46, "no_rows", "name,sex,stature\n", 3)
    people(t, 46, "cells_missing", "name,sex,stature\na,male\n", 3, ":2")
    people(t, 46, "cells_too_many", "name,sex,stature\na,male,1.8,2,3,4\n", 3, ":2")
    people(t, 46, "word", "name,sex,stature\na,male,abc\n", 3, [":2", "stature", "abc"])
    people(t, 46, "sex", "name,sex,stature\na,cat,1.8\n", 3, [":2", "cat"])
    people(t, 46, "sex_missing", "name,stature\na,1.8\n", 3, [":2", "sex"])
    people(t, 46, "name_that_leads_away", "name,sex,stature\n../../x,male,1.8\n", 3, ":2")
    people(t, 46, "one_of_two", "name,sex,stature\na,male,tall\nb,male,1.8\n", 8, ":2")
    people(t, 46, "name_twice", "name,sex,stature\nb,male,1.7\nb,male,1.8\n", 8, ":3")
    people(t, 46, "people_quote_open", 'name,sex,stature\n"a,male,1.8\n', 3, ":2")


def row_62(t):
    """Tables whose columns, rows and cells are not what their use needs."""
    weights(t, 62, "columns_other", "a,b,c\n1,2,3\n", 3, "vertex")
    weights(t, 62, "column_twice", "vertex,joint,joint\n0,a,b\n", 3, ":1")
    weights(t, 62, "vertex_beyond", "vertex,joint,weight\n99999999,knee_l,1\n", 3, ":2")
    weights(t, 62, "vertex_half", "vertex,joint,weight\n0.5,knee_l,1\n", 3, ":2")
    weights(t, 62, "vertex_minus", "vertex,joint,weight\n-1,knee_l,1\n", 3, ":2")
    weights(t, 62, "joint_unknown", "vertex,joint,weight\n0,tail,1\n", 3, [":2", "tail"])
    weights(t, 62, "weight_nan", "vertex,joint,weight\n0,knee_l,nan\n", 3, ":2")
    weights(t, 62, "weight_9", "vertex,joint,weight\n0,knee_l,9\n", 3, ":2")
    weights(t, 62, "sum_of_half", "vertex,joint,weight\n0,knee_l,0.5\n", 3, ":2")
    weights(t, 62, "joint_twice", "vertex,joint,weight\n0,knee_l,0.5\n0,knee_l,0.5\n", 3, ":3")
    weights(t, 62, "header_alone", "vertex,joint,weight\n", 3, "no weights")
    weights(t, 62, "quote_open", 'vertex,joint,weight\n0,"knee_l,1\n', 3, ":2")
    weights(t, 62, "wide", ",".join(f"c{i}" for i in range(20000)) + "\n", 5, "columns")
    weights(t, 62, "very_long", "vertex,joint,weight\n" + "0,knee_l,1\n" * 5000000, (3, 5), (), seconds=40, megabytes=900)
    weights(t, 62, "too_large", "vertex,joint,weight\n" + "0,knee_l,1\n" * 6500000, 5, "the limit is", megabytes=300)
    poses(t, 62, "pose_of_a_tail", "name,label,view,angles\nx,x,front,tail 90\n", 3, ":2")
    poses(t, 62, "pose_of_words", "name,label,view,angles\nx,x,front,elbow much\n", 3, ":2")
    poses(t, 62, "pose_of_1e9", "name,label,view,angles\nx,x,front,elbow 1e9\n", 3, ":2")
    poses(t, 62, "pose_twice", "name,label,view,angles\nx,x,front,elbow 9\nx,x,front,elbow 9\n", 3, ":3")
    poses(t, 62, "pose_without_columns", "name\nx\n", 3, "label")
    poses(t, 62, "poses_of_nothing", "name,label,view,angles\n", 3, "poses")
    for name, text, says in (("share_9", "pose,joint,flexion,abduction,rotation\nx,knee,9,0,0\n", ":2"), ("no_name", "pose,joint,flexion,abduction,rotation\n,,0,0,0\n", ":2"), ("no_columns", "a\n1\n", "column"), ("none", "pose,joint,flexion,abduction,rotation\n", "pose"),
                             ("no_such_joint", "pose,joint,flexion,abduction,rotation\nx,tail,0.1,0,0\n", ":2")):
        path = t.bench.file(f"check_{name}.csv", text)
        t.bench.case(62, f"check --poses {name}", ["check", t.small, "--poses", path, "--no-sweeps"], 3, [path.name, says])
    activation(t, 62, "unknown.csv", "time,tail\n0,1\n", 3, "tail")
    activation(t, 62, "no_time.csv", "soleus_r\n1\n", 3, "time")
    activation(t, 62, "over.csv", "time,soleus_r\n0,55\n", 3, ":2")
    activation(t, 62, "falls.csv", "time,soleus_r\n1,0\n0,1\n", 3, ":3")
    activation(t, 62, "nan.csv", "time,soleus_r\nnan,0\n", 3, ":2")
    activation(t, 62, "time_alone.csv", "time\n0\n", 3)
    activation(t, 62, "rows_none.csv", "time,soleus_r\n", 3, "rows")
    activation(t, 62, "twice.csv", "time,muscle,value\n0,soleus_r,1\n0,soleus_r,0\n", 3, ":3")
    activation(t, 62, "long_name.csv", "time," + "x" * 3000000 + "\n0,1\n", 5, "bytes")
    activation(t, 62, "no_end.sto", "version=1\nnRows=1\ntime soleus_r\n0 1\n", 3, "endheader")
    activation(t, 62, "labels_none.sto", "endheader\n", 3, "labels")
    activation(t, 62, "label_twice.sto", "endheader\ntime soleus_r soleus_r\n0 1 1\n", 3, ":2")
    activation(t, 62, "cell_blank.sto", "endheader\ntime soleus_r\n0\n", 3, ":3")
    activation(t, 62, "cell_more.sto", "endheader\ntime soleus_r\n0 1 2\n", 3, ":3")
    activation(t, 62, "word.mot", "endheader\ntime soleus_r\n0 on\n", 3, ":3")
    activation(t, 62, "rows_lie.sto", "nRows=99\nnColumns=7\nendheader\ntime soleus_r\n0 1\n1 0\n", 0)
    activation(t, 62, "of_another_kind.txt", "x", 3, "kind")


def row_78(t):
    """Line ends of other systems, byte order marks, UTF-16."""
    texts = {"weights.csv": ("--weights", "vertex,joint,weight\n0,knee_l,0.5\n0,hip_l,0.5\n"), "map.map": ("--map", "Nobody = \n"), "activation.csv": ("--activation", "time,soleus_r\n0,0\n1,1\n"),
             "activation.sto": ("--activation", "name\nversion=1\nendheader\ntime\tsoleus_r\n0\t0\n1\t1\n")}
    turned = {"crlf": lambda s: s.replace("\n", "\r\n").encode(), "cr": lambda s: s.replace("\n", "\r").encode(), "bom": lambda s: b"\xef\xbb\xbf" + s.encode(), "bom_crlf": lambda s: b"\xef\xbb\xbf" + s.replace("\n", "\r\n").encode()}
    wide = {"utf16": lambda s: s.encode("utf-16"), "utf16_be": lambda s: b"\xfe\xff" + s.encode("utf-16-be"), "utf16_bare": lambda s: s.encode("utf-16-le")}
    for name, (option, text) in texts.items():
        for kind, turn in turned.items():
            t.animate(78, f"{name} with {kind}", more=[option, t.bench.file(f"{kind}_{name}", turn(text))], codes=0)
        for kind, turn in wide.items():
            t.animate(78, f"{name} in {kind}", more=[option, t.bench.file(f"{kind}_{name}", turn(text))], codes=3, says=[f"{kind}_{name}", "utf-16"])
    walk = t.walk.first(3).text()
    rows = "name,sex,stature\nada,female,1.70\n"
    book = "name,label,view,angles\nbent,bent,front,elbow 90\n"
    for kind, turn in turned.items():
        t.animate(78, f"a motion with {kind}", motion=t.bench.file(f"{kind}.bvh", turn(walk)), codes=0)
        t.bench.case(78, f"people with {kind}", ["body", "population", t.bench.file(f"people_{kind}.csv", turn(rows)), "--skins", "-o", "{out}/p"], 0)
        poses(t, 78, f"book_{kind}", turn(book), 0)
        t.bench.case(78, f"a model with {kind}", ["template", "import", t.bench.file(f"{kind}.osim", turn(t.osim())), "-o", "{out}/c.glb"], (0, 4, 8), writes=False)
    for kind, turn in wide.items():
        t.animate(78, f"a motion in {kind}", motion=t.bench.file(f"{kind}.bvh", turn(walk)), codes=3, says=[f"{kind}.bvh", "utf-16"])
        t.bench.case(78, f"a skin in {kind}", ["fit", t.bench.file(f"{kind}.obj", turn("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")), "-o", "{out}/c.glb"], 3, [f"{kind}.obj", "utf-16"])
        t.bench.case(78, f"people in {kind}", ["body", "population", t.bench.file(f"people_{kind}.csv", turn(rows)), "--skins", "-o", "{out}/p"], 3, [f"people_{kind}.csv", "utf-16"])
        t.bench.case(78, f"poses in {kind}", ["posebook", t.small, "--poses", t.bench.file(f"book_{kind}.csv", turn(book)), "-o", "{out}/p", "--no-pictures"], 3, [f"book_{kind}.csv", "utf-16"])


def models(t):
    """Musculoskeletal models that are none (row 60 of what is imported)."""
    def model(name, text, codes=3, says=(), **options):
        path = t.bench.file(name, text)
        t.bench.case(60, f"model: {name}", ["template", "import", path, "-o", "{out}/c.glb"], codes, says, names=path.name, **options)

    good = t.osim()
    changes = [("location", "0.1 0 0", "0.1 nan 0", "finite"), ("location_far", "0.1 0 0", "1e300 0 0", ()), ("location_comma", "0.1 0 0", "0,1 0 0", "finite"), ("parent_gone", "/bodyset/tibia_r</socket_parent_frame>\n<location>", "/bodyset/x</socket_parent_frame>\n<location>", ()),
               ("force_minus", "<max_isometric_force>1000", "<max_isometric_force>-1", "negative"), ("force_1e300", "<max_isometric_force>1000", "<max_isometric_force>1e300", ()),
               ("fibre_1e300", "<optimal_fiber_length>0.1", "<optimal_fiber_length>1e300", ()), ("place_1e300", "<translation>0 -0.4 0", "<translation>0 -1e300 0", ()), ("turn_1e300", "<orientation>0 0 0", "<orientation>1e300 0 0", ())]
    for name, old, new, says in changes:
        assert old in good, name
        model(f"model_{name}.osim", good.replace(old, new, 1), (3, 4, 5), says)
    model("model_turns_back.osim", t.osim(points=[(0, 0.1, 0), (0, 0.2, 0), (0, 0.1, 0)]), (0, 3, 4), ())
    model("model_in_one_place.osim", t.osim(points=[(0, 0, 0)] * 3), (3, 4))
    model("model_cut.osim", good[:len(good) // 2], 3, "byte")
    model("model_deep.osim", good.replace("<Model", "<a>" * 100000 + "<Model"), 5, "nested")
    model("model_entities.osim", '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>' + good.replace("<credits>", "<credits>&b;", 1), (0, 3, 4), ())
    model("model_many.osim", t.osim(bodies=30000), 5, "more than")
    model("tree.xml", "<mujoco><worldbody>" + "<body>" * 200 + "</body>" * 200 + "</worldbody></mujoco>", 5, "nested")
    model("includes_itself.xml", '<mujoco><include file="includes_itself.xml"/></mujoco>', 5, "includ")
    model("pos_1e300.xml", '<mujoco><worldbody><body name="pelvis" pos="1e300 0 0"><site name="a" pos="0 0 0"/><body name="femur_r" pos="0 -1e300 0"><joint/><site name="b"/></body></body></worldbody>'
          '<tendon><spatial name="t"><site site="a"/><site site="b"/></spatial></tendon><actuator><muscle tendon="t"/></actuator></mujoco>', (3, 4), ())
    rng = random.Random(t.seed + 60)
    for k in range(max(4, t.mutants // 8)):
        at = rng.randrange(len(good))
        model(f"mutant_{k}.osim", good[:at] + rng.choice("0123456789<>/- .eE") + good[at + 1:], (0, 3, 4, 5))
