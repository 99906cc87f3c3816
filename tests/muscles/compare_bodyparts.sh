#!/usr/bin/env bash
# Unpacks BodyParts3D's parts and runs `bodyparts` on them; with a FOLDER also writes tables there, and pictures of the ten muscles that
# overlap least (ours red, theirs blue).   Usage: compare_bodyparts.sh BODYPARTS MESHSHOT ARCHIVE [FOLDER]
set -euo pipefail
bodyparts=$1 meshshot=$2 archive=$3 folder=${4:-}
if [ ! -e "$archive" ]; then
  echo "skipped: $archive is not there"
  exit 77
fi
parts=$(mktemp -d)
trap 'rm -rf "$parts"' EXIT
tar -xf "$archive" -C "$parts" || { echo "skipped: tar cannot unpack $archive"; exit 77; }
"$bodyparts" "$parts" ${folder:+"$folder"} && code=0 || code=$?
if [ -n "$folder" ] && [ -e "$folder/worst0_ours.ply" ]; then
  for i in 0 1 2 3 4 5 6 7 8 9; do
    "$meshshot" "$folder/worst$i.png" --view front --view left --size 400x400 "$folder/worst${i}_ours.ply:0.85,0.3,0.25" "$folder/worst${i}_theirs.ply:0.3,0.45,0.85,0.6"
  done
fi
exit "$code"
