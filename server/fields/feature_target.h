#pragma once
// What features are looked for about: a ball, or only a row of points, as along a tile's border, where most of what
// lies in the ball around it is of no use. And the cells of a face that may hold them. Body frame, metres. Thread-safe.

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

/// An interval of face angles, -1..1 across a face.
struct AngleSpan {
  double low, high;
};

/// A ball as a face's grid sees it.
struct FaceView {
  double radius = 0;                            ///< metres
  double angleU = 0, angleV = 0;                ///< of its centre
  double circleRadiusU = 0, circleRadiusV = 0;  ///< metres: of the circles that the centre moves on with an angle
  /// Whether all that reaches so far from points with such angles is certain to miss the ball. A point whose angle is
  /// d away lies in a plane through the body's centre that is circleRadius sin(pi d / 4) away from the ball's.
  bool isBeyond(const AngleSpan& u, const AngleSpan& v, double reach) const noexcept;
};

class BallTarget {
 public:
  explicit BallTarget(const Ball& ball) noexcept : ball_(ball) {}
  FaceView viewOf(int face) const noexcept;
  /// Cells, cellsPerFace along a face, that hold all that is within reach of the ball.
  CellBlock cells(int face, double reach, std::uint32_t cellsPerFace) const noexcept;
  /// Whether what reaches this far from scale * at touches it.
  bool touchedFrom(const double at[3], double scale, double reach) const noexcept;

 private:
  Ball ball_;
};

/// Points that lie near the line from the first to the last. Holds on to them.
class RowTarget {
 public:
  /// Precondition: one point or more.
  explicit RowTarget(const PointSet& points) noexcept;
  FaceView viewOf(int face) const noexcept { return ball_.viewOf(face); }
  CellBlock cells(int face, double reach, std::uint32_t cellsPerFace) const noexcept;
  bool touchedFrom(const double at[3], double scale, double reach) const noexcept;

 private:
  static constexpr std::size_t kStride = 8;
  void pointAt(std::size_t index, double out[3]) const noexcept;
  double squareDistanceFromLine(const double point[3]) const noexcept;

  PointSet points_;
  BallTarget ball_;
  double start_[3], along_[3];      ///< the line from the first point to the last
  double inverseSquareLength_ = 0;  ///< 0: both are one
  double bulge_ = 0;                ///< how far from the line a point may be
  double gap_ = 0;                  ///< how far a point may be from the one of every kStride before it
};

}  // namespace terrane::lunar
