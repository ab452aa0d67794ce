#include "workbench/study/page.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "formats/command/command.h"
#include "formats/command/text.h"
#include "formats/command/version.h"
#include "formats/digest/file_digest.h"
#include "formats/file/file_bytes.h"
#include "workbench/study/html.h"
#include "workbench/study/view.h"

namespace forcelayer::study {
namespace {

using command::kDecimalM;
using command::text;
using Json = nlohmann::json;

// Two depths of one pose that are searched for differ by less, m.
constexpr double kSearchedM = 1e-6;
std::string row(const std::string& name, const std::string& value) {
  return "<tr><th>" + html(name) + "</th><td>" + value + "</td></tr>\n";
}

std::string mm(const Json& length_m) {
  return length_m.is_number() ? command::length_text(length_m.get<double>()) : "not known";
}

std::string name_of(const Json& object) {
  return object.is_string() ? html(object.get<std::string>()) : "not known";
}

// A length along the path, to a tenth of a millimeter.
std::string along(const Json& length_m) { return text("%.1f mm", 1e3 * length_m.get<double>()); }

std::string place(const Json& p) {
  const auto mm = [&](int axis) { return std::round(1e5 * p[axis].get<double>()) / 1e2 + 0.0; };
  return text("x %.2f, y %.2f, z %.2f mm", mm(0), mm(1), mm(2));
}

// The same of several lines.
std::string html_lines(const std::string& plain) {
  std::string out;
  for (std::size_t from = 0; from < plain.size();) {
    const std::size_t to = std::min(plain.find('\n', from), plain.size());
    out += html(std::string_view(plain).substr(from, to - from)) + (to < plain.size() ? "\n" : "");
    from = to + 1;
  }
  return out;
}

// Measured where the meshes were asked, else the bounds.
std::string clearance(const Json& moment) {
  if (moment.contains("exact_m")) return mm(moment["exact_m"]) + " measured";
  const Json& at_most_m = moment["at_most_m"];
  return command::bounds_text(moment["clearance_m"],
                              at_most_m.is_number() ? at_most_m.get<double>() : INFINITY);
}

std::string facts_table(const Page& page) {
  const Json& v = page.report;
  const Json& smallest = v["min_clearance"];
  std::string table = "<table>\n" + row("required", mm(v["required_clearance_m"]));
  const bool at_least = smallest.value("at_least", false);
  const bool is_seated = !v["seated"].empty();
  const bool is_near = !v["violations"].empty();  // then their table says where it is worst
  if (!is_near) {
    table += row(is_seated ? "smallest distance while not in its seat" : "smallest distance",
                 at_least ? "at least " + mm(smallest["clearance_m"])
                          : clearance(smallest) + " to " + name_of(smallest["object"]));
  }
  if (!is_near && !at_least) {
    table += row("position", "after " + along(smallest["along_path_m"]) + " of the path, at " +
                                 place(smallest["point_m"]));
  }
  std::string seat;
  for (const Json& object : v["seat"]) seat += (seat.empty() ? "" : ", ") + name_of(object);
  if (!seat.empty()) table += row("installed on", seat);
  for (const Json& s : v.value("seat_depths", Json::array())) {
    const double installed_m = s["installed_m"], deepest_m = s["deepest_m"];
    const bool is_deeper = deepest_m > installed_m + kSearchedM;
    const std::string object = s["object"];
    const double gap_m = s["gap_m"], allowed_m = s["allowed_m"];
    if (gap_m > 0) table += row("gap to " + object, mm(gap_m + kDecimalM) + " when installed");
    if (gap_m > 0 && !is_deeper) continue;
    std::string depth = mm(installed_m) + " when installed";
    if (is_deeper) depth = "at least " + mm(deepest_m) + "; " + depth;
    if (allowed_m > installed_m + kSearchedM) {
      depth += "; allowed: at most " + command::at_most_text(allowed_m);
    }
    table += row("depth in " + object, depth);
  }
  for (const Json& s : v["seated"]) {
    table += row("in its seat", along(s["from_m"]) + " to " + along(s["to_m"]) + " of a path of " +
                                    along(v["path_m"]) + "; " + clearance(s) + " to " +
                                    name_of(s["object"]));
  }
  for (const Json& rule : v.value("rules", Json::array())) {
    std::string objects;
    for (const Json& object : rule["objects"])
      objects += (objects.empty() ? "" : ", ") + name_of(object);
    table +=
        row("by the rules", objects + ": " +
                                (rule.contains("sentence") ? rule["sentence"].get<std::string>()
                                                           : std::string("ignored")));
  }
  if (v.contains("hidden_within_m")) {
    table += row("not checked", "hidden objects less than " + mm(v["hidden_within_m"]) +
                                    " behind an object of the seat or of --allow");
  }
  if (const auto missing = v.value("missing_faces", std::uint64_t{0}); missing > 0) {
    table += row("faces that could not be read",
                 std::to_string(missing) + " of scene and part; the verdict does not cover them");
  }
  table += row("voxel", mm(page.scene["voxel_size_m"]));
  table += row("points of the shell", std::to_string(page.shell["points"].get<std::uint64_t>()));
  table += row("poses", std::to_string(v["poses"].get<std::uint64_t>()));
  return table + "</table>\n";
}

// A depth in the seat is of the meshes, or of shell points beyond where they are installed.
std::string depth_words(const Json& violation) {
  return violation.contains("exact_m") ? " deep" : " deeper than installed";
}

bool is_open(const Json& violation) {
  return violation.value("seat_not_settled", false) || violation.value("graze", false);
}

// How near the part comes in a stretch that is not clear, or how deep.
std::string how_near(const Json& v) {
  std::string how = clearance(v);
  if (v.contains("exact_m") && v["exact_m"] == 0) {
    how = v.value("inside", false) ? "all of the part is inside" : "the surfaces meet";
    if (v.contains("depth_m")) how += ", at least " + mm(v["depth_m"]) + " deep";
  }
  if (v.value("pushed_into_seat", false)) how = mm(v["depth_m"]) + depth_words(v);
  if (v.value("object_inside", false)) how = "the object lies inside the part";
  if (v.value("seat_not_settled", false)) how = "in its seat, overlap not known";
  if (v.value("graze", false)) how += ", too close to call";
  return how;
}

std::string violations_table(const Json& violations) {
  if (violations.empty()) return "";
  std::string table = "<h2>Positions that are ";
  table += std::all_of(violations.begin(), violations.end(), is_open) ? "not decided" : "too near";
  table +=
      "</h2>\n<table>\n<tr><th>from</th><th>to</th><th>distance</th><th>object</th><th>worst "
      "after</th><th>position</th></tr>\n";
  for (const Json& v : violations) {
    const bool is_placed = !v.value("seat_not_settled", false);
    table += "<tr><td>" + along(v["from_m"]) + "</td><td>" + along(v["to_m"]) + "</td><td>" +
             how_near(v) + "</td><td>" + name_of(v["object"]) + "</td><td>" +
             along(v["along_path_m"]) + "</td><td>" + (is_placed ? place(v["point_m"]) : "") +
             "</td></tr>\n";
  }
  return table + "</table>\n";
}

// The moments of the report that have a button, the worst one first, and the objects that they
// name.
View view_of(const Page& page) {
  View view{page.motion, page.map, page.curve};
  const auto add = [&](std::string name, const std::string& words, const Json& moment) {
    if (moment.value("at_least", false) || moment.value("out_of_time", false)) return;
    const std::string object = moment["object"].is_string() ? moment["object"] : "not known";
    if (name.empty()) name = object + ", after " + along(moment["along_path_m"]);
    const bool is_measured = moment.contains("exact_m") && moment["exact_m"].is_number();
    Json shown{{"name", name},
               {"words", object + ", " + words},
               {"along_m", moment["along_path_m"]},
               {"t_s", moment["t_s"]},
               {"value_m", moment[is_measured ? "exact_m" : "clearance_m"]}};
    if (!moment.value("seat_not_settled", false)) shown["point_m"] = moment["point_m"];
    view.moments.push_back(shown);
    view.near.push_back(object);
  };
  const Json& v = page.report;
  if (v["violations"].empty()) {
    add("Worst moment", clearance(v["told_moment"]), v["told_moment"]);
  }
  Json violations = v["violations"];
  const Json& named = v["min_clearance"];  // the one of the verdict's sentence
  std::stable_partition(violations.begin(), violations.end(), [&](const Json& each) {
    return each["object"] == named["object"] && each["t_s"] == named["t_s"];
  });
  for (const Json& each : violations) {
    add(view.moments.empty() ? "Worst moment" : "", how_near(each), each);
  }
  for (const Json& each : v["seated"]) add("Nearest in its seat", clearance(each), each);
  return view;
}

Result<std::string> view(const Page& page) {
  if (!can_show()) {
    return std::string(
        "<p>This page has no 3D view, because forcelayer was built without three.js.</p>\n");
  }
  if (page.motion.empty()) {
    return std::string("<p>This page has no 3D view, because the study reads no meshes.</p>\n");
  }
  return view_html(view_of(page));
}

Result<std::string> pictures(const std::vector<Picture>& pictures) {
  std::string out;
  for (const Picture& picture : pictures) {
    const auto file = FileBytes::read(picture.file);
    if (!file) return file.error();
    out += "<figure><img alt=\"" + html(picture.words) + "\" src=\"data:image/png;base64," +
           base64(file->bytes()) + "\"><figcaption>" + html(picture.words) +
           "</figcaption></figure>\n";
  }
  return out;
}

Result<std::string> files_table(const std::vector<std::string>& files) {
  if (files.empty()) return std::string();
  std::string table = "<h2>Files</h2>\n<table>\n<tr><th>file</th><th>SHA-256</th></tr>\n";
  for (const std::string& path : files) {
    const auto digest = digest::sha256_of_file(path);
    if (!digest) return digest.error();
    table += "<tr><td>" + html(std::filesystem::path(path).filename().string()) +
             "</td><td><code>" + *digest + "</code></td></tr>\n";
  }
  return table + "</table>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.45 sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2rem}table{border-collapse:collapse}"
    "th,td{text-align:left;padding:.2rem .9rem .2rem 0;border-bottom:1px solid #ddd;"
    "vertical-align:top}figure{margin:1rem 0}img,svg{max-width:100%;height:auto}"
    ".verdict{padding:.8rem 1rem;border-left:.5rem solid;white-space:pre-wrap}"
    ".yes{border-color:#009e73;background:#e6f5f0}.no{border-color:#d55e00;background:#fbeee6}"
    ".open{border-color:#767676;background:#f2f2f2}.force{border-color:#e69f00;background:#fdf6e5}"
    "pre{background:#f4f4f4;padding:.8rem;white-space:pre-wrap;overflow-wrap:anywhere}"
    "code{font-size:.85rem}";

// The color of a verdict: yes, yes by force, no, or open, where a longer search or more exact files
// may decide.
const char* class_of(command::VerdictKind kind) {
  using command::VerdictKind;
  if (command::is_yes(kind)) return "yes";
  if (command::passes(kind)) return "force";
  return kind == VerdictKind::kUndecided || kind == VerdictKind::kTooCloseToCall ||
                 kind == VerdictKind::kNoPathFound || kind == VerdictKind::kRefused
             ? "open"
             : "no";
}

std::string commands_of(const Page& page) {
  if (page.commands.empty()) return "";
  std::string lines;
  for (const std::string& line : page.commands) lines += html(line) + "\n";
  return "<h2>Commands</h2>\n<pre>" + lines + "</pre>\n";
}

}  // namespace

Result<std::string> html_of(const Page& page) {
  const auto drawn = pictures(page.pictures);
  if (!drawn) return drawn.error();
  const auto files = files_table(page.files);
  if (!files) return files.error();
  const std::string title = page.part + " of " + page.assembly;
  const bool is_first = page.text.starts_with(page.heading);
  const std::string text = is_first ? page.text.substr(page.heading.size()) : "\n" + page.text;
  std::string found;
  if (page.report.is_object()) {
    found = facts_table(page) + violations_table(page.report["violations"]) +
            "<h2>Clearance along the path</h2>\n" + page.curve_svg +
            "<p>The curve is a safe lower bound; the real distance is larger. Dot: the smallest "
            "distance (see the first table). Gray: in the seat. Red: less than required, or not "
            "decided.</p>\n";
    const auto shown = view(page);
    if (!shown) return shown.error();
    found += *shown;
  }
  return "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<title>" +
         html(title) + "</title>\n<style>" + kStyle + view_style() + "</style></head><body>\n<h1>" +
         html(title) + "</h1>\n<p class=\"verdict " + class_of(page.kind) + "\"><strong>" +
         html(page.heading) + "</strong>" + html_lines(text) + "</p>\n" + found + *drawn +
         commands_of(page) + *files + "<p>Made by forcelayer " + command::kVersion +
         (*command::commit() == '\0' ? "" : std::string(", commit ") + command::commit()) +
         ".</p>\n</body></html>\n";
}

}  // namespace forcelayer::study
