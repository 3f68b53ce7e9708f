#pragma once
// The tile of a level that is under a direction, and where in it that falls, for both schemes. Body frame. Thread-safe.

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "common/tiling/face_path.h"

namespace terrane {

/// direction: any finite non-zero vector. Of a level, its tile is the ancestor of any finer level's. Ties between tiles
/// of a cube's face go to the greater column and row; an ico tile may end kIcoTileAtError radians short of it
/// (ico_sphere.h). Precondition: 0 <= level <= FacePath::kMaxLevel.
FacePath tileAt(Scheme scheme, const glm::dvec3& direction, int level) noexcept;

/// Where in a tile under it a direction falls: 0..1 along u and v; of an ico tile its weights at corners 1 and 2, on
/// the plane of its corners, which on a coarse tile is some cells from where the grid's map puts it.
glm::dvec2 placeInTile(const FacePath& tile, const glm::dvec3& direction) noexcept;

}  // namespace terrane
