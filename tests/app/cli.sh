#!/usr/bin/env bash
# The command line as people and scripts use it: exit codes, whole outputs or none, same bytes at any number of threads, and that
# other programs can read what is written.   Usage: cli.sh ECORCHE SOURCE_FOLDER BUILD_FOLDER
set -u
ecorche=$1 source=$2 build=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder" || exit 1
passed=0 failed=0 skipped=0

ok() { passed=$((passed + 1)); }
bad() { failed=$((failed + 1)); echo "FAILED: $*"; }
skip() { skipped=$((skipped + 1)); echo "skipped: $*"; }

# expect CODE[,CODE] WHAT COMMAND...
expect() {
  local codes=$1 what=$2; shift 2
  "$@" > out.txt 2> err.txt
  local code=$?
  case ",$codes," in *",$code,"*) ok ;; *) bad "$what: exit $code, expected $codes: $*"; sed 's/^/    /' err.txt out.txt | head -5 ;; esac
}
# says TEXT: the last command's errors name it
says() { if grep -qi -- "$1" err.txt; then ok; else bad "the message does not say '$1': $(cat err.txt)"; fi; }
there() { if [ -s "$1" ]; then ok; else bad "$1 is missing"; fi; }
absent() { if [ ! -e "$1" ]; then ok; else bad "$1 should not exist"; fi; }

# Help and usage.
expect 0 "help" "$ecorche" --help
for verb in demo "template info" "template check" "template sweep" "template import" "body new" "body measure" "body modify" "body population" "body register" "body size" "body statistics" fit animate export render view bench check bake posebook lift lie; do
  # shellcheck disable=SC2086
  expect 0 "help of $verb" "$ecorche" $verb --help
  if grep -q Example out.txt; then ok; else bad "help of $verb has no example"; fi
done
expect 2 "no verb" "$ecorche"
expect 2 "unknown verb" "$ecorche" dance
expect 2 "unknown sex" "$ecorche" body new --sex both -o a.glb
expect 2 "a height of 17 m" "$ecorche" body new --sex male --height 17 -o a.glb
expect 2 "a height that is no number" "$ecorche" body new --sex male --height tall -o a.glb
expect 2 "no output" "$ecorche" body new --sex male
absent a.glb

# Bodies.
expect 0 "a body" "$ecorche" body new --sex female --age 30 --height 1.68 --mass 60 -o anna.glb --report body.json
there anna.glb; there body.json
expect 4 "a body that cannot be" "$ecorche" body new --sex male --height 1.75 --mass 390 -o giant.glb
says "kg"; absent giant.glb
expect 6 "a missing folder" "$ecorche" body new --sex male -o no/where/a.glb
says "no/where"

# Fitting.
expect 2 "an unknown sex of a skin" "$ecorche" fit anna.glb -o c.glb --sex both
expect 2 "an alpha of nothing" "$ecorche" fit anna.glb -o c.glb --alpha 0
expect 3 "a body that is not there" "$ecorche" fit none.glb -o c.glb
: > empty.obj
expect 3 "an empty file" "$ecorche" fit empty.obj -o c.glb
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' > triangle.obj
expect 4 "a triangle" "$ecorche" fit triangle.obj -o c.glb
expect 3 "a missing package" env ECORCHE_PACKAGES="$folder" "$ecorche" body new --sex male -o c.glb
says "setup"; absent c.glb
expect 0,8 "a fit" "$ecorche" fit anna.glb -o anna-1.glb --threads 1 --report fit.json
there anna-1.glb; there fit.json
expect 0,8 "the same fit with two threads" "$ecorche" fit anna.glb -o anna-2.glb --threads 2
if cmp -s anna-1.glb anna-2.glb; then ok; else bad "one and two threads give different bytes"; fi
expect 0 "a part of it, for what does not need all muscles" python3 "$source/tests/command_line/part.py" anna-1.glb some.glb

