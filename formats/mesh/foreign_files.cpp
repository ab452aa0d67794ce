#include "formats/mesh/foreign_files.h"

#include <cstdint>
#include <cstring>

namespace forcelayer::mesh {
namespace {

struct Foreign {
  std::string_view sign;  // first bytes, or extensions, each between dots
  const char* what;
  const char* mend;
};

using namespace std::string_view_literals;

constexpr const char* kUtf8 = "save the file as UTF-8 or ASCII";
constexpr const char* kUnpack = "unpack the file";
constexpr const char* kStep = "export the model as STEP";
constexpr const char* kMesh = "export the mesh as glTF, STL, OBJ or PLY";

constexpr Foreign kContents[] = {
    {"\xff\xfe"sv, "UTF-16 text (little-endian)", kUtf8},
    {"\xfe\xff"sv, "UTF-16 text (big-endian)", kUtf8},
    {"PK\x03\x04"sv, "a ZIP archive (as 3MF, USDZ and FreeCAD files are)", kUnpack},
    {"\x1f\x8b"sv, "compressed by gzip", kUnpack},
    {"\xd0\xcf\x11\xe0"sv, "a document of a CAD system (an OLE container)", kStep}};

constexpr Foreign kExtensions[] = {
    {".sldprt.sldasm.catpart.catproduct.cgr.ipt.iam.par.psm.prt.asm.neu.x_t.x_b.xmt_txt.sat.sab.jt."
     "3dm.dwg.dxf.fcstd.f3d.f3z.brep.brp.stpx.",
     "a format of a CAD system", kStep},
    {".ifc.skp.blend.fbx.dae.3ds.max.3mf.amf.wrl.vrml.x3d.x3dv.usd.usda.usdc.usdz.vtk.vtp.vtu.msh."
     "abc.",
     "a format of another program", kMesh},
    {".stpz.", "compressed STEP", kUnpack}};

constexpr std::size_t kLooked = 2048;  // bytes that tell a format

bool is_binary_stl(std::string_view bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t triangles = 0;
  std::memcpy(&triangles, bytes.data() + 80, sizeof triangles);
  return triangles > 0 && bytes.size() == 84 + 50 * std::uint64_t{triangles};
}

// The first line that is neither empty nor a comment.
std::string_view first_line(std::string_view text) {
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    const std::string_view line = text.substr(0, end);
    if (const std::size_t word = line.find_first_not_of(" \t");
        word != line.npos && line[word] != '#') {
      return line.substr(word);
    }
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
  }
  return {};
}

// Where the first bytes tell, the format and its extension.
struct Told {
  const char* format = nullptr;
  const char* extension = nullptr;
};

Told format_by_content(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  const std::string_view start = bytes.substr(0, kLooked), line = first_line(start);
  if (is_binary_stl(bytes)) return {"STL", ".stl"};
  if (line.starts_with("solid") && start.find("facet") != start.npos) return {"STL", ".stl"};
  if (line.starts_with("ISO-10303-21;")) return {"STEP", ".step"};
  if (line.size() >= 80 && line.substr(72, 8) == "S      1") return {"IGES", ".igs"};
  if (line.starts_with("{") && start.find("\"asset\"") != start.npos) return {"glTF", ".gltf"};
  for (const std::string_view word : {"OFF", "COFF", "NOFF", "STOFF"}) {
    if (line == word) return {"OFF", ".off"};
  }
  for (const std::string_view word : {"v ", "o ", "g ", "vn ", "vt ", "mtllib "}) {
    if (line.starts_with(word)) return {"OBJ", ".obj"};
  }
  return {};
}

}  // namespace

void refuse_wrong_extension(const SourceFile& file) {
  const Told told = format_by_content(file.bytes);
  const std::string own = lower_case_extension(file.path);
  if (told.format == nullptr || own == told.extension) return;
  if (own == ".stp" || own == ".iges" || own == ".glb") {
    if (told.extension[1] == own[1]) return;  // another spelling of the same
  }
  fail_read(file, ErrorCode::kMeshUnsupported, "",
            std::string("contains ") + told.format + " data, but its name ends in " + own,
            std::string("rename it to ") + told.extension);
}

void refuse_foreign_content(const SourceFile& file) {
  for (const auto& [sign, what, mend] : kContents) {
    if (file.bytes.starts_with(sign)) {
      fail_read(file, ErrorCode::kMeshUnsupported, "", std::string("is ") + what, mend);
    }
  }
}

void refuse_extension(const SourceFile& file) {
  const std::string extension = lower_case_extension(file.path);
  for (const auto& [extensions, what, mend] : kExtensions) {
    if (extension.size() < 2 || extensions.find(extension + ".") == std::string_view::npos)
      continue;
    fail_read(file, ErrorCode::kMeshUnsupported, "",
              in_quotes(extension) + " files (" + what + ") are not supported", mend);
  }
  refuse_foreign_content(file);
  const char* const mend = "use stl, obj, ply, off, om, drc, glb, gltf, step or iges";
  const Told told = format_by_content(file.bytes);
  const std::string content =
      told.format == nullptr ? "" : std::string("; the file contains ") + told.format + " data";
  fail_read(file, ErrorCode::kMeshUnsupported, "",
            (extension.size() < 2
                 ? "has no extension that shows its mesh format"
                 : in_quotes(extension) + " is not the extension of a supported mesh format") +
                content,
            told.format == nullptr ? mend : std::string("rename it to ") + told.extension);
}

}  // namespace forcelayer::mesh
