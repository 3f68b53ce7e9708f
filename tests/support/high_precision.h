#pragma once
// MPFR's arithmetic, what double and float are compared with. Correctly rounded, so the same on every machine.

#include <boost/multiprecision/mpfr.hpp>

namespace terrane::test {

/// 60 digits, 200 bits: sums and products of pairs of doubles are exact, all else as good as.
using HighPrecision =
    boost::multiprecision::number<boost::multiprecision::mpfr_float_backend<60, boost::multiprecision::allocate_stack>,
                                  boost::multiprecision::et_off>;

}  // namespace terrane::test
