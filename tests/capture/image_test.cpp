// Pictures: PNG files written and read back, and their difference.

#include "client/gl/image.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>

namespace terrane {
namespace {

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& name)
      : path_(std::filesystem::temp_directory_path() / ("terrane-" + std::to_string(getpid()) + "-" + name)) {}
  ~TemporaryFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Image noise(int width, int height) {
  Image image{width, height, {}};
  std::mt19937 random(7);
  image.rgb.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (auto& value : image.rgb) value = static_cast<std::uint8_t>(random());
  return image;
}

TEST(Image, PngRoundTripKeepsEveryByte) {
  const TemporaryFile file("noise.png");
  const Image written = noise(61, 37);
  const auto bytes = writePng(written, file.path());
  ASSERT_TRUE(bytes) << bytes.error().text();
  EXPECT_EQ(*bytes, std::filesystem::file_size(file.path()));
  const auto read = readPng(file.path());
  ASSERT_TRUE(read) << read.error().text();
  EXPECT_EQ(read->width, 61);
  EXPECT_EQ(read->height, 37);
  EXPECT_EQ(read->rgb, written.rgb);
}

TEST(Image, PngErrorsNameTheFile) {
  const auto missing = readPng("/nowhere/picture.png");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::Io);
  EXPECT_EQ(missing.error().field, "/nowhere/picture.png");

  const TemporaryFile file("broken.png");
  std::ofstream(file.path(), std::ios::binary) << "\x89PNG\r\n\x1a\n and then nothing that makes sense";
  const auto broken = readPng(file.path());
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().kind, ErrorKind::Malformed);

  const auto unwritable = writePng(noise(2, 2), "/nowhere/picture.png");
  ASSERT_FALSE(unwritable);
  EXPECT_EQ(unwritable.error().kind, ErrorKind::Io);
  EXPECT_FALSE(writePng(Image{3, 3, {}}, file.path())) << "sizes that do not match the bytes";
}

TEST(Image, RmsDifferenceIsZeroForEqualPicturesAndTheStepForAConstantStep) {
  Image a = noise(16, 16);
  EXPECT_EQ(rmsDifference(a, a), 0.0);
  for (auto& value : a.rgb) value = 100;
  Image b = a;
  for (auto& value : b.rgb) value = 103;
  EXPECT_DOUBLE_EQ(rmsDifference(a, b), 3.0);
}

}  // namespace
}  // namespace terrane
