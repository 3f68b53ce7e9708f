#pragma once
// The address of a tile: tiling scheme, face, and a path of base-4 digits from the face down, written "cube/2/0312"; a
// whole face is "cube/2". Everything here is integer arithmetic and exact; values are immutable and thread-safe.
//
// Cube faces 0..5 = +X -X +Y -Y +Z -Z. Each face has axes (u, v) with u x v = outward normal:
//   face   normal   u    v          face   normal   u    v
//   0      +X       +Y   +Z         1      -X       -Y   +Z
//   2      +Y       -X   +Z         3      -Y       +X   +Z
//   4      +Z       +Y   -X         5      -Z       +Y   +X
// A digit's bit 0 is the half in u, bit 1 the half in v. At level L a face is 2^L columns (u) by 2^L rows (v).
//
// Ico faces 0..19: icosahedron.h. Digits 0, 1, 2 are the child at that corner, 3 the centre child: triangle_tile.h.

#include <array>
#include <compare>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "common/result.h"

namespace terrane {

enum class Scheme : std::uint8_t { Cube, Ico };

std::string_view schemeName(Scheme scheme) noexcept;
int faceCount(Scheme scheme) noexcept;  ///< 6 or 20

/// The eight tiles around a cube tile, in the tile's own (u, v) axes. Edges come first.
enum class Side : std::uint8_t { UMin, UMax, VMin, VMax, UMinVMin, UMaxVMin, UMinVMax, UMaxVMax };
inline constexpr int kEdgeCount = 4;
inline constexpr int kSideCount = 8;

class FacePath {
 public:
  static constexpr int kMaxLevel = 30;

  constexpr FacePath() = default;  ///< cube/0

  /// A whole face. Precondition: 0 <= face < faceCount(scheme).
  static constexpr FacePath wholeFace(Scheme scheme, int face) noexcept {
    return FacePath(scheme, static_cast<std::uint8_t>(face), 0, 0);
  }

  /// Cube tile by column and row. Precondition: face in 0..5, level in 0..30, column and row < 2^level.
  static FacePath cubeTile(int face, int level, std::uint32_t column, std::uint32_t row) noexcept;

  /// A tile by what packedDigits() gives. Precondition: a face of the scheme, level in 0..30, digits < 4^level.
  static constexpr FacePath fromPackedDigits(Scheme scheme, int face, int level, std::uint64_t digits) noexcept {
    return FacePath(scheme, static_cast<std::uint8_t>(face), static_cast<std::uint8_t>(level), digits);
  }

  /// Reads "cube/2/0312", "cube/2". Errors (InvalidArgument) name "scheme", "face" or "digits" as the field.
  static Result<FacePath> parse(std::string_view text);

  /// As parse, from the parts of a URL. digits may be empty.
  static Result<FacePath> fromParts(std::string_view scheme, std::string_view face, std::string_view digits);

  std::string text() const;    ///< "cube/2/0312"
  std::string digits() const;  ///< "0312"

  constexpr Scheme scheme() const noexcept { return scheme_; }
  constexpr int face() const noexcept { return face_; }
  constexpr int level() const noexcept { return level_; }

  /// Digit i, 0 = coarsest. Precondition: 0 <= i < level().
  constexpr int digit(int i) const noexcept { return static_cast<int>((digits_ >> (2 * (level_ - 1 - i))) & 3u); }
  /// All digits, two bits each, the finest lowest: for the cube, the Morton code of (column, row).
  constexpr std::uint64_t packedDigits() const noexcept { return digits_; }

  std::uint32_t column() const noexcept;  ///< cube: index in u, 0..2^level - 1
  std::uint32_t row() const noexcept;     ///< cube: index in v

  /// Precondition: level() > 0.
  constexpr FacePath parent() const noexcept {
    return FacePath(scheme_, face_, static_cast<std::uint8_t>(level_ - 1), digits_ >> 2);
  }
  /// Precondition: level() < kMaxLevel, 0 <= digit < 4.
  constexpr FacePath child(int digit) const noexcept {
    return FacePath(scheme_, face_, static_cast<std::uint8_t>(level_ + 1),
                    (digits_ << 2) | static_cast<unsigned>(digit));
  }
  /// The ancestor at the given level (itself at its own). Precondition: 0 <= level <= this->level().
  constexpr FacePath ancestor(int level) const noexcept {
    return FacePath(scheme_, face_, static_cast<std::uint8_t>(level), digits_ >> (2 * (level_ - level)));
  }

  /// The cube tile of the same level beyond a side, over face edges too. Beyond a corner of the cube only three tiles
  /// meet: there the diagonal neighbour does not exist and the answer is empty. At level 0 only edge neighbours exist.
  std::optional<FacePath> neighbour(Side side) const noexcept;

  constexpr auto operator<=>(const FacePath&) const noexcept = default;  // NOLINT(modernize-use-nullptr): clang 14

 private:
  constexpr FacePath(Scheme scheme, std::uint8_t face, std::uint8_t level, std::uint64_t digits) noexcept
      : scheme_(scheme), face_(face), level_(level), digits_(digits) {}

  Scheme scheme_ = Scheme::Cube;
  std::uint8_t face_ = 0;
  std::uint8_t level_ = 0;
  std::uint64_t digits_ = 0;
};

}  // namespace terrane

template <>
struct std::hash<terrane::FacePath> {
  std::size_t operator()(const terrane::FacePath& path) const noexcept {
    std::uint64_t h =
        path.packedDigits() ^ (static_cast<std::uint64_t>(path.level()) << 58) ^
        (static_cast<std::uint64_t>(path.face() + 32 * static_cast<int>(path.scheme())) * 0x9E3779B97F4A7C15ull);
    h ^= h >> 31;
    h *= 0xBF58476D1CE4E5B9ull;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
