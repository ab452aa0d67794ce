#include "workbench/disassembly/folder.h"

#include <fcntl.h>
#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <span>
#include <type_traits>
#include <utility>

#include "formats/command/command.h"
#include "formats/command/output_file.h"
#include "formats/command/report.h"
#include "formats/command/text.h"
#include "formats/command/verdict/verdict.h"
#include "formats/command/version.h"
#include "formats/digest/file_digest.h"
#include "formats/path/path_file.h"
#include "workbench/disassembly/report.h"

namespace forcelayer::disassembly {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSequence = "sequence.json";
constexpr char kUnfinished[] = "The disassembly is not finished.";

template <typename Value>
void append(std::string& bytes, const Value& value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  bytes.append(raw, sizeof raw);
}

std::string digest_of(const std::string& bytes) {
  return digest::sha256_of(std::as_bytes(std::span(bytes)));
}

// The part's name, its triangles in the world and its deviation.
std::string digest_of(const pairs::AssemblyParts& assembly, const pairs::AssemblyPart& part) {
  const exact::Surface surface = pairs::surface_of(assembly.scene, part);
  std::string bytes = part.name.listed;
  bytes.push_back('\0');
  append(bytes, part.deviation_m);
  for (const glm::dvec3& vertex : surface.vertices_m) {
    for (int axis = 0; axis < 3; ++axis) append(bytes, vertex[axis]);
  }
  for (const mesh::Triangle& triangle : surface.triangles) append(bytes, triangle);
  return digest_of(bytes);
}

// A part's name as a name of a file.
std::string file_name(std::string name) {
  constexpr std::size_t kLongest = 60;
  for (char& c : name) {
    const bool is_plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                          (c >= '0' && c <= '9') || c == '.' || c == '-';
    if (!is_plain) c = '_';
  }
  return name.size() > kLongest ? name.substr(name.size() - kLongest) : name;
}

Status write_rows(const std::string& file, const std::vector<PathRow>& rows) {
  auto writer = PathWriter::create(file);
  if (!writer) return writer.error();
  for (const PathRow& row : rows) {
    if (Status s = writer->add(row); !s) return s;
  }
  return writer->finish();
}

Parts parts_of(const pairs::AssemblyParts& assembly, const nlohmann::json& names) {
  Parts parts;
  for (const nlohmann::json& name : names) {
    for (std::size_t part = 0; part < assembly.parts.size(); ++part) {
      if (assembly.parts[part].name.listed == name) parts.push_back(part);
    }
  }
  std::sort(parts.begin(), parts.end());
  return parts;
}

}  // namespace

Folder::Folder(std::string folder, Descriptor lock, const pairs::AssemblyParts& assembly,
               const Request& request)
    : folder_(std::move(folder)), lock_(std::move(lock)), assembly_(assembly), request_(request) {
  for (const pairs::AssemblyPart& part : assembly.parts) {
    digests_.push_back(digest_of(assembly, part));
  }
  std::ifstream file(in(kSequence), std::ios::binary);
  known_ = nlohmann::json::parse(file, nullptr, false);
}

std::string Folder::in(const std::string& name) const {
  return (std::filesystem::path(folder_) / name).string();
}

