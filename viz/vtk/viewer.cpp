#include <carom/viz/vtk/viewer.hpp>

#include <carom/core/check.hpp>
#include <carom/viz/vtk/detail/canvas.hpp>
#include <carom/viz/vtk/detail/display.hpp>

#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkCellPicker.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindowInteractor.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

namespace carom {
namespace {

constexpr std::chrono::milliseconds kPatience{10};  // between looks at keyboard and mouse
constexpr int kClickSlack = 3;  // [pixels] a click may move and still be a click

/// The trackball without VTK's own keys ('q', 'w', 's', 'p' ...), which would do other things than ours.
class QuietTrackball : public vtkInteractorStyleTrackballCamera {
public:
    static QuietTrackball* New() {
        auto* object = new QuietTrackball;
        object->InitializeObjectBase();
        return object;
    }
    void OnChar() override {}
    void OnKeyPress() override {}
};

}  // namespace

struct Viewer::Impl {
    ViewerSource source;
    ViewerSettings settings;

    std::unique_ptr<detail::Canvas> canvas;
    vtkSmartPointer<vtkRenderWindowInteractor> interactor;
    vtkNew<vtkCallbackCommand> on_event;
    std::vector<std::string> layers;  ///< by key: layers[0] is key 1
    DebugFrame frame;
    std::uint64_t steps = 0;
    bool paused = false;
    bool ended = false;
    bool help = true;
    bool closed = false;
    int pressed_x = 0, pressed_y = 0;
    Status fault;

    [[nodiscard]] Status open();
    [[nodiscard]] Status refresh();
    void redraw();
    void step_once();
    void tick();
    void loop();
    void press(const std::string& key);
    BodyId pick(int x, int y);
    void frame_camera();
    [[nodiscard]] std::string overlay() const;
    void close();
    void handle(unsigned long event);
    static void dispatch(vtkObject*, unsigned long event, void* self, void*) { static_cast<Impl*>(self)->handle(event); }
};

Status Viewer::Impl::open() {
    if (canvas != nullptr) return {};
    if (!source.frame) return Error{ErrorCode::InvalidArgument, "the source has no frame function", "ViewerSource::frame"};
    if (Status s = detail::validate_size(settings.width, settings.height); !s) return s;
    if (!(settings.steps_per_second > 0.0 && settings.steps_per_second <= 1000.0)) {
        return Error{ErrorCode::InvalidArgument, "steps_per_second must be in (0, 1000]", "ViewerSettings::steps_per_second"};
    }
    if (settings.camera) {
        if (Status s = validate(*settings.camera); !s) return s;
    }
    if (Status s = detail::check_display(); !s) return s;
    canvas = std::make_unique<detail::Canvas>(
        detail::CanvasSettings{.width = settings.width, .height = settings.height, .off_screen = false});
    paused = settings.paused;
    if (Status s = refresh(); !s) {
        canvas.reset();
        return s;
    }
    frame_camera();
    canvas->window()->SetWindowName(settings.title.c_str());
    interactor = vtkSmartPointer<vtkRenderWindowInteractor>::New();
    interactor->SetRenderWindow(canvas->window());
    vtkNew<QuietTrackball> trackball;
    trackball->SetDefaultRenderer(canvas->scene());
    interactor->SetInteractorStyle(trackball);
    on_event->SetClientData(this);
    on_event->SetCallback(&Impl::dispatch);
    for (const unsigned long event :
         {vtkCommand::KeyPressEvent, vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent}) {
        interactor->AddObserver(event, on_event);
    }
    interactor->Initialize();
    redraw();
    return {};
}

/// Fetches the scene as it stands.
Status Viewer::Impl::refresh() {
    frame = source.frame();
    if (Status s = validate(frame); !s) return s;
    for (const DebugLayer& layer : frame.layers) {
        if (std::find(layers.begin(), layers.end(), layer.name) == layers.end()) layers.push_back(layer.name);
    }
    canvas->show(frame);
    return {};
}

void Viewer::Impl::redraw() {
    canvas->set_caption(overlay());
    canvas->render();
}

std::string Viewer::Impl::overlay() const {
    std::ostringstream out;
    out << settings.title << "   step " << steps << (ended ? "   at its end" : paused ? "   paused" : "") << '\n';
    if (!frame.caption.empty()) out << frame.caption << '\n';
    if (!help) return out.str();
    out << "\nspace pause   n step   r frame   h help   q quit   click picks\n";
    for (std::size_t i = 0; i < layers.size() && i < 9; ++i) {
        out << i + 1 << (canvas->actors().visible(layers[i]) ? " + " : "   ") << layers[i] << '\n';
    }
    return out.str();
}

void Viewer::Impl::step_once() {
    if (ended || !source.step) return;
    ended = !source.step();
    ++steps;
    fault = refresh();
}

void Viewer::Impl::tick() {
    if (paused || ended || !source.step) return;
    step_once();
    if (!fault || (ended && settings.close_at_end)) {
        close();
    } else {
        redraw();
    }
}

/// VTK's own loop visits every interactor that was ever made, those of windows long gone included; this one serves ours alone.
void Viewer::Impl::loop() {
    using Clock = std::chrono::steady_clock;
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / settings.steps_per_second));
    Clock::time_point due = Clock::now();
    while (!closed) {
        interactor->ProcessEvents();
        closed = closed || interactor->GetDone();  // the window's own close button
        if (closed) return;
        if (Clock::now() >= due) {
            tick();
            due = std::max(due + period, Clock::now());
        }
        std::this_thread::sleep_until(std::min(due, Clock::now() + kPatience));
    }
}

