#pragma once
// The revision of a body: a hash of all that shapes its tiles' bytes, and of nothing else. It is part of every tile
// URL, so a tile under one revision never changes, and what does not touch a body (the sun, another body) never makes
// its tiles stale. Thread-safe.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "common/scene/scene.h"
#include "server/build/tile_builder.h"

namespace terrane {

/// 16 hex digits (XXH3, 64 bits). fieldIdentity: HeightField::identity(). probe: the bytes of one tile as this process
/// encodes it. They stand for the version of Draco that is linked, whose number alone would not tell two builds of it
/// apart.
std::string tileRevision(const Body& body, std::string_view fieldIdentity, const WireSettings& wire,
                         std::span<const std::uint8_t> probe);

}  // namespace terrane
