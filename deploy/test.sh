#!/usr/bin/env bash
# Everything that a change must pass: installs what is missing, builds, tests. The last lines are ctest's.
# Usage: deploy/test.sh [--full]
#   --full adds: debug, Clang, -O0 and -march=native builds, clang-tidy, ten minutes of fuzzing, 200 random cameras,
#   flights of 2,000 frames without a hole and without a pop, textures followed for 1,000, 10,000 cameras of tile
#   selection against brute force, the bytes of 100,000 tiles, 10,000 morphed tiles against their parents (more than an
#   hour on two cores)
set -euo pipefail
cd "$(dirname "$0")/.."

full=false
for argument in "$@"; do
  case "$argument" in
    --full) full=true ;;
    -h|--help) sed -n '2,7s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) echo "test: unknown argument $argument (see --help)" >&2; exit 2 ;;
  esac
done

step() { printf '\n== %s (%ds)\n' "$1" "$SECONDS"; }

step "install"
deploy/install.sh

step "formatting"
git ls-files '*.cpp' '*.h' '*.inl' | xargs -r clang-format --dry-run --Werror

build() { cmake --preset "$1" >/dev/null && cmake --build --preset "$1"; }

step "build: release"
build release

for sanitizer in asan-ubsan tsan; do
  step "build: $sanitizer"
  build "$sanitizer"
  step "tests under $sanitizer"
  ctest --preset "$sanitizer" -j 2 --quiet --output-on-failure -O "build/$sanitizer/ctest.log" \
    || { tail -n 60 "build/$sanitizer/ctest.log"; exit 1; }
  tail -n 12 "build/$sanitizer/ctest.log"
done

if $full; then
  step "build and test: debug"
  build debug
  ctest --preset debug -j 2 --output-on-failure -L 'unit|numeric|integration'
  step "GCC and Clang, -O0 and -O3, any and this CPU: the same golden tiles"
  for variant in "g++ -O3 -march=x86-64" "g++ -O3 -march=native" "clang++ -O3 -march=x86-64" "clang++ -O3 -march=native" "g++ -O0"; do
    compiler=${variant%% *}; flags=${variant#* }
    directory="build/matrix-$(tr -c 'a-z0-9+\n' '-' <<<"$variant")"
    cmake -G Ninja -S . -B "$directory" -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$compiler" \
      -DCMAKE_CXX_FLAGS_RELEASE="$flags" -DTERRANE_BENCHMARKS=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
    cmake --build "$directory"
    ctest --test-dir "$directory" -j 2 --output-on-failure -L 'unit|numeric|integration'
  done
  step "clang-tidy"
  cmake --preset release -B build/tidy -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON >/dev/null
  git ls-files 'common/*.cpp' 'proto/*.cpp' 'server/*.cpp' 'client/*.cpp' | grep -v stb_implementation | xargs -P 2 -n 4 clang-tidy -p build/tidy --quiet \
    --extra-arg=-Wno-unknown-warning-option --extra-arg=-Wno-ignored-optimization-argument
  step "fuzzing"
  cmake --preset fuzz -DTERRANE_FUZZ_SECONDS=100 >/dev/null
  cmake --build --preset fuzz
  ctest --test-dir build/fuzz -L fuzz --output-on-failure
  export TERRANE_CAMERAS=200 TERRANE_SELECTION_CAMERAS=10000 TERRANE_HASHED_TILES=100000 TERRANE_MORPH_TILES=10000 TERRANE_DRACO_TILES=10000
  export TERRANE_FLIGHT_FRAMES=2000 TERRANE_POP_FRAMES=2000 TERRANE_SWIM_FRAMES=1000
fi

step "all tests: release"
ctest --preset release -j 2
