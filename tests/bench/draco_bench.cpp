// What a tile of 64 cells with skirts costs on the wire: Draco by speed, normal width and predictions, by libdraco and
// by a template learnt from it, the GLB around it, and reading both back. Medians of interleaved runs over tiles of
// different ground; one thread. libdraco's bytes are those at the same speed with its own predictions. Usage:
// bench_draco [ROUNDS]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "proto/draco_template.h"
#include "proto/gltf_tile.h"
#include "tests/bench/measure.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

using namespace terrane;
using bench::median;
using bench::milliseconds;

struct Row {
  DracoSettings settings;
  std::shared_ptr<const DracoTemplate> learnt;
  std::vector<double> stockMs, fastMs, decodeMs, packMs, readMs;
  std::size_t stockBytes = 0, bytes = 0;
};

/// The same tile by libdraco and by the template, one right after the other.
void measure(const Tile& tile, Row& row) {
  DracoBuffer stock;
  static DracoBuffer draco;
  row.stockMs.push_back(milliseconds([&] { stock = encodeDraco(tile.mesh, row.settings).value(); }));
  row.fastMs.push_back(milliseconds([&] {
    if (row.learnt)
      row.learnt->encodeInto(tile.mesh, draco).value();
    else
      draco = stock;
  }));
  const DracoAttributeIds ids{draco.positionId, draco.normalId, draco.colorId, draco.gridId};
  row.decodeMs.push_back(milliseconds([&] { (void)decodeDraco(draco.bytes, ids, {}).value(); }));
  std::vector<std::uint8_t> glb;
  row.packMs.push_back(milliseconds([&] { glb = writeTileGlb(tile.metadata, tile.mesh, draco).value(); }));
  row.readMs.push_back(milliseconds([&] { (void)decodeTile(glb).value(); }));
  row.stockBytes += stock.bytes.size();
  row.bytes += draco.bytes.size();
}

std::vector<Row> rowsFor(const TileMesh& model) {
  std::vector<Row> rows;
  const auto add = [&](const DracoSettings& settings) {
    Row& row = rows.emplace_back();
    row.settings = settings;
    if (auto learnt = DracoTemplate::learn(model, settings)) row.learnt = *learnt;
  };
  for (const int normalBits : {8, 10}) {
    for (const int speed : {0, 3, 4, 5, 7, 8, 10}) add({.speed = speed, .normalBits = normalBits});
    for (const int speed : {4, 7})
      for (const DracoPrediction prediction : {DracoPrediction::Parallelogram, DracoPrediction::MultiParallelogram})
        for (const DracoNormals normals : {DracoNormals::Delta, DracoNormals::Geometric})
          if (prediction != DracoPrediction::Parallelogram || normals != DracoNormals::Delta)
            add({speed, normalBits, prediction, normals});
  }
  return rows;
}

std::string predictionsOf(const DracoSettings& settings) {
  if (settings.prediction == DracoPrediction::StockAtSpeed) return "stock";
  return fmt::format("{} + {}", settings.prediction == DracoPrediction::Parallelogram ? "single" : "multi",
                     settings.normals == DracoNormals::Delta ? "delta" : "geometric");
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
  std::vector<Row> rows = rowsFor(tiles.front().mesh);
  for (int round = 0; round < rounds; ++round)
    for (const Tile& tile : tiles)
      for (Row& row : rows) measure(tile, row);

  fmt::print(
      "speed  normal bits  predictions        libdraco ms  template ms  ratio  libdraco bytes  bytes  decode ms  "
      "GLB write ms  GLB read ms\n");
  const std::size_t encodes = tiles.size() * static_cast<std::size_t>(rounds);
  for (Row& row : rows) {
    const double stockMs = median(row.stockMs), fastMs = median(row.fastMs);
    fmt::print("{:5}  {:11}  {:17}  {:11.3f}  {:>11}  {:>5}  {:14}  {:5}  {:9.2f}  {:12.4f}  {:11.2f}\n",
               row.settings.speed, row.settings.normalBits, predictionsOf(row.settings), stockMs,
               row.learnt ? fmt::format("{:.3f}", fastMs) : "-",
               row.learnt ? fmt::format("{:.1f}", stockMs / fastMs) : "-", row.stockBytes / encodes,
               row.bytes / encodes, median(row.decodeMs), median(row.packMs), median(row.readMs));
  }
  return 0;
}
