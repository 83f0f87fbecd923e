#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Writes the manual pages, the completion and the package's changelog that an installation of Triskin has.
# Usage: generate_docs.sh TRISKIN FOLDER CONTACT     CONTACT: who is asked about the package, "Name <address>"
set -eu
triskin="$1" folder="$2" contact="$3"
rm -rf "$folder/man1"
mkdir -p "$folder/man1"
"$triskin" generate-docs man | gzip -9n > "$folder/man1/triskin.1.gz"
for command in $("$triskin" --help | sed -n 's/^  \([a-z][a-z-]*\)  .*/\1/p'); do
  "$triskin" generate-docs man "$command" | gzip -9n > "$folder/man1/triskin-$command.1.gz"
done
"$triskin" generate-docs bash > "$folder/triskin"
version="$("$triskin" --version)"
# Debian wants a changelog in its own form beside ours. The date is fixed, so that the same source
# makes the same package.
printf 'triskin (%s) unstable; urgency=medium\n\n  * Changes are listed in CHANGELOG.md.gz beside this file.\n\n -- %s  Thu, 01 Jan 2026 00:00:00 +0000\n' "$version" "$contact" |
  gzip -9n > "$folder/changelog.gz"
gzip -9nc "$(dirname "$0")/../../CHANGELOG.md" > "$folder/CHANGELOG.md.gz"
touch "$folder/done"
