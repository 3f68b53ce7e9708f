#include "client/app/run_statistics.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace terrane {

void FrameTimes::add(double milliseconds) {
  const auto value = static_cast<float>(milliseconds);
  if (kept_.size() < kKept)
    kept_.push_back(value);
  else
    kept_[count_ % kKept] = value;
  ++count_;
  longest_ = std::max(longest_, milliseconds);
}

double FrameTimes::percentile(double share) const {
  if (kept_.empty()) return 0;
  std::vector<float> sorted = kept_;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(std::clamp<std::size_t>(rank, 1, sorted.size()) - 1);
  std::nth_element(sorted.begin(), at, sorted.end());
  return static_cast<double>(*at);
}

std::vector<float> FrameTimes::last(std::size_t n) const {
  const std::size_t count = std::min(n, kept_.size());
  std::vector<float> result(count);
  for (std::size_t i = 0; i < count; ++i) result[i] = kept_[(count_ - count + i) % kKept];
  return result;
}

Result<std::size_t> writeTextFile(const std::string& text, const std::string& file, const std::string& flag) {
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream << text;
  stream.close();
  if (!stream) return makeError(ErrorKind::Io, flag, "cannot write \"" + file + "\"");
  return text.size();
}

std::uint64_t residentSetBytes() {
  std::ifstream statm("/proc/self/statm");
  std::uint64_t size = 0, resident = 0;
  if (!(statm >> size >> resident)) return 0;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace terrane
