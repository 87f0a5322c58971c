// A glTF file as its JSON and its buffers, and typed access to what they hold.
//
//   Result<GltfDocument> document = GltfDocument::open(contents, path, builder);
//   Result<GltfArray> positions = document->array(accessor, {"VEC3", ...}, builder);
#pragma once

#include <carom/collision/import/detail/mesh_builder.hpp>

#include <nlohmann/json.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace carom {

using GltfJson = nlohmann::json;

/// @return the member of an object; null where there is none, or where `json` is no object.
[[nodiscard]] const GltfJson& member(const GltfJson& json, const char* key);
/// @return the member of an object as a whole number; none where it is missing or something else.
[[nodiscard]] std::optional<std::uint64_t> whole_member(const GltfJson& json, const char* key);
/// @return item `index` of the list called `key`; null where there is none.
[[nodiscard]] const GltfJson& item(const GltfJson& json, const char* key, std::optional<std::uint64_t> index);

/// `count` items in a buffer, each at `stride` bytes from the last; all of them lie within `bytes`.
struct GltfArray {
    std::string_view bytes;
    std::size_t count = 0, stride = 0;
    std::uint64_t component = 0;  ///< glTF's number of the component's type
};

inline constexpr std::uint64_t kGltfUint8 = 5121, kGltfUint16 = 5123, kGltfUint32 = 5125, kGltfFloat = 5126;

class GltfDocument {
public:
    /// Checks version and extensions, and loads the buffers. The contents must outlive the document.
    [[nodiscard]] static Result<GltfDocument> open(std::string_view contents, const std::string& path, const MeshBuilder& builder);
    [[nodiscard]] const GltfJson& json() const noexcept { return json_; }
    /// The items of an accessor. @param type  "VEC3" of floats or "SCALAR" of unsigned numbers; anything else is refused.
    [[nodiscard]] Result<GltfArray> array(std::optional<std::uint64_t> accessor, std::string_view type, const MeshBuilder& builder) const;

private:
    Status split(std::string_view contents, const MeshBuilder& builder);
    Status check_demands(const MeshBuilder& builder) const;
    Status load_buffers(const std::string& path, const MeshBuilder& builder);
    GltfJson json_;
    std::optional<std::string_view> chunk_;  // the binary one of a .glb
    std::vector<std::string> buffers_;       // empty where the chunk is the buffer
};

}  // namespace carom
