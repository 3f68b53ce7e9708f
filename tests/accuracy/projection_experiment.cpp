// Cube or icosahedron, and by which map: what each makes of the sphere, and what one descent to the ground takes.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/projection/descent_comparison.h"
#include "tests/accuracy/projection/sphere_maps.h"
#include "tests/accuracy/projection/tile_costs.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/span.h"

namespace terrane::accuracy {
namespace {

constexpr std::array<const char*, kSchemes> kSchemeNames{"cube", "icosahedron"};
constexpr const char* kNotServed = "not served";

constexpr double kAlike = 0.02;        ///< ratios this near to 1 are called the same
constexpr double kLittleShare = 0.05;  ///< of a tile's build, that evenness may cost

std::string ofPercent(double ratio, const char* below) {
  return fmt::format("{:.0f} % {}", 100 * std::fabs(ratio - 1), ratio < 1 ? below : "more");
}

struct MapFigures {
  std::string_view name;
  CellShapes shapes;
};

NamedTable mapsTable(const Settings& settings, std::vector<MapFigures>& figures) {
  const int cells = settings.quick ? 256 : 1024;
  std::vector<Work> ways;
  for (const SphereMap& map : sphereMaps()) ways.push_back(map.points);
  const std::vector<double> times =
      nanosecondsPerItem(ways, settings.quick ? 20'000 : 200'000, settings.quick ? 7 : 25);
  NamedTable table;
  table.key = "maps";
  table.title = fmt::format("What each map makes of a face, in cells of 1/{} of its edge, as tiles of level {} are too",
                            cells, settings.quick ? 8 : 10);
  table.columns = {{"map", "map"},
                   {"areaRatio", "area, largest / smallest"},
                   {"shortestEdge", "shortest edge, nominal widths"},
                   {"longestEdge", "longest"},
                   {"leastAngle", "least angle, degrees"},
                   {"mostAngle", "most"},
                   {"longestForWidth", "longest cell, length / width"},
                   {"leastDrawnAngle", "least angle as drawn, degrees"},
                   {"mostDrawnAngle", "most"},
                   {"timeNsPerPoint", "time, ns a point"}};
  for (std::size_t i = 0; i < sphereMaps().size(); ++i) {
    const CellShapes s = sphereMaps()[i].shapes(cells);
    figures.push_back({sphereMaps()[i].name, s});
    table.rows.push_back({std::string(sphereMaps()[i].name), s.areaRatio, s.shortestEdge, s.longestEdge, s.leastAngle,
                          s.mostAngle, s.longestForWidth, s.leastDrawnAngle, s.mostDrawnAngle, times[i]});
  }
  table.plots = {{"Unevenness over what a point costs", "timeNsPerPoint", "areaRatio", "map", true, false}};
  return table;
}

double bitsPerVertex(const Amounts& fetched) {
  return 8 * static_cast<double>(fetched.dracoBytes) / static_cast<double>(fetched.vertices);
}

NamedTable costsTable(const AllTileCosts& costs, const SchemeOutcomes& all) {
  NamedTable table;
  table.key = "tiles";
  table.title = "What a tile is and costs (bits: Draco's, of all tiles of the descents, skirts included)";
  table.columns = {{"map", "map"},
                   {"gridVertices", "vertices of a tile's grid"},
                   {"bitsPerVertex", "bits a vertex"},
                   {"kibibytesPerTile", "KiB a tile"},
                   {"timeBuildMs", "time to build, ms a tile"},
                   {"timeBuildNs", "time to build, ns a vertex"},
                   {"timeDirectionsNs", "of it the grid's directions"},
                   {"timeDirectionsShare", "their share"}};
  const auto add = [&](std::string_view map, const TileCosts& cost, const Amounts& fetched) {
    const double kibibytes = static_cast<double>(fetched.bytes) / 1024;
    table.rows.push_back({std::string(map), static_cast<std::int64_t>(cost.gridVertices), bitsPerVertex(fetched),
                          kibibytes / static_cast<double>(fetched.tiles), cost.buildMs, cost.buildNsPerVertex(),
                          cost.directionsNs, cost.directionsNs / cost.buildNsPerVertex()});
  };
  add(kCubeMapName, costs.cube, all.byError[0][0].fetched);
  add(kBisectedMapName, costs.bisected, all.byError[0][1].fetched);
  const std::string none(kNotServed);
  table.rows.push_back({std::string(kGnomonicMapName), static_cast<std::int64_t>(costs.gnomonic.gridVertices), none,
                        none, none, none, costs.gnomonic.directionsNs, none});
  return table;
}

void addRows(const std::string& place, const SchemeOutcomes& outcomes, std::size_t error, Report& report) {
  for (std::size_t s = 0; s < kSchemes; ++s) {
    const Outcome& o = outcomes.byError[error][s];
    report.rows.push_back({place, std::string(kSchemeNames[s]), kErrorPixels[error], o.fetched.tiles,
                           o.fetched.vertices, o.fetched.triangles, static_cast<double>(o.fetched.bytes) / 1024,
                           o.meanErrorPixels(), o.worstErrorPixels});
  }
}

const CellShapes& shapesOf(const std::vector<MapFigures>& maps, std::string_view name) {
  return std::ranges::find(maps, name, &MapFigures::name)->shapes;
}

std::string evennessFinding(const std::vector<MapFigures>& maps) {
  const CellShapes &cube = shapesOf(maps, kCubeMapName), &bisected = shapesOf(maps, kBisectedMapName),
                   &gnomonic = shapesOf(maps, kGnomonicMapName);
  const auto& evenest = *std::ranges::min_element(maps, {}, [](const MapFigures& map) { return map.shapes.areaRatio; });
  const double cubeBend = cube.mostDrawnAngle / cube.leastDrawnAngle,
               icoBend = bisected.mostDrawnAngle / bisected.leastDrawnAngle;
  return fmt::format(
      "Cells: those of the cube differ in area by {:.3f}, those of the icosahedron by {:.3f} (bisected) and {:.3f} "
      "(gnomonic); the most even of all are those of \"{}\" with {:.3f}. Triangles as drawn have angles of {:.0f} to "
      "{:.0f} degrees on the cube and {:.0f} to {:.0f} on the bisected icosahedron: {} has the better triangles.",
      cube.areaRatio, bisected.areaRatio, gnomonic.areaRatio, evenest.name, evenest.shapes.areaRatio,
      cube.leastDrawnAngle, cube.mostDrawnAngle, bisected.leastDrawnAngle, bisected.mostDrawnAngle,
      icoBend < cubeBend ? "the icosahedron" : "the cube");
}

std::string descentFinding(const SchemeOutcomes& all, const std::vector<SchemeOutcomes>& places) {
  const Outcome &cube = all.byError[0][0], &ico = all.byError[0][1];
  const auto ratio = [](std::int64_t a, std::int64_t b) { return static_cast<double>(a) / static_cast<double>(b); };
  Span bytes, errors;
  for (const SchemeOutcomes& place : places) {
    bytes.include(ratio(place.byError[0][1].fetched.bytes, place.byError[0][0].fetched.bytes));
    errors.include(place.byError[0][1].meanErrorPixels() / place.byError[0][0].meanErrorPixels());
  }
  return fmt::format(
      "Where {} px are allowed, descents on the icosahedron take {:.2f} times the cube's tiles, {:.2f} times its "
      "triangles and {:.2f} times its bytes ({} over the places), and draw ground that is {:.2f} times as far off in "
      "the picture ({:.3f} against {:.3f} px on average; {} over the places).",
      kErrorPixels[0], ratio(ico.fetched.tiles, cube.fetched.tiles),
      ratio(ico.fetched.triangles, cube.fetched.triangles), ratio(ico.fetched.bytes, cube.fetched.bytes), bytes.text(),
      ico.meanErrorPixels() / cube.meanErrorPixels(), ico.meanErrorPixels(), cube.meanErrorPixels(), errors.text());
}

/// Bytes of the icosahedron over the cube's, for the cube's mean error.
std::optional<double> bytesAtEqualError(const SchemeOutcomes& outcomes) {
  const Outcome& cube = outcomes.byError[0][0];
  const auto bytes = bytesForError(outcomes, 1, cube.meanErrorPixels());
  if (!bytes) return std::nullopt;
  return *bytes / static_cast<double>(cube.fetched.bytes);
}

std::string bytesVerdict(const SchemeOutcomes& all, const std::vector<SchemeOutcomes>& places) {
  const auto bytes = bytesAtEqualError(all);
  if (!bytes) return "so few pictures do not say which takes fewer bytes";
  if (std::fabs(*bytes - 1) < kAlike)
    return fmt::format("both take the same bytes ({:.2f} times) for the same mean error", *bytes);
  const bool icoCheaper = *bytes < 1;
  std::size_t agree = 0;
  for (const SchemeOutcomes& place : places) {
    const auto there = bytesAtEqualError(place);
    agree += there && (*there < 1) == icoCheaper ? 1 : 0;
  }
  return fmt::format(
      "the icosahedron takes {} bytes than the cube for the same mean error; the {} is the cheaper to "
      "send at {} of {} places",
      ofPercent(*bytes, "fewer"), kSchemeNames[icoCheaper ? 1 : 0], agree, places.size());
}

std::string schemeVerdict(const SchemeOutcomes& all, const std::vector<SchemeOutcomes>& places,
                          const AllTileCosts& costs) {
  const double vertex = costs.bisected.buildNsPerVertex() / costs.cube.buildNsPerVertex();
  const double server = costs.bisected.buildMs * static_cast<double>(all.byError[0][1].fetched.tiles) /
                        (costs.cube.buildMs * static_cast<double>(all.byError[0][0].fetched.tiles));
  const auto time = [](double ratio) {
    return std::fabs(ratio - 1) < kAlike ? std::string("the same time") : ofPercent(ratio, "less") + " time";
  };
  return fmt::format(
      "Cube or icosahedron? With the icosahedron's error set so that it draws the ground as well as the cube does, {}. "
      "A vertex of a triangular tile takes {:.1f} bits against {:.1f}, and {} to build ({} vertices of a grid share "
      "what a tile costs, on the cube {}); the server takes {} for all the tiles of these descents at {} px.",
      bytesVerdict(all, places), bitsPerVertex(all.byError[0][1].fetched), bitsPerVertex(all.byError[0][0].fetched),
      time(vertex), costs.bisected.gridVertices, costs.cube.gridVertices, time(server), kErrorPixels[0]);
}

std::string mapVerdict(const std::vector<MapFigures>& maps, const AllTileCosts& costs) {
  const CellShapes &bisected = shapesOf(maps, kBisectedMapName), &gnomonic = shapesOf(maps, kGnomonicMapName);
  const bool bisectedEvener = bisected.areaRatio < gnomonic.areaRatio;
  const double dearer = costs.bisected.directionsNs - costs.gnomonic.directionsNs;
  const double share = std::fabs(dearer) / costs.bisected.buildNsPerVertex();
  const bool cheap = dearer <= 0 || share < kLittleShare;
  return fmt::format(
      "Which map of the icosahedron? The {} one has the more even cells (largest / smallest {:.2f} against {:.2f}, "
      "longest edge {:.2f} against {:.2f} nominal widths). A direction of the bisected map takes {:.1f} ns, of the "
      "gnomonic {:.1f} ns: {:.1f} % of a tile's build {}. {}",
      bisectedEvener ? "bisected" : "gnomonic", bisected.areaRatio, gnomonic.areaRatio, bisected.longestEdge,
      gnomonic.longestEdge, costs.bisected.directionsNs, costs.gnomonic.directionsNs, 100 * share,
      dearer > 0 ? "lost" : "gained",
      bisectedEvener && cheap ? "So the bisected map, by which tiles are served, is the one to take."
      : bisectedEvener        ? "So evenness has its price here: tiles are served by the bisected map."
                              : "So the figures speak for the gnomonic map, though tiles are served by the bisected.");
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"place", "descent to"},
                    {"scheme", "scheme"},
                    {"errorPixels", "error allowed, pixels"},
                    {"tiles", "tiles"},
                    {"vertices", "vertices"},
                    {"triangles", "triangles"},
                    {"kibibytes", "KiB"},
                    {"meanErrorPixels", "mean error drawn, pixels"},
                    {"worstErrorPixels", "worst"}};
  std::vector<MapFigures> maps;
  NamedTable mapsDone = mapsTable(settings, maps);
  DescentTiles cube("moon"), ico("moon-ico");
  const auto moon = makeHeightField(cube.builder().body(), bestSimdPath());
  std::vector<Place> places = descentPlaces(settings.seed, settings.quick ? 0 : 4);
  if (settings.quick) places.resize(2);
  const int width = settings.quick ? 320 : 1280, height = settings.quick ? 180 : 720;
  SchemeOutcomes all;
  std::vector<SchemeOutcomes> byPlace;
  for (const Place& place : places) {
    const std::vector<Camera> cameras = descentCameras(place, *moon, cube.builder().body().radiusMeters,
                                                       settings.quick ? 3 : kDescentCameras, width, height);
    byPlace.push_back(compareDescents(cameras, *moon, {&cube, &ico}));
    all += byPlace.back();
    addRows(place.name, byPlace.back(), 0, report);
    progress.at(0.1 + 0.8 * static_cast<double>(byPlace.size()) / static_cast<double>(places.size()));
  }
  for (std::size_t error = 0; error < kErrorPixels.size(); ++error) addRows("all of these", all, error, report);
  const AllTileCosts costs = tileCosts(cube.builder(), ico.builder(), places, settings.quick ? 3 : 15);
  report.plots = {
      {"Error that is drawn, over what is fetched", "kibibytes", "meanErrorPixels", "scheme", true, true, false}};
  report.more = {std::move(mapsDone), costsTable(costs, all)};
  report.findings = {evennessFinding(maps), descentFinding(all, byPlace), schemeVerdict(all, byPlace, costs),
                     mapVerdict(maps, costs),
                     fmt::format("Pictures of {} x {} pixels; descents from far orbit to {} m over the same ground by "
                                 "the same cameras (random places: seed {}). Bytes are those of distinct tiles.",
                                 width, height, kLowestMeters, settings.seed)};
  return report;
}

const Registration kRegistered({90, "projection", "Cube or icosahedron",
                                "By which solid and which map does the same picture of a planet take the fewest bytes, "
                                "and what does a point cost?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
