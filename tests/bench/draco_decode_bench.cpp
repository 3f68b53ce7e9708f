// What reading a tile's Draco stream costs: libdraco, and DracoReader once it knows the kind of tile. Medians of
// interleaved runs over tiles of different ground; one thread, its own processor time. Usage: bench_draco_decode
// [ROUNDS]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "proto/draco_reader.h"
#include "proto/gltf_tile.h"
#include "tests/unit/proto/sample_tile.h"

namespace {

using namespace terrane;

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

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Kind {
  std::string name;
  DracoSettings settings;
  std::vector<DracoBuffer> streams;
  std::vector<double> libdracoMs, readerMs, ratio;
};

Kind makeKind(Scheme scheme, bool skirts, bool colors, const DracoSettings& settings) {
  Kind kind{.name = fmt::format("{}{}{}", schemeName(scheme), skirts ? ", skirts" : "", colors ? ", colours" : ""),
            .settings = settings,
            .streams = {},
            .libdracoMs = {},
            .readerMs = {},
            .ratio = {}};
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    const FacePath path = test::kSamplePaths[scheme == Scheme::Cube ? 0 : 1];
    const Tile tile = test::sampleTile(
        {.path = path, .skirts = skirts, .colors = colors, .seed = seed, .roughness = seed % 2 == 0 ? 0.05 : 0.015});
    kind.streams.push_back(encodeDraco(tile.mesh, settings).value());
  }
  return kind;
}

void measure(Kind& kind, DracoReader& reader) {
  for (const DracoBuffer& stream : kind.streams) {
    const DracoAttributeIds ids{stream.positionId, stream.normalId, stream.colorId, stream.gridId};
    const double libdraco = milliseconds([&] { (void)decodeDraco(stream.bytes, ids, {}).value(); });
    const double quick = milliseconds([&] { (void)reader.decode(stream.bytes, ids, {}).value(); });
    kind.libdracoMs.push_back(libdraco);
    kind.readerMs.push_back(quick);
    kind.ratio.push_back(libdraco / quick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 10;
  std::vector<Kind> kinds;
  for (const int speed : {1, 3, 5, 7, 10}) kinds.push_back(makeKind(Scheme::Cube, true, true, {speed, 8}));
  kinds.push_back(makeKind(Scheme::Cube, true, false, {7, 8}));
  kinds.push_back(makeKind(Scheme::Cube, false, true, {7, 10}));
  kinds.push_back(makeKind(Scheme::Ico, true, true, {7, 8}));
  fmt::print("                              speed  normal bits  libdraco ms  reader ms  times  read quickly\n");
  for (Kind& kind : kinds) {
    // Of its own, so that no kind is forgotten for another.
    DracoReader reader;
    measure(kind, reader);
    kind.libdracoMs.clear();
    kind.readerMs.clear();
    kind.ratio.clear();
    for (int round = 0; round < rounds; ++round) measure(kind, reader);
    const auto [quick, byLibdraco] = reader.counts();
    fmt::print("{:28}  {:5}  {:11}  {:11.3f}  {:9.3f}  {:5.1f}  {} of {}\n", kind.name, kind.settings.speed,
               kind.settings.normalBits, median(kind.libdracoMs), median(kind.readerMs), median(kind.ratio), quick,
               quick + byLibdraco);
  }
  return 0;
}
