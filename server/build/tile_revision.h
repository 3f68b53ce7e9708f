#pragma once
// The revision of a body: a hash of all that shapes its tiles' bytes, and of nothing else. It is part of every tile URL, so a tile
// under one revision never changes, and what does not touch a body (the sun, another body) never makes its tiles stale. Thread-safe.

#include <string>
#include <string_view>

#include "common/scene/scene.h"
#include "server/build/tile_builder.h"

namespace terrane {

/// 16 hex digits (XXH3, 64 bits). fieldIdentity: HeightField::identity(); dracoVersion: of the encoder.
std::string tileRevision(const Body& body, std::string_view fieldIdentity, const WireSettings& wire,
                         std::string_view dracoVersion);

}  // namespace terrane
