#pragma once
// Octahedral normals of Draco, without libdraco: corrections to a prediction undone, in integers. Coordinates run from
// 0 to 2 * centre. After draco/compression/attributes/normal_compression_utils.h (1.5). Private to proto.

#include <cstdint>
#include <cstdlib>
#include <utility>

namespace terrane {

struct OctahedralPoint {
  std::int32_t s = 0, t = 0;
};

class DracoOctahedron {
 public:
  /// bits: 2 to 16.
  explicit DracoOctahedron(int bits) : center_((1 << (bits - 1)) - 1) {}

  std::int32_t center() const noexcept { return center_; }
  std::int32_t greatest() const noexcept { return 2 * center_; }

  /// The point that lies at the correction from what was predicted. All coordinates are within [0, greatest].
  OctahedralPoint corrected(OctahedralPoint predicted, OctahedralPoint correction) const noexcept {
    OctahedralPoint from{predicted.s - center_, predicted.t - center_};
    const bool folded = std::abs(from.s) + std::abs(from.t) > center_;
    if (folded) from = inverted(from);
    const int turns = turnsToBottomLeft(from);
    from = turned(from, turns);
    OctahedralPoint to{wrapped(from.s + correction.s), wrapped(from.t + correction.t)};
    to = turned(to, 4 - turns);
    if (folded) to = inverted(to);
    return {to.s + center_, to.t + center_};
  }

  /// Where an integer vector whose absolute components sum up to the centre lies.
  OctahedralPoint pointOf(std::int32_t x, std::int32_t y, std::int32_t z) const noexcept {
    if (x >= 0) return canonical({y + center_, z + center_});
    return canonical({y < 0 ? std::abs(z) : greatest() - std::abs(z), z < 0 ? std::abs(y) : greatest() - std::abs(y)});
  }

 private:
  /// Exchanges the inner diamond and the outer triangles; about the origin.
  OctahedralPoint inverted(OctahedralPoint at) const noexcept {
    std::int32_t signS = at.s > 0 ? 1 : -1, signT = at.t > 0 ? 1 : -1;
    if (at.s >= 0 && at.t >= 0) {
      signS = signT = 1;
    } else if (at.s <= 0 && at.t <= 0) {
      signS = signT = -1;
    }
    const std::int32_t same = signS * signT;
    return {signS * center_ - same * at.t, signT * center_ - same * at.s};
  }

  static int turnsToBottomLeft(OctahedralPoint at) noexcept {
    if (at.s < 0) return at.t <= 0 ? 0 : 3;
    if (at.s > 0) return at.t >= 0 ? 2 : 1;
    return at.t == 0 ? 0 : at.t > 0 ? 3 : 1;
  }

  /// By quarters; 4 is none.
  static OctahedralPoint turned(OctahedralPoint at, int turns) noexcept {
    switch (turns) {
      case 1:
        return {at.t, -at.s};
      case 2:
        return {-at.s, -at.t};
      case 3:
        return {-at.t, at.s};
      default:
        return at;
    }
  }

  std::int32_t wrapped(std::int32_t x) const noexcept {
    if (x > center_) return x - (2 * center_ + 1);
    return x < -center_ ? x + (2 * center_ + 1) : x;
  }

  /// Points of the square's edge stand for the same direction as their mirror images: one of them is chosen.
  OctahedralPoint canonical(OctahedralPoint at) const noexcept {
    const std::int32_t most = greatest();
    if ((at.s == 0 && (at.t == 0 || at.t == most)) || (at.s == most && at.t == 0)) return {most, most};
    if (at.s == 0 && at.t > center_) return {at.s, most - at.t};
    if (at.s == most && at.t < center_) return {at.s, most - at.t};
    if (at.t == most && at.s < center_) return {most - at.s, at.t};
    if (at.t == 0 && at.s > center_) return {most - at.s, at.t};
    return at;
  }

  std::int32_t center_;
};

}  // namespace terrane
