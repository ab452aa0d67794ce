#include "formats/digest/file_digest.h"

#include <nettle/sha2.h>

#include <algorithm>

#include "formats/file/file_bytes.h"

namespace forcelayer::digest {
namespace {

constexpr std::size_t kDigits = 2 * SHA256_DIGEST_SIZE;

class Sha256 {
 public:
  Sha256() { sha256_init(&state_); }
  void add(std::span<const std::byte> bytes) {
    sha256_update(&state_, bytes.size(), reinterpret_cast<const std::uint8_t*>(bytes.data()));
  }
  std::string digits() {
    std::uint8_t digest[SHA256_DIGEST_SIZE];
    sha256_digest(&state_, sizeof digest, digest);
    std::string text;
    for (const std::uint8_t byte : digest) {
      text += "0123456789abcdef"[byte >> 4];
      text += "0123456789abcdef"[byte & 15];
    }
    return text;
  }

 private:
  sha256_ctx state_;
};

}  // namespace

std::string sha256_of(std::span<const std::byte> bytes) {
  Sha256 sha;
  sha.add(bytes);
  return sha.digits();
}

Result<std::string> sha256_of_file(const std::filesystem::path& path) {
  Sha256 sha;
  const auto add = [&](std::span<const std::byte> piece) { sha.add(piece); };
  if (Status read = read_in_pieces(path, add); !read) return read.error();
  return sha.digits();
}

Result<std::vector<std::string>> parse_digests(std::string_view text) {
  std::vector<std::string> digests(1);
  for (const char c : text) {
    const char lower = c >= 'A' && c <= 'F' ? static_cast<char>(c - 'A' + 'a') : c;
    if (c == ',' || c == ' ' || c == '\t' || c == '\n') {
      if (!digests.back().empty()) digests.emplace_back();
    } else {
      digests.back() += lower;
    }
  }
  if (digests.size() > 1 && digests.back().empty()) digests.pop_back();
  for (const std::string& digest : digests) {
    if (digest.size() == kDigits &&
        digest.find_first_not_of("0123456789abcdef") == std::string::npos) {
      continue;
    }
    return Error{ErrorCode::kUsage, "", "", "'" + digest + "' is not a SHA-256",
                 "give 64 hexadecimal digits, as sha256sum or voxinfo prints them"};
  }
  return digests;
}

Status check_expected(std::span<const std::byte> bytes, std::span<const std::string> expected,
                      std::string_view name) {
  if (expected.empty()) return {};
  const std::string digest = sha256_of(bytes);
  if (std::find(expected.begin(), expected.end(), digest) != expected.end()) return {};
  return Error{ErrorCode::kChecksumMismatch, std::string(name), "",
               "has the SHA-256 " + digest + ", which is not expected",
               "use the intended file, or add this SHA-256 to the expected ones"};
}

}  // namespace forcelayer::digest
