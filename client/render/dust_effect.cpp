// Grains on the ground (client/render/dust_pass.h).

#include <algorithm>

#include "client/render/dust_pass.h"
#include "client/render/effect_factories.h"

namespace terrane {
namespace {

class DustEffect final : public Effect {
 public:
  explicit DustEffect(const EffectCall& call) {
    settings_.cover = effectSetting(call, "cover");
    settings_.smallestMeters = effectSetting(call, "smallest");
    settings_.largestMeters = std::max(effectSetting(call, "largest"), settings_.smallestMeters);
  }

  Result<std::unique_ptr<EffectPass>> makePass(const PassContext& context) const override {
    return makeDustPass(settings_, context);
  }

 private:
  DustSettings settings_;
};

}  // namespace

std::unique_ptr<const Effect> makeDustEffect(const EffectCall& call) { return std::make_unique<DustEffect>(call); }

}  // namespace terrane
