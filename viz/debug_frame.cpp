#include <carom/viz/debug_frame.hpp>

#include <algorithm>
#include <cctype>

namespace carom {
namespace {

Error fault(ErrorCode code, const DebugLayer& layer, const char* kind, std::size_t index, const char* what) {
    return {code, std::string(kind) + " " + std::to_string(index) + " " + what, "layer \"" + layer.name + "\""};
}

bool is_layer_name(const std::string& name) {
    return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    });
}

template <class Items, class IsFinite>
Status check_finite(const DebugLayer& layer, const Items& items, const char* kind, IsFinite finite) {
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (!finite(items[i])) return fault(ErrorCode::NotFinite, layer, kind, i, "is not finite");
    }
    return {};
}

Status check_triangles(const DebugLayer& layer) {
    for (std::size_t i = 0; i < layer.triangles.size(); ++i) {
        for (const std::uint32_t v : layer.triangles[i].vertices) {
            if (v >= layer.vertices.size()) {
                return fault(ErrorCode::InvalidArgument, layer, "triangle", i, "has a vertex index out of range");
            }
        }
    }
    return {};
}

Status check_layer(const DebugLayer& layer) {
    if (!is_layer_name(layer.name)) {
        return Error{ErrorCode::InvalidArgument, "a layer's name is one or more letters, digits, '_' or '-'",
                     "layer \"" + layer.name + "\""};
    }
    if (!(layer.point_size > 0.0f && layer.line_width > 0.0f && is_finite(layer.point_size) && is_finite(layer.line_width))) {
        return Error{ErrorCode::InvalidArgument, "point_size and line_width must be positive", "layer \"" + layer.name + "\""};
    }
    const auto at = [](const auto& item) { return is_finite(item.position); };
    if (Status s = check_finite(layer, layer.points, "point", at); !s) return s;
    if (Status s = check_finite(layer, layer.texts, "text", at); !s) return s;
    const auto ends = [](const DebugLine& line) { return is_finite(line.a) && is_finite(line.b); };
    if (Status s = check_finite(layer, layer.lines, "line", ends); !s) return s;
    const auto both = [](const DebugVertex& v) { return is_finite(v.position) && is_finite(v.normal); };
    if (Status s = check_finite(layer, layer.vertices, "vertex", both); !s) return s;
    return check_triangles(layer);
}

}  // namespace

DebugLayer* DebugFrame::find(std::string_view name) noexcept {
    for (DebugLayer& layer : layers) {
        if (layer.name == name) return &layer;
    }
    return nullptr;
}

const DebugLayer* DebugFrame::find(std::string_view name) const noexcept {
    for (const DebugLayer& layer : layers) {
        if (layer.name == name) return &layer;
    }
    return nullptr;
}

Status validate(const DebugFrame& frame) {
    if (!is_finite(frame.origin)) return Error{ErrorCode::NotFinite, "the origin is not finite", "DebugFrame::origin"};
    const double up_sq = glm::dot(frame.up, frame.up);
    if (!(up_sq > 0.98 && up_sq < 1.02)) {
        return Error{ErrorCode::InvalidArgument, "up must be of unit length", "DebugFrame::up"};
    }
    for (const DebugLayer& layer : frame.layers) {
        if (Status s = check_layer(layer); !s) return s;
        if (frame.find(layer.name) != &layer) {
            return Error{ErrorCode::InvalidArgument, "two layers have this name", "layer \"" + layer.name + "\""};
        }
    }
    return {};
}

}  // namespace carom
