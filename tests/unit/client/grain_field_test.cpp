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
#include "common/tiling/lattice.h"

namespace terrane {
namespace {

constexpr std::uint64_t kSeed = 20261126;
constexpr double kMoon = 1'737'400.0;

/// A third each at an edge, at a corner and inside of a face.
FacePath randomTile(std::mt19937_64& random, int level) {
  const auto last = static_cast<std::uint32_t>((std::uint64_t{1} << level) - 1);
  const int kind = static_cast<int>(random() % 3);
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

/// All but where in the tile it is.
bool sameGrain(const Grain& a, const Grain& b) {
  return a.classLevel == b.classLevel && a.column == b.column && a.row == b.row &&
         a.diameterMeters == b.diameterMeters && a.flattening == b.flattening && a.centerHeight == b.centerHeight &&
         a.shade == b.shade && a.variant == b.variant && std::ranges::equal(a.turn, b.turn);
}

glm::dvec3 positionOf(const FacePath& tile, const Grain& grain, double radiusMeters) {
  const double scale = std::ldexp(2.0, -tile.level()) / kGrainCells;
  return radiusMeters * cubeDirection(tile.face(), (tile.column() * 64.0 + grain.cells.x) * scale - 1,
                                      (tile.row() * 64.0 + grain.cells.y) * scale - 1);
}

TEST(GrainField, ATilesGrainsAreItsChildrensClassByClass) {
  std::mt19937_64 random(kSeed);
  std::printf("seed %llu\n", static_cast<unsigned long long>(kSeed));
  std::size_t compared = 0, empty = 0;
  for (int round = 0; round < 10'000; ++round) {
    // Small bodies have their grains at coarse levels: so all levels are tried.
    const int level = 8 + round % 19;
    const double radius = kMoon * std::ldexp(1.0, level - 24);
    const GrainField field({}, radius);
    const FacePath tile = randomTile(random, level);
    const int classes = std::min(field.finestClass(), level - 1) - field.coarsestClass() + 1;
    ASSERT_GT(classes, 0);
    const int classLevel = field.coarsestClass() + static_cast<int>(random() % static_cast<unsigned>(classes));
    std::vector<Grain> own = collected(field, tile, classLevel), childrens;
    for (int digit = 0; digit < 4; ++digit) {
      const glm::dvec2 half(digit & 1, digit >> 1);
      for (const Grain& grain : collected(field, tile.child(digit), classLevel)) {
        childrens.push_back(grain);
        childrens.back().cells = grain.cells / 2.0 + 32.0 * half;
      }
    }
    sortByCell(own);
    sortByCell(childrens);
    ASSERT_EQ(own.size(), childrens.size()) << tile.text() << " class " << classLevel;
    for (std::size_t i = 0; i < own.size(); ++i) {
      ASSERT_TRUE(sameGrain(own[i], childrens[i])) << tile.text() << " class " << classLevel;
      ASSERT_EQ(own[i].cells, childrens[i].cells) << "to the last bit";
    }
    compared += own.size();
    empty += own.empty() ? 1 : 0;
  }
  std::printf("%zu grains compared; %zu tiles without\n", compared, empty);
  EXPECT_GT(compared, 100'000u);
}

TEST(GrainField, NoTwoOfAClassShareTheGroundEvenOverFaceEdges) {
  std::mt19937_64 random(kSeed);
  const GrainField field({}, kMoon);
  std::size_t pairs = 0;
  double closest = 1e9;
  for (int round = 0; round < 300; ++round) {
    const int level = field.finestClass();
    const FacePath tile = randomTile(random, level);
    struct Placed {
      glm::dvec3 position;
      double radius;
    };
    const auto nearBorder = [&](const FacePath& of, std::vector<Placed>& placed) {
      for (const Grain& grain : collected(field, of, level))
        if (std::min(std::min(grain.cells.x, 64 - grain.cells.x), std::min(grain.cells.y, 64 - grain.cells.y)) < 1)
          placed.push_back({positionOf(of, grain, kMoon), grain.diameterMeters / 2.0});
    };
    std::vector<Placed> own, beside;
    nearBorder(tile, own);
    for (int side = 0; side < kSideCount; ++side)
      if (const auto neighbour = tile.neighbour(static_cast<Side>(side))) nearBorder(*neighbour, beside);
    for (const Placed& a : own)
      for (const Placed& b : beside) {
        const double apart = glm::length(a.position - b.position) / (a.radius + b.radius);
        closest = std::min(closest, apart);
        pairs += apart < 2 ? 1 : 0;
      }
  }
  std::printf("%zu pairs within two diameters over tile borders, the closest %.3f of touching\n", pairs, closest);
  EXPECT_GT(pairs, 1000u);
  // Cells are 1 / sqrt(2) of their nominal width where they are narrowest, in the middle of a face's edge.
  EXPECT_GT(closest, 0.7);
}

TEST(GrainField, IsTheSameOnEveryMachine) {
  const GrainField field({}, kMoon);
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&hash](std::uint64_t value) { hash = (hash ^ value) * 1099511628211ull; };
  std::size_t count = 0;
  for (int face = 0; face < 6; ++face) {
    for (int classLevel = field.coarsestClass(); classLevel <= field.finestClass(); ++classLevel) {
      const FacePath tile = FacePath::cubeTile(face, 22, 1'234'567u + 1000u * static_cast<unsigned>(face), 3'210'001u);
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
  EXPECT_EQ(hash, 0x3a2ab618d8d031ull);
}

TEST(GrainField, CoversWhatItIsToldAndKeepsItsSizes) {
  std::mt19937_64 random(kSeed);
  const DustSettings settings{.cover = 0.02, .smallestMeters = 0.0008, .largestMeters = 0.05};
  const GrainField field(settings, kMoon);
  const auto meanCover = [&](int classLevel) {
    double sum = 0;
    constexpr int kTiles = 400;
    for (int i = 0; i < kTiles; ++i) {
      const FacePath tile = FacePath::cubeTile(static_cast<int>(random() % 6), classLevel,
                                               static_cast<std::uint32_t>(random() & ((1u << classLevel) - 1)),
                                               static_cast<std::uint32_t>(random() & ((1u << classLevel) - 1)));
      for (const Grain& grain : collected(field, tile, classLevel)) {
        EXPECT_GE(grain.diameterMeters, 0.0008f);
        EXPECT_LE(grain.diameterMeters, 0.05f);
        EXPECT_LE(grain.diameterMeters, static_cast<float>(field.largestMeters(classLevel)));
        EXPECT_NEAR(grain.turn[0] * grain.turn[0] + grain.turn[1] * grain.turn[1] + grain.turn[2] * grain.turn[2] +
                        grain.turn[3] * grain.turn[3],
                    1, 1e-5);
        sum += std::numbers::pi / 4 * grain.diameterMeters * grain.diameterMeters;
      }
    }
    const double width = nominalTileWidthMeters(kMoon, classLevel);
    return sum / (kTiles * width * width);
  };
  const double finer = meanCover(field.finestClass()), coarser = meanCover(field.finestClass() - 1);
  std::printf("cover %.4f, an octave up %.4f\n", finer, coarser);
  EXPECT_NEAR(finer, 0.02, 0.15 * 0.02);
  EXPECT_NEAR(coarser / finer, 0.75, 0.08);
}

TEST(GrainField, WithoutCoverOrBetweenNoSizesThereIsNothing) {
  const GrainField bare({.cover = 0}, kMoon);
  EXPECT_GT(bare.coarsestClass(), bare.finestClass());
  EXPECT_TRUE(collected(bare, FacePath::cubeTile(0, 20, 5, 5), 18).empty());
  const GrainField field({}, kMoon);
  EXPECT_TRUE(collected(field, FacePath::cubeTile(0, 20, 5, 5), field.coarsestClass() - 1).empty());
}

}  // namespace
}  // namespace terrane
