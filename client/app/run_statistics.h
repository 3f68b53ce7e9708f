#pragma once
// The figures of a run, and their JSON (--stats). Plain data; milliseconds, bytes, metres, degrees as the names say.

#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "client/app/body_status.h"
#include "client/render/tile_renderer.h"
#include "client/tiles/tile_stream.h"
#include "common/result.h"
#include "common/view/camera.h"

namespace terrane {

/// Frame times of a run: percentiles over the last kKept frames (a quarter of a million: more than an hour at 60 a
/// second).
class FrameTimes {
 public:
  static constexpr std::size_t kKept = 1u << 18;
  void add(double milliseconds);
  std::uint64_t count() const noexcept { return count_; }
  /// share 0.5 is the median (nearest rank); 0 when there was no frame.
  double percentile(double share) const;
  double longest() const noexcept { return longest_; }
  /// The last frames, oldest first, at most n.
  std::vector<float> last(std::size_t n) const;

 private:
  std::vector<float> kept_;
  std::uint64_t count_ = 0;
  double longest_ = 0;
};

/// One point of a flight that was captured.
struct PointStatistics {
  std::string name;           ///< the altitude as a person reads it: "100 km"
  double altitudeMeters = 0;  ///< as the flight has it
  std::uint64_t frames = 0;   ///< since the point before
  double medianMs = 0;        ///< of those frames
  std::size_t tilesDrawn = 0;
  std::uint64_t bytesReceived = 0;  ///< since the point before
  std::uint64_t uncoveredPixels = 0, skirtPixels = 0;
  std::string capture;  ///< the picture's file, empty if none was asked for
};

struct RunStatistics {
  FrameTimes frameTimes;
  double msToSettle = -1;  ///< from the program's start to the first full view; -1: never
  DrawStats drawn;         ///< in the last frame
  std::uint64_t uncoveredPixels = 0, skirtPixels = 0, framesCounted = 0;
  std::uint64_t rssBytes = 0, gpuBytes = 0;
  double errorPixels = 0;
  Placement placement = Placement::Integer;
  Transition transition = Transition::Morph;
  SelfTestReport selfTest;
  StreamStatus stream;
  ViewPose pose;                        ///< of the last frame
  double heightAboveGroundMeters = -1;  ///< -1: not known
  int widthPixels = 0, heightPixels = 0;
  std::string server, scene;
  std::string body;                                      ///< the anchor, which the camera is relative to
  std::vector<BodyStatus> bodies;                        ///< in the last frame
  std::vector<std::string> effects;                      ///< that the scene names, less those left out
  std::vector<std::pair<std::string, int>> constructed;  ///< by name
  std::vector<PointStatistics> points;
};

std::string statisticsJson(const RunStatistics& statistics);
/// Errors name the flag.
Result<std::size_t> writeTextFile(const std::string& text, const std::string& file, const std::string& flag);

/// Resident memory of this process; 0 where the system does not tell.
std::uint64_t residentSetBytes();

}  // namespace terrane
