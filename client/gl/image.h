#pragma once
// An 8-bit RGB picture, top row first: reading the framebuffer, PNG files, difference of two pictures.

#include <cstdint>
#include <string>
#include <vector>

#include "common/result.h"

namespace terrane {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;
};

Image readFramebuffer(int width, int height);                               ///< GL thread
Result<std::size_t> writePng(const Image& image, const std::string& file);  ///< bytes written
Result<Image> readPng(const std::string& file);
/// Root mean square difference over all channels, 0..255. Precondition: equal sizes.
double rmsDifference(const Image& a, const Image& b);

}  // namespace terrane
