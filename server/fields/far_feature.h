#pragma once
// How far features and landmarks are over a patch of ground from the polynomial of degree 5 that stands for them there
// (far_field.h). None can where the distance from the middle of a feature, at which its outline has no direction, is
// less than some radii of the patch's ball, or where a joint of its profile (floor, wall, crest, apron, end) crosses
// the patch: the third derivative jumps there. Decided by enclosures, so never wrongly. Elsewhere a polynomial of
// degree 5 misses the sixth power first:
//   error <= constant height (kFarFeatureRadii radius / distance)^6,
// for the ejecta, of the rim's height, and for all else of the depth. far_field_test searches for the worst.
// Body frame, metres. Thread-safe.

#include "server/fields/feature_target.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {

/// In radii of the patch's ball: how far its middle must be from a feature's.
inline constexpr double kFarFeatureRadii = 6;
inline constexpr double kFarEjectaError = 2.5e-5, kFarBowlError = 3e-4;
/// Of a basin and of a lava patch, whose ramp may be narrow: the distance is the radius.
inline constexpr double kFarBasinError = 0.025, kFarLavaError = 1;

/// A feature of a smaller radius has a joint or its middle within reach of nearly every patch it touches.
inline constexpr double kLeastFarFeatureRadii = 3;

/// Bounds in metres of height; infinite where no polynomial will do. Of the program counts what it asks of a feature's
/// profile: joints are rounded to the footprint, and what is shown in part is not far.
double farCraterError(const Feature& crater, const Program& program, const Ball& patch) noexcept;
double farBasinError(const Basin& basin, const Ball& patch) noexcept;
/// What a crater, shown in whole or in part, adds to heights on the patch lies between these and 0, metres.
struct HeightSpan {
  double low = 0, high = 0;
};
HeightSpan craterSpan(const Feature& crater, const Program& program, const Ball& patch) noexcept;

/// heightMeters: from the lava's lowest level to its full one.
double farLavaPatchError(const LavaPatch& lava, double heightMeters, const Ball& patch) noexcept;

/// Brightness alone, of which eight bits are seen: no bound.
bool isFarHalo(const Halo& halo, const Ball& patch) noexcept;

}  // namespace terrane::lunar
