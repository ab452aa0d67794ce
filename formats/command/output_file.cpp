#include "formats/command/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "formats/command/report.h"
#include "formats/file/atomic_file.h"
#include "formats/file/named_file.h"

namespace forcelayer::command {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxBeginning = 80;  // bytes

struct Kind {
  const char* name;         // "a voxmap"
  std::string_view ending;  // in lower case; empty: any, which says what it is
  // How the files begin that commands write. Only such a file is replaced.
  std::array<std::string_view, 8> beginnings;
};

// The beginnings are those of report.cpp, of the viewer's frame times and of code quality; of
// traces, paths and curves of clearance; of voxinfo export and of JUnit.
const Kind& kind_of(FileKind kind) {
  static constexpr Kind kKinds[] = {
      {"a voxmap", ".vox", {"\211FLV"}},
      {"a point shell", ".pshell", {"\211FLP"}},
      {"a report",
       ".json",
       {"{\n  \"schema_version\"", "{\n  \"width\"", "[]\n", "[\n  {\n    \"description\""}},
      {"a table",
       ".csv",
       {"t_s,handle_x_m,", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n",
        "from_s,to_s,clearance_m,from_m,to_m\n"}},
      {"a recording", ".flr", {"\211FLR"}},
      {"a picture", ".png", {"\211PNG"}},
      {"an animation", ".glb", {"{\"asset\":{\"version\":\"2.0\",\"generator\":\"Forcelayer"}},
      {"an export",
       "",
       {"i,j,k,value\n",
        "ply\nformat binary_little_endian 1.0\ncomment surface that contains the solid",
        "Forcelayer: surface that contains the solid",
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"Forcelayer",
        "ply\nformat binary_little_endian 1.0\ncomment shell points with inward",
        {" BDV\0\0\0\0", 8},
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"voxcheck\"",
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"forcelayer study\""}}};
  return kKinds[static_cast<std::size_t>(kind)];
}

// Endings of what commands read or write. Every other ending may be used for any file but a
// picture, whose viewers go by it.
constexpr std::string_view kKnownEndings[] = {
    ".vox", ".pshell", ".json", ".csv", ".flr", ".png", ".vdb", ".stl", ".obj", ".ply", ".off",
    ".om", ".drc", ".gltf", ".glb", ".bin", ".stp", ".step", ".igs", ".iges", ".mtl",
    // Pictures and pages of other kinds, which no command writes.
    ".jpg", ".jpeg", ".gif", ".bmp", ".tif", ".tiff", ".webp", ".svg", ".pdf", ".html"};

std::string ending_of(const std::string& path) {
  std::string ending = fs::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

template <typename Range>
bool contains(const Range& range, std::string_view text) {
  return std::find(std::begin(range), std::end(range), text) != std::end(range);
}

Error refuse(const OutputFile& output, std::string_view what, std::string_view mend) {
  return {ErrorCode::kUsage, *output.path, output.option, what, mend};
}

// By any name or link. Where neither exists yet, by the name.
bool same_file(const std::string& a, const std::string& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  return fs::weakly_canonical(a, error) == fs::weakly_canonical(b, error) && !error;
}

// The first bytes of a file that is there.
std::string beginning_of(const std::string& path) {
  std::string bytes(kMaxBeginning, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  // The two headers of a GLB file state its size. The text behind them says who wrote it.
  constexpr std::size_t kGlbHeaders = 20;
  if (bytes.starts_with("glTF") && bytes.size() > kGlbHeaders) bytes.erase(0, kGlbHeaders);
  return bytes;
}

Status check_ending(const OutputFile& output) {
  const Kind& kind = kind_of(output.kind);
  const std::string ending = ending_of(*output.path);
  if (kind.ending.empty() || kind.ending == ending) return {};
  const bool is_free = !contains(kKnownEndings, ending);
  if (is_free && (output.kind != FileKind::kPicture || ending.empty())) return {};
  return refuse(output, std::string("the name of ") + kind.name + " must not end in " + ending,
                "choose a name that ends in " + std::string(kind.ending));
}

Status check_replaced(const OutputFile& output) {
  const Kind& kind = kind_of(output.kind);
  const std::string there = beginning_of(*output.path);
  if (there.empty()) return {};
  const bool fits =
      std::any_of(kind.beginnings.begin(), kind.beginnings.end(), [&](std::string_view beginning) {
        return !beginning.empty() && there.starts_with(beginning);
      });
  if (fits) return {};
  return refuse(output,
                std::string("already exists and is not ") + kind.name + " that Forcelayer wrote",
                "choose another name, or remove the file first");
}

// Whether the path ends, by links, at an open descriptor of this process, as /dev/stdout does: it
// is written through, and nothing is replaced.
bool is_descriptor(fs::path path) {
  constexpr int kMaxLinks = 40;  // as the kernel
  std::error_code error;
  for (int i = 0; i < kMaxLinks; ++i) {
    const fs::path folder = path.parent_path();
    if (folder == "/proc/self/fd" || folder == "/dev/fd") return true;
    if (!fs::is_symlink(path, error)) return false;
    path = folder / fs::read_symlink(path, error);
  }
  return false;
}

// The file that is already there under an output's name; false for a device, a pipe, or nothing.
bool replaces_file(const OutputFile& output) {
  std::error_code error;
  return fs::is_regular_file(*output.path, error) && !is_descriptor(*output.path);
}

Status check(const OutputFile& output, std::span<const OutputFile> before,
             std::span<const std::string> inputs) {
  for (const OutputFile& other : before) {
    std::error_code error;
    const bool is_device = fs::exists(*output.path, error) && !replaces_file(output);
    if (other.path->empty() || is_device || !same_file(*other.path, *output.path)) continue;
    return refuse(output, std::string("is also the output of ") + other.option,
                  "use two different names");
  }
  if (*output.path == "-") return {};
  std::error_code error;
  if (fs::exists(*output.path, error) && !replaces_file(output)) return {};
  for (const std::string& input : inputs) {
    if (!same_file(file_of(input), *output.path)) continue;
    return refuse(output, "is an input of this command, and would be replaced",
                  "choose another name");
  }
  if (Status ending = check_ending(output); !ending) return ending;
  return replaces_file(output) ? check_replaced(output) : Status();
}

// Standard output as a path; from here on what is printed goes to standard error.
Result<std::string> take_standard_output() {
  std::fflush(stdout);
  const int taken = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  if (taken < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) {
    return Error{ErrorCode::kWriteFailed, "", "standard output", std::strerror(errno), ""};
  }
  return "/dev/fd/" + std::to_string(taken);
}

}  // namespace

Status check_outputs(std::span<const OutputFile> outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (Status one = check(outputs[i], outputs.first(i), {}); !one) return one;
  }
  return {};
}

Status prepare_outputs(std::span<const OutputFile> outputs, std::span<const std::string> inputs) {
  expect_no_report();
  Status checked;  // the first that is refused
  const OutputFile* report = nullptr;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (outputs[i].path->empty()) continue;
    Status one = check(outputs[i], outputs.first(i), inputs);
    if (one && *outputs[i].path != "-") one = AtomicFile::can_create(*outputs[i].path);
    if (one && std::string_view(outputs[i].option) == "--json") report = &outputs[i];
    if (checked && !one) checked = one;
  }
  for (const OutputFile& output : outputs) {
    if (*output.path != "-" || !(checked || &output == report)) continue;
    auto path = take_standard_output();
    if (!path) return path.error();
    *output.path = std::move(*path);
  }
  if (report != nullptr) begin_report(*report->path, inputs);
  return checked;
}

}  // namespace forcelayer::command
