// Normals on the octahedron, and what is left of them, against libdraco's own arithmetic.

#include "proto/normal_symbols.h"

#include <draco/compression/attributes/normal_compression_utils.h>
#include <draco/compression/attributes/prediction_schemes/prediction_scheme_normal_octahedron_canonicalized_encoding_transform.h>
#include <draco/compression/bit_coders/rans_bit_encoder.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "proto/octahedron.h"
#include "proto/rans_bits.h"

namespace terrane::test {
namespace {

constexpr unsigned kSeed = 23;

OctahedralPoints allAt(std::int32_t s, std::int32_t t) { return {all4(s), all4(t)}; }

TEST(Octahedron, PointsOfAllWholeVectorsAreLibdracos) {
  for (int bits = 2; bits <= 7; ++bits) {
    const OctahedralGrid grid(bits);
    draco::OctahedronToolBox libdraco;
    ASSERT_TRUE(libdraco.SetQuantizationBits(bits));
    ASSERT_EQ(grid.modulus(), libdraco.max_quantized_value());
    for (std::int32_t x = -grid.center; x <= grid.center; ++x) {
      for (std::int32_t y = -grid.center + std::abs(x); y <= grid.center - std::abs(x); ++y) {
        const std::int32_t rest = grid.center - std::abs(x) - std::abs(y);
        for (const std::int32_t z : {rest, -rest}) {
          const std::int32_t vector[3] = {x, y, z};
          std::int32_t s = 0, t = 0;
          libdraco.IntegerVectorToQuantizedOctahedralCoords(vector, &s, &t);
          const OctahedralPoints ours = octahedralPoints(grid, all4(x), all4(y), all4(z));
          ASSERT_TRUE(ours.s[0] == s && ours.t[0] == t && ours.s[3] == s && ours.t[3] == t)
              << x << " " << y << " " << z << ", " << bits << " bits";
        }
      }
    }
  }
}

TEST(Octahedron, CorrectionsOfAllPairsAreLibdracos) {
  for (int bits = 2; bits <= 5; ++bits) {
    const OctahedralGrid grid(bits);
    const draco::PredictionSchemeNormalOctahedronCanonicalizedEncodingTransform<std::int32_t> libdraco(grid.modulus());
    const std::int32_t side = grid.modulus();
    for (std::int32_t pair = 0; pair < side * side * side * side; ++pair) {
      const std::int32_t value[2] = {pair % side, pair / side % side};
      const std::int32_t predicted[2] = {pair / side / side % side, pair / side / side / side};
      std::int32_t expected[2];
      libdraco.ComputeCorrection(value, predicted, expected);
      const OctahedralPoints ours =
          octahedralCorrections(grid, allAt(value[0], value[1]), allAt(predicted[0], predicted[1]));
      ASSERT_TRUE(ours.s[0] == expected[0] && ours.t[0] == expected[1])
          << value[0] << " " << value[1] << " by " << predicted[0] << " " << predicted[1] << ", " << bits << " bits";
    }
  }
}

/// The vertices in their own order.
EntryOrder plainOrder(std::size_t count) {
  EntryOrder order;
  order.pointOfEntry.resize(count);
  std::iota(order.pointOfEntry.begin(), order.pointOfEntry.end(), 0u);
  return order;
}

/// Along axes and diagonals, of lengths up to the ends of what is allowed, near the grid's ties, and any.
std::vector<float> manyNormals() {
  std::vector<float> normals;
  for (const float scale : {1.0f, 1.01e-6f, 2e-6f, 1e-3f, 5e5f}) {
    for (int code = 0; code < 27; ++code) {
      const std::array<int, 3> n{code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1};
      if (n == std::array<int, 3>{}) continue;
      for (const int component : n) normals.push_back(scale * static_cast<float>(component));
    }
  }
  for (int i = 0; i <= 512; ++i) {
    const float x = static_cast<float>(i) / 512;
    for (const float sign : {1.0f, -1.0f}) {
      normals.insert(normals.end(), {x, sign * (1 - x), 0.0f});
      normals.insert(normals.end(), {-x, 0.0f, sign * (1 - x)});
      normals.insert(normals.end(), {sign * x / 2, (1 - x) / 2, -0.5f});
    }
  }
  std::mt19937 random(kSeed);
  const auto component = [&] { return static_cast<float>(std::ldexp(random(), -31) - 1); };
  for (int i = 0; i < 30'000; ++i) normals.insert(normals.end(), {component(), component(), component()});
  return normals;
}

TEST(NormalSymbols, AreLibdracosAtEveryWidth) {
  std::vector<float> normals = manyNormals();
  const float brink = std::sqrt(1e-12f);  // squares of about 1e-12: libdraco takes what is shorter for +x
  for (float x = 0.9999999f * brink; x < 1.0000003f * brink; x = std::nextafter(x, 1.0f))
    for (const auto& n : {std::array{x, 0.0f, 0.0f}, std::array{0.0f, -x, 0.0f}, std::array{0.0f, 0.0f, -x}})
      if (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 1e-12f) normals.insert(normals.end(), n.begin(), n.end());
  const EntryOrder order = plainOrder(normals.size() / 3);
  NormalScratch scratch;
  std::vector<std::uint32_t> symbols;
  ASSERT_TRUE(gatherNormals(normals, order, scratch));
  for (int bits = 2; bits <= 16; ++bits) {
    differenceSymbols(bits, order, scratch, symbols);
    ASSERT_EQ(symbols.size(), 2 * order.size());
    draco::OctahedronToolBox octahedron;
    ASSERT_TRUE(octahedron.SetQuantizationBits(bits));
    const draco::PredictionSchemeNormalOctahedronCanonicalizedEncodingTransform<std::int32_t> transform(
        octahedron.max_quantized_value());
    std::int32_t before[2] = {0, 0};
    for (std::size_t i = 0; i < order.size(); ++i) {
      std::int32_t value[2], expected[2];
      octahedron.FloatVectorToQuantizedOctahedralCoords(&normals[3 * i], &value[0], &value[1]);
      transform.ComputeCorrection(value, before, expected);
      ASSERT_TRUE(symbols[2 * i] == static_cast<std::uint32_t>(expected[0]) &&
                  symbols[2 * i + 1] == static_cast<std::uint32_t>(expected[1]))
          << normals[3 * i] << " " << normals[3 * i + 1] << " " << normals[3 * i + 2] << ", " << bits << " bits, seed "
          << kSeed;
      std::copy_n(value, 2, before);
    }
  }
}

TEST(NormalSymbols, RefuseWhatHasNoDirection) {
  NormalScratch scratch;
  const float infinite = std::numeric_limits<float>::infinity(), notANumber = std::nanf("");
  for (const float bad : {0.0f, 9e-7f, 2e6f, infinite, notANumber}) {
    const std::vector<float> normals{0, 0, 1, bad, 0, 0, 0, 1, 0};
    EXPECT_FALSE(gatherNormals(normals, plainOrder(3), scratch)) << bad;
  }
}

TEST(RansBits, AreLibdracos) {
  std::mt19937 random(kSeed);
  for (const std::size_t count : {0, 1, 2, 31, 32, 33, 4000, 100'000}) {
    for (const unsigned ofThousand : {0u, 1u, 30u, 500u, 990u, 1000u}) {
      std::vector<std::uint8_t> bits(count), ours;
      draco::RAnsBitEncoder libdraco;
      libdraco.StartEncoding();
      for (auto& bit : bits) {
        bit = random() % 1000 < ofThousand ? 1 : 0;
        libdraco.EncodeBit(bit != 0);
      }
      draco::EncoderBuffer buffer;
      libdraco.EndEncoding(&buffer);
      appendRansBits(bits, ours);
      EXPECT_TRUE(ours == std::vector<std::uint8_t>(buffer.data(), buffer.data() + buffer.size()))
          << count << " bits, " << ofThousand << " of 1000 are 1";
    }
  }
}

}  // namespace
}  // namespace terrane::test
