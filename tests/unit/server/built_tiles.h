#pragma once
// Tiles of the test Moon, and of other grounds of its size, as the builder makes them in either scheme, and where their
// vertices are.

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <utility>

#include "common/tiling/lattice.h"
#include "server/build/tile_builder.h"
#include "tests/support/both_schemes.h"
#include "tests/support/grounds.h"
#include "tests/support/ico_points.h"

namespace terrane::test {

inline constexpr double kMoon = 1'737'400.0;
inline constexpr std::uint64_t kBodySeed = 1;

inline const TileBuilder& builderOf(const Ground& ground) {
  static std::map<std::pair<Scheme, FieldKind>, TileBuilder> builders;
  const auto [made, fresh] = builders.try_emplace({ground.scheme, ground.field}, bodyOf(ground, kMoon, kBodySeed),
                                                  WireSettings{}, bestSimdPath());
  return made->second;
}

inline FacePath randomTile(std::mt19937_64& random, Scheme scheme, int level) {
  if (scheme == Scheme::Ico) return randomIcoTile(random, level);
  const std::uint64_t last = (std::uint64_t{1} << level) - 1;
  const auto column = static_cast<std::uint32_t>(random() & last), row = static_cast<std::uint32_t>(random() & last);
  return FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row);
}

inline Tile mesh(const TileBuilder& builder, const FacePath& path) {
  Result<Tile> tile = builder.buildMesh(path);
  EXPECT_TRUE(tile.has_value()) << (tile.has_error() ? tile.error().text() : "");
  return tile.has_value() ? std::move(*tile) : Tile{};
}

inline glm::dvec3 position(const Tile& tile, std::size_t vertex) {
  const std::uint16_t* offset = tile.mesh.offsets.data() + 3 * vertex;
  return latticePosition(tile.metadata.origin + LatticePoint(offset[0], offset[1], offset[2]),
                         tile.metadata.stepExponent);
}

/// Tests that hold for tiles of both schemes: of the Moon, or of all grounds.
class OfScheme : public testing::TestWithParam<Ground> {
 protected:
  static const TileBuilder& builder() { return builderOf(GetParam()); }
  static int maxLevel() { return builder().info().selection.maxLevel; }
  static FacePath randomTile(std::mt19937_64& random, int level) { return test::randomTile(random, GetParam(), level); }
  /// A tile of the scheme by what follows the scheme in its name.
  static FacePath path(std::string_view faceAndDigits) {
    return FacePath::parse(std::string(schemeName(GetParam().scheme)) + "/" + std::string(faceAndDigits)).value();
  }
};

}  // namespace terrane::test
