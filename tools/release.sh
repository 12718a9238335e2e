#!/bin/sh
# Writes gliss-VERSION.tar.gz into a folder: the committed sources, and the pages of gliss report and gliss view, so that
# whoever builds from it needs neither npm nor its registry. Usage: tools/release.sh [FOLDER]; needs what
# tools/quickstart.sh installs.
set -eu
to=$(realpath "${1:-.}")
cd "$(dirname "$0")/.."
name=gliss-$(sed -n 's/^project(gliss VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
node tools/report/page/build.mjs "$work/page"
git archive --format=tar.gz --prefix="$name/tools/report/page/" --add-file="$work/page/report.html" \
  --add-file="$work/page/view.html" \
  --prefix="$name/" --output="$to/$name.tar.gz" HEAD
echo "$to/$name.tar.gz"
