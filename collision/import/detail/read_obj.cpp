// Wavefront OBJ: `v x y z` and `f a b/t c//n ...`, indices from 1, or from the last backwards if negative.
#include <carom/collision/import/detail/readers.hpp>
#include <carom/collision/import/detail/text.hpp>

#include <algorithm>
#include <array>

namespace carom {
namespace {

// What says nothing about faces, or (curves and surfaces) is left out.
constexpr std::array<std::string_view, 37> kOther{
    "vt",    "vn",    "vp",       "l",        "p",          "o",         "g",     "s",     "mg",     "usemtl", "mtllib", "usemap", "maplib",
    "lod",   "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech", "stech", "cstype", "deg",    "bmat",   "step",   "curv",
    "curv2", "surf",  "parm",     "trim",     "hole",       "scrv",      "sp",    "end",   "con",    "call",   "csh"};

std::optional<std::uint32_t> vertex_index(std::string_view field, std::size_t count) {
    const std::optional<long long> written = parse_number<long long>(field.substr(0, field.find('/')));
    const auto all = static_cast<long long>(count);
    if (!written || *written == 0 || *written > all || *written < -all) return std::nullopt;
    return static_cast<std::uint32_t>(*written > 0 ? *written - 1 : all + *written);
}

}  // namespace

Status read_obj(std::string_view contents, MeshBuilder& builder) {
    LineReader lines(contents);
    std::vector<std::uint32_t> corners;
    while (lines.next()) {
        Fields fields(lines.line());
        const std::string_view keyword = fields.next();
        if (keyword == "v") {
            const std::optional<float> x = parse_number<float>(fields.next()), y = parse_number<float>(fields.next()),
                                       z = parse_number<float>(fields.next());
            if (!x || !y || !z) return builder.parse_error(lines.at("a vertex needs three numbers"));
            if (!builder.add_vertex(dvec3(*x, *y, *z))) return builder.not_finite();
        } else if (keyword == "f") {
            corners.clear();
            for (std::string_view field = fields.next(); !field.empty(); field = fields.next()) {
                const std::optional<std::uint32_t> index = vertex_index(field, builder.vertex_count());
                if (!index) {
                    return builder.parse_error(lines.at("\"" + std::string(field.substr(0, 32)) + "\" is no vertex among the " +
                                                        std::to_string(builder.vertex_count()) + " so far"));
                }
                corners.push_back(*index);
            }
            if (corners.size() < 3) return builder.parse_error(lines.at("a face needs three corners"));
            if (const char* problem = builder.add_face(corners)) return builder.parse_error(lines.at(problem));
        } else if (std::ranges::find(kOther, keyword) == kOther.end()) {
            return builder.parse_error(lines.at("\"" + std::string(keyword.substr(0, 32)) + "\" is no keyword of OBJ"));
        }
    }
    return {};
}

}  // namespace carom
