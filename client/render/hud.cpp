#include "client/render/hud.h"

#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>

#include "client/render/readable_units.h"

namespace terrane {
namespace {

constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                    ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
const ImVec4 kDim{0.65f, 0.68f, 0.72f, 1}, kWarning{1.0f, 0.72f, 0.30f, 1}, kBright{0.94f, 0.95f, 0.97f, 1};

void row(const char* label, const std::string& value) {
  ImGui::TableNextRow();
  ImGui::TableNextColumn();
  ImGui::TextColored(kDim, "%s", label);
  ImGui::TableNextColumn();
  ImGui::TextUnformatted(value.c_str());
}

void figureRows(const HudState& s) {
  row("ground", s.groundKnown ? lengthText(s.groundMeters) + " above" : "not known yet");
  if (!s.body.empty()) row("over", s.body);
  row("sphere", lengthText(s.altitudeMeters) + " above");
  row("place", fmt::format("{:.5f}, {:.5f} deg", s.longitudeDegrees, s.latitudeDegrees));
  row("view", fmt::format("heading {:.1f}, pitch {:.1f} deg", s.headingDegrees, s.pitchDegrees));
  row("speed", speedText(s.speedMetersPerSecond));
  row("mode", s.mode);
  row("frame", fmt::format("{:.1f} ms median", s.medianMs));
  row("error", s.errorPixels > s.askedErrorPixels
                   ? fmt::format("{:.2g} px (asked {:.2g})", s.errorPixels, s.askedErrorPixels)
                   : fmt::format("{:.2g} px", s.errorPixels));
  row("tiles", fmt::format("{} drawn, {} loading, {} held", s.tilesDrawn, s.tilesLoading, s.tilesResident));
  row("triangles", countText(s.triangles));
  row("edges", s.samples > 1 ? fmt::format("{} samples a pixel", s.samples) : "one sample a pixel");
  row("received", bytesText(s.bytesReceived));
  if (!s.network.empty()) row("network", s.network);
  row("memory", fmt::format("{} process, {} tiles, {} GPU", bytesText(s.rssBytes), bytesText(s.residentBytes),
                            bytesText(s.gpuBytes)));
  row("placement", s.placement);
  row("new levels", s.transition);
  row("self-test", s.selfTest);
}

void figuresPanel(const HudState& s, float scale) {
  ImGui::SetNextWindowPos({10 * scale, 10 * scale});
  ImGui::SetNextWindowBgAlpha(0.62f);
  ImGui::Begin("figures", nullptr, kPanel);
  if (ImGui::BeginTable("rows", 2, ImGuiTableFlags_SizingFixedFit)) {
    figureRows(s);
    ImGui::EndTable();
  }
  if (!s.frameMs.empty()) {
    const float highest = std::max(20.0f, *std::max_element(s.frameMs.begin(), s.frameMs.end()));
    ImGui::PlotHistogram("##frames", s.frameMs.data(), static_cast<int>(s.frameMs.size()), 0,
                         fmt::format("frame time, 0 to {:.0f} ms", highest).c_str(), 0, highest,
                         {330 * scale, 44 * scale});
  }
  std::string states;
  if (s.frozen) states += "selection frozen  ";
  if (s.wireframe) states += "wireframe  ";
  if (s.levelColors) states += "level colours  ";
  if (!states.empty()) ImGui::TextColored(kWarning, "%s", states.c_str());
  ImGui::End();
}

void keysPanel(float scale, float heightPixels) {
  ImGui::SetNextWindowPos({10 * scale, heightPixels - 10 * scale}, 0, {0, 1});
  ImGui::SetNextWindowBgAlpha(0.45f);
  ImGui::Begin("keys", nullptr, kPanel);
  ImGui::TextColored(
      kDim, "drag, wheel, right drag | WASD QE fly, Shift fast, Ctrl slow | Tab mode | Home reset | P placement");
  ImGui::TextColored(kDim,
                     "F1 this | F2 wireframe | F3 level colours | F4 freeze selection | F5 changes of level | + - "
                     "error | F12 screenshot | Esc quit");
  ImGui::End();
}

void centredPanel(const char* name, float y, float pivotY, float width, const ImVec4& color, const std::string& text,
                  const float* fraction, float scale) {
  ImGui::SetNextWindowPos({width / 2, y}, 0, {0.5f, pivotY});
  ImGui::SetNextWindowBgAlpha(0.62f);
  ImGui::Begin(name, nullptr, kPanel);
  ImGui::TextColored(color, "%s", text.c_str());
  if (fraction != nullptr) ImGui::ProgressBar(*fraction, {320 * scale, 16 * scale});
  ImGui::End();
}

}  // namespace

Result<std::unique_ptr<Hud>> Hud::create(float pixelScale) {
  IMGUI_CHECKVERSION();
  ImGui::CreateContext();
  ImGuiIO& io = ImGui::GetIO();
  io.IniFilename = nullptr;  // the overlay has nothing to remember
  io.LogFilename = nullptr;
  ImFontConfig font;
  font.SizePixels = 13 * pixelScale;
  io.Fonts->AddFontDefault(&font);
  ImGui::StyleColorsDark();
  ImGui::GetStyle().ScaleAllSizes(pixelScale);
  ImGui::GetStyle().WindowRounding = 4 * pixelScale;
  ImGui::GetStyle().WindowBorderSize = 0;
  ImGui::GetStyle().Colors[ImGuiCol_PlotHistogram] = {0.36f, 0.60f, 0.86f, 1};
  if (!ImGui_ImplOpenGL3_Init("#version 330 core")) {
    ImGui::DestroyContext();
    return makeError(ErrorKind::Unsupported, "OpenGL", "the overlay could not be set up");
  }
  return std::unique_ptr<Hud>(new Hud(pixelScale));
}

Hud::~Hud() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui::DestroyContext();
}

void Hud::draw(const HudState& state, bool figures, int widthPixels, int heightPixels) {
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(widthPixels), static_cast<float>(heightPixels)};
  io.DeltaTime = 1.0f / 60;  // nothing here is animated
  ImGui_ImplOpenGL3_NewFrame();
  ImGui::NewFrame();
  const float width = io.DisplaySize.x, height = io.DisplaySize.y;
  if (figures) {
    figuresPanel(state, scale_);
    keysPanel(scale_, height);
  }
  if (!state.firstViewComplete) {
    const auto fraction = static_cast<float>(std::clamp(state.progress, 0.0, 1.0));
    centredPanel("progress", height / 2, 0.5f, width, kBright,
                 state.tilesLoading > 0 ? fmt::format("Loading: {} tiles to come", state.tilesLoading) : "Connecting",
                 &fraction, scale_);
  }
  if (!state.link.empty()) centredPanel("link", 10 * scale_, 0, width, kWarning, state.link, nullptr, scale_);
  if (!state.notice.empty())
    centredPanel("notice", height - 60 * scale_, 1, width, kBright, state.notice, nullptr, scale_);
  ImGui::Render();
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace terrane
