#include "client/render/transition.h"

#include <fmt/format.h>

#include <array>

namespace terrane {
namespace {

/// In the enumeration's order.
constexpr std::array<std::string_view, kTransitionCount> kNames{"morph", "blend", "none"};

}  // namespace

std::string_view transitionName(Transition transition) noexcept { return kNames[static_cast<std::size_t>(transition)]; }

Result<Transition> parseTransition(std::string_view text) {
  for (std::size_t i = 0; i < kNames.size(); ++i)
    if (kNames[i] == text) return static_cast<Transition>(i);
  return makeError(ErrorKind::InvalidArgument, "--transition", fmt::format("'{}' is none of morph, blend, none", text));
}

}  // namespace terrane
