// Reads the #include lines of the whole tree and proves the rules that hold it together:
//   common <- proto <- {server, client}; server and client never include each other; nothing but tests includes tests;
//   a third-party library stays in the folder that is its seam;
//   at most two translation units are coroutines, which take minutes to compile with sanitizers;
//   folders do not depend on each other in a circle.
// Prints the graph of folders, which ARCHITECTURE.md shows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/folders.h"

namespace {

namespace fs = std::filesystem;

struct SourceFile {
  std::string path;  ///< from the root of the tree, "server/http/http_server.cpp"
  std::vector<std::string> lines;
};

struct Include {
  int line = 0;
  std::string target;
};

SourceFile sourceFile(std::string path, const std::string& text) {
  SourceFile file{std::move(path), {}};
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) file.lines.push_back(line);
  return file;
}

std::vector<Include> includesOf(const SourceFile& file) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> includes;
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    std::smatch match;
    if (file.lines[i].find("include") != std::string::npos && std::regex_search(file.lines[i], match, pattern))
      includes.push_back({static_cast<int>(i + 1), match[1]});
  }
  return includes;
}

std::string topFolder(const std::string& path) { return path.substr(0, path.find('/')); }

const std::map<std::string, std::set<std::string>>& layers() {
  static const std::map<std::string, std::set<std::string>> allowed{
      {"common", {"common"}},
      {"proto", {"common", "proto"}},
      {"server", {"common", "proto", "server"}},
      {"client", {"common", "proto", "client"}},
      {"tests", {"common", "proto", "server", "client", "tests"}},
  };
  return allowed;
}

/// A library and the only files that may include its headers.
struct Seam {
  const char* library;
  std::regex headers;
  std::regex files;
};

const std::vector<Seam>& seams() {
  static const std::vector<Seam> all{
      {"Draco", std::regex("^draco/"), std::regex(R"(^proto/.*\.cpp$)")},
      {"tinygltf", std::regex("tiny_gltf\\.h$"), std::regex(R"(^proto/.*\.cpp$)")},
      {"JSON", std::regex("^(nlohmann|rapidjson|boost/json)"),
       std::regex(R"(^proto/.*\.cpp$|^proto/json_[a-z_]+\.h$)")},
      {"Asio and Beast", std::regex("^boost/(asio|beast)"), std::regex("^(server/http|client/net)/")},
      {"OpenGL", std::regex("^(GL|GLES[23]?|EGL|epoxy|GLFW|KHR)/|^imgui"), std::regex("^client/")},
      {"toml++", std::regex(R"(^toml(\+\+|plusplus)?/|^toml\.hpp$)"), std::regex(R"(^server/scenes/.*\.cpp$)")},
      {"CLI11", std::regex("^CLI/"), std::regex(R"(^(server|client)/.*(main|options)\.cpp$)")},
      {"SQLite", std::regex("^sqlite3"), std::regex("^(server/store|server/bake|client/tiles)/")},
  };
  return all;
}

std::string violation(const SourceFile& file, int line, const std::string& what) {
  return file.path + ":" + std::to_string(line) + ": " + what;
}

std::vector<std::string> layerViolations(const SourceFile& file) {
  std::vector<std::string> found;
  const auto allowed = layers().find(topFolder(file.path));
  if (allowed == layers().end()) return found;
  for (const Include& include : includesOf(file)) {
    const std::string target = topFolder(include.target);
    if (include.target.starts_with("../") || include.target.starts_with("./"))
      found.push_back(violation(file, include.line, "includes by a relative path"));
    else if (layers().contains(target) && !allowed->second.contains(target))
      found.push_back(violation(file, include.line, allowed->first + " may not include " + include.target));
  }
  return found;
}

std::vector<std::string> seamViolations(const SourceFile& file) {
  std::vector<std::string> found;
  if (topFolder(file.path) == "tests") return found;
  for (const Include& include : includesOf(file))
    for (const Seam& seam : seams())
      if (std::regex_search(include.target, seam.headers) && !std::regex_search(file.path, seam.files))
        found.push_back(
            violation(file, include.line, std::string(seam.library) + " may not be included here: " + include.target));
  return found;
}

/// The first line that makes a file a coroutine, or 0.
int coroutineLine(const SourceFile& file) {
  static const std::regex pattern(R"(\bco_(await|return|yield)\b)");
  for (std::size_t i = 0; i < file.lines.size(); ++i) {
    if (file.lines[i].find("co_") == std::string::npos) continue;
    const std::string code = file.lines[i].substr(0, file.lines[i].find("//"));
    if (std::regex_search(code, pattern)) return static_cast<int>(i + 1);
  }
  return 0;
}

