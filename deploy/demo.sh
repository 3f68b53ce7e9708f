#!/usr/bin/env bash
# The demonstration: installs what is missing, builds, serves the Moon, and flies one continuous descent from 10,000 km to 0.2 m
# above the ground. Pictures and figures are left in demo-output/.
# Usage: deploy/demo.sh [--size WxH] [--output DIR]
set -euo pipefail
cd "$(dirname "$0")/.."

size=1280x720
output=demo-output
while [ $# -gt 0 ]; do
  case "$1" in
    --size) size=${2:?--size needs a value}; shift 2 ;;
    --output) output=${2:?--output needs a value}; shift 2 ;;
    -h|--help) sed -n '2,4s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "demo: unknown argument $1 (see --help)" >&2; exit 2 ;;
  esac
done

deploy/install.sh
cmake --preset release >/dev/null
cmake --build --preset release --target terrane-server terrane-view
bin=build/release/bin

mkdir -p "$output"
rm -f "$output"/descent-*.png
log="$output/server.log"
ready="$output/server.ready"
"$bin/terrane-server" --scene moon --listen 127.0.0.1:0 >"$ready" 2>"$log" &
server=$!
trap 'kill "$server" 2>/dev/null || true; wait "$server" 2>/dev/null || true; rm -f "$ready"' EXIT
for _ in $(seq 100); do
  [ -s "$ready" ] && break
  kill -0 "$server" 2>/dev/null || { cat "$log" >&2; exit 1; }
  sleep 0.1
done
url=$(grep -o 'http://[^ ]*' "$ready" | head -n 1)
[ -n "$url" ] || { echo "demo: the server did not become ready; see $log" >&2; exit 1; }
echo "demo: serving the Moon on $url"

headless=(--headless)
[ -n "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ] && headless=()
# Over the southern shore of Mare Imbrium, in the morning.
"$bin/terrane-view" --server "$url" "${headless[@]}" --size "$size" --flight descent --camera=-16.4018,21.6039,1e7 --settle --step 4 \
  --cache none --capture "$output/descent-%d.png" --stats "$output/stats.json"

echo
echo "demo: pictures and figures are in $output/"
ls -l "$output"/descent-*.png "$output/stats.json"
