// Tiles whose far field is expanded (far_field.h) beside the same in full: as near as they promise, the same to the bit
// where other tiles share a vertex, and on every SIMD path.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "common/tiling/tile_grid.h"
#include "server/build/grid_directions.h"
#include "server/build/level_accuracy.h"
#include "tests/unit/server/built_tiles.h"

namespace terrane {
namespace {

using namespace test;

constexpr unsigned kSeed = 71;
constexpr int kCells = 64;

class ExpandedTiles : public OfScheme {
 protected:
  ExpandedTiles()
      : field_(makeHeightField(builder().body(), bestSimdPath())),
        levels_(levelAccuracies(*field_, kMoon, GetParam(), kCells, maxLevel())) {}

  const LevelAccuracy& accuracy(int level) const { return levels_[static_cast<std::size_t>(level)]; }

  static double minWavelength(int level, int cells) {
    return 2 * nominalTileWidthMeters(kMoon, level, GetParam()) / cells;
  }

  void evaluate(const HeightField& field, const FacePath& path, double toleranceMeters, SurfaceSamples& out,
                int cells = kCells) {
    gridDirections(path, cells, directions_);
    const auto side = static_cast<std::size_t>(cells) + 1;
    SampleBatch batch{directions_.x.data(), directions_.y.data(), directions_.z.data(), directions_.x.size() / side,
                      side};
    batch.footprintMeters = 0.5 * minWavelength(path.level(), cells);
    batch.grid = GridPlace{path, cells};
    batch.toleranceMeters = toleranceMeters;
    field.evaluate(batch, minWavelength(path.level(), cells), out);
  }

  /// An edge as the level beside the tile's has it: step -1 or 1.
  void evaluateEdge(const FacePath& path, int cells, int step, double toleranceMeters, SurfaceSamples& out,
                    int skirtEdge = 1) {
    const int edgeCells = step < 0 ? cells / 2 : 2 * cells;
    GridDirections edge;
    appendEdgeDirections(path, skirtEdge, edgeCells, edge);
    SampleBatch batch{edge.x.data(), edge.y.data(), edge.z.data(), 1, edge.x.size()};
    batch.grid = GridPlace{path, edgeCells, skirtEdge};
    batch.toleranceMeters = toleranceMeters;
    field_->evaluate(batch, minWavelength(path.level() + step, cells), out);
  }

  std::vector<bool> onBorder() const {
    const TileGrid grid{GetParam(), kCells};
    std::vector<bool> border(static_cast<std::size_t>(grid.vertexCount()));
    for (GridVertex at; at.j <= kCells; ++at.j)
      for (at.i = 0; at.i <= grid.rowEnd(at.j); ++at.i)
        border[static_cast<std::size_t>(grid.index(at))] = grid.borders(at) != 0;
    return border;
  }