# Sizes, changes, many people.
expect 0 "a size" "$ecorche" body new --sex female --size M -o m.glb
expect 0 "its size" "$ecorche" body size m.glb
if grep -q "^size M" out.txt; then ok; else bad "a body of size M is not found to be one: $(head -1 out.txt)"; fi
expect 2 "an unknown size" "$ecorche" body new --sex female --size XXS -o n.glb
says "XS"
expect 0 "a heavier body" "$ecorche" body modify m.glb --fat 34 -o heavier.glb --report heavier.json
there heavier.glb
expect 2 "a change without a value" "$ecorche" body modify m.glb --measure waist_girth -o n.glb
absent n.glb
printf 'name,sex,stature,waist_girth\nada,female,168cm,74cm\nbob,male,178cm,much\ncyd,male,1.80,90cm\n' > people.csv
printf 'name,sex,stature,waist_girth\ncyd,male,1.80,90cm\nada,female,168cm,74cm\n' > turned.csv
expect 8 "people with a bad row" "$ecorche" body population people.csv --skins -o people
says "people.csv:3"
there people/ada.glb; there people/cyd.glb; there people/population.csv; absent people/bob.glb
expect 0 "the others in another order" "$ecorche" body population turned.csv --skins -o turned
if cmp -s people/ada.glb turned/ada.glb && cmp -s people/cyd.glb turned/cyd.glb; then ok; else bad "the order of rows changes a body"; fi
rm turned/ada.glb
expect 0 "one of them gone" "$ecorche" body population turned.csv --skins -o turned --report again.json
if grep -q '"kept": 1' again.json && cmp -s people/ada.glb turned/ada.glb; then ok; else bad "only what is missing should be made"; fi
printf 'sex,girth_of_ears\nmale,3cm\n' > ears.csv
expect 2 "an unknown measure as a column" "$ecorche" body population ears.csv -o none
says "ears.csv:1"
expect 2 "neither file nor number" "$ecorche" body population -o none
expect 0,8 "people by chance, with anatomy, side by side" "$ecorche" body population --count 2 --sex male -o chance
there chance/person-0001.glb
expect 0,8 "the first of them on one core" "$ecorche" body population --count 1 --sex male --threads 1 -o single
if cmp -s chance/person-0001.glb single/person-0001.glb; then ok; else bad "a person of a population depends on the number of threads"; fi
if [ "$(head -2 chance/population.csv)" = "$(head -2 single/population.csv)" ]; then ok; else bad "population.csv depends on the number of threads"; fi
expect 0,8 "a crowd" "$ecorche" body population people.csv -o crowd --crowd crowd.glb
there crowd.glb; there crowd/ada.bin; absent crowd/bob.bin
expect 0,8 "the same crowd, turned round, one of its people made anew" bash -c "cp crowd.glb first.glb; rm crowd/cyd.bin; exec '$ecorche' body population turned.csv -o crowd --crowd crowd.glb --report crowd.json"
if cmp -s crowd.glb first.glb && grep -q '"kept": 1' crowd.json; then ok; else bad "a crowd depends on the order it was made in"; fi
expect 0,8 "a crowd that refers to its people" "$ecorche" body population turned.csv -o crowd --crowd crowd/crowd.gltf
there crowd/crowd.gltf; there crowd/crowd.shared
expect 2 "a crowd apart from its people" "$ecorche" body population turned.csv -o none --crowd apart.gltf
absent none
expect 8 "a crowd of skins" "$ecorche" body population people.csv --skins -o skins --crowd skins.glb
there skins.glb; there skins/ada.bin
if [ "$(stat -c %s skins.glb)" -lt 2000000 ] && grep -q 'ada/skin' skins.glb && ! grep -q 'ada/bones' skins.glb; then ok; else bad "a crowd of skins has more than skins"; fi
expect 3 "a crowd in place of a body" "$ecorche" body measure crowd.glb
says "crowd.glb#ada (ada, cyd)"
expect 3 "a crowd in place of a character" "$ecorche" export crowd.glb -o a.osim
says "crowd.glb#ada (ada, cyd)"; absent a.osim
expect 3 "somebody who is not in the crowd" "$ecorche" body measure 'crowd.glb#eve'
says "there are ada, cyd"
expect 0 "one of a crowd, measured" "$ecorche" body measure 'skins.glb#ada'
if grep -q "^stature *168.0 cm" out.txt; then ok; else bad "a person of a crowd has another stature: $(grep '^stature ' out.txt)"; fi
expect 6 "a crowd in whose place one of its people would come" "$ecorche" body modify 'crowd.glb#ada' --fat 30 -o crowd.glb
says "also the input"
expect 0 "one of a crowd, as a character" "$ecorche" export 'crowd/crowd.gltf#ada' -o ada.osim --no-meshes
there ada.osim
expect 2 "tissue without a mesh" "$ecorche" fit anna.glb -o c.glb --tissue t.vtk
says "interior"; absent c.glb
expect 0,8 "a fit by a warp of the tissue" "$ecorche" fit anna.glb -o anna-tetgen.glb --interior tetgen --tissue t.vtk --method paper
there anna-tetgen.glb; there t.vtk

