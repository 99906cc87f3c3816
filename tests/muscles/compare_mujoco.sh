#!/usr/bin/env bash
# Runs compare_mujoco.py with the simulators' Python, if that is installed.   Usage: compare_mujoco.sh ECORCHE BUILD_FOLDER
here=$(cd "$(dirname "$0")" && pwd)
ecorche=$1 build=$2
if [ ! -e "$build/clients/physics/ready" ]; then
  echo "skipped: MuJoCo is not installed: run make clients"
  exit 77
fi
exec "$build/clients/physics/bin/python" "$here/compare_mujoco.py" "$ecorche" "${ECORCHE_PACKAGES:-$build/packages}"
