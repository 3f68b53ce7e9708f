#include "client/render/clip_rows.h"

#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

namespace terrane {

glm::dmat3 clipRows(const Camera& camera) noexcept {
  const glm::dmat4 projection = reversedInfiniteProjection(camera);
  const glm::dmat3 rotation = viewRotation(camera);
  glm::dmat3 rows(0.0);
  for (int column = 0; column < 3; ++column) {
    rows[column] = glm::dvec3(projection[0][0] * rotation[column][0], projection[1][1] * rotation[column][1],
                              projection[2][3] * rotation[column][2]);
  }
  return rows;
}

glm::dmat3 screenRays(const Camera& camera) noexcept { return glm::inverse(clipRows(camera)); }

}  // namespace terrane
