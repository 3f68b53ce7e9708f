#pragma once
// Makes the client's effects: what a scene names, and nothing else. An effect adds a #define to the shaders that show
// the ground and sets their uniforms, or draws in a pass of its own after the tiles, or both. To add one: a class in a
// file of its own, a row in effect_factories.cpp (a missing row does not compile). GL thread only.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "client/gl/shader_program.h"
#include "common/scene/effects.h"
#include "common/view/camera.h"

namespace terrane {

class Effect;
class RenderTarget;
using EffectList = std::vector<std::unique_ptr<const Effect>>;

/// A picture of the ground that is not finished yet.
struct GroundPicture {
  const Camera& camera;
  const RenderTarget& target;  ///< of the camera's size; holds the tiles' colour and depth
  const EffectList& effects;
};

class EffectPass {
 public:
  virtual ~EffectPass() = default;
  /// Leaves the target bound, and GL's defaults.
  virtual void draw(const GroundPicture& picture) = 0;
};

class Effect {
 public:
  virtual ~Effect() = default;
  /// What shaders of the ground are compiled with ("EFFECT_SUN"); empty for none.
  virtual std::string_view define() const noexcept { return {}; }
  /// Of the program in use, once a pass.
  virtual void setUniforms(const gl::Program&) const {}
  /// What it draws after the tiles; null: nothing. all: the effects it is drawn with, itself among them. Errors:
  /// Unsupported ("shader").
  virtual Result<std::unique_ptr<EffectPass>> makePass(const EffectList& /*all*/,
                                                       const gl::Capabilities& /*capabilities*/) const {
    return std::unique_ptr<EffectPass>();
  }
};

/// In the order of the table, whatever the scene's; each is counted ("effect.sun"). Server-side effects are skipped.
EffectList makeEffects(const std::vector<EffectCall>& calls);
/// The defines of all.
std::vector<std::string> definesOf(const EffectList& effects);

std::unique_ptr<const Effect> makeSunEffect(const EffectCall& call);
std::unique_ptr<const Effect> makeDetailEffect(const EffectCall& call);

}  // namespace terrane
