#pragma once
// Bodies as the tests of fields and of whole tiles build them: fixed here, so that a change of a shipped scene changes
// no golden hash.

#include <cstdint>

#include "common/scene/scene.h"

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

inline Body testMoon(std::uint64_t seed = 1969) { return testBody(FieldKind::Lunar, 1'737'400.0, seed); }

}  // namespace terrane
