// The declarations of all mesh readers, and the helpers that they share. Readers throw ReadFailure;
// read_assembly() turns it into an Error.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/file_bytes.h"
#include "formats/file/named_file.h"
#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// One mesh file in memory.
struct SourceFile {
  std::string path;        // as the user gave it, without "#NODE"
  std::string_view bytes;  // all of it
  ReadOptions options = {};
};

// ".stl" of "Part.STL"; empty where the name has no extension.
std::string lower_case_extension(const std::string& path);

// Whether `path` has the extension of a mesh format.
bool has_mesh_extension(const std::string& path);

// Each of `inputs` ("FILE#NODE") by the order of files, with all nodes that are named of a file;
// none where one input names the whole of it.
std::vector<NamedFile> unite_by_file(std::span<const std::string> inputs);

// Whether a file of this name may have nodes ("FILE#NODE"): by its extension; true for an unknown
// one.
bool may_have_nodes(const std::string& path);

// Whether a library reads a file of this name that is known to crash on some damaged ones.
bool may_crash_its_reader(const std::string& path);

// The bytes of a file as text; valid as long as `file` is.
std::string_view text_of(const FileBytes& file);

struct ReadFailure {
  Error error;
};

// Throws with a place such as "line 12" or "byte 84".
[[noreturn]] void fail_read(const SourceFile& file, ErrorCode code, std::string where,
                            std::string what, std::string mend = {});
std::string at_byte(std::uint64_t offset);

// Throws kMeshUnsupported for a count that 32-bit indices of a Mesh cannot reach.
void check_count(const SourceFile& file, std::uint64_t count, const char* what);

// Throws where a vertex is not a finite number (`where`: the mesh's place in the file), kMeshEmpty
// where there are no triangles.
void check_finite(const SourceFile& file, const Mesh& mesh, const std::string& where = {});
void check_not_empty(const SourceFile& file, const Mesh& mesh);

// An assembly of one mesh, which stands once, at the origin, under the file's stem.
Assembly assembly_of(const SourceFile& file, Mesh mesh);

// 'word', shortened where it is long.
std::string in_quotes(std::string_view word);

// "1 polygon", "3 polygons", "2 entities".
std::string counted(std::uint64_t count, const char* singular);

// read_assembly() of a file that is in memory already.
Result<Assembly> read_source(const SourceFile& file);

Assembly read_stl(const SourceFile& file);
Assembly read_obj(const SourceFile& file);
Assembly read_ply(const SourceFile& file);
Assembly read_off(const SourceFile& file);
Assembly read_om(const SourceFile& file);
Assembly read_drc(const SourceFile& file);
Assembly read_gltf(const SourceFile& file);
Assembly read_step(const SourceFile& file);

// read_step() loads the library that holds its work for the first file: OpenCASCADE is 29
// libraries, and loading them takes longer than baking a small part. This loads it now where `path`
// is named as STEP or IGES, for a process that is about to give up the right to. read_step() tells
// of failures.
void load_reader_of(const std::string& path);

// The library's one entry.
extern "C" void forcelayer_read_step(const SourceFile& file, Assembly& assembly);

}  // namespace forcelayer::mesh
