#include <carom/collision/import/detail/gltf_document.hpp>

#include <carom/collision/import/detail/bytes.hpp>
#include <carom/collision/import/detail/read_file.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>

namespace carom {
namespace {

// What changes looks only.
constexpr std::array<std::string_view, 4> kHarmless{"KHR_materials_", "KHR_texture_", "KHR_lights_", "EXT_texture_"};

constexpr std::uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr std::size_t kGlbHeader = 12, kChunkHeader = 8;

int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

std::optional<std::string> decode_base64(std::string_view text) {
    while (text.ends_with('=')) text.remove_suffix(1);
    std::string out;
    out.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return std::nullopt;
        bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xffffu;
        held += 6;
        if (held < 8) continue;
        held -= 8;
        out.push_back(static_cast<char>(bits >> held & 0xffu));
    }
    return held < 6 ? std::optional(std::move(out)) : std::nullopt;
}

std::optional<std::string> decode_percent(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out.push_back(text[i]);
            continue;
        }
        unsigned value = 0;
        const std::string_view digits = text.substr(std::min(i + 1, text.size()), 2);
        const std::from_chars_result read = std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
        if (digits.size() != 2 || read.ptr != digits.data() + 2) return std::nullopt;
        out.push_back(static_cast<char>(value));
        i += 2;
    }
    return out;
}

// A buffer's bytes from the text that stands for them, or from a file in the folder of `path` or below it.
Result<std::string> fetch(const std::string& uri, const std::string& path, const MeshBuilder& builder) {
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(";base64,");
        std::optional<std::string> bytes =
            comma == std::string::npos ? std::nullopt : decode_base64(std::string_view(uri).substr(comma + 8));
        return bytes ? Result<std::string>(std::move(*bytes)) : builder.parse_error("holds a buffer that is not in base64");
    }
    const std::optional<std::string> name = decode_percent(uri);
    if (!name || name->find('\0') != std::string::npos) return builder.parse_error("names a buffer that is no path");
    const std::filesystem::path file(*name);
    const bool inside =
        file.is_relative() && std::ranges::find(file, std::filesystem::path("..")) == file.end() && uri.find(':') == std::string::npos;
    if (path.empty() || !inside) return builder.unsupported("names a buffer outside of its folder");
    return read_file((std::filesystem::path(path).parent_path() / file).string());
}

}  // namespace

const GltfJson& member(const GltfJson& json, const char* key) {
    static const GltfJson kNull;
    if (!json.is_object()) return kNull;
    const auto found = json.find(key);
    return found != json.end() ? *found : kNull;
}

std::optional<std::uint64_t> whole_member(const GltfJson& json, const char* key) {
    const GltfJson& value = member(json, key);
    return value.is_number_unsigned() ? std::optional(value.get<std::uint64_t>()) : std::nullopt;
}

const GltfJson& item(const GltfJson& json, const char* key, std::optional<std::uint64_t> index) {
    static const GltfJson kNull;
    const GltfJson& list = member(json, key);
    return list.is_array() && index && *index < list.size() ? list[*index] : kNull;
}

Result<GltfDocument> GltfDocument::open(std::string_view contents, const std::string& path, const MeshBuilder& builder) {
    GltfDocument document;
    if (Status status = document.split(contents, builder); !status) return status.error();
    if (Status status = document.check_demands(builder); !status) return status.error();
    if (Status status = document.load_buffers(path, builder); !status) return status.error();
    return document;
}

// The JSON, and the binary chunk of a .glb.
Status GltfDocument::split(std::string_view contents, const MeshBuilder& builder) {
    std::string_view text = contents;
    if (contents.starts_with("glTF")) {
        if (contents.size() < kGlbHeader + kChunkHeader) return builder.parse_error("ends within its header");
        if (load<std::uint32_t>(contents.substr(4), false) != 2) return builder.unsupported("only version 2 of glTF is read");
        if (load<std::uint32_t>(contents.substr(8), false) != contents.size()) return builder.parse_error("is not as long as it says");
        std::string_view rest = contents.substr(kGlbHeader);
        for (int chunk = 0; rest.size() >= kChunkHeader; ++chunk) {
            const std::size_t size = load<std::uint32_t>(rest, false);
            const std::uint32_t kind = load<std::uint32_t>(rest.substr(4), false);
            rest.remove_prefix(kChunkHeader);
            if (size > rest.size()) return builder.parse_error("ends within a chunk");
            if (chunk == 0 && kind != kJsonChunk) return builder.parse_error("does not begin with JSON");
            if (chunk == 0) text = rest.substr(0, size);
            if (chunk == 1 && kind == kBinaryChunk) chunk_ = rest.substr(0, size);
            rest.remove_prefix(size);
        }
        if (!rest.empty()) return builder.parse_error("ends within a chunk");
    }
    json_ = GltfJson::parse(text, nullptr, false);
    return json_.is_object() ? Status{} : Status(builder.parse_error("is not a JSON object"));
}

