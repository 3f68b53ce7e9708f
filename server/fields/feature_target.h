#pragma once
// What features are looked for about: a ball, what a tile's border encloses, or only a row of points along it; and the
// cells of a face that may hold them. Body frame, metres. Thread-safe.

#include <array>
#include <cstddef>
#include <cstdint>

namespace terrane::lunar {

struct Ball {
  double center[3] = {0, 0, 0};
  double radius = 0;
};

/// Points at scale * (x, y, z), and a ball around them.
struct PointSet {
  const double *x, *y, *z;
  std::size_t count;
  double scale;
  Ball ball;
};

/// Cells along one axis of a face.
struct CellRange {
  std::uint32_t first = 1, last = 0;
  bool empty() const noexcept { return first > last; }
};
struct CellBlock {
  CellRange columns, rows;
  bool empty() const noexcept { return columns.empty() || rows.empty(); }
};

/// An interval of face angles, -1..1 across a face, or of their tangents.
struct AngleSpan {
  double low, high;
};

/// A target as one face's grid sees it: a ball, and if they are known the face angles within which the target lies.
/// A point whose angle is d away from a half-plane through an axis of the body is circleRadius sin(pi d / 4) away from
/// that plane, where circleRadius is its distance from the axis.
class FaceView {
 public:
  /// What is seen of a ball alone: the angles are its middle's, and all of it is within its radius of that.
  FaceView(int face, const Ball& ball) noexcept;
  /// Of points in a ball, and of what they enclose. Slack: the angles are taken wider by this share on either side.
  FaceView(int face, const PointSet& points, double slack) noexcept;

  /// Cells, cellsPerFace along a face, that hold all that is within reach of the target.
  CellBlock cells(double reach, std::uint32_t cellsPerFace) const noexcept;
  /// Whether all that reaches so far from points with such angles is certain to miss the target.
  bool isBeyond(const AngleSpan& u, const AngleSpan& v, double reach) const noexcept;
  /// Whether points of the ball lie within the angles. True if none are known.
  bool holds(const PointSet& points) const noexcept;

 private:
  /// Along one axis of the face.
  struct AxisView {
    double middle = 0;        ///< metres, of the ball's centre
    double circleRadius = 0;  ///< metres, the least; 0: no angles are known
    AngleSpan tangents{0, 0}, angles{0, 0};
    void close(double slack) noexcept;
    CellRange cells(double outward, double within, double reach, std::uint32_t cellsPerFace) const noexcept;
    bool isBeyond(const AngleSpan& at, double reach) const noexcept;
  };

  int face_;
  double outward_, ballRadius_;  ///< metres; of the ball
  double aroundAngles_ = 0;      ///< metres: how far the target may be from points with the angles
  AxisView u_, v_;
};

/// A ball, or points in one and what they enclose on the sphere. Precondition of the latter: all points lie on the
/// sphere.
class PatchTarget {
 public:
  explicit PatchTarget(const Ball& ball) noexcept;
  PatchTarget(const PointSet& points, double slack) noexcept;

  const Ball& ball() const noexcept { return ball_; }
  const FaceView& viewOf(int face) const noexcept { return views_[static_cast<std::size_t>(face)]; }
  /// Whether what reaches this far from scale * at touches the ball.
  bool touchedFrom(const double at[3], double scale, double reach) const noexcept;
  bool holds(const PointSet& points) const noexcept;

 private:
  Ball ball_;
  std::array<FaceView, 6> views_;
};

/// Points that lie near the line from the first to the last.
class RowTarget {
 public:
  /// Precondition: one point or more.
  explicit RowTarget(const PointSet& points) noexcept;
  const FaceView& viewOf(int face) const noexcept { return patch_.viewOf(face); }
  bool touchedFrom(const double at[3], double scale, double reach) const noexcept;

 private:
  double squareDistanceFromLine(const double point[3]) const noexcept;

  PatchTarget patch_;
  double start_[3], along_[3];      ///< the line from the first point to the last
  double inverseSquareLength_ = 0;  ///< 0: both are one
  double bulge_ = 0;                ///< how far from the line a point may be
};

}  // namespace terrane::lunar
