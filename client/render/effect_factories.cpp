#include "client/render/effect_factories.h"

#include <algorithm>
#include <array>
#include <string>

#include "client/render/effect_pass.h"

namespace terrane {
namespace {

using Factory = std::unique_ptr<const Effect> (*)(const EffectCall&);

// In the order of EffectKind; an effect of the server has none.
constexpr std::array<Factory, kEffectKindCount> kFactories{&makeSunEffect, &makeDetailEffect, &makeDustEffect};
static_assert(std::ranges::none_of(kFactories, [](Factory factory) { return factory == nullptr; }),
              "every kind of effect has its factory");

}  // namespace

Result<std::unique_ptr<EffectPass>> Effect::makePass(const PassContext&) const { return std::unique_ptr<EffectPass>(); }

EffectList makeEffects(const std::vector<EffectCall>& calls) {
  EffectList effects;
  for (const EffectRow& row : effectTable()) {
    if (row.side != EffectSide::Client) continue;
    for (const EffectCall& call : calls) {
      if (call.kind != row.kind) continue;
      effects.push_back(kFactories[static_cast<std::size_t>(call.kind)](call));
      countConstruction("effect." + std::string(row.name));
    }
  }
  return effects;
}

std::vector<std::string> definesOf(const EffectList& effects) {
  std::vector<std::string> defines;
  for (const auto& effect : effects)
    if (!effect->define().empty()) defines.emplace_back(effect->define());
  return defines;
}

}  // namespace terrane
