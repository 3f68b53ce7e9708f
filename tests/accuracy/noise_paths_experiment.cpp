// The server's own noise kernel, reduced to octaves, on every SIMD path that this CPU has: bits, error, time.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "tests/accuracy/experiment.h"
#include "tests/accuracy/side_by_side.h"
#include "tests/accuracy/tile_build/lunar_octaves.h"
#include "tests/accuracy/tile_build/sample_block.h"
#include "tests/accuracy/tile_build/tile_reference.h"

namespace terrane::accuracy {
namespace {

using lunar::Block;

constexpr double kRadiusMeters = 1'737'400.0;
constexpr int kFinestExponent = -10;  // 2^-10 m, about 1 mm
constexpr std::array<int, 5> kOctaves{1, 4, 8, 16, 20};
constexpr std::size_t kTimedBlocks = 4;  // so few that what else the machine does seldom falls into one time
constexpr std::array<SimdPath, 3> kPaths{SimdPath::Default, SimdPath::V3, SimdPath::V4};

/// Blocks anywhere on the Moon, their samples half the finest wavelength apart, as a tile's are.
std::vector<Block> makeBlocks(std::size_t count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&] { return std::ldexp(static_cast<double>(random() >> 11), -52) - 1; };
  const double cell = std::ldexp(0.5, kFinestExponent);
  std::vector<Block> blocks(count);
  for (Block& block : blocks) {
    const double a = uniform(), b = uniform();
    const double radial = kRadiusMeters / std::sqrt(1 + a * a + b * b);
    block.count = kBlockSamples;
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
      const std::size_t k = std::min(i, kBlockSide * kBlockSide - 1);
      block.x[i] = radial;
      block.y[i] = radial * a + cell * static_cast<double>(k % kBlockSide);
      block.z[i] = radial * b + cell * static_cast<double>(k / kBlockSide);
    }
  }
  return blocks;
}

struct Sample {
  std::uint64_t height;
  std::array<std::uint32_t, 3> gradient;
  bool operator==(const Sample&) const = default;
};

std::vector<Sample> bitsOf(const std::vector<Block>& blocks) {
  std::vector<Sample> samples;
  for (const Block& b : blocks)
    for (std::size_t i = 0; i < kBlockSamples; ++i)
      samples.push_back({std::bit_cast<std::uint64_t>(b.height[i]),
                         {std::bit_cast<std::uint32_t>(b.gradientX[i]), std::bit_cast<std::uint32_t>(b.gradientY[i]),
                          std::bit_cast<std::uint32_t>(b.gradientZ[i])}});
  return samples;
}

double worstErrorMeters(const std::vector<Block>& blocks, const std::vector<lunar::NoiseOctave>& octaves) {
  double worst = 0;
  for (const Block& b : blocks)
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
      const long double exact = referenceHeightMeters(octaves, {b.x[i], b.y[i], b.z[i]});
      worst = std::max(worst, static_cast<double>(std::fabs(static_cast<long double>(b.height[i]) - exact)));
    }
  return worst;
}

/// What the findings are made of.
struct Seen {
  std::size_t differing = 0, compared = 0;
  double worstMeters = 0, amplitudesMeters = 0;
  std::vector<double> firstNs, lastNs;  ///< a sample, by path, of the fewest and of the most octaves
};

void addOctaves(const Settings& settings, int count, const std::vector<SimdPath>& paths, std::vector<Block>& blocks,
                Report& report, Seen& seen) {
  const auto octaves = lunarOctaves(kFinestExponent + count - 1, kFinestExponent, settings.seed);
  std::vector<lunar::NoiseGroup> groups;
  const lunar::Program program = octavesOnly(octaves, std::numeric_limits<double>::infinity(), kRadiusMeters, groups);
  std::vector<Work> ways;
  for (const SimdPath path : paths)
    ways.push_back([&program, &blocks, evaluate = kernelOf(path)](std::size_t samples) {
      for (std::size_t k = 0; k < samples / kBlockSamples; ++k) evaluate(program, blocks[k]);
      return blocks.front().height[0];
    });
  seen.lastNs = nanosecondsPerItem(ways, kTimedBlocks * kBlockSamples, settings.quick ? 15 : 301);
  const bool first = count == kOctaves.front();
  if (first) seen.firstNs = seen.lastNs;
  seen.amplitudesMeters = 0;
  for (const lunar::NoiseOctave& octave : octaves) seen.amplitudesMeters += octave.amplitude;

  std::vector<Sample> reference;
  for (std::size_t p = 0; p < paths.size(); ++p) {
    ways[p](blocks.size() * kBlockSamples);
    const std::vector<Sample> samples = bitsOf(blocks);
    if (p == 0) reference = samples;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) differing += samples[i] == reference[i] ? 0 : 1;
    const double error = worstErrorMeters(blocks, octaves), ns = seen.lastNs[p];
    report.rows.push_back(
        {std::string(nameOf(paths[p])), std::int64_t{count}, static_cast<std::int64_t>(differing),
         static_cast<std::int64_t>(samples.size()), error, ns,
         first ? Value(std::string("the first")) : Value((ns - seen.firstNs[p]) / (count - kOctaves.front())),
         seen.lastNs[0] / ns});
    seen.differing += differing;
    seen.compared += p == 0 ? 0 : samples.size();
    seen.worstMeters = std::max(seen.worstMeters, error);
  }
}

std::vector<std::string> findingsFrom(const Seen& seen, const std::vector<SimdPath>& paths) {
  std::string gains;
  for (std::size_t p = 1; p < paths.size(); ++p)
    gains += fmt::format("{}{} {:.1f}", p > 1 ? ", " : "", nameOf(paths[p]), seen.lastNs[0] / seen.lastNs[p]);
  return {
      fmt::format("{} of {} samples have other bits on another path than on the default one (heights and gradients){}",
                  seen.differing, seen.compared,
                  seen.differing == 0 ? ": which path a server takes changes no tile." : "."),
      fmt::format("Default's time over that of a path, {} octaves: {}.", kOctaves.back(),
                  gains.empty() ? "this CPU has no other path" : gains),
      fmt::format(
          "The worst height error on the Moon is {:.2g} m, of octaves {:.3g} m tall in all, down to 1 mm: cells "
          "split in double, float32 within.",
          seen.worstMeters, seen.amplitudesMeters)};
}

Report run(const Settings& settings, Progress& progress) {
  Report report;
  report.columns = {{"path", "path"},
                    {"octaves", "octaves"},
                    {"differing", "samples with other bits than default's"},
                    {"samples", "of samples"},
                    {"errorMeters", "worst height error, m"},
                    {"timeNsPerSample", "time, ns a sample"},
                    {"timeNsPerOctave", "time, ns an octave more"},
                    {"timeRatio", "default's time / this path's"}};
  std::vector<SimdPath> paths;
  std::ranges::copy_if(kPaths, std::back_inserter(paths), simdPathSupported);
  std::vector<Block> blocks = makeBlocks(settings.quick ? 8 : 64, settings.seed);
  Seen seen;
  for (std::size_t n = 0; n < kOctaves.size(); ++n) {
    addOctaves(settings, kOctaves[n], paths, blocks, report, seen);
    progress.at(static_cast<double>(n + 1) / kOctaves.size());
  }
  report.plots = {{"Time over octaves", "octaves", "timeNsPerSample", "path", false, false}};
  report.findings = findingsFrom(seen, paths);
  return report;
}

const Registration kRegistered({72, "noise-paths", "The server's noise on every SIMD path",
                                "What does a wider path gain, and does it change a bit?", run});

}  // namespace
}  // namespace terrane::accuracy
