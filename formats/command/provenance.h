// Reads the provenance of a baked file for its user. It is text from the file: no promise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace forcelayer::command {

// How many faces the user agreed to miss (--missing-faces); 0 where the text, the JSON that
// voxelize and pointshell write, does not say.
std::uint64_t missing_faces_in(std::string_view provenance);

// The axis of glTF files that is up, as the bake read them: "z" or "y"; empty where none was read,
// and in files of versions that always kept y up.
std::string up_in(std::string_view provenance);

// "2 faces are missing from the mesh, and no guarantee covers them"; empty where none is missing.
std::string missing_faces_text(std::string_view provenance);

// The hash of each object that a scene was baked from, and of the part that a shell was. Empty
// where the text does not have all of them.
std::vector<std::string> object_hashes_in(std::string_view provenance);
std::string part_hash_in(std::string_view provenance);

// The deviation of all meshes that the user declared, m; none where the text does not say.
std::optional<double> mesh_deviation_in(std::string_view provenance);

}  // namespace forcelayer::command
