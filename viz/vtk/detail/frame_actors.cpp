#include <carom/viz/vtk/detail/frame_actors.hpp>

#include <carom/viz/vtk/detail/polydata.hpp>

#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkTextProperty.h>
#include <vtkUnsignedIntArray.h>

#include <set>

namespace carom::detail {
namespace {

constexpr double kGhostOpacity = 0.5;

void give(vtkPolyDataMapper* mapper, const DebugLayer& layer, const PolyDataParts& parts) {
    mapper->SetInputData(make_polydata(layer, parts));
}

}  // namespace

FrameActors::Part FrameActors::make_part(bool ghost) const {
    Part part;
    part.mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    part.mapper->SetScalarModeToUseCellData();
    part.mapper->SetColorModeToDirectScalars();
    part.actor = vtkSmartPointer<vtkActor>::New();
    part.actor->SetMapper(part.mapper);
    scene_->AddActor(part.actor);
    if (ghost) {
        part.ghost = vtkSmartPointer<vtkActor>::New();
        part.ghost->SetMapper(part.mapper);
        part.ghost->GetProperty()->SetOpacity(kGhostOpacity);
        part.ghost->GetProperty()->LightingOff();
        part.ghost->PickableOff();
        overlay_->AddActor(part.ghost);
    }
    return part;
}

FrameActors::LayerActors FrameActors::make(const DebugLayer& layer) {
    LayerActors actors;
    actors.triangles = make_part(false);
    actors.lines = make_part(layer.on_top);
    actors.points = make_part(layer.on_top);
    vtkProperty* surface = actors.triangles.actor->GetProperty();
    surface->SetInterpolationToPhong();
    surface->SetAmbient(0.25);
    surface->SetDiffuse(0.85);
    surface->SetSpecular(0.12);
    surface->SetSpecularPower(30.0);
    for (vtkActor* flat : {actors.lines.actor.Get(), actors.points.actor.Get()}) {
        flat->GetProperty()->LightingOff();
        flat->PickableOff();
    }
    actors.label_mapper = vtkSmartPointer<vtkLabeledDataMapper>::New();
    actors.label_mapper->SetLabelModeToLabelFieldData();
    actors.label_mapper->SetFieldDataName("text");
    actors.labels = vtkSmartPointer<vtkActor2D>::New();
    actors.labels->SetMapper(actors.label_mapper);
    actors.labels->PickableOff();
    overlay_->AddActor2D(actors.labels);
    actors.visible = layer.visible;
    return actors;
}

void FrameActors::style(LayerActors& actors, const DebugLayer& layer) const {
    for (const Part* part : {&actors.lines, &actors.points}) {
        for (vtkActor* actor : {part->actor.Get(), part->ghost.Get()}) {
            if (actor == nullptr) continue;
            actor->GetProperty()->SetPointSize(pixel_scale_ * layer.point_size);
            actor->GetProperty()->SetLineWidth(pixel_scale_ * layer.line_width);
            actor->GetProperty()->SetRenderPointsAsSpheres(true);
        }
    }
    actors.triangles.actor->GetProperty()->SetBackfaceCulling(layer.hide_backs);
    if (layer.texts.empty()) return;
    const Color c = layer.texts.front().color;
    vtkTextProperty* text = actors.label_mapper->GetLabelTextProperty();
    text->SetFontSize(static_cast<int>(14.0f * pixel_scale_));
    text->SetColor(c.r / 255.0, c.g / 255.0, c.b / 255.0);
    text->ItalicOff();
    text->BoldOff();
    text->ShadowOff();
    text->SetJustificationToCentered();
}

void FrameActors::show(LayerActors& actors) {
    for (const Part* part : {&actors.triangles, &actors.lines, &actors.points}) {
        part->actor->SetVisibility(actors.visible && part->mapper->GetInput()->GetNumberOfCells() > 0);
        if (part->ghost != nullptr) part->ghost->SetVisibility(part->actor->GetVisibility());
    }
    actors.labels->SetVisibility(actors.visible && actors.has_texts);
}

void FrameActors::update(const DebugFrame& frame) {
    std::set<std::string> present;
    for (const DebugLayer& layer : frame.layers) {
        present.insert(layer.name);
        auto found = layers_.find(layer.name);
        if (found == layers_.end()) found = layers_.emplace(layer.name, make(layer)).first;
        LayerActors& actors = found->second;
        give(actors.triangles.mapper, layer, {.points = false, .lines = false, .triangles = true, .texts = false});
        give(actors.lines.mapper, layer, {.points = false, .lines = true, .triangles = false, .texts = false});
        give(actors.points.mapper, layer, {.points = true, .lines = false, .triangles = false, .texts = false});
        actors.has_texts = !layer.texts.empty();
        actors.label_mapper->SetInputData(
            make_polydata(layer, {.points = false, .lines = false, .triangles = false, .texts = true}));
        style(actors, layer);
        show(actors);
    }
    for (auto& [name, actors] : layers_) {
        if (present.contains(name)) continue;
        for (const Part* part : {&actors.triangles, &actors.lines, &actors.points}) {
            give(part->mapper, DebugLayer{}, {});
        }
        actors.has_texts = false;
        show(actors);
    }
}

void FrameActors::set_visible(const std::string& layer, bool visible) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return;
    found->second.visible = visible;
    show(found->second);
}

bool FrameActors::visible(const std::string& layer) const {
    const auto found = layers_.find(layer);
    return found != layers_.end() && found->second.visible;
}

BodyId FrameActors::body_of(vtkActor* actor, vtkIdType cell) {
    if (actor == nullptr || actor->GetMapper() == nullptr) return {};
    auto* data = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInput());
    if (data == nullptr || cell < 0 || cell >= data->GetNumberOfCells()) return {};
    auto* slot = vtkUnsignedIntArray::SafeDownCast(data->GetCellData()->GetArray("body_slot"));
    auto* generation = vtkUnsignedIntArray::SafeDownCast(data->GetCellData()->GetArray("body_generation"));
    if (slot == nullptr || generation == nullptr) return {};
    return {slot->GetValue(cell), generation->GetValue(cell)};
}

bool FrameActors::is_hidden_back(vtkActor* actor, vtkIdType cell, const dvec3& eye) {
    if (actor == nullptr || actor->GetProperty()->GetBackfaceCulling() == 0) return false;
    auto* data = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInput());
    if (data == nullptr || cell < 0 || cell >= data->GetNumberOfCells() || data->GetCellType(cell) != VTK_TRIANGLE) return false;
    vtkNew<vtkIdList> ids;
    data->GetCellPoints(cell, ids);
    dvec3 corner[3];
    for (int k = 0; k < 3; ++k) data->GetPoint(ids->GetId(k), &corner[k].x);
    return glm::dot(glm::cross(corner[1] - corner[0], corner[2] - corner[0]), eye - corner[0]) < 0.0;
}

}  // namespace carom::detail
