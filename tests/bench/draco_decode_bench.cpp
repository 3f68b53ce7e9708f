// What reading a tile's Draco stream costs libdraco, and DracoReader once it knows the kind of tile; and all that a
// viewer's worker does with a tile, by the latter. Prints Markdown. Usage: bench_draco_decode [ROUNDS]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <string>
#include <vector>

#include "common/memory/heap_policy.h"
#include "proto/draco_reader.h"
#include "proto/gltf_tile.h"
#include "tests/bench/measure.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

using namespace terrane;
using bench::median;
using bench::milliseconds;

struct Kind {
  std::string name;
  DracoSettings settings;
  std::vector<DracoBuffer> streams;
  std::vector<std::vector<std::uint8_t>> glbs;
  DracoReader reader;  ///< its own, so that no kind is forgotten for another
  std::vector<double> libdracoMs, readerMs, ratio, glbMs;
  std::size_t bytes = 0;

  Kind(Scheme scheme, bool skirts, bool colors, const DracoSettings& chosen);
  void measure();
};

Kind::Kind(Scheme scheme, bool skirts, bool colors, const DracoSettings& chosen)
    : name(fmt::format("{}{}{}", schemeName(scheme), skirts ? ", skirts" : "", colors ? ", colours" : "")),
      settings(chosen) {
  for (std::uint32_t seed = 1; seed <= 12; ++seed) {
    const Tile tile = test::sampleTile({.path = test::kSamplePaths[scheme == Scheme::Cube ? 0 : 1],
                                        .skirts = skirts,
                                        .colors = colors,
                                        .seed = seed,
                                        .roughness = seed % 2 == 0 ? 0.05 : 0.015});
    streams.push_back(encodeDraco(tile.mesh, settings).value());
    glbs.push_back(writeTileGlb(tile.metadata, tile.mesh, streams.back()).value());
    bytes += streams.back().bytes.size();
  }
  (void)decodeTile(glbs.front(), reader).value();
}

void Kind::measure() {
  for (std::size_t i = 0; i < streams.size(); ++i) {
    const DracoBuffer& stream = streams[i];
    const DracoAttributeIds ids{stream.positionId, stream.normalId, stream.colorId, stream.gridId};
    libdracoMs.push_back(milliseconds([&] { (void)decodeDraco(stream.bytes, ids, {}).value(); }));
    readerMs.push_back(milliseconds([&] { (void)reader.decode(stream.bytes, ids, {}).value(); }));
    ratio.push_back(readerMs.back() / libdracoMs.back());
    glbMs.push_back(milliseconds([&] { (void)decodeTile(glbs[i], reader).value(); }));
  }
}

}  // namespace

int main(int argc, char** argv) {
  // As the viewer does: libdraco takes and frees megabytes a tile.
  keepFreedMemory(kHeapKeptByViewer);
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 15;
  std::deque<Kind> kinds;
  for (const int speed : {1, 3, 4, 5, 7, 10}) kinds.emplace_back(Scheme::Cube, true, true, DracoSettings{speed, 8});
  kinds.emplace_back(Scheme::Cube, true, false, DracoSettings{});
  kinds.emplace_back(Scheme::Cube, true, true, DracoSettings{.normalBits = 10});
  kinds.emplace_back(Scheme::Ico, true, true, DracoSettings{});
  for (int round = 0; round < rounds; ++round)
    for (Kind& kind : kinds) kind.measure();

  fmt::print("| tiles | speed | normal bits | KB | libdraco ms | reader ms | reader / libdraco | whole GLB ms |\n");
  fmt::print("|---|---|---|---|---|---|---|---|\n");
  for (const Kind& kind : kinds) {
    fmt::print("| {} | {} | {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} |\n", kind.name, kind.settings.speed,
               kind.settings.normalBits, 1e-3 * static_cast<double>(kind.bytes / kind.streams.size()),
               median(kind.libdracoMs), median(kind.readerMs), median(kind.ratio), median(kind.glbMs));
    if (kind.reader.counts().byLibdraco > 1) fmt::print("Not all of these were read by the reader itself.\n");
  }
  fmt::print("\nMedians of {} rounds in turn over 12 tiles each; one thread's own time; ratio pair by pair.\n", rounds);
  return 0;
}
