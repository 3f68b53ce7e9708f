#pragma once
// The command line of terrane-server. Main thread only.

#include <string>
#include <variant>

#include "common/result.h"
#include "server/http/http_server.h"
#include "server/http/tile_service.h"

namespace terrane {

struct ServerSettings {
  std::string scene = "moon";
  std::string sceneSource = "--scene";  ///< where that was said: the flag, or file, line and key
  ServerOptions http;
  TileService::Options service;
  std::string logLevel = "info";
  bool check = false;    ///< validate the scene and exit
  bool explain = false;  ///< describe what would run and exit
};

/// Text to print to stdout, exit 0: --help, --version.
struct PrintAndExit {
  std::string text;
};

/// Reads the file of --config too. Errors: one line; field names the flag, or file, line and key, where one is to
/// blame.
Result<std::variant<ServerSettings, PrintAndExit>> parseServerCommandLine(int argc, const char* const* argv);

}  // namespace terrane
