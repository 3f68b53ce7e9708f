#include "proto/symbol_probabilities.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <utility>

#include "common/numerics/strict_math.h"

namespace terrane {
namespace {

/// Probabilities below it are sorted by counting. At most 2^20 / kSmall others exist.
constexpr std::uint32_t kSmall = 2048;
constexpr double kHalf = 0.5;  ///< added before cutting, as libdraco rounds

}  // namespace

void ProbabilityScaler::orderByProbability(std::span<const std::uint32_t> probabilities) {
  buckets_.assign(kSmall + 1, 0);
  large_.clear();
  for (std::size_t i = 0; i < probabilities.size(); ++i) {
    if (probabilities[i] < kSmall)
      ++buckets_[probabilities[i]];
    else
      large_.push_back((static_cast<std::uint64_t>(probabilities[i]) << 32) | i);
  }
  std::ranges::sort(large_, std::greater<>());
  order_.resize(probabilities.size());
  std::ranges::transform(large_, order_.begin(), [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
  auto begin = static_cast<std::uint32_t>(large_.size());
  for (std::uint32_t p = kSmall; p-- > 0;) begin += std::exchange(buckets_[p], begin);
  for (std::size_t i = probabilities.size(); i-- > 0;)
    if (probabilities[i] < kSmall) order_[buckets_[probabilities[i]]++] = static_cast<std::uint32_t>(i);
}

void ProbabilityScaler::scale(std::span<const std::uint32_t> frequencies, bool wholeAlphabet, int precisionBits,
                              std::span<std::uint32_t> probabilities) {
  const std::int64_t precision = std::int64_t{1} << precisionBits;
  const auto sum = static_cast<double>(std::accumulate(frequencies.begin(), frequencies.end(), std::uint64_t{0}));
  std::int64_t total = 0;
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    const double share = static_cast<double>(frequencies[i]) / sum;
    probabilities[i] = std::max(1u, static_cast<std::uint32_t>(share * static_cast<double>(precision) + kHalf));
    total += probabilities[i];
  }
  if (total == precision) return;
  if (total < precision) {  // the last of the most frequent takes what is left
    const auto greatest = std::max_element(probabilities.rbegin(), probabilities.rend());
    *greatest += static_cast<std::uint32_t>(precision - total);
    return;
  }
  orderByProbability(probabilities);
  // libdraco leaves out the first of its whole alphabet, sorted; where a symbol is missing, that one is it.
  const std::size_t reducible = order_.size() - (wholeAlphabet ? 1 : 0);
  std::int64_t excess = total - precision;
  while (excess > 0) {
    const double scale = static_cast<double>(precision) / static_cast<double>(precision + excess);
    for (std::size_t k = 0; k < reducible && excess > 0; ++k) {
      std::uint32_t& probability = probabilities[order_[k]];
      if (probability <= 1) break;
      const auto scaled = static_cast<std::uint32_t>(scale * static_cast<double>(probability));
      const std::int64_t most = std::min<std::int64_t>(probability - 1, excess);
      const std::int64_t cut = std::clamp<std::int64_t>(static_cast<std::int64_t>(probability) - scaled, 1, most);
      probability -= static_cast<std::uint32_t>(cut);
      excess -= cut;
    }
  }
}

}  // namespace terrane
