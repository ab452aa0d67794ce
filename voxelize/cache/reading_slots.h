// How many files are read at once: as many as memory allows.
#pragma once

#include <condition_variable>
#include <mutex>

namespace forcelayer::cache {

class ReadingSlots {
 public:
  explicit ReadingSlots(double max_bytes) : max_bytes_(max_bytes) {}

  // A file that takes so many bytes while it is read: waits until it can be read beside the others.
  // Alone, every file can.
  class Slot {
   public:
    Slot(ReadingSlots& slots, double bytes) : slots_(slots), bytes_(bytes) {
      std::unique_lock lock(slots_.mutex_);
      slots_.left_.wait(
          lock, [&] { return slots_.count_ == 0 || slots_.bytes_ + bytes_ <= slots_.max_bytes_; });
      ++slots_.count_;
      slots_.bytes_ += bytes_;
    }
    ~Slot() {
      const std::lock_guard lock(slots_.mutex_);
      --slots_.count_;
      slots_.bytes_ -= bytes_;
      slots_.left_.notify_all();
    }
    Slot(const Slot&) = delete;
    Slot& operator=(const Slot&) = delete;

   private:
    ReadingSlots& slots_;
    const double bytes_;
  };

 private:
  const double max_bytes_;
  std::mutex mutex_;
  std::condition_variable left_;
  unsigned count_ = 0;
  double bytes_ = 0;  // of files being read
};

}  // namespace forcelayer::cache