/// "server/http" of "server/http/http_server.cpp"; files directly in a top folder are that folder's mains.
std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::string folder = path.substr(0, slash);
  return std::ranges::count(folder, '/') > 1 ? folder.substr(0, folder.find('/', folder.find('/') + 1)) : folder;
}

/// For each folder the folders that it includes, with one line that does.
using Graph = std::map<std::string, std::map<std::string, std::string>>;

Graph folderGraph(const std::vector<SourceFile>& files) {
  Graph graph;
  for (const SourceFile& file : files) {
    if (topFolder(file.path) == "tests") continue;
    std::map<std::string, std::string>& targets = graph[folderOf(file.path)];
    for (const Include& include : includesOf(file))
      if (layers().contains(topFolder(include.target)) && folderOf(include.target) != folderOf(file.path))
        targets.try_emplace(folderOf(include.target), violation(file, include.line, "includes " + include.target));
  }
  return graph;
}

/// The include lines of one circle of folders; empty if there is none.
std::vector<std::string> findCircle(const Graph& graph) {
  std::set<std::string> done;
  std::vector<std::pair<std::string, std::string>> path;  // a folder and the line that led to it
  const auto visit = [&](const auto& self, const std::string& folder, const std::string& line) -> bool {
    if (done.contains(folder)) return false;
    const auto seen = std::ranges::find(path, folder, &std::pair<std::string, std::string>::first) - path.begin();
    path.emplace_back(folder, line);
    if (seen + 1 < std::ssize(path)) {
      path.erase(path.begin(), path.begin() + seen + 1);
      return true;
    }
    if (const auto targets = graph.find(folder); targets != graph.end())
      for (const auto& [target, includeLine] : targets->second)
        if (self(self, target, includeLine)) return true;
    path.pop_back();
    done.insert(folder);
    return false;
  };
  std::vector<std::string> lines;
  for (const auto& [folder, targets] : graph) {
    if (!visit(visit, folder, "")) continue;
    for (const auto& step : path) lines.push_back(step.second);
    return lines;
  }
  return lines;
}

const std::vector<SourceFile>& sourceTree() {
  static const std::vector<SourceFile> files = [] {
    std::vector<SourceFile> found;
    const fs::path root = terrane::test::sourceFolder();
    for (const char* top : {"common", "proto", "server", "client", "tests"}) {
      for (const auto& entry : fs::recursive_directory_iterator(root / top)) {
        const std::string extension = entry.path().extension().string();
        const std::array<std::string, 4> source{".h", ".cpp", ".inl", ".in"};
        if (!entry.is_regular_file() || std::ranges::count(source, extension) == 0) continue;
        std::ifstream stream(entry.path(), std::ios::binary);
        std::stringstream text;
        text << stream.rdbuf();
        found.push_back(sourceFile(fs::relative(entry.path(), root).generic_string(), text.str()));
      }
    }
    std::ranges::sort(found, {}, &SourceFile::path);
    return found;
  }();
  return files;
}

TEST(DependencyRules, TheTreeIsFound) {
  EXPECT_GT(sourceTree().size(), 50u);
  EXPECT_TRUE(std::ranges::any_of(sourceTree(), [](const SourceFile& file) { return file.path == "common/result.h"; }));
}

TEST(DependencyRules, CommonServesProtoAndProtoServesServerAndClient) {
  std::vector<std::string> found;
  for (const SourceFile& file : sourceTree()) std::ranges::copy(layerViolations(file), std::back_inserter(found));
  EXPECT_THAT(found, testing::IsEmpty());
}

TEST(DependencyRules, EveryThirdPartyLibraryStaysBehindItsSeam) {
  std::vector<std::string> found;
  for (const SourceFile& file : sourceTree()) std::ranges::copy(seamViolations(file), std::back_inserter(found));
  EXPECT_THAT(found, testing::IsEmpty());
}

TEST(DependencyRules, AtMostTwoTranslationUnitsAreCoroutinesAndNoHeaderIs) {
  std::vector<std::string> coroutines, headers;
  for (const SourceFile& file : sourceTree())
    if (const int line = coroutineLine(file); line > 0)
      (file.path.ends_with(".cpp") ? coroutines : headers).push_back(violation(file, line, "a coroutine"));
  EXPECT_THAT(headers, testing::IsEmpty());
  EXPECT_THAT(coroutines, testing::SizeIs(testing::Le(2)));
}

TEST(DependencyRules, FoldersDoNotDependOnEachOtherInACircle) {
  const Graph graph = folderGraph(sourceTree());
  for (const auto& [folder, targets] : graph) {
    std::cout << folder << " ->";
    for (const auto& [target, line] : targets) std::cout << ' ' << target;
    std::cout << '\n';
  }
  EXPECT_THAT(findCircle(graph), testing::IsEmpty());
}

