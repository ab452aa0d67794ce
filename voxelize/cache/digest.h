// 128-bit content digests (XXH3), the names of cache entries. They find accidents, not forgeries.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace forcelayer::cache {

struct Digest {
  std::uint64_t low = 0, high = 0;

  auto operator<=>(const Digest&) const = default;
  std::string hex() const;  // 32 digits, high first
};

// The digest of one run of bytes.
Digest digest_of(std::span<const std::byte> bytes);

// The digest of a sequence of pieces. Texts and spans go in with their length, so that different
// sequences never read the same.
class DigestBuilder {
 public:
  DigestBuilder();
  ~DigestBuilder();

  DigestBuilder& bytes(std::span<const std::byte> bytes);
  DigestBuilder& text(std::string_view text);
  template <class T>
  DigestBuilder& value(const T& number) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    return raw(std::as_bytes(std::span(&number, 1)));
  }
  Digest finish() const;

 private:
  DigestBuilder& raw(std::span<const std::byte> bytes);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace forcelayer::cache
