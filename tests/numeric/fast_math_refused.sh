#!/usr/bin/env bash
# What reaches a tile does not compile where the compiler may change the value of an expression: tries the options that
# tell of themselves by a macro, on the headers and on every source file that computes such values, with each compiler
# that is there. The control beside each: without the option it compiles.
#   fast_math_refused.sh SOURCE_DIRECTORY COMPILER...
# What tells nobody (all of Clang's finer options, contraction everywhere) is contraction_probe_test's to find.
set -euo pipefail
cd "$1"
shift

readonly message="Terrane's tiles must be the same bytes everywhere"
readonly precision_message="Terrane needs float and double to be evaluated in their own precision"
readonly compile=(-std=c++20 -I. -DGLM_FORCE_XYZW_ONLY -DGLM_FORCE_EXPLICIT_CTOR)

failures=0
checks=0
fail() {
  echo "FAILED: $1" >&2
  failures=$((failures + 1))
}

# refused COMPILER MESSAGE FILE [OPTION...]: the preprocessor is enough, for that is where the refusal stands.
refused() {
  local compiler=$1 expected=$2 file=$3 errors
  shift 3
  checks=$((checks + 1))
  if errors=$("$compiler" "${compile[@]}" "$@" -Wfatal-errors -x c++ -E "$file" 2>&1 >/dev/null); then
    fail "$compiler $* takes $file"
  elif ! grep -qF "$expected" <<<"$errors"; then
    fail "$compiler $* refuses $file for another reason: $errors"
  fi
}

# The control, compiled in full.
accepted() {
  local compiler=$1 file=$2 errors
  shift 2
  checks=$((checks + 1))
  errors=$("$compiler" "${compile[@]}" -x c++ -fsyntax-only "$@" "$file" 2>&1) || fail "$compiler $* does not take $file: $errors"
}

# Files whose results reach a tile and that compute with floating point: all such of these folders, and proto's writers.
sources() {
  grep -lwE 'double|float' common/tiling/*.cpp server/fields/*.cpp server/build/*.cpp
  ls server/fields/lunar_kernels_*.cpp proto/draco_input.cpp proto/draco_template.cpp proto/gltf_tile_writer.cpp
}
readonly headers="common/numerics/double_float.h server/fields/lunar_program.h server/fields/feature_layers.h
  server/fields/lunar_bounds.h"
files=$(sources | sort -u)

for compiler in "$@"; do
  if ! command -v "$compiler" >/dev/null; then
    echo "no $compiler here"
    continue
  fi
  options=(-ffast-math -Ofast -ffinite-math-only)
  if ! "$compiler" --version | grep -q clang; then
    options+=(-funsafe-math-optimizations -freciprocal-math -fno-signed-zeros
      "-fassociative-math -fno-signed-zeros -fno-trapping-math")
    if [[ $("$compiler" -dumpmachine) == x86_64* ]]; then
      refused "$compiler" "$precision_message" common/numerics/strict_math.h -mfpmath=387
    fi
  fi
  for option in "${options[@]}"; do
    # shellcheck disable=SC2086  # an option may be several words
    refused "$compiler" "$message" common/numerics/strict_math.h $option
  done
  # Which file includes what is the same for every compiler, so the first one answers for all.
  for file in $headers $files; do refused "$compiler" "$message" "$file" -ffast-math; done
  files=""
  for file in common/numerics/strict_math.h common/numerics/double_float.h common/tiling/lattice.cpp; do
    accepted "$compiler" "$file" -ffp-contract=off -fno-math-errno -fno-trapping-math
  done
done

echo "$checks checks, $failures failures"
((checks > 0 && failures == 0))