// The controls: each rule finds what it forbids, with its place, and lets pass what it allows.

TEST(DependencyRulesControl, AForbiddenLayerIsFoundWithFileAndLine) {
  const std::string text = "#pragma once\n#include <vector>\n  #  include \"server/http/http_server.h\"\n";
  EXPECT_THAT(layerViolations(sourceFile("client/net/x.h", text)),
              testing::ElementsAre("client/net/x.h:3: client may not include server/http/http_server.h"));
  EXPECT_THAT(layerViolations(sourceFile("proto/x.h", text)), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("common/x.h", text)), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("server/x.h", text)), testing::IsEmpty());
  EXPECT_THAT(layerViolations(sourceFile("tests/x.h", text)), testing::IsEmpty());
  EXPECT_THAT(layerViolations(sourceFile("server/x.h", "#include \"client/gl/image.h\"\n")), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("common/x.h", "#include \"proto/tile_url.h\"\n")), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("common/x.h", "#include \"tests/x.h\"\n")), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("common/x.h", "#include \"../client/x.h\"\n")), testing::SizeIs(1));
  EXPECT_THAT(layerViolations(sourceFile("client/x.h", "// #include \"server/x.h\"\n")), testing::IsEmpty());
}

TEST(DependencyRulesControl, ALibraryOutsideItsSeamIsFound) {
  const auto violations = [](const char* path, const std::string& header) {
    return seamViolations(sourceFile(path, "#include <" + header + ">\n")).size();
  };
  EXPECT_EQ(violations("proto/draco_encoder.cpp", "draco/mesh/mesh.h"), 0u);
  EXPECT_EQ(violations("proto/draco_mesh.h", "draco/mesh/mesh.h"), 1u);
  EXPECT_EQ(violations("server/build/x.cpp", "draco/mesh/mesh.h"), 1u);
  EXPECT_EQ(violations("client/tiles/x.cpp", "nlohmann/json.hpp"), 1u);
  EXPECT_EQ(violations("proto/x.h", "tiny_gltf.h"), 1u);
  EXPECT_EQ(violations("server/http/http_server.cpp", "boost/asio/post.hpp"), 0u);
  EXPECT_EQ(violations("server/store/x.cpp", "boost/asio/post.hpp"), 1u);
  EXPECT_EQ(violations("client/net/x.cpp", "boost/beast/http.hpp"), 0u);
  EXPECT_EQ(violations("client/tiles/x.cpp", "boost/beast/http.hpp"), 1u);
  EXPECT_EQ(violations("server/x.cpp", "epoxy/gl.h"), 1u);
  EXPECT_EQ(violations("client/gl/window.cpp", "GLFW/glfw3.h"), 0u);
  EXPECT_EQ(violations("common/x.cpp", "imgui.h"), 1u);
  EXPECT_EQ(violations("server/scenes/scene_file.cpp", "toml++/toml.h"), 0u);
  EXPECT_EQ(violations("server/server_main.cpp", "toml++/toml.h"), 1u);
  EXPECT_EQ(violations("server/server_options.cpp", "CLI/CLI.hpp"), 0u);
  EXPECT_EQ(violations("client/view_main.cpp", "CLI/CLI.hpp"), 0u);
  EXPECT_EQ(violations("server/http/x.cpp", "CLI/CLI.hpp"), 1u);
  EXPECT_EQ(violations("common/x.h", "boost/system/result.hpp"), 0u);
  EXPECT_EQ(violations("tests/x.cpp", "nlohmann/json.hpp"), 0u);
}

TEST(DependencyRulesControl, ACoroutineIsFoundButItsNameInACommentIsNot) {
  EXPECT_EQ(coroutineLine(sourceFile("a.cpp", "int x;\n  co_await y;\n")), 2);
  EXPECT_EQ(coroutineLine(sourceFile("a.cpp", "// co_await y;\nco_spawn(z);\n")), 0);
}

TEST(DependencyRulesControl, ACircleOfFoldersIsFoundWithTheLinesThatMakeIt) {
  EXPECT_THAT(findCircle({{"a", {{"b", "a.h:1"}}}, {"b", {{"c", "b.h:2"}}}, {"c", {}}}), testing::IsEmpty());
  EXPECT_THAT(findCircle({{"a", {{"b", "a.h:1"}}}, {"b", {{"c", "b.h:2"}}}, {"c", {{"b", "c.h:3"}}}}),
              testing::ElementsAre("b.h:2", "c.h:3"));
}

}  // namespace
