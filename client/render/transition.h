#pragma once
// How a change of level is shown. Thread-safe.

#include <cstdint>
#include <string_view>

#include "common/result.h"

namespace terrane {

enum class Transition : std::uint8_t {
  Morph,  ///< vertices move between a tile's own surface and its parent's: closed without skirts, each pixel drawn once
  Blend,  ///< both surfaces are drawn and mixed by alpha, for comparison: twice the work, and skirts on both
  None,   ///< at once, with skirts: it pops
};
inline constexpr int kTransitionCount = 3;

std::string_view transitionName(Transition transition) noexcept;
/// Errors name "--transition" and list what is allowed.
Result<Transition> parseTransition(std::string_view text);

}  // namespace terrane
