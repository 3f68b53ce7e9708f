#pragma once
// One body of the scene as the viewer has it: what of it is wanted and drawn from where the camera is, frame by frame.
// GL thread only.

#include <optional>
#include <unordered_set>
#include <vector>

#include "client/render/body_picture.h"
#include "client/tiles/tile_stream.h"
#include "common/view/camera.h"
#include "common/view/level_transitions.h"
#include "common/view/tile_selection.h"

namespace terrane {

/// A body whose disc is smaller than this across is not drawn and costs no tile: on a black sky it would add less than
/// a pixel of its own light.
inline constexpr double kLeastDiameterPixels = 1;

class BodyView {
 public:
  /// index: of the body among those that the stream has selected; the stream outlives it.
  BodyView(TileStream& stream, std::size_t index) : stream_(stream), index_(index) {}

  const BodyInfo& info() const { return *stream_.body(index_); }
  std::size_t index() const noexcept { return index_; }
  /// A radius that no ground of it is above.
  double highestRadiusMeters() const;

  void changeLevelsOverTime(bool wanted);
  /// What is wanted from there, and from what is wanted to what is drawn; true if that is another picture.
  bool choose(const Camera& from, double allowedPixels, double seconds);
  /// The same again from a camera that was held above what choose has drawn. What was wanted from the lower one is
  /// asked for too, or what keeps the camera up would never come.
  bool chooseHigher(const Camera& from, double allowedPixels);
  /// As from so far away that there is nothing of it; true if that is another picture.
  bool hide();

  /// Where a body's ground counts too, seen or not: under the camera.
  struct GroundCall {
    ViewPose pose;
    /// The camera's own height depends on the ground, so until that is known no fine tile is asked for where the camera
    /// only seems to be.
    bool first = false;
  };
  /// Asks for the selection and the ground; true when the ground's finest wanted tile is there, or none is called for.
  /// from: as choose had it. ahead: for what lies beside the picture too, after all that is in it.
  bool request(const Camera& from, double allowedPixels, const std::optional<GroundCall>& ground, bool ahead);

  std::optional<TileStream::Ground> groundBelow(const ViewPose& pose) const;
  /// Under the drawn ground there is nothing to see. It may be higher than the finest ground that is known, from which
  /// poses count, as long as it is coarse: a fine tile has come and has not grown in yet. Then the camera stays above
  /// it by half its height above that ground, and sinks as the drawn ground does.
  double altitudeAboveDrawn(const ViewPose& viewed) const;

  bool isComplete() const noexcept { return selection_.complete; }
  bool isSettled() const noexcept { return selection_.complete && transitions_.settled() && missing_ == 0; }
  std::size_t missing() const noexcept { return missing_; }
  std::size_t wanted() const noexcept { return wantedCount_; }
  const std::vector<DrawnTile>& drawn() const noexcept { return drawn_; }
  std::vector<FacePath> drawnPaths() const;
  BodyPicture picture(const Camera& from) const;

 private:
  bool select(const Camera& from, double allowedPixels, double seconds);
  std::vector<WantedTile> groundChain(const Camera& from, const ViewPose& pose, double allowedPixels) const;
  void addBesidePicture(const Camera& from, double allowedPixels, std::unordered_set<FacePath>& known,
                        std::vector<WantedTile>& wanted) const;
  ResidentLookup lookup() const;

  TileStream& stream_;
  std::size_t index_;
  TileSelection selection_;
  std::vector<WantedTile> wantedLower_;  ///< since choose
  LevelTransitions transitions_;
  bool hidden_ = false;   ///< since the last choice: nothing of it is wanted, beside the picture neither
  bool overTime_ = true;  ///< what transitions_ was made for
  std::vector<DrawnTile> drawn_;
  std::size_t missing_ = 0, wantedCount_ = 0;
};

}  // namespace terrane
