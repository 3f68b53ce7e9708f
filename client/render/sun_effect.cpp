// Sunlight from the direction of the subsolar point (client/shaders/sun.glsl).

#include <cmath>

#include "client/render/effect_factories.h"

namespace terrane {
namespace {

class SunEffect final : public Effect {
 public:
  explicit SunEffect(const EffectCall& call) : ambient_(static_cast<float>(effectSetting(call, "ambient"))) {
    const double longitude = effectSetting(call, "longitude"), latitude = effectSetting(call, "latitude");
    towardsSun_ = glm::vec3(std::cos(latitude) * std::cos(longitude), std::cos(latitude) * std::sin(longitude),
                            std::sin(latitude));
  }

  std::string_view define() const noexcept override { return "EFFECT_SUN"; }

  void setUniforms(const gl::Program& program) const override {
    setUniform(program.uniform("towardsSun"), towardsSun_);
    setUniform(program.uniform("ambient"), ambient_);
  }

 private:
  glm::vec3 towardsSun_{1, 0, 0};
  float ambient_ = 0;
};

}  // namespace

std::unique_ptr<const Effect> makeSunEffect(const EffectCall& call) { return std::make_unique<SunEffect>(call); }

}  // namespace terrane