void Viewer::Impl::frame_camera() {
    const int* size = canvas->window()->GetSize();  // the window may have been resized
    const double aspect = static_cast<double>(std::max(size[0], 1)) / std::max(size[1], 1);
    canvas->set_camera(settings.camera ? *settings.camera : automatic_camera(frame, aspect));
}

void Viewer::Impl::close() {
    closed = true;
    interactor->SetDone(true);
}

void Viewer::Impl::press(const std::string& key) {
    if (key == "q" || key == "Escape") return close();
    if (key == "space") {
        paused = !paused;
    } else if (key == "n") {
        paused = true;
        step_once();
        if (!fault) return close();
    } else if (key == "r") {
        frame_camera();
    } else if (key == "h") {
        help = !help;
    } else if (key.size() == 1 && key[0] >= '1' && key[0] <= '9') {
        const auto index = static_cast<std::size_t>(key[0] - '1');
        if (index >= layers.size()) return;
        canvas->actors().set_visible(layers[index], !canvas->actors().visible(layers[index]));
    } else {
        return;
    }
    redraw();
}

BodyId Viewer::Impl::pick(int x, int y) {
    dvec3 eye{0.0};
    canvas->scene()->GetActiveCamera()->GetPosition(&eye.x);
    vtkNew<vtkCellPicker> picker;
    picker->SetTolerance(0.0);
    bool hit = picker->Pick(x, y, 0.0, canvas->scene()) != 0;
    if (hit && detail::FrameActors::is_hidden_back(picker->GetActor(), picker->GetCellId(), eye)) {
        // The picker sees what is not drawn: look behind that layer.
        vtkActor* seen_through = picker->GetActor();
        seen_through->PickableOff();
        hit = picker->Pick(x, y, 0.0, canvas->scene()) != 0;
        seen_through->PickableOn();
    }
    if (!hit) return {};
    const BodyId body = detail::FrameActors::body_of(picker->GetActor(), picker->GetCellId());
    if (!body) return body;
    const std::string text = source.describe
                                 ? source.describe(body)
                                 : "body " + std::to_string(body.slot) + ':' + std::to_string(body.generation) + '\n';
    if (source.print) {
        source.print(text);
    } else {
        std::fputs(text.c_str(), stdout);
        std::fflush(stdout);
    }
    return body;
}

void Viewer::Impl::handle(unsigned long event) {
    int x = 0, y = 0;
    interactor->GetEventPosition(x, y);
    switch (event) {
        case vtkCommand::KeyPressEvent: return press(interactor->GetKeySym() != nullptr ? interactor->GetKeySym() : "");
        case vtkCommand::LeftButtonPressEvent: pressed_x = x, pressed_y = y; return;
        case vtkCommand::LeftButtonReleaseEvent:
            if (std::abs(x - pressed_x) <= kClickSlack && std::abs(y - pressed_y) <= kClickSlack) pick(x, y);
            return;
        default: return;
    }
}

Viewer::Viewer(ViewerSource source, ViewerSettings settings) : impl_(std::make_unique<Impl>()) {
    impl_->source = std::move(source);
    impl_->settings = std::move(settings);
}

Viewer::~Viewer() {
    if (impl_->interactor == nullptr) return;
    // Window and interactor refer to each other.
    impl_->interactor->RemoveObserver(impl_->on_event);
    impl_->interactor->SetInteractorStyle(nullptr);
    impl_->interactor->SetRenderWindow(nullptr);
    impl_->canvas->window()->SetInteractor(nullptr);
    impl_->interactor = nullptr;
}

Status Viewer::open() { return impl_->open(); }

Status Viewer::run() {
    if (Status s = impl_->open(); !s) return s;
    if (impl_->closed) return impl_->fault;
    impl_->loop();
    return impl_->fault;
}

void Viewer::press(const std::string& key) {
    CAROM_REQUIRE(impl_->canvas != nullptr, ErrorCode::InvalidArgument, "the window is not open");
    impl_->press(key);
}

BodyId Viewer::pick(int x, int y) {
    CAROM_REQUIRE(impl_->canvas != nullptr, ErrorCode::InvalidArgument, "the window is not open", BodyId{});
    return impl_->pick(x, y);
}

std::uint64_t Viewer::steps() const noexcept { return impl_->steps; }
bool Viewer::paused() const noexcept { return impl_->paused; }
bool Viewer::layer_visible(const std::string& name) const {
    return impl_->canvas != nullptr && impl_->canvas->actors().visible(name);
}

}  // namespace carom
