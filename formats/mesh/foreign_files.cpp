#include "formats/mesh/foreign_files.h"

namespace forcelayer::mesh {
namespace {

struct Foreign {
  std::string_view sign;  // first bytes, or extensions, each between dots
  const char* what;
  const char* mend;
};

using namespace std::string_view_literals;

constexpr const char* kUtf8 = "save it as UTF-8 or ASCII";
constexpr const char* kUnpack = "unpack it";
constexpr const char* kStep = "export it as STEP";
constexpr const char* kMesh = "export it as glTF, STL, OBJ or PLY";

constexpr Foreign kContents[] = {
    {"\xff\xfe"sv, "UTF-16 text (little-endian)", kUtf8},
    {"\xfe\xff"sv, "UTF-16 text (big-endian)", kUtf8},
    {"PK\x03\x04"sv, "a ZIP archive (3MF, USDZ and FreeCAD files are such)", kUnpack},
    {"\x1f\x8b"sv, "compressed by gzip", kUnpack},
    {"Kaydara FBX"sv, "an FBX file", kMesh},
    {"BLENDER"sv, "a Blender file", kMesh},
    {"DBRep_DrawableShape"sv, "OpenCASCADE's own format (BREP)", kStep},
    {"CASCADE Topology"sv, "OpenCASCADE's own format (BREP)", kStep},
    {"3D Geometry File Format"sv, "a Rhino file", kStep},
    {"#VRML"sv, "VRML", kMesh},
    {"\xd0\xcf\x11\xe0"sv, "a document of a CAD system (an OLE container)", kStep},
    {"<?xml"sv, "an XML file", kMesh},
    {"%PDF"sv, "a PDF file", kStep}};

constexpr Foreign kExtensions[] = {{".sldprt.sldasm.", "SolidWorks", kStep},
                                   {".catpart.catproduct.cgr.", "CATIA", kStep},
                                   {".ipt.iam.", "Inventor", kStep},
                                   {".par.psm.", "Solid Edge", kStep},
                                   {".prt.asm.neu.", "Creo, NX or Solid Edge", kStep},
                                   {".x_t.x_b.xmt_txt.", "Parasolid", kStep},
                                   {".sat.sab.", "ACIS", kStep},
                                   {".jt.", "JT", kStep},
                                   {".3dm.", "Rhino", kStep},
                                   {".dwg.dxf.", "AutoCAD", kStep},
                                   {".fcstd.", "FreeCAD", kStep},
                                   {".f3d.f3z.", "Fusion", kStep},
                                   {".brep.brp.", "OpenCASCADE", kStep},
                                   {".ifc.", "IFC", kMesh},
                                   {".skp.", "SketchUp", kMesh},
                                   {".blend.", "Blender", kMesh},
                                   {".fbx.", "FBX", kMesh},
                                   {".dae.", "COLLADA", kMesh},
                                   {".3ds.max.", "3ds Max", kMesh},
                                   {".3mf.", "3MF", kMesh},
                                   {".amf.", "AMF", kMesh},
                                   {".wrl.vrml.x3d.x3dv.", "VRML or X3D", kMesh},
                                   {".usd.usda.usdc.usdz.", "USD", kMesh},
                                   {".vtk.vtp.vtu.", "VTK", kMesh},
                                   {".msh.", "Gmsh or Fluent", kMesh},
                                   {".abc.", "Alembic", kMesh},
                                   {".stpz.", "STEP, compressed", kUnpack},
                                   {".stpx.", "STEP as XML", kStep}};

}  // namespace

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
    fail_read(
        file, ErrorCode::kMeshUnsupported, "",
        in_quotes(extension) + " is the extension of a format that is not read here (" + what + ")",
        mend);
  }
  refuse_foreign_content(file);
  fail_read(file, ErrorCode::kMeshUnsupported, "",
            in_quotes(extension) + " is not the extension of a mesh format that is read here",
            "use stl, obj, ply, off, om, drc, glb, gltf, step or iges");
}

}  // namespace forcelayer::mesh
