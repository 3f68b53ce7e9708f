#include "client/gl/image.h"

#include <epoxy/gl.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#define STBI_NO_STDIO
#include <stb/stb_image.h>
#define STBI_WRITE_NO_STDIO
#include <stb/stb_image_write.h>

namespace terrane {
namespace {

constexpr std::uintmax_t kMaxPngBytes = 256u << 20;

}  // namespace

Image readFramebuffer(int width, int height) {
  Image image{width, height, {}};
  const auto rowBytes = static_cast<std::size_t>(width) * 3;
  image.rgb.resize(rowBytes * static_cast<std::size_t>(height));
  std::vector<std::uint8_t> bottomFirst(image.rgb.size());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, bottomFirst.data());
  for (std::size_t row = 0; row < static_cast<std::size_t>(height); ++row) {
    std::memcpy(image.rgb.data() + row * rowBytes,
                bottomFirst.data() + (static_cast<std::size_t>(height) - 1 - row) * rowBytes, rowBytes);
  }
  return image;
}

Result<std::size_t> writePng(const Image& image, const std::string& file) {
  if (image.width < 1 || image.height < 1 ||
      image.rgb.size() != static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3) {
    return makeError(ErrorKind::InvalidArgument, file, "the picture is empty");
  }
  std::string bytes;
  const auto append = [](void* context, void* data, int size) {
    static_cast<std::string*>(context)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
  };
  if (stbi_write_png_to_func(append, &bytes, image.width, image.height, 3, image.rgb.data(), image.width * 3) == 0) {
    return makeError(ErrorKind::Internal, file, "the PNG encoder ran out of memory");
  }
  std::ofstream stream(file, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) return makeError(ErrorKind::Io, file, "cannot write the picture");
  return bytes.size();
}

Result<Image> readPng(const std::string& file) {
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(file, failure);
  if (failure) return makeError(ErrorKind::Io, file, failure.message());
  if (size > kMaxPngBytes) return makeError(ErrorKind::TooLarge, file, fmt::format("more than {} bytes", kMaxPngBytes));
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream stream(file, std::ios::binary);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream) return makeError(ErrorKind::Io, file, "cannot read the picture");

  Image image;
  int channels = 0;
  stbi_uc* pixels = stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(bytes.data()),
                                          static_cast<int>(bytes.size()), &image.width, &image.height, &channels, 3);
  if (pixels == nullptr) return makeError(ErrorKind::Malformed, file, stbi_failure_reason());
  image.rgb.assign(pixels, pixels + static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  stbi_image_free(pixels);
  return image;
}

double rmsDifference(const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) {
    const double difference = static_cast<double>(a.rgb[i]) - static_cast<double>(b.rgb[i]);
    sum += difference * difference;
  }
  return a.rgb.empty() ? 0 : std::sqrt(sum / static_cast<double>(a.rgb.size()));
}

}  // namespace terrane
