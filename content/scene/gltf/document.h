// A glTF document with every byte read that it refers to: parsed, its extensions checked, nothing interpreted yet.
#pragma once

#include <tiny_gltf.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "content/scene/gltf/source_files.h"

namespace probewalk::gltf {

// An encoded image (PNG, JPEG, WebP), or why there is none.
struct EncodedImage {
  std::string name;             // URI or name, for messages
  std::optional<Bytes> bytes;   // absent: the file is missing or its URI is refused; `problem` says which
  int buffer_view = -1;         // else in this view
  std::string problem;
};

struct Document {
  std::string file;       // for messages
  tinygltf::Model model;  // buffers and images stay empty: tinygltf never touches a file
  nlohmann::json json;    // the whole document, for extras
  std::vector<Bytes> buffers;
  std::vector<bool> buffer_is_placeholder;  // a fallback of EXT_meshopt_compression without data
  std::vector<EncodedImage> images;
  std::vector<std::string> warnings;
};

// Throws BadInput for anything that is not a complete glTF 2.0 file or needs an extension we do not know.
Document read_document(SourceFiles& files);

// `object[key]` where both exist and the value is of JSON type object or array, else nullptr.
const nlohmann::json* find_object(const nlohmann::json& object, const char* key);
const nlohmann::json* find_array(const nlohmann::json& object, const char* key);
// String member, or "" when absent or of another type.
std::string string_member(const nlohmann::json& object, const char* key);

}  // namespace probewalk::gltf
