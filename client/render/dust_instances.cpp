#include "client/render/dust_instances.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace terrane {

/// Which grains can be seen: near enough to be a pixel wide, and with their shadows not all beside the picture.
class DustInstances::View {
 public:
  explicit View(const Camera& camera)
      : camera_(camera.positionBody),
        unseen_(kGrainUnseenPixels / (2 * static_cast<float>(pixelsPerRadian(camera)))),
        right_(camera.right),
        up_(camera.up),
        backward_(camera.backward) {
    const double vertical = std::tan(camera.verticalFieldOfView / 2),
                 horizontal = vertical * camera.widthPixels / camera.heightPixels;
    slopes_ = {horizontal, vertical};
    margins_ = {kReach * std::sqrt(1 + horizontal * horizontal), kReach * std::sqrt(1 + vertical * vertical)};
  }

  glm::vec3 relative(const glm::dvec3& root) const { return glm::vec3(root - camera_); }
  /// The least radius that is seen so far away.
  float leastRadius(float distanceMeters) const { return unseen_ * distanceMeters; }

  bool sees(const glm::vec3& root, float radius) const {
    const float limit = leastRadius(1.0f);
    if (radius * radius <= limit * limit * glm::dot(root, root)) return false;
    const float depth = -glm::dot(backward_, root);
    return std::abs(glm::dot(right_, root)) <= slopes_.x * depth + margins_.x * radius &&
           std::abs(glm::dot(up_, root)) <= slopes_.y * depth + margins_.y * radius;
  }

 private:
  /// Radii that a grain's shadow may be away from its root (grain_shadow.vert.glsl).
  static constexpr double kReach = 7;
  glm::dvec3 camera_;
  float unseen_;
  glm::vec3 right_, up_, backward_;
  glm::vec2 slopes_, margins_;
};

void DustInstances::gather(const Camera& camera, std::span<const TileDraw> tiles) {
  ++frame_;
  for (auto& instances : meshes_) instances.clear();
  const View view(camera);
  for (const TileDraw& draw : tiles) {
    const TileMetadata& tile = draw.tile->metadata;
    if (tile.path.level() - kFinestClassBelow < field_.coarsestClass() || tile.cellsPerEdge != kGrainCells ||
        !draw.tile->layout->indices->isGrid())
      continue;
    const double distance =
        std::max(glm::length(tile.sphere.center - camera.positionBody) - tile.sphere.radiusMeters, camera.nearMeters);
    const float unseenMeters = 2 * view.leastRadius(static_cast<float>(distance));
    if (field_.largestMeters(field_.coarsestClass()) <= unseenMeters) continue;
    auto found = kept_.find(tile.path);
    if (found != kept_.end() && !found->second.grains.fits(draw)) {
      kept_.erase(found);
      found = kept_.end();
    }
    if (found == kept_.end()) found = kept_.emplace(tile.path, Kept{TileGrains(field_, draw)}).first;
    Kept& kept = found->second;
    kept.frame = frame_;
    kept.grains.moveTo(draw.byBorders);
    for (const GrainRun& run : kept.grains.runs())
      if (run.largestMeters > unseenMeters) append(view, kept.grains, run);
  }
  std::erase_if(kept_, [this](const auto& entry) { return entry.second.frame != frame_; });
}

void DustInstances::append(const View& view, const TileGrains& grains, const GrainRun& run) {
  std::vector<GrainInstance>& out = meshes_[static_cast<std::size_t>(run.mesh)];
  for (std::size_t i = run.first; i < run.first + run.count; ++i) {
    const GrainInstance& instance = grains.instances()[i];
    const glm::vec3 root = view.relative(grains.roots()[i]);
    if (!view.sees(root, instance.radiusMeters)) continue;
    out.push_back(instance);
    if (!relative_) continue;
    out.back().rootHigh = {root.x, root.y, root.z};
    out.back().rootLow = {};
  }
}

}  // namespace terrane
