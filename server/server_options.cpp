#include "server/server_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "server/scenes/scene_file.h"
#include "server/store/byte_size.h"

namespace terrane {
namespace {

/// A range that NaN is outside of (CLI::Range lets it pass).
CLI::Validator secondsFrom(double least) {
  constexpr double kMost = 86'400;
  const std::string range = fmt::format("{} to {} seconds", least, kMost);
  return {[=](std::string& text) {
            double value = 0;
            const bool isNumber = CLI::detail::lexical_cast(text, value);
            return isNumber && value >= least && value <= kMost ? std::string() : text + " is not " + range;
          },
          range};
}

constexpr const char* kDescription =
    "Serves the terrain of whole planets: Draco glTF tiles computed on demand.\n"
    "Prints one line with its URL when it is ready; logs go to stderr. SIGTERM and SIGINT let what is\n"
    "under way finish, a second one ends at once.";

/// What CLI11 fills; strings that need our own reading are read after it.
struct RawOptions {
  std::string memoryCache = "256MiB";
  std::string simd;
  std::string maxHeader = "8KiB";
  double headerTimeout = 10, idleTimeout = 60, writeTimeout = 30, responseTimeout = 60, shutdownGrace = 5;
};

std::string oneLine(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

void addOptions(CLI::App& app, ServerSettings& settings, RawOptions& raw) {
  const std::string scenes = fmt::format("{}", fmt::join(shippedScenes(), ", "));
  app.add_option("--scene", settings.scene,
                 "What to serve: a scene that ships (" + scenes + ") or a path to a .toml file")
      ->type_name("NAME|FILE")
      ->capture_default_str();
  app.add_option("--listen", settings.http.listen,
                 "HOST:PORT to listen on; may be repeated. [::1]:8080 for IPv6; port 0 picks a free one")
      ->type_name("HOST:PORT")
      ->default_str("127.0.0.1:8080")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->expected(1)
      ->allow_extra_args(false);
  app.add_option("--threads", settings.service.threads, "Threads that build tiles; 0: one for each CPU")
      ->check(CLI::Range(0, 1024))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--io-threads", settings.http.ioThreads, "Threads that move bytes")
      ->check(CLI::Range(1, 256))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--memory-cache", raw.memoryCache, "Bytes of finished tiles kept in memory, as 256MiB; 0 keeps none")
      ->type_name("SIZE")
      ->capture_default_str();
  app.add_option("--max-queued", settings.service.maxQueuedBuilds,
                 "Tiles that may wait to be built; beyond that requests get 503")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--cells", settings.service.wire.cellsPerEdge, "Cells along a tile's edge: 16, 32, 64 or 128")
      ->check(CLI::IsMember({16, 32, 64, 128}))
      ->type_name("N")
      ->capture_default_str();
  app.add_option(
         "--simd", raw.simd,
         "Vector instructions for the height field: default, v3 (AVX2) or v4 (AVX-512). Same tiles, another speed.\n"
         "Without it: the best that this CPU has")
      ->type_name("LEVEL");
  app.add_option("--max-connections", settings.http.maxConnections, "Connections at once; beyond that they get 503")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--header-timeout", raw.headerTimeout, "Seconds for a request's header to arrive")
      ->check(secondsFrom(0.001))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--idle-timeout", raw.idleTimeout, "Seconds that a connection may be silent between requests")
      ->check(secondsFrom(0.001))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--write-timeout", raw.writeTimeout, "Seconds without a byte of a response being taken")
      ->check(secondsFrom(0.001))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--response-timeout", raw.responseTimeout, "Seconds for a tile to be built; then 503")
      ->check(secondsFrom(0.001))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--max-header", raw.maxHeader, "Bytes of a request's header, 1KiB to 1MiB; beyond that 431")
      ->type_name("SIZE")
      ->capture_default_str();
  app.add_option("--shutdown-grace", raw.shutdownGrace, "Seconds for what is under way when the server stops")
      ->check(secondsFrom(0.0))
      ->type_name("S")
      ->capture_default_str();
  app.add_option("--log-level", settings.logLevel, "What goes to stderr: debug, info, warn, error or off")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}))
      ->type_name("LEVEL")
      ->capture_default_str();
  app.add_flag("--check", settings.check, "Validate the scene, say so, and exit");
  app.add_flag("--explain", settings.explain,
               "Print the bodies, each effect (on or off, why, its cost) and what was constructed, and exit");
  app.set_config("--config", "",
                 "Read flags from a TOML or INI file: scene = \"moon\", threads = 4; flags given here win");
  app.allow_config_extras(CLI::config_extras_mode::error);
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(std::max<std::int64_t>(1, static_cast<std::int64_t>(seconds * 1000)));
}

Result<void> finish(ServerSettings& settings, const RawOptions& raw) {
  const Result<std::size_t> cache = parseByteSize(raw.memoryCache, "--memory-cache");
  if (!cache) return cache.error();
  settings.service.memoryCacheBytes = *cache;
  const Result<std::size_t> header = parseByteSize(raw.maxHeader, "--max-header");
  if (!header) return header.error();
  if (*header < 1024 || *header > 1024 * 1024)
    return makeError(ErrorKind::InvalidArgument, "--max-header",
                     fmt::format("\"{}\" is out of range; allowed: 1KiB to 1MiB", raw.maxHeader));
  settings.http.maxHeaderBytes = *header;
  settings.service.simd = bestSimdPath();
  if (!raw.simd.empty()) {
    const Result<SimdPath> simd = parseSimdPath(raw.simd);
    if (!simd) return simd.error();
    if (!simdPathSupported(*simd))
      return makeError(ErrorKind::Unsupported, "--simd", fmt::format("this CPU has no \"{}\"", raw.simd));
    settings.service.simd = *simd;
  }
  settings.http.headerTimeout = milliseconds(raw.headerTimeout);
  settings.http.idleTimeout = milliseconds(raw.idleTimeout);
  settings.http.writeTimeout = milliseconds(raw.writeTimeout);
  settings.http.responseTimeout = milliseconds(raw.responseTimeout);
  settings.http.shutdownGrace = milliseconds(raw.shutdownGrace);
  return {};
}

}  // namespace

Result<std::variant<ServerSettings, PrintAndExit>> parseServerCommandLine(int argc, const char* const* argv) try {
  using Parsed = std::variant<ServerSettings, PrintAndExit>;
  ServerSettings settings;
  RawOptions raw;
  CLI::App app(kDescription, "terrane-server");
  addOptions(app, settings, raw);
  app.set_version_flag("--version", "terrane-server " TERRANE_VERSION, "Print the version and exit");
  app.get_formatter()->column_width(34);
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForVersion& version) {
    return Parsed(PrintAndExit{std::string(version.what()) + "\n"});
  } catch (const CLI::CallForHelp&) {
    return Parsed(PrintAndExit{app.help()});
  } catch (const CLI::ParseError& error) {
    return makeError(ErrorKind::InvalidArgument, "", oneLine(error.what()) + " (see --help)");
  }
  if (Result<void> finished = finish(settings, raw); !finished) return std::move(finished).error();
  return Parsed(std::move(settings));
} catch (const std::exception& error) {
  return makeError(ErrorKind::Internal, "", oneLine(error.what()));
}

}  // namespace terrane
