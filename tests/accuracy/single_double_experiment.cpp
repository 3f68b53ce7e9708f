// The loops of a tile build in float and in double: what double costs on the CPU, and what float would lose. The same
// templates in both types, on the oldest x86-64 and on the best that this CPU has; the double ones are checked against
// the product's own functions, bit for bit.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/tile_build/tile_product.h"
#include "tests/accuracy/tile_build/tile_truth.h"
#include "tests/accuracy/tile_build/tile_ways.h"

namespace terrane::accuracy {
namespace {

constexpr double kMoonMeters = 1'737'400.0, kEarthMeters = 6'371'000.0;
constexpr std::array<int, 5> kLevels{0, 6, 12, 18, 24};

constexpr std::array<const char*, kLoops> kLoopNames{"directions",
                                                     "noise, positions too",
                                                     "noise, in cells (Terrane)",
                                                     "rounding to the lattice",
                                                     "normals from gradients",
                                                     "normals from neighbours"};

/// Directions and rounding to the lattice.
std::vector<Work> productLoopWorks(const Tile& tile) {
  const auto directions = std::make_shared<GridDirections>(), again = std::make_shared<GridDirections>();
  gridDirections(tile.place.path, kCells, *directions);
  return {repeated(kVertices,
                   [&tile, again] {
                     gridDirections(tile.place.path, kCells, *again);
                     return again->x.back();
                   }),
          repeated(kVertices, [&tile, directions] {
            const auto lattice = productLattice(tile.place, *directions, tile.inDouble.ground.heightMeters);
            return static_cast<double>(lattice.back());
          })};
}

/// Times on the default path, on the best, and of the product's functions (0: it has none of its own).
struct AllTimesNs {
  TimesNs oldest, best;
  std::array<double, kLoops> product{};
};

AllTimesNs timesOf(const Tile& tile, int rounds) {
  const TileLoops &oldest = loopsOf(SimdPath::Default), &newest = loopsOf(bestSimdPath());
  std::vector<Work> loops = loopWorks(tile, oldest);
  std::ranges::move(loopWorks(tile, newest), std::back_inserter(loops));
  std::ranges::move(productLoopWorks(tile), std::back_inserter(loops));
  const std::vector<double> loopNs = nanosecondsPerItem(loops, kVertices, rounds);

  const auto kernel = std::make_shared<ProductNoise>(tile.place, bestSimdPath(), tile.inDouble.blocks);
  std::vector<double> noiseNs(2 * kNoiseWorks + 1);
  for (std::size_t line = 0; line < kBlocksPerLine; ++line) {
    std::vector<Work> noise = noiseWorks(tile, oldest, line);
    std::ranges::move(noiseWorks(tile, newest, line), std::back_inserter(noise));
    noise.push_back(repeated(kLineVertices, [kernel, line] { return kernel->lastHeightMeters(line); }));
    const std::vector<double> ns = nanosecondsPerItem(noise, kLineVertices, rounds);
    for (std::size_t k = 0; k < ns.size(); ++k) noiseNs[k] += ns[k] / kBlocksPerLine;
  }
  AllTimesNs all{timesFrom(loopNs.data(), noiseNs.data()),
                 timesFrom(loopNs.data() + kLoopWorks, noiseNs.data() + kNoiseWorks)};
  all.product[kDirections] = loopNs[2 * kLoopWorks];
  all.product[kLattice] = loopNs[2 * kLoopWorks + 1];
  all.product[kNoiseInCells] = noiseNs[2 * kNoiseWorks];
  return all;
}

/// Between the loops in double and the product's functions.
std::size_t verticesThatDiffer(const Tile& tile, SimdPath path) {
  GridDirections directions;
  gridDirections(tile.place.path, kCells, directions);
  const auto lattice = productLattice(tile.place, directions, tile.inDouble.ground.heightMeters);
  const auto heights = ProductNoise(tile.place, path, tile.inDouble.blocks).heightMeters();
  const auto slots = vertexOfSlot();
  std::vector<bool> differs(kVertices);
  for (std::size_t slot = 0; slot < kSlots; ++slot)
    if (heights[slot] != tile.inCells.ground.heightMeters[slots[slot]]) differs[slots[slot]] = true;
  const Columns<double>& own = tile.inDouble.directions;
  for (std::size_t v = 0; v < kVertices; ++v) {
    if (directions.x[v] != own.x[v] || directions.y[v] != own.y[v] || directions.z[v] != own.z[v] ||
        !std::equal(&lattice[3 * v], &lattice[3 * v] + 3, &tile.inDouble.lattice[3 * v]))
      differs[v] = true;
  }
  return static_cast<std::size_t>(std::ranges::count(differs, true));
}

/// Of a whole tile in float, at every level of a body.
std::vector<double> errorsInFloat(const Settings& settings, double radiusMeters, Progress& progress, double begin,
                                  double end) {
  std::vector<double> meters;
  for (int level = 0; level <= kLevels.back(); ++level) {
    const Tile tile(placeAt(radiusMeters, level, settings.seed), loopsOf(SimdPath::Default));
    const Truth truth(tile.place, settings.quick ? 16 : 4);
    meters.push_back(truth.latticeErrorMeters(tile.inFloat.fineLattice, nullptr));
    progress.at(begin + (end - begin) * level / kLevels.back());
  }
  return meters;
}

/// The level from which on the errors stay above what `limit` says of a level; empty if they do not.
template <class Limit>
std::optional<int> alwaysAboveFrom(const std::vector<double>& errorByLevel, Limit limit) {
  std::optional<int> from;
  for (int level = static_cast<int>(errorByLevel.size()) - 1; level >= 0; --level) {
    if (errorByLevel[static_cast<std::size_t>(level)] <= limit(level)) break;
    from = level;
  }
  return from;
}

/// A row of the table: one loop, or all of them, at one level.
struct Line {
  std::string loop;
  double errorFloatMeters, errorDoubleMeters;
  double timeFloatNs, timeDoubleNs, timeBestFloatNs, timeBestDoubleNs;
  Value timeProductNs = std::string("none of its own");
};

void addLine(const Place& place, const Line& line, Report& report) {
  report.rows.push_back({line.loop, std::int64_t{place.path.level()}, line.errorFloatMeters, line.errorDoubleMeters,
                         line.errorFloatMeters / stepMeters(place.stepExponent),
                         line.errorFloatMeters / place.cellMeters, line.timeFloatNs, line.timeDoubleNs,
                         line.timeDoubleNs / line.timeFloatNs, line.timeBestFloatNs, line.timeBestDoubleNs,
                         line.timeBestDoubleNs / line.timeBestFloatNs, line.timeProductNs});
}

/// What the findings are made of.
struct Seen {
  TimesNs defaultNs, bestNs;
  std::size_t levels = 0;
  std::size_t differing = 0;
  double worstInCellsMeters = 0, inCellsSteps = 0, worstDoubleMeters = 0;
  double floatTilt = 0, doubleTilt = 0;         ///< of normals from neighbours at the finest level, radians
  std::vector<double> moonMeters, earthMeters;  ///< error in float by level
};

void addLevel(const Settings& settings, double radiusMeters, int level, Report& report, Seen& seen) {
  const SimdPath best = bestSimdPath();
  const TileLoops &oldest = loopsOf(SimdPath::Default), &newest = loopsOf(best);
  const Tile tile(placeAt(radiusMeters, level, settings.seed), oldest);
  const Tile again(tile.place, newest);
  seen.differing += verticesThatDiffer(tile, best) + verticesThatDiffer(again, best);
  const AllTimesNs times = timesOf(tile, settings.quick ? 5 : 61);
  const TimesNs &a = times.oldest, &b = times.best;
  const ErrorsMeters e = errorsOf(tile, oldest, settings.quick ? 8 : 1);

  if (radiusMeters == kMoonMeters) {
    for (std::size_t k = 0; k < kLoops; ++k) {
      Line line{kLoopNames[k], e.inFloat[k], e.inDouble[k], a.inFloat[k], a.inDouble[k], b.inFloat[k], b.inDouble[k]};
      if (times.product[k] > 0) line.timeProductNs = times.product[k];
      addLine(tile.place, line, report);
    }
    addLine(tile.place,
            {"tile, cells float (Terrane)", e.wholeInCells, e.wholeDouble, a.wholeInCells(), a.wholeDouble(),
             b.wholeInCells(), b.wholeDouble()},
            report);
    seen.defaultNs = a;
    seen.bestNs = b;
    seen.worstInCellsMeters = std::max(seen.worstInCellsMeters, e.wholeInCells);
    seen.inCellsSteps = std::max(seen.inCellsSteps, e.wholeInCells / stepMeters(tile.place.stepExponent));
    seen.floatTilt = e.inFloat[kNeighbourNormals] / tile.place.cellMeters;
    seen.doubleTilt = e.inDouble[kNeighbourNormals] / tile.place.cellMeters;
    seen.worstDoubleMeters = std::max(seen.worstDoubleMeters, e.wholeDouble);
  }
  addLine(tile.place,
          {radiusMeters == kMoonMeters ? "tile, all float" : "tile, all float, Earth-sized", e.wholeFloat,
           e.wholeDouble, a.wholeFloat(), a.wholeDouble(), b.wholeFloat(), b.wholeDouble()},
          report);
}

std::string fromLevel(std::optional<int> level) {
  return level ? fmt::format("from level {} on", *level) : std::string("at no level");
}

std::string whereFloatFails(const char* body, double radiusMeters, const std::vector<double>& meters) {
  const auto step = alwaysAboveFrom(meters, [&](int level) { return stepMeters(stepExponent(radiusMeters, level)); });
  const auto cell =
      alwaysAboveFrom(meters, [&](int level) { return nominalTileWidthMeters(radiusMeters, level) / kCells; });
  const auto [least, most] = std::ranges::minmax(meters);
  return fmt::format("{} by {:.2g} to {:.2g} m, more than a lattice step {} and than the distance of two vertices {}",
                     body, least, most, fromLevel(step), fromLevel(cell));
}

std::string dearer(double with, double without) { return fmt::format("{:+.0f} %", 100 * (with / without - 1)); }

std::vector<std::string> findingsFrom(const Seen& seen) {
  const TimesNs &a = seen.defaultNs, &b = seen.bestNs;
  const char* best = nameOf(bestSimdPath());
  std::vector<std::string> findings;
  findings.push_back(fmt::format("A tile built in float would have vertices out of place, whatever its level: {}; {}.",
                                 whereFloatFails("on the Moon", kMoonMeters, seen.moonMeters),
                                 whereFloatFails("on an Earth-sized body", kEarthMeters, seen.earthMeters)));
  findings.push_back(fmt::format(
      "Double in place of float, all loops of a vertex of level {}: {} time on any x86-64 ({:.0f} against {:.0f} ns), "
      "{} with {} ({:.0f} against {:.0f} ns). The loops other than noise: {} and {}.",
      kLevels.back(), dearer(a.wholeDouble(), a.wholeFloat()), a.wholeDouble(), a.wholeFloat(),
      dearer(b.wholeDouble(), b.wholeFloat()), best, b.wholeDouble(), b.wholeFloat(),
      dearer(a.wholeDouble() - a.inDouble[kNoise], a.wholeFloat() - a.inFloat[kNoise]),
      dearer(b.wholeDouble() - b.inDouble[kNoise], b.wholeFloat() - b.inFloat[kNoise])));
  findings.push_back(fmt::format(
      "Terrane has float only within the cells of noise of short waves, below {:.0f} times a level's shortest. That "
      "loses "
      "at most {:.2g} m and {:.2g} lattice steps (all double: {:.2g} m), and takes {} time against all float on any "
      "x86-64, {} with {}; all double would take {} and {}.",
      lunar::kDoubleWavelengths, seen.worstInCellsMeters, seen.inCellsSteps, seen.worstDoubleMeters,
      dearer(a.wholeInCells(), a.wholeFloat()), dearer(b.wholeInCells(), b.wholeFloat()), best,
      dearer(a.wholeDouble(), a.wholeFloat()), dearer(b.wholeDouble(), b.wholeFloat())));
  findings.push_back(fmt::format(
      "Normals from gradients need no double. From the places of neighbours in float they are off by up to {:.2g} "
      "radians at level {} (2: they may point anywhere), in double by {:.1g}.",
      seen.floatTilt, kLevels.back(), seen.doubleTilt));
  findings.push_back(
      fmt::format("Checked against the product: in double, on any x86-64 and with {}, {} vertices differ in a bit from "
                  "gridDirections, the noise kernel, roundToLattice and a whole tile of the server's Moon.",
                  best, seen.differing));
  return findings;
}

Report run(const Settings& settings, Progress& progress) {
  const char* best = nameOf(bestSimdPath());
  Report report;
  report.columns = {{"loop", "loop (on the Moon unless said)"},
                    {"level", "level"},
                    {"errorFloatMeters", "worst error in float, m"},
                    {"errorDoubleMeters", "worst error in double, m"},
                    {"errorFloatSteps", "in float, lattice steps"},
                    {"errorFloatCells", "in float, vertex distances"},
                    {"timeFloatNs", "time in float, ns a vertex, any x86-64"},
                    {"timeDoubleNs", "time in double, ns"},
                    {"timeRatio", "time, double / float"},
                    {"timeBestFloatNs", fmt::format("time in float, ns a vertex, {}", best)},
                    {"timeBestDoubleNs", fmt::format("time in double, ns, {}", best)},
                    {"timeBestRatio", fmt::format("time, double / float, {}", best)},
                    {"timeProductNs", "time of the product's function, ns a vertex"}};
  Seen seen;
  seen.differing = builtVerticesThatDiffer(loopsOf(SimdPath::Default).inDouble, kLevels.back());
  for (std::size_t k = 0; k < kLevels.size(); ++k) {
    addLevel(settings, kMoonMeters, kLevels[k], report, seen);
    progress.at(0.1 + 0.29 * static_cast<double>(k + 1) / kLevels.size());
  }
  for (std::size_t k = 0; k < kLevels.size(); k += 2) {
    addLevel(settings, kEarthMeters, kLevels[k], report, seen);
    progress.at(0.4 + 0.19 * static_cast<double>(k + 1) / kLevels.size());
  }
  seen.moonMeters = errorsInFloat(settings, kMoonMeters, progress, 0.6, 0.79);
  seen.earthMeters = errorsInFloat(settings, kEarthMeters, progress, 0.8, 1.0);
  report.plots = {{"What float loses, loop by loop", "level", "errorFloatMeters", "loop", false, true},
                  {"What double loses", "level", "errorDoubleMeters", "loop", false, true},
                  {"What double costs", "level", "timeBestRatio", "loop", false, false}};
  report.findings = findingsFrom(seen);
  return report;
}

const Registration kRegistered({55, "single-double", "Single against double on the CPU",
                                "What does double cost in the loops of a tile build, and what would float lose?", run});

}  // namespace
}  // namespace terrane::accuracy
