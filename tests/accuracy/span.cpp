#include "tests/accuracy/span.h"

#include <fmt/format.h>

#include <algorithm>

namespace terrane::accuracy {

void Span::include(double value) {
  least_ = std::min(least_, value);
  most_ = std::max(most_, value);
}

std::string Span::text() const {
  const std::string least = fmt::format("{:.3g}", least_), most = fmt::format("{:.3g}", most_);
  return least == most ? most : least + " to " + most;
}

}  // namespace terrane::accuracy
