// Body -> field: the only place that constructs one.

#include "server/fields/lunar_field.h"
#include "server/fields/sphere_field.h"

namespace terrane {

std::unique_ptr<const HeightField> makeHeightField(const Body& body, SimdPath simd) {
  countConstruction("field." + std::string(fieldRow(body.field).name));
  switch (body.field) {
    case FieldKind::Lunar:
      return std::make_unique<LunarField>(body, simd);
    case FieldKind::Sphere:
      break;
  }
  return std::make_unique<SphereField>();
}

}  // namespace terrane
