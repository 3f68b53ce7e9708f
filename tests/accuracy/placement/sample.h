#pragma once
// Vertices around a camera that is far from the origin, in integers, so that the truth of any place is exact: what
// placement experiments share.

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "common/numerics/double_float3.h"

namespace terrane::accuracy {

/// True positions are whole units of 2^-20 m: exact at 1 mm and, in 64 bits, up to 58 AU.
using Units = std::int64_t;
inline constexpr double kUnitMeters = 0x1p-20;
/// Vertices lie on a lattice of 2^-10 m, as terrain tiles do; a camera lies anywhere.
inline constexpr Units kLatticeUnits = 1 << 10;
inline constexpr double kLatticeMeters = 0x1p-10;

using UnitPoint = std::array<Units, 3>;

/// A point that is on no lattice: units, and a rest of 0 .. 1 unit with 30 bits.
struct FinePoint {
  UnitPoint units{};
  glm::dvec3 restUnits{0.0};
};

struct Sample {
  FinePoint camera;
  std::vector<UnitPoint> vertices;
};

/// Vertices are this far from the camera, and pixels those of a picture of 720 lines and 60 degrees.
inline constexpr double kDistanceMeters = 2.0;
double pixelsOf(double meters);

/// A camera that far from the origin in a direction of its own, vertices around it.
Sample makeSample(double metersFromOrigin, std::uint64_t seed, std::size_t vertices);

/// Cameras for the worst of a place: what a camera's own rounding does depends on where exactly it stands. One in four
/// has moved to where a scheme is at its worst: the border of a tile, of a multiple of 65536 m, or between two floats.
inline constexpr int kCameras = 128;
Sample makeSampleOf(double metersFromOrigin, std::uint64_t seed, int camera, std::size_t vertices);
/// Moves a sample, camera and vertices, along all axes to where floats that far out have their next border.
void moveBetweenFloats(Sample& sample);

struct Place {
  const char* name;
  double meters;
};
inline constexpr std::array<Place, 8> kPlaces{{{"1 mm", 1e-3},
                                               {"1 m", 1},
                                               {"1 km", 1e3},
                                               {"the Moon's radius", 1.7374e6},
                                               {"the Earth's radius", 6.371e6},
                                               {"the Moon's orbit", 3.844e8},
                                               {"1 AU", 1.495978707e11},
                                               {"30 AU", 30 * 1.495978707e11}}};
inline constexpr std::size_t kMoonsRadius = 3;  ///< in kPlaces

/// Each the nearest that the type holds, metres.
glm::vec3 floatsOf(const FinePoint& point);
glm::dvec3 doublesOf(const FinePoint& point);
DoubleFloat3 pairsOf(const FinePoint& point);
/// Cesium's encoding: multiples of 65536 m, towards 0, and the rest.
DoubleFloat3 splitOf(const FinePoint& point);

/// Vertex minus camera, metres: exact while they are within 4 m of each other.
glm::dvec3 trueRelative(const UnitPoint& vertex, const FinePoint& camera);
/// Of a vertex placed relative to the camera.
double errorMeters(const glm::vec3& placed, const UnitPoint& vertex, const FinePoint& camera);

}  // namespace terrane::accuracy
