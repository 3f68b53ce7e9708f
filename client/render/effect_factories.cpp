#include "client/render/effect_factories.h"

#include <algorithm>
#include <array>
#include <string>

namespace terrane {
namespace {

using Factory = std::unique_ptr<const Effect> (*)(const ParameterValues&);

// In the order of EffectKind; an effect of the server has none.
constexpr std::array<Factory, kEffectKindCount> kFactories{&makeSunEffect};
static_assert(std::ranges::none_of(kFactories, [](Factory factory) { return factory == nullptr; }),
              "every kind of effect has its factory");

}  // namespace

std::vector<std::unique_ptr<const Effect>> makeEffects(const std::vector<EffectCall>& calls) {
  std::vector<std::unique_ptr<const Effect>> effects;
  for (const EffectCall& call : calls) {
    const EffectRow& row = effectRow(call.kind);
    if (row.side != EffectSide::Client) continue;
    effects.push_back(kFactories[static_cast<std::size_t>(call.kind)](call.parameters));
    countConstruction("effect." + std::string(row.name));
  }
  return effects;
}

}  // namespace terrane
