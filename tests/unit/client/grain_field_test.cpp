// Which grains lie where: the same whichever tile asks, none twice, none lost.

#include "client/dust/grain_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>

#include "common/tiling/cube_sphere.h"
#include "common/tiling/ico_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_neighbours.h"
#include "tests/support/both_schemes.h"

namespace terrane {
namespace {

constexpr std::uint64_t kSeed = 20261126;
constexpr double kMoon = 1'737'400.0;

FacePath randomTriangle(std::mt19937_64& random, int level, int kind) {
  FacePath tile = FacePath::wholeFace(Scheme::Ico, static_cast<int>(random() % 20));
  const auto corner = random() % 3;
  while (tile.level() < level) {
    const auto digit = kind == 0 ? random() % 4 : kind == 1 ? (corner + random() % 2) % 3 : corner;
    tile = tile.child(static_cast<int>(digit));
  }
  return tile;
}

/// A third each at an edge, at a corner and inside of a face.
FacePath randomTile(Scheme scheme, std::mt19937_64& random, int level) {
  const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
  const int kind = static_cast<int>(random() % 3);
  if (scheme == Scheme::Ico) return randomTriangle(random, level, kind);
  const auto inside = [&] { return static_cast<std::uint32_t>(random() & last); };
  const auto border = [&] { return random() % 2 == 0 ? 0 : last; };
  const std::uint32_t column = kind == 0 ? inside() : border(), row = kind == 2 ? border() : inside();
  return FacePath::cubeTile(static_cast<int>(random() % 6), level, column, row);
}

std::vector<Grain> collected(const GrainField& field, const FacePath& tile, int classLevel) {
  std::vector<Grain> grains;
  field.collect(tile, classLevel, grains);
  return grains;
}

void sortByCell(std::vector<Grain>& grains) {
  std::ranges::sort(
      grains, [](const Grain& a, const Grain& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
}

/// Where on the parent's grid a place on the grid of its child is.
glm::dvec2 onParent(Scheme scheme, int digit, const glm::dvec2& cells) {
  if (scheme == Scheme::Cube) return cells / 2.0 + 32.0 * glm::dvec2(digit & 1, digit >> 1);
  if (digit == 3) return glm::dvec2(32.0) - cells / 2.0;
  return cells / 2.0 + glm::dvec2(digit == 1 ? 32 : 0, digit == 2 ? 32 : 0);
}

double cellsFromBorder(Scheme scheme, const glm::dvec2& cells) {
  const double fromAxes = std::min(cells.x, cells.y);
  if (scheme == Scheme::Ico) return std::min(fromAxes, 64 - cells.x - cells.y);
  return std::min(fromAxes, 64 - std::max(cells.x, cells.y));
}

/// All but where in the tile it is.
bool sameGrain(const Grain& a, const Grain& b) {
  return a.classLevel == b.classLevel && a.column == b.column && a.row == b.row &&
         a.diameterMeters == b.diameterMeters && a.flattening == b.flattening && a.centerHeight == b.centerHeight &&
         a.shade == b.shade && a.variant == b.variant && std::ranges::equal(a.turn, b.turn);
}

glm::dvec3 positionOf(const FacePath& tile, const Grain& grain, double radiusMeters) {
  if (tile.scheme() == Scheme::Ico) {
    const auto corners = icoCornerDirections(kIcoMap, tile);
    const glm::dvec2 part = grain.cells / double{kGrainCells};
    return radiusMeters *
           glm::normalize(corners[0] + part.x * (corners[1] - corners[0]) + part.y * (corners[2] - corners[0]));
  }
  const double scale = std::ldexp(2.0, -tile.level()) / kGrainCells;
  return radiusMeters * cubeDirection(tile.face(), (tile.column() * 64.0 + grain.cells.x) * scale - 1,
                                      (tile.row() * 64.0 + grain.cells.y) * scale - 1);
}

class GrainFieldOfSchemes : public testing::TestWithParam<Scheme> {};

TEST_P(GrainFieldOfSchemes, ATilesGrainsAreItsChildrensClassByClass) {
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  std::size_t compared = 0, empty = 0;
  for (int round = 0; round < 10'000; ++round) {
    // Small bodies have their grains at coarse levels: so all levels are tried.
    const int level = 8 + round % 19;
    const double radius = kMoon * std::ldexp(1.0, level - 24);
    const GrainField field({}, radius, GetParam());
    const FacePath tile = randomTile(GetParam(), random, level);
    const int classes = std::min(field.finestClass(), level - 1) - field.coarsestClass() + 1;
    ASSERT_GT(classes, 0);
    const int classLevel = field.coarsestClass() + static_cast<int>(random() % static_cast<unsigned>(classes));
    std::vector<Grain> own = collected(field, tile, classLevel), childrens;
    for (int digit = 0; digit < 4; ++digit) {
      for (const Grain& grain : collected(field, tile.child(digit), classLevel)) {
        childrens.push_back(grain);
        childrens.back().cells = onParent(tile.scheme(), digit, grain.cells);
      }
    }
    sortByCell(own);
    sortByCell(childrens);
    ASSERT_EQ(own.size(), childrens.size()) << tile.text() << " class " << classLevel;
    for (std::size_t i = 0; i < own.size(); ++i) {
      ASSERT_TRUE(sameGrain(own[i], childrens[i])) << tile.text() << " class " << classLevel;
      if (GetParam() == Scheme::Cube) {
        ASSERT_EQ(own[i].cells, childrens[i].cells) << "to the last bit";
      } else {  // thirds of whole numbers are rounded
        ASSERT_LE(glm::distance(own[i].cells, childrens[i].cells), 64 * 0x1p-51);
      }
    }
    compared += own.size();
    empty += own.empty() ? 1 : 0;
  }
  std::printf("%zu grains compared; %zu tiles without\n", compared, empty);
  EXPECT_GT(compared, 100'000u);
}

TEST_P(GrainFieldOfSchemes, NoTwoOfAClassShareTheGroundEvenOverFaceEdges) {
  std::mt19937_64 random(kSeed);
  const GrainField field({}, kMoon, GetParam());
  std::size_t pairs = 0;
  double closest = 1e9;
  for (int round = 0; round < 300; ++round) {
    const int level = field.finestClass();
    const FacePath tile = randomTile(GetParam(), random, level);
    struct Placed {
      glm::dvec3 position;
      double radius;
    };
    const auto nearBorder = [&](const FacePath& of, std::vector<Placed>& placed) {
      for (const Grain& grain : collected(field, of, level))
        if (cellsFromBorder(of.scheme(), grain.cells) < 1)
          placed.push_back({positionOf(of, grain, kMoon), grain.diameterMeters / 2.0});
    };
    std::vector<Placed> own, beside;
    nearBorder(tile, own);
    for (const FacePath& neighbour : tilesAround(tile)) nearBorder(neighbour, beside);
    for (const Placed& a : own)
      for (const Placed& b : beside) {
        const double apart = glm::length(a.position - b.position) / (a.radius + b.radius);
        closest = std::min(closest, apart);
        pairs += apart < 2 ? 1 : 0;
      }
  }
  std::printf("%zu pairs within two diameters over tile borders, the closest %.3f of touching\n", pairs, closest);
  EXPECT_GT(pairs, 300u);
  // Squares are 1 / sqrt(2) of their nominal width where they are narrowest, in the middle of a face's edge; triangles
  // are never narrower than they should be by more than their sharpest corners make them.
  EXPECT_GT(closest, 0.7);
}

TEST_P(GrainFieldOfSchemes, IsTheSameOnEveryMachine) {
  const GrainField field({}, kMoon, GetParam());
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 1099511628211ull; };
  std::size_t count = 0;
  for (int face = 0; face < faceCount(GetParam()); ++face) {
    for (int classLevel = field.coarsestClass(); classLevel <= field.finestClass(); ++classLevel) {
      const FacePath tile =
          FacePath::parse(std::string(schemeName(GetParam())) + "/" + std::to_string(face) + "/0312031203120312031203")
              .value();
      if (classLevel > tile.level()) continue;
      for (const Grain& grain : collected(field, tile, classLevel)) {
        ++count;
        add(grain.column);
        add(grain.row);
        add(std::bit_cast<std::uint64_t>(grain.cells.x));
        add(std::bit_cast<std::uint64_t>(grain.cells.y));
        for (const float value : {grain.diameterMeters, grain.flattening, grain.centerHeight, grain.shade,
                                  grain.turn[0], grain.turn[1], grain.turn[2], grain.turn[3]})
          add(std::bit_cast<std::uint32_t>(value));
        add(static_cast<std::uint64_t>(grain.variant));
      }
    }
  }
  std::printf("%zu grains, hash %llx\n", count, static_cast<unsigned long long>(hash));
  EXPECT_EQ(hash, GetParam() == Scheme::Cube ? 0xa876ad231ccea197ull : 0xf83a217773aac6eull);
}

TEST_P(GrainFieldOfSchemes, CoversWhatItIsToldAndKeepsItsSizes) {
  std::mt19937_64 random(kSeed);
  // The finest class is whole: its least grains are a fifth of a cell wide.
  const double smallestMeters = 0.19 * nominalTileWidthMeters(kMoon, 23, GetParam()) / kGrainCells;
  const DustSettings settings{.cover = 0.02, .smallestMeters = smallestMeters, .largestMeters = 0.05};
  const GrainField field(settings, kMoon, GetParam());
  const auto meanCover = [&](int classLevel) {
    double sum = 0;
    constexpr int kTiles = 400;
    for (int i = 0; i < kTiles; ++i) {
      FacePath tile =
          FacePath::wholeFace(GetParam(), static_cast<int>(random() % static_cast<unsigned>(faceCount(GetParam()))));
      while (tile.level() < classLevel) tile = tile.child(static_cast<int>(random() % 4));
      for (const Grain& grain : collected(field, tile, classLevel)) {
        EXPECT_GE(grain.diameterMeters, static_cast<float>(smallestMeters));
        EXPECT_LE(grain.diameterMeters, 0.05f);
        EXPECT_LE(grain.diameterMeters, static_cast<float>(field.largestMeters(classLevel)));
        EXPECT_NEAR(grain.turn[0] * grain.turn[0] + grain.turn[1] * grain.turn[1] + grain.turn[2] * grain.turn[2] +
                        grain.turn[3] * grain.turn[3],
                    1, 1e-5);
        sum += std::numbers::pi / 4 * grain.diameterMeters * grain.diameterMeters;
      }
    }
    const double area = 4 * std::numbers::pi * kMoon * kMoon / faceCount(GetParam()) / std::ldexp(1.0, 2 * classLevel);
    return sum / (kTiles * area);
  };
  const double finer = meanCover(field.finestClass()), coarser = meanCover(field.finestClass() - 1);
  std::printf("cover %.4f, an octave up %.4f\n", finer, coarser);
  EXPECT_NEAR(finer, 0.02, 0.15 * 0.02);
  EXPECT_NEAR(coarser / finer, 0.75, 0.08);
}

INSTANTIATE_TEST_SUITE_P(Schemes, GrainFieldOfSchemes, test::bothSchemes(), test::nameOfScheme);

TEST(GrainField, WithoutCoverOrBetweenNoSizesThereIsNothing) {
  const GrainField bare({.cover = 0}, kMoon, Scheme::Cube);
  EXPECT_GT(bare.coarsestClass(), bare.finestClass());
  EXPECT_TRUE(collected(bare, FacePath::cubeTile(0, 20, 5, 5), 18).empty());
  const GrainField field({}, kMoon, Scheme::Cube);
  EXPECT_TRUE(collected(field, FacePath::cubeTile(0, 20, 5, 5), field.coarsestClass() - 1).empty());
}

}  // namespace
}  // namespace terrane
