#include "formats/mesh/step/iges/iges_placings.h"

#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESData_IGESModel.hxx>
#include <IGESData_TransfEntity.hxx>
#include <IGESGeom_TransformationMatrix.hxx>
#include <TColStd_HArray2OfReal.hxx>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gp_GTrsf.hxx>
#include <map>
#include <string>

namespace forcelayer::mesh {
namespace {

using Entity = Handle(IGESData_IGESEntity);
using Matrix = Handle(IGESGeom_TransformationMatrix);

// Curves, surfaces, faces and groups whose matrix OpenCASCADE applies.
constexpr int kPlaced[] = {100, 102, 104, 106, 108, 110, 112, 114, 118, 120, 122, 126, 128,
                           130, 140, 142, 144, 190, 192, 194, 196, 198, 308, 402, 408};

// Points, directions, curves and surfaces that a face may be made of.
constexpr int kGeometry[] = {100, 102, 104, 106, 108, 110, 112, 114, 116, 118, 120, 122,
                             123, 126, 128, 130, 140, 141, 142, 190, 192, 194, 196, 198};

// Faces, solids, their parts, and groups: each is misplaced whole.
constexpr int kHolders[] = {143, 144, 184, 186, 308, 320, 402, 408, 412,
                            414, 420, 430, 502, 504, 508, 510, 514};

template <std::size_t N>
bool is_one_of(const Entity& entity, const int (&types)[N]) {
  return std::find(std::begin(types), std::end(types), entity->TypeNumber()) != std::end(types);
}

// How far OpenCASCADE lets a matrix be from a rotation or mirror; it then takes the next one.
constexpr double kRounding = 1e-4;

bool is_rigid(const gp_GTrsf& a_from_b) {
  for (int i = 1; i <= 3; ++i) {
    for (int j = i; j <= 3; ++j) {
      double product = 0;
      for (int k = 1; k <= 3; ++k) product += a_from_b.Value(i, k) * a_from_b.Value(j, k);
      if (!(std::abs(product - (i == j ? 1 : 0)) <= kRounding)) return false;
    }
  }
  return true;
}

bool is_identity(const gp_GTrsf& a_from_b) {
  for (int row = 1; row <= 3; ++row) {
    for (int column = 1; column <= 4; ++column) {
      if (a_from_b.Value(row, column) != (row == column ? 1 : 0)) return false;
    }
  }
  return true;
}

Matrix matrix_of(const gp_GTrsf& a_from_b) {
  Handle(TColStd_HArray2OfReal) numbers = new TColStd_HArray2OfReal(1, 3, 1, 4);
  for (int row = 1; row <= 3; ++row) {
    for (int column = 1; column <= 4; ++column) {
      numbers->SetValue(row, column, a_from_b.Value(row, column));
    }
  }
  Matrix matrix = new IGESGeom_TransformationMatrix;
  matrix->Init(numbers);
  return matrix;
}

// The transformation matrices that entries of the directory name (field 7), by entry: OpenCASCADE
// forgets one that is not there.
std::map<int, int> matrix_entries_of(std::string_view text) {
  constexpr std::size_t kMatrix = 48, kField = 8, kSection = 72, kLine = 73;  // columns
  const auto number_at = [](std::string_view line, std::size_t column) {
    return std::atoi(std::string(line.substr(column, kField)).c_str());
  };
  std::map<int, int> matrices;
  bool is_first = true;  // of the two lines of an entry
  for (std::size_t begin = 0, end = 0; begin < text.size(); begin = end + 1) {
    end = std::min(text.find('\n', begin), text.size());
    const std::string_view line = text.substr(begin, end - begin);
    if (line.size() < kLine || line[kSection] != 'D') continue;
    const int matrix = number_at(line, kMatrix);
    if (is_first && matrix != 0) matrices[number_at(line, kLine)] = matrix;
    is_first = !is_first;
  }
  return matrices;
}

class IgesPlacings {
 public:
  IgesPlacings(const Handle(IGESData_IGESModel) & model, std::string_view text)
      : model_(model), matrix_entries_(matrix_entries_of(text)) {}

  IgesMisplaced settle() {
    IgesMisplaced misplaced;
    for (Standard_Integer i = 1; i <= model_->NbEntities(); ++i) {
      const Entity entity = model_->Entity(i);
      const bool is_holder = is_one_of(entity, kHolders);
      if ((!is_holder && !is_one_of(entity, kGeometry)) || settle(entity)) continue;
      if (is_holder) {
        misplaced.holders.push_back(entity);
      } else {
        misplaced.geometry.insert(model_->DNum(entity));
      }
    }
    return misplaced;
  }

 private:
  // False where it cannot be placed.
  bool settle(const Entity& entity) {
    const auto named = matrix_entries_.find(model_->DNum(entity));
    const bool has_matrix = named != matrix_entries_.end();
    const Matrix matrix = Matrix::DownCast(entity->Transf());
    if (has_matrix && (matrix.IsNull() || model_->DNum(matrix) != named->second)) return false;
    gp_GTrsf a_from_b;
    if (!matrix.IsNull()) {
      if (!product_of(matrix, a_from_b)) return false;
      if (!is_one_of(entity, kPlaced)) return is_identity(a_from_b);
    }
    const auto instance = Handle(IGESBasic_SingularSubfigure)::DownCast(entity);
    if (instance.IsNull()) {
      if (!matrix.IsNull()) entity->InitTransf(matrix_of(a_from_b));
      return true;
    }
    if (instance->HasScaleFactor() && std::abs(instance->ScaleFactor() - 1) > kRounding) {
      return false;
    }
    if (matrix.IsNull()) return true;
    gp_GTrsf definition_to_instance;
    definition_to_instance.SetTranslationPart(instance->Translation());
    a_from_b.Multiply(definition_to_instance);
    instance->Init(instance->Subfigure(), gp_XYZ(0, 0, 0), false, 1);
    instance->InitTransf(matrix_of(a_from_b));
    return true;
  }

  // Combines a matrix and those that it names, which are applied after it. False where there is
  // none.
  bool product_of(const Matrix& first, gp_GTrsf& product) const {
    std::set<const Standard_Transient*> seen;
    product = gp_GTrsf();
    for (Matrix matrix = first;;) {
      constexpr int kLeftHanded = 1;  // beyond are those of finite elements
      if (!seen.insert(matrix.get()).second || matrix->FormNumber() > kLeftHanded) return false;
      gp_GTrsf after = matrix->Value();
      if (!is_rigid(after)) return false;
      product.PreMultiply(after);
      const auto next = matrix_entries_.find(model_->DNum(matrix));
      const bool has_next = next != matrix_entries_.end() || matrix->HasTransf();
      if (!has_next) return true;
      const Matrix outer = Matrix::DownCast(matrix->Transf());
      if (outer.IsNull() ||
          (next != matrix_entries_.end() && model_->DNum(outer) != next->second)) {
        return false;
      }
      matrix = outer;
    }
  }

  Handle(IGESData_IGESModel) model_;
  std::map<int, int> matrix_entries_;
};

}  // namespace

IgesMisplaced settle_iges_placings(const Handle(XSControl_WorkSession) & session,
                                   std::string_view text) {
  return IgesPlacings(Handle(IGESData_IGESModel)::DownCast(session->Model()), text).settle();
}

}  // namespace forcelayer::mesh
