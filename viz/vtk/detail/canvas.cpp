#include <carom/viz/vtk/detail/canvas.hpp>

#include <carom/core/math.hpp>

#include <vtkCamera.h>
#include <vtkTextProperty.h>

namespace carom::detail {

Status validate_size(int width, int height) {
    if (width >= 16 && width <= 8192 && height >= 16 && height <= 8192) return {};
    return Error{ErrorCode::InvalidArgument, "width and height must be in 16..8192 pixels",
                 std::to_string(width) + " x " + std::to_string(height)};
}

Canvas::Canvas(const CanvasSettings& settings) : actors_(scene_, overlay_) {
    window_->SetOffScreenRendering(settings.off_screen ? 1 : 0);
    window_->SetSize(settings.width, settings.height);
    window_->SetMultiSamples(settings.off_screen ? 0 : 4);  // pictures are drawn larger and averaged instead
    window_->SetNumberOfLayers(2);
    scene_->GradientBackgroundOn();
    scene_->SetBackground(0.965, 0.965, 0.955);
    scene_->SetBackground2(0.70, 0.79, 0.89);
    overlay_->SetLayer(1);
    overlay_->SetActiveCamera(scene_->GetActiveCamera());
    overlay_->InteractiveOff();
    window_->AddRenderer(scene_);
    window_->AddRenderer(overlay_);
    actors_.set_pixel_scale(settings.pixel_scale);
    add_lights();
    caption_->GetTextProperty()->SetColor(0.12, 0.14, 0.20);
    caption_->GetTextProperty()->SetFontFamilyToCourier();
    caption_->GetTextProperty()->SetFontSize(static_cast<int>(18.0f * settings.pixel_scale));
    caption_->GetTextProperty()->SetVerticalJustificationToTop();
    caption_->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
    caption_->SetPosition(0.012, 0.985);
    overlay_->AddActor2D(caption_);
}

void Canvas::add_lights() {
    scene_->AutomaticLightCreationOff();
    scene_->RemoveAllLights();
    sun_->SetLightTypeToSceneLight();
    sun_->PositionalOff();
    sun_->SetColor(1.0, 0.97, 0.92);
    sun_->SetIntensity(0.85);
    scene_->AddLight(sun_);
    vtkNew<vtkLight> fill;  // from the viewer, so that no side that faces us is black
    fill->SetLightTypeToHeadlight();
    fill->SetColor(0.86, 0.92, 1.0);
    fill->SetIntensity(0.30);
    scene_->AddLight(fill);
}

void Canvas::show(const DebugFrame& frame) {
    // The sun stands high, to the left and behind the front (the z axis, or x where up is z).
    const dvec3 up = glm::normalize(frame.up);
    const dvec3 side = any_perpendicular(up), front = glm::cross(side, up);
    const dvec3 sun = glm::normalize(0.8 * up + 0.45 * front - 0.6 * side);
    vtkCamera* camera = scene_->GetActiveCamera();
    const dvec3 shift = origin_ - frame.origin;
    if (shift != dvec3{0.0}) {
        double p[3], f[3];
        camera->GetPosition(p);
        camera->GetFocalPoint(f);
        camera->SetPosition(p[0] + shift.x, p[1] + shift.y, p[2] + shift.z);
        camera->SetFocalPoint(f[0] + shift.x, f[1] + shift.y, f[2] + shift.z);
        origin_ = frame.origin;
    }
    actors_.update(frame);
    sun_->SetFocalPoint(0.0, 0.0, 0.0);
    sun_->SetPosition(sun.x, sun.y, sun.z);
    if (!frame.caption.empty()) set_caption(frame.caption);
}

void Canvas::set_camera(const Camera& camera) {
    const dvec3 position = camera.position - origin_, target = camera.target - origin_;
    vtkCamera* active = scene_->GetActiveCamera();
    active->SetPosition(position.x, position.y, position.z);
    active->SetFocalPoint(target.x, target.y, target.z);
    active->SetViewUp(camera.up.x, camera.up.y, camera.up.z);
    active->SetViewAngle(camera.field_of_view * 180.0 / kPi);
}

void Canvas::set_caption(const std::string& text) { caption_->SetInput(text.c_str()); }

void Canvas::render() {
    scene_->ResetCameraClippingRange();
    window_->Render();
}

}  // namespace carom::detail
