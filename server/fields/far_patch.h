#pragma once
// The patch of ground that a far field is expanded over: a rectangle in the plane that touches the sphere in the middle
// of a tile's samples, and what lies above it on the sphere. Body frame, metres. Thread-safe.

#include <cstddef>

#include "server/fields/feature_target.h"

namespace terrane::lunar {

/// Along an axis of a patch its expansion is fitted at this many Chebyshev nodes.
inline constexpr int kFarNodes = 6, kFarNodeCount = kFarNodes * kFarNodes;
/// cos((2 k + 1) pi / 12), from -1 up.
inline constexpr double kFarNodePlaces[kFarNodes] = {-0.9659258262890683, -0.7071067811865476, -0.25881904510252074,
                                                     0.25881904510252074, 0.7071067811865476,  0.9659258262890683};

struct FarPatch {
  double radiusMeters = 0;                          ///< of the sphere
  double origin[3] = {};                            ///< in the plane: the rectangle's middle
  double axisA[3] = {}, axisB[3] = {}, up[3] = {};  ///< orthonormal
  double halfA = 0, halfB = 0;                      ///< metres
  double offsetA = 0, offsetB = 0;                  ///< metres from where the plane touches the sphere to the origin
  Ball ball;                                        ///< around all of the patch
  double sag = 0;                                   ///< metres: how far below the plane its points may be

  /// On the sphere, above a halfA along axisA and b halfB along axisB from the origin.
  void pointAt(double a, double b, double out[3]) const noexcept;
};

/// Around points of a sphere, one and those rowLength - 1 further on along about a straight line. They should span less
/// than a radian. Precondition: rowLength >= 2, points.count >= rowLength.
FarPatch patchAround(const PointSet& points, std::size_t rowLength, double radiusMeters) noexcept;

}  // namespace terrane::lunar
