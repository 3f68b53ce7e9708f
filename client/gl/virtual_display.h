#pragma once
// A virtual X display (Xvfb) as a child process, for drawing where there is no display. It ends with this object, and
// with this process however that ends: the kernel signals it when the thread that started it is gone, so start it on
// the main thread.

#include <sys/types.h>

#include <string>

#include "common/result.h"

namespace terrane {

class VirtualDisplay {
 public:
  /// Waits until the server takes connections. Errors: Io ("display").
  static Result<VirtualDisplay> start(int widthPixels, int heightPixels);
  VirtualDisplay(VirtualDisplay&& other) noexcept;
  VirtualDisplay& operator=(VirtualDisplay&&) = delete;
  ~VirtualDisplay();

  const std::string& name() const noexcept { return name_; }  ///< ":7", for the environment variable DISPLAY

 private:
  VirtualDisplay(pid_t process, std::string name) : process_(process), name_(std::move(name)) {}
  pid_t process_ = -1;
  std::string name_;
};

}  // namespace terrane
