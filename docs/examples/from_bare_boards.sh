#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The first hour of a technician: from bare boards to a patch that is verified and calibrated. Everything is simulated: the scene says that
# four mistakes were made at the bench, and this script plays the person who mends what triskin repair names.
# Usage: from_bare_boards.sh [FOLDER]     FOLDER: where the files go; without it a new one below /tmp
set -euo pipefail
triskin="${TRISKIN:-triskin}"
folder="${1:-$(mktemp -d /tmp/triskin.XXXXXX)}"
cd "$folder"
export XDG_STATE_HOME="$folder/state" # where the simulated boards keep their flash
say() { printf '$ triskin %s\n' "$*"; "$triskin" "$@"; }

# A mistake of the bench each: a dead chip, a module that is turned by 120°, a shorted taxel, two modules at each other's place.
mistakes=(
  '{"kind":"removed_chip","module":3}'
  '{"kind":"rotated_module","module":6,"steps":1}'
  '{"kind":"saturated_taxel","module":8,"taxel":2}'
  '{"kind":"swapped_chips","module":1,"other":10}'
)
write_bench() {
  local IFS=,
  printf '{"format":"triskin-scene","version":1,"design":"hip.json","faults":[%s]}\n' "${mistakes[*]-}" > bench.json
}
mend() { # FINDING: takes away the mistake whose module the finding names
  local left=() mistake
  for mistake in "${mistakes[@]}"; do
    local module="${mistake#*\"module\":}"
    module="${module%%[!0-9]*}"
    if [[ "$1" != *"module $module "* ]]; then left+=("$mistake"); fi
  done
  mistakes=("${left[@]}")
  write_bench
}

say generate hip -o hip.obj --size-mm 110 --faces 300
say design hip.obj -o hip.json --iterations 60 --threads 1 # the same cover on every machine
write_bench
say flash hip.json --scene bench.json
say verify hip.json --scene bench.json | grep -v '^ ' || true

# The technician reads what repair says and answers each of its questions with Enter.
printf '$ triskin repair hip.json --scene bench.json\n'
coproc REPAIR { "$triskin" repair hip.json --scene bench.json 2> /dev/null; }
repair_pid=$REPAIR_PID
finding= expects_finding=0
while IFS= read -r line <&"${REPAIR[0]}"; do
  if ((expects_finding)); then finding="$line"; fi
  expects_finding=0
  case "$line" in
    "finding 1 of"*) expects_finding=1 ;;
    "Fix this now."*) mend "$finding" && echo >&"${REPAIR[1]}" ;;
    *"Enter: done"*) echo >&"${REPAIR[1]}" ;;
  esac
  case "$line" in " "*) ;; *) printf '%s\n' "$line" ;; esac
done
wait "$repair_pid"

say calibrate hip.json --scene bench.json --steps 5,10,20,30,40
say verify hip.json --scene bench.json
