// STEP and IGES through OpenCASCADE: the assembly tree with names and placings, over all files that
// it is spread over, every face tessellated to a given deflection. OpenCASCADE turns all units into
// millimeters.
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Standard_Failure.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>

#include "formats/mesh/checks/grouped_warnings.h"
#include "formats/mesh/node_names.h"
#include "formats/mesh/reader.h"
#include "formats/mesh/step/document.h"
#include "formats/mesh/step/entities/faces.h"
#include "formats/mesh/step/entities/names.h"
#include "formats/mesh/step/face_report.h"
#include "formats/mesh/step/references.h"
#include "formats/mesh/step/sewing.h"
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

bool all_of(std::string_view text, std::string_view letters) {
  return !text.empty() && text.find_first_not_of(letters) == std::string_view::npos;
}

// Whether no designer typed the name of an instance: SolidWorks numbers them "NAUO1", and
// OpenCASCADE calls one without a name, such as Creo's, by the place of its product, "=>[0:1:1:3]".
bool is_made_up(std::string_view name) {
  if (name.starts_with("NAUO")) return all_of(name.substr(4), "0123456789");
  return name.starts_with("=>[") && name.ends_with("]") &&
         all_of(name.substr(3, name.size() - 4), "0123456789:");
}

// A file of the assembly: the one that the user named, or one that another refers to.
struct OpenFile {
  SourceFile source;
  StepDocument content;
};

struct Product {
  const OpenFile* file = nullptr;
  TDF_Label label;  // null where it only holds the roots of a file
};

TDF_LabelSequence roots_of(const OpenFile& file) {
  TDF_LabelSequence roots;
  XCAFDoc_DocumentTool::ShapeTool(file.content.document->Main())->GetFreeShapes(roots);
  return roots;
}

bool is_step_name(const std::string& name) {
  const std::string extension = lower_case_extension(name);
  return extension == ".stp" || extension == ".step" || extension == ".igs" || extension == ".iges";
}

constexpr std::uint32_t kNoTriangles = 0xffffffff;

// A product once it is tessellated.
struct TessellatedProduct {
  std::uint32_t mesh = kNoTriangles;  // index into Assembly::meshes
  double deviation_mm = 0;            // of its triangles
  std::vector<LostFace> lost;
};

class StepReader {
 public:
  explicit StepReader(const SourceFile& file)
      : file_(file), tessellator_(file, file.options.deflection_m / kMetersPerMillimeter) {}

