// Stanford PLY: a header that says which elements have which properties, then the elements as text or bytes.
#include <carom/collision/import/detail/bytes.hpp>
#include <carom/collision/import/detail/readers.hpp>
#include <carom/collision/import/detail/text.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace carom {
namespace {

enum class Scalar : unsigned char { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };
enum class Encoding : unsigned char { Text, Little, Big };

std::optional<Scalar> scalar_named(std::string_view name) {
    constexpr std::array<std::array<std::string_view, 2>, 8> kNames{{{"char", "int8"},
                                                                     {"uchar", "uint8"},
                                                                     {"short", "int16"},
                                                                     {"ushort", "uint16"},
                                                                     {"int", "int32"},
                                                                     {"uint", "uint32"},
                                                                     {"float", "float32"},
                                                                     {"double", "float64"}}};
    for (std::size_t i = 0; i < kNames.size(); ++i) {
        if (name == kNames[i][0] || name == kNames[i][1]) return static_cast<Scalar>(i);
    }
    return std::nullopt;
}

std::size_t size_of(Scalar type) { return std::array<std::size_t, 8>{1, 1, 2, 2, 4, 4, 4, 8}[static_cast<std::size_t>(type)]; }
bool is_real(Scalar type) { return type == Scalar::Float || type == Scalar::Double; }

struct Property {
    std::string name;
    Scalar type = Scalar::Float;
    std::optional<Scalar> count;  ///< of a list
};

struct Element {
    std::string name;
    std::uint32_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    Encoding encoding = Encoding::Text;
    std::vector<Element> elements;
    std::size_t size = 0, lines = 0;  ///< of the header itself
};

std::optional<Property> parse_property(Fields fields) {
    Property property;
    std::string_view word = fields.next();
    if (word == "list") {
        property.count = scalar_named(fields.next());
        if (!property.count || is_real(*property.count)) return std::nullopt;
        word = fields.next();
    }
    const std::optional<Scalar> type = scalar_named(word);
    property.name = fields.next();
    if (!type || property.name.empty()) return std::nullopt;
    property.type = *type;
    return property;
}

// One line of the header, other than the first and the last. @return false if it is none.
bool parse_header_line(std::string_view line, Header& header, bool& has_format) {
    Fields fields(line);
    const std::string_view keyword = fields.next();
    if (keyword == "comment" || keyword == "obj_info" || keyword.empty()) return true;
    if (keyword == "format") {
        const std::string_view name = fields.next();
        const bool text = name == "ascii", little = name == "binary_little_endian", big = name == "binary_big_endian";
        header.encoding = text ? Encoding::Text : little ? Encoding::Little : Encoding::Big;
        const bool good = (text || little || big) && !has_format && fields.next() == "1.0";
        has_format = true;
        return good;
    }
    if (keyword == "element") {
        Element element;
        element.name = fields.next();
        const std::optional<std::uint32_t> count = parse_number<std::uint32_t>(fields.next());
        element.count = count.value_or(0);
        header.elements.push_back(std::move(element));
        return count.has_value();
    }
    if (keyword != "property" || header.elements.empty()) return false;
    std::optional<Property> property = parse_property(fields);
    if (!property) return false;
    header.elements.back().properties.push_back(std::move(*property));
    return true;
}

Result<Header> parse_header(std::string_view contents, const MeshBuilder& builder) {
    Header header;
    bool has_format = false;
    for (bool ended = false; !ended; ++header.lines) {
        const std::size_t end = contents.find('\n', header.size);
        std::string_view line = contents.substr(header.size, end - header.size);
        if (line.ends_with('\r')) line.remove_suffix(1);
        if (header.lines == 0 && line != "ply") return builder.parse_error("does not begin with ply");
        if (end == std::string_view::npos) return builder.parse_error("ends within the header");
        ended = Fields(line).next() == "end_header";
        if (header.lines > 0 && !ended && !parse_header_line(line, header, has_format)) {
            return builder.parse_error("line " + std::to_string(header.lines + 1) + ": is no line of a PLY header");
        }
        header.size = end + 1;
    }
    if (!has_format) return builder.parse_error("the header does not say the format");
    return header;
}

// Reads numbers one by one, from text or bytes.
class Numbers {
public:
    Numbers(std::string_view data, Encoding encoding) : text_(data), bytes_(data), encoding_(encoding) {}

