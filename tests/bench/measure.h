#pragma once
// What benchmarks measure with. Thread-safe.

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace terrane::bench {

/// Of the thread's own processor time: what else the machine does shows little.
inline double threadMs() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

template <class Work>
double milliseconds(Work&& work) {
  const double begin = threadMs();
  work();
  return threadMs() - begin;
}

/// Precondition: not empty.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace terrane::bench
