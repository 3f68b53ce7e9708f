// Body -> field: the only place that constructs one.

#include "server/fields/lunar_field.h"
#include "server/fields/midpoint_field.h"
#include "server/fields/sphere_field.h"

namespace terrane {

Result<void> checkHeightField(const Body& body) {
  return body.field == FieldKind::Midpoint ? MidpointField::check(body) : Result<void>();
}

std::unique_ptr<const HeightField> makeHeightField(const Body& body, SimdPath simd) {
  countConstruction("field." + std::string(fieldRow(body.field).name));
  switch (body.field) {
    case FieldKind::Lunar:
      return std::make_unique<LunarField>(body, simd);
    case FieldKind::Midpoint:
      return std::make_unique<MidpointField>(body);
    case FieldKind::Sphere:
      break;
  }
  return std::make_unique<SphereField>();
}

}  // namespace terrane
