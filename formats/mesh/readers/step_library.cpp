// Loads the library that reads STEP and IGES (../step) when the first such file comes.
#include <dlfcn.h>

#include "formats/file/program_folder.h"
#include "formats/mesh/reader.h"

namespace forcelayer::mesh {
namespace {

struct StepLibrary {
  decltype(&forcelayer_read_step) read = nullptr;
  std::string failure;
};

// bin/ and lib/ stand beside each other where the programs are built and where they are installed.
StepLibrary load() {
  StepLibrary library;
  const auto path = program_folder().parent_path() / "lib/forcelayer/forcelayer_step.so";
  // Never closed: what it throws lives on.
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  void* const entry = handle != nullptr ? ::dlsym(handle, "forcelayer_read_step") : nullptr;
  if (entry == nullptr) {
    const char* const failure = ::dlerror();
    library.failure = failure != nullptr ? failure : "no entry";
  }
  library.read = reinterpret_cast<decltype(library.read)>(entry);
  return library;
}

const StepLibrary& step_library() {
  static const StepLibrary library = load();
  return library;
}

}  // namespace

void load_reader_of(const std::string& path) {
  const std::string dotted = lower_case_extension(path) + ".";
  if (std::string_view(".step.stp.iges.igs.").find(dotted) != std::string_view::npos)
    step_library();
}

Assembly read_step(const SourceFile& file) {
#ifdef FORCELAYER_STEP
  const StepLibrary& library = step_library();
  if (library.read == nullptr) {
    fail_read(file, ErrorCode::kMeshUnsupported, "",
              "the reader of STEP and IGES cannot be loaded: " + library.failure,
              "install the package forcelayer-tools, or export the assembly as glTF (.glb)");
  }
  Assembly assembly;
  library.read(file, assembly);
  return assembly;
#else
  fail_read(file, ErrorCode::kMeshUnsupported, "", "this program was built without STEP and IGES",
            "export the assembly as glTF (.glb), or configure with -DFORCELAYER_STEP=ON");
#endif
}

}  // namespace forcelayer::mesh
