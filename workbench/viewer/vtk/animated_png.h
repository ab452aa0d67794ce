// Pictures one after the other in one PNG, as browsers show it (APNG): the first is what other
// programs see. Source: https://wiki.mozilla.org/APNG_Specification, part of PNG's third edition.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace forcelayer::viewer {

class AnimatedPng {
 public:
  // Played for ever, each picture for `delay_ms`.
  AnimatedPng(std::uint32_t pictures, std::uint16_t delay_ms);

  // Adds the next of the pictures, all of which have the same size and kind of pixels.
  void add(std::span<const std::byte> png);

  // The file, once all have been added.
  std::vector<std::byte> finish();

 private:
  void put_chunk(const char* name, std::span<const std::byte> content);
  void put_control(std::span<const std::byte> header);

  std::vector<std::byte> file_;
  std::uint32_t pictures_, added_ = 0, sequence_ = 0;
  std::uint16_t delay_ms_;
};

}  // namespace forcelayer::viewer
