#pragma once
// Frequencies of symbols scaled to whole probabilities that add up to a power of two, as libdraco scales them: bit for
// bit, in time that grows with the symbols that come and not with the alphabet. Private to proto. Thread-safe.

#include <cstdint>
#include <span>
#include <vector>

namespace terrane {

class ProbabilityScaler {
 public:
  /// frequencies: of the symbols that come, in their order, none zero, at most 2^18 of them. wholeAlphabet: whether
  /// every symbol below the greatest comes. probabilities: as many; they add up to 2^precisionBits, none is zero.
  /// Precondition: twice as many fit into 2^precisionBits, which libdraco sees to.
  void scale(std::span<const std::uint32_t> frequencies, bool wholeAlphabet, int precisionBits,
             std::span<std::uint32_t> probabilities);

 private:
  void orderByProbability(std::span<const std::uint32_t> probabilities);

  std::vector<std::uint32_t> order_;    ///< greatest probability first; of equal ones the last symbol
  std::vector<std::uint32_t> buckets_;  ///< where those of each small probability begin
  std::vector<std::uint64_t> large_;
};

}  // namespace terrane
