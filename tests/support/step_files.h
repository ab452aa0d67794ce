// STEP and IGES files that OpenCASCADE writes, and damage to them as text.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/mesh_files.h"
#include "tests/support/places.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {

inline std::string read_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Runs a program of the build in `folder`; throws where it fails.
inline void run_in(const std::filesystem::path& folder, const std::string& command) {
  const std::string line = "cd " + folder.string() + " && " + test::command_path(command);
  if (std::system(line.c_str()) != 0) throw std::runtime_error(line);
}

// The box of make_box_file as STEP: product #7, its shape #10, which lists the solid #15.
inline std::string step_box() {
  const ScratchFolder folder;
  run_in(folder.path(), "make_box_file box.step");
  return read_text(folder / "box.step");
}

// The same box as IGES: six trimmed surfaces (144), or a solid (186) of six faces (510).
inline std::string iges_box(bool solid) {
  const ScratchFolder folder;
  run_in(folder.path(), solid ? "make_box_file box.igs solid" : "make_box_file box.igs");
  return read_text(folder / "box.igs");
}

// `text` with `entities` at the end of its data.
inline std::string with_entities(std::string text, const std::string& entities) {
  return text.insert(text.rfind("ENDSEC;"), entities);
}

// `text` with the one place that `pattern` fits replaced; throws where it fits none.
inline std::string replaced(const std::string& text, const std::string& pattern,
                            const std::string& by) {
  const std::regex search(pattern);
  if (!std::regex_search(text, search)) throw std::runtime_error("no " + pattern);
  return std::regex_replace(text, search, by, std::regex_constants::format_first_only);
}

// An IGES text in which the parameters of directory entry `entry` are `parameters`, one line.
inline std::string with_parameters(const std::string& text, int entry,
                                   const std::string& parameters) {
  std::istringstream lines(text);
  std::string result, line;
  bool found = false;
  while (std::getline(lines, line)) {
    if (line.size() >= 80 && line[72] == 'P' && std::stoi(line.substr(64, 8)) == entry) {
      std::string field = parameters;
      field.resize(64, ' ');
      line.replace(0, 64, field);
      found = true;
    }
    result += line + "\n";
  }
  if (!found) throw std::runtime_error("no parameters of D" + std::to_string(entry));
  return result;
}

// The same with another type of entity in directory entry `entry`.
inline std::string with_type(const std::string& text, int entry, const std::string& type) {
  std::istringstream lines(text);
  std::string result, line;
  while (std::getline(lines, line)) {
    if (line.size() >= 80 && line[72] == 'D') {
      const int number = std::stoi(line.substr(73, 7));
      if (number == entry || number == entry + 1) {
        line.replace(0, 8, std::string(8 - type.size(), ' ') + type);
      }
    }
    result += line + "\n";
  }
  return result;
}

// Entries that are added to an IGES text, each with parameters on one line.
class IgesText {
 public:
  explicit IgesText(const std::string& text) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      line.resize(80, ' ');
      sections_[line[72]].push_back(line.substr(0, 72));
    }
  }

  // Its directory entry. `status` has four numbers of two digits; `matrix` is an entry or 0.
  int add(int type, const std::string& parameters, int matrix = 0, int form = 0,
          const std::string& status = "00000000") {
    const auto entry = static_cast<int>(sections_['D'].size()) + 1;
    const auto first = static_cast<int>(sections_['P'].size()) + 1;
    char line[100];
    std::snprintf(line, sizeof line, "%8d%8d%8d%8d%8d%8d%8d%8d%8s", type, first, 0, 0, 0, 0, matrix,
                  0, status.c_str());
    sections_['D'].push_back(line);
    std::snprintf(line, sizeof line, "%8d%8d%8d%8d%8d%32d", type, 0, 0, 1, form, 0);
    sections_['D'].push_back(line);
    std::snprintf(line, sizeof line, "%-64s%8d", (std::to_string(type) + "," + parameters).c_str(),
                  entry);
    sections_['P'].push_back(line);
    return entry;
  }

  // Names the matrix in an entry of the file.
  void set_matrix(int entry, int matrix) {
    char field[16];
    std::snprintf(field, sizeof field, "%8d", matrix);
    sections_['D'][static_cast<std::size_t>(entry - 1)].replace(48, 8, field);
  }

  // Four numbers of two digits, as of add().
  void set_status(int entry, const std::string& status) {
    sections_['D'][static_cast<std::size_t>(entry - 1)].replace(64, 8, status);
  }

  std::string text() const {
    std::string text;
    for (const char section : {'S', 'G', 'D', 'P'}) {
      int number = 0;
      for (const std::string& line : sections_.at(section)) {
        char end[16];
        std::snprintf(end, sizeof end, "%c%7d\n", section, ++number);
        text += line + end;
      }
    }
    char end[100];
    const auto size = [&](char section) { return static_cast<int>(sections_.at(section).size()); };
    std::snprintf(end, sizeof end, "S%7dG%7dD%7dP%7d%40sT%7d\n", size('S'), size('G'), size('D'),
                  size('P'), "", 1);
    return text + end;
  }

 private:
  std::map<char, std::vector<std::string>> sections_;
};

// Faces that a STEP text holds, without OpenCASCADE: entities of the two types of face.
inline std::size_t count_step_faces(const std::string& text) {
  const std::regex face(R"(#\d+\s*=\s*(ADVANCED_FACE|FACE_SURFACE)\s*\()");
  return static_cast<std::size_t>(
      std::distance(std::sregex_iterator(text.begin(), text.end(), face), {}));
}

// Faces that an IGES text holds: directory entries of types 143, 144 and 510, two lines each.
inline std::size_t count_iges_faces(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  std::size_t faces = 0;
  while (std::getline(lines, line)) {
    if (line.size() < 80 || line[72] != 'D' || std::stoi(line.substr(73, 7)) % 2 == 0) continue;
    const int type = std::stoi(line.substr(0, 8));
    if (type == 143 || type == 144 || type == 510) ++faces;
  }
  return faces;
}

// Faces that an assembly was tessellated from, each mesh once: triangles of one face share
// vertices, those of two faces do not.
inline std::size_t count_patches(const mesh::Assembly& assembly) {
  std::size_t patches = 0;
  for (const mesh::Mesh& mesh : assembly.meshes) {
    std::vector<std::uint32_t> parent(mesh.vertices.size());
    for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
    const auto root = [&](std::uint32_t i) {
      while (parent[i] != i) i = parent[i] = parent[parent[i]];
      return i;
    };
    for (const auto& [a, b, c] : mesh.triangles) {
      parent[root(b)] = root(a);
      parent[root(c)] = root(a);
    }
    std::set<std::uint32_t> roots;
    for (const mesh::Triangle& triangle : mesh.triangles) roots.insert(root(triangle[0]));
    patches += roots.size();
  }
  return patches;
}

}  // namespace forcelayer::test
