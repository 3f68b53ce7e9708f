#include "tests/accuracy/side_by_side.h"

#include <algorithm>
#include <chrono>

namespace terrane::accuracy {

std::vector<double> nanosecondsPerItem(const std::vector<Work>& ways, std::size_t count, int rounds) {
  static volatile double sink = 0;
  std::vector<std::vector<double>> times(ways.size());
  for (int round = 0; round <= rounds; ++round) {  // the first warms up
    for (std::size_t way = 0; way < ways.size(); ++way) {
      const auto start = std::chrono::steady_clock::now();
      sink = sink + ways[way](count);
      const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - start;
      if (round > 0) times[way].push_back(took.count() / static_cast<double>(count));
    }
  }
  std::vector<double> medians;
  for (auto& samples : times) {
    const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
    std::ranges::nth_element(samples, middle);
    medians.push_back(*middle);
  }
  return medians;
}

}  // namespace terrane::accuracy
