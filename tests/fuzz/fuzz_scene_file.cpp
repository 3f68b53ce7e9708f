// Any bytes as a scene file: a scene or one error that names file and key.

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "server/scenes/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scene = terrane::parseScene({reinterpret_cast<const char*>(data), size}, "fuzz.toml");
  if (!scene && scene.error().message.empty()) std::abort();
  return 0;
}
