#pragma once
// GL's state while tiles and what lies on them are drawn. GL thread only.

#include <cstdint>

#include "client/gl/capabilities.h"

namespace terrane {

/// Reversed depth test, back faces culled, nothing blended; and GL's defaults again afterwards (the HUD relies on
/// them).
class TilePass {
 public:
  enum class Start : std::uint8_t { Cleared, Kept };  ///< what is in the framebuffer
  TilePass(const gl::Capabilities& capabilities, bool wireframe, Start start = Start::Cleared);
  TilePass(const TilePass&) = delete;
  TilePass& operator=(const TilePass&) = delete;
  ~TilePass();

 private:
  bool clipControl_;
};

}  // namespace terrane
