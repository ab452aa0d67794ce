// STEP and IGES through OpenCASCADE: the assembly tree with names and placings, every face
// tessellated to a given deflection. OpenCASCADE turns all units into millimeters.
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <map>
#include <mutex>
#include <sstream>

#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/readers/step_document.h"
#include "formats/mesh/step/face_report.h"
#include "formats/mesh/step/tessellator.h"

namespace forcelayer::mesh {
namespace {

constexpr double kMetersPerMillimeter = 1e-3;

Affine affine_of(const TopLoc_Location& location) {
  const gp_Trsf& transform = location.Transformation();
  Affine affine;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      affine.linear[static_cast<std::size_t>(3 * row + column)] =
          transform.Value(row + 1, column + 1);
    }
    affine.translation[static_cast<std::size_t>(row)] = transform.Value(row + 1, 4);
  }
  return affine;
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) attribute;
  if (!label.FindAttribute(TDataStd_Name::GetID(), attribute)) return "";
  const TCollection_ExtendedString& text = attribute->Get();
  std::string name(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter place = name.data();
  text.ToUTF8CString(place);
  return name.c_str();
}

class StepReader {
 public:
  explicit StepReader(const SourceFile& file)
      : file_(file), tessellator_(file, file.options.deflection_m / kMetersPerMillimeter) {}

  Assembly read() {
    const Handle(TDocStd_Document) document = read_step_document(file_);
    TDF_LabelSequence roots;
    XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
    add_level(roots, nullptr, Affine{});
    const auto [first, last] = find_sub_tree(file_, names_);
    LeftOutNodes left_out = find_left_out(file_, names_);
    for (std::size_t i = first; i < last; ++i) {
      if (!left_out.is_out[i]) place(i);
    }
    check_missing_faces(file_, left_out.unknown, assembly_);
    if (assembly_.instances.empty()) {
      fail_read(file_, ErrorCode::kMeshEmpty, "",
                left_out.names.empty() ? "no faces in this file" : "no faces are left in this file",
                "export the file again");
    }
    assembly_.left_out = std::move(left_out.names);
    assembly_.meters_per_unit = kMetersPerMillimeter;
    assembly_.deviation_units = tessellator_.deviation_mm();
    return std::move(assembly_);
  }

 private:
  void add_level(const TDF_LabelSequence& labels, const NodeName* parent,
                 const Affine& assembly_from_parent) {
    std::set<std::string> used;
    for (TDF_LabelSequence::Iterator label(labels); label.More(); label.Next()) {
      add_node(label.Value(), parent, used, assembly_from_parent);
    }
  }

  // An instance bears its own name, else its product's.
  void add_node(const TDF_Label& label, const NodeName* parent, std::set<std::string>& used,
                const Affine& assembly_from_parent) {
    TDF_Label product = label;
    const bool refers = XCAFDoc_ShapeTool::GetReferredShape(label, product);
    std::string name = name_of(label);
    if (name.empty()) name = name_of(product);
    if (name.empty()) name = "node" + std::to_string(names_.size());
    const NodeName node = name_node(name, parent, used);
    if (node.depth > kDeepestNode)
      fail_read(file_, ErrorCode::kMeshUnsupported, "", "nested too deep", "export the file again");
    names_.push_back(node);
    products_.push_back(product);
    // A referring label carries the placing; a product that stands alone has it in its shape.
    placings_.push_back(
        refers ? compose(assembly_from_parent, affine_of(XCAFDoc_ShapeTool::GetLocation(label)))
               : assembly_from_parent);
    TDF_LabelSequence components;
    if (!XCAFDoc_ShapeTool::GetComponents(product, components)) return;
    const Affine placing = placings_.back();
    add_level(components, &node, placing);
  }

  void place(std::size_t node) {
    if (XCAFDoc_ShapeTool::IsAssembly(products_[node])) return;
    TCollection_AsciiString entry;
    TDF_Tool::Entry(products_[node], entry);
    const auto [known, is_new] = meshes_.try_emplace(entry.ToCString(), kNoTriangles);
    std::vector<LostFace>& lost = lost_faces_[known->first];
    if (is_new) {
      Tessellation made =
          tessellator_.tessellate(XCAFDoc_ShapeTool::GetShape(products_[node]), names_[node].path);
      add_face_warnings(made, names_[node].path, assembly_.warnings);
      lost = std::move(made.lost);
      if (!made.mesh.triangles.empty()) {
        assembly_.meshes.push_back(std::move(made.mesh));
        known->second = static_cast<std::uint32_t>(assembly_.meshes.size() - 1);
      }
    }
    for (const LostFace& face : lost) {
      assembly_.missing_faces.push_back(
          {names_[node].path, mesh::apply(placings_[node], face.center_mm), face.size_mm});
    }
    if (known->second == kNoTriangles && !lost.empty()) return;
    if (known->second == kNoTriangles) return add_warning(names_[node].path);
    assembly_.instances.push_back({known->second, names_[node].path, placings_[node]});
  }

  void add_warning(const std::string& path) {
    assembly_.warnings.push_back(path + " left out: it has no faces, only curves or points");
  }

  static constexpr std::uint32_t kNoTriangles = 0xffffffff;

  const SourceFile& file_;
  StepTessellator tessellator_;
  std::vector<NodeName> names_;  // of all nodes, each before its children
  std::vector<TDF_Label> products_;
  std::vector<Affine> placings_;
  std::map<std::string, std::uint32_t> meshes_;              // by product
  std::map<std::string, std::vector<LostFace>> lost_faces_;  // by product
  Assembly assembly_;
};

}  // namespace

Assembly read_step(const SourceFile& file) {
  static std::mutex mutex;  // OpenCASCADE keeps its reading parameters in globals
  const std::lock_guard lock(mutex);
  Message::DefaultMessenger()->ChangePrinters().Clear();  // it reports on standard output
  try {
    return StepReader(file).read();
  } catch (const Standard_Failure& failure) {
    fail_read(file, ErrorCode::kMeshUnreadable, "",
              std::string("OpenCASCADE: ") + failure.GetMessageString(), "export the file again");
  }
}

}  // namespace forcelayer::mesh