  std::unique_ptr<const HeightField> field_;
  std::vector<LevelAccuracy> levels_;
  GridDirections directions_;
};
INSTANTIATE_TEST_SUITE_P(Schemes, ExpandedTiles, bothSchemes(), nameOfScheme);

template <class T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b, std::size_t i) {
  return std::memcmp(&a[i], &b[i], sizeof(T)) == 0;
}
bool sameSample(const SurfaceSamples& a, const SurfaceSamples& b, std::size_t i) {
  return sameBits(a.heightMeters, b.heightMeters, i) && sameBits(a.gradientX, b.gradientX, i) &&
         sameBits(a.gradientY, b.gradientY, i) && sameBits(a.gradientZ, b.gradientZ, i) &&
         sameBits(a.reflectance, b.reflectance, i);
}
std::size_t samplesThatDiffer(const SurfaceSamples& a, const SurfaceSamples& b) {
  std::size_t differ = 0;
  for (std::size_t i = 0; i < a.heightMeters.size(); ++i) differ += sameSample(a, b, i) ? 0 : 1;
  return differ;
}

struct Worst {
  double height = 0, slope = 0, reflectance = 0;
  void add(const SurfaceSamples& a, const SurfaceSamples& b, std::size_t i) {
    height = std::max(height, std::abs(a.heightMeters[i] - b.heightMeters[i]));
    for (const auto& part : {&SurfaceSamples::gradientX, &SurfaceSamples::gradientY, &SurfaceSamples::gradientZ})
      slope = std::max(slope, static_cast<double>(std::abs((a.*part)[i] - (b.*part)[i])));
    reflectance = std::max(reflectance, static_cast<double>(std::abs(a.reflectance[i] - b.reflectance[i])));
  }
};

TEST_P(ExpandedTiles, AreWithinTheirToleranceInsideAndTheSameOnTheBorder) {
  std::mt19937_64 random(kSeed);
  RecordProperty("seed", kSeed);
  const std::vector<bool> border = onBorder();
  SurfaceSamples whole, expanded;
  int expandedTiles = 0;
  double worstShare = 0, worstSlope = 0, worstReflectance = 0;
  for (int round = 0; round < 3 * (maxLevel() + 1); ++round) {
    const FacePath path = randomTile(random, round % (maxLevel() + 1));
    const double tolerance = accuracy(path.level()).toleranceMeters;
    evaluate(*field_, path, 0, whole);
    evaluate(*field_, path, tolerance, expanded);
    Worst worst;
    for (std::size_t i = 0; i < border.size(); ++i) {
      ASSERT_TRUE(!border[i] || sameSample(whole, expanded, i)) << path.text() << " vertex " << i;
      worst.add(whole, expanded, i);
    }
    EXPECT_LE(worst.height, tolerance + field_->roundingMeters(accuracy(path.level()).minWavelengthMeters))
        << path.text();
    EXPECT_LE(worst.slope, 3e-4) << path.text();
    EXPECT_LE(worst.reflectance, 0.25 * kColorScale / 255) << path.text();
    worstShare = std::max(worstShare, worst.height / tolerance);
    worstSlope = std::max(worstSlope, worst.slope);
    worstReflectance = std::max(worstReflectance, worst.reflectance);
    expandedTiles += worst.height > 0 ? 1 : 0;
  }
  std::printf("%d tiles expanded; worst: %.3f of the tolerance, slope %.1e, reflectance %.1e\n", expandedTiles,
              worstShare, worstSlope, worstReflectance);
  EXPECT_GT(expandedTiles, 2 * maxLevel()) << "or nothing was shown";
}

TEST_P(ExpandedTiles, HaveTheSameBitsOnEverySimdPath) {
  std::mt19937_64 random(kSeed + 1);
  SurfaceSamples expected, got;
  for (const SimdPath path : {SimdPath::Default, SimdPath::V3, SimdPath::V4}) {
    if (!simdPathSupported(path)) continue;
    const auto other = makeHeightField(builder().body(), path);
    for (int level = 6; level <= maxLevel(); level += 3) {
      const FacePath tile = randomTile(random, level);
      evaluate(*field_, tile, accuracy(level).toleranceMeters, expected);
      evaluate(*other, tile, accuracy(level).toleranceMeters, got);
      EXPECT_EQ(samplesThatDiffer(expected, got), 0u) << tile.text();
    }
  }
}

TEST_P(ExpandedTiles, AreEvaluatedInFullWhereTheToleranceIsTooSmall) {
  std::mt19937_64 random(kSeed + 2);
  SurfaceSamples whole, expanded;
  for (int level = 6; level <= maxLevel(); level += 3) {
    const FacePath path = randomTile(random, level);
    evaluate(*field_, path, 0, whole);
    evaluate(*field_, path, 1e-9, expanded);
    EXPECT_EQ(samplesThatDiffer(whole, expanded), 0u) << path.text();
  }
}

/// Of few cells too, where a crater as large as the tile is only just shown.
TEST_P(ExpandedTiles, LendTheirExpansionToTheirOwnEdgesOnly) {
  std::mt19937_64 random(kSeed + 3);
  SurfaceSamples grid, edge, fullEdge, otherEdge, fullOtherEdge;
  int lent = 0;
  for (int round = 0; round < 300; ++round) {
    const int level = 6 + round % (maxLevel() - 6), cells = 2 << round % 7, step = round % 2 == 0 ? 1 : -1;
    const FacePath path = randomTile(random, level), other = randomTile(random, level);
    const double tolerance = accuracy(level).toleranceMeters;
    const double rounding = field_->roundingMeters(minWavelength(level + step, cells));
    evaluate(*field_, path, tolerance, grid, cells);
    edge.scratch = otherEdge.scratch = grid.scratch;
    evaluateEdge(path, cells, step, tolerance, edge);
    evaluateEdge(other, cells, step, tolerance, otherEdge);
    evaluateEdge(path, cells, step, 0, fullEdge);
    evaluateEdge(other, cells, step, 0, fullOtherEdge);
    bool differs = false;
    for (std::size_t i = 0; i < edge.heightMeters.size(); ++i) {
      EXPECT_LE(std::abs(edge.heightMeters[i] - fullEdge.heightMeters[i]), tolerance + rounding)
          << path.text() << " cells " << cells << " step " << step;
      ASSERT_TRUE(sameBits(otherEdge.heightMeters, fullOtherEdge.heightMeters, i)) << other.text();
      differs = differs || !sameBits(edge.heightMeters, fullEdge.heightMeters, i);
    }
    lent += differs ? 1 : 0;
  }
  EXPECT_GT(lent, 100);
}

/// Between two landmarks of different sizes, which the levels compute in different precisions.
TEST_P(ExpandedTiles, LendTheirEdgesNoCraterTwice) {
  const FacePath middle = FacePath::parse(GetParam() == Scheme::Cube ? "cube/2/000331122" : "ico/4/32312300").value();
  SurfaceSamples grid, edge, fullEdge;
  for (int digits = 0; digits < 16; ++digits) {
    const FacePath path = digits == 0 ? middle : middle.parent().parent().child(digits / 4).child(digits % 4);
    const double tolerance = accuracy(path.level()).toleranceMeters;
    for (const int step : {-1, 1}) {
      evaluate(*field_, path, tolerance, grid);
      edge.scratch = grid.scratch;
      for (int skirtEdge = 0; skirtEdge < 3; ++skirtEdge) {
        evaluateEdge(path, kCells, step, tolerance, edge, skirtEdge);
        fullEdge.scratch = nullptr;
        evaluateEdge(path, kCells, step, 0, fullEdge, skirtEdge);
        for (std::size_t i = 0; i < edge.heightMeters.size(); ++i)
          ASSERT_LE(std::abs(edge.heightMeters[i] - fullEdge.heightMeters[i]),
                    tolerance + field_->roundingMeters(minWavelength(path.level() + step, kCells)))
              << path.text() << " edge " << skirtEdge << " step " << step;
      }
    }
  }
}

TEST_P(ExpandedTiles, AreForgottenWhereOtherBatchesCameBetweenThemAndTheirEdges) {
  std::mt19937_64 random(kSeed + 4);
  SurfaceSamples grid, between, edge, fullEdge;
  for (int round = 0; round < 60; ++round) {
    const int level = 6 + round % (maxLevel() - 6);
    const FacePath path = randomTile(random, level), other = randomTile(random, level);
    const double tolerance = accuracy(level).toleranceMeters;
    evaluate(*field_, path, tolerance, grid);
    between.scratch = edge.scratch = grid.scratch;
    // Finer, so that more is gathered near the same tile; or elsewhere, so that all is.
    SampleBatch batch{directions_.x.data(), directions_.y.data(), directions_.z.data(), 1, 30};
    if (round % 2 == 0) {
      field_->evaluate(batch, minWavelength(level, kCells) / 16, between);
    } else {
      evaluate(*field_, other, 0, between);
    }
    evaluateEdge(path, kCells, 1, tolerance, edge);
    evaluateEdge(path, kCells, 1, 0, fullEdge);
    for (std::size_t i = 0; i < edge.heightMeters.size(); ++i)
      EXPECT_LE(std::abs(edge.heightMeters[i] - fullEdge.heightMeters[i]),
                tolerance + field_->roundingMeters(minWavelength(level + 1, kCells)))
          << path.text();
  }
}

}  // namespace
}  // namespace terrane
