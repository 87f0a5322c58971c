// The VTK actors of a debug frame: made once for each layer, given new data frame by frame.
#pragma once

#include <carom/viz/debug_frame.hpp>

#include <vtkActor.h>
#include <vtkActor2D.h>
#include <vtkLabeledDataMapper.h>
#include <vtkPolyDataMapper.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include <map>
#include <string>

namespace carom::detail {

/// Draws layers into two renderers of one camera: `scene`, and `overlay` on top of it for what shines through.
class FrameActors {
public:
    FrameActors(vtkRenderer* scene, vtkRenderer* overlay) : scene_(scene), overlay_(overlay) {}

    /// Shows the layers of `frame`. A layer seen for the first time is as visible as it says.
    void update(const DebugFrame& frame);

    void set_visible(const std::string& layer, bool visible);
    [[nodiscard]] bool visible(const std::string& layer) const;

    /// Points and lines are this much larger than the layers say, for pictures that are drawn larger than they end up.
    void set_pixel_scale(float scale) { pixel_scale_ = scale; }

    /// @return the body of a cell that a picker hit; null where the actor is none of ours.
    [[nodiscard]] static BodyId body_of(vtkActor* actor, vtkIdType cell);

    /// @return true where the cell is a triangle that is not drawn, because `eye` (in the actor's coordinates) is behind it.
    [[nodiscard]] static bool is_hidden_back(vtkActor* actor, vtkIdType cell, const dvec3& eye);

private:
    /// One kind of primitive of one layer.
    struct Part {
        vtkSmartPointer<vtkPolyDataMapper> mapper;
        vtkSmartPointer<vtkActor> actor;  ///< in the scene
        vtkSmartPointer<vtkActor> ghost;  ///< in the overlay; null where nothing shines through
    };
    struct LayerActors {
        Part triangles, lines, points;
        vtkSmartPointer<vtkLabeledDataMapper> label_mapper;
        vtkSmartPointer<vtkActor2D> labels;
        bool visible = true;
        bool has_texts = false;
    };

    LayerActors make(const DebugLayer& layer);
    Part make_part(bool ghost) const;
    void style(LayerActors& actors, const DebugLayer& layer) const;
    static void show(LayerActors& actors);

    vtkRenderer* scene_;
    vtkRenderer* overlay_;
    std::map<std::string, LayerActors> layers_;
    float pixel_scale_ = 1.0f;
};

}  // namespace carom::detail
