#!/usr/bin/env bash
# Whether the npm package draco3d, by which browsers read tiles, reads the very values that C++ libdraco does, and how
# long it takes. Needs Node.js, npm and its registry, which nothing else here does.
# Usage: tests/draco3d/run.sh [--tiles N] [--chromium PROGRAM]
#   --tiles N            of each ground and setting (27: one of each level of the Moon)
#   --chromium PROGRAM   also in this browser, without a window
set -euo pipefail
cd "$(dirname "$0")/../.."

tiles=27
chromium=
while [ $# -gt 0 ]; do
  case "$1" in
    --tiles) tiles=${2:?--tiles: how many} ;;
    --chromium) chromium=${2:?--chromium: which program} ;;
    -h|--help) sed -n '2,6s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "draco3d: unknown argument $1 (see --help)" >&2; exit 2 ;;
  esac
  shift 2
done
for program in node npm; do
  command -v "$program" >/dev/null || { echo "draco3d: $program is needed" >&2; exit 1; }
done

cmake --preset release >/dev/null
cmake --build --preset release --target draco3d_samples
work=build/draco3d
mkdir -p "$work"
[ -d "$work/node_modules/draco3d" ] || npm install --prefix "$work" --no-save --silent draco3d@1.5.7
export NODE_PATH="$PWD/$work/node_modules"

samples=$(mktemp -d)
trap 'rm -rf "$samples"' EXIT
build/release/bin/draco3d_samples "$samples/bin" "$tiles"
echo "Node.js $(node --version):"
node tests/draco3d/decode.js "$samples/bin"
if [ -n "$chromium" ]; then
  echo "$("$chromium" --version):"
  node tests/draco3d/page.js "$samples/bin" > "$samples/page.html"
  "$chromium" --headless --no-sandbox --disable-gpu --disable-background-networking --disable-component-update --no-first-run \
    --user-data-dir="$samples/profile" --dump-dom "file://$samples/page.html" 2>/dev/null \
    | sed -n '/<pre id="result">/,/<\/pre>/p' | sed 's/<[^>]*>//g' | tee "$samples/seen"
  grep -q 'tiles exact' "$samples/seen"
fi
