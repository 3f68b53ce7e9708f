#pragma once
// A position as the index of a tile and a float's offset from the tile's middle, per axis: what game engines call large
// world coordinates (Unreal 5: tiles of 2^21 m, later 2^18). Kept here to be measured beside the schemes that Terrane
// draws with, for it fails in two ways, both shown by tests/numeric and priced by terrane-accuracy:
//   falloff      the offset is a float: the nearer the tile's border, the coarser it is, u S / 2 there (0.06 m for 2^21
//                m), and without limit where offsets are added up and never regularised
//   oscillation  two positions close to each other on both sides of a border differ by one tile and by minus almost a
//                tile: taken by themselves (relativeByTilesAndOffsets) the offsets' difference is rounded as a number
//                of a tile's size, so that what is near jumps whenever the camera crosses a border. relativeByHalves
//                subtracts without that; the offsets' own rounding stays.
// S = tileMeters is a power of two; u = 2^-24. Thread-safe. What is not finite or out of reach: the offset is NaN, the
// tile 0.

#include <glm/ext/vector_int3_sized.hpp>
#include <glm/vec3.hpp>

#include "common/numerics/strict_math.h"

namespace terrane {

struct TiledPosition {
  glm::ivec3 tile{0};
  glm::vec3 offsetMeters{0.0f};  ///< from the tile's middle; +-S/2 when regular
};

/// Within tiledPositionBound. Reaches to +-(2^31 - 1) S.
TiledPosition tiledFromDouble(const glm::dvec3& meters, float tileMeters) noexcept;
/// Exact where 53 bits suffice.
glm::dvec3 toDouble(const TiledPosition& position, float tileMeters) noexcept;

/// The same position with every offset in +-S/2 (a half belongs to the higher tile): exact, since what is taken away is
/// a multiple of the offset's last bit. Offsets of 2^24 S and more have lost the place in the tile already.
TiledPosition regularised(const TiledPosition& position, float tileMeters) noexcept;

/// Moved by so much, and regularised; the sum of offset and way is rounded, by half an ulp of it.
TiledPosition moved(const TiledPosition& position, const glm::vec3& byMeters, float tileMeters) noexcept;

/// Metres, of a component: half an ulp of what lies just below S/2.
constexpr double tiledPositionBound(double tileMeters) noexcept { return 0x1p-26 * tileMeters; }

}  // namespace terrane
