#pragma once
// The well-kept library of pairs of doubles (libqd) beside Terrane's pairs of floats: its operations' times and errors.

#include <cstdint>
#include <string_view>

#include "tests/accuracy/side_by_side.h"

namespace terrane::accuracy {

/// One of test::pairOperations() in libqd; empty where it has none (a result as float).
Work doubleDoubleWork(std::string_view operation);

/// The worst relative error of a random search, in units of u^2 = 2^-106; for sums, operands nearly cancel in a quarter
/// of the cases.
double doubleDoubleWorst(std::string_view operation, std::uint64_t seed, int samples);

}  // namespace terrane::accuracy
