// STEP and IGES through OpenCASCADE: the assembly tree with names and placings, every face
// tessellated to a given deflection. OpenCASCADE turns all units into millimeters.
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRep_Tool.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <Interface_InterfaceModel.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Poly_Triangulation.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPControl_Reader.hxx>
#include <Standard_Failure.hxx>
#include <StepShape_FaceSurface.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDF_Tool.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Face.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>
#include <algorithm>
#include <map>
#include <mutex>
#include <sstream>

#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

constexpr double kMetersPerMillimeter = 1e-3;
constexpr double kAngularDeflectionRad = 0.35;  // 20 degrees: what small rounds need to stay round

[[noreturn]] void fail(const SourceFile& file, ErrorCode code, std::string what) {
  fail_read(file, code, "", std::move(what), "export the file again");
}

// Every face of a STEP file must have become a shape.
void check_faces(const SourceFile& file, const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  const Handle(Transfer_TransientProcess) process = session->TransferReader()->TransientProcess();
  std::uint64_t faces = 0, lost = 0;
  for (Standard_Integer i = 1; i <= model->NbEntities(); ++i) {
    const Handle(Standard_Transient) entity = model->Value(i);
    if (!entity->IsKind(STANDARD_TYPE(StepShape_FaceSurface))) continue;
    ++faces;
    if (TransferBRep::ShapeResult(process, entity).IsNull()) ++lost;
  }
  if (lost == 0) return;
  fail(file, ErrorCode::kMeshIncomplete,
       "OpenCASCADE could not read " + std::to_string(lost) + " of " + counted(faces, "face"));
}

template <typename Reader>
void transfer(const SourceFile& file, Reader& reader, Handle(TDocStd_Document) & document) {
  reader.SetNameMode(true);
  reader.SetColorMode(false);
  reader.SetLayerMode(false);
  if (reader.ReadFile(file.path.c_str()) != IFSelect_RetDone) {
    fail(file, ErrorCode::kMeshUnreadable, "OpenCASCADE cannot parse this file");
  }
  if (!reader.Transfer(document)) {
    fail(file, ErrorCode::kMeshUnreadable, "OpenCASCADE cannot read the shapes of this file");
  }
}

Handle(TDocStd_Document) read_document(const SourceFile& file) {
  Handle(TDocStd_Document) document = new TDocStd_Document("BinXCAF");
  if (lower_case_extension(file.path).starts_with(".ig")) {
    IGESCAFControl_Reader reader;
    transfer(file, reader, document);
  } else {
    STEPCAFControl_Reader reader;
    transfer(file, reader, document);
    check_faces(file, reader.Reader().WS());
  }
  return document;
}

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

// The triangles of a shape in its own frame, millimeters.
class Tessellator {
 public:
  Tessellator(const SourceFile& file, double deflection_mm)
      : file_(file), deflection_mm_(deflection_mm) {}

  Mesh tessellate(const TopoDS_Shape& shape, const std::string& name) {
    BRepMesh_IncrementalMesh(shape, deflection_mm_, false, kAngularDeflectionRad, false);
    Mesh mesh;
    mesh.single_precision = false;
    std::uint64_t faces = 0, lost = 0;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      ++faces;
      if (!add(TopoDS::Face(face.Current()), mesh)) ++lost;
    }
    if (lost > 0) {
      fail_read(file_, ErrorCode::kMeshIncomplete, name,
                "OpenCASCADE could not tessellate " + std::to_string(lost) + " of " +
                    counted(faces, "face"),
                "mend these faces where the part was drawn");
    }
    check_finite(file_, mesh, name);
    return mesh;
  }

  double largest_deflection_mm() const { return largest_deflection_mm_; }

 private:
  bool add(const TopoDS_Face& face, Mesh& mesh) {
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangulation = BRep_Tool::Triangulation(face, location);
    if (triangulation.IsNull() || triangulation->NbTriangles() == 0) return false;
    largest_deflection_mm_ = std::max(largest_deflection_mm_, triangulation->Deflection());
    check_count(file_, mesh.vertices.size() + static_cast<std::uint64_t>(triangulation->NbNodes()),
                "vertices");
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (Standard_Integer i = 1; i <= triangulation->NbNodes(); ++i) {
      const gp_Pnt node = triangulation->Node(i).Transformed(location.Transformation());
      mesh.vertices.push_back({node.X(), node.Y(), node.Z()});
    }
    for (Standard_Integer i = 1; i <= triangulation->NbTriangles(); ++i) {
      Standard_Integer a = 0, b = 0, c = 0;
      triangulation->Triangle(i).Get(a, b, c);
      if (face.Orientation() == TopAbs_REVERSED) std::swap(b, c);
      const auto corner = [&](Standard_Integer n) {
        return first + static_cast<std::uint32_t>(n - 1);
      };
      mesh.triangles.push_back({corner(a), corner(b), corner(c)});
    }
    return true;
  }

  const SourceFile& file_;
  double deflection_mm_;
  double largest_deflection_mm_ = 0;
};

class StepReader {
 public:
  explicit StepReader(const SourceFile& file)
      : file_(file), tessellator_(file, file.options.deflection_m / kMetersPerMillimeter) {}

  Assembly read() {
    const Handle(TDocStd_Document) document = read_document(file_);
    TDF_LabelSequence roots;
    XCAFDoc_DocumentTool::ShapeTool(document->Main())->GetFreeShapes(roots);
    add_level(roots, nullptr, Affine{});
    const auto [first, last] = find_sub_tree(file_, names_);
    for (std::size_t i = first; i < last; ++i) place(i);
    if (assembly_.instances.empty()) {
      fail(file_, ErrorCode::kMeshEmpty, "no faces in this file");
    }
    assembly_.meters_per_unit = kMetersPerMillimeter;
    assembly_.deviation_units = std::max(file_.options.deflection_m / kMetersPerMillimeter,
                                         tessellator_.largest_deflection_mm());
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
    if (node.depth > kDeepestNode) fail(file_, ErrorCode::kMeshUnsupported, "nested too deep");
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
    if (is_new) {
      Mesh mesh =
          tessellator_.tessellate(XCAFDoc_ShapeTool::GetShape(products_[node]), names_[node].path);
      if (!mesh.triangles.empty()) {
        assembly_.meshes.push_back(std::move(mesh));
        known->second = static_cast<std::uint32_t>(assembly_.meshes.size() - 1);
      }
    }
    if (known->second == kNoTriangles) return add_warning(names_[node].path);
    assembly_.instances.push_back({known->second, names_[node].path, placings_[node]});
  }

  void add_warning(const std::string& path) {
    assembly_.warnings.push_back(path + " left out: it has no faces, only curves or points");
  }

  static constexpr std::uint32_t kNoTriangles = 0xffffffff;

  const SourceFile& file_;
  Tessellator tessellator_;
  std::vector<NodeName> names_;  // of all nodes, each before its children
  std::vector<TDF_Label> products_;
  std::vector<Affine> placings_;
  std::map<std::string, std::uint32_t> meshes_;  // by product
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
    fail(file, ErrorCode::kMeshUnreadable,
         std::string("OpenCASCADE: ") + failure.GetMessageString());
  }
}

}  // namespace forcelayer::mesh
