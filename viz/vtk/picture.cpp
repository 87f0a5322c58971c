#include <carom/viz/vtk/picture.hpp>

#include <carom/viz/vtk/detail/canvas.hpp>
#include <carom/viz/vtk/detail/display.hpp>
#include <carom/viz/vtk/detail/files.hpp>

#include <vtkImageData.h>
#include <vtkImageResize.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

namespace carom {
namespace {

constexpr int kOversampling = 2;  // drawn so much larger, then averaged: smooth edges with every driver

/// The picture as the bytes of a PNG file; empty where VTK could not make it.
std::string encode(vtkRenderWindow* window, int width, int height) {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->SetInputBufferTypeToRGB();
    grab->ReadFrontBufferOff();
    grab->ShouldRerenderOff();
    vtkNew<vtkImageResize> shrink;
    shrink->SetInputConnection(grab->GetOutputPort());
    shrink->SetResizeMethodToOutputDimensions();
    shrink->SetOutputDimensions(width, height, 1);
    vtkNew<vtkPNGWriter> writer;
    writer->SetInputConnection(shrink->GetOutputPort());
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    if (bytes == nullptr || bytes->GetNumberOfValues() == 0) return {};
    return {reinterpret_cast<const char*>(bytes->GetPointer(0)), static_cast<std::size_t>(bytes->GetNumberOfValues())};
}

}  // namespace

Status render_to_png(const DebugFrame& frame, const std::string& path, const PictureSettings& settings) {
    if (Status s = detail::validate_size(settings.width, settings.height); !s) return s;
    if (Status s = validate(frame); !s) return s;
    const double aspect = static_cast<double>(settings.width) / settings.height;
    const Camera camera = settings.camera ? *settings.camera : automatic_camera(frame, aspect);
    if (Status s = validate(camera); !s) return s;
    if (Status s = detail::check_display(); !s) return s;
    detail::Canvas canvas({.width = kOversampling * settings.width,
                           .height = kOversampling * settings.height,
                           .off_screen = true,
                           .pixel_scale = static_cast<float>(kOversampling)});
    canvas.show(frame);
    canvas.set_camera(camera);
    canvas.render();
    const std::string png = encode(canvas.window(), settings.width, settings.height);

    if (png.empty()) return Error{ErrorCode::Io, "the picture could not be drawn", path};
    return detail::write_file(path, png);
}

}  // namespace carom
