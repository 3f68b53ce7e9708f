#!/usr/bin/env bash
# Installs what Terrane needs to build, test and run on Debian 12. Safe to call again: when all is there it only looks.
# Usage: deploy/install.sh
set -euo pipefail

packages=(
  # toolchain
  g++ cmake ninja-build ccache pkg-config git ca-certificates
  # libraries
  libboost1.81-dev libglm-dev libdraco-dev libtinygltf-dev libglfw3-dev libepoxy-dev libimgui-dev libstb-dev
  libspdlog-dev libfmt-dev libcli11-dev libtomlplusplus-dev nlohmann-json3-dev libsqlite3-dev libxxhash-dev
  # software OpenGL and a virtual display, for machines without a GPU or a screen
  xvfb libgl1-mesa-dri libegl1 libgl1 xauth
  # tests, sanitizers (llvm: lines in their reports), fuzzing, benchmarks
  libgtest-dev libgmock-dev libbenchmark-dev libmpfr-dev libqd-dev clang libclang-rt-14-dev llvm clang-format clang-tidy
  nginx-light wrk curl procps python3-minimal
)

missing=()
installed=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' "${packages[@]}" 2>/dev/null || true)
for package in "${packages[@]}"; do
  grep -qx "$package installed" <<<"$installed" || missing+=("$package")
done
if [ ${#missing[@]} -eq 0 ]; then
  echo "install: all ${#packages[@]} packages are there"
  exit 0
fi

asRoot=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "install: root or sudo is needed for: ${missing[*]}" >&2; exit 1; }
  asRoot=(sudo)
fi
export DEBIAN_FRONTEND=noninteractive
echo "install: ${missing[*]}"
"${asRoot[@]}" apt-get update -qq
"${asRoot[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
echo "install: done"