# Names and places.
expect 0 "a name with blanks, quotes and a line end" "$ecorche" body new --sex male -o "o' \"ü
x.glb"
there "o' \"ü
x.glb"
cp anna.glb ./-anna.glb
expect 4 "a body whose name begins with a dash, as a character" "$ecorche" animate -o a.glb -- -anna.glb none.bvh
says "-anna.glb"
mkfifo pipe.bvh
for file in pipe.bvh . /dev/zero loop; do
  [ "$file" = loop ] && ln -s loop loop
  expect 3 "a motion that is $file" timeout 20 "$ecorche" animate anna-1.glb "$file" -o a.glb
  expect 3 "a character that is $file" timeout 20 "$ecorche" animate "$file" "$source/data/motions/walk.bvh" -o a.glb
  expect 3 "a body that is $file" timeout 20 "$ecorche" fit "$file" -o a.glb
done
absent a.glb
expect 2 "a character in another format" "$ecorche" fit anna.glb -o a.obj
absent a.obj
cp anna.glb same.glb
expect 6 "an output that is the input" "$ecorche" fit same.glb -o ./same.glb
says "also the input"
ln same.glb other_name.glb
expect 6 "an output that is the input by another name" "$ecorche" fit same.glb -o other_name.glb
if cmp -s anna.glb same.glb; then ok; else bad "the input was touched"; fi
mkdir -p folder.glb
expect 6 "an output that is a folder" "$ecorche" fit anna.glb -o folder.glb
expect 6 "an output that is a device" "$ecorche" body new --sex male --report /dev/full -o a.glb
absent a.glb
if [ -c /dev/full ]; then ok; else bad "/dev/full is gone"; fi
expect 6 "one output of two in a missing folder" "$ecorche" animate anna-1.glb "$source/data/motions/walk.bvh" -o a.glb -o no/where/a.pc2
absent a.glb
mkdir -p full
if mount -t tmpfs -o size=64k none full 2> /dev/null; then
  expect 6 "a full disk" "$ecorche" body new --sex male -o full/a.glb
  if [ -z "$(ls -A full)" ]; then ok; else bad "left on the full disk: $(ls -A full)"; fi
  umount full
else
  skip "a full disk: no right to mount one"
fi
mkdir -p limited
expect 6 "a limit on the size of files" bash -c "ulimit -f 16; exec '$ecorche' body new --sex male -o limited/a.glb"
if [ -z "$(ls -A limited)" ]; then ok; else bad "left under the limit: $(ls -A limited)"; fi
expect 5 "too little memory" bash -c "ulimit -v 300000; exec '$ecorche' fit anna.glb -o a.glb --threads 1"
absent a.glb

# Motions: a second and a half of those of the package.
for name in walk long_jump; do
  awk -v frames=90 '/^Frames:/ {print "Frames: " frames; next} {print} /^Frame Time:/ {left = frames; while (left-- > 0 && (getline row) > 0) print row; exit}' \
    "$source/data/motions/$name.bvh" > "$folder/$name.bvh"
