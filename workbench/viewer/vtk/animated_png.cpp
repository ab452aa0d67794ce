#include "workbench/viewer/vtk/animated_png.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace forcelayer::viewer {
namespace {

constexpr std::size_t kSignature = 8, kLength = 4, kName = 4, kChecksum = 4;  // bytes

template <typename Number>
void put(std::vector<std::byte>& bytes, Number number) {  // the most significant byte first
  for (std::size_t n = sizeof number; n-- > 0;) {
    bytes.push_back(static_cast<std::byte>(number >> (8 * n) & 0xff));
  }
}

std::uint32_t length_at(std::span<const std::byte> bytes) {
  std::uint32_t length = 0;
  for (std::size_t n = 0; n < kLength; ++n)
    length = length << 8 | std::to_integer<std::uint32_t>(bytes[n]);
  return length;
}

constexpr std::array<std::uint32_t, 256> make_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t value = n;
    for (int bit = 0; bit < 8; ++bit) value = value >> 1 ^ (value & 1 ? 0xedb88320u : 0);
    table[n] = value;
  }
  return table;
}

// CRC-32 as PNG has it.
std::uint32_t checksum(std::span<const std::byte> bytes) {
  static constexpr auto kTable = make_table();
  std::uint32_t value = ~0u;
  for (const std::byte byte : bytes) {
    value = kTable[(value ^ std::to_integer<std::uint32_t>(byte)) & 0xff] ^ value >> 8;
  }
  return ~value;
}

}  // namespace

AnimatedPng::AnimatedPng(std::uint32_t pictures, std::uint16_t delay_ms)
    : pictures_(pictures), delay_ms_(delay_ms) {}

void AnimatedPng::put_chunk(const char* name, std::span<const std::byte> content) {
  put(file_, static_cast<std::uint32_t>(content.size()));
  const std::size_t begin = file_.size();
  for (std::size_t n = 0; n < kName; ++n) file_.push_back(static_cast<std::byte>(name[n]));
  file_.insert(file_.end(), content.begin(), content.end());
  put(file_, checksum(std::span(file_).subspan(begin)));
}

// fcTL: the picture that follows replaces all of the one before.
void AnimatedPng::put_control(std::span<const std::byte> header) {
  std::vector<std::byte> control;
  put(control, sequence_++);
  control.insert(control.end(), header.begin(), header.begin() + 8);  // width, height
  put(control, std::uint64_t{0});                                     // offsets
  put(control, delay_ms_);
  put(control, std::uint16_t{1000});
  put(control, std::uint16_t{0});  // nothing is disposed of, nothing blended
  put_chunk("fcTL", control);
}

void AnimatedPng::add(std::span<const std::byte> png) {
  if (added_ == 0) file_.assign(png.begin(), png.begin() + kSignature);
  for (auto rest = png.subspan(kSignature); rest.size() >= kLength + kName + kChecksum;) {
    const std::size_t length = length_at(rest);
    const std::string_view name(reinterpret_cast<const char*>(rest.data()) + kLength, kName);
    const auto content = rest.subspan(kLength + kName, length);
    if (name == "IHDR") {
      if (added_ == 0) {
        put_chunk("IHDR", content);
        std::vector<std::byte> animation;
        put(animation, pictures_);
        put(animation, std::uint32_t{0});  // played for ever
        put_chunk("acTL", animation);
      }
      put_control(content);
    } else if (name == "IDAT" && added_ == 0) {
      put_chunk("IDAT", content);
    } else if (name == "IDAT") {
      std::vector<std::byte> data;
      put(data, sequence_++);
      data.insert(data.end(), content.begin(), content.end());
      put_chunk("fdAT", data);
    }
    rest = rest.subspan(kLength + kName + length + kChecksum);
  }
  ++added_;
}

std::vector<std::byte> AnimatedPng::finish() {
  put_chunk("IEND", {});
  return std::move(file_);
}

}  // namespace forcelayer::viewer
