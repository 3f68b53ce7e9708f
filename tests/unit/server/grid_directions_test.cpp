#include "server/build/grid_directions.h"

#include <gtest/gtest.h>

#include <random>

#include "common/tiling/cube_sphere.h"

namespace terrane {
namespace {

TEST(GridDirections, AreCubeGridDirectionsToTheBit) {
  std::mt19937_64 random(41);
  GridDirections directions;
  for (int round = 0; round < 300; ++round) {
    const int level = round % 31, face = static_cast<int>(random() % 6);
    const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
    // Every third tile touches an edge of its face, where the bits are shared.
    const std::uint32_t column = round % 3 == 0 ? last : static_cast<std::uint32_t>(random()) & last;
    const std::uint32_t row = static_cast<std::uint32_t>(random()) & last;
    const int levels = round % 2 == 0 ? 6 : 3, cells = 1 << levels;
    gridDirections(FacePath::cubeTile(face, level, column, row), cells, directions);
    const auto side = static_cast<std::size_t>(cells) + 1;
    ASSERT_EQ(directions.x.size(), side * side);
    for (std::size_t j = 0; j < side; ++j) {
      for (std::size_t i = 0; i < side; ++i) {
        const glm::dvec3 expected = cubeGridDirection(face, level + levels, (std::uint64_t{column} << levels) + i,
                                                      (std::uint64_t{row} << levels) + j);
        const glm::dvec3 got(directions.x[j * side + i], directions.y[j * side + i], directions.z[j * side + i]);
        ASSERT_TRUE(got == expected) << "level " << level << " vertex " << i << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace terrane
