// The lunar field's expansion of what varies slowly over a tile: what it saves and what it loses by the tolerance, at
// levels from coarse to fine and by both schemes, beside the field evaluated in full at every vertex.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <random>

#include "common/tiling/lattice.h"
#include "proto/tile_mesh.h"
#include "server/build/grid_directions.h"
#include "server/build/level_accuracy.h"
#include "server/fields/height_field.h"
#include "server/fields/lunar_program.h"
#include "server/fields/sample_blocks.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/support/moon_body.h"

namespace terrane::accuracy {
namespace {

constexpr std::array<int, 6> kLevels{4, 8, 12, 16, 20, 24};
constexpr int kCells = 64;
constexpr std::size_t kSide = kCells + 1;

/// In lattice steps. The first is the field in full, with which the others are compared.
constexpr std::array<double, 5> kTolerances{0, 1.0 / 512, kToleranceSteps, 1.0 / 8, 1};
constexpr std::size_t kFull = 0, kTight = 1, kTiles = 2, kLoose = 4;

/// Of which the findings tell times.
constexpr int kShownLevel = 20;

struct Ground {
  const HeightField& field;
  Scheme scheme;
  int level;
  double minWavelengthMeters, stepMeters;
};

/// One tile's grid.
class Grid {
 public:
  Grid(const Ground& ground, const FacePath& path) : ground_(ground), path_(path) {
    gridDirections(path, kCells, directions_);
  }
  std::size_t count() const { return directions_.x.size(); }
  void evaluate(double toleranceSteps, SurfaceSamples& out) const {
    ground_.field.evaluate(
        {directions_.x.data(), directions_.y.data(), directions_.z.data(), count() / kSide, kSide,
         0.5 * ground_.minWavelengthMeters, GridPlace{path_, kCells}, toleranceSteps * ground_.stepMeters},
        ground_.minWavelengthMeters, out);
  }

