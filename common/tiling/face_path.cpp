#include "common/tiling/face_path.h"

#include <cstdlib>

namespace terrane {
namespace {

constexpr int kFaceCountCube = 6;
constexpr int kFaceCountIco = 20;

struct IntegerVector {
  std::int64_t x, y, z;

  constexpr IntegerVector operator+(const IntegerVector& b) const { return {x + b.x, y + b.y, z + b.z}; }
  constexpr IntegerVector operator*(std::int64_t k) const { return {x * k, y * k, z * k}; }
  constexpr bool operator==(const IntegerVector&) const = default;
};

constexpr std::int64_t dot(const IntegerVector& a, const IntegerVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr IntegerVector cross(const IntegerVector& a, const IntegerVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

struct IntegerAxes {
  IntegerVector normal, u, v;
};

// The table of face_path.h.
constexpr std::array<IntegerAxes, kFaceCountCube> kAxes{{
    {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
    {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
    {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
    {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}},
    {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}},
}};

constexpr bool axesAreRightHanded() {
  for (const IntegerAxes& axes : kAxes) {
    if (!(cross(axes.u, axes.v) == axes.normal)) return false;
  }
  return true;
}
static_assert(axesAreRightHanded());

/// Bits 0, 2, 4, ... of a Morton code.
constexpr std::uint32_t evenBits(std::uint64_t code) {
  code &= 0x5555555555555555ull;
  code = (code | (code >> 1)) & 0x3333333333333333ull;
  code = (code | (code >> 2)) & 0x0F0F0F0F0F0F0F0Full;
  code = (code | (code >> 4)) & 0x00FF00FF00FF00FFull;
  code = (code | (code >> 8)) & 0x0000FFFF0000FFFFull;
  code = (code | (code >> 16)) & 0x00000000FFFFFFFFull;
  return static_cast<std::uint32_t>(code);
}

/// The inverse: bit i goes to bit 2 i.
constexpr std::uint64_t spreadBits(std::uint32_t bits) {
  std::uint64_t code = bits;
  code = (code | (code << 16)) & 0x0000FFFF0000FFFFull;
  code = (code | (code << 8)) & 0x00FF00FF00FF00FFull;
  code = (code | (code << 4)) & 0x0F0F0F0F0F0F0F0Full;
  code = (code | (code << 2)) & 0x3333333333333333ull;
  code = (code | (code << 1)) & 0x5555555555555555ull;
  return code;
}

/// The tile whose centre is the given point of the cube with half-width `half` = 2^level, on which a tile is 2 units
/// wide. A centre is odd steps from every edge of its face, so exactly one coordinate has the magnitude `half`.
FacePath tileAtCubePoint(const IntegerVector& point, std::int64_t half, int level) noexcept {
  for (int face = 0; face < kFaceCountCube; ++face) {
    const IntegerAxes& axes = kAxes[static_cast<std::size_t>(face)];
    if (dot(point, axes.normal) == half) {
      const std::int64_t column = (dot(point, axes.u) + half - 1) / 2;
      const std::int64_t row = (dot(point, axes.v) + half - 1) / 2;
      return FacePath::cubeTile(face, level, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
    }
  }
  std::abort();  // unreachable: the caller's point lies on a face
}

/// What a user typed, fit for a message: short and printable whatever it was.
std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string out = "\"";
  for (const char c : text.substr(0, kShown)) out += (c >= 0x20 && c < 0x7f && c != '"' && c != '\\') ? c : '?';
  return out + (text.size() > kShown ? "...\"" : "\"");
}

Error invalid(const char* field, std::string message) {
  return makeError(ErrorKind::InvalidArgument, field, std::move(message));
}

/// A decimal number of one or two digits without leading zeros (a tile has one name), or -1.
int parseFace(std::string_view text) noexcept {
  if (text.empty() || text.size() > 2 || (text.size() == 2 && text[0] == '0')) return -1;
  int value = 0;
  for (const char c : text) {
    if (c < '0' || c > '9') return -1;
    value = 10 * value + (c - '0');
  }
  return value;
}

}  // namespace

std::string_view schemeName(Scheme scheme) noexcept { return scheme == Scheme::Ico ? "ico" : "cube"; }

int faceCount(Scheme scheme) noexcept { return scheme == Scheme::Ico ? kFaceCountIco : kFaceCountCube; }

FacePath FacePath::cubeTile(int face, int level, std::uint32_t column, std::uint32_t row) noexcept {
  return FacePath(Scheme::Cube, static_cast<std::uint8_t>(face), static_cast<std::uint8_t>(level),
                  spreadBits(column) | (spreadBits(row) << 1));
}

Result<FacePath> FacePath::parse(std::string_view text) {
  const std::size_t schemeEnd = text.find('/');
  if (schemeEnd == std::string_view::npos) {
    // One word alone: the scheme is the first thing that can be wrong with it.
    if (text != "cube" && text != "ico") return fromParts(text, "", "");
    return invalid("face", "missing; a tile is written scheme/face or scheme/face/digits, as cube/2/0312");
  }
  const std::string_view scheme = text.substr(0, schemeEnd);
  const std::string_view rest = text.substr(schemeEnd + 1);
  const std::size_t faceEnd = rest.find('/');
  if (faceEnd == std::string_view::npos) return fromParts(scheme, rest, "");
  const std::string_view digits = rest.substr(faceEnd + 1);
  Result<FacePath> path = fromParts(scheme, rest.substr(0, faceEnd), digits);
  if (path.has_value() && digits.empty()) {
    return invalid("digits", "empty after the slash; a whole face is written without it, as cube/2");
  }
  return path;
}

Result<FacePath> FacePath::fromParts(std::string_view scheme, std::string_view face, std::string_view digits) {
  if (scheme != "cube" && scheme != "ico") {
    return invalid("scheme", quoted(scheme) + " is not a tiling scheme; the schemes are cube and ico");
  }
  const Scheme parsedScheme = scheme == "ico" ? Scheme::Ico : Scheme::Cube;
  const int parsedFace = parseFace(face);
  if (parsedFace < 0 || parsedFace >= faceCount(parsedScheme)) {
    return invalid("face", quoted(face) + " is not a face of " + std::string(scheme) + "; faces are 0 to " +
                               std::to_string(faceCount(parsedScheme) - 1));
  }
  if (digits.size() > static_cast<std::size_t>(kMaxLevel)) {
    return invalid("digits",
                   std::to_string(digits.size()) + " digits; the deepest level is " + std::to_string(kMaxLevel));
  }
  FacePath path = wholeFace(parsedScheme, parsedFace);
  for (const char c : digits) {
    if (c < '0' || c > '3') return invalid("digits", quoted(digits) + " holds something else than the digits 0 to 3");
    path = path.child(c - '0');
  }
  return path;
}

std::string FacePath::text() const {
  std::string out(schemeName(scheme_));
  out += '/';
  out += std::to_string(face());
  if (level() > 0) {
    out += '/';
    out += digits();
  }
  return out;
}

std::string FacePath::digits() const {
  std::string out(static_cast<std::size_t>(level()), '0');
  for (int i = 0; i < level(); ++i) out[static_cast<std::size_t>(i)] = static_cast<char>('0' + digit(i));
  return out;
}

std::uint32_t FacePath::column() const noexcept { return evenBits(digits_); }
std::uint32_t FacePath::row() const noexcept { return evenBits(digits_ >> 1); }

std::optional<FacePath> FacePath::neighbour(Side side) const noexcept {
  struct Offset {
    std::int64_t u, v;
  };
  constexpr std::array<Offset, kSideCount> kOffsets{
      {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
  if (scheme_ != Scheme::Cube) return std::nullopt;

  // The cube has the half-width 2^level, so tiles are 2 wide and centres are odd integers on their face.
  const std::int64_t half = std::int64_t{1} << level();
  const Offset offset = kOffsets[static_cast<std::size_t>(side)];
  const std::int64_t u = 2 * static_cast<std::int64_t>(column()) + 1 - half + 2 * offset.u;
  const std::int64_t v = 2 * static_cast<std::int64_t>(row()) + 1 - half + 2 * offset.v;
  const bool beyondU = u < -half || u > half;
  const bool beyondV = v < -half || v > half;
  if (beyondU && beyondV) return std::nullopt;

  // One unit past an edge is one unit down the next face.
  const IntegerAxes& axes = kAxes[static_cast<std::size_t>(face())];
  IntegerVector point = axes.normal * half + axes.u * u + axes.v * v;
  if (beyondU) point = axes.normal * (half - 1) + axes.u * (u < 0 ? -half : half) + axes.v * v;
  if (beyondV) point = axes.normal * (half - 1) + axes.u * u + axes.v * (v < 0 ? -half : half);
  return tileAtCubePoint(point, half, level());
}

}  // namespace terrane
