#include "client/app/view_options.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "client/app/option_values.h"
#include "client/net/server_url.h"
#include "common/command_line.h"

namespace terrane {
namespace {

constexpr double kRadiansPerDegree = std::numbers::pi / 180;

constexpr const char* kDescription =
    "Flies over the terrain that a terrane-server computes, from far orbit to the ground.";

constexpr const char* kFooter = R"(
Modes
  Without --headless, --settle, --capture, --frames or --explain a window opens and follows your hands.
  With one of them the run is scripted: it goes to its end by itself, or prints one line that says why not.
  --headless needs no display. Without --flight and --frames it implies --settle.

Controls
  drag          orbit: turn the body under the cursor     free flight: look around
  right drag    look around                               wheel: nearer, further
  W A S D Q E   fly; Shift faster, Ctrl slower; the speed follows the height above ground
  Tab mode      Home reset     P placement     F1 help and figures     F2 wireframe     F3 level colours
  F4 freeze selection          F5 changes of level          + - allowed error           F12 screenshot   Esc quit

Statistics (--stats)
  frameMs is CPU and GPU together (the GPU is waited for). uncoveredPixels and skirtPixels are counted in an own pass for every
  frame from the first full view on; that pass is not part of frameMs, and without --stats it is not drawn.

Examples
  terrane-view --server http://127.0.0.1:8080
  terrane-view --server http://127.0.0.1:8080 --camera -20.1,9.6,2,40,-10 --above-ground --headless --capture ground.png
  terrane-view --server http://127.0.0.1:8080 --headless --flight descent --settle --capture descent-%d.png --stats descent.json)";

// What CLI11 fills in before it is checked.
struct RawOptions {
  ViewOptions options;
  std::optional<std::string> camera;
  std::string size = "1280x720", placement = "auto", samples = "auto", transition = "morph", cache,
              cacheBudget = "512MiB", memoryBudget = "128MiB", bandwidth = "0";
  int latencyMs = 0;
  std::vector<std::string> without;
  double fieldOfViewDegrees = 50;
};

// Help texts start in column 40 and end before column 110.
std::string wrapped(std::string_view text) {
  constexpr std::size_t kWidth = 70;
  std::string result;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(' '), text.size());
    if (column > 0 && column + 1 + end > kWidth) {
      result += '\n';
      column = 0;
    }
    if (column > 0) result += ' ';
    result += text.substr(0, end);
    column += (column > 0 ? 1 : 0) + end;
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return result;
}

void declareOptions(CLI::App& app, RawOptions& raw) {
  ViewOptions& o = raw.options;
  app.add_option("--server", o.serverUrl, "Where the server is, e.g. http://127.0.0.1:8080")->type_name("URL");
  app.add_option("--body", o.body, "Which of the scene's bodies --camera and --flight are over (default: the first)")
      ->type_name("NAME");
  app.add_option(
         "--camera", raw.camera,
         "Degrees and metres above the reference sphere; heading from north clockwise (default 0), pitch 0 level, -90 "
         "down (default). Default: the whole body in view")
      ->type_name("LON,LAT,ALT[,HEADING,PITCH]");
  app.add_flag("--above-ground", o.aboveGround,
               "Altitudes of --camera and --flight count from the finest ground under the camera");
  app.add_option("--flight", o.flight,
                 "Fly this: descent (10,000 km to 0.2 m), orbit, ground (a walk, 30 m to 0.2 m), or a file as --record "
                 "writes it; built-in flights go to --camera's place")
      ->type_name("descent|orbit|ground|FILE");
  app.add_option("--record", o.recordFile, "Write what was flown")->type_name("FILE");
  app.add_option("--size", raw.size, "Picture size in pixels")->type_name("WxH")->capture_default_str();
  app.add_option("--fov", raw.fieldOfViewDegrees, "Vertical field of view, degrees, 1..150")
      ->type_name("DEG")
      ->capture_default_str();
  app.add_option("--error", o.errorPixels, "Allowed screen-space error, pixels, 0.1..100")
      ->type_name("PIXELS")
      ->capture_default_str();
  app.add_option("--frame-budget", o.frameBudgetMs,
                 "Hold this frame time by raising the error, up to 16 times --error; 0 is off (default)")
      ->type_name("MS");
  app.add_option(
         "--placement", raw.placement,
         "How vertices are placed: auto (what the self-test of the GPU allows), integer, double-float, cpu, float32")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_flag("--headless", o.headless, "No window, no display needed");
  app.add_flag("--settle", o.settle,
               "Wait until every view is complete before it is drawn; fails when tiles do not come");
  app.add_option("--capture", o.captureFile,
                 "Write the last picture; with %d in the name one for each point of the flight")
      ->type_name("OUT.png");
  app.add_option("--stats", o.statsFile, "Write figures of the run")->type_name("OUT.json");
  app.add_flag("--hud", o.hud, "Show the overlay in scripted runs too");
  app.add_flag("--wireframe", o.wireframe, "Begin with the edges of triangles alone (F2)");
  app.add_flag("--level-colors", o.levelColors, "Begin with a colour for each level (F3)");
  app.add_option(
         "--frames", o.frames,
         "Scripted: frames to draw (default: a flight's own number; otherwise 1, with --stats 8), spread over the "
         "whole flight unless --step says how far they are apart")
      ->type_name("N");
  app.add_option("--step", o.stepSeconds,
                 "Scripted flights: seconds between frames; the flight's own points are always among them")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--time-limit", o.timeLimitSeconds, "Scripted: give up when one view is not complete after this time")
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--cache", raw.cache,
                 "Disk cache of tiles, or none (default: $XDG_CACHE_HOME/terrane/tiles.sqlite in a window; none in "
                 "scripted runs, "
                 "so that they can be repeated)")
      ->type_name("FILE|none");
  app.add_option("--cache-budget", raw.cacheBudget, "Most that the disk cache takes")
      ->type_name("SIZE")
      ->capture_default_str();
  app.add_option("--memory-budget", raw.memoryBudget, "Most that tiles in memory take, what is in view excepted")
      ->type_name("SIZE")
      ->capture_default_str();
  app.add_option("--latency", raw.latencyMs,
                 "Fly under a worse network: no answer sooner than this after its request, 0..10000; 0 is off "
                 "(default). The network's own time limits do not count it, --time-limit does. A scripted flight "
                 "without --settle then takes its time, as in a window")
      ->type_name("MS");
  app.add_option("--bandwidth", raw.bandwidth,
                 "The same: what all answers together may bring, as 2MB/s, 500KiB/s or in bytes per second; 0 is off "
                 "(default)")
      ->type_name("BYTES/S");
  app.add_flag("--explain", o.explain, "Print each effect, on or off, why, and what it costs here; then leave");
}

