#include "workbench/study/view.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <utility>
#include <vector>

#include "formats/command/text.h"
#include "formats/file/file_bytes.h"
#include "workbench/study/curve.h"
#include "workbench/study/embedded.h"
#include "workbench/study/html.h"

namespace forcelayer::study {
namespace {

using Json = nlohmann::ordered_json;

// With three.js, base64 and the pictures a page stays below 5 MB.
constexpr std::size_t kMaxMotionBytes = 2'600'000;
constexpr std::size_t kNamed = 20;  // objects that a sentence lists

struct Motion {
  std::string glb;                    // empty where the part alone is too large
  std::vector<std::string> left_out;  // names
};

Error not_readable(const std::string& path) {
  return {ErrorCode::kReadFailed, path, "", "is not an animation that voxcheck wrote", ""};
}

// The first nodes of the file, as many as fit: mesh, material, accessors and buffer views of each
// follow those of the motion (write_glb()).
Result<Motion> read_motion(const std::string& path) {
  constexpr std::size_t kHead = 20, kChunk = 8, kOfMotion = 3;
  const auto file = FileBytes::read(path);
  if (!file) return file.error();
  const std::span<const std::byte> bytes = file->bytes();
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::uint32_t size = 0;
  if (bytes.size() < kHead) return not_readable(path);
  std::memcpy(&size, bytes.data() + 12, sizeof size);
  if (bytes.size() < kHead + size + kChunk) return not_readable(path);
  Json json = Json::parse(text.substr(kHead, size), nullptr, false);
  if (!json.is_object()) return not_readable(path);
  const auto accessors_of = [&](std::size_t nodes) {  // each has its own buffer view
    std::size_t count = kOfMotion;
    for (std::size_t n = 0; n < nodes; ++n) {
      count += json["meshes"][n]["primitives"][0]["attributes"].size() + 1;
    }
    return count;
  };
  const auto end_of = [&](std::size_t nodes) {
    const Json& last = json["bufferViews"][accessors_of(nodes) - 1];
    return (last["byteOffset"].get<std::size_t>() + last["byteLength"].get<std::size_t>() + 3) / 4 *
           4;
  };
  Motion motion;
  const std::size_t all = json["meshes"].size();
  std::size_t nodes = all;  // the text shrinks with them
  while (nodes > 0 && end_of(nodes) + size * nodes / all > kMaxMotionBytes) {
    motion.left_out.push_back(json["nodes"][nodes]["name"]);
    --nodes;
  }
  if (nodes == 0) return motion;
  const auto keep = [](Json& list, std::size_t count) {
    list.erase(list.begin() + static_cast<std::ptrdiff_t>(count), list.end());
  };
  keep(json["nodes"], nodes + 1);
  keep(json["nodes"][0]["children"], nodes);
  keep(json["meshes"], nodes);
  keep(json["materials"], nodes);
  const std::size_t end = end_of(nodes);
  keep(json["accessors"], accessors_of(nodes));
  keep(json["bufferViews"], accessors_of(nodes));
  json["buffers"][0]["byteLength"] = end;
  if (bytes.size() < kHead + size + kChunk + end) return not_readable(path);
  std::string head = json.dump();
  head.resize((head.size() + 3) / 4 * 4, ' ');
  const auto put = [&](std::size_t number) {
    const auto value = static_cast<std::uint32_t>(number);
    motion.glb.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  motion.glb = text.substr(0, 8);
  put(kHead + head.size() + kChunk + end);
  put(head.size());
  motion.glb += text.substr(16, 4);
  motion.glb += head;
  put(end);
  motion.glb += text.substr(kHead + size + 4, 4 + end);
  return motion;
}

// Neighbors are joined until there are few enough: with the least clearance of both.
std::vector<CurvePiece> joined(std::vector<CurvePiece> pieces) {
  constexpr std::size_t kMaxPieces = 4000;
  while (pieces.size() > kMaxPieces) {
    for (std::size_t n = 0; n < pieces.size(); n += 2) {
      CurvePiece piece = pieces[n];
      if (n + 1 < pieces.size()) {
        const CurvePiece& next = pieces[n + 1];
        piece.to_m = next.to_m, piece.to_s = next.to_s;
        piece.clearance_m = std::min(piece.clearance_m, next.clearance_m);
      }
      pieces[n / 2] = piece;
    }
    pieces.resize((pieces.size() + 1) / 2);
  }
  return pieces;
}

// JSON as the text of a script element, which "</" would end.
std::string script_text(const nlohmann::json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)) {
    text += c == '<' ? "\\u003c" : std::string(1, c);
  }
  return text;
}

std::string left_out_text(const std::vector<std::string>& names) {
  if (names.empty()) return "";
  std::string text = "<p>The 3D view leaves out the objects farthest from the path: ";
  for (std::size_t n = 0; n < std::min(names.size(), kNamed); ++n) {
    text += (n == 0 ? "" : ", ") + html(names[n]);
  }
  if (names.size() > kNamed) {
    text += command::text(" and %zu more", names.size() - kNamed);
  }
  return text + ".</p>\n";
}

}  // namespace

bool can_show() { return !embedded("three.js").empty(); }

std::string view_style() { return embedded("view.css"); }

Result<std::string> view_html(const View& view) {
  auto motion = read_motion(view.map.empty() ? view.motion : view.map);
  if (motion && !motion->left_out.empty()) motion = read_motion(view.motion);
  if (!motion) return motion.error();
  if (motion->glb.empty()) {
    return "<p>This page has no 3D view, because the part has too many triangles. Other viewers "
           "show " +
           html(std::filesystem::path(view.motion).filename().string()) + ".</p>\n";
  }
  auto pieces = read_curve(view.curve);
  if (!pieces) return pieces.error();
  nlohmann::json data{{"moments", view.moments}, {"near", view.near}};
  for (const CurvePiece& p : joined(std::move(*pieces))) {
    data["curve"].push_back({p.from_m, p.to_m, p.from_s, p.to_s, p.clearance_m});
  }
  const auto glb = std::as_bytes(std::span(motion->glb));
  return embedded("view.html") + left_out_text(motion->left_out) +
         "<script type=\"application/json\" id=\"view-data\">" + script_text(data) +
         "</script>\n<script type=\"application/base64\" id=\"view-motion\">" + base64(glb) +
         "</script>\n<!-- three.js\n" + embedded("three_license.txt") + "-->\n<script>\n" +
         embedded("three.js") + "</script>\n<script>\n" + embedded("view.js") + "</script>\n";
}

}  // namespace forcelayer::study
