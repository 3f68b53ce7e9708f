#pragma once
// How far the loops of a tile build are from what they should give, in metres, for numbers of one type. Each loop is
// given exact inputs rounded to its type; the whole tile what the loop before it gave.

#include <cstdint>
#include <vector>

#include "tests/accuracy/tile_build/tile_chain.h"
#include "tests/accuracy/tile_build/tile_reference.h"

namespace terrane::accuracy {

/// What a place's vertices should be: all of them, or every `stride`th of a line.
class Truth {
 public:
  Truth(const Place& place, std::size_t stride);

  double directionErrorMeters(const Columns<double>& directions) const;
  double heightErrorMeters(const std::vector<double>& heightMeters) const;
  /// Of vertices in steps of 2^kFinestExponent m, with these heights or with the true ones.
  double latticeErrorMeters(const std::vector<std::int64_t>& lattice, const std::vector<double>* heightMeters) const;
  /// What the angle makes over a cell: of normals from the gradient, or from neighbours (inner vertices only).
  double gradientNormalErrorMeters(const std::vector<float>& normals, const Ground& ground) const;
  double neighbourNormalErrorMeters(const std::vector<float>& normals, const std::vector<double>& heightMeters) const;

 private:
  ReferenceVector position(std::size_t vertex, long double heightMeters) const;

  const Place& place_;
  std::vector<ReferenceVector> directions_;
  std::vector<std::size_t> vertices_;
  std::vector<long double> heightMeters_;  ///< by index in vertices_
};

}  // namespace terrane::accuracy
