#pragma once
// A viewer without hands or window: stream, selection and renderer, one update and at most one draw a frame. Both the
// scripted run and the interactive one are loops around it. GL thread only.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/app/body_status.h"
#include "client/app/view_options.h"
#include "client/render/tile_renderer.h"
#include "client/tiles/tile_stream.h"
#include "common/result.h"
#include "common/view/drawn_tile.h"
#include "common/view/tile_selection.h"

namespace terrane {

/// How much arriving tiles may take of one frame.
struct UploadBudget {
  std::size_t bytes = 4u << 20;
  double milliseconds = 4;
};
inline constexpr UploadBudget kUnlimitedUpload{~std::size_t{0}, 1e9};

struct UpdateReport {
  bool changed = false;   ///< the picture would be another one: draw
  bool complete = false;  ///< the view has every tile it asks for
  bool settled = false;   ///< complete, the ground under the camera is final, and nothing is on its way
  bool stuck = false;     ///< tiles are missing and none of them will come: the server refused them for good
};

// A scene's bodies are all in the picture, in their places. The camera is known relative to one of them, the anchor: at
// first the one of --body. Only its ground holds the camera up.
class ViewSession {
 public:
  /// Does not wait for the server. wake: from any thread, when something arrived. A default cache that cannot be
  /// opened is a warning. Errors: as TileStream::open; Io naming "--cache".
  static Result<std::unique_ptr<ViewSession>> open(const ViewOptions& options, std::function<void()> wake);
  ~ViewSession();

  /// True once the scene is there and the renderer made; call until then, and before anything below. Errors:
  /// InvalidArgument naming
  /// "--body", and what TileRenderer::create says.
  Result<bool> ready();
  const SceneInfo& scene() const;
  /// The anchor.
  const BodyInfo& body() const;
  /// All that are in view or could be, the one of --body first: those of the scene that keep clear of it and each
  /// other.
  std::vector<BodyStatus> bodies() const;
  double largestRadiusMeters() const;
  /// The scene's, less those that the options leave out.
  std::vector<EffectCall> effects() const;

  /// Makes that body the anchor that the camera is nearest to, if it is clearly nearer than to the anchor. True if it
  /// is another: pose() is then the same camera's over that body, to within the bound of cameraOverOther, and has a
  /// roll where that body's level is another. The picture does not change.
  bool anchorNearest();
  /// Makes the body of --body the anchor, in the same way.
  void anchorFirst();

  /// The camera of a pose over the anchor, at a picture size. aboveGround: the pose's altitude counts from the ground
  /// as far as it is known.
  struct View {
    ViewPose pose;
    bool aboveGround = false;
    int widthPixels = 0, heightPixels = 0;
    double seconds = 0;  ///< since the update before: changes of level morph over time
    bool ahead = false;  ///< ask for what lies beside the picture too, after all that is in it
  };
  UpdateReport update(const View& view, const UploadBudget& budget);

  DrawStats draw();
  CoverageCount coverage();
  /// Waits until the GPU has drawn what was asked.
  void finish();

  /// The pose that update made of the view: its altitude is above the reference sphere. A camera that is above the
  /// ground is held above the drawn ground too, which may be higher as long as it is coarse.
  const ViewPose& pose() const noexcept;
  const Camera& camera() const noexcept;
  /// As pose, over the body of --body: level with it, for a flight knows no roll.
  ViewPose poseOverFirst() const;
  std::optional<double> groundHeight(const glm::dvec3& directionBody) const;
  /// Height above the finest ground under the camera; empty if none is known.
  std::optional<double> heightAboveGround() const;
  /// Share of the wanted tiles that are there, 0..1, and how many are not.
  double progress() const noexcept;
  std::size_t missing() const noexcept;
  /// Of the anchor.
  const std::vector<DrawnTile>& drawn() const noexcept;
  StreamStatus streamStatus() const;
  const SelfTestReport& selfTest() const;
  std::size_t gpuBytes() const;
  /// With ViewOptions::explain a mesh of the anchor's as long as the session lives; null otherwise.
  TilePtr keptTile(const FacePath& path) const;

  DrawSettings drawSettings;
  double errorPixels = 2;
  bool frozen = false;  ///< keep the drawn set and the requests as they are

 private:
  struct State;
  explicit ViewSession(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// "integer exact; TwoSum, TwoProd exact (precise); fma not fused": for the overlay and the figures.
std::string selfTestText(const SelfTestReport& report);

}  // namespace terrane
