// Texture without end: relief and reflectance below the mesh (client/shaders/detail.frag.glsl).

#include <cmath>

#include "client/render/detail_pass.h"
#include "client/render/effect_factories.h"

namespace terrane {
namespace {

class DetailEffect final : public Effect {
 public:
  explicit DetailEffect(const EffectCall& call) {
    const double relief = effectSetting(call, "relief"), hurst = effectSetting(call, "hurst");
    for (int octave = 0; octave < kDetailOctaves; ++octave) {
      const auto at = static_cast<std::size_t>(octave);
      strength_.slopes[at] = static_cast<float>(relief * std::exp2((hurst - 1) * (kFinestDetailExponent + octave)));
      strength_.mottles[at] = static_cast<float>(effectSetting(call, "mottle"));
    }
  }

  Result<std::unique_ptr<EffectPass>> makePass(const PassContext& context) const override {
    return makeDetailPass(strength_, context);
  }

 private:
  DetailStrength strength_;
};

}  // namespace

std::unique_ptr<const Effect> makeDetailEffect(const EffectCall& call) { return std::make_unique<DetailEffect>(call); }

}  // namespace terrane
