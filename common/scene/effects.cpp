#include "common/scene/effects.h"

#include <algorithm>
#include <map>
#include <mutex>
#include <numbers>

namespace terrane {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

constexpr std::array kSunParameters{
    ParameterSpec{"longitude", Quantity::Angle, -360 * kDegree, 360 * kDegree, 0,
                  "longitude of the point that has the sun overhead, east positive"},
    ParameterSpec{"latitude", Quantity::Angle, -90 * kDegree, 90 * kDegree, 0,
                  "latitude of the point that has the sun overhead"},
    ParameterSpec{"ambient", Quantity::Number, 0, 1, 0.02, "light that reaches the shade, as a part of full sunlight"},
};

constexpr std::array kDetailParameters{
    ParameterSpec{"relief", Quantity::Number, 0, 1, 0.12, "slope of the relief in each octave up to a metre"},
    ParameterSpec{"mottle", Quantity::Number, 0, 1, 0.04,
                  "how much reflectance varies, as a share, in each octave up to a metre"},
    ParameterSpec{"hurst", Quantity::Number, 0, 1, 0.7,
                  "how both fall with longer waves, as their length's power of hurst - 1"},
};

constexpr std::array kDustParameters{
    ParameterSpec{"cover", Quantity::Number, 0, 0.05, 0.03,
                  "share of the ground that the least octave of grains covers; each above it a quarter less"},
    ParameterSpec{"smallest", Quantity::Length, 1e-5, 100, 0.0005, "least diameter of a grain"},
    ParameterSpec{"largest", Quantity::Length, 1e-5, 100, 0.128, "greatest diameter of a grain"},
};

// In the order of EffectKind.
constexpr std::array kEffects{
    EffectRow{EffectKind::Sun, "sun", "sunlight from one direction, with a night side", "surface normals of the tiles",
              "one dot product a vertex and one power a pixel; no pass, texture or buffer of its own",
              EffectSide::Client, kSunParameters},
    EffectRow{EffectKind::Detail, "detail", "relief and mottling of the ground finer than its mesh, at every scale",
              "the depth of the ground as a texture; the sun, or it only mottles",
              "one pass over the picture: three octaves of noise a pixel, whatever the number of triangles",
              EffectSide::Client, kDetailParameters},
    EffectRow{EffectKind::Dust, "dust", "grains and pebbles that lie on the ground, solid, where near enough to see",
              "the tiles' vertices; the sun for their shadows",
              "four instanced meshes and a pass for shadows, a copy of the "
              "depth buffer and an instance a grain in view; nothing where no grain would be a pixel wide",
              EffectSide::Client, kDustParameters},
};
static_assert(kEffects.size() == kEffectKindCount, "every kind of effect has its row");
static_assert(
    [] {
      for (std::size_t i = 0; i < kEffects.size(); ++i)
        if (static_cast<std::size_t>(kEffects[i].kind) != i) return false;
      return true;
    }(),
    "rows stand in the order of EffectKind");

struct ConstructionCounter {
  std::mutex mutex;
  std::map<std::string, int, std::less<>> counts;
};

ConstructionCounter& constructionCounter() {
  static ConstructionCounter counter;
  return counter;
}

}  // namespace

std::span<const EffectRow> effectTable() noexcept { return kEffects; }

const EffectRow& effectRow(EffectKind kind) noexcept { return kEffects[static_cast<std::size_t>(kind)]; }

std::optional<EffectKind> findEffect(std::string_view name) noexcept {
  const auto row = std::ranges::find(kEffects, name, &EffectRow::name);
  if (row == kEffects.end()) return std::nullopt;
  return row->kind;
}

double effectSetting(const EffectCall& call, std::string_view name) {
  if (const auto found = call.parameters.find(name); found != call.parameters.end()) return found->second;
  const auto schema = effectRow(call.kind).parameters;
  const auto spec = std::ranges::find(schema, name, &ParameterSpec::name);
  return spec == schema.end() ? 0 : spec->defaultValue;
}

void countConstruction(std::string_view name) {
  ConstructionCounter& counter = constructionCounter();
  const std::lock_guard lock(counter.mutex);
  const auto found = counter.counts.find(name);
  if (found != counter.counts.end())
    ++found->second;
  else
    counter.counts.emplace(name, 1);
}

std::vector<std::pair<std::string, int>> constructionCounts() {
  ConstructionCounter& counter = constructionCounter();
  const std::lock_guard lock(counter.mutex);
  return {counter.counts.begin(), counter.counts.end()};
}

void resetConstructionCounts() {
  ConstructionCounter& counter = constructionCounter();
  const std::lock_guard lock(counter.mutex);
  counter.counts.clear();
}

}  // namespace terrane
