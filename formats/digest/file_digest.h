// SHA-256 of a file, as `sha256sum` prints it. A user compares it with the digest that he noted
// when he baked the file. Checksums inside a file tell damage, not who wrote it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/mapped_file.h"
#include "formats/result.h"

namespace forcelayer::digest {

// 64 lower-case hexadecimal digits.
std::string sha256_of(std::span<const std::byte> bytes);

// The SHA-256 of an open file. Reads small pieces, so that the process's memory does not grow.
Result<std::string> sha256_of(const MappedFile& file);

// Digests as typed: 64 hexadecimal digits each, with commas or white space between them. Errors:
// kUsage.
Result<std::vector<std::string>> parse_digests(std::string_view text);

// Success where the file's digest is one of `expected`, or where `expected` is empty; the file is
// then not read. `name` is the file's, for the error. Errors: kChecksumMismatch.
Status check_expected(const MappedFile& file, std::span<const std::string> expected,
                      std::string_view name);

}  // namespace forcelayer::digest
