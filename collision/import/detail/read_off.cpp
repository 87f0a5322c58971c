// Geomview OFF as text: the keyword, the numbers of vertices, faces and edges, then a vertex a line and a face a line.
#include <carom/collision/import/detail/readers.hpp>
#include <carom/collision/import/detail/text.hpp>

namespace carom {
namespace {

// Refuses what does not begin with the keyword, whose prefixes only say what else a vertex has.
Status check_keyword(std::string_view keyword, const MeshBuilder& builder) {
    if (!keyword.ends_with("OFF")) return builder.parse_error("does not begin with OFF");
    std::string_view prefix = keyword.substr(0, keyword.size() - 3);
    for (const std::string_view known : {"ST", "C", "N"}) {
        if (prefix.starts_with(known)) prefix.remove_prefix(known.size());
    }
    if (prefix == "4" || prefix == "n" || prefix == "4n")
        return builder.unsupported("vertices of other than three dimensions are not read");
    return prefix.empty() ? Status{} : Status(builder.parse_error("does not begin with OFF"));
}

Status read_vertices(LineReader& lines, std::size_t count, MeshBuilder& builder) {
    for (std::size_t i = 0; i < count; ++i) {
        if (!lines.next()) return builder.parse_error("ends after " + std::to_string(i) + " of " + std::to_string(count) + " vertices");
        Fields fields(lines.line());
        const std::optional<float> x = parse_number<float>(fields.next()), y = parse_number<float>(fields.next()),
                                   z = parse_number<float>(fields.next());
        if (!x || !y || !z) return builder.parse_error(lines.at("a vertex needs three numbers"));
        if (!builder.add_vertex(dvec3(*x, *y, *z))) return builder.not_finite();
    }
    return {};
}

Status read_faces(LineReader& lines, std::size_t count, MeshBuilder& builder) {
    std::vector<std::uint32_t> corners;
    for (std::size_t i = 0; i < count; ++i) {
        if (!lines.next()) return builder.parse_error("ends after " + std::to_string(i) + " of " + std::to_string(count) + " faces");
        Fields fields(lines.line());
        const std::optional<std::uint32_t> size = parse_number<std::uint32_t>(fields.next());
        if (!size || *size == 0) return builder.parse_error(lines.at("a face needs its number of corners"));
        corners.clear();
        for (std::uint32_t k = 0; k < *size; ++k) {
            const std::optional<std::uint32_t> index = parse_number<std::uint32_t>(fields.next());
            if (!index) return builder.parse_error(lines.at("a face needs as many corners as it says"));
            corners.push_back(*index);
        }
        if (const char* problem = builder.add_face(corners)) return builder.parse_error(lines.at(problem));
    }
    return {};
}

}  // namespace

Status read_off(std::string_view contents, MeshBuilder& builder) {
    LineReader lines(contents);
    if (!lines.next()) return builder.parse_error("does not begin with OFF");
    Fields fields(lines.line());
    if (Status status = check_keyword(fields.next(), builder); !status) return status;
    std::string_view first = fields.next();
    if (first == "BINARY") return builder.unsupported("binary OFF is not read");
    if (first.empty()) {
        if (!lines.next()) return builder.parse_error("ends before the number of vertices");
        fields = Fields(lines.line());
        first = fields.next();
    }
    const std::optional<std::uint32_t> vertices = parse_number<std::uint32_t>(first), faces = parse_number<std::uint32_t>(fields.next());
    if (!vertices || !faces) return builder.parse_error(lines.at("needs the numbers of vertices and faces"));
    // The shortest vertex is "0 0 0\n", the shortest face "1 0\n"; the last line may do without its end.
    if ((std::uint64_t{*vertices} * 6 + std::uint64_t{*faces} * 4) > lines.bytes_left() + 1) {
        return builder.parse_error(lines.at("says more vertices and faces than the file holds"));
    }
    builder.reserve(*vertices, *faces);
    if (Status status = read_vertices(lines, *vertices, builder); !status) return status;
    if (Status status = read_faces(lines, *faces, builder); !status) return status;
    return lines.next() ? Status(builder.parse_error(lines.at("follows the last face"))) : Status{};
}

}  // namespace carom
