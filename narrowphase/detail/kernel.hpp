// What a pair kernel sees and writes: two shapes in the frame of the first, patches of contact out.
//
//   CollideStatus sphere_sphere(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);
#pragma once

#include <carom/narrowphase/collide.hpp>
#include <carom/narrowphase/detail/manifold_list.hpp>

#include <array>
#include <cstdint>
#include <span>

namespace carom::detail {

/// What points are to be reported.
struct Asked {
    double margin = 0.0;  ///< with separations up to this [m]
    bool steady = false;  ///< as in PlacedShapes
};

/// One pair as its kernel sees it: everything in the frame of the first shape, in double, so that the distance of the pair from
/// the world's origin has no influence.
struct PairFrame {
    const Shape& first;
    const Shape& second;
    dmat3 rotation{1.0};     ///< second's frame to first's
    dvec3 translation{0.0};  ///< origin of the second in the first's frame [m]
    double margin = 0.0;     ///< separations up to this are reported [m]
    bool steady = false;     ///< as in PlacedShapes

    [[nodiscard]] Asked asked() const noexcept { return {margin, steady}; }
    [[nodiscard]] dvec3 to_first(const dvec3& p) const noexcept { return rotation * p + translation; }
    [[nodiscard]] dvec3 to_second(const dvec3& p) const noexcept { return (p - translation) * rotation; }
};

/// A point of contact in double, in the frame of the first shape.
struct PatchPoint {
    dvec3 position{0.0};      ///< midway between the surfaces [m]
    double separation = 0.0;  ///< along the patch's normal [m]
    std::uint64_t feature = 0;
};

/// One manifold in double, in the frame of the first shape; normal from first to second.
struct Patch {
    dvec3 normal{0.0, 1.0, 0.0};
    int count = 0;
    std::array<PatchPoint, kMaxManifoldPoints> points{};

    void add(const dvec3& position, double separation, std::uint64_t feature) noexcept {
        points[static_cast<std::size_t>(count++)] = {position, separation, feature};
    }
};

/// Turns the patches of one pair into manifolds about A's origin along world axes, undoes the swap of a pair whose kernel
/// takes its shapes in the other order, and says of which parts of compounds they are.
class ManifoldSink {
public:
    /// @param axes  rotation of the kernel's first shape to world axes; `shift` from A's origin to the first shape's.
    ManifoldSink(const dmat3& axes, const dvec3& shift, bool swapped, std::uint32_t index, ManifoldList& out) noexcept
        : axes_(axes), shift_(shift), turn_(swapped ? -1.0 : 1.0), index_(index), out_(out) {}

    void add(const Patch& patch);

    /// @return the sink for part `part` of the compound that is the kernel's first shape, against its second: for a kernel whose first
    /// shape lies in this kernel's first frame by `axes` and `origin`; `swapped` where that is the second shape.
    [[nodiscard]] ManifoldSink of_part(const dmat3& axes, const dvec3& origin, bool swapped, std::uint32_t part) const noexcept;

private:
    dmat3 axes_;
    dvec3 shift_;
    double turn_;
    std::uint32_t part_a_ = 0, part_b_ = 0;
    std::uint64_t parts_ = 0;  // in the order in which the kernels took compounds apart, each part counted from 1; 0: none
    std::uint32_t index_;
    ManifoldList& out_;
};

struct Workspace;  // detail/workspace.hpp

using Kernel = CollideStatus (*)(const PairFrame& pair, Workspace& workspace, ManifoldSink& sink);

/// What kernels for many pairs see. Everything has been checked, but for the poses where a kernel says that it proves them finite.
struct BatchInput {
    PlacedShapes placed;
    std::span<const NumberedPair> pairs;

    /// How far apart the two of a pair may be [m].
    [[nodiscard]] float margin(std::uint32_t index) const noexcept { return pairs[index].margin + pairs[index].slack; }
    [[nodiscard]] ShapePair pair(std::uint32_t index) const noexcept {
        const NumberedPair& p = pairs[index];
        return {placed.shapes[p.a], placed.shapes[p.b], placed.poses[p.a], placed.poses[p.b], margin(index), placed.steady};
    }
};

/// Many pairs of one kind at once: pairs `chosen` of the input, at most one manifold for each, in their order.
using WideKernel = void (*)(const BatchInput& input, std::span<const std::uint32_t> chosen, Workspace& workspace,
                            ManifoldList& out);

/// The kernel of a pair of types: for one pair at a time, which may take the second type first, or for many; where there are both, the
/// one for many is faster and preferred. Both are null where there is none.
struct KernelEntry {
    Kernel function = nullptr;
    WideKernel wide = nullptr;
    bool swapped = false;

    [[nodiscard]] constexpr bool exists() const noexcept { return function != nullptr || wide != nullptr; }
};

/// @return the table's entry for the types of A and B. detail/kernel_table.cpp names them all.
[[nodiscard]] const KernelEntry& kernel_for(ShapeType a, ShapeType b) noexcept;

/// Runs one pair that has been checked, by a kernel for one at a time.
CollideStatus run_pair(const ShapePair& pair, const KernelEntry& entry, std::uint32_t index, Workspace& workspace,
                       ManifoldList& out);

/// The shape as what it is known to be.
template <class T>
[[nodiscard]] const T& as(const Shape& shape) noexcept {
    const T* const known = std::get_if<T>(&shape);
    if (known == nullptr) __builtin_unreachable();
    return *known;
}

}  // namespace carom::detail
