// Sunlight from the direction of the subsolar point (client/shaders/sun.glsl).

#include <cmath>

#include "client/render/effect_factories.h"

namespace terrane {
namespace {

/// A setting, or the table's default where a scene was made by hand.
double setting(const ParameterValues& values, std::string_view name) {
  if (const auto found = values.find(name); found != values.end()) return found->second;
  for (const ParameterSpec& spec : effectRow(EffectKind::Sun).parameters)
    if (spec.name == name) return spec.defaultValue;
  return 0;
}

class SunEffect final : public Effect {
 public:
  explicit SunEffect(const ParameterValues& values) : ambient_(static_cast<float>(setting(values, "ambient"))) {
    const double longitude = setting(values, "longitude"), latitude = setting(values, "latitude");
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

std::unique_ptr<const Effect> makeSunEffect(const ParameterValues& parameters) {
  return std::make_unique<SunEffect>(parameters);
}

}  // namespace terrane
