#pragma once
// The overlay: figures of the flight, what is loading, what went wrong, and the keys. It shows and never takes input.
// Draws into the current framebuffer after the scene and leaves the GL state as it was. GL thread only.

#include <memory>
#include <span>
#include <string>

#include "common/result.h"

namespace terrane {

/// What is shown; lengths in metres.
struct HudState {
  std::string body;           ///< that the camera is over; empty where there is only one
  double altitudeMeters = 0;  ///< above the reference sphere
  double groundMeters = 0;    ///< height above the finest known ground
  bool groundKnown = false;
  double longitudeDegrees = 0, latitudeDegrees = 0, headingDegrees = 0, pitchDegrees = 0;
  double speedMetersPerSecond = 0;
  std::span<const float> frameMs;  ///< of the last frames, oldest first
  double medianMs = 0;
  double errorPixels = 0, askedErrorPixels = 0;
  int samples = 1;  ///< a pixel
  std::size_t tilesDrawn = 0, tilesLoading = 0, tilesResident = 0, triangles = 0;
  std::size_t bytesReceived = 0, residentBytes = 0, gpuBytes = 0, rssBytes = 0;
  /// network, link, notice: empty when there is nothing to say.
  std::string placement, transition, selfTest, mode, network, link, notice;
  double progress = 1;  ///< towards the first full view
  bool firstViewComplete = false;
  bool frozen = false, wireframe = false, levelColors = false;
};

class Hud {
 public:
  /// pixelScale: 1 on an ordinary display, 2 on one of double density. Errors: Unsupported.
  static Result<std::unique_ptr<Hud>> create(float pixelScale);
  ~Hud();
  Hud(const Hud&) = delete;
  Hud& operator=(const Hud&) = delete;

  /// figures: the whole overlay; otherwise only the progress bar and what needs saying.
  void draw(const HudState& state, bool figures, int widthPixels, int heightPixels);

 private:
  explicit Hud(float pixelScale) : scale_(pixelScale) {}
  float scale_;
};

}  // namespace terrane
