#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# The first hour of an engineer: from the mesh of a part to a design that is checked, priced and drawn for assembly.
# Usage: from_mesh_to_sheet.sh [FOLDER]     FOLDER: where the files go; without it a new one below /tmp
set -euo pipefail
triskin="${TRISKIN:-triskin}"
folder="${1:-$(mktemp -d /tmp/triskin.XXXXXX)}"
cd "$folder"
say() { printf '$ triskin %s\n' "$*"; "$triskin" "$@"; }

say generate forearm -o forearm.obj
say design forearm.obj -o forearm.json --time-limit-s 5
say check forearm.json
say export forearm.json --format pdf -o forearm.pdf
say export forearm.json --format html -o forearm.html
