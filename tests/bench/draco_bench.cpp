// What a tile of 64 cells with skirts costs on the wire: Draco by speed and normal width, the GLB around it, and
// reading both back. Medians of interleaved runs over tiles of different ground; one thread. Usage: bench_draco
// [ROUNDS]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "proto/gltf_tile.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

using namespace terrane;

/// Of the thread's own processor time: what else the machine does shows little.
double nowMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double milliseconds(Work&& work) {
  const double begin = nowMs();
  work();
  return nowMs() - begin;
}

double median(std::vector<double>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Row {
  DracoSettings settings;
  std::vector<double> encodeMs, decodeMs, packMs, readMs;
  std::size_t bytes = 0;
};

void measure(const Tile& tile, Row& row) {
  DracoBuffer draco;
  row.encodeMs.push_back(milliseconds([&] { draco = encodeDraco(tile.mesh, row.settings).value(); }));
  const DracoAttributeIds ids{draco.positionId, draco.normalId, draco.colorId, draco.gridId};
  row.decodeMs.push_back(milliseconds([&] { (void)decodeDraco(draco.bytes, ids, {}).value(); }));
  std::vector<std::uint8_t> glb;
  row.packMs.push_back(milliseconds([&] { glb = writeTileGlb(tile.metadata, tile.mesh, draco).value(); }));
  row.readMs.push_back(milliseconds([&] { (void)decodeTile(glb).value(); }));
  row.bytes += glb.size();
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  std::vector<Tile> tiles;
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const int level = 4 + static_cast<int>(seed);
    const FacePath path = FacePath::cubeTile(static_cast<int>(seed % 6), level, seed * 7919 % (1u << level),
                                             seed * 104729 % (1u << level));
    tiles.push_back(test::sampleTile({.path = path, .seed = seed, .roughness = seed % 2 == 0 ? 0.05 : 0.015}));
  }
  std::vector<Row> rows;
  for (const int normalBits : {8, 10})
    for (const int speed : {0, 3, 4, 5, 7, 8, 10}) rows.push_back({{speed, normalBits}, {}, {}, {}, {}, 0});
  for (int round = 0; round < rounds; ++round)
    for (const Tile& tile : tiles)
      for (Row& row : rows) measure(tile, row);

  fmt::print("speed  normal bits  encode ms  decode ms  GLB write ms  GLB read ms  bytes a tile\n");
  for (Row& row : rows) {
    fmt::print("{:5}  {:11}  {:9.2f}  {:9.2f}  {:12.4f}  {:11.2f}  {:12}\n", row.settings.speed,
               row.settings.normalBits, median(row.encodeMs), median(row.decodeMs), median(row.packMs),
               median(row.readMs), row.bytes / (tiles.size() * static_cast<std::size_t>(rounds)));
  }
  return 0;
}
