#pragma once
// One descent in both schemes: what each fetches, and how far what it draws is from the ground, in the same points of
// the same pictures.

#include <array>
#include <optional>

#include "server/fields/height_field.h"
#include "tests/accuracy/projection/descent.h"

namespace terrane::accuracy {

/// Index 0: what tiles of the cube do; 1: those of the icosahedron.
inline constexpr std::size_t kSchemes = 2;
/// The default, and once more coarser by half a level: how bytes and error go together.
inline constexpr std::array<double, 2> kErrorPixels{2, 2 * 1.4142135623730951};

struct Outcome {
  Amounts fetched;  ///< distinct tiles of all cameras: those drawn and those above them
  double errorPixelsSum = 0, worstErrorPixels = 0;
  std::int64_t points = 0;  ///< of pictures where both schemes draw ground

  double meanErrorPixels() const { return errorPixelsSum / static_cast<double>(points); }
  Outcome& operator+=(const Outcome& other);
};

struct SchemeOutcomes {
  /// By kErrorPixels, then by scheme.
  std::array<std::array<Outcome, kSchemes>, kErrorPixels.size()> byError;

  SchemeOutcomes& operator+=(const SchemeOutcomes& other);
};

/// Forgets the sources' tiles at the end. The error of a point is how far the mesh lies above or below the finest
/// ground there, as the camera sees it, in pixels.
SchemeOutcomes compareDescents(const std::vector<Camera>& cameras, const HeightField& moon,
                               const std::array<DescentTiles*, kSchemes>& sources);

/// Bytes that a scheme would need for another mean error, from the two that were measured: bytes fall as a power of the
/// error. Empty where few cameras do not say it: the coarser of the two did not draw worse with fewer bytes, or the
/// other error lies further from the finer than the coarser does.
std::optional<double> bytesForError(const SchemeOutcomes& outcomes, std::size_t scheme, double meanErrorPixels);

}  // namespace terrane::accuracy
