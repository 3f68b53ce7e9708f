#pragma once
// What a change of level does to the picture: just before and just after it, under one camera, over flights whose
// tiles come late. GL thread only; a context must be current. Deterministic.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "client/flight/flight_file.h"
#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/tile_renderer.h"
#include "common/view/drawn_tile.h"
#include "tests/support/tile_source.h"

namespace terrane {

enum class PopFlight : std::uint8_t {
  Descent,  ///< the viewer's own: 10,000 km to 0.2 m above ground in a minute
  Walk,     ///< 280 m over the ground in a minute, turning, 2 m above it and at the end 0.2 m
};
inline constexpr std::array kPopFlights{PopFlight::Descent, PopFlight::Walk};
std::string_view popFlightName(PopFlight flight) noexcept;

inline constexpr double kPopFrameSeconds = 0.03;
inline constexpr int kPopFlightFrames = 2000;  ///< of a whole flight
/// That arrive, some 55 KiB; on the ground fewer than the view asks for.
constexpr int popTilesPerFrame(Scheme scheme) noexcept { return scheme == Scheme::Cube ? 3 : 5; }

struct Pops {
  int frames = 0;
  int changes = 0;  ///< of the drawn set, in frames in which more happened than that tiles entered or left the view
  double worstRms = 0, medianRms = 0;    ///< of 255, over all channels
  double worstPerMillion = 0;            ///< pixels of which a channel differs by more than 8 of 255
  std::uint64_t uncovered = 0;           ///< pixels in all frames
  std::size_t tiles = 0;                 ///< drawn in all frames
  std::uint64_t hurried = 0, jumps = 0;  ///< changes that could not wait (TransitionCounts)
};

class PopMeter {
 public:
  /// Throws std::runtime_error where what draws cannot be had. The source must outlive it, and may have served another.
  PopMeter(TileSource& moon, PopFlight flight, Transition transition, int widthPixels, int heightPixels);

  /// What one frame draws, for those who want to draw it again.
  struct Moment {
    Camera camera;
    std::vector<DrawnTile> drawn;
    std::vector<FacePath> wanted;  ///< what would be drawn at once
  };

  /// Flies so many frames in the middle of the flight, beginning with a full view and what lies beside it.
  /// eachFrame: after it was drawn.
  Pops fly(int frames, const std::function<void(const Moment&)>& eachFrame = {});
  /// Returns when the picture is there.
  DrawStats draw(const Moment& moment, Transition transition);

 private:
  Camera cameraAt(int frame) const;
  bool isThere(const FacePath& path) const { return resident_.contains(path); }
  void load(const FacePath& path);
  ResidentLookup lookup() const;
  TileSelection select(const Camera& camera) const;
  void loadLate(const Camera& camera, const TileSelection& selection);
  void settle(const Camera& camera);
  Image picture(const Camera& camera, const std::vector<DrawnTile>& tiles);
  void compare(const Camera& camera, const std::vector<DrawnTile>& before, const std::vector<DrawnTile>& after);

  TileSource& moon_;
  Flight flight_;
  DrawSettings settings_;
  int widthPixels_, heightPixels_;
  std::unique_ptr<TileRenderer> renderer_;
  RenderTarget target_;
  std::unordered_map<FacePath, ResidentTile> resident_;
  Pops pops_;
  std::vector<double> rms_;
};

}  // namespace terrane
