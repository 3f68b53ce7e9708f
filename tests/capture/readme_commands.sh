#!/usr/bin/env bash
# Runs README's copy-paste commands as a reader would, with the binaries under test and a free port in place of 8080.
# Usage: readme_commands.sh SOURCE_DIR BIN_DIR
set -euo pipefail
source=$1 bin=$2
cd "$source"
work=$(mktemp -d)
port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')

block() {  # the sh block after <!-- commands:NAME -->
  awk -v marker="<!-- commands:$1 -->" '$0 == marker {found = 1; next} found && /^```sh$/ {inside = 1; next} inside && /^```$/ {exit} inside' README.md \
    | sed -e "s#build/release/bin#$bin#g" -e "s#:8080#:$port#g" -e "s#/tmp/moon#$work/moon#g" -e "s#/tmp/accuracy#$work/accuracy#g"
}
for name in serve ask view serve-planets view-planets accuracy; do
  [ -n "$(block "$name")" ] || { echo "README has no commands:$name block" >&2; exit 1; }
done

serve() {  # by the block NAME; waits until it is ready
  block "$1" >"$work/serve.sh"
  : >"$work/ready"
  bash -c "exec $(cat "$work/serve.sh")" >"$work/ready" 2>"$work/log" &
  server=$!
  for _ in $(seq 600); do
    [ -s "$work/ready" ] && break
    kill -0 "$server" || { cat "$work/log" >&2; exit 1; }
    sleep 0.1
  done
}
view() {  # by the block NAME: a picture, and figures of a closed ground
  rm -f "$work"/moon.*
  block "$1" >"$work/view.sh"
  bash -euo pipefail "$work/view.sh"
  [ "$(head -c 4 "$work/moon.png" | tail -c 3)" = PNG ] || { echo "the picture is no PNG" >&2; exit 1; }
  python3 - "$work/moon.json" <<'PY'
import json, sys
stats = json.load(open(sys.argv[1]))
assert stats["uncoveredPixels"] == 0, stats["uncoveredPixels"]
assert stats["tilesDrawn"] > 0
PY
}
server=
trap 'kill $server 2>/dev/null || true; wait $server 2>/dev/null || true; rm -rf "$work"' EXIT
serve serve
block ask >"$work/ask.sh"
bash -euo pipefail "$work/ask.sh"
view view
kill -TERM "$server"
wait "$server"
serve serve-planets
view view-planets
kill -TERM "$server"
wait "$server"
block accuracy >"$work/accuracy.sh"
bash -euo pipefail "$work/accuracy.sh" >/dev/null
grep -q "</html>" "$work/accuracy/index.html"
echo "README's commands work"
