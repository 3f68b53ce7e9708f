#pragma once
// The scene files of server/scenes/, built into the program so that it needs no file beside it. The list is generated
// (shipped_scenes.cpp.in). Thread-safe.

#include <span>
#include <string_view>

namespace terrane {

struct ShippedScene {
  std::string_view name;
  std::string_view toml;
};
std::span<const ShippedScene> shippedSceneTexts() noexcept;

}  // namespace terrane
