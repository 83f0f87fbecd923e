#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes the manual pages, the completion and the package's changelog that an installation of Triskin has.
# Usage: generate_docs.sh TRISKIN FOLDER
set -eu
triskin="$1" folder="$2"
mkdir -p "$folder/man1"
"$triskin" generate-docs man | gzip -9n > "$folder/man1/triskin.1.gz"
for command in $("$triskin" --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p'); do
  "$triskin" generate-docs man "$command" | gzip -9n > "$folder/man1/triskin-$command.1.gz"
done
"$triskin" generate-docs bash > "$folder/triskin"
version="$("$triskin" --version)"
printf 'triskin (%s) unstable; urgency=medium\n\n  * See /usr/share/doc/triskin/README.md.\n\n -- Triskin developers <triskin@localhost>  Thu, 01 Jan 2026 00:00:00 +0000\n' "$version" |
  gzip -9n > "$folder/changelog.gz"
touch "$folder/done"