// What the file says that its reader must know.
Status GltfDocument::check_demands(const MeshBuilder& builder) const {
    const GltfJson& version = member(member(json_, "asset"), "version");
    if (!version.is_string()) return builder.parse_error("does not say which version of glTF it is");
    if (!version.get_ref<const std::string&>().starts_with("2.")) return builder.unsupported("only version 2 of glTF is read");
    for (const GltfJson& name : member(json_, "extensionsRequired")) {
        if (!name.is_string()) return builder.parse_error("names an extension that is no text");
        const std::string& text = name.get_ref<const std::string&>();
        if (std::ranges::any_of(kHarmless, [&](std::string_view known) { return text.starts_with(known); })) continue;
        return builder.unsupported("needs the extension " + text.substr(0, 64));
    }
    return {};
}

Status GltfDocument::load_buffers(const std::string& path, const MeshBuilder& builder) {
    for (const GltfJson& buffer : member(json_, "buffers")) {
        const GltfJson& uri = member(buffer, "uri");
        const bool first = buffers_.empty();
        buffers_.emplace_back();
        if (uri.is_null() && first && chunk_) continue;
        if (!uri.is_string()) return builder.parse_error("has a buffer without a place");
        Result<std::string> bytes = fetch(uri.get_ref<const std::string&>(), path, builder);
        if (!bytes) return bytes.error();
        if (first) chunk_.reset();
        buffers_.back() = std::move(*bytes);
    }
    return {};
}

Result<GltfArray> GltfDocument::array(std::optional<std::uint64_t> accessor, std::string_view type, const MeshBuilder& builder) const {
    const GltfJson& json = item(json_, "accessors", accessor);
    const GltfJson& view = item(json_, "bufferViews", whole_member(json, "bufferView"));
    const std::optional<std::uint64_t> buffer = whole_member(view, "buffer"), count = whole_member(json, "count"),
                                       component = whole_member(json, "componentType"), length = whole_member(view, "byteLength");
    if (json.is_object() && json.contains("sparse")) return builder.unsupported("sparse accessors are not read");
    if (!buffer || *buffer >= buffers_.size() || !count || !component || !length) return builder.parse_error("has an accessor of nothing");
    const bool vectors = type == "VEC3";
    if (member(json, "type") != type || (*component == kGltfFloat) != vectors) {
        return builder.unsupported("positions must be three floats, indices unsigned numbers");
    }
    const std::size_t size = vectors                     ? 12
                             : *component == kGltfUint8  ? 1
                             : *component == kGltfUint16 ? 2
                             : *component == kGltfUint32 ? 4
                                                         : 0;
    if (size == 0) return builder.unsupported("positions must be three floats, indices unsigned numbers");
    const std::string_view bytes = *buffer == 0 && chunk_ ? *chunk_ : std::string_view(buffers_[*buffer]);
    const std::uint64_t start = whole_member(view, "byteOffset").value_or(0), skip = whole_member(json, "byteOffset").value_or(0);
    const std::uint64_t stride = whole_member(view, "byteStride").value_or(size);
    const bool within = start <= bytes.size() && *length <= bytes.size() - start && skip <= *length && stride >= size &&
                        (*count == 0 || (*length - skip >= size && *count - 1 <= (*length - skip - size) / stride));
    if (!within) return builder.parse_error("has an accessor beyond the end of its buffer");
    return GltfArray{bytes.substr(start + skip, *length - skip), *count, stride, *component};
}

}  // namespace carom
