#include "formats/mesh/readers/gltf/meshopt_view.h"

#ifdef FORCELAYER_MESHOPT
#include <meshoptimizer.h>
#endif

namespace forcelayer::mesh {

#ifdef FORCELAYER_MESHOPT

namespace {

bool decode_elements(const MeshoptView& view, std::string& elements) {
  const auto* packed = reinterpret_cast<const unsigned char*>(view.packed.data());
  const std::size_t size = view.packed.size();
  if (view.mode == "ATTRIBUTES") {
    if (view.stride % 4 != 0 || view.stride < 4 || view.stride > 256) return false;
    return meshopt_decodeVertexBuffer(elements.data(), view.count, view.stride, packed, size) == 0;
  }
  if (view.stride != 2 && view.stride != 4) return false;
  if (view.mode == "TRIANGLES") {
    return view.count % 3 == 0 &&
           meshopt_decodeIndexBuffer(elements.data(), view.count, view.stride, packed, size) == 0;
  }
  return view.mode == "INDICES" &&
         meshopt_decodeIndexSequence(elements.data(), view.count, view.stride, packed, size) == 0;
}

bool apply_filter(const MeshoptView& view, std::string& elements) {
  if (view.filter == "NONE") return true;
  if (view.mode != "ATTRIBUTES") return false;
  if (view.filter == "OCTAHEDRAL" && (view.stride == 4 || view.stride == 8)) {
    meshopt_decodeFilterOct(elements.data(), view.count, view.stride);
  } else if (view.filter == "QUATERNION" && view.stride == 8) {
    meshopt_decodeFilterQuat(elements.data(), view.count, view.stride);
  } else if (view.filter == "EXPONENTIAL") {
    meshopt_decodeFilterExp(elements.data(), view.count, view.stride);
  } else {
    return false;
  }
  return true;
}

}  // namespace

bool reads_meshopt() { return true; }

std::optional<std::string> decode_meshopt(const MeshoptView& view) {
  std::string elements(view.count * view.stride, '\0');
  if (view.count > 0 && !decode_elements(view, elements)) return {};
  if (!apply_filter(view, elements)) return {};
  return elements;
}

#else

bool reads_meshopt() { return false; }

std::optional<std::string> decode_meshopt(const MeshoptView&) { return {}; }

#endif

}  // namespace forcelayer::mesh
