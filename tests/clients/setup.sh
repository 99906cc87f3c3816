#!/usr/bin/env bash
# Fetches the programs that exported files are tried in: the glTF validator and three.js (npm), Blender, MuJoCo and OpenSim as Python modules.
# Usage: tests/clients/setup.sh FOLDER
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=$1
mkdir -p "$folder"

if ! cmp -s "$here/package-lock.json" "$folder/package-lock.json" || [ ! -d "$folder/node_modules/three" ]; then
  command -v npm >/dev/null || "$here/../../data/setup.sh" "$folder/../packages" <(printf 'nodejs\nnpm\n')
  cp "$here/package.json" "$here/package-lock.json" "$folder/"
  (cd "$folder" && npm ci --silent --no-audit --no-fund >&2)
fi

if [ ! -e "$folder/python/ready" ]; then
  echo "clients: fetching Blender (once)" >&2
  python3 -m venv --clear "$folder/python"
  "$folder/python/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
    --only-binary :all: -r "$here/requirements.txt"
  touch "$folder/python/ready"
fi

if [ ! -e "$folder/physics/ready" ]; then
  echo "clients: fetching MuJoCo and OpenSim (once)" >&2
  python3 -m venv --clear "$folder/physics"
  "$folder/physics/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --require-hashes \
    --only-binary :all: -r "$here/physics.txt"
  touch "$folder/physics/ready"
fi
