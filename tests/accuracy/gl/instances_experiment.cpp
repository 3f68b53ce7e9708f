// Many things placed from one root: what an instance must carry, what it costs, and how exact it is, by the size of the
// set that shares the root.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "common/numerics/relative_position.h"
#include "tests/accuracy/experiment.h"
#include "tests/accuracy/gl/gl_experiment.h"
#include "tests/accuracy/gl/shader_scheme.h"

namespace terrane::accuracy {
namespace {

using gl::Component, gl::Conversion, gl::setUniform;

constexpr std::string_view kRootOffset = "root + offset, recombined as double-float",
                           kNearRoot = "(root − camera) by the CPU + offset", kOneTile = "one tile index + offset",
                           kFull = "double-float each", kSteps = "steps of a lattice, 32 bits";

glm::vec3 offsetFrom(const UnitPoint& root, const FinePoint& point) {
  glm::vec3 offset(0.0f);
  for (std::size_t a = 0; a < 3; ++a)
    offset[static_cast<int>(a)] = static_cast<float>(static_cast<double>(point.units[a] - root[a]) * kUnitMeters);
  return offset;
}

constexpr const char* kOffset = "layout(location = 0) in vec3 offset;\n";
const std::vector<gl::VertexAttribute> kOneVector{{0, 3, Component::F32, Conversion::Float, 0}};

ShaderScheme rootOffset(const UnitPoint& root) {
  return {
      kRootOffset,
      12,
      0,
      std::string("#include \"double_float.glsl\"\nuniform vec3 rootHigh, rootLow, cameraHigh, cameraLow;\n") + kOffset,
      "subtractPairToFloat(addFloat(DoubleFloat3(rootHigh, rootLow), offset), DoubleFloat3(cameraHigh, cameraLow))",
      12,
      kOneVector,
      eachVertex([root](const FinePoint& point, const Sample&) { return offsetFrom(root, point); }),
      [root](const gl::Program& program, const Sample& sample) {
        setPair(program, "root", {root, glm::dvec3(0.0)});
        setPair(program, "camera", sample.camera);
      }};
}

ShaderScheme nearRoot(const UnitPoint& root) {
  return {kNearRoot,
          12,
          0,
          std::string("uniform vec3 rootMinusCamera;\n") + kOffset,
          "rootMinusCamera + offset",
          12,
          kOneVector,
          eachVertex([root](const FinePoint& point, const Sample&) { return offsetFrom(root, point); }),
          [root](const gl::Program& program, const Sample& sample) {
            setUniform(program.uniform("rootMinusCamera"),
                       cameraRelative(doublesOf({root, glm::dvec3(0.0)}), doublesOf(sample.camera)));
          }};
}

/// One tile that holds the whole set: its size grows with the set's. The camera's own tile may be another.
ShaderScheme oneTile(const UnitPoint& root, double extentMeters) {
  const double size = std::exp2(std::ceil(std::log2(4 * extentMeters)));
  UnitPoint middle{};
  glm::ivec3 tile(0);
  for (std::size_t a = 0; a < 3; ++a) {
    tile[static_cast<int>(a)] = static_cast<int>(std::floor(static_cast<double>(root[a]) * kUnitMeters / size + 0.5));
    middle[a] = static_cast<Units>(tile[static_cast<int>(a)]) * static_cast<Units>(size / kUnitMeters);
  }
  const auto sizeText = fmt::format("{:.1f}", size);
  return {kOneTile,
          12,
          0,
          std::string("#include \"relative_position.glsl\"\nuniform ivec3 tile, cameraTile;\nuniform vec3 "
                      "cameraOffset;\n") +
              kOffset,
          "relativeByHalves(tile, offset, cameraTile, cameraOffset, " + sizeText + ")",
          12,
          kOneVector,
          eachVertex([middle](const FinePoint& point, const Sample&) { return offsetFrom(middle, point); }),
          [tile, size](const gl::Program& program, const Sample& sample) {
            const TiledPosition camera = tiledFromDouble(doublesOf(sample.camera), static_cast<float>(size));
            setUniform(program.uniform("tile"), tile);
            setUniform(program.uniform("cameraTile"), camera.tile);
            setUniform(program.uniform("cameraOffset"), camera.offsetMeters);
          }};
}

ShaderScheme fullPairs() {
  return {kFull,
          24,
          0,
          "#include \"double_float.glsl\"\nlayout(location = 0) in vec3 high;\nlayout(location = 1) in vec3 low;\n"
          "uniform vec3 cameraHigh, cameraLow;\n",
          "subtractPairToFloat(DoubleFloat3(high, low), DoubleFloat3(cameraHigh, cameraLow))",
          24,
          {{0, 3, Component::F32, Conversion::Float, 0}, {1, 3, Component::F32, Conversion::Float, 12}},
          eachVertex([](const FinePoint& point, const Sample&) { return pairsOf(point); }),
          [](const gl::Program& program, const Sample& sample) { setPair(program, "camera", sample.camera); }};
}

/// The finest step in which the set's extent fits 31 bits, not finer than the truth is given in.
ShaderScheme latticeSteps(const UnitPoint& root, double extentMeters) {
  const int exponent = std::max(-20, static_cast<int>(std::ceil(std::log2(2 * extentMeters))) - 30);
  const Units unitsPerStep = Units{1} << (exponent + 20);
  return {kSteps,
          12,
          0,
          "#include \"relative_position.glsl\"\nlayout(location = 0) in ivec3 steps;\nuniform ivec3 "
          "originMinusCamera;\nuniform vec3 cameraRest;\nuniform float stepMeters;\n",
          "relativeOnLattice(originMinusCamera, steps, cameraRest, stepMeters)",
          12,
          {{0, 3, Component::I32, Conversion::Integer, 0}},
          eachVertex([root, unitsPerStep](const FinePoint& point, const Sample&) {
            glm::ivec3 steps(0);
            for (std::size_t a = 0; a < 3; ++a)
              steps[static_cast<int>(a)] = static_cast<std::int32_t>(
                  std::llround(static_cast<double>(point.units[a] - root[a]) / static_cast<double>(unitsPerStep)));
            return steps;
          }),
          [root, unitsPerStep, exponent](const gl::Program& program, const Sample& sample) {
            glm::ivec3 difference(0);
            glm::vec3 rest(0.0f);
            for (std::size_t a = 0; a < 3; ++a) {  // the lattice begins at the root
              const auto axis = static_cast<int>(a);
              const Units away = sample.camera.units[a] - root[a];
              const Units whole = away >= 0 ? away / unitsPerStep : -((-away + unitsPerStep - 1) / unitsPerStep);
              difference[axis] = static_cast<std::int32_t>(-whole);
              rest[axis] = static_cast<float>(
                  (static_cast<double>(away - whole * unitsPerStep) + sample.camera.restUnits[axis]) /
                  static_cast<double>(unitsPerStep));
            }
            setUniform(program.uniform("originMinusCamera"), difference);
            setUniform(program.uniform("cameraRest"), rest);
            setUniform(program.uniform("stepMeters"), std::ldexp(1.0f, exponent));
          }};
}

struct InstanceSet {
  Sample sample;
  UnitPoint root{};
};

/// Instances around a camera on the Moon, on no lattice; the set's root as far away as the set is large.
InstanceSet makeSet(double extentMeters, std::uint64_t seed, std::size_t count) {
  InstanceSet set{makeSample(kPlaces[kMoonsRadius].meters, seed, count), {}};
  const UnitPoint spread = makeSample(1000, seed + 1, 1).camera.units;
  for (std::size_t a = 0; a < 3; ++a) {
    set.root[a] = set.sample.camera.units[a] + static_cast<Units>(static_cast<double>(spread[a]) * extentMeters / 1000);
    for (std::size_t i = 0; i < count; ++i)
      set.sample.vertices[i][a] += static_cast<Units>((i * 7919 + a * 104729) % 1021);
  }
  return set;
}

std::vector<ShaderScheme> schemesOf(const InstanceSet& set, double extentMeters) {
  return {nearRoot(set.root), rootOffset(set.root), oneTile(set.root, extentMeters),
          latticeSteps(set.root, extentMeters), fullPairs()};
}

Report run(const Settings& settings, Progress& progress) {
  if (auto nothing = whyNotDrawn()) return *nothing;
  Report report;
  report.columns = {{"extentMeters", "size of the set, m"},
                    {"scheme", "an instance carries"},
                    {"errorMeters", "worst error, m"},
                    {"errorPixels", "worst error, pixels at 2 m"},
                    {"bytes", "bytes an instance"},
                    {"timeNsPerInstance", "time, ns an instance"},
                    {"timeRatioToFull", "time / double-float each"}};
  const std::array kExtents{10.0, 100.0, 1e3, 1e4, 1e5};
  std::map<std::string_view, double> atTenKilometres;
  for (std::size_t e = 0; e < kExtents.size(); ++e) {
    const InstanceSet set = makeSet(kExtents[e], settings.seed + 2 * e, settings.quick ? 4096 : 32768);
    const std::vector<ShaderScheme> all = schemesOf(set, kExtents[e]);
    auto prepared = prepareAll(all, set.sample);
    if (!prepared) return notRun(prepared.error());
    const std::vector<double> times = nanosecondsPerVertex(*prepared, set.sample, settings.quick ? 3 : 15);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const double error = worstMeters(set.sample, (*prepared)[i].run);
      if (e == 3) atTenKilometres[all[i].name] = pixelsOf(error);
      report.rows.push_back({kExtents[e], std::string(all[i].name), error, pixelsOf(error),
                             std::int64_t{all[i].bytesPerVertex}, times[i], times[i] / times.back()});
    }
    progress.at(static_cast<double>(e + 1) / kExtents.size());
  }
  report.plots = {{"Worst error over the size of the set", "extentMeters", "errorPixels", "scheme"}};
  report.findings = {
      fmt::format("In 12 bytes, in a set of 10 km: an offset as a float is off by {:.2g} pixels however it is "
                  "recombined ({:.2g} with the root's distance as a float, {:.2g} from a tile's middle); steps of a "
                  "lattice, which spend no bits on being fine near the root, by {:.2g}.",
                  atTenKilometres.at(kRootOffset), atTenKilometres.at(kNearRoot), atTenKilometres.at(kOneTile),
                  atTenKilometres.at(kSteps)),
      "A double-float each takes twice the bytes and needs no root: for what moves freely."};
  return report;
}

const Registration kRegistered({20, "instances", "Instances", "What must an instance carry to stand still 2 m away?",
                                run});

}  // namespace
}  // namespace terrane::accuracy
