#!/usr/bin/env bash
# The viewer's frame beside a bare loop; then the whole program: memory, and start to first full view against a cold server, by each encoder, and a warm one.
# Usage: tests/bench/viewer_bench.sh [BIN_DIR] [FRAMES]; prints Markdown.
set -euo pipefail
bin=${1:-build/release/bin}
frames=${2:-60}
"$bin/bench_viewer" --frames "$frames"

work=$(mktemp -d)
server=
cleanup() { [ -n "$server" ] && kill "$server" 2>/dev/null; wait 2>/dev/null || true; rm -rf "$work"; }
trap cleanup EXIT
startServer() {  # [FLAG...]
  [ -n "$server" ] && { kill "$server"; wait "$server" || true; }
  : >"$work/ready"
  "$bin/terrane-server" --scene moon --listen 127.0.0.1:0 "$@" >"$work/ready" 2>/dev/null &
  server=$!
  for _ in $(seq 100); do [ -s "$work/ready" ] && break; sleep 0.05; done
  url=$(grep -o 'http://[^ ]*' "$work/ready" | head -n 1)
}
view() {  # NAME CAMERA
  "$bin/terrane-view" --server "$url" --headless --settle --cache none --size 1280x720 --above-ground --camera="$1" --stats "$work/$2.json" >/dev/null
}
echo
echo "| whole program, 1280×720 | cold server: first full view ms | the same, tiles by stock Draco | warm server ms | tiles drawn | requests | KB | RSS MB |"
echo "|---|---|---|---|---|---|---|---|"
while IFS='|' read -r name camera; do
  for round in 1 2 3; do
    startServer --draco stock
    view "$camera" "stock$round"
    startServer
    view "$camera" "cold$round"
    view "$camera" "warm$round"
  done
  python3 - "$work" "$name" <<'PY'
import json, statistics, sys
work, name = sys.argv[1:]
stock, cold, warm = ([json.load(open(f"{work}/{kind}{i}.json")) for i in (1, 2, 3)] for kind in ("stock", "cold", "warm"))
m = lambda rows, key: statistics.median(row[key] for row in rows)
print(f"| {name} | {m(cold, 'msToSettle'):.0f} | {m(stock, 'msToSettle'):.0f} | {m(warm, 'msToSettle'):.0f} | {m(warm, 'tilesDrawn'):.0f} | {m(warm, 'requests'):.0f} "
      f"| {m(warm, 'bytesReceived') / 1024:.0f} | {m(warm, 'rssBytes') / 2**20:.0f} |")
PY
done <<'VIEWS'
orbit, 1,000 km|-20,10,1000000,0,-60
1 km above ground|-20,10,1000,0,-20
2 m above ground|-20,10,2,0,-15
VIEWS
