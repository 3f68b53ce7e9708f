#pragma once
// The command line of terrane-view as plain values. Degrees and metres as a person writes them become radians and
// metres here. No GL, no files are touched. Thread-safe.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "client/flight/flight_file.h"
#include "client/net/simulated_link.h"
#include "client/render/tile_renderer.h"
#include "common/result.h"
#include "common/scene/effects.h"
#include "common/view/camera.h"

namespace terrane {

struct ViewOptions {
  std::string serverUrl;
  std::string body;                    ///< empty: the scene's first
  std::optional<ViewPose> camera;      ///< none: the whole body in view
  bool aboveGround = false;            ///< the camera's altitude counts from the finest ground under it
  std::string flight;                  ///< "descent", "orbit", "ground", a file, or empty
  std::optional<Flight> flightOfFile;  ///< the file's, once it was read (readFlight)
  std::string recordFile;
  int widthPixels = 1280, heightPixels = 720;
  double verticalFieldOfView = 0.8726646259971648;  ///< 50 degrees
  double errorPixels = 2;
  double frameBudgetMs = 0;            ///< 0: off
  std::optional<Placement> placement;  ///< none: what the self-test of the GPU chose
  Transition transition = Transition::Morph;
  std::optional<int> samples;       ///< a pixel; 1 is no multisampling; none: what suits the renderer
  std::vector<EffectKind> without;  ///< effects to leave out of the scene's
  bool headless = false, settle = false, hud = false, explain = false;
  bool wireframe = false, levelColors = false;
  std::string captureFile;  ///< "%d" in it: one picture for each point of the flight
  std::string statsFile;
  std::string cacheFile;        ///< empty: no disk cache
  bool cacheIsDefault = false;  ///< nobody asked for it: what goes wrong with it stops nothing
  std::size_t cacheBudgetBytes = 512u << 20;
  std::size_t memoryBudgetBytes = 128u << 20;
  NetworkConditions network;
  int frames = 0;                 ///< 0: as many as it takes
  double stepSeconds = 1.0 / 30;  ///< of a scripted flight
  bool stepGiven = false;         ///< otherwise --frames spreads over the whole flight
  double timeLimitSeconds = 120;  ///< for one view to be complete in a scripted run

  /// Runs to an end by itself, with a fixed time step, instead of following a person's hands.
  bool scripted() const { return headless || settle || explain || frames > 0 || !captureFile.empty(); }
};

/// --help or --version: print it and leave with 0.
struct OptionsText {
  std::string text;
};

/// arguments without the program's name. environment: looks up a variable, for the default cache file; empty if not
/// set. Errors: InvalidArgument; field names the flag.
using EnvironmentLookup = std::string (*)(const char* name);
Result<std::variant<ViewOptions, OptionsText>> parseViewOptions(const std::vector<std::string>& arguments,
                                                                EnvironmentLookup environment);

}  // namespace terrane
