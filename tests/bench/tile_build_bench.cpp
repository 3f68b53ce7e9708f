// What a tile costs to build, by level, beside what stock Draco alone takes for the same mesh in the same run, both
// in processor time (the parts are by the clock).
// Usage: bench_tile_build [--tiles N] [--scene NAME] [--default-heap]; prints a Markdown table of medians, one core.
// The heap is set as the server sets it, for both; --default-heap leaves it alone.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "common/memory/heap_policy.h"
#include "server/build/tile_builder.h"
#include "server/scenes/scene_file.h"
#include "tests/bench/measure.h"
#include "tests/bench/stock_draco.h"

namespace {

using namespace terrane;
using bench::median;

FacePath randomTile(std::mt19937_64& random, Scheme scheme, int level) {
  FacePath path = FacePath::wholeFace(scheme, static_cast<int>(random() % static_cast<unsigned>(faceCount(scheme))));
  while (path.level() < level) path = path.child(static_cast<int>(random() % 4));
  return path;
}

struct Row {
  std::vector<double> field, mesh, draco, glb, total, stock, stockDeduplicated, ratio, bytes;
};

bool measure(const TileBuilder& builder, const FacePath& path, const DracoSettings& settings, Row& row) {
  // The build first: a builder that has just made the same tile's mesh would know the features near it.
  const double start = bench::threadMs();
  const auto built = builder.build(path);
  const double took = bench::threadMs() - start;
  if (!built) return false;
  const auto tile = builder.buildMesh(path);
  if (!tile) return false;
  const auto stock = bench::encodeWithStockDraco(tile->mesh, settings, false);
  const auto deduplicated = bench::encodeWithStockDraco(tile->mesh, settings, true);
  row.field.push_back(built->times.fieldMs);
  row.mesh.push_back(built->times.meshMs);
  row.draco.push_back(built->times.dracoMs);
  row.glb.push_back(built->times.glbMs);
  row.total.push_back(took);
  row.stock.push_back(stock.milliseconds);
  row.ratio.push_back(took / stock.milliseconds);
  row.stockDeduplicated.push_back(deduplicated.milliseconds);
  row.bytes.push_back(static_cast<double>(built->glb.size()));
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  int tiles = 25;
  std::string sceneName = "moon";
  bool defaultHeap = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view flag = argv[i];
    if (flag == "--default-heap") defaultHeap = true;
    if (flag == "--tiles" && i + 1 < argc) tiles = std::max(1, std::atoi(argv[i + 1]));
    if (flag == "--scene" && i + 1 < argc) sceneName = argv[i + 1];
  }
  if (!defaultHeap) keepFreedMemory(kHeapKeptByServer);
  const auto scene = loadScene(sceneName);
  if (!scene) {
    fmt::print(stderr, "bench_tile_build: {}\n", scene.error().text());
    return 2;
  }
  const WireSettings wire;
  DracoSettings stockSettings = wire.draco;
  stockSettings.speed = 7;
  const TileBuilder builder(scene->bodies.front(), wire, bestSimdPath());
  std::mt19937_64 random(20260101);
  const Scheme scheme = builder.info().selection.scheme;

  fmt::print(
      "| level | field ms | mesh ms | Draco ms | GLB ms | tile ms | stock Draco ms (with de-duplication) | tile / "
      "stock | KB |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|\n");
  std::vector<double> ratios;
  for (int level = 0; level <= std::min(24, builder.info().selection.maxLevel); level += 2) {
    Row row;
    measure(builder, randomTile(random, scheme, level), stockSettings, row);  // warm-up, dropped
    row = {};
    for (int i = 0; i < tiles; ++i) {
      if (!measure(builder, randomTile(random, scheme, level), stockSettings, row)) return 1;
    }
    const double ratio = median(row.ratio);
    ratios.push_back(ratio);
    fmt::print("| {} | {:.2f} | {:.2f} | {:.2f} | {:.3f} | {:.2f} | {:.2f} ({:.2f}) | {:.2f} | {:.1f} |\n", level,
               median(row.field), median(row.mesh), median(row.draco), median(row.glb), median(row.total),
               median(row.stock), median(row.stockDeduplicated), ratio, median(row.bytes) / 1024);
  }
  fmt::print("\nMedian of the ratios: {:.2f}; largest: {:.2f}. {} tiles a level, one core, SIMD path {}.\n",
             median(ratios), *std::max_element(ratios.begin(), ratios.end()), tiles,
             bestSimdPath() == SimdPath::V4   ? "v4"
             : bestSimdPath() == SimdPath::V3 ? "v3"
                                              : "default");
  return 0;
}
