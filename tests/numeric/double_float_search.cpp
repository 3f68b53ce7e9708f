#include "tests/numeric/double_float_search.h"

#include <iostream>

namespace terrane::test {

Operands::Operands(std::uint64_t seed) : DoubleFloatOperands(seed) { std::cout << "seed " << seed << '\n'; }

}  // namespace terrane::test
