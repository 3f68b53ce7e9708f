#pragma once
// Holds a frame time by trading detail: raises the allowed screen-space error while frames take too long and lowers it
// again when there is room, between the error that was asked for and kWorstFactor times it. A dead band wider than one
// step's effect keeps it from swinging. Deterministic: a function of the frame times alone. One thread.

#include <array>
#include <cstddef>

namespace terrane {

class FrameBudget {
 public:
  static constexpr double kWorstFactor = 16;

  /// budgetMs <= 0: no budget, the error stays as asked.
  FrameBudget(double budgetMs, double errorPixels) noexcept
      : budgetMs_(budgetMs), asked_(errorPixels), current_(errorPixels) {}

  /// Takes a frame's time; returns the error for the next frame, in pixels.
  double frame(double milliseconds) noexcept;
  double errorPixels() const noexcept { return current_; }
  /// False while more frames are needed to decide: a viewer that draws only on change goes on drawing.
  bool steady() const noexcept { return !(budgetMs_ > 0) || (decided_ && count_ == 0); }
  /// A new request from the person; the controller goes on from the nearest allowed value.
  void setAsked(double errorPixels) noexcept;
  double asked() const noexcept { return asked_; }

 private:
  static constexpr std::size_t kWindow = 5;  ///< frames looked at before each decision: one slow frame is no trend
  double budgetMs_, asked_, current_;
  std::array<double, kWindow> recent_{};
  std::size_t count_ = 0;
  bool decided_ = false;  ///< the last full window called for no change
};

}  // namespace terrane
