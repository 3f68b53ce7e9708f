// parseTarget: whatever is accepted as a tile prints to a target that reads back as the same tile.

#include <string_view>

#include "proto/tile_url.h"
#include "tests/fuzz/sound_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto route = terrane::parseTarget({reinterpret_cast<const char*>(data), size});
  if (!route) return 0;
  if (const auto* tile = std::get_if<terrane::TileAddress>(&*route)) {
    const auto again = terrane::parseTarget(terrane::tileTarget(*tile));
    terrane::fuzz::require(again.has_value());
    const auto& back = std::get<terrane::TileAddress>(*again);
    terrane::fuzz::require(back.path == tile->path && back.body == tile->body && back.revision == tile->revision);
  }
  return 0;
}