done
walk=$folder/walk.bvh
expect 4 "a character that is a body" "$ecorche" animate anna.glb "$walk" -o a.glb
expect 3 "a motion that is not there" "$ecorche" animate some.glb none.bvh -o a.glb
expect 2 "an unknown kind of output" "$ecorche" animate some.glb "$walk" -o a.fbx
expect 0 "a walk" "$ecorche" animate some.glb "$walk" -o walk.glb -o walk.pc2 --report walk.json
there walk.glb; there walk.pc2; there walk.json
expect 2 "a skin of no known kind" "$ecorche" animate some.glb "$walk" -o a.pc2 --skin rubber
says "deltamush"; absent a.pc2
expect 2 "one OBJ file for a motion" "$ecorche" animate some.glb "$walk" -o a.obj
says "%04d.obj"
for skin in ecorche lbs dqs deltamush paper anchors; do expect 0 "some steps by $skin" "$ecorche" animate some.glb "$walk" -o "$skin.pc2" --to 9f --skin $skin; done
if cmp -s lbs.pc2 dqs.pc2 || cmp -s lbs.pc2 deltamush.pc2 || cmp -s ecorche.pc2 paper.pc2; then bad "two skins are the same"; else ok; fi
expect 0 "a walk for other programs" "$ecorche" animate some.glb "$walk" -o walk.mdd -o "objs/%03d.obj" --to 9f
there walk.mdd; there objs/001.obj
expect 0,8 "a bake" "$ecorche" bake some.glb "$walk" long_jump.bvh -o baked.glb --samples 30 --morphs 8 --report bake.json
there baked.glb
if grep -q '"rms"' bake.json; then ok; else bad "the bake does not state its error"; fi
expect 0 "a crowd that walks" "$ecorche" animate crowd.glb "$walk" -o walking.glb --stagger 0.3 --report walking.json
there walking.glb
if grep -q '"people": 2' walking.json; then ok; else bad "not everybody walks"; fi
expect 2 "a crowd's vertices" "$ecorche" animate crowd.glb "$walk" -o a.pc2
says "crowd.glb#NAME"; absent a.pc2
expect 2 "one person, one after the other" "$ecorche" animate some.glb "$walk" -o a.glb --stagger 1
absent a.glb
printf 'name,label,view,angles\nbent,bent,front,elbow 90\n' > poses.csv
expect 0,8 "a pose book" "$ecorche" posebook some.glb -o poses --poses poses.csv
there poses/ecorche.png; there poses/lbs.png; there poses/figures.csv
printf 'name,label,view,angles\nbent,bent,front,tail 90\n' > poses.csv
expect 3 "a pose of a tail" "$ecorche" posebook some.glb -o poses --poses poses.csv --no-pictures
says "tail"
expect 2 "an unknown layer" "$ecorche" render some.glb "$walk" -o "f/%04d.png" --layers fat
expect 2 "a size without height" "$ecorche" render some.glb "$walk" -o "f/%04d.png" --size 100
expect 0 "a film" "$ecorche" render some.glb "$walk" -o film.mp4 --size 160x90 --fps 4 --layers muscles,bones
there film.mp4
expect 0 "pictures" "$ecorche" render some.glb "$walk" -o "frames/%04d.png" --size 96x96 --fps 2
there frames/0001.png
expect 0 "every third frame of some" "$ecorche" render some.glb "$walk" -o "some/%04d.png" --frames 10-16x3 --size 64x64
there some/0010.png; there some/0016.png; absent some/0011.png; absent some/0017.png
expect 0 "a part of the motion" "$ecorche" render some.glb "$walk" -o part.mp4 --from 0.5 --to 1 --fps 10 --size 64x64 --report part.json
if grep -q '"frames": 6' part.json; then ok; else bad "half a second at 10 a second is not 6 frames"; fi
expect 2 "a part beyond the end" "$ecorche" render some.glb "$walk" -o a.mp4 --from 900
expect 2 "a part that is no number" "$ecorche" render some.glb "$walk" -o a.mp4 --from nan
expect 2 "frames that are none" "$ecorche" render some.glb "$walk" -o a.mp4 --frames 9-3
expect 2 "frames beyond the end" "$ecorche" render some.glb "$walk" -o a.mp4 --frames 1-99999
expect 2 "a zoom of nothing" "$ecorche" render some.glb "$walk" -o a.mp4 --zoom nan
expect 2 "no layer" "$ecorche" render some.glb "$walk" -o a.mp4 --layers ""
absent a.mp4
expect 0 "a still at rest" "$ecorche" render some.glb -o rest.png --size 96x96
there rest.png
expect 0 "a close-up in a pose, without background" "$ecorche" render some.glb -o knee.png --pose squat --look-at knee_l --hide skin --background transparent --size 96x96
there knee.png
expect 0 "a close-up of a landmark in a motion" "$ecorche" render some.glb "$walk" -o elbow.png --at 1 --look-at olecranon_r --size 96x96
expect 2 "a film without a motion" "$ecorche" render some.glb -o a.mp4
says "needs a motion"
expect 2 "a still of no moment" "$ecorche" render some.glb "$walk" -o a.png
says "--at"
expect 2 "a film without a background" "$ecorche" render some.glb "$walk" -o a.mp4 --background transparent
expect 2 "an unknown pose" "$ecorche" render some.glb -o a.png --pose sqaut
says "squat"
expect 2 "an unknown part" "$ecorche" render some.glb -o a.png --only femr
says "femur"
expect 2 "an unknown thing to look at" "$ecorche" render some.glb -o a.png --look-at patela
says "patella"
absent a.png; absent a.mp4
if mount -t tmpfs -o size=16k none full 2> /dev/null; then
  expect 6 "a film on a full disk" "$ecorche" render some.glb "$walk" -o full/a.mp4 --size 320x180 --fps 4
  says "space"
  expect 6 "a still on a full disk" "$ecorche" render some.glb -o full/a.png --size 640x360
  if [ -z "$(ls -A full)" ]; then ok; else bad "left on the full disk: $(ls -A full)"; fi
  umount full
