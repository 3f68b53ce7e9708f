#include "server/fields/sphere_field.h"

#include "common/numerics/strict_math.h"

namespace terrane {

void SphereField::evaluate(const SampleBatch& batch, double, SurfaceSamples& out) const {
  out.heightMeters.assign(batch.count(), 0.0);
  out.gradientX.assign(batch.count(), 0.0f);
  out.gradientY.assign(batch.count(), 0.0f);
  out.gradientZ.assign(batch.count(), 0.0f);
  out.reflectance.clear();
}

}  // namespace terrane
