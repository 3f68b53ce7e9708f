#pragma once
// Polynomials through the samples of a far field at a patch's nodes. Thread-safe.

#include "server/fields/far_expansion.h"
#include "server/fields/far_patch.h"

namespace terrane::lunar {

/// Node k of a patch, 0 <= k < kFarNodeCount.
constexpr double farNodeA(int k) noexcept { return kFarNodePlaces[k % kFarNodes]; }
constexpr double farNodeB(int k) noexcept { return kFarNodePlaces[k / kFarNodes]; }

/// From a block whose first kFarNodeCount samples are the patch's nodes in order, evaluated. Coefficients are those of
/// the Chebyshev interpolant of the nodes (Trefethen, "Approximation Theory and Approximation Practice", chapter 4)
/// without the terms above each polynomial's degree.
void fitExpansion(const FarPatch& patch, const Block& nodes, FarExpansion& out) noexcept;

}  // namespace terrane::lunar
