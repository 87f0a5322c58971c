#include <carom/viz/layer.hpp>

namespace carom {

const char* to_string(Layer layer) noexcept {
    switch (layer) {
        case Layer::Static: return "static";
        case Layer::Shapes: return "shapes";
        case Layer::Contacts: return "contacts";
        case Layer::Normals: return "normals";
        case Layer::Impulses: return "impulses";
        case Layer::Bounds: return "bounds";
        case Layer::Bvh: return "bvh";
        case Layer::Names: return "names";
        case Layer::Joints: return "joints";
    }
    return "unknown";
}

}  // namespace carom
