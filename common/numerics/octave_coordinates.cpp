#include "common/numerics/octave_coordinates.h"

#include <cmath>
#include <cstdint>

namespace terrane {

OctaveCoordinates octaveCoordinates(const glm::dvec3& positionBody, int exponent) noexcept {
  OctaveCoordinates coordinates;
  for (int axis = 0; axis < 3; ++axis) {
    const double wavelengths = std::ldexp(positionBody[axis], -exponent);
    if (!std::isfinite(wavelengths)) continue;
    const double whole = std::floor(wavelengths);
    // Exact: the remainder of whole numbers, and a difference that only drops leading bits.
    const auto wrapped = static_cast<std::int64_t>(std::fmod(whole, 0x1p32));
    coordinates.cell[axis] = static_cast<std::int32_t>(static_cast<std::uint32_t>(wrapped));
    coordinates.rest[axis] = static_cast<float>(wavelengths - whole);
  }
  return coordinates;
}

}  // namespace terrane
