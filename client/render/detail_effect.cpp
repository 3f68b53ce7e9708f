// Texture without end: relief and reflectance below the mesh (client/shaders/detail.frag.glsl).

#include <algorithm>
#include <cmath>

#include "client/render/detail_pass.h"
#include "client/render/effect_factories.h"

namespace terrane {
namespace {

class DetailEffect final : public Effect {
 public:
  explicit DetailEffect(const EffectCall& call) {
    // The Moon's own slopes fall like this (Rosenburg et al. 2011, from LOLA: a Hurst exponent of 0.76 over maria), and
    // the longer waves are the mesh' business.
    const double relief = effectSetting(call, "relief"), hurst = effectSetting(call, "hurst");
    const double mottle = effectSetting(call, "mottle");
    for (int octave = 0; octave < kDetailOctaves; ++octave) {
      const auto at = static_cast<std::size_t>(octave);
      const double share = std::exp2((hurst - 1) * std::max(0, kFinestDetailExponent + octave));
      strength_.slopes[at] = static_cast<float>(relief * share);
      strength_.mottles[at] = static_cast<float>(mottle * share);
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