  Assembly read() {
    const OpenFile& top = open(file_, "");
    chain_.push_back(&top);
    add_level(top, roots_of(top), nullptr, Affine{});
    NodesToRead to_read = choose_readable();
    join_nodes(to_read);
    collect_losses(to_read);
    forecast(to_read);
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (to_read.is_read[i]) place(i);
    }
    check_missing_faces(flawed_ != nullptr ? flawed_->source : file_, losses_, to_read.unknown,
                        missing_, assembly_.instances.size(), assembly_);
    if (assembly_.instances.empty()) {
      fail_read(file_, ErrorCode::kMeshEmpty, "",
                !missing_.empty()          ? "no face of this file can be read"
                : to_read.left_out.empty() ? "no faces in this file"
                                           : "--without leaves out all faces of this file",
                to_read.left_out.empty() || !missing_.empty()
                    ? "export the file again"
                    : "keep at least one node of this file, or leave out the whole file; nothing "
                      "can block the last part of an assembly");
    }
    for (std::string& line : node_warnings_.lines()) {
      assembly_.warnings.push_back(std::move(line));
    }
    set_instances(nodes_of_instances_, names_);
    assembly_.nodes = std::move(names_);
    assembly_.left_out = std::move(to_read.left_out);
    assembly_.meters_per_unit = kMetersPerMillimeter;
    return std::move(assembly_);
  }

 private:
  // A file that cannot be read is an error unless the nodes that need it are left out. Nobody knows
  // which names its nodes have: a name that fits nothing may be one of them.
  NodesToRead choose_readable() const {
    NodesToRead to_read;
    try {
      to_read = nodes_to_read(file_, names_);
    } catch (const ReadFailure&) {
      if (!unread_.empty()) throw ReadFailure(unread_.front().second);
      throw;
    }
    for (const auto& [node, failure] : unread_) {
      if (!to_read.is_left_out[node]) throw ReadFailure(failure);
    }
    return to_read;
  }

  void forecast(const NodesToRead& to_read) {
    if (!file_.options.progress) return;
    std::set<std::pair<const OpenFile*, std::string>> known;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (!to_read.is_read[i] || !is_tessellated(i)) continue;
      if (!known.insert({products_[i].file, entry_of(products_[i].label)}).second) continue;
      expected_[i] = tessellator_.forecast(shape_of(i));
      all_expected_ += expected_[i];
    }
    file_.options.progress({0, all_expected_});
  }

  // A node that has a shape and is not read as one with another.
  bool is_tessellated(std::size_t node) const {
    const TDF_Label& label = products_[node].label;
    return !label.IsNull() && !XCAFDoc_ShapeTool::IsAssembly(label) && !is_joined_.contains(node);
  }

  void tell_progress(std::size_t node) {
    if (!file_.options.progress || !(all_expected_ > 0)) return;
    done_ += expected_[node];
    file_.options.progress({std::min(1.0, done_ / all_expected_), all_expected_});
  }

  // The leaves of IGES files that are read and end at open edges, by file and parent.
  std::map<std::string, std::vector<std::size_t>> open_nodes(const NodesToRead& to_read) const {
    std::map<std::string, std::vector<std::size_t>> leaves, open;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto& [file, label] = products_[i];
      if (!to_read.is_read[i] || !file->content.is_iges || label.IsNull()) continue;
      const std::string& path = names_[i].path;
      const std::string parent = path.substr(0, path.size() - names_[i].label.size());
      leaves[parent + '\n' + file->source.path].push_back(i);
    }
    for (const auto& [parent, nodes] : leaves) {
      if (nodes.size() < 2) continue;
      for (const std::size_t i : nodes) {
        const TopoDS_Shape shape = shape_of(i);
        if (count_open_edges(shape, tessellator_.deflection_mm(shape)) > 0)
          open[parent].push_back(i);
      }
    }
    return open;
  }

  // The faces of one body may be in many nodes of an IGES file, or the group that held them is
  // damaged: nodes whose faces meet at open edges are read as the first of them.
  void join_nodes(const NodesToRead& to_read) {
    for (const auto& [parent, nodes] : open_nodes(to_read)) {
      std::vector<TopoDS_Shape> shapes;
      for (const std::size_t i : nodes) shapes.push_back(shape_of(i));
      const double deflection_mm = tessellator_.deflection_mm(loose_faces_of(shapes));
      const std::vector<std::size_t> first = first_met(shapes, deflection_mm);
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        if (first[n] == n) continue;
        std::vector<std::size_t>& joined = joined_[nodes[first[n]]];
        joined.push_back(nodes[n]);
        is_joined_.insert(nodes[n]);
      }
    }
    for (const auto& [first, others] : joined_) {
      assembly_.warnings.push_back(
          names_[first].path + ": this node and " + counted(others.size(), "other node") + " (" +
          names_[others.front()].path + (others.size() > 1 ? ", ..." : "") +
          ") are read as one body, because their faces meet at open edges. In the file, their "
          "group may be damaged or missing");
    }
  }

  TopoDS_Shape shape_of(std::size_t node) const {
    const auto others = joined_.find(node);
    const TopoDS_Shape own = XCAFDoc_ShapeTool::GetShape(products_[node].label);
    if (others == joined_.end()) return own;
    std::vector<TopoDS_Shape> all{own};
    for (const std::size_t i : others->second) {
      all.push_back(XCAFDoc_ShapeTool::GetShape(products_[i].label));
    }
    return loose_faces_of(all);
  }

  // Where a face of joined nodes is: the node that it came from.
  std::size_t node_of(const LostFace& face, std::size_t node) const {
    const auto others = joined_.find(node);
    if (others == joined_.end()) return node;
    std::size_t nearest = node;
    double smallest = std::numeric_limits<double>::infinity();
    const auto look_at = [&](std::size_t i) {
      const LostFace own = box_of_edges(XCAFDoc_ShapeTool::GetShape(products_[i].label));
      double distance = std::abs(own.size_mm - face.size_mm);
      for (std::size_t k = 0; k < 3; ++k) {
        distance += std::abs(own.center_mm[k] - face.center_mm[k]);
      }
      if (distance < smallest) smallest = distance, nearest = i;
    };
    look_at(node);
    for (const std::size_t i : others->second) look_at(i);
    return nearest;
  }

  // The losses of nodes that are read.
  void collect_losses(const NodesToRead& to_read) {
    for (const auto& [path, file] : files_) {
      if (!file) continue;
      const std::size_t before = missing_.size();
      for (const LostPiece& piece : file->content.losses.pieces) add_loss(*file, piece, to_read);
      if (missing_.size() == before) continue;
      if (flawed_ == nullptr) flawed_ = file.get();
      losses_.text += (losses_.text.empty() ? "" : "; ") + file->content.losses.text;
      losses_.mend = file->content.losses.mend;
    }
  }

  // A piece belongs to the nodes of its products; where these are unknown, to the one node of its
  // file that has a shape.
  void add_loss(const OpenFile& file, const LostPiece& piece, const NodesToRead& to_read) {
    std::vector<std::size_t> owners, leaves;
    bool is_any_read = false;
    for (std::size_t i = 0; i < products_.size(); ++i) {
      const auto& [of, label] = products_[i];
      if (of != &file) continue;
      is_any_read = is_any_read || to_read.is_read[i];
      if (label.IsNull()) continue;
      const bool is_leaf = !XCAFDoc_ShapeTool::IsAssembly(label) && !is_joined_.contains(i);
      if (is_leaf && count_faces(XCAFDoc_ShapeTool::GetShape(label)) > 0) leaves.push_back(i);
      const auto& known = piece.owners;
      if (std::find(known.begin(), known.end(), entry_of(label)) != known.end()) {
        owners.push_back(i);
      }
    }
    if (owners.empty() && leaves.size() == 1) owners = leaves;
    for (const std::size_t i : owners) {
      if (!to_read.is_read[i]) continue;
      const LostFace place = box_of_edges(XCAFDoc_ShapeTool::GetShape(products_[i].label));
      add_missing(i, {place.center_mm, place.size_mm, false}, piece.name);
      is_flawed_.insert(i);
    }
    if (owners.empty() && is_any_read) missing_.emplace_back().name = piece.name;
  }

  void add_level(const OpenFile& file, const TDF_LabelSequence& labels, const AssemblyNode* parent,
                 const Affine& assembly_from_parent) {
    UsedLabels used;
    for (TDF_LabelSequence::Iterator label(labels); label.More(); label.Next()) {
      add_node({&file, label.Value()}, parent, used, assembly_from_parent);
    }
  }

  // An instance bears the name that its designer gave it, else its product's.
  void add_node(Product product, const AssemblyNode* parent, UsedLabels& used,
                const Affine& assembly_from_parent) {
    const TDF_Label label = product.label;
    const bool refers = XCAFDoc_ShapeTool::GetReferredShape(label, product.label);
    std::string name = name_of(label);
    if (name.empty() || is_made_up(name)) name = name_of(product.label);
    if (product.file->content.is_iges) name = without_bytes_as_letters(name);
    if (name.empty()) name = "node" + std::to_string(names_.size());
    const AssemblyNode node = name_node(name, parent, used);
    if (const std::string wrong = limit_.add(node); !wrong.empty()) {
      fail_read(file_, ErrorCode::kMeshUnsupported, node.path.substr(0, 200), wrong,
                "export the file again");
    }
    // A referring label carries the placing; a product that stands alone has it in its shape.
    Affine placing =
        refers ? compose(assembly_from_parent, affine_of(XCAFDoc_ShapeTool::GetLocation(label)))
               : assembly_from_parent;
    const std::size_t files = chain_.size();
    TDF_LabelSequence components;
    try {
      components = follow_references(product, placing, node.path);
    } catch (const ReadFailure& failure) {
      if (file_.options.without.empty()) throw;
      unread_.emplace_back(names_.size(), failure);
    }
    names_.push_back(node);
    products_.push_back(product);
    placings_.push_back(placing);
    add_level(*product.file, components, &node, placing);
    chain_.resize(files);
  }

  // The components of a product. Where its shape is in another file, that file's root takes its
  // place; where there are several roots, they are its components.
  TDF_LabelSequence follow_references(Product& product, Affine& placing, const std::string& node) {
    for (;;) {
      TDF_LabelSequence components;
      const bool has_shape = XCAFDoc_ShapeTool::GetComponents(product.label, components) ||
                             count_faces(XCAFDoc_ShapeTool::GetShape(product.label)) > 0;
      const auto& references = product.file->content.references;
      const auto found = references.find(entry_of(product.label));
      if (found == references.end()) return components;
      if (has_shape) {
        if (warned_of_.insert(product.file->source.path + "#" + found->first).second)
          warn_of_unread(found->second, node);
        return components;
      }
      const OpenFile& other = open_reference(*product.file, found->second, node);
      const TDF_LabelSequence roots = roots_of(other);
      product = {&other, {}};
      if (roots.Length() != 1) return roots;
      product.label = roots.First();
      if (XCAFDoc_ShapeTool::GetReferredShape(roots.First(), product.label)) {
        placing = compose(placing, affine_of(XCAFDoc_ShapeTool::GetLocation(roots.First())));
      }
    }
  }

  const OpenFile& open_reference(const OpenFile& from,
                                 const std::vector<std::vector<std::string>>& references,
                                 const std::string& node) {
    const auto chosen = std::find_if(references.begin(), references.end(), [](const auto& names) {
      return std::any_of(names.begin(), names.end(), is_step_name);
    });
    if (chosen == references.end()) {
      fail_read(from.source, ErrorCode::kMeshUnsupported, node,
                "the shape of this node is in the file " + in_quotes(references.front().front()) +
                    ", which is neither STEP nor IGES",
                "export the assembly into one STEP file");
    }
    const auto [path, is_elsewhere] = find_reference(from.source, file_, *chosen, node);
    if (is_elsewhere && warned_of_.insert(path.string()).second) {
      assembly_.warnings.push_back(node + ": this node names the file " +
                                   in_quotes(chosen->front()) + ", but " + path.string() +
                                   " was read");
    }
    const OpenFile& other = open({path.string(), {}, file_.options}, node);
    if (std::find(chain_.begin(), chain_.end(), &other) != chain_.end()) {
      fail_read(from.source, ErrorCode::kMeshUnreadable, node,
                "the shape of this node is in the file " + in_quotes(chosen->front()) +
                    ", which contains this node itself",
                "export the assembly into one file");
    }
    chain_.push_back(&other);
    return other;
  }

  // Reads each file once. An error bears the node that needs the file.
  const OpenFile& open(const SourceFile& source, const std::string& node) {
    std::error_code ignored;
    const auto key = std::filesystem::weakly_canonical(source.path, ignored);
    std::unique_ptr<OpenFile>& file = files_[key];
    if (file) return *file;
    try {
      file = std::make_unique<OpenFile>(OpenFile{source, read_step_document(source)});
      const std::uintmax_t bytes = std::filesystem::file_size(source.path, ignored);
      if (!ignored) limit_.allow_for(bytes);
      for (const std::string& warning : file->content.warnings) {
        assembly_.warnings.push_back((node.empty() ? "" : node + ": ") + warning);
      }
      tessellator_.add_open_bodies(file->content.open_bodies);
      return *file;
    } catch (ReadFailure& failure) {
      if (failure.error.where.empty()) failure.error.where = node;
      throw;
    } catch (const Standard_Failure& failure) {
      fail_read(source, ErrorCode::kMeshUnreadable, node,
                std::string("OpenCASCADE: ") + failure.GetMessageString(), "export the file again");
    }
  }

  void place(std::size_t node) {
    const auto& [file, label] = products_[node];
    if (!is_tessellated(node)) return;
    const auto [known, is_new] = products_done_.try_emplace({file, entry_of(label)});
    auto& [mesh, deviation_mm, lost] = known->second;
    if (is_new || joined_.contains(node)) {
      Tessellation made = tessellator_.tessellate(shape_of(node), names_[node].path);
      add_face_warnings(made, names_[node].path, assembly_.warnings);
      tell_progress(node);
      lost = std::move(made.lost);
      deviation_mm = made.deviation_mm;
      if (!made.mesh.triangles.empty()) {
        assembly_.meshes.push_back(std::move(made.mesh));
        mesh = static_cast<std::uint32_t>(assembly_.meshes.size() - 1);
      }
    }
    for (const LostFace& face : lost) add_missing(node_of(face, node), face, "");
    if (mesh == kNoTriangles) {
      if (lost.empty() && !is_flawed_.contains(node)) {
        node_warnings_.add(names_[node].path,
                           "left out because it has no faces, only curves or points");
      }
      return;
    }
    assembly_.instances.push_back({mesh, names_[node].path, placings_[node], {}, deviation_mm});
    nodes_of_instances_.push_back(node);
  }

  void add_missing(std::size_t node, const LostFace& place, const std::string& name) {
    MissingPiece& missing = missing_.emplace_back();
    missing.face.node = names_[node].path;
    missing.face.center = forcelayer::mesh::apply(placings_[node], place.center_mm);
    missing.face.size = place.size_mm;
    missing.name = name;
    missing.has_edges = place.has_edges;
  }

  void warn_of_unread(const std::vector<std::vector<std::string>>& references,
                      const std::string& node) {
    for (const auto& names : references) {
      if (!std::any_of(names.begin(), names.end(), is_step_name)) continue;
      assembly_.warnings.push_back(node + " has a shape of its own, so the file " +
                                   in_quotes(names.front()) + " that it names was not read");
    }
  }

  const SourceFile& file_;
  StepTessellator tessellator_;
  std::map<std::filesystem::path, std::unique_ptr<OpenFile>> files_;
  NodeTreeLimit limit_;
  std::vector<const OpenFile*> chain_;  // from the top file to that of the node in hand
  std::set<std::string> warned_of_;     // files and products
  std::vector<MissingPiece> missing_;
  FileLosses losses_;                                        // of all files; no pieces
  const OpenFile* flawed_ = nullptr;                         // the first file that has some
  std::set<std::size_t> is_flawed_;                          // nodes that lack a piece
  std::vector<std::pair<std::size_t, ReadFailure>> unread_;  // nodes whose files cannot be read
  std::vector<AssemblyNode> names_;  // of all nodes, each before its children
  std::vector<Product> products_;
  std::vector<Affine> placings_;
  std::map<std::size_t, double> expected_;  // triangles of nodes, the first of each product
  double all_expected_ = 0, done_ = 0;
  std::map<std::size_t, std::vector<std::size_t>> joined_;  // nodes that are read as one with it
  std::set<std::size_t> is_joined_;                         // those nodes
  std::map<std::pair<const OpenFile*, std::string>, TessellatedProduct> products_done_;
  GroupedWarnings node_warnings_{"nodes"};
  std::vector<std::size_t> nodes_of_instances_;  // [instances]
  Assembly assembly_;
};

}  // namespace

// The entry of the library that holds all of this: readers/step_library.cpp loads it.
extern "C" void forcelayer_read_step(const SourceFile& file, Assembly& assembly) {
  static std::mutex mutex;  // OpenCASCADE keeps its reading parameters in globals
  const std::lock_guard lock(mutex);
  Message::DefaultMessenger()->ChangePrinters().Clear();  // it reports on standard output
  try {
    assembly = StepReader(file).read();
  } catch (const Standard_Failure& failure) {
    fail_read(file, ErrorCode::kMeshUnreadable, "",
              std::string("OpenCASCADE: ") + failure.GetMessageString(), "export the file again");
  }
}

}  // namespace forcelayer::mesh