    std::optional<double> next(Scalar type) {
        if (encoding_ == Encoding::Text) return next_word(type);
        const std::size_t size = size_of(type);
        if (bytes_.size() < size) return std::nullopt;
        const std::string_view data = bytes_;
        bytes_.remove_prefix(size);
        const bool big = encoding_ == Encoding::Big;
        switch (type) {
            case Scalar::Int8:
                return load<std::int8_t>(data, big);
            case Scalar::Uint8:
                return load<std::uint8_t>(data, big);
            case Scalar::Int16:
                return load<std::int16_t>(data, big);
            case Scalar::Uint16:
                return load<std::uint16_t>(data, big);
            case Scalar::Int32:
                return load<std::int32_t>(data, big);
            case Scalar::Uint32:
                return load<std::uint32_t>(data, big);
            case Scalar::Float:
                return static_cast<double>(load<float>(data, big));
            case Scalar::Double:
                return load<double>(data, big);
        }
        return std::nullopt;
    }
    [[nodiscard]] std::size_t bytes_left() const { return encoding_ == Encoding::Text ? text_.rest().size() : bytes_.size(); }
    [[nodiscard]] bool at_end() const { return encoding_ == Encoding::Text ? Fields(text_).next().empty() : bytes_.empty(); }
    /// The fewest bytes that a number takes up.
    [[nodiscard]] std::size_t least(Scalar type) const { return encoding_ == Encoding::Text ? 1 : size_of(type); }

private:
    std::optional<double> next_word(Scalar type) {
        const std::string_view word = text_.next();
        if (type == Scalar::Float) {
            const std::optional<float> value = parse_number<float>(word);
            return value ? std::optional<double>(*value) : std::nullopt;
        }
        return parse_number<double>(word);
    }
    Fields text_;
    std::string_view bytes_;
    Encoding encoding_;
};

// A number that stands for an index or a length.
std::optional<std::uint32_t> whole(const std::optional<double>& value) {
    if (!value || !(*value >= 0.0 && *value <= 4294967295.0) || *value != std::floor(*value)) return std::nullopt;
    return static_cast<std::uint32_t>(*value);
}

// What an element is read for.
enum class Role : unsigned char { Vertex, Face, Other };

class BodyReader {
public:
    BodyReader(Numbers& numbers, MeshBuilder& builder) : numbers_(numbers), builder_(builder) {}

    Status read(const Element& element, Role role) {
        for (std::uint32_t i = 0; i < element.count; ++i) {
            const auto place = [&] { return element.name.substr(0, 32) + " " + std::to_string(i); };
            corners_.clear();
            for (const Property& property : element.properties) {
                if (!(property.count ? read_list(property) : read_scalar(property))) {
                    return builder_.parse_error(place() + ": \"" + property.name.substr(0, 32) + "\" is missing or no number");
                }
            }
            if (role == Role::Vertex && !builder_.add_vertex(position_)) return builder_.not_finite();
            if (role != Role::Face) continue;
            if (const char* problem = builder_.add_face(corners_)) return builder_.parse_error(place() + ": " + problem);
        }
        return {};
    }

private:
    bool read_scalar(const Property& property) {
        const std::optional<double> value = numbers_.next(property.type);
        if (!value) return false;
        for (int axis = 0; axis < 3; ++axis) {
            if (property.name == std::string_view(&"xyz"[axis], 1)) position_[axis] = *value;
        }
        return true;
    }

    bool read_list(const Property& property) {
        const std::optional<std::uint32_t> count = whole(numbers_.next(*property.count));
        if (!count || *count > numbers_.bytes_left() / numbers_.least(property.type)) return false;
        const bool wanted = property.name == "vertex_indices" || property.name == "vertex_index";
        for (std::uint32_t k = 0; k < *count; ++k) {
            const std::optional<double> value = numbers_.next(property.type);
            if (!value) return false;
            if (!wanted) continue;
            const std::optional<std::uint32_t> corner = whole(value);
            if (!corner) return false;
            corners_.push_back(*corner);
        }
        return true;
    }

    Numbers& numbers_;
    MeshBuilder& builder_;
    dvec3 position_{0.0};
    std::vector<std::uint32_t> corners_;
};

bool has(const Element& element, std::string_view name, bool list) {
    return std::ranges::any_of(element.properties, [&](const Property& p) { return p.name == name && p.count.has_value() == list; });
}

// What the element is for, once it has what that takes and the file can hold as many as it says.
Result<Role> role_of(const Element& element, const Numbers& numbers, const MeshBuilder& builder) {
    std::size_t least = 0;
    for (const Property& property : element.properties) {
        least += numbers.least(property.count.value_or(property.type));
    }
    if (element.count > 0 && (least == 0 || element.count > numbers.bytes_left() / least)) {
        return builder.parse_error("says more of \"" + element.name.substr(0, 32) + "\" than the file holds");
    }
    if (element.name == "tristrips") return builder.unsupported("triangle strips are not read");
    if (element.name == "vertex") {
        if (has(element, "x", false) && has(element, "y", false) && has(element, "z", false)) return Role::Vertex;
        return builder.parse_error("vertices need x, y and z");
    }
    if (element.name != "face") return Role::Other;
    if (has(element, "vertex_indices", true) || has(element, "vertex_index", true)) return Role::Face;
    return builder.parse_error("faces need a list vertex_indices");
}

}  // namespace

Status read_ply(std::string_view contents, MeshBuilder& builder) {
    const Result<Header> header = parse_header(contents, builder);
    if (!header) return header.error();
    Numbers numbers(contents.substr(header->size), header->encoding);
    for (const Element& element : header->elements) {
        const Result<Role> role = role_of(element, numbers, builder);
        if (!role) return role.error();
        if (Status status = BodyReader(numbers, builder).read(element, *role); !status) return status;
    }
    return numbers.at_end() ? Status{} : Status(builder.parse_error("goes on after the last element"));
}

}  // namespace carom
