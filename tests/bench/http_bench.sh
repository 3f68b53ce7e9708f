#!/usr/bin/env bash
# A cached tile over HTTP: terrane-server against nginx serving the same bytes as a file. wrk with one thread and 64 connections, one
# I/O thread (one nginx worker with sendfile), the two in turn; prints a Markdown table with the medians and their ratio.
# Usage: tests/bench/http_bench.sh [BIN_DIR] [ROUNDS] [SECONDS_A_ROUND]
set -euo pipefail
bin=${1:-build/release/bin}
rounds=${2:-5}
seconds=${3:-4}

work=$(mktemp -d)
pids=()
cleanup() { for pid in "${pids[@]}"; do kill "$pid" 2>/dev/null || true; done; wait 2>/dev/null || true; rm -rf "$work"; }
trap cleanup EXIT

"$bin/terrane-server" --scene moon --listen 127.0.0.1:0 --io-threads 1 --threads 1 >"$work/ready" 2>"$work/server.log" &
pids+=($!)
for _ in $(seq 100); do [ -s "$work/ready" ] && break; sleep 0.1; done
url=$(grep -o 'http://[^ ]*' "$work/ready" | head -n 1)
revision=$(curl -sf "$url/v1/scene.json" | grep -o '"revision": *"[0-9a-f]*"' | head -n 1 | grep -o '[0-9a-f]\{8,\}')
target="/v1/$revision/moon/cube/0/0123.glb"
curl -sf "$url$target" -o "$work/tile.glb"
size=$(stat -c %s "$work/tile.glb")

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("127.0.0.1", 0)); print(s.getsockname()[1])')
cat >"$work/nginx.conf" <<CONF
worker_processes 1; daemon off; pid $work/nginx.pid; error_log $work/nginx.log;
events { worker_connections 512; }
http { access_log off; sendfile on; tcp_nopush on; keepalive_requests 1000000000; client_body_temp_path $work/b; proxy_temp_path $work/p;
  fastcgi_temp_path $work/f; uwsgi_temp_path $work/u; scgi_temp_path $work/s;
  server { listen 127.0.0.1:$port; root $work; open_file_cache max=10; } }
CONF
chmod 755 "$work"; chmod 644 "$work/tile.glb"
"$(command -v nginx || echo /usr/sbin/nginx)" -c "$work/nginx.conf" &
pids+=($!)
for _ in $(seq 50); do curl -sf "http://127.0.0.1:$port/tile.glb" -o /dev/null && break; sleep 0.1; done

rate() { wrk -t1 -c64 -d"${seconds}s" "$1" | awk '/Requests\/sec/ {print $2}'; }
rate "$url$target" >/dev/null
for _ in $(seq "$rounds"); do
  a=$(rate "$url$target"); b=$(rate "http://127.0.0.1:$port/tile.glb")
  echo "$a $b"
done >"$work/rates"
python3 - "$work/rates" "$size" "$rounds" "$seconds" <<'PY'
import statistics, sys
pairs = [tuple(map(float, line.split())) for line in open(sys.argv[1])]
ratio = statistics.median(a / b for a, b in pairs)
print("| one cached tile, bytes | terrane-server requests/s | nginx requests/s | ratio |\n|---|---|---|---|")
print(f"| {sys.argv[2]} | {statistics.median(a for a, _ in pairs):,.0f} | {statistics.median(b for _, b in pairs):,.0f} | {ratio:.2f} |")
print(f"\nMedians of {sys.argv[3]} rounds of {sys.argv[4]} s in turn; wrk, 1 thread, 64 connections; ratio pair by pair.")
PY
