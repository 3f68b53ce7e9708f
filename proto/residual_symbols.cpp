#include "proto/residual_symbols.h"

#include <algorithm>

#include "proto/vector4.h"

namespace terrane {
namespace {

/// The residual of a value known to lie in a range, brought into half of that range on either side of zero.
class WrappedResidual {
 public:
  explicit WrappedResidual(const ValueRange& range)
      : least_(all4(range.least)),
        greatest_(all4(range.greatest)),
        size_(all4(1 + range.greatest - range.least)),
        lowest_(-(size_ / 2)),
        highest_((size_ - 1) / 2) {}

  /// As symbols: 0, -1, 1, -2, ...
  Int4 operator()(Int4 value, Int4 predicted) const noexcept {
    predicted = choose(predicted < least_, least_, predicted);
    predicted = choose(predicted > greatest_, greatest_, predicted);
    Int4 residual = value - predicted;
    residual += (residual < lowest_) & size_;
    residual -= (residual > highest_) & size_;
    return (residual + residual) ^ (residual >> 31);
  }

 private:
  Int4 least_, greatest_, size_, lowest_, highest_;
};

struct Entries {
  const std::int32_t* values;
  Int4 operator[](std::size_t entry) const noexcept { return load4(values + 4 * entry); }
  Int4 by(const Parallelogram& p) const noexcept { return (*this)[p.next] + (*this)[p.previous] - (*this)[p.opposite]; }
};

/// predict(entry): of entries 1 and up; the first is predicted by zero.
template <int kComponents, class Predict>
void writeSymbols(const Entries& entries, std::size_t count, const WrappedResidual& residual, Predict&& predict,
                  std::vector<std::uint32_t>& symbols) {
  symbols.resize(kComponents * count + 3);  // an entry is written whole; what is too much the next one covers
  std::uint32_t* out = symbols.data();
  const auto write = [&](Int4 values) {
    store4(out, values);
    out += kComponents;
  };
  write(residual(entries[0], Int4{}));
  for (std::size_t entry = 1; entry < count; ++entry) write(residual(entries[entry], predict(entry)));
  symbols.resize(kComponents * count);
}

/// The sum of up to four parallelograms of 16-bit numbers is below 2^20, so that a quotient that is not whole differs
/// from the next whole number by more than its rounding.
Int4 meanOf(const Entries& entries, const Parallelogram* first, const Parallelogram* last) noexcept {
  Int4 sum{};
  for (const Parallelogram* p = first; p != last; ++p) sum += entries.by(*p);
  const auto count = static_cast<float>(last - first);
  return __builtin_convertvector(__builtin_convertvector(sum, Float4) / Float4{count, count, count, count}, Int4);
}

template <int kComponents, class T>
ValueRange symbolsOf(std::span<const T> source, const EntryOrder& order, IntegerPrediction prediction,
                     ResidualScratch& scratch, std::vector<std::uint32_t>& symbols) {
  const std::size_t count = order.size();
  T least = source[0], greatest = source[0];
  for (const T value : source) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  const ValueRange range{least, greatest};
  scratch.values.resize(4 * count);
  for (std::size_t entry = 0; entry < count; ++entry) {
    const T* from = source.data() + static_cast<std::size_t>(kComponents) * order.pointOfEntry[entry];
    for (std::size_t c = 0; c < kComponents; ++c) scratch.values[4 * entry + c] = from[c];
  }
  const Entries entries{scratch.values.data()};
  const WrappedResidual residual(range);
  const auto write = [&](auto&& predict) { writeSymbols<kComponents>(entries, count, residual, predict, symbols); };
  switch (prediction) {
    case IntegerPrediction::Difference:
      write([&](std::size_t entry) { return entries[entry - 1]; });
      break;
    case IntegerPrediction::Parallelogram:
      write([&](std::size_t entry) { return entries.by(order.parallelograms[entry - 1]); });
      break;
    case IntegerPrediction::MultiParallelogram:
      write([&](std::size_t entry) {
        const std::uint32_t begin = order.aroundBegin[entry], end = order.aroundBegin[entry + 1];
        return begin == end ? entries[entry - 1]
                            : meanOf(entries, order.around.data() + begin, order.around.data() + end);
      });
      break;
  }
  return range;
}

template <class T>
ValueRange symbolsFor(std::span<const T> source, int components, const EntryOrder& order, IntegerPrediction prediction,
                      ResidualScratch& scratch, std::vector<std::uint32_t>& symbols) {
  return components == 1 ? symbolsOf<1>(source, order, prediction, scratch, symbols)
                         : symbolsOf<3>(source, order, prediction, scratch, symbols);
}

}  // namespace

ValueRange residualSymbols(std::span<const std::uint16_t> source, int components, const EntryOrder& order,
                           IntegerPrediction prediction, ResidualScratch& scratch,
                           std::vector<std::uint32_t>& symbols) {
  return symbolsFor(source, components, order, prediction, scratch, symbols);
}

ValueRange residualSymbols(std::span<const std::uint8_t> source, int components, const EntryOrder& order,
                           IntegerPrediction prediction, ResidualScratch& scratch,
                           std::vector<std::uint32_t>& symbols) {
  return symbolsFor(source, components, order, prediction, scratch, symbols);
}

}  // namespace terrane
