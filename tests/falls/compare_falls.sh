#!/usr/bin/env bash
# Runs compare_falls.py with the simulators' Python, if that is installed.   Usage: compare_falls.sh ECORCHE RAGDOLL_FIGURES BUILD_FOLDER [CHARACTER.glb]
here=$(cd "$(dirname "$0")" && pwd)
ecorche=$1 figures=$2 build=$3
shift 3
if [ ! -e "$build/clients/physics/ready" ]; then
  echo "skipped: MuJoCo is not installed: run make clients"
  exit 77
fi
exec "$build/clients/physics/bin/python" "$here/compare_falls.py" "$ecorche" "$figures" "$@"
