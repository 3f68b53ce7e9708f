#pragma once
// Bodies as the tests of whole tiles build them: fixed here, so that a change of a shipped scene changes no golden
// hash.

#include "common/scene/scene.h"

namespace terrane {

inline Body testBody(FieldKind field, double radiusMeters) {
  Body body;
  body.name = "moon";
  body.radiusMeters = radiusMeters;
  body.field = field;
  body.fieldParameters = defaultValues(fieldRow(field).parameters);
  body.seed = 1969;
  return body;
}

inline Body testMoon() { return testBody(FieldKind::Lunar, 1'737'400.0); }

}  // namespace terrane
