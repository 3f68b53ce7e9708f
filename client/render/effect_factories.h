#pragma once
// Makes the client's effects: what a scene names, and nothing else. An effect adds a #define to the shaders that show
// the ground and sets their uniforms, or draws a pass of its own over the tiles (effect_pass.h), or both. To add one: a
// class in a file of its own, a row in effect_factories.cpp (a missing row does not compile). GL thread only.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "client/gl/shader_program.h"
#include "common/scene/effects.h"

namespace terrane {

class EffectPass;
struct PassContext;

class Effect {
 public:
  virtual ~Effect() = default;
  /// What shaders of the ground are compiled with ("EFFECT_SUN"); empty for none.
  virtual std::string_view define() const noexcept { return {}; }
  /// Of the program in use, once a pass.
  virtual void setUniforms(const gl::Program&) const {}
  /// What it draws over the tiles; null: nothing. Errors: Unsupported ("shader").
  virtual Result<std::unique_ptr<EffectPass>> makePass(const PassContext& context) const;
};
using EffectList = std::vector<std::unique_ptr<const Effect>>;

/// In the order of the table, whatever the scene's; each is counted ("effect.sun"). Server-side effects are skipped.
EffectList makeEffects(const std::vector<EffectCall>& calls);
/// The defines of all.
std::vector<std::string> definesOf(const EffectList& effects);

std::unique_ptr<const Effect> makeSunEffect(const EffectCall& call);
std::unique_ptr<const Effect> makeDetailEffect(const EffectCall& call);
std::unique_ptr<const Effect> makeDustEffect(const EffectCall& call);

}  // namespace terrane
