#pragma once
// The schemes for placing a vertex as a vertex shader runs them: attributes, uniforms, and the functions of
// common/numerics' GLSL. GL thread only; a context must be current.

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "common/result.h"
#include "tests/accuracy/placement/schemes.h"
#include "tests/support/vertex_run.h"

namespace terrane::accuracy {

struct ShaderScheme {
  std::string_view name;
  int bytesPerVertex;
  int uploadedBytesPerVertex;
  std::string declarations;  ///< attributes, uniforms, includes
  std::string expression;    ///< a vec3: the vertex relative to the camera
  std::size_t stride;
  std::vector<gl::VertexAttribute> attributes;
  std::function<std::vector<std::byte>(const Sample&)> vertices;
  std::function<void(const gl::Program&, const Sample&)> setUniforms;
};

/// What any shader costs that does nothing.
inline constexpr std::string_view kPassedThrough = "none: a finished position passed on";

const std::vector<ShaderScheme>& shaderSchemes();

/// A scheme's vertices, each encoded by itself.
template <class Encode>
std::function<std::vector<std::byte>(const Sample&)> eachVertex(Encode encode) {
  return [encode](const Sample& sample) {
    std::vector<decltype(encode(FinePoint{}, sample))> values;
    for (const UnitPoint& vertex : sample.vertices) values.push_back(encode({vertex, glm::dvec3(0.0)}, sample));
    const auto bytes = gl::bytesOf(values);
    return std::vector<std::byte>(bytes.begin(), bytes.end());
  };
}

/// Uniforms <name>High and <name>Low.
void setPair(const gl::Program& program, const std::string& name, const FinePoint& point);

/// The scheme's program with a sample's vertices and camera, ready to run. Errors: Unsupported ("shader").
Result<test::VertexRun> prepare(const ShaderScheme& scheme, const Sample& sample);

struct Prepared {
  const ShaderScheme* scheme;
  test::VertexRun run;
};
/// Errors: Unsupported ("shader").
Result<std::vector<Prepared>> prepareAll(const std::vector<ShaderScheme>& schemes, const Sample& sample);

/// Another sample's vertices and camera into a prepared scheme.
void load(Prepared& prepared, const Sample& sample);

/// Nanoseconds a vertex of each, taken in turn; medians. What a scheme has the CPU do for every frame is in it.
std::vector<double> nanosecondsPerVertex(std::vector<Prepared>& all, const Sample& sample, int rounds);

/// Of what the last run placed.
double worstMeters(const Sample& sample, const test::VertexRun& run);

}  // namespace terrane::accuracy