 private:
  Ground ground_;
  FacePath path_;
  GridDirections directions_;
};

/// Neighbours in the list lie on different faces.
std::vector<Grid> randomGrids(const Ground& ground, std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed + static_cast<std::uint64_t>(ground.level));
  const std::uint64_t digits = (std::uint64_t{1} << (2 * ground.level)) - 1;
  std::vector<Grid> grids;
  for (std::size_t i = 0; i < count; ++i) {
    const int face = static_cast<int>(i) % faceCount(ground.scheme);
    grids.emplace_back(ground, FacePath::fromPackedDigits(ground.scheme, face, ground.level, random() & digits));
  }
  return grids;
}

/// Between the field expanded and in full.
struct Differences {
  double worstMeters = 0, squareSum = 0, worstSlope = 0, worstReflectance = 0;
  std::size_t count = 0;
  std::size_t beyondTolerance = 0;  ///< heights
  std::size_t beyondBound = 0;      ///< heights: further than the tolerance and float32's roundings together
  std::size_t onBorder = 0;         ///< vertices of borders that differ in a bit of anything
  double rmsMeters() const { return std::sqrt(squareSum / static_cast<double>(count)); }
};

/// Whether a vertex is on its tile's border, by grid index.
std::vector<bool> borderOf(Scheme scheme, std::size_t count) {
  std::vector<bool> isBorder(count);
  const lunar::SampleBlocks parts(count / kSide, kSide, TileGrid{scheme, kCells});
  for (std::size_t k = parts.insideCount(); k < parts.count(); ++k)
    for (const std::uint32_t sample : parts[k]) isBorder[sample] = true;
  return isBorder;
}

void addDifferences(const SurfaceSamples& full, const SurfaceSamples& expanded, const std::vector<bool>& isBorder,
                    double toleranceMeters, double roundingMeters, Differences& out) {
  for (std::size_t i = 0; i < full.heightMeters.size(); ++i) {
    const double height = std::fabs(expanded.heightMeters[i] - full.heightMeters[i]);
    const double slope =
        std::hypot(static_cast<double>(expanded.gradientX[i]) - static_cast<double>(full.gradientX[i]),
                   static_cast<double>(expanded.gradientY[i]) - static_cast<double>(full.gradientY[i]),
                   static_cast<double>(expanded.gradientZ[i]) - static_cast<double>(full.gradientZ[i]));
    const double reflectance =
        std::fabs(static_cast<double>(expanded.reflectance[i]) - static_cast<double>(full.reflectance[i]));
    out.worstMeters = std::max(out.worstMeters, height);
    out.squareSum += height * height;
    out.worstSlope = std::max(out.worstSlope, slope);
    out.worstReflectance = std::max(out.worstReflectance, reflectance);
    out.beyondTolerance += height > toleranceMeters ? 1 : 0;
    // Not "greater than": what is no number is beyond too.
    out.beyondBound += height <= toleranceMeters + roundingMeters ? 0 : 1;
    out.onBorder += isBorder[i] && !(height == 0 && slope == 0 && reflectance == 0) ? 1 : 0;
  }
  out.count += full.heightMeters.size();
}

std::array<Differences, kTolerances.size()> differencesOf(const Ground& ground, const std::vector<Grid>& grids) {
  std::array<Differences, kTolerances.size()> all;
  const std::vector<bool> isBorder = borderOf(ground.scheme, grids.front().count());
  const double rounding = lunar::singleRounding(ground.minWavelengthMeters);
  SurfaceSamples full, expanded;
  for (const Grid& grid : grids) {
    grid.evaluate(0, full);
    for (std::size_t t = 0; t < kTolerances.size(); ++t) {
      grid.evaluate(kTolerances[t], expanded);
      addDifferences(full, expanded, isBorder, kTolerances[t] * ground.stepMeters, rounding, all[t]);
    }
  }
  return all;
}

/// Two tiles in turn: of one alone, features would be gathered for the first evaluation only. Means over such pairs of
/// the medians.
std::array<double, kTolerances.size()> timesNs(const std::vector<Grid>& grids, int rounds) {
  std::array<double, kTolerances.size()> ns{};
  for (std::size_t k = 0; k + 1 < grids.size(); k += 2) {
    const Grid &one = grids[k], &other = grids[k + 1];
    std::vector<Work> ways;
    for (const double tolerance : kTolerances) {
      ways.push_back([&one, &other, tolerance, samples = std::make_shared<SurfaceSamples>()](std::size_t) {
        one.evaluate(tolerance, *samples);
        const double height = samples->heightMeters.back();
        other.evaluate(tolerance, *samples);
        return height + samples->heightMeters.back();
      });
    }
    const std::vector<double> medians = nanosecondsPerItem(ways, one.count() + other.count(), rounds);
    for (std::size_t t = 0; t < medians.size(); ++t) ns[t] += medians[t] / static_cast<double>(grids.size() / 2);
  }
  return ns;
}

std::string inSteps(double tolerance) {
  return tolerance > 0 && tolerance < 1 ? fmt::format("1/{:.0f}", 1 / tolerance) : fmt::format("{:.0f}", tolerance);
}

std::string nameOf(Scheme scheme, std::size_t tolerance) {
  return fmt::format("{}, {}{}", schemeName(scheme), inSteps(kTolerances[tolerance]),
                     tolerance == kFull    ? " (in full)"
                     : tolerance == kTiles ? " (Terrane)"
                                           : "");
}

/// What the findings are made of. Times by scheme.
struct Seen {
  std::array<std::array<double, kTolerances.size()>, 2> ns{};                 ///< at kShownLevel
  double worstSteps = 0, rmsSteps = 0, worstSlope = 0, worstReflectance = 0;  ///< as tiles are made, at any level
  std::size_t heights = 0, beyondTolerance = 0, beyondBound = 0, onBorder = 0;
  double shareOfTolerance = 0;  ///< the worst
};

void addRow(const Ground& ground, std::size_t t, const Differences& d, const std::array<double, kTolerances.size()>& ns,
            Report& report, Seen& seen) {
  const double step = ground.stepMeters, reflectanceSteps = d.worstReflectance * 255 / static_cast<double>(kColorScale);
  report.rows.push_back({nameOf(ground.scheme, t), std::int64_t{ground.level}, kTolerances[t], d.worstMeters / step,
                         d.rmsMeters() / step, d.worstMeters, d.rmsMeters(), d.worstSlope, reflectanceSteps,
                         lunar::singleRounding(ground.minWavelengthMeters) / step,
                         static_cast<std::int64_t>(d.beyondBound), ns[t], ns[kFull], ns[t] / ns[kFull]});
  if (t == kFull) return;
  seen.heights += d.count;
  seen.beyondTolerance += d.beyondTolerance;
  seen.beyondBound += d.beyondBound;
  seen.onBorder += d.onBorder;
  seen.shareOfTolerance = std::max(seen.shareOfTolerance, d.worstMeters / (kTolerances[t] * step));
  if (t != kTiles) return;
  seen.worstSteps = std::max(seen.worstSteps, d.worstMeters / step);
  seen.rmsSteps = std::max(seen.rmsSteps, d.rmsMeters() / step);
  seen.worstSlope = std::max(seen.worstSlope, d.worstSlope);
  seen.worstReflectance = std::max(seen.worstReflectance, reflectanceSteps);
}

std::vector<std::string> findingsFrom(const Seen& seen) {
  const auto &cube = seen.ns[static_cast<std::size_t>(Scheme::Cube)],
             &ico = seen.ns[static_cast<std::size_t>(Scheme::Ico)];
  return {
      fmt::format("At the tolerance that tiles are made with, {} lattice step, the field takes {:.2f} of the time at "
                  "level {} ({:.0f} against {:.0f} ns a vertex of the cube; of the icosahedron {:.2f}). At any of the "
                  "levels heights are off by at most {:.2g} steps (root mean square {:.1g}), slopes by {:.1g} radians "
                  "and brightness by {:.2g} of the 255 steps of a colour.",
                  inSteps(kToleranceSteps), cube[kTiles] / cube[kFull], kShownLevel, cube[kTiles], cube[kFull],
                  ico[kTiles] / ico[kFull], seen.worstSteps, seen.rmsSteps, seen.worstSlope, seen.worstReflectance),
      fmt::format("A tolerance of {} would take {:.2f} of the time there, one of {} step {:.2f}.",
                  inSteps(kTolerances[kTight]), cube[kTight] / cube[kFull], inSteps(kTolerances[kLoose]),
                  cube[kLoose] / cube[kFull]),
      fmt::format(
          "{}: of {} heights {} are further off than their tolerance and what float32 rounds, {} than the "
          "tolerance alone (the worst is off by {:.2g} of it), and {} vertices of borders, which tiles share, differ "
          "in a bit.",
          seen.beyondBound + seen.onBorder == 0 ? "The bound holds" : "THE BOUND IS BROKEN", seen.heights,
          seen.beyondBound, seen.beyondTolerance, seen.shareOfTolerance, seen.onBorder)};
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"way", "scheme, tolerance in lattice steps"},
                    {"level", "level"},
                    {"toleranceSteps", "tolerance, lattice steps"},
                    {"heightSteps", "worst height difference, lattice steps"},
                    {"heightRmsSteps", "rms, lattice steps"},
                    {"heightMeters", "worst height difference, m"},
                    {"heightRmsMeters", "rms, m"},
                    {"slopeRadians", "worst gradient difference, radians"},
                    {"reflectanceSteps", "worst reflectance difference, 1/255"},
                    {"roundingSteps", "float32 may round, lattice steps"},
                    {"heightsBeyond", "heights further off than both"},
                    {"timeNs", "time, ns a vertex"},
                    {"timeFullNs", "time in full, ns a vertex"},
                    {"timeRatio", "time / in full"}};
  const Body body = testMoon();
  const auto field = makeHeightField(body, bestSimdPath());
  Seen seen;
  std::size_t done = 0;
  for (const Scheme scheme : {Scheme::Cube, Scheme::Ico}) {
    const auto levels = levelAccuracies(*field, body.radiusMeters, scheme, kCells, kLevels.back());
    for (const int level : kLevels) {
      const Ground ground{*field, scheme, level, levels[static_cast<std::size_t>(level)].minWavelengthMeters,
                          stepMeters(stepExponent(body.radiusMeters, level, scheme))};
      const std::vector<Grid> grids = randomGrids(ground, settings.quick ? 4 : 24, settings.seed);
      const auto differences = differencesOf(ground, grids);
      const auto ns = timesNs(grids, settings.quick ? 5 : 15);
      for (std::size_t t = 0; t < kTolerances.size(); ++t) addRow(ground, t, differences[t], ns, report, seen);
      if (level == kShownLevel) seen.ns[static_cast<std::size_t>(scheme)] = ns;
      progress.at(static_cast<double>(++done) / (2 * kLevels.size()));
    }
  }
  report.plots = {{"What the tolerance saves", "level", "timeRatio", "way", false, false},
                  {"What it loses in height", "level", "heightSteps", "way", false, true},
                  {"What it loses in slope", "level", "slopeRadians", "way", false, true}};
  report.findings = findingsFrom(seen);
  return report;
}

const Registration kRegistered({74, "far-field", "What varies slowly over a tile, as polynomials",
                                "What does a tolerance of heights save when a tile's ground is made, and what is lost?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
