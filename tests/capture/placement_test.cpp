// Where vertices land on the screen: against a reference of 113 bits, against each other over tile borders, and as
// pictures. The plain float placement is the control that must miss every bound.

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cmath>
#include <cstdio>
#include <map>

#include "client/gl/image.h"
#include "client/gl/render_target.h"
#include "client/render/placement.h"
#include "common/numerics/relative_position.h"
#include "tests/capture/gl_fixture.h"
#include "tests/capture/stitched_tiles.h"

namespace terrane {
namespace {

using Quad = boost::multiprecision::cpp_bin_float_quad;

constexpr double kMaxErrorPixels = 0.01;
constexpr int kWidth = 640, kHeight = 360;
constexpr double kErrorPixels = 1;

class PlacementTest : public GlTest {
 protected:
  static std::unique_ptr<TileRenderer> makeMoonRenderer(const RendererOptions& options = {}) {
    return makeRenderer(moonSunlight(), options);
  }
  static std::vector<FacePath> uploadSettled(TileRenderer& renderer, const Camera& camera) {
    std::vector<FacePath> paths = moon().settledTiles(camera, kErrorPixels);
    for (const FacePath& path : paths) renderer.upload(moon().tile(path));
    return paths;
  }
  static Image picture(TileRenderer& renderer, const Camera& camera, const std::vector<FacePath>& paths,
                       Placement placement) {
    auto target = RenderTarget::create(camera.widthPixels, camera.heightPixels);
    EXPECT_TRUE(target);
    target->bind();
    const DrawStats stats = renderer.draw(camera, paths, {.placement = placement, .skirts = true});
    EXPECT_EQ(stats.tiles, paths.size());
    Image image = readFramebuffer(camera.widthPixels, camera.heightPixels);
    RenderTarget::bindWindow();
    return image;
  }
};

/// A camera's projection in 113 bits, from the same doubles.
class ReferenceCamera {
 public:
  explicit ReferenceCamera(const Camera& camera) : camera_(camera) {
    const glm::dmat4 projection = reversedInfiniteProjection(camera);
    for (int axis = 0; axis < 3; ++axis) {
      rows_[0][axis] = Quad(projection[0][0]) * Quad(camera.right[axis]);
      rows_[1][axis] = Quad(projection[1][1]) * Quad(camera.up[axis]);
      rows_[2][axis] = -Quad(camera.backward[axis]);
    }
  }

  struct Clip {
    Quad x, y, w;
  };
  Clip clip(const TileMetadata& metadata, const std::uint16_t* offset) const {
    Clip result{0, 0, 0};
    const Quad step(stepMeters(metadata.stepExponent));
    for (int axis = 0; axis < 3; ++axis) {
      const Quad relative = Quad(metadata.origin[axis] + offset[axis]) * step - Quad(camera_.positionBody[axis]);
      result.x += rows_[0][axis] * relative;
      result.y += rows_[1][axis] * relative;
      result.w += rows_[2][axis] * relative;
    }
    return result;
  }

