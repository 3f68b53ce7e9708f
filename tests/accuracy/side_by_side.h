#pragma once
// Times of several ways of doing the same, taken in turn so that what else the machine does falls on all alike.

#include <cstddef>
#include <functional>
#include <vector>

namespace terrane::accuracy {

/// Works through `count` items and returns anything that depends on all of them, so that no work is dropped.
using Work = std::function<double(std::size_t count)>;

/// Median nanoseconds an item, in the order of `ways`.
std::vector<double> nanosecondsPerItem(const std::vector<Work>& ways, std::size_t count, int rounds);

}  // namespace terrane::accuracy
