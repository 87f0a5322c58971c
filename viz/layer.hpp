// The names of the layers that a world's debug frame has.
//
//   if (const DebugLayer* contacts = frame.find(to_string(Layer::Contacts))) ...
#pragma once

namespace carom {

/// The layers that a world fills. The order is that of DebugFrame::layers.
enum class Layer : unsigned char {
    Static,    ///< the shapes of static bodies, without their backs
    Shapes,    ///< the shapes of dynamic and kinematic bodies
    Contacts,  ///< points of contact: warm colours touch, the cold one is within the margin only
    Normals,   ///< a line along the normal from each point, from A towards B
    Impulses,  ///< a line along the normal from each point, as long as its impulse is large
    Bounds,    ///< the box of each bounded shape
    Bvh,       ///< the boxes of each mesh's hierarchy
    Names,     ///< the name of each body that has one, at its centre of mass
    Joints,    ///< from each body's centre of mass to its anchor, and from anchor to anchor
};
inline constexpr int kLayerCount = 9;

/// @return the name of the layer in a frame: "static", "shapes", "contacts", "normals", "impulses", "bounds", "bvh", "names", "joints".
[[nodiscard]] const char* to_string(Layer layer) noexcept;

/// @return the layer's bit in DebugFrameSettings::layers.
[[nodiscard]] constexpr unsigned layer_bit(Layer layer) noexcept { return 1u << static_cast<unsigned>(layer); }
inline constexpr unsigned kAllLayers = (1u << kLayerCount) - 1;

}  // namespace carom