void declarePictureOptions(CLI::App& app, RawOptions& raw) {
  app.add_option(
         "--msaa", raw.samples,
         "Samples a pixel for smooth edges, 2, 4 or 8, or off; auto is 4 on a GPU and off where software draws. "
         "More than the driver has are the most that it has")
      ->type_name("N|auto|off")
      ->capture_default_str();
  app.add_option("--transition", raw.transition,
                 "How a change of level is shown: morph, or to compare: blend (both levels mixed by alpha), none (it "
                 "pops)")
      ->type_name("NAME")
      ->capture_default_str();
  app.add_option("--without", raw.without,
                 "Leave out this effect of the scene, as if it did not name it: to compare. May be given several times")
      ->type_name("EFFECT")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

Result<std::size_t> checkRange(std::string_view flag, double value, double low, double high) {
  if (value >= low && value <= high) return std::size_t{0};
  return flagError(flag, fmt::format("{} is out of range: {} to {}", value, low, high));
}

Result<std::size_t> checkCapture(const ViewOptions& options) {
  const std::size_t percent = options.captureFile.find('%');
  if (percent == std::string::npos) return std::size_t{0};
  if (options.captureFile.compare(percent, 2, "%d") != 0 ||
      options.captureFile.find('%', percent + 1) != std::string::npos)
    return flagError("--capture",
                     fmt::format("\"{}\": %d may stand in the name once, and no other %", options.captureFile));
  if (options.flight.empty()) return flagError("--capture", "%d counts the points of a flight: --flight is missing");
  return std::size_t{0};
}

std::string defaultCacheFile(EnvironmentLookup environment) {
  std::string base = environment("XDG_CACHE_HOME");
  if (base.empty()) {
    const std::string home = environment("HOME");
    if (home.empty()) return {};
    base = home + "/.cache";
  }
  return base + "/terrane/tiles.sqlite";
}

Result<ViewOptions> checked(RawOptions raw, EnvironmentLookup environment) {
  ViewOptions& o = raw.options;
  if (o.serverUrl.empty())
    return flagError("--server", "is missing: where is the server? e.g. --server http://127.0.0.1:8080");
  if (const auto server = parseServerUrl(o.serverUrl); !server) return server.error();
  if (raw.camera) {
    const auto pose = parseCamera(*raw.camera);
    if (!pose) return pose.error();
    o.camera = *pose;
  }
  const auto size = parseSize(raw.size);
  if (!size) return size.error();
  std::tie(o.widthPixels, o.heightPixels) = *size;
  if (raw.placement != "auto") {
    const auto placement = parsePlacement(raw.placement);
    if (!placement) return placement.error();
    o.placement = *placement;
  }
  const auto samples = parseSamples(raw.samples);
  if (!samples) return samples.error();
  o.samples = *samples;
  auto without = parseEffects(raw.without);
  if (!without) return without.error();
  o.without = std::move(*without);
  const auto transition = parseTransition(raw.transition);
  if (!transition) return transition.error();
  o.transition = *transition;
  for (const auto& range :
       {checkRange("--fov", raw.fieldOfViewDegrees, 1, 150), checkRange("--error", o.errorPixels, 0.1, 100),
        checkRange("--frame-budget", o.frameBudgetMs, 0, 10'000), checkRange("--frames", o.frames, 0, 1e6),
        checkRange("--step", o.stepSeconds, 1e-4, 1e6), checkRange("--time-limit", o.timeLimitSeconds, 0.1, 1e6),
        checkRange("--latency", raw.latencyMs, 0, 10'000), checkCapture(o)})
    if (!range) return range.error();
  o.verticalFieldOfView = raw.fieldOfViewDegrees * kRadiansPerDegree;
  const auto cacheBudget = parseBudget(raw.cacheBudget, "--cache-budget");
  if (!cacheBudget) return cacheBudget.error();
  const auto memoryBudget = parseBudget(raw.memoryBudget, "--memory-budget");
  if (!memoryBudget) return memoryBudget.error();
  o.cacheBudgetBytes = *cacheBudget;
  o.memoryBudgetBytes = *memoryBudget;
  const auto bandwidth = parseBandwidth(raw.bandwidth);
  if (!bandwidth) return bandwidth.error();
  o.network = {std::chrono::milliseconds(raw.latencyMs), *bandwidth};
  if (o.headless && o.flight.empty() && o.frames == 0) o.settle = true;
  o.cacheIsDefault = raw.cache.empty();
  if (o.cacheIsDefault)
    o.cacheFile = o.scripted() ? std::string{} : defaultCacheFile(environment);
  else if (raw.cache != "none")
    o.cacheFile = raw.cache;
  return std::move(raw.options);
}

// CLI11 words its messages "--error: Could not convert..." or names the flag at the end; here the flag is a field of
// its own.
Error errorOf(const CLI::ParseError& error, const CLI::App& app) {
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    const auto extra = app.remaining();
    return flagError(extra.empty() ? "" : extra.front(), "no such flag (terrane-view --help lists them)");
  }
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr) {  // "Could not convert: --error = abc"
    const std::size_t flag = message.find("--"), value = message.find(" = ");
    if (flag != std::string::npos && value != std::string::npos && value > flag)
      return flagError(message.substr(flag, value - flag),
                       fmt::format("\"{}\" is no number", message.substr(value + 3)));
  }
  if (message.rfind("--", 0) == 0) {
    const std::size_t end = message.find_first_of(": ");
    const std::size_t text = message.find_first_not_of(": ", end);
    return flagError(message.substr(0, end), text == std::string::npos ? "wrong value" : message.substr(text));
  }
  const std::size_t flag = message.find("--");
  if (flag == std::string::npos) return flagError("", message);
  return flagError(message.substr(flag, message.find_first_of(": ", flag) - flag), message);
}

}  // namespace

Result<std::variant<ViewOptions, OptionsText>> parseViewOptions(const std::vector<std::string>& arguments,
                                                                EnvironmentLookup environment) {
  using Parsed = std::variant<ViewOptions, OptionsText>;
  CLI::App app{kDescription, "terrane-view"};
  RawOptions raw;
  declareOptions(app, raw);
  declarePictureOptions(app, raw);
  app.footer(std::string(kFooter) + "\n\n" + kExitStatusHelp);
  app.set_version_flag("--version", "terrane-view " TERRANE_VERSION);
  app.get_formatter()->column_width(40);
  for (CLI::Option* option : app.get_options()) option->description(wrapped(option->get_description()));
  const auto kindOf = [&](std::string_view flag) {
    const CLI::Option* option = app.get_option_no_throw(std::string(flag));
    if (option == nullptr) return FlagKind::Unknown;
    return option->get_items_expected_min() > 0 ? FlagKind::TakesValue : FlagKind::Switch;
  };
  if (const auto values = checkFlagValues(arguments, kindOf); !values) return values.error();
  try {
    app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 takes them last first
  } catch (const CLI::CallForHelp&) {
    return Parsed{OptionsText{app.help()}};
  } catch (const CLI::CallForVersion& version) {
    return Parsed{OptionsText{std::string(version.what()) + "\n"}};
  } catch (const CLI::ParseError& error) {
    return errorOf(error, app);
  }
  raw.options.stepGiven = app.count("--step") > 0;
  auto options = checked(std::move(raw), environment);
  if (!options) return options.error();
  return Parsed{std::move(*options)};
}

}  // namespace terrane
