// Welding: from triangles with corners of their own to vertices that are shared, by exact keys and by sorting a
// floating-point hash.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <utility>

#include "common/tiling/ico_sphere.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/welding/vertex_normals.h"
#include "tests/accuracy/welding/weld_counts.h"

namespace terrane::accuracy {
namespace {

constexpr std::array<const char*, 2> kTypes{"float", "double"}, kCopies{"alike", "a rounding apart"};

struct Input {
  std::string name;
  Soup soup;
  bool sphere;
};

std::vector<Input> inputsOf(const Settings& settings) {
  std::vector<Input> inputs;
  const int tileCells = settings.quick ? 32 : 64;
  for (const int level : settings.quick ? std::vector{3, 5} : std::vector{4, 6, 8})
    inputs.push_back({fmt::format("sphere, level {}", level), wholeSphere(level), true});
  for (const int level : settings.quick ? std::vector{12} : std::vector{12, 28}) {
    const std::array<std::pair<const char*, glm::dvec3>, 2> places{
        {{"a vertex", icosahedronVertex(0)}, {"a pole", glm::dvec3(0, 0, 1)}}};
    for (const auto& [place, direction] : places)
      inputs.push_back({fmt::format("tiles of level {} at {}", level, place),
                        tileWithNeighbours(icoTileAt(kIcoMap, direction, level), tileCells), false});
  }
  return inputs;
}

/// An input as the ways take it.
struct Prepared {
  explicit Prepared(const Soup& soup)
      : corners(cornersOf(soup)),
        alike(positionsOf<double>(soup, Copies::Alike)),
        apart(positionsOf<double>(soup, Copies::Apart)),
        alikeFloat(positionsOf<float>(soup, Copies::Alike)),
        apartFloat(positionsOf<float>(soup, Copies::Apart)),
        truth(weldByCoordinates(alike)) {}

