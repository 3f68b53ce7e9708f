#pragma once
// Bodies as the tests of fields and of whole tiles build them: fixed here, so that a change of a shipped scene changes
// no golden hash.

#include <cstdint>

#include "common/scene/scene.h"
#include "common/tiling/cube_sphere.h"
#include "common/tiling/lattice.h"
#include "common/tiling/tile_bounds.h"
#include "common/view/tile_selection.h"

namespace terrane {

inline Body testBody(FieldKind field, double radiusMeters, std::uint64_t seed = 1969) {
  Body body;
  body.name = "moon";
  body.radiusMeters = radiusMeters;
  body.field = field;
  body.fieldParameters = defaultValues(fieldRow(field).parameters);
  body.seed = seed;
  return body;
}

inline constexpr double kMoonRadiusMeters = 1'737'400.0;

inline Body testMoon(std::uint64_t seed = 1969) { return testBody(FieldKind::Lunar, kMoonRadiusMeters, seed); }

/// The same body on tiles of another scheme.
inline Body tiledBy(Scheme scheme, Body body) {
  body.schemes = {scheme};
  return body;
}

/// The Moon as selection sees it, with errors of 0.4 cells of 64, as the lunar field's are.
inline SelectionBody selectionMoon(int maxLevel, const HeightRange& heights, Scheme scheme = Scheme::Cube) {
  SelectionBody body;
  body.scheme = scheme;
  body.radiusMeters = kMoonRadiusMeters;
  body.maxLevel = maxLevel;
  body.heights = heights;
  body.occluderRadiusMeters = lowestSurfaceRadiusMeters(kMoonRadiusMeters, heights.minMeters, 64, scheme);
  for (int level = 0; level <= maxLevel; ++level)
    body.geometricErrorMeters.push_back(0.4 / 64 * nominalTileWidthMeters(kMoonRadiusMeters, level, scheme));
  return body;
}

}  // namespace terrane
