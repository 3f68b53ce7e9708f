#pragma once
// Lengths, bytes and durations as a person reads them: three significant digits and a unit. ASCII. Thread-safe.

#include <cstdint>
#include <string>

namespace terrane {

std::string lengthText(double meters);          ///< "0.2 m", "12.3 km", "10,000 km"
std::string bytesText(std::uint64_t bytes);     ///< "512 B", "12.4 KiB", "128 MiB"
std::string speedText(double metersPerSecond);  ///< "1.4 m/s", "3.2 km/s"
std::string countText(std::uint64_t count);     ///< "12,345"

}  // namespace terrane