Result<Folder> Folder::open(const std::string& folder, const pairs::AssemblyParts& assembly,
                            const Request& request) {
  std::error_code failure;
  const std::filesystem::path paths = std::filesystem::path(folder) / "paths";
  const bool is_known = std::filesystem::exists(std::filesystem::path(folder) / kSequence);
  if (!is_known && std::filesystem::exists(paths) && !std::filesystem::is_empty(paths, failure)) {
    return Error{ErrorCode::kUsage, paths.string(), "--output",
                 "has files, but no disassembly wrote them", "name another folder"};
  }
  std::filesystem::create_directories(paths, failure);
  if (failure) {
    return Error{ErrorCode::kWriteFailed, folder, "--output", failure.message(),
                 "name a folder that can be written to"};
  }
  // The system lets the lock go however this program ends. A file system that knows no such lock
  // refuses nobody.
  Descriptor lock(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (lock.valid() && ::flock(lock.number(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return Error{ErrorCode::kWriteFailed, folder, "--output",
                 "another disassembly is writing to this folder",
                 "wait until it has ended, or name another folder"};
  }
  Folder opened(folder, std::move(lock), assembly, request);
  std::string sequence = opened.in(kSequence);
  const command::OutputFile output[] = {{"--output", &sequence, command::FileKind::kReport}};
  if (Status s = command::check_outputs(output); !s) return s.error();
  if (Status s = opened.check_target(); !s) return s.error();
  // A path without that file is not of a disassembly: it is there first.
  if (Status s = is_known ? opened.mark_unfinished() : opened.write({}, false, 0); !s) {
    return s.error();
  }
  return opened;
}

Status Folder::check_target() const {
  if (!known_.is_object() || !known_.contains("target")) return {};
  if (nlohmann::json(outcome_json(assembly_, request_, {})["target"]) == known_["target"])
    return {};
  return Error{ErrorCode::kUsage, folder_, "--output", "holds a disassembly with another --target",
               "name another folder"};
}

// The file may be of other parts by now. Its steps stay, for recall().
Status Folder::mark_unfinished() const {
  std::ifstream file(in(kSequence), std::ios::binary);
  auto known = Json::parse(file, nullptr, false);
  if (!known.is_object()) return {};
  known["sentence"] = kUnfinished;
  known["finished"] = false;
  known["out_of_time"] = false;
  known["left"] = Json::array();
  return command::write_report(in(kSequence), known);
}

std::string Folder::state_of(const Parts& present) const {
  std::string bytes = std::string(command::kVersion) + " " + command::commit();
  append(bytes, request_.required_m);
  for (const pairs::Rule& rule : request_.rules) {
    bytes += rule.part + '\0' + rule.object + '\0';
    append(bytes, rule.requirement.kind);
    append(bytes, rule.requirement.clearance_m);
  }
  const auto add = [&](const Parts& parts) {
    bytes.push_back('\0');
    for (const std::size_t part : parts) bytes += digests_[part];
  };
  add(present);
  add(request_.target);
  return digest_of(bytes);
}

std::vector<Step> Folder::recall(const Parts& present) const {
  std::vector<Step> steps;
  if (!known_.is_object() || !known_.contains("steps") || !known_["steps"].is_array()) return steps;
  const std::string state = state_of(present);
  for (const nlohmann::json& known : known_["steps"]) {
    if (!known.is_object() || known.value("state", "") != state) continue;
    auto step = step_of(known);
    if (!step) return {};
    steps.push_back(std::move(*step));
  }
  return steps;
}

std::optional<Step> Folder::step_of(const nlohmann::json& known) const try {
  const std::string file = in(known.at("path"));
  const auto digest = digest::sha256_of_file(file);
  if (!digest || *digest != known.at("path_sha256")) return std::nullopt;
  auto rows = read_path(file, PathOf::kPart);
  if (!rows) return std::nullopt;
  Step step;
  step.parts = parts_of(assembly_, known.at("parts"));
  if (step.parts.empty() || step.parts.size() != known.at("parts").size()) return std::nullopt;
  step.rows = std::move(*rows);
  step.settled_by = known.at("settled_by");
  step.length_m = known.at("path_length_m");
  if (!known.at("nearest").is_null()) {
    const Parts nearest = parts_of(assembly_, nlohmann::json::array({known["nearest"]}));
    if (nearest.empty()) return std::nullopt;
    step.nearest = nearest.front();
    step.distance_m = known.at("distance_m");
    step.clearance_m = known.at("clearance_m");
  }
  step.touched = parts_of(assembly_, known.at("touches"));
  step.ignored = parts_of(assembly_, known.at("ignores"));
  step.from = parts_of(assembly_, known.at("from"));
  step.hidden_overlap_m = known.at("hidden_overlap_m");
  for (const nlohmann::json& overlap : known.at("overlaps")) {
    const Parts object = parts_of(assembly_, nlohmann::json::array({overlap.at("object")}));
    if (object.empty()) return std::nullopt;
    step.overlaps.push_back({object.front(), overlap.at("depth_m")});
  }
  return step;
} catch (const nlohmann::json::exception&) {  // the file was changed by someone
  return std::nullopt;
}

Status Folder::add(const Parts& present, const std::vector<Step>& steps) {
  const std::string state = state_of(present);
  for (const Step& step : steps) {
    const std::string name =
        command::text("paths/%03zu_", steps_.size() + 1) +
        file_name(command::short_name(assembly_.paths[step.parts.front()], assembly_.paths)) +
        ".csv";
    if (Status s = write_rows(in(name), step.rows); !s) return s;
    const auto digest = digest::sha256_of_file(in(name));
    if (!digest) return digest.error();
    Json json = step_json(assembly_, step);
    json["path"] = name;
    json["path_sha256"] = *digest;
    json["state"] = state;
    steps_.push_back(std::move(json));
  }
  return {};
}

Status Folder::write(const Outcome& outcome, bool finished, double seconds) {
  written_ = {{"schema_version", command::kReportSchema}};  // by which a later run knows the file
  written_.update(outcome_json(assembly_, request_, outcome));
  written_["steps"] = steps_;
  if (!finished && !outcome.is_out_of_time) written_["sentence"] = kUnfinished;
  written_["finished"] = finished;
  written_["seconds"] = seconds;
  if (Status s = command::write_report(in(kSequence), written_); !s) return s;
  if (!finished || !known_.is_object() || !known_.contains("steps")) return {};
  for (const nlohmann::json& known : known_["steps"]) {
    if (!known.is_object() || !known.contains("path") || !known["path"].is_string()) continue;
    const std::string name = known["path"];
    const bool is_ours = name.starts_with("paths/") && name.find('/', 6) == std::string::npos;
    const bool is_named = std::any_of(steps_.begin(), steps_.end(),
                                      [&](const Json& step) { return step["path"] == name; });
    std::error_code ignored;
    if (is_ours && !is_named) std::filesystem::remove(in(name), ignored);
  }
  return {};
}

}  // namespace forcelayer::disassembly