  std::vector<Corner> corners;
  std::vector<glm::dvec3> alike, apart;
  std::vector<glm::vec3> alikeFloat, apartFloat;
  Weld truth;
};

template <class Real>
Weld weldByHash(std::span<const glm::vec<3, Real>> positions, Sort sort) {
  return weldSorted<Real>(sortedHashes<Real>(positions, sort), kUsualEpsilon<Real>);
}

struct Way {
  const char* name;
  bool exact;
  int mostGridLevel;
  Weld (*weld)(const Prepared& input, Copies copies);
};

template <Weld (*kWeld)(std::span<const Corner>)>
Weld byKeys(const Prepared& input, Copies) {
  return kWeld(input.corners);
}
template <Sort kSort>
Weld byFloatHash(const Prepared& input, Copies copies) {
  return weldByHash<float>(copies == Copies::Alike ? input.alikeFloat : input.apartFloat, kSort);
}
template <Sort kSort>
Weld byDoubleHash(const Prepared& input, Copies copies) {
  return weldByHash<double>(copies == Copies::Alike ? input.alike : input.apart, kSort);
}

constexpr int kAnyGridLevel = 52;
enum WayIndex : std::size_t {
  kKey64,
  kRadix,
  kTable,
  kKey128,
  kFloatIntro,
  kFloatHeap,
  kDoubleIntro,
  kDoubleHeap,
  kWays
};
constexpr std::array<Way, kWays> kAllWays{{
    {"exact key of 64 bits, introsort", true, kKey64MaxGridLevel, byKeys<weldByKey64>},
    {"exact key of 64 bits, radix sort", true, kKey64MaxGridLevel, byKeys<weldByKey64Radix>},
    {"exact key of 64 bits, hash table", true, kKey64MaxGridLevel, byKeys<weldByKey64HashTable>},
    {"exact key of 128 bits, introsort", true, kAnyGridLevel, byKeys<weldByKey128>},
    {"float theta + k phi, introsort", false, kAnyGridLevel, byFloatHash<Sort::Introsort>},
    {"float theta + k phi, heapsort", false, kAnyGridLevel, byFloatHash<Sort::Heapsort>},
    {"double theta + k phi, introsort", false, kAnyGridLevel, byDoubleHash<Sort::Introsort>},
    {"double theta + k phi, heapsort", false, kAnyGridLevel, byDoubleHash<Sort::Heapsort>},
}};

/// What the findings are made of.
struct Seen {
  std::string name;
  bool sphere = false;
  std::int64_t truth = 0, expected = 0;  ///< expected: 10 * 4^level + 2 of a sphere, else as found
  struct OfWay {
    std::size_t way;
    WeldCounts alike, apart;
    double timeNs;
  };
  std::vector<OfWay> ways;
  std::array<std::array<EpsilonBounds, 2>, 2> bounds;  ///< by float and double, then by Copies
};

Seen measureWays(const Input& input, const Prepared& prepared, int rounds, Report& report) {
  Seen seen{input.name, input.sphere, prepared.truth.count, prepared.truth.count, {}, {}};
  if (input.sphere) seen.expected = 10 * (std::int64_t{1} << (2 * input.soup.gridLevel)) + 2;
  std::vector<Work> works;
  for (std::size_t way = 0; way < kAllWays.size(); ++way) {
    if (input.soup.gridLevel > kAllWays[way].mostGridLevel) continue;
    const auto counts = [&](Copies copies) {
      return compare(kAllWays[way].weld(prepared, copies), prepared.truth, prepared.alike);
    };
    const WeldCounts alike = counts(Copies::Alike);
    // Keys know nothing of coordinates.
    seen.ways.push_back({way, alike, kAllWays[way].exact ? alike : counts(Copies::Apart), 0});
    works.emplace_back([&prepared, way](std::size_t) {
      return static_cast<double>(kAllWays[way].weld(prepared, Copies::Alike).count);
    });
  }
  const std::vector<double> times = nanosecondsPerItem(works, prepared.corners.size(), rounds);
  for (std::size_t i = 0; i < times.size(); ++i) {
    Seen::OfWay& of = seen.ways[i];
    of.timeNs = times[i];
    report.rows.push_back({input.name, std::string(kAllWays[of.way].name),
                           static_cast<std::int64_t>(prepared.corners.size()), seen.expected, of.alike.found,
                           of.alike.missed.all(), of.alike.wrong.all(), of.apart.missed.all(), of.apart.wrong.all(),
                           of.apart.missed.pole, of.apart.missed.seam, of.apart.missed.elsewhere, times[i]});
  }
  return seen;
}

template <class Real>
void addBounds(Seen& seen, std::size_t type, const std::array<std::span<const glm::vec<3, Real>>, 2>& copies,
               const Prepared& prepared, NamedTable& table) {
  for (std::size_t c = 0; c < copies.size(); ++c) {
    const auto sorted = sortedHashes<Real>(copies[c], Sort::Introsort);
    const EpsilonBounds bounds = epsilonBounds<Real>(sorted, prepared.truth, prepared.alike);
    seen.bounds[type][c] = bounds;
    const auto at = [&](double epsilon) {
      return compare(weldSorted<Real>(sorted, epsilon), prepared.truth, prepared.alike);
    };
    const WeldCounts none = at(0), enough = at(bounds.leastForNoMiss);
    table.rows.push_back({seen.name, std::string(kTypes[type]), std::string(kCopies[c]), bounds.leastForNoMiss,
                          bounds.leastForNoMissElsewhere, bounds.mostForNoWrong,
                          std::string(bounds.possible()            ? "yes"
                                      : bounds.possibleElsewhere() ? "but for poles, antimeridian"
                                                                   : "no"),
                          none.missed.all(), none.wrong.all(), enough.wrong.all()});
  }
}

NamedTable boundsTable() {
  NamedTable table;
  table.key = "epsilon";
  table.title =
      "What an epsilon would have to be: no copy missed from the first on, no two vertices merged below the third";
  table.columns = {{"input", "input"},
                   {"type", "hash in"},
                   {"copies", "copies"},
                   {"leastForNoMiss", "least for no miss"},
                   {"leastElsewhere", "but for poles, antimeridian"},
                   {"mostForNoWrong", "most for no wrong weld"},
                   {"possible", "is there one?"},
                   {"missedAtZero", "missed at 0"},
                   {"wrongAtZero", "wrong at 0"},
                   {"wrongWithNoMiss", "wrong where none is missed"}};
  return table;
}

struct SeenNormals {
  std::string input;
  NormalDifferences exact, tiles, floats, doubles, gradient;
};

SeenNormals measureNormals(const Input& input, const Prepared& prepared, NamedTable& table) {
  const SoupGround ground = lunarGround(input.soup);
  const std::span<const glm::dvec3> positions(ground.positionsBody);
  const std::vector<glm::dvec3> exact = areaWeightedNormals(positions, weldByKey128(prepared.corners));
  const auto row = [&](const char* name, const std::vector<glm::dvec3>& normals,
                       const std::vector<glm::dvec3>& reference) {
    const NormalDifferences d = compareNormals(normals, reference, prepared.truth);
    table.rows.push_back({input.name, std::string(name), d.mostOfCopies, d.mostOfExact});
    return d;
  };
  const auto welded = [&](const Weld& weld) { return areaWeightedNormals(positions, weld); };
  SeenNormals seen{input.name, {}, {}, {}, {}, {}};
  seen.exact = row("exact key", exact, exact);
  seen.tiles = row("each tile alone", welded(weldWithinTiles(input.soup)), exact);
  seen.floats = row("float theta + k phi", welded(byFloatHash<Sort::Introsort>(prepared, Copies::Apart)), exact);
  seen.doubles = row("double theta + k phi", welded(byDoubleHash<Sort::Introsort>(prepared, Copies::Apart)), exact);
  seen.gradient = row("no weld: from the gradient (Terrane)", ground.gradientNormals, exact);
  return seen;
}

NamedTable normalsTable() {
  NamedTable table;
  table.key = "normals";
  table.title = "Smooth normals on the Moon's ground, welded so (hashes of copies a rounding apart)";
  table.columns = {{"input", "input"},
                   {"way", "way"},
                   {"mostOfCopies", "most between copies of a vertex, degrees"},
                   {"mostOfExact", "most from the exact weld's, degrees"}};
  return table;
}

std::int64_t mistakesOf(const Seen::OfWay& of) {
  return of.alike.missed.all() + of.alike.wrong.all() + of.apart.missed.all() + of.apart.wrong.all();
}

std::string exactFinding(const std::vector<Seen>& all) {
  std::int64_t mistakes = 0, miscounted = 0;
  for (const Seen& seen : all) {
    miscounted += seen.truth != seen.expected ? 1 : 0;
    for (const Seen::OfWay& of : seen.ways)
      if (kAllWays[of.way].exact) mistakes += mistakesOf(of);
  }
  return fmt::format(
      "By exact keys, sorted or in a table, {} in any of these inputs; {}.",
      mistakes == 0 ? "no weld is missed and none is wrong" : fmt::format("{} welds are missed or wrong", mistakes),
      miscounted == 0 ? "spheres have 10 x 4^n + 2 vertices" : "some spheres do not have 10 x 4^n + 2 vertices");
}

std::string verdict(const Seen& sphere) {
  const Seen::OfWay* quickest = nullptr;
  const Seen::OfWay* quickestRight = nullptr;
  for (const Seen::OfWay& of : sphere.ways) {
    if (quickest == nullptr || of.timeNs < quickest->timeNs) quickest = &of;
    if (mistakesOf(of) > 0) continue;
    if (quickestRight == nullptr || of.timeNs < quickestRight->timeNs) quickestRight = &of;
  }
  std::string text = fmt::format(
      "Keys or hash? On {} introsort takes {:.0f} ns a corner by keys of 64 bits, {:.0f} by a float hash, "
      "{:.0f} by one in double. ",
      sphere.name, sphere.ways[kKey64].timeNs, sphere.ways[kFloatIntro].timeNs, sphere.ways[kDoubleIntro].timeNs);
  if (quickestRight == nullptr) return text + "No way is right there.";
  text += fmt::format("The quickest that is right there is \"{}\", {:.0f} ns", kAllWays[quickestRight->way].name,
                      quickestRight->timeNs);
  if (quickest == quickestRight) return text + ", the quickest of all: nothing is left that speaks for another.";
  return text +
         fmt::format("; \"{}\" is quicker, {:.0f} ns, and wrong.", kAllWays[quickest->way].name, quickest->timeNs);
}

std::string placesOf(const ByPlace& places) {
  return fmt::format("{} within 5 degrees of a pole, {} on the antimeridian, {} elsewhere", places.pole, places.seam,
                     places.elsewhere);
}

std::string hashFinding(const Seen& sphere) {
  std::string text = fmt::format(
      "By theta + k phi (k = {:.4f}) with an epsilon of a few ulps, {} of {} vertices, "
      "copies a rounding apart:",
      kLongitudeFactor, sphere.name, sphere.truth);
  for (const std::size_t way : {kFloatIntro, kDoubleIntro}) {
    const WeldCounts& counts = sphere.ways[way].apart;
    text += fmt::format(" in {} {} welds are missed", kTypes[way == kFloatIntro ? 0 : 1], counts.missed.all());
    if (counts.missed.all() > 0) text += fmt::format(" ({})", placesOf(counts.missed));
    text += fmt::format(" and {} vertices merged with others", counts.wrong.all());
    if (counts.wrong.all() > 0) text += fmt::format(" ({})", placesOf(counts.wrong));
    text += way == kFloatIntro ? ";" : ".";
  }
  return text;
}

std::string whereThereIsOne(const std::vector<Seen>& all, std::size_t type, std::size_t copies) {
  std::array<std::string, 2> names;  // without, with
  std::array<std::size_t, 2> counts{};
  for (const Seen& seen : all) {
    const std::size_t is = seen.bounds[type][copies].possible() ? 1 : 0;
    names[is] += (names[is].empty() ? "" : "; ") + seen.name;
    ++counts[is];
  }
  if (counts[0] == 0) return "for all of these inputs";
  if (counts[1] == 0) return "for none of these inputs";
  return counts[1] <= counts[0] ? "only for " + names[1] : "for all but " + names[0];
}

std::string epsilonFinding(const std::vector<Seen>& all) {
  std::string text = "Is there an epsilon at which a hash misses nothing and merges nothing wrongly?";
  for (std::size_t type = 0; type < kTypes.size(); ++type)
    for (std::size_t copies = 0; copies < kCopies.size(); ++copies)
      text += fmt::format(" In {}, copies {}: {}.", kTypes[type], kCopies[copies], whereThereIsOne(all, type, copies));
  return text;
}

std::string sortFinding(const Seen& sphere) {
  const double single = sphere.ways[kFloatHeap].timeNs / sphere.ways[kFloatIntro].timeNs,
               twice = sphere.ways[kDoubleHeap].timeNs / sphere.ways[kDoubleIntro].timeNs;
  return fmt::format(
      "Heapsort gives the same welds as introsort in {:.1f} times the time (float) and {:.1f} times "
      "(double) on {}: {}.",
      single, twice, sphere.name,
      single > 1 && twice > 1 ? "introsort is the one to take" : "neither is always the quicker");
}

std::string normalsFinding(const std::vector<SeenNormals>& all) {
  const SeenNormals& last = all.back();
  return fmt::format(
      "Smooth normals, {}: copies of a vertex agree to {:.2g} degrees where the weld is exact; tiles welded alone "
      "differ by up to "
      "{:.2g} degrees at their borders, welds by hashes are up to {:.2g} (float) and {:.2g} degrees (double) off the "
      "exact ones. Normals "
      "from the ground's gradient, as tiles have them, agree to {:.2g} degrees without a weld, and no tile waits for "
      "its neighbours.",
      last.input, last.exact.mostOfCopies, last.tiles.mostOfCopies, last.floats.mostOfExact, last.doubles.mostOfExact,
      last.gradient.mostOfCopies);
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"input", "input"},
                    {"way", "way"},
                    {"corners", "corners"},
                    {"truth", "vertices there are"},
                    {"found", "found"},
                    {"missedAlike", "missed, copies alike"},
                    {"wrongAlike", "wrong"},
                    {"missedApart", "missed, copies a rounding apart"},
                    {"wrongApart", "wrong"},
                    {"missedAtPoles", "of those missed at poles"},
                    {"missedOnSeam", "on the antimeridian"},
                    {"missedElsewhere", "elsewhere"},
                    {"timeNsPerCorner", "time, ns a corner"}};
  NamedTable bounds = boundsTable(), normals = normalsTable();
  std::vector<Seen> all;
  std::vector<SeenNormals> allNormals;
  const std::vector<Input> inputs = inputsOf(settings);
  for (const Input& input : inputs) {
    const Prepared prepared(input.soup);
    const int rounds = prepared.corners.size() > 1'000'000 ? 3 : settings.quick ? 3 : 9;
    all.push_back(measureWays(input, prepared, rounds, report));
    addBounds<float>(all.back(), 0, {prepared.alikeFloat, prepared.apartFloat}, prepared, bounds);
    addBounds<double>(all.back(), 1, {prepared.alike, prepared.apart}, prepared, bounds);
    if (prepared.corners.size() <= 1'000'000) allNormals.push_back(measureNormals(input, prepared, normals));
    progress.at(static_cast<double>(all.size()) / static_cast<double>(inputs.size()));
  }
  const Seen& sphere = *std::ranges::find_if(all.rbegin(), all.rend(), &Seen::sphere);
  report.plots = {{"Wrong welds over time", "timeNsPerCorner", "wrongApart", "way", true, false, false}};
  report.more = {std::move(bounds), std::move(normals)};
  report.findings = {exactFinding(all), hashFinding(sphere), epsilonFinding(all),
                     verdict(sphere),   sortFinding(sphere), normalsFinding(allNormals)};
  return report;
}

const Registration kRegistered({91, "welding", "Welding by exact keys and by a hash",
                                "Does sorting a floating-point hash find out which corners of triangles are the same "
                                "vertex, and what do exact keys cost?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