 private:
  Camera camera_;
  Quad rows_[3][3];
};

struct PixelErrors {
  double worst = 0;
  std::size_t vertices = 0;
};

/// The worst distance on screen between what the shader computed and the reference, over vertices in the frustum.
void measure(TileRenderer& renderer, const Camera& camera, const Tile& tile, std::size_t stride,
             const std::map<Placement, PixelErrors*>& placements) {
  const ReferenceCamera reference(camera);
  std::map<Placement, std::vector<float>> computed;
  for (const auto& [placement, errors] : placements)
    computed[placement] = renderer.clipPositions(camera, {tile.metadata.path, {}}, placement);
  for (std::size_t i = 0; i < tile.mesh.vertexCount(); i += stride) {
    const auto exact = reference.clip(tile.metadata, &tile.mesh.offsets[3 * i]);
    if (exact.w < camera.nearMeters || abs(exact.x) > exact.w || abs(exact.y) > exact.w) continue;
    const auto exactX = static_cast<double>(Quad(exact.x / exact.w)),
               exactY = static_cast<double>(Quad(exact.y / exact.w));
    for (const auto& [placement, errors] : placements) {
      const float* clip = &computed[placement][4 * i];
      const double w = clip[3];
      const double dx = (clip[0] / w - exactX) * 0.5 * camera.widthPixels,
                   dy = (clip[1] / w - exactY) * 0.5 * camera.heightPixels;
      const double error = std::hypot(dx, dy);
      if (!(error <= errors->worst)) errors->worst = error;  // a NaN counts as the worst
      ++errors->vertices;
    }
  }
}

TEST_F(PlacementTest, VerticesStayWithinAHundredthOfAPixelWhileTheCameraMovesByMillimetres) {
  constexpr int kMoves = 12, kFullMoves = 1;
  Camera camera = moon().cameraAboveGround({-20.1 * kDegree, 9.6 * kDegree, 2.0, 0.4, -12 * kDegree}, kWidth, kHeight);
  auto renderer = makeMoonRenderer();
  const std::vector<FacePath> paths = uploadSettled(*renderer, camera);
  PixelErrors integer, doubleFloat, cpu, float32;
  for (int move = 0; move < kMoves; ++move) {
    camera.positionBody += 0.001 * camera.right - 0.0003 * camera.backward;
    // Every vertex in the first frame, then every 17th.
    for (const FacePath& path : paths) {
      measure(*renderer, camera, *moon().tile(path), move < kFullMoves ? 1 : 17,
              {{Placement::Integer, &integer},
               {Placement::DoubleFloat, &doubleFloat},
               {Placement::Cpu, &cpu},
               {Placement::Float32, &float32}});
    }
  }
  std::printf(
      "worst error at 2 m above ground, %zu tiles, %zu vertices: integer %.2e px, double-float %.2e px, cpu %.2e px, "
      "float32 %.3g px\n",
      paths.size(), integer.vertices, integer.worst, doubleFloat.worst, cpu.worst, float32.worst);
  EXPECT_GT(integer.vertices, 10000u);
  EXPECT_LE(integer.worst, kMaxErrorPixels);
  EXPECT_LE(doubleFloat.worst, kMaxErrorPixels);
  EXPECT_LE(cpu.worst, kMaxErrorPixels);
  EXPECT_GT(float32.worst, 1.0) << "the control: plain floats must miss the bound by far";
}

TEST_F(PlacementTest, AMillimetreOfCameraMovesEveryNearVertexByAMillimetre) {
  const Camera before = moon().cameraAboveGround({1.0, 0.5, 2.0, 0, -90 * kDegree}, kWidth, kHeight);
  Camera after = before;
  after.positionBody += 0.001 * before.right;
  auto renderer = makeMoonRenderer();
  const std::vector<FacePath> paths = uploadSettled(*renderer, before);
  const double pixelsPerMeter = pixelsPerRadian(before);  // at a distance of 1 m
  double worst = 0;
  std::size_t vertices = 0;
  for (const FacePath& path : paths) {
    const auto a = renderer->clipPositions(before, {path, {}}, Placement::Integer),
               b = renderer->clipPositions(after, {path, {}}, Placement::Integer);
    for (std::size_t i = 0; i < a.size(); i += 4) {
      const double w = a[i + 3];
      if (w < 1 || w > 3 || std::abs(a[i]) > w || std::abs(a[i + 1]) > w) continue;
      const double movedPixels = (a[i] / w - b[i] / static_cast<double>(b[i + 3])) * 0.5 * kWidth;
      worst = std::max(worst, std::abs(movedPixels * w / pixelsPerMeter - 0.001));
      ++vertices;
    }
  }
  std::printf("%zu vertices 1 to 3 m away: moved by 1 mm, worst error %.2e m\n", vertices, worst);
  EXPECT_GT(vertices, 100u);
  EXPECT_LE(worst, 1e-6);
}

/// Clip positions by lattice point, so that vertices shared by tiles meet. Every vertex is so far on its way to the
/// parent's surface.
std::size_t countDifferingSharedVertices(TileRenderer& renderer, const Camera& camera,
                                         const std::vector<std::shared_ptr<const Tile>>& tiles, Placement placement,
                                         float morph, std::size_t& shared) {
  std::map<std::array<std::int64_t, 3>, std::array<std::uint32_t, 4>> seen;
  std::size_t differing = 0;
  shared = 0;
  for (const auto& tile : tiles) {
    const auto positions = renderer.clipPositions(camera, {tile->metadata.path, morphedBy(morph)}, placement);
    // The feet of skirts do not move, wherever their tops go.
    const std::size_t compared = morph == 0 ? tile->mesh.vertexCount() : std::size_t{65} * 65;
    std::map<std::array<std::int64_t, 3>, std::array<std::uint32_t, 4>> own;
    for (std::size_t i = 0; i < compared; ++i) {
      std::array<std::int64_t, 3> key{};
      std::array<std::uint32_t, 4> bits{};
      for (std::size_t c = 0; c < 3; ++c)
        key[c] = tile->metadata.origin[static_cast<int>(c)] + tile->mesh.offsets[3 * i + c];
      for (std::size_t c = 0; c < 4; ++c) bits[c] = std::bit_cast<std::uint32_t>(positions[4 * i + c]);
      own.emplace(key, bits);
    }
    for (const auto& [key, bits] : own) {
      const auto [found, isNew] = seen.emplace(key, bits);
      if (isNew) continue;
      ++shared;
      if (found->second != bits) ++differing;
    }
  }
  return differing;
}

TEST_F(PlacementTest, VerticesSharedByTilesGetTheSameBitsOverFaceEdgesAndCornersToo) {
  auto renderer = makeMoonRenderer();
  const double corner = std::atan(1 / std::sqrt(2.0));
  std::size_t float32Differing = 0;
  for (const int level : {3, 12, 20}) {
    // The three tiles at the cube's corner (+X +Y +Z), and their neighbours on the same face.
    const auto last = static_cast<std::uint32_t>((1u << level) - 1);
    const std::vector<FacePath> corners{FacePath::cubeTile(0, level, last, last), FacePath::cubeTile(2, level, 0, last),
                                        FacePath::cubeTile(4, level, last, 0)};
    std::vector<std::shared_ptr<const Tile>> tiles;
    for (const FacePath& path : corners) {
      tiles.push_back(moon().tile(path));
      for (const Side side : {Side::UMin, Side::VMin}) tiles.push_back(moon().tile(*path.neighbour(side)));
    }
    for (const auto& tile : tiles) {
      renderer->upload(tile);
      renderer->upload(moon().tile(tile->metadata.path.parent()));
    }
    const Camera camera = moon().cameraAboveGround(
        {45 * kDegree, corner, std::ldexp(1.0, 20 - level), 0.3, -50 * kDegree}, kWidth, kHeight);
    for (const float morph : {0.0f, 0.37f, 1.0f}) {
      for (const Placement placement :
           {Placement::Integer, Placement::DoubleFloat, Placement::Cpu, Placement::Float32}) {
        std::size_t shared = 0;
        const std::size_t differing = countDifferingSharedVertices(*renderer, camera, tiles, placement, morph, shared);
        std::printf("level %2d, morph %.2f, %s: %zu of %zu shared vertices differ\n", level, static_cast<double>(morph),
                    std::string(placementName(placement)).c_str(), differing, shared);
        EXPECT_GE(shared, 500u);
        if (placement == Placement::Float32) {
          float32Differing += differing;
        } else {
          EXPECT_EQ(differing, 0u) << placementName(placement) << " at level " << level << ", morph " << morph;
        }
      }
    }
  }
  EXPECT_GT(float32Differing, 0u) << "the control: plain floats must not agree";
}

TEST_F(PlacementTest, IntegerDoubleFloatAndCpuDrawTheSamePictureFromOrbitToTheGround) {
  auto renderer = makeMoonRenderer();
  for (const double altitude : {1e7, 1e5, 2.0, 0.2}) {
    const Camera camera =
        moon().cameraAboveGround({-20.1 * kDegree, 9.6 * kDegree, altitude, 0.2, -35 * kDegree}, kWidth, kHeight);
    const Camera view =
        altitude > 1e6 ? moon().cameraAboveGround({-0.35, 0.17, altitude, 0, -90 * kDegree}, kWidth, kHeight) : camera;
    const std::vector<FacePath> paths = uploadSettled(*renderer, view);
    const Image integer = picture(*renderer, view, paths, Placement::Integer);
    const double doubleFloat = rmsDifference(integer, picture(*renderer, view, paths, Placement::DoubleFloat));
    const double cpu = rmsDifference(integer, picture(*renderer, view, paths, Placement::Cpu));
    const double float32 = rmsDifference(integer, picture(*renderer, view, paths, Placement::Float32));
    std::printf("%9.1f m: RMS of 255 against integer: double-float %.4f, cpu %.4f, float32 %.4f\n", altitude,
                doubleFloat, cpu, float32);
    EXPECT_LE(doubleFloat, 0.25);
    EXPECT_LE(cpu, 0.25);
    if (altitude < 10) {
      EXPECT_GT(float32, 1.0) << "the control: plain floats must show";
    }
    renderer->clear();
  }
}

TEST_F(PlacementTest, TheBaselineDepthPathDrawsThePictureOfTheReversedOne) {
  auto reversed = makeMoonRenderer(), baseline = makeMoonRenderer({.forceBaseline = true});
  for (const double altitude : {1e7, 3e4, 0.2}) {
    const double pitch = altitude > 1e6 ? -90 * kDegree : -10 * kDegree;
    const Camera camera = moon().cameraAboveGround({0.3, -0.4, altitude, 1.0, pitch}, kWidth, kHeight);
    const std::vector<FacePath> paths = uploadSettled(*reversed, camera);
    uploadSettled(*baseline, camera);
    const double rms = rmsDifference(picture(*reversed, camera, paths, Placement::Integer),
                                     picture(*baseline, camera, paths, Placement::Integer));
    std::printf("%9.1f m: RMS of 255 between the depth paths %.4f\n", altitude, rms);
    EXPECT_LE(rms, 0.25);
  }
}

TEST_F(PlacementTest, ATileTooFarForTheShadersIntegersIsPlacedOnTheCpu) {
  auto renderer = makeMoonRenderer();
  const FacePath path = FacePath::cubeTile(0, 22, 1u << 21, 1u << 21);
  const auto tile = moon().tile(path);
  renderer->upload(tile);
  Camera camera = cameraFromPose({0.1, 0.1, 5e7, 0, -90 * kDegree}, 1737400, 0.9, kWidth, kHeight);
  ASSERT_FALSE(originMinusCamera(tile->metadata.origin,
                                 cameraOnLattice(camera.positionBody, stepMeters(tile->metadata.stepExponent)).steps));
  EXPECT_EQ(renderer->clipPositions(camera, {path, {}}, Placement::Integer),
            renderer->clipPositions(camera, {path, {}}, Placement::Cpu));
}

TEST_F(PlacementTest, DrawingToTheWindowShowsWhatTheRenderTargetHolds) {
  auto renderer = makeMoonRenderer();
  const auto size = window().framebufferSize();
  const Camera camera = cameraFromPose({0.3, 0.2, 4e6, 0, -90 * kDegree}, 1737400, 0.9, size[0], size[1]);
  const std::vector<FacePath> paths = uploadSettled(*renderer, camera);
  RenderTarget::bindWindow();
  renderer->draw(camera, paths, {.skirts = true});
  const Image shown = readFramebuffer(size[0], size[1]);
  EXPECT_EQ(rmsDifference(shown, picture(*renderer, camera, paths, Placement::Integer)), 0.0);
}

TEST_F(PlacementTest, TilesOfEqualConnectivityShareTheirIndicesAndGiveTheirMemoryBack) {
  auto renderer = makeMoonRenderer();
  EXPECT_EQ(renderer->gpuBytes(), 0u);
  const auto a = moon().tile(FacePath::cubeTile(1, 2, 0, 0)), b = moon().tile(FacePath::cubeTile(1, 2, 1, 0));
  const std::size_t first = renderer->upload(a), second = renderer->upload(b);
  EXPECT_EQ(first - second, a->mesh.triangles.size() * 2) << "the second tile brings no indices";
  EXPECT_EQ(renderer->gpuBytes(), first + second);
  renderer->remove(a->metadata.path);
  EXPECT_EQ(renderer->gpuBytes(), first);
  renderer->remove(a->metadata.path);
  renderer->remove(b->metadata.path);
  EXPECT_EQ(renderer->gpuBytes(), 0u);
  const std::vector<FacePath> gone{a->metadata.path, b->metadata.path};
  auto target = RenderTarget::create(64, 64);
  ASSERT_TRUE(target);
  target->bind();
  EXPECT_EQ(renderer->draw(cameraFromPose({}, 1737400, 0.9, 64, 64), gone, {}).tiles, 0u)
      << "tiles that are not there are skipped";
}

TEST(Placement, NamesAreReadBackAndUnknownOnesListWhatIsAllowed) {
  for (const char* name : {"integer", "double-float", "cpu", "float32"}) {
    const auto placement = parsePlacement(name);
    ASSERT_TRUE(placement) << name;
    EXPECT_EQ(placementName(*placement), name);
  }
  const auto wrong = parsePlacement("double");
  ASSERT_FALSE(wrong);
  EXPECT_EQ(wrong.error().field, "--placement");
  for (const char* name : {"integer", "double-float", "cpu", "float32"})
    EXPECT_NE(wrong.error().message.find(name), std::string::npos);
}

TEST(Placement, TheCameraIsRoundedDownToTheLatticeOnNegativeAxesToo) {
  const CameraOnLattice camera = cameraOnLattice({-0.3, 10.0, -1737400.125}, 0.25);
  EXPECT_EQ(camera.steps, LatticePoint(-2, 40, -6949601));
  EXPECT_FLOAT_EQ(camera.rest.x, 0.8f);
  EXPECT_EQ(camera.rest.y, 0.0f);
  EXPECT_EQ(camera.rest.z, 0.5f);
}

}  // namespace
}  // namespace terrane
