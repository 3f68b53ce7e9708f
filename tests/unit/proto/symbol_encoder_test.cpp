// The coder of symbols against libdraco's own, byte for byte.

#include "proto/symbol_encoder.h"

#include <draco/compression/config/compression_shared.h>
#include <draco/compression/entropy/symbol_decoding.h>
#include <draco/compression/entropy/symbol_encoding.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "proto/symbol_entropy.h"

namespace terrane::test {
namespace {

constexpr unsigned kSeed = 17;
using Symbols = std::vector<std::uint32_t>;

std::vector<std::uint8_t> codedByLibdraco(const Symbols& symbols, int components, int level) {
  draco::Options options;
  draco::SetSymbolEncodingCompressionLevel(&options, level);
  draco::EncoderBuffer buffer;
  const bool taken =
      draco::EncodeSymbols(symbols.data(), static_cast<int>(symbols.size()), components, &options, &buffer);
  EXPECT_TRUE(taken);
  return {buffer.data(), buffer.data() + buffer.size()};
}

struct Ways {
  int tagged = 0, raw = 0;
};

/// Whether ours are libdraco's bytes; counts which way of writing it was.
bool sameBytes(const Symbols& symbols, int components, int level, Ways& ways) {
  std::vector<std::uint8_t> ours;
  if (!encodeSymbols(symbols, components, level, ours)) return false;
  if (!ours.empty()) ++(ours[0] == 0 ? ways.tagged : ways.raw);
  return ours == codedByLibdraco(symbols, components, level);
}

/// Of one kind: what residuals look like, and what they never do.
struct Kind {
  const char* name;
  std::uint32_t (*draw)(std::mt19937& random, std::size_t i, std::uint32_t greatest);
};
constexpr Kind kKinds[] = {
    {"all alike", [](std::mt19937&, std::size_t, std::uint32_t greatest) { return greatest; }},
    {"any",
     [](std::mt19937& random, std::size_t, std::uint32_t greatest) {
       return static_cast<std::uint32_t>(random() % (greatest + std::uint64_t{1}));
     }},
    {"mostly small",
     [](std::mt19937& random, std::size_t, std::uint32_t greatest) { return greatest >> (random() % 20); }},
    {"the first is far",
     [](std::mt19937& random, std::size_t i, std::uint32_t greatest) {
       return i == 0 ? greatest : static_cast<std::uint32_t>(random() % 7);
     }},
    {"only the ends",
     [](std::mt19937& random, std::size_t, std::uint32_t greatest) { return random() % 2 == 0 ? 0 : greatest; }},
    {"each once, in turn",
     [](std::mt19937&, std::size_t i, std::uint32_t greatest) {
       return static_cast<std::uint32_t>(i % (greatest + std::uint64_t{1}));
     }},
    {"bell",
     [](std::mt19937& random, std::size_t, std::uint32_t greatest) {
       std::uint64_t sum = 0;
       for (int k = 0; k < 8; ++k) sum += random() % (greatest + std::uint64_t{1});
       return static_cast<std::uint32_t>(sum / 8);
     }},
};

TEST(SymbolEncoder, GivesTheBytesOfLibdraco) {
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  Ways ways;
  for (const std::size_t values : {1, 2, 3, 5, 64, 900, 4485, 23'400}) {
    for (const int components : {1, 2, 3, 4}) {
      for (const Kind& kind : kKinds) {
        for (const int bits : {0, 1, 3, 8, 10, 11, 13, 17, 18, 19, 20}) {
          Symbols symbols(values * static_cast<std::size_t>(components));
          for (std::size_t i = 0; i < symbols.size(); ++i)
            symbols[i] = kind.draw(random, i, static_cast<std::uint32_t>((std::uint64_t{1} << bits) - 1));
          const int level = static_cast<int>(random() % 11);
          ASSERT_TRUE(sameBytes(symbols, components, level, ways))
              << kind.name << ", " << values << " x " << components << ", " << bits << " bits, level " << level;
        }
      }
    }
  }
  EXPECT_GT(ways.tagged, 100);
  EXPECT_GT(ways.raw, 100);
}

TEST(SymbolEncoder, GivesTheBytesOfLibdracoAtEveryLevel) {
  std::mt19937 random(kSeed);
  Ways ways;
  for (int level = 0; level <= 10; ++level)
    for (const int bits : {1, 6, 9, 12, 16}) {
      Symbols symbols(30'000);
      for (auto& symbol : symbols) symbol = (1u << bits) >> (random() % 5) ^ static_cast<std::uint32_t>(random() % 3);
      EXPECT_TRUE(sameBytes(symbols, 3, level, ways)) << "level " << level << ", " << bits << " bits";
    }
}

/// Around all powers of two: as many components as fill a value with the longest, and fewer. libdraco's encoder counts
/// in a table of every symbol up to the greatest, so that the longest can only be read back.
TEST(SymbolEncoder, MeasuresSymbolsOfEveryLength) {
  Ways ways;
  for (const int components : {1, 2, 3}) {
    for (const unsigned longest : {25u, 31u}) {
      Symbols symbols;
      for (unsigned bits = 0; bits < longest; ++bits)
        for (const std::uint32_t symbol : {(1u << bits) - 1, 1u << bits, (1u << bits) + ((1u << bits) - 1)})
          for (int c = 0; c < components; ++c) symbols.push_back(symbol);
      EXPECT_TRUE(longest > 25 || sameBytes(symbols, components, 3, ways)) << components;
      std::vector<std::uint8_t> bytes;
      ASSERT_TRUE(encodeSymbols(symbols, components, 3, bytes));
      draco::DecoderBuffer buffer;
      buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      buffer.set_bitstream_version(DRACO_BITSTREAM_VERSION(2, 2));
      Symbols read(symbols.size());
      ASSERT_TRUE(draco::DecodeSymbols(static_cast<std::uint32_t>(symbols.size()), components, &buffer, read.data()));
      EXPECT_EQ(read, symbols) << components;
    }
  }
}

/// Where the two ways of writing take nearly the same: many small arrays, of which some lie within a bit.
TEST(SymbolEncoder, ChoosesAsLibdracoWhereBothWaysAreAlike) {
  std::mt19937 random(kSeed);
  Ways ways;
  for (int round = 0; round < 60'000; ++round) {
    const int components = 1 + static_cast<int>(random() % 3);
    Symbols symbols((1 + random() % 40) * static_cast<std::size_t>(components));
    const auto bits = static_cast<unsigned>(1 + random() % 10);
    for (auto& symbol : symbols) symbol = static_cast<std::uint32_t>(random()) % (1u << (1 + random() % bits));
    ASSERT_TRUE(sameBytes(symbols, components, 3, ways)) << "round " << round;
  }
  EXPECT_GT(ways.tagged, 1000);
  EXPECT_GT(ways.raw, 1000);
}

TEST(SymbolEncoder, RefusesWhatLibdracoHasNoRoomFor) {
  std::vector<std::uint8_t> out;
  EXPECT_FALSE(encodeSymbols(Symbols{1, 0x80000000u}, 1, 3, out));
  EXPECT_FALSE(encodeSymbols(Symbols{1, 2, 3}, 2, 3, out));
  EXPECT_TRUE(out.empty());
  EXPECT_TRUE(encodeSymbols(Symbols{}, 3, 3, out));
  EXPECT_TRUE(out.empty());  // as libdraco writes it
}

TEST(SymbolEncoder, KeepsNothingFromTheUseBefore) {
  std::mt19937 random(kSeed);
  SymbolEncoder used;
  for (int round = 0; round < 200; ++round) {
    Symbols symbols(3 * (1 + random() % 500));
    const auto bits = static_cast<unsigned>(random() % 21);
    for (auto& symbol : symbols) symbol = static_cast<std::uint32_t>(random()) & ((1u << bits) - 1);
    std::vector<std::uint8_t> fresh, again;
    ASSERT_TRUE(encodeSymbols(symbols, 3, 3, fresh));
    ASSERT_TRUE(used.begin(symbols, 3, 3));
    RansStream* const streams[] = {&used.stream()};
    encodeStreams(streams);
    used.append(again);
    EXPECT_EQ(fresh, again) << "round " << round;
  }
}

TEST(SymbolEntropy, LogarithmsAreRoundedToNearest) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 20'000; ++round) {
    const auto total = 1 + static_cast<std::uint32_t>(random() % 100'000);
    const double x = static_cast<double>(1 + random() % total) / total;
    const auto exact = std::log2(static_cast<long double>(x));
    const double rounded = roundedLog2(x);
    // Of two neighbours the nearer; long double is the judge, whose own error is some units of its last place.
    const double unit = std::abs(rounded - std::nextafter(rounded, -64.0));
    EXPECT_LE(std::abs(static_cast<double>(exact - rounded)), 0.51 * unit) << x;
  }
  EXPECT_EQ(roundedLog2(1.0), 0.0);
  EXPECT_EQ(roundedLog2(0.25), -2.0);
}

TEST(SymbolEntropy, BoundsHoldTheSumAndAreNarrow) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 500; ++round) {
    std::vector<std::uint32_t> frequencies(1 + random() % 3000);
    std::uint32_t total = 0;
    for (auto& frequency : frequencies)
      total += frequency = static_cast<std::uint32_t>(1 + (random() % 20'000 >> (random() % 15)));
    long double exact = 0;
    for (const std::uint32_t frequency : frequencies)
      exact -= frequency * std::log2(static_cast<long double>(frequency) / total);
    const auto [least, greatest] = entropyBounds(frequencies, total);
    EXPECT_LE(std::ldexp(static_cast<long double>(least), -32), exact);
    EXPECT_GE(std::ldexp(static_cast<long double>(greatest), -32), exact);
    EXPECT_LT(std::ldexp(static_cast<double>(greatest - least), -32), 0.01) << total;
  }
}

}  // namespace
}  // namespace terrane::test
