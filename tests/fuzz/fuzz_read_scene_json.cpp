// readSceneJson: whatever is accepted writes to a document that reads back and writes the same again.

#include <string_view>

#include "proto/scene_json.h"
#include "tests/fuzz/sound_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto scene = terrane::readSceneJson({reinterpret_cast<const char*>(data), size});
  if (!scene) return 0;
  const std::string text = terrane::writeSceneJson(*scene);
  const auto again = terrane::readSceneJson(text);
  terrane::fuzz::require(again.has_value() && terrane::writeSceneJson(*again) == text);
  return 0;
}
