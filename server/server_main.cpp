// terrane-server: reads a scene, serves its tiles until SIGTERM or SIGINT.

#include <fmt/format.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <thread>

#include "common/byte_size.h"
#include "common/command_line.h"
#include "common/memory/heap_policy.h"
#include "common/scene/scene.h"
#include "server/explain.h"
#include "server/http/http_server.h"
#include "server/http/tile_service.h"
#include "server/scenes/scene_file.h"
#include "server/server_options.h"

namespace terrane {
namespace {

/// One line to stderr, and the exit status.
int complain(const std::string& text, int status) {
  terrane::complain("terrane-server", text);
  return status;
}

void printOut(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

/// File descriptors for every connection that is allowed, as far as the system lets us.
void raiseDescriptorLimit(std::size_t maxConnections) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = static_cast<rlim_t>(maxConnections) + 64;
  if (limit.rlim_cur >= wanted) return;
  limit.rlim_cur = std::min(wanted, limit.rlim_max);
  setrlimit(RLIMIT_NOFILE, &limit);
}

sigset_t endingSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

/// The first signal stops the server with grace, the second ends the program at once. The pointers are not touched
/// after the first.
void watchSignals(HttpServer* server, TileService* service) {
  const sigset_t signals = endingSignals();
  int signal = 0;
  if (sigwait(&signals, &signal) != 0) return;
  spdlog::info("stopping; a second signal ends at once");
  service->setReady(false);
  server->stop();
  sigwait(&signals, &signal);
  _exit(kExitFailed);
}

/// What encodes each body's tiles; a warning where it is not what was asked for.
void logCoders(const TileService& service, DracoCoder wanted) {
  for (std::size_t i = 0; i < service.whyStockDraco().size(); ++i) {
    const std::string &body = service.scene().bodies[i].name, &why = service.whyStockDraco()[i];
    if (why.empty())
      spdlog::info("{}: tiles are encoded by a template learnt from libdraco", body);
    else
      spdlog::log(wanted == DracoCoder::Stock ? spdlog::level::info : spdlog::level::warn,
                  "{}: every tile is encoded by libdraco: {}", body, why);
  }
}

int serve(const Scene& scene, const ServerSettings& settings) {
  keepFreedMemory(kHeapKeptByServer);
  raiseDescriptorLimit(settings.http.maxConnections);
  // Blocked before any thread starts, so that only sigwait sees them.
  const sigset_t signals = endingSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);

  TileService service(scene, settings.service);
  const Result<std::unique_ptr<HttpServer>> server = HttpServer::open(settings.http, service);
  if (!server) return complain(server.error().text(), exitStatus(server.error()));
  std::thread(watchSignals, server->get(), &service).detach();

  std::string urls;
  for (const std::string& url : (*server)->urls()) urls += " " + url;
  printOut(fmt::format("terrane-server: serving {} on{}\n", scene.name, urls));
  spdlog::info("memory cache {}", formatByteSize(settings.service.memoryCacheBytes));
  logCoders(service, settings.service.draco);
  (*server)->run();

  const TileCacheStats stats = service.cacheStats();
  spdlog::info("stopped after {} tiles built, {} from memory", stats.builds, stats.hits);
  return 0;
}

int run(int argc, char** argv) {
  auto parsed = parseServerCommandLine(argc, argv);
  if (!parsed) return complain(parsed.error().text(), kExitWrongUsage);
  if (const auto* text = std::get_if<PrintAndExit>(&*parsed)) return printOut(text->text), 0;
  const ServerSettings& settings = std::get<ServerSettings>(*parsed);

  spdlog::set_default_logger(spdlog::stderr_color_mt("terrane-server"));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %^%l%$ %v");
  spdlog::set_level(spdlog::level::from_str(settings.logLevel));

  const Result<Scene> scene = loadScene(settings.scene);
  if (!scene) {  // what is wrong within a scene file says file, line and key by itself
    const Error& error = scene.error();
    const bool notRead = error.field == "--scene" || error.kind == ErrorKind::NotFound || error.kind == ErrorKind::Io;
    const std::string text = notRead ? settings.sceneSource + ": " + error.message : error.message;
    return complain(text, kExitWrongUsage);
  }
  if (settings.check) {
    printOut(fmt::format("terrane-server: scene {} is valid: {} {}, {} {}\n", scene->name, scene->bodies.size(),
                         scene->bodies.size() == 1 ? "body" : "bodies", scene->effects.size(),
                         scene->effects.size() == 1 ? "effect" : "effects"));
    return 0;
  }
  if (settings.explain) return printOut(explainScene(*scene, settings.service)), 0;
  return serve(*scene, settings);
}

}  // namespace
}  // namespace terrane

int main(int argc, char** argv) {
  try {
    return terrane::run(argc, argv);
  } catch (const std::exception& error) {
    terrane::complain("terrane-server", error.what());
    return terrane::kExitFailed;
  }
}
