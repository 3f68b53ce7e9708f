// DracoReader as the decode workers share it.

#include <gtest/gtest.h>

#include <thread>
#include <vector>

#include "proto/draco_reader.h"
#include "tests/unit/client/small_tiles.h"

namespace terrane::testing {
namespace {

TEST(DracoReaderThreads, MayLearnAndReadAtOnce) {
  constexpr std::size_t kThreads = 4, kRounds = 20, kKinds = 3;
  std::vector<DracoBuffer> streams;
  std::vector<TileMesh> expected;
  const DracoAttributeIds ids{.position = 0, .normal = 1, .color = -1, .grid = 2};
  for (const int cells : {4, 8, 16})
    for (const double bumpMeters : {0.0, 100.0, 3000.0}) {
      const auto height = [&](const glm::dvec3& direction) { return bumpMeters * direction.x * direction.y; };
      const Tile tile = smallTile(FacePath::parse("cube/2/031").value(), height, {.cells = cells});
      ASSERT_TRUE(tile.mesh.colors.empty());
      streams.push_back(encodeDraco(tile.mesh, {}).value());
      expected.push_back(decodeDraco(streams.back().bytes, ids, {}).value());
    }
  DracoReader reader;
  std::vector<std::size_t> wrong(kThreads);
  std::vector<std::thread> threads;
  for (std::size_t thread = 0; thread < kThreads; ++thread)
    threads.emplace_back([&, thread] {
      for (std::size_t i = 0; i < kRounds * streams.size(); ++i) {
        const std::size_t which = (i * 5 + thread) % streams.size();
        const auto mesh = reader.decode(streams[which].bytes, ids, {});
        if (!mesh || mesh->offsets != expected[which].offsets || mesh->normals != expected[which].normals ||
            mesh->triangles != expected[which].triangles || mesh->gridIndices != expected[which].gridIndices)
          ++wrong[thread];
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<std::size_t>(kThreads));
  const auto [quick, byLibdraco] = reader.counts();
  EXPECT_EQ(quick + byLibdraco, kThreads * kRounds * streams.size());
  EXPECT_LE(byLibdraco, kKinds * kThreads) << "each thread learns a kind once at most";
}

}  // namespace
}  // namespace terrane::testing