else
  skip "a film on a full disk: no right to mount one"
fi
mkdir -p tools
printf '#!/bin/sh\ncat > /dev/null\n' > tools/ffmpeg; chmod +x tools/ffmpeg
expect 6 "an ffmpeg that writes nothing" env PATH="$folder/tools:$PATH" "$ecorche" render some.glb "$walk" -o a.mp4 --size 64x64 --fps 2
says "empty"
expect 6 "no ffmpeg" env PATH="$folder/none" "$ecorche" render some.glb "$walk" -o a.mp4 --size 64x64 --fps 2
says "install the package ffmpeg"
expect 6 "no graphics driver" env ECORCHE_GL=egl __EGL_VENDOR_LIBRARY_DIRS="$folder/none" "$ecorche" render some.glb -o a.png --size 64x64
says "libegl1"
absent a.mp4; absent a.png

# Models of other programs.
expect 2 "an unknown kind of model" "$ecorche" export anna-1.glb -o a.fbx
expect 4 "a body has no anatomy to export" "$ecorche" export anna.glb -o a.osim
absent a.osim
expect 0 "an export" "$ecorche" export anna-1.glb -o anna.osim -o anna.xml --report export.json
there anna.osim; there anna.xml; there anna_meshes/femur_l.obj; there export.json
expect 0 "an import" "$ecorche" template import anna.osim -o back.glb --report import.json
there back.glb; there import.json
expect 0 "what a template holds" "$ecorche" template info back.glb
expect 0 "the check of a template" "$ecorche" template check back.glb
expect 0,8 "a fit of an imported template" "$ecorche" fit anna.glb --template back.glb -o anna-back.glb --method paper
there anna-back.glb
expect 4 "a character that is no template" "$ecorche" fit anna.glb --template anna-1.glb -o c.glb
says "template"; absent c.glb
expect 3 "a model that is no model" "$ecorche" template import triangle.obj -o c.glb
expect 3 "a model that leaves its folder" "$ecorche" template import "$source/tests/corpus/model/mesh_outside.osim" -o c.glb
says "folder"; absent c.glb

