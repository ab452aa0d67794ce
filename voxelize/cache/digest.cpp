#include "voxelize/cache/digest.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

namespace forcelayer::cache {
namespace {

Digest digest(XXH128_hash_t hash) { return {hash.low64, hash.high64}; }

}  // namespace

struct DigestBuilder::State {
  XXH3_state_t hash;
};

std::string Digest::hex() const {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(high),
                static_cast<unsigned long long>(low));
  return text;
}

Digest digest_of(std::span<const std::byte> bytes) {
  return digest(XXH3_128bits(bytes.data(), bytes.size()));
}

DigestBuilder::DigestBuilder() : state_(std::make_unique<State>()) {
  XXH3_128bits_reset(&state_->hash);
}
DigestBuilder::~DigestBuilder() = default;

DigestBuilder& DigestBuilder::raw(std::span<const std::byte> bytes) {
  XXH3_128bits_update(&state_->hash, bytes.data(), bytes.size());
  return *this;
}

DigestBuilder& DigestBuilder::bytes(std::span<const std::byte> bytes) {
  return value(std::uint64_t{bytes.size()}).raw(bytes);
}

DigestBuilder& DigestBuilder::text(std::string_view text) {
  return bytes(std::as_bytes(std::span(text)));
}

Digest DigestBuilder::finish() const { return digest(XXH3_128bits_digest(&state_->hash)); }

}  // namespace forcelayer::cache
