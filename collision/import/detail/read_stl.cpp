// STL. Binary: 80 bytes that say nothing, a 32-bit count, and 50 bytes a triangle, little-endian. Text: solid, facet, outer loop, vertex.
#include <carom/collision/import/detail/bytes.hpp>
#include <carom/collision/import/detail/readers.hpp>
#include <carom/collision/import/detail/text.hpp>

#include <algorithm>

namespace carom {
namespace {

constexpr std::size_t kHeader = 84, kFacet = 50, kNormal = 12;

Status read_binary(std::string_view contents, std::size_t count, MeshBuilder& builder) {
    builder.reserve(3 * count, count);
    for (std::size_t i = 0; i < count; ++i) {
        const std::string_view facet = contents.substr(kHeader + kFacet * i + kNormal);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto part = [&](std::size_t axis) { return static_cast<double>(load<float>(facet.substr(4 * (3 * k + axis)), false)); };
            if (!builder.add_vertex({part(0), part(1), part(2)})) return builder.not_finite();
        }
        const auto last = static_cast<std::uint32_t>(builder.vertex_count());
        const std::uint32_t corners[3]{last - 3, last - 2, last - 1};
        if (const char* problem = builder.add_face(corners)) return builder.parse_error(problem);
    }
    return {};
}

std::string lower(std::string_view word) {
    std::string out(word.substr(0, 32));
    std::ranges::transform(out, out.begin(), [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return out;
}

// The next line must begin with these words; what follows them is left in the result.
std::optional<Fields> expect(LineReader& lines, std::initializer_list<std::string_view> words) {
    if (!lines.next()) return std::nullopt;
    Fields fields(lines.line());
    for (const std::string_view word : words) {
        if (lower(fields.next()) != word) return std::nullopt;
    }
    return fields;
}

// After its line "facet normal ...".
Status read_facet(LineReader& lines, MeshBuilder& builder) {
    if (!expect(lines, {"outer", "loop"})) return builder.parse_error(lines.at("expected \"outer loop\""));
    for (int k = 0; k < 3; ++k) {
        std::optional<Fields> fields = expect(lines, {"vertex"});
        if (!fields) return builder.parse_error(lines.at("expected a vertex"));
        const std::optional<float> x = parse_number<float>(fields->next()), y = parse_number<float>(fields->next()),
                                   z = parse_number<float>(fields->next());
        if (!x || !y || !z) return builder.parse_error(lines.at("a vertex needs three numbers"));
        if (!builder.add_vertex(dvec3(*x, *y, *z))) return builder.not_finite();
    }
    if (!expect(lines, {"endloop"})) return builder.parse_error(lines.at("expected \"endloop\""));
    if (!expect(lines, {"endfacet"})) return builder.parse_error(lines.at("expected \"endfacet\""));
    const auto last = static_cast<std::uint32_t>(builder.vertex_count());
    const std::uint32_t corners[3]{last - 3, last - 2, last - 1};
    const char* const problem = builder.add_face(corners);
    return problem != nullptr ? Status(builder.parse_error(lines.at(problem))) : Status{};
}

Status read_text(std::string_view contents, MeshBuilder& builder) {
    LineReader lines(contents);
    bool open = false;
    while (lines.next()) {
        const std::string keyword = lower(Fields(lines.line()).next());
        if (keyword != (open ? "facet" : "solid") && !(open && keyword == "endsolid")) {
            return builder.parse_error(lines.at(open ? "expected \"facet\" or \"endsolid\"" : "expected \"solid\""));
        }
        if (open && keyword == "facet") {
            if (Status status = read_facet(lines, builder); !status) return status;
        } else {
            open = !open;
        }
    }
    return open ? Status(builder.parse_error("ends before \"endsolid\"")) : Status{};
}

}  // namespace

// Binary files may begin with "solid" too, so the size decides first.
Status read_stl(std::string_view contents, MeshBuilder& builder) {
    if (contents.size() >= kHeader) {
        const std::size_t count = load<std::uint32_t>(contents.substr(kHeader - 4), false);
        if (contents.size() == kHeader + kFacet * count) return read_binary(contents, count, builder);
    }
    if (lower(Fields(contents).next()) == "solid") return read_text(contents, builder);
    return builder.parse_error("neither begins with \"solid\" nor is as long as its number of triangles says");
}

}  // namespace carom