if command -v xvfb-run > /dev/null; then
  expect 0 "the window" xvfb-run -a "$ecorche" view some.glb "$walk" --frames 3 --screenshot window.png
  there window.png
  expect 0 "a slider moved" xvfb-run -a "$ecorche" view anna-1.glb --sliders --measure stature=172cm --frames 2 -o edited.glb
  expect 0 "its stature" "$ecorche" body measure edited.glb
  if grep -q "^stature *172.0 cm" out.txt; then ok; else bad "the character that a slider made has another stature: $(grep '^stature ' out.txt)"; fi
  expect 0 "the anatomy of what a slider made, fitted once more" "$ecorche" fit edited.glb -o edited-fitted.glb
  expect 8 "a slider where no fit is good" xvfb-run -a "$ecorche" view --sex female --sliders --measure weight=125kg --measure stature=158cm --frames 2 -o stout.glb
  says "missed"; there stout.glb
  expect 0 "a window from the left on some parts" xvfb-run -a "$ecorche" view some.glb --only thigh_l --camera left --frames 2 --screenshot parts.png
  there parts.png
  expect 2 "a window on no part" "$ecorche" view some.glb --only thihg --frames 2
  says "thigh"
else
  skip "the window: xvfb-run is not installed"
fi
expect 4,6 "the window without a display" env -u DISPLAY -u WAYLAND_DISPLAY "$ecorche" view some.glb --frames 1

# Other people's programs.
if [ -d "$build/clients/node_modules/gltf-validator" ]; then
  for file in anna.glb anna-1.glb walk.glb baked.glb crowd.glb skins.glb walking.glb; do
    expect 0 "the glTF validator on $file" node "$source/tests/clients/validate.cjs" "$build/clients/node_modules" "$folder/$file"
    tail -1 out.txt
  done
else
  skip "the glTF validator: run make clients"
fi
if [ -d "$build/clients/node_modules/three" ] && command -v chromium > /dev/null; then
  three() { node "$source/tests/clients/three_plays.mjs" "$build/clients/node_modules" "$folder/baked.glb" "$1" "$folder/walk.pc2" 60; }
  expect 0 "three.js in Chromium on baked.glb" three walk
  tail -1 out.txt
  expect 1 "three.js in Chromium on another motion than the cache's" three long_jump
  for file in crowd.glb skins.glb crowd/crowd.gltf; do
    expect 0 "three.js in Chromium on $file" node "$source/tests/clients/three_crowd.mjs" "$build/clients/node_modules" "$folder/$file" "$folder/people"
    tail -1 out.txt
  done
  expect 0 "three.js in Chromium on walking.glb" node "$source/tests/clients/three_crowd.mjs" "$build/clients/node_modules" "$folder/walking.glb" "$folder/people" --motion walk
  tail -1 out.txt
else
  skip "three.js in Chromium: run make clients"
fi
if [ -e "$build/clients/physics/ready" ]; then
  for file in anna.xml anna.osim; do
    expect 0 "$file in its simulator" "$build/clients/physics/bin/python" "$source/tests/clients/simulators.py" "$folder/$file"
    tail -1 out.txt
  done
else
  skip "MuJoCo and OpenSim: run make clients"
fi
if [ -e "$build/clients/python/ready" ]; then
  expect 0 "Blender on baked.glb" "$build/clients/python/bin/python" "$source/tests/clients/blender_loads.py" "$folder/baked.glb"
  expect 0 "Blender on walk.glb" "$build/clients/python/bin/python" "$source/tests/clients/blender_loads.py" "$folder/walk.glb"
  tail -1 out.txt
  for file in skins.glb walking.glb; do  # the others are three.js's
    expect 0 "Blender on $file" "$build/clients/python/bin/python" "$source/tests/clients/blender_crowd.py" "$folder/$file" "$folder/people"
    tail -1 out.txt
  done
else
  skip "Blender: run make clients"
fi

echo "$passed passed, $failed failed, $skipped skipped"
[ "$failed" -eq 0 ]
