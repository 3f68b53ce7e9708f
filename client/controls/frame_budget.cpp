#include "client/controls/frame_budget.h"

#include <algorithm>
#include <cmath>

namespace terrane {
namespace {

// Frame time falls at most with the square of the error, so one step of kGentle changes it by at most 1.21, less than
// the band's width of 1.05 / 0.75 = 1.4: from inside the band no step is taken, and no step leaps over it.
constexpr double kTooSlow = 1.05, kRoomLeft = 0.75;
constexpr double kGentle = 1.1, kSteep = 1.5;

}  // namespace

void FrameBudget::setAsked(double errorPixels) noexcept {
  asked_ = errorPixels;
  current_ = budgetMs_ > 0 ? std::clamp(current_, asked_, asked_ * kWorstFactor) : asked_;
  count_ = 0;
  decided_ = false;
}

double FrameBudget::frame(double milliseconds) noexcept {
  if (!(budgetMs_ > 0) || !std::isfinite(milliseconds)) return current_;
  recent_[count_++] = milliseconds;
  if (count_ < kWindow) return current_;
  count_ = 0;
  std::array<double, kWindow> sorted = recent_;
  std::nth_element(sorted.begin(), sorted.begin() + kWindow / 2, sorted.end());
  const double load = sorted[kWindow / 2] / budgetMs_;
  const double before = current_;
  // Far over budget there is no need to be gentle; on the way back there is, for each step costs requests.
  if (load > kTooSlow) current_ *= load > 2 ? kSteep : kGentle;
  if (load < kRoomLeft) current_ /= kGentle;
  current_ = std::clamp(current_, asked_, asked_ * kWorstFactor);
  decided_ = current_ == before;
  return current_;
}

}  // namespace terrane
