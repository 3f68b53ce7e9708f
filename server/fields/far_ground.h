#pragma once
// Patches of ground that are not mixed: over all of one, either land or lava is on top by more than the blend of the
// two, the regolith is calmed alike, and no height is near the clamp. There the field is a sum, so that its far part
// needs half as many polynomials, and what is under lava need not be evaluated. Decided by enclosures of the
// polynomials and by bounds of what is near, so never wrongly. Thread-safe.

#include "server/fields/far_expansion.h"
#include "server/fields/feature_target.h"
#include "server/fields/lunar_program.h"

namespace terrane::lunar {

/// Finds out what ground an expansion is of, and makes it one of that; it stays as it is where that is mixed. near:
/// what is left to be added to it at its tile's level. The expansion then holds for the edges of the levels beside it
/// too, of which the finer must show no more relief and old craters than this one. Precondition: the ground is Mixed,
/// as fitExpansion leaves it.
void simplifyGround(const Program& near, const Ball& patch, FarExpansion& expansion) noexcept;

}  // namespace terrane::lunar
