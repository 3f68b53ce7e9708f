#!/usr/bin/env bash
# Runs the benchmarks (medians; ratios measured side by side in one run) and prints them as Markdown.
# Usage: deploy/bench.sh [--write-readme] [--quick]
set -euo pipefail
cd "$(dirname "$0")/.."
write=false quick=false
for argument in "$@"; do
  case "$argument" in
    --write-readme) write=true ;;
    --quick) quick=true ;;
    -h|--help) sed -n '2,3s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "bench: unknown argument $argument (see --help)" >&2; exit 2 ;;
  esac
done
deploy/install.sh >&2
cmake --preset release >&2
cmake --build --preset release --target terrane-server terrane-view terrane-accuracy bench_tile_build bench_draco_decode bench_planets bench_viewer bench_effects >&2
bin=build/release/bin
tiles=25 rounds=5 seconds=4
$quick && tiles=5 rounds=1 seconds=1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
report=$work/report.md
{
  echo "**Building a tile**, by level, beside what stock Draco (edgebreaker, speed 7, 16 bits) alone takes for the same mesh:"
  echo
  "$bin/bench_tile_build" --tiles "$tiles"
  echo
  echo "**Reading a tile**, 64 cells: its Draco stream by libdraco and by the viewer's reader, which knows kinds of tiles:"
  echo
  "$bin/bench_draco_decode" "$($quick && echo 3 || echo 15)"
  echo
  echo "**Who builds the planets**: a first whole view of several bodies (scene \`planets\`), by one thread a body and by tile on one pool:"
  echo
  "$bin/bench_planets" --rounds "$($quick && echo 3 || echo 15)"
  echo
  echo "**Serving a cached tile**, beside nginx serving the same file:"
  echo
  tests/bench/http_bench.sh "$bin" "$rounds" "$seconds"
  echo
  echo "**Viewing** at 1280×720 on software OpenGL (llvmpipe), beside a bare loop that draws the same triangles:"
  echo
  tests/bench/viewer_bench.sh "$bin" "$($quick && echo 10 || echo 60)"
  echo
  echo "**What a seamless, real ground costs**, at 1280×720 on software OpenGL: every tile half way between two levels, the effects detail and dust; each left out, and several samples a pixel put in:"
  echo
  "$bin/bench_effects" --frames "$($quick && echo 5 || echo 15)"
} | tee "$report"

"$bin/terrane-accuracy" $($quick && echo --quick) --only summary --out "$work/accuracy" >&2
python3 - "$work/accuracy/accuracy.json" >"$work/accuracy.md" <<'PY'
import json, sys
summary = json.load(open(sys.argv[1]))["experiments"][0]
keys = list(summary["columns"])
if not keys:
    sys.exit("bench: " + summary["findings"][0])
print("| " + " | ".join(summary["columns"].values()) + " |")
print("|---" * len(keys) + "|")
for row in summary["rows"]:
    print("| " + " | ".join(v if isinstance(v, str) else f"{v:.2g}" for v in (row[k] for k in keys)) + " |")
PY
cat "$work/accuracy.md"

if $write; then
  python3 - "$report" "$work/accuracy.md" <<'PY'
import re, sys
text = open("README.md").read()
for name, file in (("bench", sys.argv[1]), ("accuracy", sys.argv[2])):
    body = open(file).read().strip()
    text = re.sub(rf"(<!-- {name}:begin -->\n).*?(<!-- {name}:end -->)", lambda m: m.group(1) + body + "\n" + m.group(2), text, flags=re.S)
open("README.md", "w").write(text)
PY
  echo "bench: README.md updated" >&2
fi
