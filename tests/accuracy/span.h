#pragma once

#include <limits>
#include <string>

namespace terrane::accuracy {

/// The least and the most of what was included, for findings over several views.
class Span {
 public:
  void include(double value);
  double most() const { return most_; }
  /// "1.2 to 3.4", or one figure where both would be written alike.
  std::string text() const;

 private:
  double least_ = std::numeric_limits<double>::infinity(), most_ = -std::numeric_limits<double>::infinity();
};

}  // namespace terrane::accuracy
