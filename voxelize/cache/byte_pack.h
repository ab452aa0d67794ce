// The bytes of a cache entry: plain values one after another, each at a multiple of eight bytes, in
// native byte order. The entry's header names the byte order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace forcelayer::cache {

class BytePacker {
 public:
  void reserve(std::size_t bytes) { bytes_.reserve(bytes); }
  template <class T>
  void value(const T& item) {
    values(std::span<const T>(&item, 1));
  }
  template <class T>
  void values(std::span<const T> items) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + (items.size_bytes() + 7) / 8 * 8);
    if (!items.empty()) std::memcpy(bytes_.data() + at, items.data(), items.size_bytes());
  }
  // With their number in front.
  template <class T>
  void list(const std::vector<T>& items) {
    value(std::uint64_t{items.size()});
    values(std::span<const T>(items));
  }
  void text(std::string_view text) {
    value(std::uint64_t{text.size()});
    values(std::span<const char>(text));
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

struct BadPack {};  // thrown where a pack ends too early or makes no sense

class ByteUnpacker {
 public:
  explicit ByteUnpacker(std::span<const std::byte> bytes) : rest_(bytes) {}

  template <class T>
  T value() {
    T item;
    std::memcpy(&item, take(sizeof(T)), sizeof(T));
    return item;
  }
  // Not copied: the constructor's `bytes` must be aligned for T.
  template <class T>
  std::span<const T> values(std::uint64_t count) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= 8);
    if (count > rest_.size() / sizeof(T)) throw BadPack{};
    return {reinterpret_cast<const T*>(take(count * sizeof(T))), count};
  }
  template <class T>
  std::span<const T> list() {
    return values<T>(value<std::uint64_t>());
  }
  std::string text() {
    const auto characters = list<char>();
    return {characters.begin(), characters.end()};
  }
  void expect_end() const {
    if (!rest_.empty()) throw BadPack{};
  }

 private:
  const std::byte* take(std::size_t bytes) {
    const std::size_t padded = (bytes + 7) / 8 * 8;
    if (padded > rest_.size()) throw BadPack{};
    const std::byte* first = rest_.data();
    rest_ = rest_.subspan(padded);
    return first;
  }

  std::span<const std::byte> rest_;
};

}  // namespace forcelayer::cache
