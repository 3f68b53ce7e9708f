#pragma once

#include <stdexcept>
#include <utility>

#include "common/result.h"

namespace terrane {

/// What a test cannot do without. Throws std::runtime_error with the error's text.
template <class T>
T require(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text());
  return std::move(*result);
}

}  // namespace terrane
