#pragma once
// Makes the client's effects: what a scene names, and nothing else. An effect adds a #define to the shaded tile shader
// and sets its uniforms. To add one: a class in a file of its own, a row in effect_factories.cpp (a missing row does
// not compile). GL thread only.

#include <memory>
#include <string_view>
#include <vector>

#include "client/gl/shader_program.h"
#include "common/scene/effects.h"

namespace terrane {

class Effect {
 public:
  virtual ~Effect() = default;
  /// What the shader is compiled with ("EFFECT_SUN").
  virtual std::string_view define() const noexcept = 0;
  /// Of the program in use, once a pass.
  virtual void setUniforms(const gl::Program& program) const = 0;
};

/// In the order given; each is counted ("effect.sun"). Server-side effects are skipped.
std::vector<std::unique_ptr<const Effect>> makeEffects(const std::vector<EffectCall>& calls);

std::unique_ptr<const Effect> makeSunEffect(const ParameterValues& parameters);

}  // namespace terrane
