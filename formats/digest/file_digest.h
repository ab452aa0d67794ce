// SHA-256 of a file's bytes, as `sha256sum` prints it. A user compares it with the digest that he
// noted when he baked the file. Checksums inside a file tell damage, not who wrote it.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"

namespace forcelayer::digest {

// 64 lower-case hexadecimal digits.
std::string sha256_of(std::span<const std::byte> bytes);

// The same of a file, which is read in small pieces.
Result<std::string> sha256_of_file(const std::filesystem::path& path);

// Digests as typed: 64 hexadecimal digits each, with commas or white space between them. Errors:
// kUsage.
Result<std::vector<std::string>> parse_digests(std::string_view text);

// Success where the digest of a file's bytes is one of `expected`, or where `expected` is empty.
// `name` is the file's, for the error. Errors: kChecksumMismatch.
Status check_expected(std::span<const std::byte> bytes, std::span<const std::string> expected,
                      std::string_view name);

}  // namespace forcelayer::digest
