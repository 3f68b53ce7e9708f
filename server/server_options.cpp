#include "server/server_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>

#include "common/byte_size.h"
#include "common/command_line.h"
#include "server/config/config_file.h"
#include "server/http/listen_address.h"
#include "server/scenes/scene_file.h"

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
  std::string draco = "fast";
  std::string maxHeader = "8KiB";
  std::string config;
  double headerTimeout = 10, idleTimeout = 60, writeTimeout = 30, responseTimeout = 60, shutdownGrace = 5;
};

std::string oneLine(std::string text) {
  std::ranges::replace(text, '\n', ' ');
  while (text.ends_with(' ')) text.pop_back();
  return text;
}

/// CLI11 begins some of its messages with the flag.
std::string withoutFlag(std::string message, const std::string& key) {
  const std::string flag = "--" + key + ": ";
  if (message.starts_with(flag)) message.erase(0, flag.size());
  return message;
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
  app.add_option("--draco", raw.draco,
                 "What encodes tiles: fast (what all tiles share is learnt from libdraco once, and checked) or stock\n"
                 "(libdraco for each). Same tiles, another speed")
      ->check(CLI::IsMember({"fast", "stock"}))
      ->type_name("CODER")
      ->capture_default_str();
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
  app.add_option("--config", raw.config,
                 "Read flags from a TOML or INI file: scene = \"moon\", threads = 4; flags given here win")
      ->type_name("FILE");
}

std::chrono::milliseconds milliseconds(double seconds) {
  return std::chrono::milliseconds(std::max<std::int64_t>(1, static_cast<std::int64_t>(seconds * 1000)));
}

Result<void> finish(ServerSettings& settings, const RawOptions& raw) {
  for (const std::string& text : settings.http.listen)
    if (const Result<ListenAddress> listen = parseListenAddress(text); !listen) return listen.error();
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
  settings.service.draco = raw.draco == "stock" ? DracoCoder::Stock : DracoCoder::Fast;
  settings.http.headerTimeout = milliseconds(raw.headerTimeout);
  settings.http.idleTimeout = milliseconds(raw.idleTimeout);
  settings.http.writeTimeout = milliseconds(raw.writeTimeout);
  settings.http.responseTimeout = milliseconds(raw.responseTimeout);
  settings.http.shutdownGrace = milliseconds(raw.shutdownGrace);
  return {};
}

/// One reading of flags, from the defaults on.
struct CommandLine {
  CommandLine() {
    addOptions(app, settings, raw);
    app.set_version_flag("--version", "terrane-server " TERRANE_VERSION, "Print the version and exit");
    app.footer(kExitStatusHelp);
    app.get_formatter()->column_width(34);
  }

  /// Throws CLI::Success for --help and --version.
  Result<void> read(std::vector<std::string> words) try {
    if (Result<void> values = checkFlagValues(words, [&](std::string_view flag) { return kindOf(flag); }); !values)
      return values;
    std::ranges::reverse(words);  // CLI11 takes them last first
    app.parse(std::move(words));
    return finish(settings, raw);
  } catch (const CLI::Success&) {
    throw;
  } catch (const CLI::ParseError& error) {
    return makeError(ErrorKind::InvalidArgument, "", oneLine(error.what()) + " (see --help)");
  }

  const CLI::Option* option(std::string_view flag) const { return app.get_option_no_throw(std::string(flag)); }
  FlagKind kindOf(std::string_view flag) const {
    if (option(flag) == nullptr) return FlagKind::Unknown;
    return option(flag)->get_items_expected_min() > 0 ? FlagKind::TakesValue : FlagKind::Switch;
  }

  CLI::App app{kDescription, "terrane-server"};
  ServerSettings settings;
  RawOptions raw;
};

/// What a line of the file is on the command line; empty for a switch that is off.
Result<std::vector<std::string>> wordsOf(const ConfigEntry& entry) {
  const std::string flag = "--" + entry.key;
  const CommandLine flags;
  if (flags.option(flag) == nullptr || entry.key == "config" || entry.key == "help" || entry.key == "version")
    return makeError(ErrorKind::InvalidArgument, flag, "no such flag in a file (see --help)");
  std::vector<std::string> words;
  if (flags.kindOf(flag) == FlagKind::TakesValue) {
    for (const std::string& value : entry.values) words.push_back(flag + "=" + value);
  } else if (entry.values.size() != 1) {
    return makeError(ErrorKind::InvalidArgument, flag, "a switch takes one value; allowed: true, false");
  } else if (entry.values[0] != "true" && entry.values[0] != "false") {
    return makeError(ErrorKind::InvalidArgument, flag,
                     quotedForMessage(entry.values[0]) + " is no value of a switch; allowed: true, false");
  } else if (entry.values[0] == "true") {
    words.push_back(flag);
  }
  if (Result<void> read = CommandLine().read(words); !read) return read.error();
  return words;
}

/// The words that stand for the file, without those whose flags were given.
Result<std::vector<std::string>> wordsOfConfig(const std::string& file, CommandLine& given) {
  const Result<std::vector<ConfigEntry>> entries = readConfigFile(file);
  if (!entries) return entries.error();
  std::vector<std::string> all;
  for (const ConfigEntry& entry : *entries) {
    const std::string place = fmt::format("{}:{}: {}", file, entry.line, entry.key);
    const Result<std::vector<std::string>> words = wordsOf(entry);
    if (!words) {
      const Error& error = words.error();
      const bool named = error.field.empty() || error.field == "--" + entry.key;
      return makeError(error.kind, place, named ? withoutFlag(error.message, entry.key) : error.text());
    }
    if (given.option("--" + entry.key)->count() > 0) continue;
    all.insert(all.end(), words->begin(), words->end());
    if (entry.key == "scene") given.settings.sceneSource = place;
  }
  return all;
}

}  // namespace

Result<std::variant<ServerSettings, PrintAndExit>> parseServerCommandLine(int argc, const char* const* argv) try {
  using Parsed = std::variant<ServerSettings, PrintAndExit>;
  std::vector<std::string> words(argv + 1, argv + argc);
  CommandLine given;
  try {
    if (Result<void> read = given.read(words); !read) return std::move(read).error();
  } catch (const CLI::CallForVersion& version) {
    return Parsed(PrintAndExit{std::string(version.what()) + "\n"});
  } catch (const CLI::Success&) {
    return Parsed(PrintAndExit{given.app.help()});
  }
  if (given.raw.config.empty()) return Parsed(std::move(given.settings));
  const Result<std::vector<std::string>> more = wordsOfConfig(given.raw.config, given);
  if (!more) return more.error();
  words.insert(words.begin(), more->begin(), more->end());
  CommandLine all;
  if (Result<void> read = all.read(words); !read) return std::move(read).error();
  all.settings.sceneSource = given.settings.sceneSource;
  return Parsed(std::move(all.settings));
} catch (const std::exception& error) {
  return makeError(ErrorKind::Internal, "", oneLine(error.what()));
}

}  // namespace terrane
